#!/usr/bin/env python3
"""A path tracer to read: the light of lessons 9 to 12, in plain Python.

    python3 docs/course/path_tracer.py scenes/course/room.nff --size 60x45 --samples 16 -o build/room.png

It adds to tracer.py what light over many bounces needs. Its pictures converge to those of `raio render
--integrator path` with the same options; the noise is its own. Each row of pixels has its own random
numbers, so the picture does not depend on the number of processes.
"""
import argparse, random, struct, sys, time
from bisect import bisect_right
from collections import namedtuple
from concurrent.futures import ProcessPoolExecutor
from itertools import accumulate
from math import asin, atan2, cos, inf, pi, sin, sqrt

sys.dont_write_bytecode = True
sys.path.append("docs/course")  # for copies of this file in other folders
from tracer import Camera, Scene, Tracer, Vec, cross, dot, length, png, reflect, refract, times, to_disc, unit

def gray(x): return Vec(x, x, x)
def brightest(c): return max(c.x, c.y, c.z)
def mean(c): return (c.x + c.y + c.z) / 3

# ---------------------------------------------------------------- microfacets: lesson 11
#
# Directions are in the frame of the normal, (0, 0, 1). `out` points to the eye, `into` to the light.

def ggx_normals(cosine, alpha):
    """The density of microfacets whose normals have this cosine, by area of the flat surface."""
    return alpha ** 2 / (pi * (cosine ** 2 * (alpha ** 2 - 1) + 1) ** 2)

def smith(cosine, alpha):
    """Lambda: how much area of hidden microfacets there is for each visible one."""
    return (sqrt(1 + alpha ** 2 * (1 / cosine ** 2 - 1)) - 1) / 2

def ggx(out, into, alpha):
    """The BSDF of white microfacets times |into.z|, and the density of directions from `ggx_sample`."""
    normals = ggx_normals(unit(out + into).z, alpha)
    seen = 1 + smith(out.z, alpha)
    return normals / (4 * out.z * (seen + smith(into.z, alpha))), normals / (4 * out.z * seen)

def ggx_sample(out, alpha, u, v):
    """The mirror direction at a random visible microfacet, after Dupuy and Benyoub 2023."""
    stretched = unit(Vec(alpha * out.x, alpha * out.y, out.z))
    z, turn = (1 - u) * (1 + stretched.z) - stretched.z, 2 * pi * v
    around = sqrt(max(0, 1 - z * z))
    cap = Vec(around * cos(turn), around * sin(turn), z) + stretched
    return reflect(-out, unit(Vec(alpha * cap.x, alpha * cap.y, cap.z)))

class LostEnergy:
    """The part of the light that single reflections of white microfacets lose, by the cosine, and on average."""
    def __init__(self, alpha, points=256, columns=32):
        self.columns, self.lost = columns, []
        for column in range(columns + 1):
            cosine = max(1e-3, (column / columns) ** 2)
            out, kept = Vec(sqrt(1 - cosine ** 2), 0, cosine), 0
            for i in range(points):
                into = ggx_sample(out, alpha, (i + 0.5) / points, i * 0.6180339887 % 1)
                if into.z > 0:
                    value, density = ggx(out, into, alpha)
                    kept += value / density / points
            self.lost.append(1 - kept)
        self.average = sum(2 * x * self.at(x) for x in ((i + 0.5) / 1000 for i in range(1000))) / 1000

    def at(self, cosine):
        column, part = divmod(self.columns * sqrt(cosine), 1)
        i = min(int(column), self.columns - 1)
        return self.lost[i] + (self.lost[i + 1] - self.lost[i]) * (part if column == i else 1)

# ---------------------------------------------------------------- surfaces: lessons 9 to 11

def fresnel(cosine, eta):
    """The part of the light that glass reflects; eta: index behind the surface / index in front."""
    k = 1 - (1 - cosine ** 2) / eta ** 2
    if k <= 0: return 1  # total internal reflection
    behind = sqrt(k)
    a, b = (eta * cosine - behind) / (eta * cosine + behind), (cosine - eta * behind) / (cosine + eta * behind)
    return (a * a + b * b) / 2

Next = namedtuple("Next", "direction weight density")  # weight: BSDF x cosine / density, which is 0 if infinite

