"""Instances: the 60 places of an icosahedral shell, for one unit that is stored once."""

import numpy as np
import raio


def turn(axis, angle):
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


# All rotations of the icosahedron follow from two.
golden = (1 + 5 ** 0.5) / 2
group = [np.eye(3)]
for g in group:  # grows
    for h in (turn((0, 1, golden), 2 * np.pi / 5), turn((1, 1, 1), 2 * np.pi / 3)):
        if min(np.abs(g @ h - other).max() for other in group) > 1e-6:
            group.append(g @ h)
assert len(group) == 60

# A unit of three lumps of atoms, between a fivefold and two threefold axes.
rng = np.random.default_rng(3)
axes = np.array([[0, 1, golden], [1, 1, 1], [-1, 1, 1]], float)
axes /= np.linalg.norm(axes, axis=1, keepdims=True)
unit = raio.Scene()
for weights, color in (((2.6, 1, 1), "#3d6c9e"), ((1, 1.9, 0.6), "#e0a458"), ((1, 0.6, 1.9), "#79a89a")):
    middle = np.array(weights) @ axes
    middle *= 100 / np.linalg.norm(middle)
    atoms = rng.normal(size=(900, 3))
    atoms *= (rng.uniform(0, 1, 900) ** (1 / 3) / np.linalg.norm(atoms, axis=1) * 17)[:, None]
    unit.spheres(middle + atoms * (1 - 0.25 * (atoms @ middle > 0)[:, None]), 2.4, colors=color)

scene = raio.Scene()
transforms = np.tile(np.eye(4), (60, 1, 1))
transforms[:, :3, :3] = group
scene.instances(unit, transforms)
scene.look((-0.2, 0.3, -1), up=(0, 1, 0), margin=0.03)
scene.render(size=(800, 800), samples=32, depth_cue=0.4).save("capsid.png")
