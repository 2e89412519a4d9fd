"""Streamlines as tubes, coloured by speed: the attractor of Thomas."""

import numpy as np
import raio


def flow(p):
    return np.sin(np.roll(p, -1, axis=1)) - 0.19 * p


rng = np.random.default_rng(4)
step, lines = 0.08, [rng.uniform(-3, 3, (48, 3))]
for _ in range(700):  # Runge and Kutta, fourth order
    p = lines[-1]
    k1 = flow(p)
    k2 = flow(p + step / 2 * k1)
    k3 = flow(p + step / 2 * k2)
    k4 = flow(p + step * k3)
    lines.append(p + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
lines = np.array(lines[200:])  # steps, lines, 3; near the attractor

speed = np.linalg.norm(flow(lines.reshape(-1, 3)), axis=1).reshape(lines.shape[:2])
radius = 0.015 + 0.04 * speed / speed.max()
look = {"cmap": "plasma", "vmin": 0, "vmax": speed.max()}
scene = raio.Scene()
scene.cones(lines[:-1].reshape(-1, 3), lines[1:].reshape(-1, 3), radius[:-1].ravel(),
            radius[1:].ravel(), colors=((speed[1:] + speed[:-1]) / 2).ravel(), **look)
scene.spheres(lines.reshape(-1, 3), radius.ravel(), colors=speed.ravel(), **look)
scene.look((-1, -0.8, -0.9), margin=0.02)
scene.render(size=(900, 800), samples=32).save("streamlines.png")