class Surface:
    """The numbers of `f` as docs/materials.md maps them: a diffuse base, and a mirror or glass."""
    def __init__(self, color, kd, specular, ks, transmission, ior, roughness):
        scale = 1 / max(1, kd * brightest(color) + ks * brightest(specular) + transmission)
        self.diffuse, self.mirror, self.glass, self.ior = color * (kd * scale), gray(0), 0, ior or 1
        if transmission > 0 and roughness >= 1 / 32: sys.exit("this path tracer has no rough glass; raio has")
        if transmission > 0: self.glass = min((ks + transmission) * scale, 1)
        else: self.mirror = specular * (ks * scale)
        self.edge = brightest(self.mirror)
        self.alpha = min(roughness, 1) ** 2 if roughness >= 1 / 32 and self.edge else 0
        if self.alpha:
            self.lost = LostEnergy(self.alpha)
            lost = self.lost.average
            def again(f0):  # the colour of light that was reflected twice or more
                f = (20 * f0 + self.edge) / 21
                return f * f / self.edge * (1 - lost) / lost / (1 - f / self.edge * lost)
            self.again = Vec(*(again(self.mirror[c]) for c in range(3)))

    def mirrors(self, cosine):
        """Schlick's approximation of Fresnel's equations for metal."""
        return self.mirror + (gray(self.edge) - self.mirror) * (1 - cosine) ** 5

    def chances(self, out):
        """The probabilities of the lobes: cosine, mirror or microfacets, glass."""
        flat = mean(self.diffuse)
        if self.alpha: flat += mean(self.again) * self.lost.at(out.z) * self.lost.average
        total = flat + self.edge + self.glass
        return (flat / total, self.edge / total, self.glass / total) if total else (0, 0, 0)

    def evaluate(self, out, into):
        """BSDF x cosine, and the density of `sample`; of what is not sharp."""
        if into.z <= 0: return gray(0), 0
        flat, shiny, _ = self.chances(out)
        value, density = self.diffuse * (into.z / pi), flat * into.z / pi
        if self.alpha:
            single, single_density = ggx(out, into, self.alpha)
            value += self.mirrors(dot(out, unit(out + into))) * single
            value += self.again * (self.lost.at(out.z) * self.lost.at(into.z) * into.z / pi)
            density += shiny * single_density
        return value, density

    def sample(self, out, entering):
        """A random next direction: chooses a lobe, then a direction in proportion to it."""
        flat, shiny, glass = self.chances(out)
        choice, mirrored = random.random(), Vec(-out.x, -out.y, out.z)
        if choice >= flat and glass:
            eta = self.ior if entering else 1 / self.ior
            bent = refract(-out, Vec(0, 0, 1), 1 / eta)
            is_reflected = random.random() < fresnel(out.z, eta)
            return Next(mirrored if is_reflected or not bent else bent, gray(self.glass / glass), 0)
        if choice >= flat and not self.alpha:
            return Next(mirrored, self.mirrors(out.z) * (1 / shiny), 0) if shiny else None
        if choice >= flat:
            into = ggx_sample(out, self.alpha, random.random(), random.random())
        else:  # points of a disc, projected up: in proportion to the cosine
            x, y = to_disc(random.random(), random.random())
            into = Vec(x, y, sqrt(max(0, 1 - x * x - y * y)))
        value, density = self.evaluate(out, into)
        return Next(into, value * (1 / density), density) if density > 0 else None

# ---------------------------------------------------------------- scenes and environments

class PathScene(Scene):
    """NFF, and the `f` of P3F with specular colour and roughness."""
    def read(self, word, n):
        if word == "f" and len(n) == 8:
            self.material = Surface(Vec(*n[:3]), n[3], gray(1), n[4], n[6], n[7], 0)
        elif word == "f":
            self.material = Surface(Vec(*n[:3]), n[3], Vec(*n[4:7]), n[7], n[9], n[10], n[11] if n[11:] else 0)
        else:
            return super().read(word, n)
        return True

