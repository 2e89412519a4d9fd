#!/usr/bin/env python3
"""A ray tracer to read: Whitted's shading for NFF scenes, in plain Python.

    python3 docs/course/tracer.py scenes/course/solids.nff --size 120x90 -o build/solids.png

With one ray per pixel its picture is that of `raio render` with the same options, but for at most
one pixel in a thousand. With antialiasing, soft shadows or depth of field its random points are its
own, and so is the noise. The lessons beside this file explain each part.
"""
import argparse, random, re, struct, sys, time, zlib
from collections import Counter, defaultdict, namedtuple
from itertools import product
from math import cos, inf, pi, radians, sin, sqrt, tan

# ---------------------------------------------------------------- vectors: lesson 1

class Vec:
    """Three numbers: a point, a direction or a colour (red, green, blue)."""
    __slots__ = "x", "y", "z"

    def __init__(self, x, y, z): self.x, self.y, self.z = x, y, z
    def __add__(a, b): return Vec(a.x + b.x, a.y + b.y, a.z + b.z)
    def __sub__(a, b): return Vec(a.x - b.x, a.y - b.y, a.z - b.z)
    def __mul__(a, k): return Vec(a.x * k, a.y * k, a.z * k)
    def __neg__(a): return Vec(-a.x, -a.y, -a.z)
    def __getitem__(a, axis): return (a.x, a.y, a.z)[axis]

def dot(a, b): return a.x * b.x + a.y * b.y + a.z * b.z
def cross(a, b): return Vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
def length(a): return sqrt(dot(a, a))
def unit(a): return a * (1 / length(a))
def times(a, b): return Vec(a.x * b.x, a.y * b.y, a.z * b.z)  # colour by colour
def box_around(points): return [[f(p[a] for p in points) for a in range(3)] for f in (min, max)]

# ---------------------------------------------------------------- shapes: lesson 2
#
# hit(origin, direction): the distance along the ray, whose direction has length 1, to the shape;
#     infinity if there is nothing in front of the origin
# normals(point): the unit normal of the surface, and the one to shade it with
# box(): the lowest and the highest corner of a box around the shape
# size: about how large it is

class Sphere:
    def __init__(self, center, radius, material):
        self.center, self.radius, self.material, self.size = center, radius, material, radius

    def hit(self, origin, direction):
        to_center = self.center - origin
        middle = dot(to_center, direction)  # the ray's point nearest to the centre
        across = to_center - direction * middle
        d2 = self.radius ** 2 - dot(across, across)  # half of the chord, squared
        if d2 < 0: return inf
        enters, leaves = middle - sqrt(d2), middle + sqrt(d2)
        return enters if enters > 0 else leaves if leaves > 0 else inf

    def normals(self, point):
        return (unit(point - self.center),) * 2

    def box(self):
        r = Vec(self.radius, self.radius, self.radius)
        return box_around([self.center - r, self.center + r])

class Triangle:
    def __init__(self, corners, material, corner_normals=None):
        self.corners, self.material, self.corner_normals = corners, material, corner_normals
        self.edge1, self.edge2 = corners[1] - corners[0], corners[2] - corners[0]
        self.normal = unit(cross(self.edge1, self.edge2))
        self.size = 2 * max(abs(edge[a]) for edge in (self.edge1, self.edge2) for a in range(3))

    def hit(self, origin, direction):
        """Möller and Trumbore: solves origin + t direction = corner + b1 edge1 + b2 edge2."""
        p = cross(direction, self.edge2)
        determinant = dot(self.edge1, p)
        if determinant == 0: return inf  # the ray is parallel to the triangle
        from_corner = origin - self.corners[0]
        b1 = dot(from_corner, p) / determinant
        if b1 < 0 or b1 > 1: return inf
        q = cross(from_corner, self.edge1)
        b2 = dot(direction, q) / determinant
        if b2 < 0 or b1 + b2 > 1: return inf
        t = dot(self.edge2, q) / determinant
        return t if t > 0 else inf

    def normals(self, point):
        """Smooth triangles mix the normals of their corners by the barycentric weights."""
        if not self.corner_normals:
            return self.normal, self.normal
        from_corner, area = point - self.corners[0], length(cross(self.edge1, self.edge2))
        b1 = dot(cross(from_corner, self.edge2), self.normal) / area
        b2 = dot(cross(self.edge1, from_corner), self.normal) / area
        n0, n1, n2 = self.corner_normals
        smooth = unit(n0 * (1 - b1 - b2) + n1 * b1 + n2 * b2)
        return self.normal, smooth if dot(smooth, self.normal) > 0 else -smooth

    def box(self): return box_around(self.corners)

