"""Long work: progress, Ctrl-C, threads, processes, films."""

import multiprocessing
import os
import pickle
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
import raio
from conftest import pixels


def run(code, **options):
    """Runs a Python program."""
    return subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True,
                          timeout=120, **options)


def test_progress_is_reported(cloud):
    scene, *_ = cloud
    told = []
    scene.render(size=(600, 450), samples=64, progress=lambda stage, share: told.append((stage, share)))
    assert told and told[-1][0] == "rendering"
    assert all(0 <= share <= 1 for _, share in told)
    assert [s for _, s in told] == sorted(s for _, s in told)


def test_an_error_of_the_progress_function_ends_the_work(cloud):
    scene, *_ = cloud

    def fail(stage, share):
        raise RuntimeError("enough")

    before = pixels(scene)
    start = time.monotonic()
    with pytest.raises(RuntimeError, match="enough"):
        scene.render(size=(4000, 3000), samples=1000, progress=fail)
    assert time.monotonic() - start < 30  # far less than the picture takes
    assert np.array_equal(pixels(scene), before)


def test_progress_needs_no_terminal():
    done = run("""
        import raio
        scene = raio.Scene()
        scene.spheres([[0, 0, 0]], 1)
        scene.render(size=(600, 450), samples=64, progress=True)
        """)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "" and "\x1b" not in done.stderr


CTRL_C = """
    import os, signal, threading, time, numpy as np, raio
    scene = raio.Scene()
    scene.spheres(np.random.default_rng(1).uniform(-5, 5, (20000, 3)), 0.2)
    scene.render(size=(8, 8))
    def press():
        time.sleep(0.5)
        press.at = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)
    threading.Thread(target=press).start()
    try:
        scene.render(size=(8000, 6000), samples=1000)
    except KeyboardInterrupt:
        print(time.monotonic() - press.at)
    print(scene.render(size=(8, 8), samples=4).numpy().sum() > 0)
"""


def test_ctrl_c_stops_and_leaves_everything_usable():
    done = run(CTRL_C)
    seconds, usable = done.stdout.split()
    assert float(seconds) < 10 and usable == "True"


def test_two_threads_render_at_the_same_time(cloud):
    scene, *_ = cloud
    other = raio.Scene()
    other.spheres([[0, 0, 0]], 1)
    expected = [pixels(scene, samples=16), pixels(other, samples=16), pixels(scene, samples=16)]
    results = [None] * 3

    def work(i):
        results[i] = pixels((scene, other, scene)[i], samples=16)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(a, b) for a, b in zip(results, expected))


def test_the_gil_is_free_while_a_picture_is_rendered(cloud):
    scene, *_ = cloud
    counted, done = [], threading.Event()

    def count():
        while not done.is_set():
            counted.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    scene.render(size=(600, 450), samples=64)
    done.set()
    thread.join()
    assert len(counted) > 20


def test_writes_during_a_render_do_not_crash():
    done = run("""
        import threading, numpy as np, raio
        rng = np.random.default_rng(1)
        scene = raio.Scene()
        centers = rng.uniform(-5, 5, (5000, 3)).astype(np.float32)
        radii = np.full(5000, 0.2, np.float32)
        scene.spheres(centers, radii, colors=rng.random((5000, 3)).astype(np.float32))
        corners = rng.uniform(-5, 5, (300, 3)).astype(np.float32)
        faces = rng.integers(0, 300, (1000, 3), dtype=np.uint32)
        scene.mesh(corners, faces)
        stop = threading.Event()
        def write():
            while not stop.is_set():
                centers[:] = rng.choice([np.nan, np.inf, 1e30, 0], (5000, 3))
                corners[:] = rng.choice([np.nan, -np.inf, 1e38, 0], (300, 3))
                radii[:] = rng.choice([-1, np.nan, 1e30], 5000)
                faces[:] = 4294967295
        thread = threading.Thread(target=write, daemon=True)
        thread.start()
        for i in range(20):
            try:
                scene.render(size=(200, 150), samples=4)
            except ValueError:  # the camera does not fit such a scene
                pass
            if i % 5 == 0:
                scene._change(geometry=True)
        stop.set(); thread.join()
        print("fine")
        """)
    assert done.stdout.strip() == "fine", done.stderr


