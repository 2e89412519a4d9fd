#!/usr/bin/env python3
"""Draws the diagrams of the lessons, SVG files, into a folder.

    python3 docs/course/figures.py docs/pictures/course
"""
import sys
from math import cos, radians, sin, sqrt, tan
from pathlib import Path

sys.dont_write_bytecode = True
from tracer import Grid, Sphere, Vec, reflect, refract, unit

BLUE, RED, GREY, GREEN, YELLOW = "#1f5fa8", "#c0392b", "#8a8a8a", "#2e7d4f", "#f4d35e"

class Drawing:
    """x to the right, y up, in units of `scale` pixels; (0, 0) is the lower left corner."""
    def __init__(self, width, height, scale):
        self.width, self.height, self.scale, self.parts = width * scale, height * scale, scale, []

    def at(self, x, y): return x * self.scale, self.height - y * self.scale

    def line(self, a, b, color=GREY, width=1.5, dashed=False):
        (x0, y0), (x1, y1) = self.at(*a), self.at(*b)
        dashes = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" '
                          f'stroke="{color}" stroke-width="{width}"{dashes}/>')

    def arrow(self, a, b, color=BLUE, label="", dx=0.1, dy=0.1):
        self.line(a, b, color, 2)
        (x0, y0), (x1, y1) = self.at(*a), self.at(*b)
        length = sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        u, v = 9 * (x1 - x0) / length, 9 * (y1 - y0) / length
        self.parts.append(f'<path d="M{x1:.1f} {y1:.1f} l{-u - v / 2:.1f} {-v + u / 2:.1f} '
                          f'l{v:.1f} {-u:.1f} z" fill="{color}"/>')
        self.text(b[0] + dx, b[1] + dy, label, color)

    def circle(self, center, radius, color=GREY, fill="none"):
        x, y = self.at(*center)
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius * self.scale:.1f}" '
                          f'stroke="{color}" stroke-width="1.5" fill="{fill}"/>')

    def box(self, low, high, fill, color=GREY):
        x, y = self.at(low[0], high[1])
        self.parts.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{(high[0] - low[0]) * self.scale:.1f}" '
                          f'height="{(high[1] - low[1]) * self.scale:.1f}" fill="{fill}" stroke="{color}"/>')

    def text(self, x, y, words, color="#222"):
        x, y = self.at(x, y)
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" fill="{color}" font-size="15" '
                          f'font-family="sans-serif">{words}</text>')

    def save(self, path):
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:.0f}" '
                        f'height="{self.height:.0f}">\n<rect width="100%" height="100%" fill="#fff"/>\n'
                        + "\n".join(self.parts) + "\n</svg>\n", encoding="utf-8")

def turned(direction, degrees):
    a = radians(degrees)
    return (direction[0] * cos(a) - direction[1] * sin(a), direction[0] * sin(a) + direction[1] * cos(a))

def camera():
    """From the side: the image plane, cut into rows, and the ray through the centre of one."""
    d, eye, half, rows = Drawing(9, 4.2, 60), (0.6, 2), 3 * tan(radians(25)), 8
    d.line(eye, (8.7, 2), dashed=True)
    for edge in -half, half:
        d.line(eye, (eye[0] + 3.6, eye[1] + 1.2 * edge))
    for row in range(rows + 1):
        y = eye[1] + half - 2 * half * row / rows
        d.line((3.52, y), (3.68, y), "#222")
    d.line((3.6, eye[1] - half), (3.6, eye[1] + half), "#222", 2)
    ball = Sphere(Vec(6.6, 2.7, 0), 0.9, None)
    direction = unit(Vec(3, half - 2 * half * 2.5 / rows, 0))
    t = ball.hit(Vec(*eye, 0), direction)
    point = Vec(*eye, 0) + direction * t
    normal, _ = ball.normals(point)
    d.circle((6.6, 2.7), 0.9, GREEN, "#e3f1e8")
    d.arrow(eye, (point.x, point.y), BLUE, "P", -0.3, 0.16)
    tip = point + normal * 0.9
    d.arrow((point.x, point.y), (tip.x, tip.y), RED, "N", -0.1, 0.12)
    for x, y, words, color in ((0.2, 1.5, "eye", "#222"), (1.75, 1.72, "angle / 2", "#222"),
                               (4.3, 0.3, "image plane", "#222"), (4.4, 2.85, "D", BLUE), (7.9, 1.7, "at", "#222")):
        d.text(x, y, words, color)
    return d

