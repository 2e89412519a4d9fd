#!/usr/bin/env python3
"""Compares Raio with programs that render the same picture: one table of ratios.

    bench/peers.py --peer PATH/embree_packet.cpp SCENE.nff...

A peer is a C++ source (built with Embree and TBB into build/peers) or a program. It is called as

    PEER SCENE.nff OUT.ppm REPEAT AA THREADS SOFT DOF

and prints `render_s SECONDS` of the fastest of REPEAT frames, and `rays COUNT`. Programs run
alternately, so other load affects them alike; each run is a new process and gives its fastest frame,
and the table uses the median of the runs. Ratios are Raio's time over the peer's."""
import argparse
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# By name: the peer's AA, SOFT and DOF, and the options that give Raio the peer's light and lens.
EFFECTS = {
    "plain": (["1"], ["0", "0"]),
    "aa": (["3"], ["0", "0"]),
    "all": (["3"], ["1", "1"]),
}
SAME_LIGHT_AND_LENS = ["--light-size", "1", "--aperture", "0.05", "--focus", "3.5"]


def fail(status, message):
    print(f"peers.py: error: {message}", file=sys.stderr)
    sys.exit(status)


def run(command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0:
        fail(3 if done.returncode != 1 else 1, f"{command[0]}: {done.stderr.strip()[-500:]}")
    return done.stdout


def build(peer):
    path = pathlib.Path(peer)
    if not path.exists():
        return None
    if path.suffix != ".cpp":
        return path.resolve()
    out = ROOT / "build" / "peers" / path.stem
    out.parent.mkdir(parents=True, exist_ok=True)
    run(["g++", "-std=c++20", "-O3", "-march=native", "-ffast-math", "-o", out, path,
         "-lembree3", "-ltbb"])
    return out


def raio_seconds(args, scene, effects, folder, check):
    out = folder / "raio.json"
    run([args.raio_bench, "frame", scene, "--accel", args.accel, "--effects", effects,
         "--repeat", args.frames, "--threads", args.threads, "--json", out]
        + SAME_LIGHT_AND_LENS + ([] if check else ["--no-check"]))
    row = json.loads(out.read_text().splitlines()[0])
    return row["least_s"], row["rays"]


def peer_seconds(peer, args, scene, effects, folder):
    aa, soft_dof = EFFECTS[effects]
    # One frame more: Raio's first, which warms up, does not count.
    text = run([peer, scene, folder / "peer.ppm", args.frames + 1, *aa, args.threads, *soft_dof])
    return float(re.search(r"render_s (\S+)", text)[1]), int(re.search(r"\brays (\d+)", text)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", nargs="+", help="NFF files")
    parser.add_argument("--peer", action="append", required=True, help="a source or a program")
    parser.add_argument("--effects", default="plain,all", help="of plain, aa, all (%(default)s)")
    parser.add_argument("--runs", type=int, default=11, help="of each program (%(default)s)")
    parser.add_argument("--frames", type=int, default=5, help="in a run (%(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="(%(default)s)")
    parser.add_argument("--accel", default="auto", help="Raio's structure (%(default)s)")
    parser.add_argument("--raio-bench", default=ROOT / "build/release/bench/raio_bench")
    args = parser.parse_args()

    peers = {}
    for peer in args.peer:
        program = build(peer)
        if program:
            peers[program.stem] = program
        else:
            print(f"peers.py: {peer} is left out: it is not there", file=sys.stderr)
    ratios = {}
    print(f"{'scene':18}{'effects':9}{'Raio ms':>9}" +
          "".join(f"{name + ' ms':>20}{'ratio':>7}{'rays':>7}" for name in peers))
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for effects in args.effects.split(","):
            for scene in args.scene:
                ours, theirs = [], {name: [] for name in peers}
                for i in range(args.runs):
                    seconds, rays = raio_seconds(args, scene, effects, folder, check=i == 0)
                    ours.append(seconds)
                    for name, program in peers.items():
                        theirs[name].append(peer_seconds(program, args, scene, effects, folder))
                line = f"{pathlib.Path(scene).stem:18}{effects:9}"
                line += f"{1000 * statistics.median(ours):9.1f}"
                for name, runs in theirs.items():
                    time = statistics.median(seconds for seconds, _ in runs)
                    ratio = statistics.median(ours) / time
                    ratios.setdefault((name, effects), []).append((ratio, pathlib.Path(scene).stem))
                    line += f"{1000 * time:20.1f}{ratio:7.3f}{rays / runs[0][1]:7.3f}"
                print(line, flush=True)
    print(f"\nmedians of {args.runs} runs, each the fastest of {args.frames} frames; "
          f"rays: Raio's over the peer's")
    for (name, effects), values in ratios.items():
        mean = math.exp(statistics.fmean(math.log(ratio) for ratio, _ in values))
        worst, scene = max(values)
        print(f"Raio / {name}, {effects}: geometric mean {mean:.3f}, worst {worst:.3f} ({scene})")


if __name__ == "__main__":
    main()
