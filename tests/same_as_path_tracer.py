#!/usr/bin/env python3
"""Renders small scenes with Raio's path integrator and with the path tracer of the course, and fails if their means
differ by more than noise: in the whole picture, in its blocks, and in the sum of squares over all blocks.

    tests/same_as_path_tracer.py build/release/raio
    tests/same_as_path_tracer.py build/release/raio "scenes/shapes.nff --samples 64"

The error of the path tracer is known from the variance of its samples; that of Raio, whose samples are better
distributed, is at most as large for the same number. All seeds are fixed, so the result is always the same.
"""
import argparse
import struct
import subprocess
import sys
import tempfile
import time
from math import sqrt
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "docs/course"))
import path_tracer  # noqa: E402

# Many bounces between diffuse walls, with a point and with a square; mirrors and glass in front of a background; rough
# metal and the balance heuristic; metals of all roughnesses, white and coloured, in light from all sides; masked
# microfacets at grazing angles.
LAMPS = "--environment scenes/course/paths/lamps.pfm"
SCENES = ["scenes/course/room.nff --samples 16 --soft-shadows --light-size 2",
          "scenes/course/room.nff --samples 16 --depth 2", "scenes/course/glass.nff --samples 32",
          f"scenes/course/paths/plates.p3f --samples 24 {LAMPS}", "scenes/course/paths/furnace.p3f --samples 24",
          "tests/files/rough_metal.p3f --samples 96 --depth 2"]
RAIO_SAMPLES, BLOCK, MOST_SIGMAS, MOST_RMS = 1024, 8, 3, 1.5
ROUNDING = 5e-4  # Raio computes in single precision; relative to the brightness


def raio_picture(raio, words):
    """Rows of colours."""
    with tempfile.TemporaryDirectory() as name:
        picture = Path(name) / "picture.pfm"
        subprocess.run([raio, "render", "--quiet", *words, "-o", picture], cwd=ROOT, check=True)
        with picture.open("rb") as file:
            file.readline()
            width, height = map(int, file.readline().split())
            file.readline()
            numbers = struct.unpack(f"<{3 * width * height}f", file.read())
    rows = [numbers[i:i + 3 * width] for i in range(0, len(numbers), 3 * width)][::-1]
    return [[row[i:i + 3] for i in range(0, len(row), 3)] for row in rows]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("raio", type=Path)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--size", default="24x16")
    arguments = parser.parse_args()
    faults = []
    print(f"{'':72}               in standard errors\n{'scene':72}   mean     apart    whole    worst   rms    tracer")
    for scene in arguments.scenes:
        words = [*scene.split(), "--size", arguments.size]
        options = path_tracer.parse([*words, "-o", "none.png"])
        options.scene = str(ROOT / options.scene)
        if options.environment:
            options.environment = str(ROOT / options.environment)
        start = time.monotonic()
        theirs = path_tracer.render(options)
        seconds = time.monotonic() - start
        for option in ("--strategy", "--samples"):
            if option in words:
                at = words.index(option)
                del words[at:at + 2]
        words += ["--integrator", "path", "--filter", "box", "--samples", str(RAIO_SAMPLES)]
        ours = raio_picture(arguments.raio.resolve(), words)

        # For each block and colour the sums of differences, of variances and of Raio's picture.
        width, height = options.size
        blocks = {}
        for y in range(height):
            for x in range(width):
                mean, variance = theirs[y][x]
                for c in range(3):
                    sums = blocks.setdefault((x // BLOCK, y // BLOCK, c), [0, 0, 0])
                    sums[0] += mean[c] - ours[y][x][c]
                    sums[1] += variance[c] * (1 + options.samples / RAIO_SAMPLES)
                    sums[2] += ours[y][x][c]
        whole = [[sum(blocks[key][i] for key in blocks if key[2] == c) for i in range(3)] for c in range(3)]

        def in_sigmas(difference, variance, brightness):
            return max(0, abs(difference) - ROUNDING * brightness) / sqrt(variance + 1e-12)

        of_blocks = [in_sigmas(*sums) for sums in blocks.values()]
        of_whole = max(in_sigmas(*sums) for sums in whole)
        worst, rms = max(of_blocks), sqrt(sum(s * s for s in of_blocks) / len(of_blocks))
        bright = sum(sums[2] for sums in whole) / (3 * width * height)
        apart = sum(sums[0] for sums in whole) / (3 * width * height) / bright
        print(f"{scene:72} {bright:.4f} {100 * apart:7.2f} % {of_whole:8.2f} {worst:8.2f} {rms:5.2f} {seconds:6.1f} s",
              flush=True)
        if of_whole > MOST_SIGMAS or worst > MOST_SIGMAS or rms > MOST_RMS:
            faults.append(f"{scene}: the pictures differ by more than noise")
    return "\n".join(faults) or None


if __name__ == "__main__":  # the path tracer starts processes, some of which import this file
    sys.exit(main())
