#!/usr/bin/env python3
"""Rays against a mesh, by Raio and by Embree through trimesh (pip install trimesh embreex), in turns.

    PYTHONPATH=build/release/python python3 bench/python_rays.py [MILLION-RAYS] [ROUNDS]
"""

import sys
import time

import numpy as np
import raio
import trimesh
import trimesh.ray.ray_pyembree  # fails if Embree is missing: the other way would be slow

n = int(float(sys.argv[1] if len(sys.argv) > 1 else 10) * 1e6)
rounds = int(sys.argv[2] if len(sys.argv) > 2 else 3)

# A bumpy ball of 1.3 million triangles, and rays from everywhere around it.
ball = trimesh.creation.icosphere(subdivisions=8)
ball.vertices *= 1 + 0.1 * np.sin(9 * ball.vertices).prod(axis=1, keepdims=True)
rng = np.random.default_rng(1)
origins = rng.normal(size=(n, 3)).astype(np.float32)
origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
directions = (rng.uniform(-1, 1, (n, 3)) - origins).astype(np.float32)

scene = raio.Scene()
scene.mesh(ball.vertices, ball.faces)
scene.intersect(origins[:10], directions[:10])  # builds the structure
ball.ray.intersects_first(origins[:10], directions[:10])

times = {"raio": [], "embree": []}
for _ in range(rounds):
    start = time.perf_counter()
    ours = scene.intersect(origins, directions).id
    times["raio"].append(time.perf_counter() - start)
    start = time.perf_counter()
    theirs = ball.ray.intersects_first(origins, directions)
    times["embree"].append(time.perf_counter() - start)

best = {name: min(all_times) for name, all_times in times.items()}
print(f"{len(ball.faces)} triangles, {n} rays: {(ours != theirs).sum()} hit another triangle")
for name, seconds in best.items():
    print(f"{name:7} {seconds:7.2f} s  {n / seconds / 1e6:6.2f} million rays a second")
print(f"ratio {best['raio'] / best['embree']:.2f}")