class Polygon:
    """Flat, of any number of corners, convex or concave."""
    def __init__(self, corners, material):
        self.corners, self.material = corners, material
        normal = Vec(0, 0, 0)  # Newell's sum, which concave corners do not mislead
        for a, b in zip(corners, corners[1:] + corners[:1]):
            normal += cross(a - corners[0], b - corners[0])
        self.normal = unit(normal)
        # Seen along the axis nearest to its normal it is largest: the other two coordinates count.
        self.u, self.v = sorted(range(3), key=lambda axis: abs(self.normal[axis]))[:2]
        outline = [(c[self.u], c[self.v]) for c in corners]
        self.edges = list(zip(outline, outline[1:] + outline[:1]))
        self.size = 2 * max(abs(c[a] - corners[0][a]) for c in corners for a in range(3))

    def hit(self, origin, direction):
        cosine = dot(direction, self.normal)
        t = dot(self.corners[0] - origin, self.normal) / cosine if cosine else inf
        if not 0 < t < inf: return inf
        point = origin + direction * t
        u, v = point[self.u], point[self.v]
        inside = False  # is the number of edges to the right of the point odd?
        for (u0, v0), (u1, v1) in self.edges:
            if (v0 > v) != (v1 > v) and u < u0 + (u1 - u0) * (v - v0) / (v1 - v0):
                inside = not inside
        return t if inside else inf

    def normals(self, point): return self.normal, self.normal
    def box(self): return box_around(self.corners)

# ---------------------------------------------------------------- scene files

Material = namedtuple("Material", "color kd ks shine transmission ior")  # the numbers of `f`

class Scene:
    """What an NFF file says: words, each followed by its numbers; # begins a comment."""
    def __init__(self, path):
        self.background, self.resolution = Vec(0, 0, 0), (512, 512)
        self.lights, self.shapes = [], []
        with open(path, encoding="ascii") as file:
            words = re.sub("#.*", "", file.read()).split()
        starts = [i for i, word in enumerate(words) if word[0].isalpha()]
        for i, end in zip(starts, starts[1:] + [len(words)]):
            if not self.read(words[i], [float(x) for x in words[i + 1:end]]):
                sys.exit(f"{path}: this tracer has no '{' '.join(words[i:end])}'; raio may have")

    def read(self, word, n):
        def points(first, stride=3): return [Vec(*n[i:i + 3]) for i in range(first, len(n), stride)]
        match word:
            case "v" | "hither": pass
            case "from": self.eye = Vec(*n)
            case "at": self.at = Vec(*n)
            case "up": self.up = Vec(*n)
            case "angle": self.angle = radians(n[0])
            case "resolution": self.resolution = int(n[0]), int(n[1])
            case "b": self.background = Vec(*n)
            case "l": self.lights.append((Vec(*n[:3]), Vec(*n[3:]) if n[3:] else None))
            case "f": self.material = Material(Vec(*n[:3]), *n[3:])
            case "s" if n[3] > 0: self.shapes.append(Sphere(Vec(*n[:3]), n[3], self.material))
            case "p" if n[0] == 3: self.shapes.append(Triangle(points(1), self.material))
            case "p": self.shapes.append(Polygon(points(1), self.material))
            case "pp":  # a fan of smooth triangles, for convex outlines
                corners, normals = points(1, 6), [unit(normal) for normal in points(4, 6)]
                for three in [(0, i, i + 1) for i in range(1, len(corners) - 1)]:
                    self.shapes.append(Triangle([corners[i] for i in three], self.material,
                                                [normals[i] for i in three]))
            case _: return False
        return True

