"""Streamlines as tubes, coloured by speed: the flow of Arnold, Beltrami and Childress."""

import numpy as np
import raio


def flow(p):
    x, y, z = p.T
    return np.stack((np.sin(z) + 0.4 * np.cos(y), 0.8 * np.sin(x) + np.cos(z),
                     0.4 * np.sin(y) + 0.8 * np.cos(x)), axis=1)


rng = np.random.default_rng(4)
lines = [rng.uniform(0, 2 * np.pi, (140, 3))]
step = 0.04
for _ in range(260):  # Runge and Kutta, fourth order
    p = lines[-1]
    k1 = flow(p)
    k2 = flow(p + step / 2 * k1)
    k3 = flow(p + step / 2 * k2)
    k4 = flow(p + step * k3)
    lines.append(p + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
lines = np.array(lines)  # steps, lines, 3

speed = np.linalg.norm(flow(lines.reshape(-1, 3)), axis=1).reshape(lines.shape[:2])
radius = 0.02 + 0.05 * (speed - speed.min()) / np.ptp(speed)
look = {"cmap": "viridis", "vmin": speed.min(), "vmax": speed.max()}
scene = raio.Scene()
scene.cones(lines[:-1].reshape(-1, 3), lines[1:].reshape(-1, 3), radius[:-1].ravel(),
            radius[1:].ravel(), colors=((speed[1:] + speed[:-1]) / 2).ravel(), **look)
scene.spheres(lines.reshape(-1, 3), radius.ravel(), colors=speed.ravel(), **look)
scene.look((-1, 1, -0.7), margin=0.02)
scene.render(size=(1000, 800), samples=32).save("streamlines.png")
