"""Ray queries: how far a probe can look in each direction, from inside a porous solid."""

import matplotlib.pyplot as plt
import numpy as np
import raio

rng = np.random.default_rng(2)
grains = rng.uniform(-10, 10, (1500, 3))
grains = grains[np.linalg.norm(grains, axis=1) > 2.2]  # the probe is in a hole at the centre
scene = raio.Scene()
scene.spheres(grains, rng.uniform(0.5, 1.1, len(grains)))

# One ray for each pixel of a map of all directions.
latitude, longitude = np.meshgrid(np.radians(np.linspace(89.75, -89.75, 360)),
                                  np.radians(np.linspace(-179.75, 179.75, 720)), indexing="ij")
directions = np.stack((np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude),
                       np.sin(latitude)), axis=-1).reshape(-1, 3)
hits = scene.intersect(np.zeros_like(directions), directions)
distance = np.where(hits.index < 0, np.nan, hits.distance).reshape(latitude.shape)

figure = plt.figure(figsize=(8, 4.4), layout="constrained")
axes = figure.add_subplot(projection="mollweide")
drawn = axes.pcolormesh(longitude, latitude, distance, cmap="viridis", rasterized=True)
axes.set_xticklabels([])
axes.tick_params(labelsize=8)
figure.colorbar(drawn, label="free distance", shrink=0.8)
figure.savefig("distance_map.png", dpi=110)
