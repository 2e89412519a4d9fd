#!/usr/bin/env python3
"""Renders scenes with common mistakes, each a changed line of tracer.py, as PNG pictures in a folder.

    python3 docs/course/mistakes.py build
    python3 docs/course/mistakes.py build acne bands --size 90x60

Each picture is mistake-NAME.png; docs/course.md shows them beside Raio's.
"""
import argparse, contextlib, io, sys
from collections import namedtuple
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

TRACER = Path(__file__).with_name("tracer.py")

# The name, the scene in scenes/course/ and its options, the line's part that is right, and the wrong one.
Mistake = namedtuple("Mistake", "name scene options right wrong")
MISTAKES = [
    Mistake("acne", "solids", "",
            "shape.material, point + off, point - off",
            "shape.material, point, point"),
    Mistake("overflow", "solids", "",
            "int(255 * min(mean[c], 1) + 0.5)",
            "int(255 * mean[c] + 0.5) % 256"),
    Mistake("beyond", "lamp", "",
            "closest(point, to_light, distance, any_will_do=True)",
            "closest(point, to_light, any_will_do=True)"),
    Mistake("normals", "row", "",
            "return (unit(point - self.center),) * 2",
            "return (point - self.center,) * 2"),
    Mistake("outside", "glass", "",
            "self.radiance(inside, bent,",
            "self.radiance(outside, bent,"),
    Mistake("eta", "glass", "",
            "eta = 1 / m.ior if enters else m.ior",
            "eta = m.ior if enters else 1 / m.ior"),
    Mistake("bands", "solids", "--aa 2 --soft-shadows --light-size 3",
            "return (column + random.random()) / self.n, (row + random.random()) / self.n",
            "return (column + 0) / self.n, (row + 0) / self.n"),
    Mistake("focus", "row", "--aa 2 --dof --aperture 0.15",
            "unit(towards * self.focus - offset)",
            "unit(towards)"),
    Mistake("early", "solids", "",
            "if limit <= leaves or found and any_will_do: break",
            "if found: break"),
    Mistake("cells", "solids", "",
            "ends = [(self.cell_at(lo[a] - pad, a), self.cell_at(hi[a] + pad, a)) for a in range(3)]",
            "ends = [[self.cell_at((lo[a] + hi[a]) / 2, a)] * 2 for a in range(3)]"),
]

def render(mistake, folder, size):
    source = TRACER.read_text(encoding="utf-8")
    assert source.count(mistake.right) == 1, f"{mistake.name}: tracer.py has this line no longer"
    tracer = {"__name__": "tracer"}
    exec(compile(source.replace(mistake.right, mistake.wrong), TRACER, "exec"), tracer)
    picture = folder / f"mistake-{mistake.name}.png"
    scene = TRACER.parents[2] / f"scenes/course/{mistake.scene}.nff"
    sys.argv = ["tracer.py", str(scene), *mistake.options.split(), "--size", size, "-o", str(picture)]
    with contextlib.redirect_stdout(io.StringIO()) as said:
        tracer["main"]()
    return said.getvalue().strip()

def main():
    parser = argparse.ArgumentParser(description="Renders scenes with common mistakes")
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help="(default: all)")
    parser.add_argument("--size", default="180x120", metavar="WxH")
    arguments = parser.parse_args()
    known = [mistake.name for mistake in MISTAKES]
    for name in arguments.names:
        if name not in known:
            parser.error(f"no mistake has the name {name}; there are {', '.join(known)}")
    with ProcessPoolExecutor() as pool:
        for said in pool.map(render, *zip(*((m, arguments.folder, arguments.size) for m in MISTAKES
                                            if m.name in (arguments.names or known)))):
            print(said)

if __name__ == "__main__":
    main()
