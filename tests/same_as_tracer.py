#!/usr/bin/env python3
"""Renders scenes with Raio and with the tracer of the course, and fails if more than one pixel in a
thousand differs by more than 1 of 255.

    tests/same_as_tracer.py build/release/raio
    tests/same_as_tracer.py build/release/raio scenes/rings.nff --size 200x200
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Spheres, triangles, polygons and smooth triangles; mirrors and glass. In the sphereflake each
# reflection in a small ball multiplies the rounding of Raio's floats, so it gets fewer of them.
SCENES = ["scenes/course/solids.nff", "scenes/course/glass.nff", "scenes/mount.nff", "scenes/gears.nff",
          "scenes/teapot.nff", "scenes/sphereflake.nff --depth 3"]
ALLOWED = 0.001


def read_ppm(path):
    magic, width, height, most, pixels = path.read_bytes().split(maxsplit=4)
    assert (magic, most) == (b"P6", b"255"), path
    assert len(pixels) == 3 * int(width) * int(height), path
    return pixels


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("raio", type=Path)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--size", default="64x64")
    arguments = parser.parse_args()
    raio = [arguments.raio.resolve(), "render", "--quiet"]
    tracer = [sys.executable, ROOT / "docs/course/tracer.py"]
    faults = []

    with tempfile.TemporaryDirectory() as name:
        ours, theirs, stats = (Path(name) / file for file in ("raio.ppm", "tracer.ppm", "stats.json"))

        def render_both(options):
            subprocess.run([*raio, *options, "-o", ours, "--stats", stats], cwd=ROOT, check=True)
            start = time.monotonic()
            subprocess.run([*tracer, *options, "-o", theirs], cwd=ROOT, check=True, capture_output=True)
            seconds = time.monotonic() - start
            a, b = read_ppm(ours), read_ppm(theirs)
            if len(a) != len(b):
                sys.exit(f"{options[0]}: the pictures differ in size")
            return a, b, seconds

        print("scene                              pixels apart   tracer     Raio")
        for scene in arguments.scenes:
            a, b, seconds = render_both([*scene.split(), "--size", arguments.size, "--aa", "1"])
            pixels = range(0, len(a), 3)
            apart = sum(any(abs(a[i + c] - b[i + c]) > 1 for c in range(3)) for i in pixels)
            share = apart / len(pixels)
            raio_s = json.loads(stats.read_text())["time_s"]["total"]
            print(f"{scene:35}{apart:5} {100 * share:5.2f} % {seconds:7.2f} s {raio_s:7.4f} s")
            if share > ALLOWED:
                faults.append(f"{scene}: {100 * share:.2f} % of the pixels differ")

        scene = ["scenes/course/solids.nff", "--size", "24x16"]
        # Brute force and the grid give the same picture.
        subprocess.run([*tracer, *scene, "-o", ours], cwd=ROOT, check=True, capture_output=True)
        subprocess.run([*tracer, *scene, "--accel", "none", "-o", theirs], cwd=ROOT, check=True,
                       capture_output=True)
        if read_ppm(ours) != read_ppm(theirs):
            faults.append("with the grid the tracer's picture is not that of brute force")

        # Random points differ, means do not: noise of some 4 of 255 in each of 1536 pixels leaves 0.1
        # in their mean.
        scene[-1] = "48x32"
        effects = ["--aa", "4", "--soft-shadows", "--light-size", "3", "--dof", "--aperture", "0.3"]
        a, b, _ = render_both([*scene, *effects])
        bias = sum(x - y for x, y in zip(a, b)) / len(a)
        error = (sum((x - y) ** 2 for x, y in zip(a, b)) / len(a)) ** 0.5
        print(f"all effects: mean difference {bias:.2f} of 255, root mean square {error:.2f}")
        if abs(bias) > 0.3 or error > 7:
            faults.append("with all effects the pictures differ by more than noise")

    return "\n".join(faults) or None


sys.exit(main())
