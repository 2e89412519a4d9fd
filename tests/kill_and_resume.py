#!/usr/bin/env python3
"""Kills a render at random moments, goes on with its checkpoint each time, and compares the end
with the picture of a render that nobody disturbed, to the byte.

    tests/kill_and_resume.py build/release/raio scenes/shapes.nff --kills 50
    tests/kill_and_resume.py build/release/raio scenes/shapes.nff --kills 50 --signal TERM
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("raio", type=Path)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--signal", choices=["KILL", "TERM", "INT", "HUP"], default="KILL")
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    parser.add_argument("--options", default="--size 200x150 --samples 400 --dof --soft-shadows")
    arguments = parser.parse_args()
    moments = random.Random(arguments.seed)
    blow = signal.Signals["SIG" + arguments.signal]
    render = [arguments.raio.resolve(), "render", arguments.scene.resolve(), "--quiet"]
    render += arguments.options.split()
    keep = ["--checkpoint", "c.raio", "--resume", "--checkpoint-interval", "0.05"]

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole, picture, checkpoint = folder / "whole.png", folder / "x.png", folder / "c.raio"
        start = time.monotonic()
        subprocess.run([*render, "-o", whole], cwd=folder, check=True)
        alone_s = time.monotonic() - start

        kills = pictures = 0
        while kills < arguments.kills or pictures == 0:
            program = subprocess.Popen([*render, *keep, "-o", picture], cwd=folder, stderr=subprocess.PIPE)
            # Long enough to come further each time, and so short that there are enough kills.
            wait_s = moments.uniform(0, 3 * alone_s / arguments.kills)
            try:
                _, said = program.communicate(timeout=wait_s if kills < arguments.kills else None)
            except subprocess.TimeoutExpired:
                program.send_signal(blow)
                _, said = program.communicate()
                kills += 1
            if program.returncode not in (0, 130, -blow):  # also: too early to be heard, too late
                return f"after kill {kills} it ends with status {program.returncode}: {said.decode()}"
            if blow != signal.SIGKILL and list(folder.glob(".raio*")):
                return f"after kill {kills} an unfinished file is left"
            if not picture.exists():
                continue
            pictures += 1
            if picture.read_bytes() != whole.read_bytes():
                return f"after kill {kills} the picture differs"
            if kills < arguments.kills:  # done too soon: once more from the start
                picture.unlink()
                checkpoint.unlink()
        size = whole.stat().st_size
    print(f"{kills} kills, {pictures} finished, each the same {size} bytes ({alone_s:.1f} s undisturbed)")
    return None


sys.exit(main())
