#!/usr/bin/env python3
"""What workers cost: a LocalCluster of single-threaded workers against one process with as many threads.

    PYTHONPATH=build/release/python bench/distribute_overhead.py SCENE [--workers N] [--rounds N] [option=value ...]

The scene is read before; both structures are built anew in each round. Prints the seconds of each round, the
ratio, and whether the bytes are equal.
"""

import argparse
import statistics
import time

import raio
from distributed import Client, LocalCluster


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("options", nargs="*", metavar="option=value")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    wanted = parser.parse_intermixed_args()
    options = dict(text.split("=", 1) for text in wanted.options)
    ratios = []
    for _ in range(wanted.rounds):
        scene = raio.load(wanted.scene)
        begin = time.perf_counter()
        one = scene.render(threads=wanted.workers, **options)
        one_s = time.perf_counter() - begin
        with LocalCluster(n_workers=wanted.workers, threads_per_worker=1, dashboard_address=None) as cluster, \
                Client(cluster) as client:
            client.wait_for_workers(wanted.workers)
            client.run(__import__, "raio._worker")  # as a cluster that has worked before
            begin = time.perf_counter()
            many = raio.distribute.render(scene, client=client, **options)
            many_s = time.perf_counter() - begin
        same = one._film.to_bytes() == many._film.to_bytes()
        ratios.append(many_s / one_s)
        print(f"one process {one_s:.2f} s, {wanted.workers} workers {many_s:.2f} s: {ratios[-1]:.3f}, "
              f"{'the same bytes' if same else 'OTHER BYTES'}", flush=True)
    print(f"median {statistics.median(ratios):.3f}")


if __name__ == "__main__":
    main()