def mirror_and_glass():
    """Reflection and refraction at the surface of glass, by the tracer's own functions."""
    d, p, n = Drawing(7, 5, 60), (3.2, 2.4), Vec(0, 1, 0)
    d.box((0, 0), (7, p[1]), "#e4eef7", "#e4eef7")
    d.line((0, p[1]), (7, p[1]), "#222", 2)
    incoming = Vec(sin(radians(50)), -cos(radians(50)), 0)
    mirrored, bent = reflect(incoming, n), refract(incoming, n, 1 / 1.5)
    def end(v, length): return p[0] + v.x * length, p[1] + v.y * length
    d.line(p, (p[0], 0.2), dashed=True)
    d.arrow(p, (p[0], 4.3), RED, "N")
    d.arrow(end(-incoming, 2.9), p, BLUE)
    d.arrow(p, end(mirrored, 2.9), BLUE, "reflected")
    d.arrow(p, end(bent, 2.4), BLUE, "refracted")
    for x, y, words in ((0.85, 3.6, "D"), (2.65, 3.2, "\u03b8\u2081"), (3.45, 3.2, "\u03b8\u2081"),
                        (3.3, 1.35, "\u03b8\u2082"), (0.2, 2.55, "air, 1"), (0.2, 2.05, "glass, 1.5")):
        d.text(x, y, words)
    return d

def phong():
    """The four directions of Phong's formula."""
    d, p = Drawing(7, 3.9, 60), (3.4, 0.5)
    d.line((0.3, p[1]), (6.7, p[1]), "#222", 2)
    up = (0, 1)
    for degrees, length, label, color in ((0, 3, "N", RED), (40, 3, "L", BLUE), (-40, 3, "R", BLUE),
                                          (-62, 3, "V", GREEN)):
        x, y = turned(up, degrees)
        d.arrow(p, (p[0] + length * x, p[1] + length * y), color, label)
    d.text(2.85, 2.2, "\u03b8"), d.text(3.75, 2.2, "\u03b8"), d.text(5.0, 1.75, "\u03b1")
    d.text(p[0] - 0.1, 0.15, "P")
    return d

def penumbra():
    """A light of width s, the edge of an occluder, and the floor."""
    d, edge = Drawing(8, 5, 60), (3.6, 2.2)
    left, right = (2.4, 4.6), (4.4, 4.6)
    def on_floor(light):
        return light[0] + (edge[0] - light[0]) * (light[1] - 0.6) / (light[1] - edge[1]), 0.6
    d.line((0.2, 0.6), (7.8, 0.6), "#222", 2)
    d.line((0.8, edge[1]), edge, "#222", 6)
    d.line(left, right, YELLOW, 8)
    a, b = on_floor(right), on_floor(left)
    d.line(right, a), d.line(left, b)
    d.line((0.4, 0.5), (a[0], 0.5), "#222", 8), d.line((a[0], 0.5), (b[0], 0.5), GREY, 8)
    for x, y, words in ((3.1, 4.75, "light, s"), (1.2, 2.35, "occluder"), (0.9, 0.1, "umbra"),
                        (a[0] + 0.15, 0.1, "penumbra, w"), (5.8, 0.1, "lit"), (6.3, 3.3, "a"), (6.3, 1.3, "b")):
        d.text(x, y, words)
    d.line((6.1, 4.6), (6.1, edge[1]), BLUE), d.line((6.1, edge[1]), (6.1, 0.6), RED)
    d.line((3.6, edge[1]), (6.2, edge[1]), dashed=True)
    return d

def lens():
    """Rays of one pixel from the whole lens meet in the plane of focus, and part again behind it."""
    d, axis = Drawing(9, 4, 60), 2
    d.line((0.2, axis), (8.8, axis), dashed=True)
    d.line((1, axis - 1), (1, axis + 1), GREEN, 4)
    d.line((5, 0.4), (5, 3.7), "#222", 2)
    for y in -1, -0.5, 0, 0.5, 1:
        d.line((1, axis + y), (8.2, axis + y + (0.4 - y) * 7.2 / 4), BLUE)
    spread = 2 * abs(1 - 7.2 / 4)
    middle = axis + 0.4 * 7.2 / 4
    d.line((8.2, middle - spread / 2), (8.2, middle + spread / 2), RED, 4)
    for x, y, words in ((0.3, 0.55, "lens, 2R"), (4.2, 0.1, "plane of focus, f"), (8.3, 2.9, "disc"),
                        (8.15, 1.6, "z")):
        d.text(x, y, words)
    return d