# ---------------------------------------------------------------- brute force and a grid: lesson 8

class BruteForce:
    def __init__(self, shapes): self.shapes, self.counts = shapes, Counter()

    def cells(self, origin, direction):
        """For each cell along the ray its list of shapes, and where the ray leaves it."""
        yield self.shapes, inf

    def closest(self, origin, direction, limit=inf, any_will_do=False):
        """The first shape along the ray, if it is nearer than `limit`, and its distance."""
        found = None
        for shapes, leaves in self.cells(origin, direction):
            self.counts["steps"] += 1
            self.counts["tests"] += len(shapes)
            for shape in shapes:
                t = shape.hit(origin, direction)
                if t < limit:
                    limit, found = t, shape
            # What lies in a later cell may be hidden by something nearer there.
            if limit <= leaves or found and any_will_do: break
        return found, limit

class Grid(BruteForce):
    """Equal cells over the scene, each with the list of the shapes whose boxes touch it."""
    def __init__(self, shapes, factor):
        super().__init__(shapes)
        lo, hi = box_around([corner for shape in shapes for corner in shape.box()])
        pad = 1e-6 * max(abs(x) for x in lo + hi)  # also gives a flat scene a thickness
        self.lo, self.hi = [x - pad for x in lo], [x + pad for x in hi]
        size = [high - low for low, high in zip(self.lo, self.hi)]
        side = (size[0] * size[1] * size[2] / len(shapes)) ** (1 / 3)  # of a shape's share of space
        self.n = [min(100, int(factor * s / side) + 1) for s in size]
        self.width = [s / n for s, n in zip(size, self.n)]
        self.lists = defaultdict(list)
        for shape in shapes:
            lo, hi = shape.box()
            ends = [(self.cell_at(lo[a] - pad, a), self.cell_at(hi[a] + pad, a)) for a in range(3)]
            for cell in product(*(range(first, last + 1) for first, last in ends)):
                self.lists[cell].append(shape)

    def cell_at(self, x, axis):
        return min(max(int((x - self.lo[axis]) / self.width[axis]), 0), self.n[axis] - 1)

    def cells(self, origin, direction):
        """Amanatides and Woo: the next cell lies behind the nearest of three planes."""
        enters, leaves = 0, inf
        for a in range(3):
            if direction[a]:
                ends = [(x - origin[a]) / direction[a] for x in (self.lo[a], self.hi[a])]
                enters, leaves = max(enters, min(ends)), min(leaves, max(ends))
            elif not self.lo[a] < origin[a] < self.hi[a]: return
        if enters > leaves: return
        point = origin + direction * enters
        cell = [self.cell_at(point[a], a) for a in range(3)]
        step, to_plane, per_cell = [0, 0, 0], [inf, inf, inf], [inf, inf, inf]
        for a in range(3):
            if direction[a]:
                step[a] = 1 if direction[a] > 0 else -1
                plane = self.lo[a] + self.width[a] * (cell[a] + (step[a] > 0))
                to_plane[a] = (plane - origin[a]) / direction[a]
                per_cell[a] = self.width[a] / abs(direction[a])
        while True:
            axis = to_plane.index(min(to_plane))
            yield self.lists.get(tuple(cell), ()), to_plane[axis]
            cell[axis] += step[axis]
            if not 0 <= cell[axis] < self.n[axis]: return
            to_plane[axis] += per_cell[axis]

# ---------------------------------------------------------------- samples: lessons 5, 6 and 7

class Samples:
    """The random points of one pixel: each square is cut into n x n cells, one point in each."""
    def __init__(self, n): self.n, self.orders, self.sample = n, {}, 0

    def in_pixel(self): return (0.5, 0.5) if self.n == 1 else self.in_cell(self.sample)

    def in_square(self, purpose):
        """The cells of another square are taken in a random order of its own."""
        if purpose not in self.orders:
            self.orders[purpose] = random.sample(range(self.n ** 2), self.n ** 2)
        return self.in_cell(self.orders[purpose][self.sample])

    def in_cell(self, cell):
        row, column = divmod(cell, self.n)
        return (column + random.random()) / self.n, (row + random.random()) / self.n

