"""Pictures and movies on several workers."""

import os
import pathlib
import pickle
import random
import re
import signal
import subprocess
import sys
import threading
import time
import types
import warnings

import numpy as np
import pytest
import raio
from raio._portions import Portion, Portions

distributed = pytest.importorskip("distributed")
import dask  # noqa: E402
import raio.distribute as distribute  # noqa: E402
from raio import _tasks, _worker  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.filterwarnings("default")  # the library's own


@pytest.fixture(scope="module")
def cluster():
    """Two workers with a thread each, which are restarted if they are killed."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0",
                                  scheduler_kwargs={"allowed_failures": 10}) as cluster:
        yield cluster


@pytest.fixture
def client(cluster):
    with distributed.Client(cluster) as client:
        client.wait_for_workers(2)
        yield client


@pytest.fixture
def scene():
    rng = np.random.default_rng(1)
    scene = raio.Scene(background="transparent")
    scene.spheres(rng.uniform(-3, 3, (300, 3)).astype(np.float32), 0.4, colors=rng.random((300, 3)))
    return scene


SIZE = {"size": (330, 200), "samples": 24}


class FakeFilm:
    """Tiles with the samples that each has."""

    def __init__(self, tiles, samples):
        self.has = [set() for _ in range(tiles)]
        self.samples = samples

    def tiles(self):
        return len(self.has)

    def missing(self, shard, shards):
        lacks = {tuple(sorted(set(range(self.samples)) - has)) for has in self.has[shard::shards]}
        if len(lacks) > 1:
            return None
        spans = []
        for k in next(iter(lacks), ()):
            if spans and spans[-1][1] == k:
                spans[-1][1] = k + 1
            else:
                spans.append([k, k + 1])
        return spans

    def add(self, portion):
        for has in self.has[portion.shard::portion.shards]:
            for k in range(portion.first, portion.end):
                assert k not in has
                has.add(k)


@pytest.mark.parametrize("seed", range(30))
def test_portions_give_every_sample_once(seed):
    rng = random.Random(seed)
    tiles, samples, cores = rng.choice([1, 2, 7, 40, 500]), rng.choice([1, 5, 64]), rng.choice([1, 4, 60])
    film, second = FakeFilm(tiles, samples), rng.choice([1e-5, 1e-2, 3])
    portions, taken = Portions(film, samples), []
    restarts = rng.choice([0, 2])
    while portions or taken:
        while portions and len(taken) < 2 * cores:
            taken.append(portions.take(cores, 4))
        portion = taken.pop(rng.randrange(len(taken)))
        match rng.randrange(8):
            case 0:
                portions.put_back(portion)
            case 1:
                if not portions.halve(portion):
                    portions.put_back(portion)
            case _:
                film.add(portion)
                portions.done(portion, second * portions.size(portion) * rng.uniform(0.5, 2))
                if restarts and rng.random() < 0.05:  # goes on with the film alone
                    restarts -= 1
                    portions, taken = Portions(film, samples), []
        assert portions.left == sum(samples - len(has) for has in film.has)
    assert all(len(has) == samples for has in film.has)


def test_portions_become_shorter_towards_the_end():
    film, portions = FakeFilm(1000, 64), None
    portions = Portions(film, 64)
    sizes = []
    while portions:
        portion = portions.take(10, 4)
        film.add(portion)
        portions.done(portion, seconds := 0.01 * portions.size(portion))
        sizes.append(seconds)
    assert max(sizes) < 8 and max(sizes[-10:]) < 0.8
    assert 150 < len(sizes) < 2000


def test_portions_go_on_with_any_film():
    film = FakeFilm(37, 8)
    rng = random.Random(1)
    for has in film.has:
        has.update(range(rng.randrange(9)))
    portions = Portions(film, 8)
    while portions:
        portion = portions.take(2, 4)
        film.add(portion)
        portions.done(portion, 1)
    assert portions.left == 0


def same_bytes(image, other):
    return image._film.to_bytes() == other._film.to_bytes()


@pytest.mark.parametrize("options", [
    {}, {"channels": ["steps", "tests"]}, {"view": "steps"},
    {"integrator": "ambient", "outline": 1.5, "channels": ["depth", "id", "variance"]},
    {"crop": (30, 20, 200, 180)}, {"opacity": 0.5}, {"seed": 7, "accel": "grid"}])
def test_same_bytes(client, scene, options, tmp_path):
    want = scene.render(**SIZE, **options)
    image = distribute.render(scene, client=client, **SIZE, **options)
    assert same_bytes(image, want)
    for suffix in (".png", ".exr", ".npz"):
        image.save(tmp_path / f"a{suffix}")
        want.save(tmp_path / f"b{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_same_bytes_with_lights_and_cells(client):
    scene = raio.Scene()
    scene.spheres([[0, 0, 0]], 1, material=raio.Material(ks=0.4))
    scene.cylinders([[-2, -1.2, 0]], [[2, -1.2, 0]], 0.2)
    scene.light(position=(3, 4, 5), size=0.5)
    scene.camera((0, 1, 6), (0, 0, 0), up=(0, 1, 0), aperture=0.1)
    options = {"size": (100, 80), "aa": 4, "lens_samples": 2, "soft_shadows": True}
    assert same_bytes(distribute.render(scene, client=client, **options), scene.render(**options))


def test_files_are_read_by_the_workers(client, tmp_path):
    path = tmp_path / "atoms.xyz"
    path.write_text("3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")
    options = {"style": "ball-and-stick", "size": (120, 90), "samples": 8}
    image = distribute.render(path, client=client, **options)
    assert same_bytes(image, raio.render(path, **options))
    assert image.settings()["style"] == "ball-and-stick"


def test_environments_are_read_by_the_workers(client, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = {**SIZE, "environment": "sky.pfm", "integrator": "ambient"}
    for value in 1.0, 3.0:
        pathlib.Path("sky.pfm").write_bytes(b"PF\n2 1\n-1\n" + np.float32([value, 0, 0] * 2).tobytes())
        image = distribute.render(ROOT / "scenes/rings.nff", client=client, **options)
        assert image.settings()["environment"] == str(tmp_path / "sky.pfm")  # as all workers find it
        assert np.array_equal(image.numpy(), raio.render(ROOT / "scenes/rings.nff", **options).numpy())
    options = {**SIZE, "background": "sky"}
    image = distribute.render(ROOT / "scenes/rings.nff", client=client, **options)
    assert same_bytes(image, raio.render(ROOT / "scenes/rings.nff", **options))


@pytest.fixture
def sky(tmp_path):
    """A folder with the six faces of a sky."""
    folder = tmp_path / "sky"
    folder.mkdir()
    scene = raio.Scene(background="orange")
    scene.spheres([[0, 0, 0]], 1)
    for face in ("right", "left", "top", "bottom", "front", "back"):
        scene.render(size=(16, 16), samples=1).save(folder / f"{face}.png")
    return folder


def test_skies(client, scene, sky, tmp_path, monkeypatch):
    scene.background = None
    monkeypatch.chdir(tmp_path)  # not that of the workers
    options = {**SIZE, "background": "sky"}
    assert same_bytes(distribute.render(scene, client=client, **options), scene.render(**options))
    # A sky in files beside the scene's.
    path = tmp_path / "with.p3f"
    path.write_text("env sky\nv\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 64 64\n"
                    "l 1 2 3\nf 1 0 0 0.5 1 0 0 1\ns 0 0 0 1\n")
    small = {"size": (64, 48)}
    want = raio.render(path, **small)
    assert same_bytes(distribute.render(path, client=client, **small), want)
    loaded = raio.load(path)
    with pytest.raises(ValueError, match="sky is in files of its own.*; give the path"):
        distribute.render(loaded, client=client, **small)
    with pytest.raises(ValueError, match="sky is in files of its own.*; give the path"):
        distribute.animate([loaded], tmp_path / "{}.png", client=client, **small)
    with pytest.warns(raio.SceneWarning, match="sky is not in the bytes"):
        pickle.loads(pickle.dumps(loaded))
    other = {**small, "background": "red"}
    assert same_bytes(distribute.render(loaded, client=client, **other), loaded.render(**other))


def test_annotations_and_values(client):
    scene = raio.Scene()
    scene.spheres([[0, 0, 0], [2, 0, 0]], 1, colors=[1, 2], cmap="viridis")
    options = {"size": (300, 200), "samples": 2, "color_bar": "speed", "scale_bar": "nm"}
    try:
        want = scene.render(**options)
    except RuntimeError as error:
        pytest.skip(str(error))
    image = distribute.render(scene, client=client, **options)
    np.testing.assert_array_equal(image.display(), want.display())


def kill_a_worker(client, rng):
    pids = [worker["pid"] for worker in _alive(client).values()]
    if pids:
        os.kill(rng.choice(pids), signal.SIGKILL)


def _alive(client):
    pids = client.run(os.getpid, on_error="ignore")
    return {address: {"pid": pid} for address, pid in pids.items() if isinstance(pid, int)}


def test_killed_workers_cost_no_byte(cluster, client, scene):
    options = {"size": (500, 400), "samples": 200}
    want = scene.render(**options)
    rng, stop, kills = random.Random(3), threading.Event(), []

    def kill():
        with distributed.Client(cluster) as killer:
            while not stop.wait(0.7) and len(kills) < 4:
                kill_a_worker(killer, rng)
                kills.append(time.monotonic())

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        image = distribute.render(scene, client=client, task_seconds=0.5, **options)
    finally:
        stop.set()
        thread.join()
    assert kills
    assert same_bytes(image, want)


def test_an_interrupted_picture_is_continued(client, scene, tmp_path, monkeypatch):
    path = tmp_path / "so-far.raio"
    options = {**SIZE, "checkpoint": path, "checkpoint_interval": 0.01}
    taken = []
    take = distribute._Picture._take

    def few(self, portion, result):
        if len(taken) == 10:
            raise KeyboardInterrupt
        taken.append(portion)
        take(self, portion, result)

    monkeypatch.setattr(distribute._Picture, "_take", few)
    with pytest.raises(KeyboardInterrupt):
        distribute.render(scene, client=client, **options)
    so_far = raio.load_film(path)
    assert so_far.missing and taken

    again = []

    def rest(self, portion, result):
        again.append(portion)
        take(self, portion, result)

    monkeypatch.setattr(distribute._Picture, "_take", rest)
    with pytest.raises(ValueError, match="so-far.raio: it already exists; add resume"):
        distribute.render(scene, client=client, **options)
    image = distribute.render(scene, client=client, resume=True, **options)
    assert same_bytes(image, scene.render(**SIZE))
    assert again and path.read_bytes() == image._film.to_bytes()

    def work(portions):  # pairs of tiles and samples
        tiles = image._film.tiles()
        return [(t, k) for p in portions for t in range(p.shard, tiles, p.shards) for k in range(p.first, p.end)]

    assert not set(work(taken)) & set(work(again)), "rendered twice"
    options["samples"] = 30  # more than before
    assert same_bytes(distribute.render(scene, client=client, resume=True, **options),
                      scene.render(**{**SIZE, "samples": 30}))
    for other, text in ({"samples": 24}, "already has 30 samples"), ({"seed": 3}, "seed"):
        with pytest.raises(ValueError, match=f"so-far.raio: .*{text}"):
            distribute.render(scene, client=client, resume=True, **{**options, **other})


def test_the_picture_refines_where_it_is_looked_at(client, scene, tmp_path, monkeypatch):
    monkeypatch.setattr(distribute._Shown, "PAUSE_S", 0.0)
    seen = []
    distribute.render(scene, client=client, preview=lambda image: seen.append(image.numpy()[..., 3].mean()), **SIZE)
    assert len(seen) > 2
    path = tmp_path / "so-far.png"
    image = distribute.render(scene, client=client, preview=path, **SIZE)
    image.save(tmp_path / "picture.png")
    assert path.read_bytes() == (tmp_path / "picture.png").read_bytes()
    with pytest.raises(OSError, match="preview: the folder .*no is missing"):
        distribute.render(scene, client=client, preview=tmp_path / "no" / "a.png")
    with pytest.raises(ValueError, match="ends in .png or .ppm"):
        distribute.render(scene, client=client, preview="picture.exr")
    with pytest.raises(ValueError, match="needs a notebook"):
        distribute.render(scene, client=client, preview=True)


def test_progress(client, scene):
    seen = []
    distribute.render(scene, client=client, progress=lambda stage, share: seen.append((stage, share)), **SIZE)
    shares = [share for _, share in seen]
    assert shares == sorted(shares) and shares[-1] == 1 and {stage for stage, _ in seen} == {"rendering"}


def test_cancelled_workers_are_soon_free(client, scene):
    def stop(image):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):  # while portions of ten minutes are rendered
        distribute.render(scene, client=client, size=(400, 300), samples=10_000_000, task_seconds=600, preview=stop)
    workers = list(client.scheduler_info()["workers"])
    for future in [client.submit(abs, -1, workers=worker, pure=False) for worker in workers]:
        assert future.result(timeout=100) == 1


def test_another_version_is_refused_by_name(client, scene, monkeypatch):
    monkeypatch.setattr(_tasks, "_raio", types.SimpleNamespace(version=lambda: "9.8.7"))
    with pytest.raises(RuntimeError, match=r"client has raio 9\.8\.7, but the worker .* has raio"):
        distribute.render(scene, client=client, **SIZE)


WITHOUT_RAIO = "import sys; sys.modules['raio'] = None"  # code that Dask runs first


def test_workers_without_raio_are_refused(scene, tmp_path):
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0",
                                  preload=[WITHOUT_RAIO]) as cluster, distributed.Client(cluster) as client:
        with pytest.raises(RuntimeError, match="a worker cannot run raio .*; install the client's version"):
            distribute.render(scene, client=client, **SIZE)
        for frames in [scene], lambda index: scene:
            with pytest.raises(RuntimeError, match="a worker cannot run raio"):
                distribute.animate(frames, tmp_path / "{}.png", client=client, count=1 if callable(frames) else None)


def test_the_scheduler_needs_no_raio(scene, tmp_path):
    file = tmp_path / "scheduler.json"
    arguments = ["--scheduler-file", file, "--no-dashboard"]
    scheduler = subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_scheduler", *arguments, "--port", "0",
                                  "--preload", WITHOUT_RAIO])
    worker = subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_worker", *arguments, "--no-nanny",
                               "--nthreads", "1"])
    try:
        with distributed.Client(scheduler_file=file, timeout=120) as client:
            assert same_bytes(distribute.render(scene, client=client, **SIZE), scene.render(**SIZE))
            path, = distribute.animate([scene], tmp_path / "{}.png", client=client, **SIZE)
            scene.render(**SIZE).save(tmp_path / "one.png")
            assert path.read_bytes() == (tmp_path / "one.png").read_bytes()
    finally:
        for process in worker, scheduler:
            process.terminate()
            process.wait()


def test_workers_that_end_again_and_again(scene, tmp_path):
    ending = "import os, raio._worker as w; w.portion = w.frame = lambda *_: os._exit(1)"
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0", preload=[ending],
                                  scheduler_kwargs={"allowed_failures": 0}) as cluster, \
            distributed.Client(cluster) as client:
        with pytest.raises(MemoryError, match="^1 workers ended .* tcp://.* give workers more"):
            distribute.render(scene, client=client, **SIZE)
        with pytest.warns(RuntimeWarning, match="^frame 0 is tried once more: 1 workers ended"), \
                pytest.raises(MemoryError, match="^frame 0: 1 workers ended"):
            distribute.animate([scene], tmp_path / "{}.png", client=client, **SIZE)


def test_a_cluster_that_is_closed(scene):
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as cluster, \
            distributed.Client(cluster) as client:
        closing = []

        def close(image):
            if not closing:
                closing.append(threading.Thread(target=cluster.close))
                closing[0].start()

        with pytest.raises(ConnectionError):
            distribute.render(scene, client=client, size=(400, 300), samples=10_000_000, preview=close)
        closing[0].join()


def test_a_small_worker_refuses_a_large_scene(scene):
    rng = np.random.default_rng(1)
    scene.spheres(rng.random((3_000_000, 3), np.float32), 0.01)
    # Dask would kill the worker near its limit, sometimes before the error has reached the client.
    with dask.config.set({"distributed.worker.memory.terminate": False}), \
            distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0",
                                     memory_limit="450 MB") as cluster, distributed.Client(cluster) as client:
        with pytest.raises(MemoryError, match="does not fit into the worker .* whose memory limit is"):
            distribute.render(scene, client=client, **SIZE)


def test_what_is_refused(client, scene, tmp_path):
    refused = [
        (TypeError, "threads is not for", {"threads": 4}),
        (TypeError, "shard is not for", {"shard": "1/2"}),
        (TypeError, "time_limit is not for", {"time_limit": 3}),
        (TypeError, "resume has no effect without checkpoint", {"resume": True}),
        (TypeError, "unknown option 'sampels'", {"sampels": 4}),
        (TypeError, "style is an option for reading", {"style": "sticks"}),
        (ValueError, "task_seconds: expected", {"task_seconds": 0}),
        (ValueError, "ends in .raio", {"checkpoint": "a.png"}),
        (OSError, "no/a.raio", {"checkpoint": tmp_path / "no" / "a.raio"}),
        (TypeError, "task_seconds: expected a number, found '4'", {"task_seconds": "4"}),
        (TypeError, "checkpoint: expected", {"checkpoint": b"a.raio"}),
        (ValueError, "checkpoint: expected", {"checkpoint": 3}),
        (ValueError, "checkpoint.interval", {"checkpoint": "a.raio", "checkpoint_interval": 0}),
        (TypeError, "preview: expected", {"preview": 3}),
        (TypeError, "progress: expected", {"progress": "yes"}),
    ]
    for error, text, options in refused:
        with pytest.raises(error, match=text):
            distribute.render(scene, client=client, **{**SIZE, **options})
    with pytest.raises(TypeError, match=r"client: expected a dask\.distributed\.Client"):
        distribute.render(scene, client="tcp://localhost", **SIZE)
    with pytest.raises(FileNotFoundError):
        distribute.render(tmp_path / "no.nff", client=client)
    with pytest.raises(TypeError, match="scene: expected a Scene or the path"):
        distribute.render(3, client=client)


def test_without_a_client(scene):
    with pytest.raises(ValueError, match="client: expected"):
        distribute.render(scene, **SIZE)


def test_errors_of_workers_reach_the_caller(client, tmp_path):
    path = tmp_path / "ball.nff"
    path.write_text("v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 64 64\nb 0 0 0\nl 1 2 3\n"
                    "f 1 0 0 1 0 0 0 0\ns 0 0 0 1\n")
    source = ("key", str(path) + ".gone", ())
    client.wait_for_workers(1)
    future = client.submit(_worker.checked, raio.__version__, "portion", pickle.dumps((source, {}, {}, 0, 1, 0, 1)),
                           pure=False)
    with pytest.raises(FileNotFoundError, match="worker . has no file .*ball.nff.gone"):
        future.result()
    with pytest.raises(FileNotFoundError, match="worker . has no file .*ball.nff.gone"):
        distribute.animate(lambda index: source[1], tmp_path / "{}.png", client=client, count=1)


# --- movies


def moving(index):
    scene = raio.Scene(background="white")
    scene.spheres([[0, 0, 0], [1 + index, 0, 0]], 1, colors=["red", "blue"][index % 2])
    return scene


FRAME = {"size": (64, 48), "samples": 4}


def test_frames_of_a_function(client, tmp_path):
    paths = distribute.animate(moving, tmp_path / "frame-{:02d}.png", client=client, count=5, **FRAME)
    assert [path.name for path in paths] == [f"frame-{i:02d}.png" for i in range(5)]
    with pytest.warns(RuntimeWarning, match="5 of 5 pictures exist and are kept"):
        assert distribute.animate(moving, tmp_path / "frame-{:02d}.png", client=client, count=5, **FRAME) == paths
    for i, path in enumerate(paths):
        moving(i).render(**FRAME).save(tmp_path / "one.png")
        assert path.read_bytes() == (tmp_path / "one.png").read_bytes()


def test_a_function_that_cannot_travel(client, tmp_path):
    lock = threading.Lock()
    with pytest.raises(TypeError, match="^frames: the function cannot be sent to workers .*lock"):
        distribute.animate(lambda index: lock, tmp_path / "{}.png", client=client, count=2)


def test_missing_and_changed_frames_are_made(client, tmp_path):
    files = []
    for i in range(4):
        files.append(tmp_path / f"{i}.xyz")
        files[-1].write_text(f"2\n\nO 0 0 0\nH {i + 1} 0 0\n")
    pattern = str(tmp_path / "out/frame-{}.png")
    paths = distribute.animate(files, pattern, client=client, **FRAME)
    made = [path.stat().st_mtime_ns for path in paths]
    assert distribute.animate(files, pattern, client=client, **FRAME) == paths
    assert [path.stat().st_mtime_ns for path in paths] == made
    with pytest.raises(TypeError, match="style is an option for reading"):
        distribute.animate([moving(0)], tmp_path / "s{}.png", client=client, style="sticks", **FRAME)
    paths[1].unlink()
    files[2].write_text("2\n\nO 0 0 0\nH 9.5 0 0\n")
    distribute.animate(files, pattern, client=client, **FRAME)
    assert [path.stat().st_mtime_ns == before for path, before in zip(paths, made)] == [True, False, False, True]
    raio.render(files[2], **FRAME).save(tmp_path / "one.png")
    assert paths[2].read_bytes() == (tmp_path / "one.png").read_bytes()
    with pytest.raises(ValueError, match="made with other options .size 64x48, not 32x24"):
        distribute.animate(files, pattern, client=client, **{**FRAME, "size": (32, 24)})
    record = tmp_path / "out/frame-all.json"
    for text in "[]", "{}", '{"options": 3, "frames": {}}', "{":
        record.write_text(text)
        with pytest.raises(ValueError, match="frame-all.json, which tells .* is damaged"):
            distribute.animate(files, pattern, client=client, **FRAME)
    record.unlink()
    with pytest.raises(ValueError, match="frame-0.png already exists, without frame-all.json"):
        distribute.animate(files, pattern, client=client, **FRAME)


def test_frames_that_are_scenes(client, tmp_path):
    scenes = [moving(i) for i in range(3)]
    paths = distribute.animate(scenes, tmp_path / "{}.exr", client=client, channels=["depth"], **FRAME)
    scenes[1].render(channels=["depth"], **FRAME).save(tmp_path / "one.exr")
    assert paths[1].read_bytes() == (tmp_path / "one.exr").read_bytes()


def guessing(index):
    warnings.warn("guessed", raio.SceneWarning, stacklevel=1)
    return moving(index)


def failing(index):
    if index == 2:
        raise OSError("no such step")
    return moving(index)


def test_reports_and_failures_of_frames(client, tmp_path):
    with pytest.warns(raio.SceneWarning, match="frame .: guessed") as reported:
        distribute.animate(guessing, tmp_path / "{}.png", client=client, count=3, **FRAME)
    assert len([w for w in reported if "guessed" in str(w.message)]) == 1
    with pytest.raises(OSError, match="no such step") as failure:
        distribute.animate(failing, tmp_path / "b{}.png", client=client, count=4, **FRAME)
    assert failure.value.__notes__ == ["while frame 2 was made"]
    for arguments, error, text in [
            ((moving, "a{}.mp4", 2), ValueError, "with the suffix of a picture"),
            ((moving, "a.png", 2), ValueError, "expected a pattern such as"),
            ((moving, "a{x}.png", 2), ValueError, "expected a pattern such as"),
            ((moving, "a{:.0s}.png", 2), ValueError, "expected a pattern such as"),
            ((moving, "a{}.png", None), ValueError, "count: expected"),
            ((moving, "a{}.png", "2"), TypeError, "count: expected a whole number, found '2'"),
            (([moving(0)], "a{}.png", 1), TypeError, "count: only for a function; frames is a list of 1"),
            (([], "a{}.png", None), ValueError, "at least one"),
            (("ab", "a{}.png", None), TypeError, "expected a list"),
            (([1], "a{}.png", None), TypeError, "found int for frame 0")]:
        with pytest.raises(error, match=text):
            distribute.animate(arguments[0], tmp_path / arguments[1], count=arguments[2], client=client)
    assert Portion(0, 1, 0, 1) == (0, 1, 0, 1)


def test_encrypted_connections():
    pytest.importorskip("cryptography")
    with distributed.LocalCluster(n_workers=1, threads_per_worker=2, dashboard_address=":0",
                                  security=True) as cluster, distributed.Client(cluster) as client:
        assert client.scheduler.address.startswith("tls://")
        scene = moving(1)
        assert same_bytes(distribute.render(scene, client=client, **FRAME), scene.render(**FRAME))


# --- SLURM, without Python


@pytest.fixture
def sbatch(program, tmp_path):
    """Runs a script of examples/slurm with a job's variables: its status and what it reports."""
    step = tmp_path / "bin" / "srun"
    step.parent.mkdir()
    step.write_text('#!/bin/bash\nwhile [[ $1 == --* ]]; do shift; done\nexec "$@"\n')
    step.chmod(0o755)

    def run(script, *arguments, job=0, jobs=2, **variables):
        slurm = {"SLURM_ARRAY_TASK_ID": job, "SLURM_ARRAY_TASK_COUNT": jobs, "SLURM_ARRAY_TASK_MAX": jobs - 1}
        texts = {name: str(value) for name, value in {**slurm, **variables}.items()}
        done = subprocess.run(["bash", ROOT / "examples/slurm" / script, *arguments], text=True, capture_output=True,
                              env={**os.environ, **texts, "RAIO": str(program),
                                   "PATH": f"{step.parent}:{os.environ['PATH']}"})
        return done.returncode, done.stderr

    return run


