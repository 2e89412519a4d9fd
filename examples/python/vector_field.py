"""A vector field as arrows: the flow around a vortex ring."""

import numpy as np
import raio

# The velocity of a ring of vortex, by the law of Biot and Savart.
angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
ring = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
tangent = np.stack((-np.sin(angle), np.cos(angle), 0 * angle), axis=1) * (2 * np.pi / 200)
# Points of planes through the axis.
r, z, turn = (a.ravel() for a in np.meshgrid(np.linspace(0.12, 2, 11), np.linspace(-1.5, 1.5, 15),
                                             np.arange(8) * np.pi / 4, indexing="ij"))
places = np.stack((r * np.cos(turn), r * np.sin(turn), z), axis=1)
apart = places[:, None] - ring
flow = np.cross(tangent, apart).T / (np.linalg.norm(apart, axis=2).T ** 2 + 0.03) ** 1.5
flow = flow.sum(axis=1).T
speed = np.linalg.norm(flow, axis=1)
behind = np.isin(turn.round(3), (np.arange(3, 8) * np.pi / 4).round(3))
places, flow, speed = places[behind], flow[behind], speed[behind]

length = 0.24 * (speed / speed.max())[:, None] ** 0.35
way = flow / speed[:, None] * length
look = {"colors": speed, "cmap": "plasma", "vmin": 0, "vmax": np.percentile(speed, 97)}
scene = raio.Scene()
neck = places + 0.1 * way
scene.cylinders(places - way / 2, neck, 0.085 * length[:, 0], **look)
scene.cones(neck, places + way / 2, 0.24 * length[:, 0], 0, **look)
scene.discs(neck, -flow, 0.24 * length[:, 0], **look)
scene.lines(np.concatenate((ring, ring[:1])), 0.02, colors="#333333")
scene.look((-0.25, -1, -0.45), margin=0.03)
scene.render(size=(900, 800), samples=64).save("vector_field.png")
