#!/usr/bin/env python3
"""Compares Raio with PyMOL, OVITO and POV-Ray on a figure of a molecule: seconds, memory, pictures.

    bench/molecules.py [--style space-filling|ball-and-stick] [--size WxH] [--keep FOLDER] FILE

Each program reads the file (PDB), fits the camera and draws it on white by its own means for figures: PyMOL's ray
tracer with its defaults; OVITO's Tachyon with its defaults (12 samples, 12 occlusion rays); POV-Ray, with its
antialiasing, the scene that `raio convert` writes; Raio with its defaults, with the samples of OVITO, and with 4 and 1.
Runs alternate; the results are the median seconds of whole processes and the largest memory. Missing programs are
skipped. OVITO is a module of the Python given by --python. --keep stores the pictures in a folder."""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PYMOL = """load {file}, m
hide everything
{show}
bg_color white
set ray_opaque_background, 1
orient m
ray {width}, {height}
png {out}
"""
PYMOL_SHOW = {
    "space-filling": "show spheres",
    "ball-and-stick": "show sticks\nshow spheres\nset sphere_scale, 0.25\nset stick_radius, 0.15",
}
OVITO = """
import sys
from ovito.io import import_file
from ovito.modifiers import CreateBondsModifier
from ovito.vis import TachyonRenderer, Viewport
pipeline = import_file({file!r})
if {style!r} == "ball-and-stick":
    pipeline.modifiers.append(CreateBondsModifier(mode=CreateBondsModifier.Mode.VdWRadius))
    pipeline.compute().particles.vis.scaling = 0.5
else:
    def van_der_waals(frame, data):
        types = data.particles_.particle_types_
        for t in types.types:
            types.type_by_id_(t.id).radius = t.vdw_radius
    pipeline.modifiers.append(van_der_waals)
if pipeline.source.data.cell:
    pipeline.source.data.cell_.vis.enabled = False
pipeline.add_to_scene()
viewport = Viewport(type=Viewport.Type.Perspective, camera_dir=(2, 1, -1))
viewport.zoom_all(size=({width}, {height}))
viewport.render_image(size=({width}, {height}), filename={out!r}, renderer=TachyonRenderer(), background=(1, 1, 1))
"""


def commands(args, folder):
    """By program: the timed commands of its figure."""
    width, height = args.size.split("x")
    names = dict(file=str(args.file), style=args.style, width=width, height=height)
    script = folder / "draw-pymol.pml"
    script.write_text(PYMOL.format(**names, show=PYMOL_SHOW[args.style], out=folder / "pymol.png"))
    ovito = folder / "draw-ovito.py"
    ovito.write_text(OVITO.format(**names, out=str(folder / "ovito.png")))
    raio = [args.raio, "render", args.file, "--style", args.style, "--size", args.size, "--quiet"]
    return {
        "raio": [raio + ["-o", folder / "raio.png"]],
        "raio, 12 samples": [raio + ["--samples", 12, "--occlusion-rays", 12, "-o", folder / "raio-12.png"]],
        "raio, 4 samples": [raio + ["--samples", 4, "--occlusion-rays", 1, "-o", folder / "raio-4.png"]],
        "pymol": [["pymol", "-cq", script]],
        "ovito": [[args.python, ovito]],
        "povray": [[args.raio, "convert", args.file, "--style", args.style, folder / "molecule.pov"],
                   ["povray", f"+I{folder / 'molecule.pov'}", f"+O{folder / 'povray.png'}", f"+W{width}",
                    f"+H{height}", "+A0.1", "-D"]],
    }


def run(command, log):
    """Seconds and peak bytes of a process; None if it is missing or fails; see the log."""
    start = time.monotonic()
    try:
        process = subprocess.Popen([str(c) for c in command], stdout=log, stderr=log)
    except FileNotFoundError:
        return None
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return (time.monotonic() - start, usage.ru_maxrss * 1024) if process.returncode == 0 else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=lambda p: pathlib.Path(p).resolve(), metavar="FILE")
    parser.add_argument("--style", choices=PYMOL_SHOW, default="space-filling")
    parser.add_argument("--size", default="1280x960", metavar="WxH")
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs of each (default: 3)")
    parser.add_argument("--raio", default=ROOT / "build/release/raio", metavar="PROGRAM")
    parser.add_argument("--python", default=sys.executable, metavar="PROGRAM", help="with the module ovito")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep.resolve() if args.keep else pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        programs, runs = commands(args, folder), {}
        with open(folder / "log.txt", "w") as log:
            for _ in range(args.repeat):
                for name, steps in programs.items():
                    runs.setdefault(name, []).append([run(step, log) for step in steps])
        print(f"{args.file.name}, {args.style}, {args.size}: median of {args.repeat}")
        for name, all_runs in runs.items():
            if any(step is None for steps in all_runs for step in steps):
                print(f"  {name:18} did not run; log.txt of --keep says why")
                continue
            seconds = statistics.median(sum(s for s, _ in steps) for steps in all_runs)
            memory = max(bytes_ for steps in all_runs for _, bytes_ in steps)
            print(f"  {name:18} {seconds:8.2f} s {memory / 1e6:8.0f} MB")


if __name__ == "__main__":
    main()
