"""Videos and sequences of pictures."""

import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest
import raio

SMALL = {"size": (32, 24), "samples": 1}
needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is missing")


def scene(index: int = 0) -> raio.Scene:
    made = raio.Scene()
    made.spheres([[0, 0, 0]], 1 + 0.2 * index, colors="orange")
    made.camera((0, -9, 0), (0, 0, 0))
    return made


def test_pictures(tmp_path: Path):
    paths = raio.movie(scene, tmp_path / "new" / "f-{:03d}.png", count=3, **SMALL)
    assert [p.name for p in paths] == ["f-000.png", "f-001.png", "f-002.png"]
    scene(2).render(**SMALL).save(tmp_path / "one.png")
    assert paths[2].read_bytes() == (tmp_path / "one.png").read_bytes()
    assert sorted(p.name for p in (tmp_path / "new").iterdir()) == [p.name for p in paths]


def test_a_generator_may_change_one_scene(tmp_path: Path):
    def frames():
        one = scene()
        for radius in (0.5, 1.5):
            one._parts[0].radii = radius
            yield one

    told = []
    a, b = raio.movie(frames(), tmp_path / "{}.png", progress=lambda *t: told.append(t), count=2,
                      **SMALL)
    assert a.read_bytes() != b.read_bytes()
    assert [share for _, share in told] == [0.5, 1]


def test_whole_or_not_at_all(tmp_path: Path):
    (tmp_path / "0.png").write_text("old")

    def frames():
        yield scene()
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        raio.movie(frames(), tmp_path / "{}.png", **SMALL)
    assert [p.name for p in tmp_path.iterdir()] == ["0.png"]
    assert (tmp_path / "0.png").read_text() == "old"


def test_refuses(tmp_path: Path, monkeypatch):
    image = scene().render(**SMALL)
    with pytest.raises(ValueError, match="size"):
        raio.movie([image, scene().render(size=(30, 24), samples=1)], tmp_path / "{}.png")
    for path, frames, message in (("a.gif", [image], "frame-"), ("{}.png", [], "at least one"),
                                  ("{}.png", lambda i: image, "count"), ("{{}}.png", [image], "same")):
        with pytest.raises(ValueError, match=message):
            raio.movie(frames, tmp_path / path)
    with pytest.raises(TypeError, match="frame 0"):
        raio.movie([3], tmp_path / "{}.png")
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(RuntimeError, match="install ffmpeg"):
        raio.movie([image], tmp_path / "a.mp4")
    assert not list(tmp_path.iterdir())


def test_display_is_the_picture_file(tmp_path: Path):
    pil = pytest.importorskip("PIL.Image")
    made = scene()
    made.spheres([[1.5, 0, 0]], 0.5, opacity=0.5)
    image = made.render(background="transparent", **SMALL)
    image.save(tmp_path / "a.png")
    shown, visible = image.display(), image.display()[..., 3] > 0
    with pil.open(tmp_path / "a.png") as file:
        assert np.array_equal(np.asarray(file.convert("RGBA"))[visible], shown[visible])


def decoded(path: Path, width: int, height: int) -> np.ndarray:
    data = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", path, "-f", "rawvideo", "-pix_fmt",
                           "rgb24", "-"], capture_output=True, check=True).stdout
    return np.frombuffer(data, np.uint8).reshape(-1, height, width, 3)


@needs_ffmpeg
@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_video(tmp_path: Path, suffix: str):
    [path] = raio.movie(scene, tmp_path / f"a{suffix}", count=5, fps=10, size=(64, 48), samples=4)
    shown = decoded(path, 64, 48).astype(int)
    assert len(shown) == 5
    expected = scene(4).render(size=(64, 48), samples=4).display()[..., :3]
    assert np.abs(shown[4] - expected).mean() < 6
    assert np.abs(shown[4, 24, 32] - expected[24, 32]).max() < 12
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@needs_ffmpeg
def test_odd_sizes(tmp_path: Path):
    with pytest.warns(UserWarning, match="34 x 26"):
        [path] = raio.movie([scene()], tmp_path / "a.mp4", size=(33, 25), samples=1)
    shown = decoded(path, 34, 26)
    assert shown[0, -1, -1].min() > 240  # white, as the background


@needs_ffmpeg
def test_transparent_frames_are_refused(tmp_path: Path):
    with pytest.raises(ValueError, match="frame 0 is transparent"):
        raio.movie([scene()], tmp_path / "a.mp4", background="transparent", **SMALL)


@needs_ffmpeg
@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_leaves_nothing(tmp_path: Path):
    program = textwrap.dedent("""
        import sys, raio
        def frames():
            scene = raio.Scene()
            scene.spheres([[0, 0, 0]], 1)
            while True:
                yield scene
                print("frame", flush=True)
        raio.movie(frames(), sys.argv[1], size=(64, 48), samples=1)
    """)
    process = subprocess.Popen([sys.executable, "-c", program, tmp_path / "a.mp4"], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout.readline() == "frame\n"
    # ffmpeg is a child of the process until it ends.
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    child = int(children.read_text().split()[0]) if children.exists() else None
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert "KeyboardInterrupt" in errors
    assert not list(tmp_path.iterdir())
    if child:
        time.sleep(0.1)
        assert not Path(f"/proc/{child}").exists()
