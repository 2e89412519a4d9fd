"""A vector field as arrows: the flow around a vortex ring."""

import numpy as np
import raio

# The velocity of a ring of vortex, by the law of Biot and Savart.
angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
ring = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
tangent = np.stack((-np.sin(angle), np.cos(angle), 0 * angle), axis=1) * (2 * np.pi / 200)
# Points of a plane through the axis.
r, z, turn = (a.ravel() for a in np.meshgrid(np.linspace(0.08, 1.96, 13),
                                             np.linspace(-1.3, 1.3, 17),
                                             (0, np.pi), indexing="ij"))
places = np.stack((r * np.cos(turn), r * np.sin(turn), z), axis=1)
apart = places[:, None] - ring
flow = np.cross(tangent, apart).T / (np.linalg.norm(apart, axis=2).T ** 2 + 0.03) ** 1.5
flow = flow.sum(axis=1).T
speed = np.linalg.norm(flow, axis=1)

length = 0.2 * (speed / speed.max())[:, None] ** 0.35
way = flow / speed[:, None] * length
look = {"colors": speed, "cmap": "plasma", "vmin": 0, "vmax": np.percentile(speed, 97)}
scene = raio.Scene()
neck = places + 0.1 * way
scene.cylinders(places - way / 2, neck, 0.1 * length[:, 0], **look)
scene.cones(neck, places + way / 2, 0.26 * length[:, 0], 0, **look)
scene.discs(neck, -flow, 0.26 * length[:, 0], **look)
scene.lines(np.concatenate((ring, ring[:1])), 0.02, colors="#333333")
scene.look((0.35, 1, -0.4), margin=0.1)
scene.render(size=(1000, 760), samples=64, color_bar="speed").save("vector_field.png")
