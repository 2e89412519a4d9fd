"""A smooth mesh, coloured by its mean curvature."""

import numpy as np
import raio

# A torus whose tube swells five times, as a grid of points.
m, n = 600, 240
u, v = np.meshgrid(np.linspace(0, 2 * np.pi, m, endpoint=False),
                   np.linspace(0, 2 * np.pi, n, endpoint=False), indexing="ij")
tube = 1 + 0.3 * np.cos(5 * u + 2 * v)
ring = 3 + tube * np.cos(v)
points = np.stack((ring * np.cos(u), ring * np.sin(u), tube * np.sin(v)), axis=-1)


def along(values, axis):
    step = 2 * np.pi / values.shape[axis]
    return (np.roll(values, -1, axis) - np.roll(values, 1, axis)) / (2 * step)


# The first and second fundamental forms, by differences.
pu, pv = along(points, 0), along(points, 1)
normal = np.cross(pu, pv)
normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
dot = lambda a, b: (a * b).sum(axis=-1)
e, f, g = dot(pu, pu), dot(pu, pv), dot(pv, pv)
l, k, w = dot(along(pu, 0), normal), dot(along(pu, 1), normal), dot(along(pv, 1), normal)
curvature = (e * w - 2 * f * k + g * l) / (2 * (e * g - f * f))

i, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
number = lambda i, j: (i % m) * n + j % n
faces = np.stack((number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)), -1)
scene = raio.Scene()
limit = np.percentile(abs(curvature), 98)
scene.mesh(points.reshape(-1, 3), faces.reshape(-1, 4), normals=normal.reshape(-1, 3),
           colors=curvature.ravel(), cmap="coolwarm", vmin=-limit, vmax=limit)
scene.look((0, 1, -1), margin=0.03)
scene.render(size=(1000, 680), samples=64).save("curvature.png")
