#!/usr/bin/env python3
"""Recomputes pixels from the numbers of `raio explain --json` alone, without the scene, and fails if
one differs from that of `raio render`, a float, in its last bit.

    tests/explain_recompute.py build/release/raio
    tests/explain_recompute.py build/release/raio --pixels 1000
    tests/explain_recompute.py build/release/raio scenes/rings.nff --aa 3

The terms follow docs/shading.md and docs/explain.md, in floats, in the order stated there. The rays'
geometry is checked, too: directions, distances and the numbers of each test with a primitive.
"""

import argparse
import json
import math
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENES = [
    "scenes/sphereflake.nff --depth 3",
    "scenes/shapes.nff --aa 1 --depth 8",
    "scenes/rings.nff --aa 1 --soft-shadows",
    "scenes/gears.nff --depth 3",
    "scenes/tetra.nff --shading phong",
    "scenes/teapot.nff --aa 2",
    "scenes/mount.nff --shading blinn-phong",
    "scenes/lattice.nff --aa 1 --accel grid",
    "scenes/quadrics.nff --aa 1",
    "scenes/tree.nff",
    "scenes/billiards.p3f --aa 1 --no-dof",
    "scenes/lens.p3f --aa 1",
    "scenes/metals.p3f --aa 1",
    "scenes/yardstick.p3f --aa 1 --no-dof",
    "scenes/course/solids.nff --aa 2 --soft-shadows --dof",
    "scenes/course/glass.nff --fresnel exact",
    "scenes/course/wheel.nff --accel none",
    "scenes/course/glass.nff --aa 1 --gloss 0.1 --translucency 0.05",
]


def f32(x):
    """The nearest float. Sums, products, quotients and roots of floats, computed as doubles and then
    rounded, are those of float arithmetic."""
    return struct.unpack("f", struct.pack("f", x))[0]


def add(a, b):
    return [f32(x + y) for x, y in zip(a, b)]


def mul(a, b):
    b = b if isinstance(b, list) else [b] * 3
    return [f32(x * y) for x, y in zip(a, b)]


def dot(a, b):
    x, y, z = (f32(p * q) for p, q in zip(a, b))
    return f32(f32(x + y) + z)


def length(a):
    return f32(math.sqrt(dot(a, a)))


def normalized(a):
    return mul(a, f32(1 / length(a)))


def renormalized(a):
    """A vector of length 1, except for rounding: a step of Newton's method."""
    return mul(a, f32(1.5 - f32(0.5 * dot(a, a))))


def mirrored(direction, normal):
    return add(direction, mul(normal, -f32(2 * dot(direction, normal))))


def negative(a):
    return [-x for x in a]


def floats(value):
    """All numbers are printed so that they can be read back as the same floats."""
    if isinstance(value, list):
        return [floats(x) for x in value]
    if isinstance(value, dict):
        return {name: floats(x) for name, x in value.items()}
    return f32(value) if isinstance(value, float) else value


class Wrong(Exception):
    pass


def same(what, found, expected):
    if found != expected:
        raise Wrong(f"{what}: recomputed {expected}, printed {found}")


def close(what, found, expected, error):
    pairs = zip(found, expected) if isinstance(found, list) else [(found, expected)]
    if any(not abs(x - y) <= error for x, y in pairs):
        raise Wrong(f"{what}: recomputed {expected}, printed {found}")


