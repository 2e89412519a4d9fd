"""A million particles, coloured by a value; a corner is cut away."""

import numpy as np
import raio

rng = np.random.default_rng(7)
n = 100
places = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
places = (places + rng.uniform(-0.35, 0.35, places.shape)).astype(np.float32)

# A smooth random field: a sum of waves, whose amplitude falls with their number.
value = np.zeros(len(places), np.float32)
for _ in range(60):
    k = rng.normal(size=3)
    k *= rng.uniform(2, 12) / n / np.linalg.norm(k)
    value += np.cos(2 * np.pi * (places @ k.astype(np.float32) + rng.uniform())) / np.linalg.norm(k * n)

kept = ~((places[:, 0] > n * 0.5) & (places[:, 1] < n * 0.5) & (places[:, 2] > n * 0.5))
scene = raio.Scene()
scene.spheres(places[kept], 0.62, colors=value[kept], cmap="viridis")
scene.look((-1, 1.35, -0.8), margin=0.03)
scene.render(size=(900, 800), samples=32, progress=True).save("million_particles.png")
