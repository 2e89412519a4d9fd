"""A picture in matplotlib's axes, to scale, with a colour bar."""

import matplotlib.pyplot as plt
import numpy as np
import raio

# Grains of a film, seen from above; their height is the value.
rng = np.random.default_rng(8)
x, y = rng.uniform(0, 12, (2, 9000))
z = 0.8 * np.sin(x) * np.cos(0.8 * y) + 0.12 * rng.normal(size=9000)
scene = raio.Scene()
scene.spheres(np.stack((x, y, z), axis=1), rng.uniform(0.09, 0.2, 9000), colors=z, cmap="viridis")

# An orthographic camera at a distance d shows a height of 2 d tan(fov / 2).
distance, height = 100, 8
scene.camera((6, 4, distance), (6, 4, 0), up=(0, 1, 0), projection="orthographic",
             fov=np.degrees(2 * np.arctan(height / 2 / distance)))
image = scene.render(size=(960, 640), samples=32)

figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
axes.imshow(image.display(), extent=(0, 12, 0, 8))
axes.set(xlabel="x (nm)", ylabel="y (nm)")
figure.colorbar(plt.cm.ScalarMappable(plt.Normalize(z.min(), z.max()), "viridis"), ax=axes,
                label="height (nm)", shrink=0.85)
figure.savefig("axes.png", dpi=110)