class Sample:
    """One object printed by raio explain --json."""

    def __init__(self, told):
        self.told = told
        self.rays = told["rays"]
        self.unit = told["unit"]
        self.lights = floats(told["lights"])

    def color(self):
        """Exact, as the film stores it."""
        total = [0.0] * 3
        for ray in self.rays:
            same("weight", floats(ray["weight"]), self.weight(ray))
            self.check_tests(ray)
            if ray["kind"] == "shadow":
                continue
            light = self.radiance(ray) if "surface" in ray else floats(ray["terms"]["background"])
            adds = [round(x / self.unit) * self.unit for x in mul(light, self.weight(ray))]
            same("adds", ray["adds"], adds)
            total = [a + b for a, b in zip(total, adds)]
        same("rgb", self.told["rgb"], total)
        return total

    def weight(self, ray):
        if ray["parent"] is None:
            return [1.0] * 3
        parent = self.rays[ray["parent"]]
        weight, s = floats(parent["weight"]), floats(parent["surface"])
        if ray["kind"] == "shadow":
            return weight
        split = self.reflectance(parent)
        if ray["kind"] == "reflection":
            self.check_mirrored(ray, parent)
            return mul(weight, mul(s["specular"], s["ks"]) if split is None else split)
        self.check_refracted(ray, parent)
        return mul(weight, s["transmission"] if split is None else f32(1 - split))

    def radiance(self, ray):
        s = floats(ray["surface"])
        total = mul(s["color"], f32(self.told["ambient"]))
        same("ambient", floats(ray["terms"]["ambient"]), total)
        for shadow in self.rays:
            if shadow["parent"] == ray["id"] and shadow["kind"] == "shadow":
                light = self.light(shadow, ray, s)
                if not shadow["occluded"]:
                    total = add(total, light)
        same("radiance", s["radiance"], total)
        self.check_children(ray, s)
        return total

    def light(self, shadow, ray, s):
        """Diffuse and highlight of a light, if it is not occluded."""
        direction, normal = floats(shadow["direction"]), s["normal"]
        source = self.lights[shadow["light"]]
        if "sides" not in source:
            self.check_towards_light(shadow, source)
        cosine = dot(normal, direction)
        same("N.L", f32(shadow["n_dot_l"]), cosine)
        toward_eye = negative(floats(ray["direction"]))
        if "h" in shadow:
            other, base = normalized(add(direction, toward_eye)), normal
            same("H", floats(shadow["h"]), other)
        else:
            other, base = mirrored(negative(direction), normal), toward_eye
            same("R", floats(shadow["r"]), other)
        angle = dot(base, other)
        same("N.H" if "h" in shadow else "R.V", f32(shadow["n_dot_h" if "h" in shadow else "r_dot_v"]), angle)
        # The power is Raio's own; its error is below 2e-7.
        power = f32(shadow["power"])
        close("power", power, min(max(angle, 0.0), 1.0) ** s["shine"] if angle > 0 or s["shine"] == 0 else 0.0, 2e-7)
        diffuse = mul(s["color"], f32(s["kd"] * cosine))
        both = diffuse
        if s["ks"] > 0:
            both = add(diffuse, mul(s["specular"], f32(s["ks"] * power)))
        if not shadow["occluded"]:
            terms = shadow["terms"]
            same("diffuse", terms["diffuse"], mul(source["intensity"], diffuse))
            total = [a + b for a, b in zip(terms["diffuse"], terms["highlight"])]
            same("diffuse + highlight", total, mul(source["intensity"], both))
        return mul(source["intensity"], both)

    def reflectance(self, ray):
        """Kr, or None if Ks and T split the light."""
        s = floats(ray["surface"])
        if self.told["fresnel"] == "none" or not s["transmission"] > 0:
            return None
        eta = self.relative_index(s)
        before = min(max(-dot(floats(ray["direction"]), s["normal"]), 0.0), 1.0)
        squared = self.squared_behind(eta, before)
        behind = f32(math.sqrt(max(squared, 0.0)))

        def ratio(a, b):
            r = f32(f32(a - b) / max(f32(a + b), f32(1e-30)))
            return f32(r * r)

        if squared < 0:
            part = 1.0
        elif self.told["fresnel"] == "exact":
            part = f32(f32(ratio(f32(eta * before), behind) + ratio(f32(eta * behind), before)) * 0.5)
        else:
            least = ratio(eta, 1.0)
            x = f32(1 - (behind if eta > 1 else before))
            square = f32(x * x)
            part = f32(least + f32(f32(1 - least) * f32(f32(square * square) * x)))
        same("Kr", s["refraction"]["reflectance"], part)
        return part

    def relative_index(self, s):
        eta = f32(s["refraction"]["index_before"] / s["refraction"]["index_behind"])
        same("eta", s["refraction"]["eta"], eta)
        return eta

    @staticmethod
    def squared_behind(eta, cosine):
        return f32(1 - f32(f32(eta * eta) * f32(1 - f32(cosine * cosine))))

    # The rays' geometry.

    def check_mirrored(self, ray, parent):
        s = floats(parent["surface"])
        expected = renormalized(mirrored(floats(parent["direction"]), s["mirror_normal"]))
        if s["gloss"] > 0:
            if dot(floats(ray["direction"]), s["geometric_normal"]) < 0:
                raise Wrong("a rough mirror sends its ray through the surface")
        else:
            same("mirrored direction", floats(ray["direction"]), expected)

    def check_refracted(self, ray, parent):
        s, into = floats(parent["surface"]), floats(parent["direction"])
        bend, eta = s["refraction"], self.relative_index(s)
        cosine = -dot(into, bend["normal"])
        same("cosine", bend["cosine"], cosine)
        squared = self.squared_behind(eta, cosine)
        same("squared cosine", bend["cosine2_behind"], squared)
        if squared < 0:
            raise Wrong("a ray is refracted despite total internal reflection")
        along = f32(f32(eta * cosine) - f32(math.sqrt(squared)))
        if s["translucency"] == 0:
            expected = renormalized(add(mul(into, eta), mul(bend["normal"], along)))
            same("refracted direction", floats(ray["direction"]), expected)

    def check_children(self, ray, s):
        kinds = [other["kind"] for other in self.rays if other["parent"] == ray["id"]]
        split = self.reflectance(ray)
        mirrors = s["ks"] > 0 if split is None else split > 0
        same("reflected rays", kinds.count("reflection"), int(mirrors and max(s["specular"]) > 0))
        passes = s["transmission"] > 0 and s["refraction"]["cosine2_behind"] >= 0
        same("refracted rays", kinds.count("refraction"), int(passes))

    @staticmethod
    def check_towards_light(shadow, source):
        to_light = add(source["position"], negative(floats(shadow["origin"])))
        distance = length(to_light)
        same("L", floats(shadow["direction"]), mul(to_light, f32(1 / distance)))
        same("tmax", f32(shadow["tmax"]), f32(distance * f32(1 - 4 * 2.0**-23)))

    @staticmethod
    def check_tests(ray):
        """The numbers of the tests with spheres and triangles give their distances."""
        nearest = None
        for test in ray.get("tests", []):
            if test.get("repeated"):
                continue
            v, kind = test["values"], test["primitive"]["kind"]
            if kind == "triangle":
                (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (floats(v[corner]) for corner in "ABC")
                u = f32(f32(cx * by) - f32(cy * bx))
                w = f32(f32(bx * ay) - f32(by * ax))
                mid = f32(f32(ax * cy) - f32(ay * cx))
                same("U, V, W", floats([v["U"], v["V"], v["W"]]), [u, mid, w])
                inside = not (min(u, mid, w) < 0 < max(u, mid, w))
                det = f32(f32(u + mid) + w)
                if test["t"] is not None:
                    t = f32(f32(f32(f32(u * az) + f32(mid * bz)) + f32(w * cz)) / det)
                    same("inside", inside, True)
                    same("t", f32(test["t"]), t)
            elif kind == "sphere" and test["t"] is not None:
                m, h = f32(v["m"]), f32(math.sqrt(f32(v["h^2"])))
                if f32(test["t"]) not in (f32(m - h), f32(m + h)):
                    raise Wrong(f"t of a sphere: {test['t']}, m {m}, h {h}")
            if test["t"] is not None and "t" in v:
                same("t of a test", f32(test["t"]), f32(v["t"]))
            if test["nearest"]:
                nearest = test
        if ray["kind"] != "shadow" and ray.get("tests"):
            same("hit", nearest and nearest["t"], ray["t"])


def read_pfm(path):
    data = path.read_bytes()
    head = data.split(maxsplit=4)[:4]
    width, height = int(head[1]), int(head[2])
    pixels = data[-12 * width * height:]
    order = "<" if float(head[3]) < 0 else ">"

    def at(x, y):
        return list(struct.unpack_from(order + "3f", pixels, 12 * ((height - 1 - y) * width + x)))

    return width, height, at


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("raio", type=Path)
    parser.add_argument("scene", nargs="?", help="instead of the default ones; further options are Raio's")
    parser.add_argument("--pixels", type=int, default=54, help="of all scenes together")
    parser.add_argument("--seed", type=int, default=1)
    arguments, options = parser.parse_known_args()
    raio = arguments.raio.resolve()
    scenes = [[arguments.scene, *options]] if arguments.scene else [line.split() for line in SCENES]
    chosen = random.Random(arguments.seed)
    faults, done, rays = [], 0, 0

    def run(*command):
        return subprocess.run(list(map(str, command)), cwd=ROOT, check=True, capture_output=True, text=True).stdout

    with tempfile.TemporaryDirectory() as name:
        picture = Path(name) / "picture.pfm"
        for number, scene in enumerate(scenes):
            options = [*scene, "--size", "80x60"]
            run(raio, "render", "--quiet", *options, "-o", picture)
            width, height, at = read_pfm(picture)
            count = arguments.pixels * (number + 1) // len(scenes) - arguments.pixels * number // len(scenes)
            equal = 0
            for _ in range(count):
                x, y = chosen.randrange(width), chosen.randrange(height)
                try:
                    total, sample, samples = [0.0] * 3, 0, 1
                    while sample < samples:
                        told = json.loads(run(raio, "explain", *options, "--pixel", f"{x},{y}", "--sample", sample,
                                              "--json"))
                        color = Sample(told).color()
                        total = [a + b for a, b in zip(total, color)]
                        samples, sample, rays = told["samples"], sample + 1, rays + len(told["rays"])
                    same("pixel", at(x, y), [f32(c / samples) for c in total])
                    equal += 1
                except Wrong as fault:
                    faults.append(f"{' '.join(scene)}: pixel {x},{y}: {fault}")
            print(f"{' '.join(scene):60} {equal} of {count} pixels equal")
            done += equal
    print(f"{done} pixels recomputed, {rays} rays")
    if faults:
        sys.exit("\n".join(faults[:20]))


if __name__ == "__main__":
    main()