class Environment:
    """A picture of all directions, in a PFM file; cells of it are sampled in proportion to their light."""
    def __init__(self, path, up):
        with open(path, "rb") as file:
            _, size, scale = (file.readline() for _ in range(3))
            self.width, self.height = map(int, size.split())
            order = "<" if float(scale) < 0 else ">"
            numbers = struct.unpack(f"{order}{3 * self.width * self.height}f", file.read())
        rows = [numbers[i:i + 3 * self.width] for i in range(0, len(numbers), 3 * self.width)][::-1]
        self.texels = [[Vec(*row[i:i + 3]) for i in range(0, len(row), 3)] for row in rows]
        is_z = abs(up.z) > abs(up.y)
        self.up = Vec(0, 0, 1 if up.z > 0 else -1) if is_z else Vec(0, 1 if up.y > 0 else -1, 0)
        self.forward = Vec(0, 1, 0) if is_z else Vec(0, 0, -1)
        self.right = cross(self.forward, self.up)
        # Between the centres of texels the radiance is mixed, so a cell counts its neighbours' light, too.
        light = [[brightest(texel) for texel in row] for row in self.texels]
        wide = [[row[i - 1] + row[i] + row[(i + 1) % self.width] for i in range(self.width)] for row in light]
        weights = []
        for j in range(self.height):
            around = [wide[min(max(k, 0), self.height - 1)] for k in (j - 1, j, j + 1)]
            weights += [sum(three) * self.solid_angle(j) for three in zip(*around)]
        self.sums = list(accumulate(weights))

    def border(self, row): return cos(pi * row / self.height)  # the height of a row's upper edge, -1 to 1
    def solid_angle(self, row): return 2 * pi / self.width * (self.border(row) - self.border(row + 1))

    def place(self, d):
        """The column and the row of a direction."""
        column = (atan2(dot(d, self.right), dot(d, self.forward)) / (2 * pi) + 0.5) * self.width
        return column % self.width, (0.5 - asin(max(-1, min(1, dot(d, self.up)))) / pi) * self.height

    def radiance(self, d):
        column, row = self.place(d)
        i, x = divmod(column - 0.5, 1)
        j, y = divmod(row - 0.5, 1)
        def texel(i, j): return self.texels[min(max(int(j), 0), self.height - 1)][int(i) % self.width]
        above = texel(i, j) * (1 - x) + texel(i + 1, j) * x
        return above * (1 - y) + (texel(i, j + 1) * (1 - x) + texel(i + 1, j + 1) * x) * y

    def density(self, d):
        column, row = self.place(d)
        row = min(int(row), self.height - 1)
        cell = row * self.width + min(int(column), self.width - 1)
        weight = self.sums[cell] - (self.sums[cell - 1] if cell else 0)
        return weight / self.sums[-1] / self.solid_angle(row)

    def sample(self):
        cell = min(bisect_right(self.sums, random.random() * self.sums[-1]), len(self.sums) - 1)
        row, column = divmod(cell, self.width)
        top, bottom = self.border(row), self.border(row + 1)
        up = bottom + (top - bottom) * random.random()
        turn = ((column + random.random()) / self.width - 0.5) * 2 * pi
        around = sqrt(max(0, 1 - up * up))
        return self.right * (around * sin(turn)) + self.forward * (around * cos(turn)) + self.up * up

# ---------------------------------------------------------------- paths: lessons 9, 10 and 12

class PathTracer(Tracer):
    def __init__(self, scene, options):
        super().__init__(scene, options)
        self.environment = Environment(options.environment, scene.up) if options.environment else None
        # One of these is chosen at each point: lights that only shadow rays find, and the environment.
        self.choices = self.lights + [None] * (self.environment is not None and options.strategy != "bsdf")

    def surrounding(self, direction):
        return self.environment.radiance(direction) if self.environment else self.scene.background

    def share(self, of_bsdf, direction):
        """The part of the environment's light that paths collect; `direct_light` collects the rest."""
        if self.environment is None or of_bsdf == 0 or self.options.strategy == "bsdf": return 1
        if self.options.strategy == "light": return 0
        of_light = self.environment.density(direction) / len(self.choices)
        return of_bsdf / (of_bsdf + of_light)  # the balance heuristic of Veach and Guibas 1995

    def path(self, origin, direction):
        """One sample of the radiance that comes along a ray, against its direction."""
        light, weight, density = gray(0), gray(1), 0
        for level in range(1, self.options.depth + 1):
            shape, distance = self.structure.closest(origin, direction)
            if shape is None:
                return light + times(weight, self.surrounding(direction)) * self.share(density, direction)
            if level == self.options.depth: break
            point = origin + direction * distance
            flat, normal = shape.normals(point)
            entering = dot(flat, direction) < 0
            if not entering: flat, normal = -flat, -normal
            if dot(normal, direction) >= -1e-4: normal = flat
            off = flat * (2 ** -18 * (max(abs(point[a]) for a in range(3)) + shape.size))
            u = unit(cross(normal, Vec(1, 0, 0) if abs(normal.x) < 0.7 else Vec(0, 1, 0)))
            v = cross(normal, u)
            def local(d): return Vec(dot(d, u), dot(d, v), dot(d, normal))
            out, surface = local(-direction), shape.material
            out.z = max(out.z, 1e-6)
            light += times(weight, self.direct_light(surface, point + off, out, flat, local))
            step = surface.sample(out, entering)
            if step is None: break
            d = step.direction
            direction = unit(u * d.x + v * d.y + normal * d.z)
            if dot(direction, flat) * d.z <= 0: break  # a smooth normal sends it through the surface
            origin = point + off if d.z > 0 else point - off
            weight, density = times(weight, step.weight), step.density
            if level >= 4:  # Russian roulette
                chance = min(brightest(weight), 0.95)
                if random.random() >= chance: break
                weight = weight * (1 / chance)
        return light

    def direct_light(self, surface, point, out, flat, local):
        """What one randomly chosen light adds, divided by its probability."""
        if not self.choices: return gray(0)
        light = random.choice(self.choices)
        if light:  # it cannot be hit, so only shadow rays find it
            (target, edge_u, edge_v), intensity = light
            if self.options.soft_shadows:
                target = target + edge_u * (random.random() - 0.5) + edge_v * (random.random() - 0.5)
            distance = length(target - point)
            towards, arriving = (target - point) * (1 / distance), intensity * pi
        else:
            towards, distance = self.environment.sample(), inf
            arriving = self.environment.radiance(towards) * (1 / self.environment.density(towards))
        into = local(towards)
        if dot(towards, flat) <= 0 or into.z <= 0: return gray(0)
        value, of_bsdf = surface.evaluate(out, into)
        if of_bsdf == 0: return gray(0)
        hides, _ = self.structure.closest(point, towards, distance, any_will_do=True)
        if hides: return gray(0)
        share = 1 if light else 1 - self.share(of_bsdf, towards)
        return times(value, arriving) * (share * len(self.choices))

