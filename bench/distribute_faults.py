#!/usr/bin/env python3
"""What happens to a picture when workers, connections, disks and clients fail.

    PYTHONPATH=build/release/python bench/distribute_faults.py [--kills N] [--only NAME]

Prints a table: each fault, the seconds of the picture, the work that was done more than once, and whether the
bytes are those of one process.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path

import dask
import numpy as np
import raio
from distributed import Client, LocalCluster, Status

OPTIONS = {"size": (640, 480), "samples": 256}


def make_scene():
    rng = np.random.default_rng(1)
    scene = raio.Scene(background="white")
    scene.spheres(rng.uniform(-3, 3, (2000, 3)).astype(np.float32), 0.2, colors=rng.random((2000, 3)))
    return scene


def cluster_of(workers, **options):
    # Else a LocalCluster drops workers that happen to be dead twice, 15 seconds apart.
    dask.config.set({"distributed.deploy.lost-worker-timeout": "1h"})
    return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None,
                        scheduler_kwargs={"allowed_failures": 10}, **options)


def rendered(client, **options):
    """The picture, its seconds, and the samples in parts that came in, over those of the picture."""
    from raio import distribute

    done, take = [0, 0], distribute._Picture._take

    def count(self, portion, result):
        if isinstance(result, tuple):
            done[0] += self._portions.size(portion)
        done[1] = self._portions.all
        take(self, portion, result)

    distribute._Picture._take = count
    begin = time.monotonic()
    try:
        image = distribute.render(make_scene(), client=client, task_seconds=1, **{**OPTIONS, **options})
    finally:
        distribute._Picture._take = take
    return image, time.monotonic() - begin, done[0] / done[1]


def kills(want, count, workers):
    """SIGKILL to random workers."""
    rng, killed, stop = random.Random(workers), [], threading.Event()
    seconds = shares = 0
    wrong = 0
    with cluster_of(workers) as cluster, Client(cluster) as client, Client(cluster) as other:

        def kill():
            while not stop.wait(rng.uniform(0.5, 1.5)):
                if len(killed) >= count:
                    return
                # Dask gives up a worker that ends while it starts.
                nannies = [worker for worker in cluster.workers.values()
                           if worker.status == Status.running and worker.process
                           and worker.process.status == Status.running]
                if nannies:
                    os.kill(rng.choice(nannies).process.pid, signal.SIGKILL)
                    killed.append(time.monotonic())

        thread = threading.Thread(target=kill)
        thread.start()
        pictures = 0
        while len(killed) < count:
            image, s, share = rendered(client)
            seconds, shares, pictures = seconds + s, shares + share, pictures + 1
            wrong += image._film.to_bytes() != want
        stop.set()
        thread.join()
        del other
    return f"{len(killed)} SIGKILLs of {workers} workers, {pictures} pictures", seconds, shares / pictures, not wrong


def connections(want, workers):
    """The client's connection to the scheduler breaks again and again."""
    stop, broken = threading.Event(), []
    with cluster_of(workers) as cluster, Client(cluster) as client:

        def cut():
            while not stop.wait(0.7):
                if client.status == "running" and len(broken) < 4:
                    client.loop.add_callback(client.scheduler_comm.comm.abort)
                    broken.append(1)

        thread = threading.Thread(target=cut)
        thread.start()
        image, seconds, share = rendered(client)
        stop.set()
        thread.join()
    return f"{len(broken)} lost connections to the scheduler", seconds, share, image._film.to_bytes() == want


def full_disk(want, workers):
    """Workers whose folder for spilled data is full."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", folder])
        if done.returncode:
            return "full disk of the workers: cannot be mounted here", 0, 0, True
        try:
            with cluster_of(workers, local_directory=folder, memory_limit="400 MB") as cluster, \
                    Client(cluster) as client:
                client.wait_for_workers(workers)
                try:
                    with open(Path(folder) / "filler", "wb", buffering=0) as filler:
                        while True:
                            filler.write(bytes(1 << 12))
                except OSError:
                    pass
                image, seconds, share = rendered(client)
        finally:
            subprocess.run(["umount", "-l", folder])
    return "full disk of the workers", seconds, share, image._film.to_bytes() == want


CLIENT = """
import sys, raio
sys.path.insert(0, {bench!r})
from distribute_faults import make_scene, OPTIONS
from distributed import Client
raio.distribute.render(make_scene(), client=Client({address!r}), task_seconds=1, checkpoint={path!r},
                       checkpoint_interval=0.5, resume=True, **OPTIONS).save({path!r} + ".png")
"""


def clients(want, workers):
    """The client is killed every few seconds, and started again."""
    rng, kills = random.Random(7), 0
    with cluster_of(workers) as cluster, tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "picture.raio")
        script = CLIENT.format(bench=str(Path(__file__).parent), address=cluster.scheduler_address, path=path)
        begin = time.monotonic()
        while True:
            process = subprocess.Popen([sys.executable, "-c", script])
            try:
                if process.wait(rng.uniform(1.2, 2) if kills < 8 else 600) == 0:
                    break
                raise RuntimeError("the client failed")
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                kills += 1
        seconds = time.monotonic() - begin
        same = Path(path).read_bytes() == want
    return f"{kills} SIGKILLs of the client, resumed", seconds, float("nan"), same


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--only", choices=["kills", "connections", "disk", "client"])
    parser.add_argument("--workers", type=int, default=3)
    wanted = parser.parse_args()
    warnings.simplefilter("ignore")
    want = make_scene().render(**OPTIONS)._film.to_bytes()
    faults = {"kills": lambda: kills(want, wanted.kills, wanted.workers),
              "connections": lambda: connections(want, wanted.workers),
              "disk": lambda: full_disk(want, wanted.workers), "client": lambda: clients(want, wanted.workers)}
    with cluster_of(wanted.workers) as cluster, Client(cluster) as client:
        image, seconds, share = rendered(client)
    print("| fault | seconds | work that came in, of the picture's | the same bytes |\n|---|---|---|---|")
    print(f"| none | {seconds:.1f} | {share:.3f} | {image._film.to_bytes() == want} |", flush=True)
    for name, fault in faults.items():
        if wanted.only in (None, name):
            what, seconds, share, same = fault()
            print(f"| {what} | {seconds:.1f} | {share:.3f} | {same} |", flush=True)


if __name__ == "__main__":
    main()