def grid():
    """The cells that the tracer's own grid visits, in their order."""
    d, columns, rows, size = Drawing(8, 5.4, 60), 9, 6, 0.8
    shapes = [Sphere(Vec(0.4, 0.4, 0.5), 0.4, None), Sphere(Vec(8.6, 5.6, 0.5), 0.4, None),
              Sphere(Vec(6.4, 3.6, 0.5), 0.9, None), Sphere(Vec(2.3, 3.9, 0.5), 0.7, None)]
    cells = Grid(shapes, 1)
    cells.n, cells.lo, cells.hi, cells.width = [columns, rows, 1], [0, 0, 0], [columns, rows, 1], [1, 1, 1]
    def place(x, y): return 0.4 + size * x, 0.3 + size * y
    start, direction = Vec(0.2, 1.35, 0.5), unit(Vec(1, 0.41, 0))
    end = min(s.hit(start, direction) for s in shapes)
    visited, enters = [], 0
    for _, leaves in cells.cells(start, direction):
        middle = start + direction * ((enters + leaves) / 2)
        visited.append((int(middle.x), int(middle.y)))
        enters = leaves
        if leaves > end:
            break
    for i in range(columns):
        for j in range(rows):
            d.box(place(i, j), place(i + 1, j + 1), YELLOW if (i, j) in visited else "none")
    for number, (i, j) in enumerate(visited, 1):
        d.text(*place(i + 0.08, j + 0.72), str(number))
    for shape in shapes:
        d.circle(place(shape.center.x, shape.center.y), shape.radius * size, GREEN, "#e3f1e8")
    hit = start + direction * end
    d.arrow(place(start.x, start.y), place(hit.x, hit.y), BLUE)
    return d

def path():
    """A path from the eye over three points, each with a ray to the lamp."""
    d, lamp = Drawing(9, 4.8, 60), (4.9, 4.3)
    d.line((0.4, 0.6), (8.5, 0.6), "#222", 2), d.line((8.5, 0.6), (8.5, 4.6), "#222", 2)
    d.line((lamp[0] - 0.5, lamp[1]), (lamp[0] + 0.5, lamp[1]), YELLOW, 8)
    points = [(0.5, 2.9), (2.9, 0.6), (8.5, 2.5), (6.2, 0.6)]
    for i, (a, b) in enumerate(zip(points, points[1:])):
        d.arrow(a, b, BLUE)
        d.text((a[0] + b[0]) / 2 + 0.05, (a[1] + b[1]) / 2 + 0.2, str(i + 1), BLUE)
    for i, point in enumerate(points[1:]):
        target = lamp[0] + 0.3 * (i - 1), lamp[1]
        d.line(point, target, RED, 1.5, True)
        x, y = (point[a] + (target[a] - point[a]) * (0.3, 0.3, 0.6)[i] for a in (0, 1))
        d.text(x + 0.1, y, str(i + 2), RED)
    for x, y, words in ((0.25, 3.1, "eye"), (5.55, 4.3, "lamp"), (2.8, 0.2, "x1"), (8.6, 2.45, "x2"),
                        (6.1, 0.2, "x3")):
        d.text(x, y, words)
    return d

def microfacets():
    """A rough surface of facets; those whose normal is H mirror L to V."""
    d, p = Drawing(8, 4, 60), (4, 0.85)
    half = unit(Vec(sin(radians(12)), cos(radians(12)), 0))
    light = Vec(sin(radians(-38)), cos(radians(-38)), 0)
    to_eye = reflect(-light, half)
    tilts, x, y, shown = (14, -22, 5, 12, -20, 25, -17, 12, -26, 12, 20, -19, 9, -15, 12), 0.4, 0.7, []
    for tilt in tilts:  # each facet descends by its tilt
        end = x + 0.48, y - 0.48 * tan(radians(tilt))
        shown.append(((x, y), end, tilt == 12))
        x, y = end
    for a, b, is_found in shown:
        d.line(a, b, RED if is_found else "#222", 4 if is_found else 2)
    p = tuple((shown[7][0][i] + shown[7][1][i]) / 2 for i in (0, 1))
    for v, length, label, color in ((light, 2.9, "L, into", BLUE), (to_eye, 2.6, "V, out", GREEN),
                                    (Vec(0, 1, 0), 2.9, "N", "#222"), (half, 2.4, "H", RED)):
        d.arrow(p, (p[0] + length * v.x, p[1] + length * v.y), color, label)
    return d

def main():
    folder = Path(sys.argv[1])
    for name, draw in (("1-camera", camera), ("3-phong", phong), ("4-mirror-and-glass", mirror_and_glass),
                       ("6-penumbra", penumbra), ("7-lens", lens), ("8-grid", grid), ("9-path", path),
                       ("11-microfacets", microfacets)):
        draw().save(folder / f"{name}.svg")

if __name__ == "__main__":
    main()