def to_disc(u, v):
    """Shirley and Chiu: squares around the middle become circles, and areas stay in proportion."""
    a, b = 2 * u - 1, 2 * v - 1
    if abs(a) > abs(b):
        return a * cos(pi / 4 * b / a), a * sin(pi / 4 * b / a)
    return (b * sin(pi / 4 * a / b), b * cos(pi / 4 * a / b)) if b else (0, 0)

# ---------------------------------------------------------------- the camera: lessons 1 and 7

class Camera:
    def __init__(self, scene, width, height, aperture, focus):
        self.eye = scene.eye
        forward = unit(scene.at - scene.eye)
        self.right = unit(cross(forward, scene.up))
        self.up = cross(self.right, forward)
        self.focus = focus or length(scene.at - scene.eye)
        self.aperture = aperture or self.focus / 50
        pixel = 2 * tan(scene.angle / 2) / height  # on the plane at distance 1
        self.across, self.down = self.right * pixel, self.up * -pixel
        self.corner = forward - self.across * (width / 2) - self.down * (height / 2)

    def ray(self, x, y, lens):
        """Through (x, y), in pixels from the upper left corner of the picture."""
        towards = self.corner + self.across * x + self.down * y
        if lens is None:
            return self.eye, unit(towards)
        offset = (self.right * lens[0] + self.up * lens[1]) * self.aperture
        return self.eye + offset, unit(towards * self.focus - offset)

# ---------------------------------------------------------------- shading: lessons 3, 4 and 6

def reflect(d, n): return d - n * (2 * dot(d, n))

def refract(d, n, eta):
    """Snell's law; None at total internal reflection."""
    cosine = -dot(d, n)
    k = 1 - eta * eta * (1 - cosine * cosine)
    return unit(d * eta + n * (eta * cosine - sqrt(k))) if k >= 0 else None

class Tracer:
    def __init__(self, scene, options):
        self.scene, self.options = scene, options
        self.structure = (Grid(scene.shapes, options.grid_factor) if options.accel == "grid"
                          else BruteForce(scene.shapes))
        white = 1 / sqrt(max(1, len(scene.lights)))
        self.ambient = 0 if any(color for _, color in scene.lights) else 0.1
        self.lights = [(self.light_square(position), color or Vec(white, white, white))
                       for position, color in scene.lights]
        self.rays = Counter()

    def light_square(self, position):
        """The light, and for soft shadows the edges of a square that faces the point `at`."""
        normal = unit(self.scene.at - position)
        side = self.options.light_size or 0.1 * length(self.scene.at - position)
        sign = 1 if normal.z >= 0 else -1  # two edges across the normal, by Duff et al. 2017
        a = -normal.x / (sign + normal.z)
        u = Vec(1 + sign * normal.x * a, sign * normal.y * a, -sign * normal.x)
        return position, u * side, cross(normal, u) * side

    def radiance(self, origin, direction, level, samples, kind="eye"):
        """The colour that comes along a ray, against its direction."""
        if level > self.options.depth: return self.scene.background
        self.rays[kind] += 1
        shape, distance = self.structure.closest(origin, direction)
        if shape is None: return self.scene.background
        point = origin + direction * distance
        flat, normal = shape.normals(point)
        enters = dot(flat, direction) < 0
        if not enters:  # normals on the side that the ray comes from
            flat, normal = -flat, -normal
        # Rays start a little off the surface: rounding may have put the point behind it.
        off = flat * (2 ** -18 * (max(abs(point[a]) for a in range(3)) + shape.size))
        m, outside, inside = shape.material, point + off, point - off
        color = m.color * self.ambient
        for light in range(len(self.lights)):
            color += self.direct(light, outside, direction, flat, normal, m, samples)
        if m.ks > 0:
            mirrored = reflect(direction, normal)
            if dot(mirrored, flat) <= 0:  # a smooth normal sends it through the surface
                mirrored = reflect(direction, flat)
            color += self.radiance(outside, mirrored, level + 1, samples, "reflected") * m.ks
        if m.transmission > 0:
            eta = 1 / m.ior if enters else m.ior  # index left / index entered
            bent = refract(direction, normal, eta)
            if bent and dot(bent, flat) >= 0:  # or keeps it from going through
                bent = refract(direction, flat, eta)
            if bent:
                beyond = self.radiance(inside, bent, level + 1, samples, "refracted")
                color += beyond * m.transmission
        return color

    def direct(self, light, point, direction, flat, normal, m, samples):
        """What a light adds, by Phong, if nothing stands in its way."""
        (target, edge_u, edge_v), intensity = self.lights[light]
        if self.options.soft_shadows:
            u, v = samples.in_square(light)
            target += edge_u * (u - 0.5) + edge_v * (v - 0.5)
        distance = length(target - point)
        to_light = (target - point) * (1 / distance)
        cosine = dot(normal, to_light)
        if cosine <= 0 or dot(flat, to_light) <= 0: return Vec(0, 0, 0)
        self.rays["shadow"] += 1
        hides, _ = self.structure.closest(point, to_light, distance, any_will_do=True)
        if hides: return Vec(0, 0, 0)
        highlight = m.ks * max(0, -dot(reflect(-to_light, normal), direction)) ** m.shine
        return times(intensity, m.color * (m.kd * cosine) + Vec(highlight, highlight, highlight))

