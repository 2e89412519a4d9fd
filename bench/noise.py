#!/usr/bin/env python3
"""Measures pictures with `--noise`: the true error against a reference, and the time against `--samples`.

    bench/noise.py [--raio PROGRAM] [--size N] [--reference N] [--only NAME]

For each picture: the reference; pictures with 16, 32, ... samples per pixel; pictures with `--noise`. The relative
error of a pixel is that of docs/adaptive.md. Of blocks of 8 x 8 pixels, the table shows the root mean square of their
pixels: of all blocks, and the one below which 95 % of the blocks are. `as good as`: the number of samples of every
pixel, by interpolation, with the same 95 %. Times are processor seconds of the program, less those of one sample."""
import argparse
import array
import math
import os
import pathlib
import struct
import subprocess
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURES = {
    "sphereflake, soft shadows, lens": ["scenes/sphereflake.nff", "--soft-shadows", "--dof"],
    "balls, soft shadows": ["../shared/scenes/spd/balls.nff", "--soft-shadows"],
    "3sn6, ambient": ["../shared/scenes/molecules/3sn6.pdb"],
    "1crn, ambient, dark": ["../shared/scenes/molecules/1crn.pdb", "--look", "dark"],
}
UNIFORM = [16, 32, 64, 128, 256, 512]
NOISE = [0.05, 0.02, 0.01]
DARKEST = 1 / 32


def render(raio, scene, options, size, folder):
    """The brightness-relative data of a picture: (width, height, rgb, samples), and its processor seconds."""
    out = pathlib.Path(folder) / "picture.npz"
    command = [raio, "render", *scene, "--size", f"{size}x{size}", "--channels", "samples", *options, "-o", str(out)]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit("failed: " + " ".join(command))
    with zipfile.ZipFile(out) as arrays:
        def numbers(name, kind):
            data = arrays.read(name + ".npy")
            header = struct.unpack("<H", data[8:10])[0]
            values = array.array(kind)
            values.frombytes(data[10 + header:])
            return values
        rgba, samples = numbers("rgba", "f"), numbers("samples", "I")
    return rgba, samples, usage.ru_utime + usage.ru_stime


def block_errors(rgba, reference, size):
    """The root mean square error of each block, and the relative errors of all pixels."""
    sums, counts, pixels = {}, {}, []
    for y in range(size):
        for x in range(size):
            at = 4 * (y * size + x)
            bright = max(sum(reference[at:at + 3]) / 3, DARKEST)
            square = sum((rgba[at + c] - reference[at + c])**2 for c in range(3)) / 3 / bright**2
            pixels.append(math.sqrt(square))
            block = (y // 8, x // 8)
            sums[block] = sums.get(block, 0) + square
            counts[block] = counts.get(block, 0) + 1
    return sorted(math.sqrt(sums[b] / counts[b]) for b in sums), pixels


def percentile(values, part):
    return values[min(len(values) - 1, int(part * len(values)))]


def as_good_as(error, uniform):
    """The number of samples with that error, on straight lines through logarithms."""
    points = sorted(uniform.items())
    for (n0, e0), (n1, e1) in zip(points, points[1:]):
        if e1 <= error or n1 == points[-1][0]:
            return n0 * (n1 / n0)**(math.log(e0 / error) / math.log(e0 / e1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--raio", default=str(ROOT / "build/release/raio"))
    parser.add_argument("--size", type=int, default=192)
    parser.add_argument("--reference", type=int, default=4096)
    parser.add_argument("--only", default="", help="pictures whose names contain this")
    args = parser.parse_args()
    print(
        "| picture | E | samples | rms of blocks | 95 % of blocks | blocks below E | pixels below 2 E "
        "| as good as | time |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in PICTURES.items():
            if args.only not in name:
                continue
            run = lambda *options, scene=scene: render(args.raio, scene, options, args.size, folder)
            start_s = run("--samples", "1")[2]
            reference = run("--samples", str(args.reference), "--seed", "4711")[0]
            uniform, a_sample_s = {}, 0
            for n in UNIFORM:
                rgba, _, seconds = run("--samples", str(n))
                blocks, _ = block_errors(rgba, reference, args.size)
                uniform[n] = percentile(blocks, 0.95)
                a_sample_s = (seconds - start_s) / (n - 1)
            print(f"<!-- {name}: uniform {uniform}, {a_sample_s:.4f} s a sample -->", flush=True)
            for noise in NOISE:
                rgba, samples, seconds = run("--noise", str(noise))
                blocks, pixels = block_errors(rgba, reference, args.size)
                rms = math.sqrt(sum(b * b for b in blocks) / len(blocks))
                most = percentile(blocks, 0.95)
                equal = as_good_as(most, uniform)
                print(f"| {name} | {noise} | {sum(samples) / len(samples):.0f} | {rms:.4f} | {most:.4f} "
                      f"| {100 * sum(b < noise for b in blocks) / len(blocks):.1f} % "
                      f"| {100 * sum(p < 2 * noise for p in pixels) / len(pixels):.1f} % | {equal:.0f} "
                      f"| {(seconds - start_s) / (a_sample_s * equal):.2f} |", flush=True)


if __name__ == "__main__":
    main()
