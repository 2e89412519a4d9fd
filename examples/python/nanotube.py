"""Balls and sticks from arrays: a carbon nanotube with hydrogen at its ends."""

import numpy as np
import raio

n, rows, bond = 8, 11, 1.42  # an armchair tube, in angstroms
radius = 3 * n * bond / (2 * np.pi)
angles, heights = [], []
for row in range(rows):
    for k in range(n):
        for shift in (0, 1):
            # Around the tube, bonds alternate with gaps of two bonds.
            angles.append((3 * k + 1.5 * (row % 2) + shift) * bond / radius)
            heights.append(row * bond * np.sqrt(0.75))
angles, heights = np.array(angles), np.array(heights)


def on_tube(heights):
    return np.stack((radius * np.cos(angles), radius * np.sin(angles), heights), axis=1)


carbon = on_tube(heights)
# Atoms of the first and the last row have two neighbours; hydrogen takes the place of the third.
ends = (heights == heights.min()) | (heights == heights.max())
side = np.where(heights > heights.mean(), 0.93, -0.93)
turn = np.where(np.arange(len(angles)) % 2, 0.55, -0.55) / radius
angles = angles + turn
hydrogen = on_tube(heights + side)[ends]

atoms = np.concatenate((carbon, hydrogen))
is_carbon = np.arange(len(atoms)) < len(carbon)
distance = np.linalg.norm(atoms[:, None] - atoms, axis=2)
first, second = np.nonzero(np.triu((distance > 0.1) & (distance < 1.6)))

scene = raio.Scene()
scene.spheres(atoms, np.where(is_carbon, 0.42, 0.28),
              colors=np.where(is_carbon[:, None], (70, 74, 84), (235, 235, 235)).astype(np.uint8))
scene.cylinders(atoms[first], atoms[second], 0.14, colors="#9aa3b5")
scene.look((-0.75, 0.35, -0.5), up=(1, 0, 0.25), margin=0.04)
scene.render(size=(1000, 640), samples=64).save("nanotube.png")
