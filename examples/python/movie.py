"""A movie of spheres that a wave moves; without ffmpeg, change the name to "movie-{:03d}.png"."""

import shutil

import numpy as np
import raio

side = np.arange(-12, 13.0)
x, y = (a.ravel() for a in np.meshgrid(side, side))
distance = np.hypot(x, y)
scene = raio.Scene()
balls = scene.spheres(np.stack((x, y, 0 * x), axis=1), 0.48, colors=0 * x, cmap="coolwarm", vmin=-1,
                      vmax=1)
scene.camera((0, -34, 22), (0, 0, -1.5), fov=36)


def frames(count=48):
    for step in range(count):
        height = np.cos(0.7 * distance - 2 * np.pi * step / count) * np.exp(-distance / 14)
        balls.centers = np.stack((x, y, 2 * height), axis=1)
        balls.colors = height
        yield scene  # the scene as it is now is rendered before the next step


name = "movie.mp4" if shutil.which("ffmpeg") else "movie-{:03d}.png"
raio.movie(frames(), name, fps=24, size=(640, 400), samples=16)
next(frames(4)).render(size=(960, 600), samples=64).save("movie.png")