# ---------------------------------------------------------------- pictures

def prepare(options):
    """In each process: what all of its rows need."""
    global tracer, camera, width, height
    tracer = PathTracer(PathScene(options.scene), options)
    width, height = options.size or tracer.scene.resolution
    camera = Camera(tracer.scene, width, height, None, None)

def render_row(row):
    """For each pixel of a row the mean of its samples, and the variance of that mean, colour by colour."""
    options = tracer.options
    random.seed(options.seed * 65536 + row)
    n, pixels = options.samples, []
    for column in range(width):
        total, squares = gray(0), gray(0)
        for _ in range(n):
            sample = tracer.path(*camera.ray(column + random.random(), row + random.random(), None))
            total, squares = total + sample, squares + times(sample, sample)
        middle = total * (1 / n)
        pixels.append((middle, (squares * (1 / n) - times(middle, middle)) * (1 / max(1, n - 1))))
    return pixels

def render(options):
    prepare(options)
    with ProcessPoolExecutor(initializer=prepare, initargs=(options,)) as pool:
        return list(pool.map(render_row, range(height)))

def encoded(x):
    """The curve of sRGB, as a byte."""
    x = min(x, 1)
    return int(255 * (12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055) + 0.5)

def save(path, rows, exposure):
    width, height = len(rows[0]), len(rows)
    if path.lower().endswith(".pfm"):  # the numbers themselves, from the lowest row to the highest
        numbers = [mean[c] for row in reversed(rows) for mean, _ in row for c in range(3)]
        data = b"PF\n%d %d\n-1\n" % (width, height) + struct.pack(f"<{len(numbers)}f", *numbers)
    else:
        colors = [mean * 2 ** exposure for row in rows for mean, _ in row]
        data = png(width, height, bytes(encoded(color[c]) for color in colors for c in range(3)))
    with open(path, "wb") as file:
        file.write(data)

def parse(arguments=None):
    parser = argparse.ArgumentParser(description="A path tracer to read; options as in raio render")
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True, metavar="PICTURE.png")
    parser.add_argument("--size", type=lambda s: [int(n) for n in s.split("x")], metavar="WxH")
    parser.add_argument("--strategy", choices=["bsdf", "light", "mis"], default="mis",
                        help="which rays find the environment")
    parser.add_argument("--accel", choices=["none", "grid"], default="grid")
    parser.add_argument("--soft-shadows", action="store_true")
    for option, kind, default in (("--samples", int, 16), ("--depth", int, 16), ("--seed", int, 0),
                                  ("--light-size", float, None), ("--environment", str, None),
                                  ("--exposure", float, 0), ("--grid-factor", float, 2)):
        parser.add_argument(option, type=kind, default=default)
    return parser.parse_args(arguments)

def main():
    options, start = parse(), time.perf_counter()
    rows = render(options)
    save(options.output, rows, options.exposure)
    pixels = [pixel for row in rows for pixel in row]
    bright = sum(mean(color) for color, _ in pixels) / len(pixels)
    noise = sqrt(sum(mean(variance) for _, variance in pixels) / len(pixels))
    print(f"{options.output}: {time.perf_counter() - start:.1f} s, mean {bright:.4f}, noise {noise:.4f}")

if __name__ == "__main__":
    main()