def child(queue):
    try:
        scene = raio.Scene()
        scene.spheres([[0, 0, 0]], 1)
        queue.put(pixels(scene).sum())
    except RuntimeError as error:
        queue.put(str(error))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_is_refused_with_advice_and_spawn_works(cloud):
    scene, *_ = cloud
    pixels(scene)
    for method, expected in (("fork", str), ("spawn", np.floating)):
        context = multiprocessing.get_context(method)
        queue = context.Queue()
        process = context.Process(target=child, args=(queue,))
        process.start()
        result = queue.get(timeout=60)
        process.join()
        assert isinstance(result, expected)
        if method == "fork":
            assert "spawn" in result


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
def test_a_fork_before_the_first_use_is_fine():
    done = run("""
        import os, sys, numpy as np, raio
        scene = raio.Scene
        child = os.fork()
        s = raio.Scene(); s.spheres([[0, 0, 0]], 1)
        ok = s.render(size=(8, 8)).numpy().shape == (8, 8, 4)
        if child == 0: os._exit(0 if ok else 1)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        """)
    assert done.stdout.strip() == "0", done.stderr


def test_films_are_refined_stored_resumed_and_merged(cloud, tmp_path):
    scene, *_ = cloud
    whole = pixels(scene, samples=16)
    film = scene.start(size=(40, 30))
    assert film.samples == 0 and film._repr_png_() is None
    with pytest.raises(ValueError, match="no samples"):
        film.image()
    film.add(3).add(5)
    film.save(tmp_path / "part.raio")
    resumed = raio.load_film(tmp_path / "part.raio", scene, size=(40, 30))
    assert resumed.samples == 8
    assert np.array_equal(resumed.add(8).image().numpy(), whole)
    copy = pickle.loads(pickle.dumps(film))
    assert np.array_equal(copy.add(8).image().numpy(), whole)
    parts = [scene.render(size=(40, 30), samples=16, sample_range=span) for span in ((0, 5), (5, 16))]
    assert np.array_equal(raio.merge(parts).image().numpy(), whole)
    shards = [scene.render(size=(40, 30), samples=16, shard=f"{i}/3") for i in (3, 1, 2)]
    merged = raio.merge(shards)
    assert merged.missing == "" and np.array_equal(merged.image().numpy(), whole)
    with pytest.raises(ValueError):
        raio.merge([parts[0], parts[0]])
    with pytest.raises(TypeError, match="expected Films and Images"):
        raio.merge(["part.raio"])
    with pytest.raises(TypeError, match="samples is not for start"):
        scene.start(samples=4)
    with pytest.raises(ValueError, match="no scene"):
        merged.add(1)


def test_threads_may_add_to_one_film(cloud):
    scene, *_ = cloud
    film = scene.start(size=(40, 30))
    threads = [threading.Thread(target=film.add, args=(n,)) for n in (1, 2, 3, 4, 5, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert film.samples == 16
    assert np.array_equal(film.image().numpy(), pixels(scene, samples=16))


def test_images_have_channels_settings_and_formats(cloud, tmp_path):
    scene, *_ = cloud
    image = scene.render(size=(40, 30), samples=4, channels=["depth", "id", "normal", "alpha"],
                         background="transparent")
    assert image.size == (40, 30)
    assert set(image.channels) == {"depth", "id", "normal", "alpha"}
    assert image["depth"].shape == (30, 40) and image["depth"].dtype == np.float32
    assert image["normal"].shape == (30, 40, 3)
    assert image["id"].dtype == np.uint32
    with pytest.raises(KeyError, match="depth"):
        image["albedo"]
    assert image.display().dtype == np.uint8 and np.asarray(image).shape == (30, 40, 4)
    assert image.settings()["size"] == "40x30" and image.settings()["samples"] == "4"
    image.save(tmp_path / "a.npz")
    stored = np.load(tmp_path / "a.npz")
    assert np.array_equal(stored["depth"], image["depth"])
    assert np.array_equal(stored["rgba"], image.numpy())
    assert image._repr_png_().startswith(b"\x89PNG")
    image.save(tmp_path / "a.png")  # without the channels
    assert (tmp_path / "a.png").read_bytes() == image._repr_png_()
    with pytest.raises(ValueError, match="alpha"):
        image.save(tmp_path / "a.ppm")
    with pytest.raises(OSError):
        image.save(tmp_path / "no" / "a.exr")
    assert not list(tmp_path.glob("*.ppm"))