# ---------------------------------------------------------------- pictures

def png(width, height, pixels):
    """Rows of red, green and blue bytes as a file of chunks; the 0 before a row says: no filter."""
    rows = b"".join(b"\0" + pixels[i:i + 3 * width] for i in range(0, len(pixels), 3 * width))
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))

def render(scene, options):
    width, height = options.size or scene.resolution
    tracer = Tracer(scene, options)
    camera = Camera(scene, width, height, options.aperture, options.focus)
    pixels = bytearray()
    for row in range(height):
        for column in range(width):
            samples, total = Samples(options.aa), Vec(0, 0, 0)
            for samples.sample in range(options.aa ** 2):
                x, y = samples.in_pixel()
                lens = to_disc(*samples.in_square("lens")) if options.dof else None
                total += tracer.radiance(*camera.ray(column + x, row + y, lens), 1, samples)
            mean = total * (1 / options.aa ** 2)
            pixels += bytes(int(255 * min(mean[c], 1) + 0.5) for c in range(3))
    with open(options.output, "wb") as file:
        is_png = options.output.lower().endswith(".png")
        file.write(png(width, height, pixels) if is_png else b"P6 %d %d 255\n" % (width, height) + pixels)
    return tracer

def main():
    parser = argparse.ArgumentParser(description="A ray tracer to read; options as in raio render")
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True, metavar="PICTURE.png")
    parser.add_argument("--size", type=lambda s: [int(n) for n in s.split("x")], metavar="WxH")
    parser.add_argument("--accel", choices=["none", "grid"], default="grid")
    for switch in "--soft-shadows", "--dof":
        parser.add_argument(switch, action="store_true")
    for option, kind, default in (("--aa", int, 1), ("--depth", int, 5), ("--seed", int, 0),
                                  ("--light-size", float, None), ("--aperture", float, None),
                                  ("--focus", float, None), ("--grid-factor", float, 2)):
        parser.add_argument(option, type=kind, default=default)
    options = parser.parse_args()
    if not options.output.lower().endswith((".png", ".ppm")):
        parser.error(f"{options.output}: this tracer writes PNG and PPM; expected a name that ends in .png or .ppm")
    random.seed(options.seed)
    start = time.perf_counter()
    tracer = render(Scene(options.scene), options)
    seconds, rays, counts = time.perf_counter() - start, tracer.rays, tracer.structure.counts
    print(f"{options.output}: {seconds:.1f} s, {rays.total()} rays {dict(rays)}, tests per ray",
          f"{counts['tests'] / rays.total():.2f}, steps {counts['steps'] / rays.total():.2f}")

if __name__ == "__main__":
    main()
