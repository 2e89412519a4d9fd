"""Films: refined step by step, and merged from shares, with the same bytes as one render."""

import matplotlib.pyplot as plt
import numpy as np
import raio

rng = np.random.default_rng(5)
scene = raio.Scene()
scene.spheres(rng.normal(size=(400, 3)), rng.uniform(0.1, 0.45, 400), colors=rng.uniform(size=400),
              cmap="cividis")

film = scene.start(size=(360, 360))
figure, axes = plt.subplots(1, 3, figsize=(9, 3.3), layout="constrained")
for ax, more in zip(axes, (1, 7, 120)):
    film.add(more)
    ax.imshow(film.image().display())
    ax.set_title(f"{film.samples} samples a pixel", fontsize=10)
    ax.axis("off")
figure.savefig("refine.png", dpi=110)

# Each of four machines could render one share.
shares = [scene.render(size=(360, 360), samples=128, shard=f"{k}/4") for k in range(1, 5)]
merged = raio.merge(shares).image()
assert np.array_equal(merged.numpy(), film.image().numpy())
