#!/usr/bin/env python3
"""Compares Raio's pictures with POV-Ray's of the same scenes: one table of differences.

    bench/pov.py [--keep FOLDER] SCENE.nff...

Each scene is rendered by Raio and, exported by `raio export`, by POV-Ray (Debian's package povray), to
8-bit PNG. --keep stores the pictures of the last depth in a folder: NAME-raio.png, NAME-pov.png, NAME-diff.png."""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def fail(status, message):
    print(f"pov.py: error: {message}", file=sys.stderr)
    sys.exit(status)


def run(command, folder):
    try:
        done = subprocess.run([str(c) for c in command], cwd=folder, capture_output=True, text=True)
    except FileNotFoundError:
        fail(3, f"{command[0]} is not there")
    if done.returncode != 0:
        fail(3, f"{command[0]}: {done.stderr.strip()[-1500:]}")
    return done.stdout


def compare(args, scene, depth, folder):
    name, (width, height) = scene.stem, args.size.split("x")
    ours, theirs = f"{name}-raio.png", f"{name}-pov.png"
    picture = [scene, "--size", args.size, "--depth", depth]
    if args.projection:
        picture += ["--projection", args.projection]
    run([args.raio, "render", *picture, "--no-dof", "--aa", 1, "--quiet", "-o", ours], folder)
    run([args.raio, "export", *picture, "-o", f"{name}.pov"], folder)
    run([args.povray, f"+I{name}.pov", f"+O{theirs}", f"+W{width}", f"+H{height}",
         "File_Gamma=1.0", "-A", "-D"], folder)
    text = run([args.raio, "compare", ours, theirs, "--diff", f"{name}-diff.png"], folder)
    values = re.findall(r"  +(\S+)(?: \S+)*$", text, re.MULTILINE)
    return f"{values[0]:>10}{values[1]:>10}{values[2]:>10}{values[3]:>12}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", nargs="+", type=pathlib.Path, help="NFF files")
    parser.add_argument("--size", default="512x512", help="(%(default)s)")
    parser.add_argument("--depth", type=int, nargs="+", default=[5], help="levels of rays (5)")
    parser.add_argument("--projection", help="orthographic: the scene as parallel rays show it")
    parser.add_argument("--keep", type=pathlib.Path, help="a folder for the pictures")
    parser.add_argument("--raio", type=pathlib.Path, default=ROOT / "build/release/raio")
    parser.add_argument("--povray", default="povray")
    args = parser.parse_args()
    args.raio = args.raio.resolve()
    heads = ["PSNR", "RMSE", "largest", "pixels"], ["dB", "of 255", "of 255", "above 8, %"]
    if len(args.depth) > 1:
        print(" " * 18 + "".join(f"{f'depth {depth}':>42}" for depth in args.depth))
    for first, head in zip(("", "scene"), heads):
        print(f"{first:18}" + "{:>10}{:>10}{:>10}{:>12}".format(*head) * len(args.depth))
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for scene in args.scene:
            print(f"{scene.stem:18}", end="", flush=True)
            for depth in args.depth:
                print(compare(args, scene.resolve(), depth, folder), end="", flush=True)
            print()


if __name__ == "__main__":
    main()
