"""Transparent shells around a core, cut open."""

import numpy as np
import raio

scene = raio.Scene()
theta, phi = np.meshgrid(np.linspace(0, np.pi, 121), np.linspace(0.12 * np.pi, 1.72 * np.pi, 241),
                         indexing="ij")
direction = np.stack((np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), -1)
corner = np.arange(120)[:, None] * 241 + np.arange(240)
faces = np.stack((corner, corner + 241, corner + 242, corner + 1), axis=-1).reshape(-1, 4)

for radius, color, opacity in ((1.0, "#2c7fb8", 0.35), (0.78, "#41b6a4", 0.5), (0.56, "#e9c46a", 0.75)):
    wave = radius * (1 + 0.02 * np.cos(6 * phi) * np.sin(theta) ** 6)
    vertices = (direction * wave[..., None]).reshape(-1, 3)
    scene.mesh(vertices, faces, normals=direction.reshape(-1, 3), colors=color, opacity=opacity)
scene.spheres([[0, 0, 0]], 0.34, colors="#d1495b")
scene.look((0.75, 1, -0.55), margin=0.04)
scene.render(size=(800, 760), samples=64).save("shells.png")
