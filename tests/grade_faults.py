#!/usr/bin/env python3
"""Breaks the tracer of the course, one line at a time, and fails unless raio grade names each fault.

    tests/grade_faults.py build/release/raio
    tests/grade_faults.py build/release/raio upside-down --size 90x60
"""

import argparse
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs/course"))
import mistakes  # noqa: E402
from mistakes import Mistake  # noqa: E402

# The name of the fault, as `raio grade` prints it; see Mistake.
FAULTS = [
    Mistake("upside-down", "solids", "", "for row in range(height):", "for row in reversed(range(height)):"),
    Mistake("mirrored", "solids", "", "self.right * pixel, self.up", "self.right * -pixel, self.up"),
    Mistake("turned", "solids", "", "unit(cross(forward, scene.up))", "unit(cross(scene.up, forward))"),
    Mistake("red-blue", "solids", "", "for c in range(3))", "for c in (2, 1, 0))"),
    Mistake("gamma-2.2", "solids", "", "min(mean[c], 1) + 0.5", "min(mean[c], 1) ** (1 / 2.2) + 0.5"),
    Mistake("overflow", "solids", "", "int(255 * min(mean[c], 1) + 0.5)", "int(255 * mean[c] + 0.5) % 256"),
    Mistake("no-shadows", "solids", "", "if hides: return", "if False: return"),
    Mistake("beyond-light", "lamp", "", "closest(point, to_light, distance, any_will_do=True)",
            "closest(point, to_light, any_will_do=True)"),
    Mistake("acne", "solids", "", "shape.material, point + off, point - off", "shape.material, point, point"),
    Mistake("no-ambient", "solids", "", "scene.lights) else 0.1", "scene.lights) else 0"),
    Mistake("no-highlight", "solids", "", "highlight = m.ks *", "highlight = 0 *"),
    Mistake("full-intensity", "row", "", "white = 1 / sqrt(max(1, len(scene.lights)))", "white = 1"),
    Mistake("no-reflection", "glass", "", "if m.ks > 0:", "if False:"),
    Mistake("no-refraction", "glass", "", "if m.transmission > 0:", "if False:"),
    Mistake("inverse-index", "glass", "", "eta = 1 / m.ior if enters else m.ior",
            "eta = m.ior if enters else 1 / m.ior"),
    Mistake("depth-less", "glass", "", "if level > self.options.depth:", "if level >= self.options.depth:"),
    Mistake("no-background", "solids", "", "if shape is None: return self.scene.background",
            "if shape is None: return Vec(0, 0, 0)"),
    Mistake("corner-upper-left", "solids", "", "return (0.5, 0.5) if", "return (0, 0) if"),
    Mistake("whole-angle", "solids", "", "2 * tan(scene.angle / 2) / height", "2 * tan(scene.angle) / height"),
    Mistake("flat-normals", "../teapot", "", "self.normal, smooth if dot(smooth, self.normal) > 0 else -smooth",
            "self.normal, self.normal"),
    Mistake("long-normals", "row", "", "return (unit(point - self.center),) * 2",
            "return (point - self.center,) * 2"),
]
CORRECT = Mistake("none", "glass", "", "import argparse", "import argparse")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("raio", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--size", default="60x40")
    parser.add_argument("--folder", type=Path, help="keeps the pictures here")
    arguments = parser.parse_args()
    wrong = []

    with tempfile.TemporaryDirectory() as name:
        folder = arguments.folder or Path(name)

        def grade(fault):
            picture = folder / f"mistake-{fault.name}.png"
            command = [arguments.raio.resolve(), "grade", ROOT / f"scenes/course/{fault.scene}.nff", picture, "--json",
                       "--size", arguments.size]
            run = subprocess.run(command, text=True, capture_output=True)
            if run.returncode not in (0, 1):
                sys.exit(f"{fault.name}: {run.stderr}")
            return run.returncode, json.loads(run.stdout)

        chosen = [f for f in [*FAULTS, CORRECT] if f.name in (arguments.names or [f.name])]
        with ProcessPoolExecutor() as pool:
            list(pool.map(mistakes.render, chosen, *([x] * len(chosen) for x in (folder, arguments.size))))
        print("fault              status   RMSE    named              with it   explains")
        for fault in chosen:
            status, said = grade(fault)
            causes = said["causes"]
            named = causes[0]["name"] if causes else "none"
            line = f"{fault.name:18} {status:6} {said['errors']['rmse']:8.2f}   {named:18}"
            if causes:
                line += f"{causes[0]['rmse']:8.2f} {100 * causes[0]['share']:8.1f} %"
                line += "".join(f", then {c['name']}" for c in causes[1:])
                line += "".join(f", equals {n}" for n in causes[0]["equals"])
            print(line)
            if named != fault.name or status != (fault is not CORRECT):
                wrong.append(f"{fault.name}: raio grade named {named} and its status was {status}")
    return "\n".join(wrong) or None


sys.exit(main())
