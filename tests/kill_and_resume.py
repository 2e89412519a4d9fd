#!/usr/bin/env python3
"""Kills a render at random moments, resumes from its checkpoint each time, and compares the result
with the picture of an undisturbed render, byte by byte.

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
            # Long enough to make progress each time, and short enough for many kills.
            wait_s = moments.uniform(0, 3 * alone_s / arguments.kills)
            try:
                _, said = program.communicate(timeout=wait_s if kills < arguments.kills else None)
            except subprocess.TimeoutExpired:
                program.send_signal(blow)
                _, said = program.communicate()
                kills += 1
            if program.returncode not in (0, 130, -blow):  # or: before the handler was installed, or too late
                return f"after kill {kills} it ends with status {program.returncode}: {said.decode()}"
            if blow != signal.SIGKILL and list(folder.glob(".raio*")):
                return f"after kill {kills} an unfinished file is left"
            if not picture.exists():
                continue
            pictures += 1
            if picture.read_bytes() != whole.read_bytes():
                return f"after kill {kills} the picture differs"
            if kills < arguments.kills:  # finished too soon: start again
                picture.unlink()
                checkpoint.unlink()
        size = whole.stat().st_size
    print(f"{kills} kills, {pictures} finished, each the same {size} bytes ({alone_s:.1f} s undisturbed)")
    return None


sys.exit(main())