def test_scripts_of_slurm(sbatch, tmp_path, program):
    atoms = tmp_path / "atoms.xyz"
    atoms.write_text("3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")
    options = ["--size", "400x300", "--samples", "2"]
    for job in 0, 1, 1:  # the last one was requeued
        assert sbatch("render.sbatch", atoms, *options, "--checkpoint-interval", "9", job=job)[0] == 0
    for arguments, variables, text in [
            ([atoms], {"jobs": 3}, "array of another size, not of 3; delete .*atoms.xyz.parts"),
            ([atoms, "-o", "a.png"], {}, "-o is set by this script"),
            ([atoms, "--shard=1/2"], {}, "--shard is set by this script"),
            ([atoms, "--checkpoint", "a.raio"], {}, "--checkpoint is set by this script"),
            ([atoms], {"RAIO_SHARDS": "two"}, "RAIO_SHARDS: expected the number of parts, found two"),
            ([tmp_path / "no.xyz"], {}, "has no scene .*no.xyz")]:
        status, said = sbatch("render.sbatch", *arguments, **variables)
        assert status == 2 and re.search(text, said), said
    # Annotations, as docs/cluster.md tells.
    legend, whole = [*options, "--legend"], tmp_path / "whole.raio"
    assert sbatch("merge.sbatch", atoms, whole)[0] == 0
    for path, more in (tmp_path / "a.png", ["--checkpoint", whole, "--resume"]), (tmp_path / "b.png", []):
        done = subprocess.run([program, "render", atoms, *legend, *more, "-o", path], capture_output=True, text=True)
        if "Cairo" in done.stderr:
            pytest.skip(done.stderr)
        assert done.returncode == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
