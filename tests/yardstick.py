#!/usr/bin/env python3
"""Checks docs/course.md: its commands run, and its counts and quoted outputs are what they print.

    tests/yardstick.py build/release/raio
    tests/yardstick.py build/release/raio --print

prints the tables as they should be. The pictures of the mistakes are those in the tree; `./check docs`
makes them again.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs/course"))
sys.dont_write_bytecode = True
from mistakes import MISTAKES, TRACER

REGIONS = ["background", "edges", "mirrors and glass", "shiny surfaces", "borders of shadows", "shadows", "lit surfaces"]


def blocks(page):
    """Indented code: a list of lines for each block between empty lines."""
    for piece in page.split("\n\n"):
        lines = piece.strip("\n").split("\n")
        if all(line.startswith("    ") for line in lines):
            yield [line[4:] for line in lines]


def is_command(block):
    return re.match(r"\./raio |python3 |sed |for ", block[0])


def run_commands(page, folder):
    """Runs all except the window and the tracer; returns the output, and the output quoted by the page."""
    said = []
    answers = False
    for block in blocks(page):
        if is_command(block):
            script = "\n".join(line for line in block if not line.startswith(("python3 ", "./raio view ")))
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder, text=True,
                                  capture_output=True)
            if done.returncode:
                sys.exit(f"{script}\n{done.stderr}{done.stdout}")
            answers = [done.stdout.rstrip("\n"), ""]
            said.append(answers)
        elif answers:  # output may contain empty lines
            answers[1] += "\n\n" * bool(answers[1]) + "\n".join(block)
    return [pair for pair in said if pair[1]]


def count_rows(folder):
    for path in sorted((folder / "build").glob("*.json")):
        stats = json.loads(path.read_text())
        rays = stats["rays"]
        kinds = ["eye", "eye_hits", "reflection", "refraction", "shadow", "shadow_hits"]
        cells = [f"{rays[kind]:,}" for kind in kinds]
        if "per_ray" in stats:
            cells = [f"{rays['total']:,}", *(f"{stats['per_ray'][what]:.1f}" for what in ("tests", "steps"))]
        yield f"| `{path.stem}` | " + " | ".join(cells) + " |"


def mistake_rows(page, folder):
    """The regions where each picture with a mistake differs from the right one."""
    for mistake in MISTAKES:
        wrong = f"pictures/course/mistake-{mistake.name}.png"
        right = re.search(rf"\((\S+)\) \| !\[[^\]]*\]\({wrong}\)", page)
        if not right:
            sys.exit(f"the page does not show {wrong} beside the right picture")
        command = ["./raio", "compare", f"docs/{right[1]}", f"docs/{wrong}", "--explain",
                   f"scenes/course/{mistake.scene}.nff"]
        text = subprocess.run(command, cwd=folder, text=True, capture_output=True, check=True).stdout
        psnr, above = re.search(r"PSNR +(\S+ dB)(?:.*\n)+pixels above 8 +(\S+) %", text).groups()
        # Without a line for what the scene does not show.
        parts = dict.fromkeys(REGIONS, "0") | dict(re.findall(r"^([a-z ]+?)(?: +\S+ %){2} +(\S+) %", text, re.M))
        yield f"| `{mistake.name}` | {psnr} | " + " | ".join(
            f"{float(part):.{digits}f} %" for part, digits in zip([above, *parts.values()], [1] + [0] * 7)) + " |"


def mistakes_are_seen(page, folder):
    """Each changes tracer.py and a small picture; the page quotes the line."""
    subprocess.run([sys.executable, TRACER.with_name("mistakes.py"), folder, "--size", "36x24"], check=True,
                   stdout=subprocess.DEVNULL)
    for mistake in MISTAKES:
        right, wrong = folder / "right.ppm", folder / f"mistake-{mistake.name}.png"
        scene = ROOT / f"scenes/course/{mistake.scene}.nff"
        subprocess.run([sys.executable, TRACER, scene, *mistake.options.split(), "--size", "36x24", "-o", right],
                       check=True, stdout=subprocess.DEVNULL)
        said = subprocess.run(["./raio", "compare", right, wrong], cwd=folder, text=True, capture_output=True,
                              check=True).stdout
        if "pixels above 8      0 %" in said:
            yield f"{mistake.name} cannot be seen"
        if f"```\n{mistake.right}\n{mistake.wrong}\n```" not in page:
            yield f"the page does not quote the line of {mistake.name}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("raio", type=Path)
    parser.add_argument("--print", action="store_true", help="the tables as they should be")
    arguments = parser.parse_args()
    page = (ROOT / "docs/course.md").read_text(encoding="utf-8")
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for part in "scenes", "docs/course", "docs/pictures/course":
            shutil.copytree(ROOT / part, folder / part)
        (folder / "build").mkdir()
        (folder / "raio").symlink_to(arguments.raio.resolve())
        for printed, quoted in run_commands(page, folder):
            if "\n".join(map(str.rstrip, printed.split("\n"))) != quoted:
                faults.append(f"printed:\n{printed}\nquoted:\n{quoted}")
        for row in [*count_rows(folder), *mistake_rows(page, folder)]:
            if arguments.print:
                print(row)
            if row not in page:
                faults.append(f"the page lacks {row}")
        faults += mistakes_are_seen(page, folder)
    return None if arguments.print else "\n".join(faults) or None


if __name__ == "__main__":
    sys.exit(main())
