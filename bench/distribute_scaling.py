#!/usr/bin/env python3
"""How the efficiency of raio.distribute falls with the number of cores.

    PYTHONPATH=build/release/python bench/distribute_scaling.py [--dummies N] [--seconds S] [-o PLOT.png]

Measures what one task costs Dask's scheduler with N dummy workers and what one part costs the client, and the
spread of the costs of tiles. Then simulates an 8K picture with the package's own division into portions.
"""

import argparse
import asyncio
import heapq
import subprocess
import sys
import time
from collections import deque

import numpy as np
import raio
from raio import _raio
from raio._portions import Portions

WORKERS = """
import asyncio, sys
from distributed import Worker
async def main():
    workers = [Worker(sys.argv[1], nthreads=1, dashboard=False, memory_limit=0) for _ in range(int(sys.argv[2]))]
    await asyncio.gather(*workers)
    await asyncio.Event().wait()
asyncio.run(main())
"""


async def scheduler_s_per_task(dummies, tasks=20_000):
    """Seconds of processor time, and on the clock, per task without work."""
    from distributed import Client, Scheduler, as_completed

    async with Scheduler(dashboard=False, port=0) as scheduler:
        processes = [subprocess.Popen([sys.executable, "-c", WORKERS, scheduler.address, str(dummies // 4)],
                                      stderr=subprocess.DEVNULL) for _ in range(4)]
        try:
            async with Client(scheduler.address, asynchronous=True) as client:
                while len(scheduler.workers) < dummies // 4 * 4:
                    await asyncio.sleep(0.5)
                cpu = time.process_time()
                # In portions like those of a picture: twice as many as workers are outstanding.
                futures = [client.submit(abs, i, pure=False, key=("dummy", i)) for i in range(2 * dummies)]
                submitted, pending = len(futures), as_completed(futures)
                async for _ in pending:
                    if submitted < tasks:
                        pending.add(client.submit(abs, submitted, pure=False, key=("dummy", submitted)))
                        submitted += 1
                return (time.process_time() - cpu) / tasks
        finally:
            for process in processes:
                process.kill()


def merge_s_per_tile():
    """Of an 8K picture: seconds per part, and per tile in it."""
    rng = np.random.default_rng(1)
    scene = raio.Scene()
    scene.spheres(rng.random((20_000, 3)) * 10, 0.15, colors=rng.random((20_000, 3)))
    options = {"size": (7680, 4320), "samples": 64}
    film = _raio.begin(scene._core(), raio._options.settings(scene._with_defaults(options)))
    seconds, tiles, size = [], [], 0
    for first in range(0, 16, 4):
        for shard, shards in ((1, 128), (2, 1024)):
            part = scene.render(shard=f"{shard}/{shards}", sample_range=(first, first + 4), **options)._film.to_bytes()
            begin = time.perf_counter()
            film.add(part)
            if first > 0:  # the film's memory exists by then
                seconds.append(time.perf_counter() - begin)
                tiles.append(film.tiles() / shards)
                size = len(part) / tiles[-1]
    slope, start = np.polyfit(tiles, seconds, 1)
    return max(start, 0), slope, size


def tile_costs():
    """Relative costs of tiles, of a molecule before a background."""
    rng = np.random.default_rng(1)
    scene = raio.Scene()
    scene.spheres(rng.normal(size=(100_000, 3)), 0.05)
    costs = []
    scene.render(size=(32, 24), samples=1)  # builds the structure
    for shard in range(1, 121):
        begin = time.perf_counter()
        scene.render(size=(1920, 1080), samples=4, shard=f"{shard}/510", threads=1)
        costs.append(time.perf_counter() - begin)
    return np.array(costs) / np.mean(costs)


class Counted:
    """What Portions asks of a film."""

    def __init__(self, tiles, samples):
        self._tiles, self._samples = tiles, samples

    def tiles(self):
        return self._tiles

    def missing(self, shard, shards):
        return [(0, self._samples)]


def efficiency(cores, ideal_s, longest_s, costs, of):
    """The parallel efficiency of a picture that would take `ideal_s` seconds without overhead, and its tasks."""
    per_task_s, part_s, tile_s = of
    tiles, samples = 8160, 1024
    tile_cost = costs[np.random.default_rng(1).integers(len(costs), size=tiles)]
    tile_cost *= cores * ideal_s / tile_cost.sum() / samples
    portions = Portions(Counted(tiles, samples), samples)
    scheduler = client = now = 0.0
    queue, running, count, out = deque(), [], 0, 0
    idle = cores

    def submit(at):
        nonlocal scheduler, out
        while portions and out < 2 * cores + 2:
            portion = portions.take(cores, longest_s)
            scheduler = max(scheduler, at) + per_task_s / 2
            queue.append((scheduler, portion))
            out += 1

    def start(at):
        nonlocal idle, count
        while idle > 0 and queue:
            ready, portion = queue.popleft()
            seconds = tile_cost[portion.shard::portion.shards].sum() * (portion.end - portion.first)
            count += 1
            idle -= 1
            heapq.heappush(running, (max(at, ready) + seconds, count, portion, seconds))

    submit(0.0)
    start(0.0)
    while running:
        now, _, portion, seconds = heapq.heappop(running)
        idle, out = idle + 1, out - 1
        scheduler = max(scheduler, now) + per_task_s / 2
        start(scheduler)
        merge = part_s + tile_s * len(tile_cost[portion.shard::portion.shards])
        client = max(client, scheduler) + merge
        portions.done(portion, seconds, merge)
        submit(client)
        start(client)
    return ideal_s / max(client, now), count


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--dummies", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=120, help="of the picture, if nothing else costs time")
    parser.add_argument("-o", "--output")
    wanted = parser.parse_args()
    per_task_s = asyncio.run(scheduler_s_per_task(wanted.dummies))
    part_s, tile_s, size = merge_s_per_tile()
    costs = tile_costs()
    print(f"scheduler: {per_task_s * 1e6:.0f} us per task with {wanted.dummies} dummy workers\n"
          f"client: {part_s * 1e3:.2f} ms per part and {tile_s * 1e3:.3f} ms per tile, which has {size / 1e3:.0f} kB\n"
          f"costs of tiles: {costs.min():.2f} to {costs.max():.2f} of the mean\n")
    curves = {}
    all_cores = [4, 16, 64, 256, 1000, 2000, 4000, 10_000]
    print("| cores | " + " | ".join(f"{s} s" if s else "default" for s in (None, 4, 16, 60)) + " |")
    for cores in all_cores:
        row = []
        for longest_s in (None, 4, 16, 60):
            seconds = longest_s or max(4, cores / raio.distribute._TASKS_PER_S)
            value, count = efficiency(cores, wanted.seconds, seconds, costs, (per_task_s, part_s, tile_s))
            curves.setdefault(longest_s, []).append(value)
            row.append(f"{value:.3f} ({count})")
        print(f"| {cores} | " + " | ".join(row) + " |", flush=True)
    if wanted.output:
        import matplotlib.pyplot as plt

        for longest_s, values in curves.items():
            plt.semilogx(all_cores, values, "o-", label=f"{longest_s} s" if longest_s else "default")
        plt.xlabel("cores")
        plt.ylabel("efficiency")
        plt.ylim(0, 1.02)
        plt.legend(title="longest portion")
        plt.savefig(wanted.output, dpi=120, bbox_inches="tight")


if __name__ == "__main__":
    main()
