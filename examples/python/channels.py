"""Channels: what each pixel shows, as arrays."""

import matplotlib.pyplot as plt
import numpy as np
import raio

rng = np.random.default_rng(11)
scene = raio.Scene()
t = np.linspace(0, 14 * np.pi, 260)
helix = np.stack((np.cos(t) * (1 + t / 18), np.sin(t) * (1 + t / 18), t / 9), axis=1)
scene.spheres(helix, 0.12 + 0.16 * t / t.max(), colors=t, cmap="plasma")
image = scene.render(size=(480, 420), samples=16, channels=["depth", "normal", "id"])

depth = np.where(np.isfinite(image["depth"]), image["depth"], np.nan)
normal = np.where(np.isnan(depth)[..., None], 1, image["normal"] / 2 + 0.5)
# Each primitive has a number; a table of random colours tells neighbours apart.
table = np.vstack((rng.uniform(0.2, 0.9, (len(scene), 3)), (1, 1, 1)))
number = np.minimum(image["id"], len(scene))

figure, axes = plt.subplots(2, 2, figsize=(7, 6.4), layout="constrained")
axes = axes.ravel()
axes[0].imshow(image.display())
shown = axes[1].imshow(depth, cmap="viridis_r")
figure.colorbar(shown, ax=axes[1], shrink=0.7)
axes[2].imshow(normal.clip(0, 1))
axes[3].imshow(table[number])
for ax, name in zip(axes, ("picture", "depth", "normal", "id")):
    ax.set_title(name, fontsize=10)
    ax.axis("off")
figure.savefig("channels.png", dpi=100)
