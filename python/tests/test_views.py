"""Scene.view() without a browser: messages in, frames out."""

import gc
import queue
import struct
import sys
import zlib

import numpy as np
import pytest
import raio
from raio import views
from raio._live import Live, Pace, png
from raio._turntable import Camera

WAIT = 20  # seconds, at most


def make_scene():
    scene = raio.Scene()
    points = np.random.default_rng(1).uniform(-5, 5, (500, 3)).astype(np.float32)
    scene.spheres(points, 0.5, colors="orange")
    return scene


def pixels_of(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunks[kind] = data[at + 8:at + 8 + length]
        at += 12 + length
    width, height, _, color = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    lines = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8)
    steps = lines.reshape(height, -1)[:, 1:].astype(np.uint32)
    return np.cumsum(steps, axis=0).astype(np.uint8).reshape(height, width, 4 if color == 6 else 3)


class FrontEnd:
    def __init__(self, scene, **options):
        self.messages = queue.Queue()
        self.live = Live(scene, options, lambda message, buffers: self.messages.put(
            (message, buffers)))

    def say(self, kind, **more):
        self.live.receive({"type": kind, **more})

    def next(self):
        return self.messages.get(timeout=WAIT)

    def frame(self, until=lambda message: True):
        """The next frame that fits; acknowledges all on the way."""
        while True:
            message, buffers = self.next()
            if message["type"] == "error":
                raise AssertionError(message["text"])
            if message["type"] != "frame":
                continue
            self.say("ack", frame=message["frame"])
            if until(message):
                return message, pixels_of(buffers[0])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.live.close()
        assert self.live.join(WAIT)


def is_complete(message):
    return not message["moving"] and message["samples"] == message["of"]


def test_refines_to_the_picture_of_render():
    scene = make_scene()
    with FrontEnd(scene, size=(64, 48), samples=8) as front:
        front.say("hello")
        message, pixels = front.frame(is_complete)
        assert message["samples"] == 8
        expected = scene.render(size=(64, 48), samples=8).display()
        assert (pixels == expected[:, :, :3]).all()


def test_sends_no_second_frame_before_the_first_has_arrived():
    with FrontEnd(make_scene(), size=(32, 24), samples=4) as front:
        front.say("hello")
        while (message := front.next()[0])["type"] != "frame":
            pass
        with pytest.raises(queue.Empty):
            front.messages.get(timeout=0.2)
        front.say("ack", frame=message["frame"])
        assert front.next()[0]["frame"] == message["frame"] + 1


def test_turns_and_comes_back():
    with FrontEnd(make_scene(), size=(64, 48), samples=2) as front:
        front.say("hello")
        _, before = front.frame(is_complete)
        front.say("turn", dx=100, dy=20, height=480)
        message, small = front.frame(lambda m: m["moving"])
        assert message["samples"] == 1 and small.shape[0] <= 48
        _, turned = front.frame(is_complete)
        assert (turned != before).any()
        front.say("ack", frame=message["frame"], gestures=[{"type": "reset"}])
        _, again = front.frame(is_complete)
        assert (again == before).all()


def test_the_first_moved_frame_has_the_scale_of_the_still_one():
    for size in [(90, 30), (30, 90)]:
        scene = make_scene()
        with FrontEnd(scene, size=size, samples=2) as front:
            front.say("hello")
            _, before = front.frame(is_complete)
            front.say("pan", dx=0, dy=0, height=480)
            _, moved = front.frame(is_complete)
            assert (moved == before).mean() > 0.98


def test_a_changed_scene_is_rendered_again():
    scene = make_scene()
    with FrontEnd(scene, size=(32, 24), samples=2) as front:
        front.say("hello")
        _, before = front.frame(is_complete)
        scene.spheres([[0, 0, 0]], 20)
        front.live.refresh()
        _, after = front.frame(is_complete)
        assert (before != after).any()


def test_shows_errors_and_lives_on():
    scene = make_scene()
    with FrontEnd(scene, size=(32, 24), samples=1, accel="grid", grid_factor=-1) as front:
        front.say("hello")
        message, _ = front.next()
        assert message["type"] == "error" and "grid_factor" in message["text"]
        del front.live._options["grid_factor"]
        front.live.refresh()
        front.frame(is_complete)


def test_closing_ends_the_thread_in_the_middle_of_work():
    front = FrontEnd(make_scene(), size=(1600, 1200), samples=4096)
    front.say("hello")
    while front.next()[0]["type"] != "frame":
        pass
    front.live.close()
    assert front.live.join(WAIT)


def test_camera_turns_as_in_the_window():
    camera = Camera(np.array([0.0, -10, 0]), np.zeros(3), np.array([0.0, 0, 1]), 45)
    quarter = camera.turned(np.zeros(3), 240, 0, 480)
    assert np.allclose(quarter.from_, [-10, 0, 0])
    above = camera.turned(np.zeros(3), 0, 10_000, 480)
    assert 9.9 < above.from_[2] < 10  # short of the pole
    nearer = camera.zoomed(np.zeros(3), 1)
    assert np.allclose(nearer.from_, [0, -8.8, 0])
    assert np.allclose(camera.panned(np.zeros(3), 480, 0, 480).at[0], -20 * np.tan(np.pi / 8))


def test_pace_follows_the_time():
    pace = Pace()
    for _ in range(20):
        pace.measure(pace.scale, 1.0 * pace.scale**2)
    assert 0.2 < pace.scale < 0.35
    for _ in range(20):
        pace.measure(pace.scale, 0.01)
    assert pace.scale == 1


def test_png_keeps_all_bytes():
    pixels = np.random.default_rng(1).integers(0, 256, (7, 5, 4), dtype=np.uint8)
    assert (pixels_of(png(pixels)) == pixels).all()
    pixels[:, :, 3] = 255
    assert (pixels_of(png(pixels)) == pixels[:, :, :3]).all()


# --- what view() chooses


def test_widget(monkeypatch):
    pytest.importorskip("anywidget")
    monkeypatch.setattr(views, "_is_in_notebook", lambda: True)
    widget = make_scene().view(size=(48, 32), samples=2)
    data = widget._repr_mimebundle_()[0]
    assert "application/vnd.jupyter.widget-view+json" in data
    assert pixels_of(data["image/png"]).shape == (32, 48, 3)
    assert widget._size == (48, 32) and widget.camera["fov"] > 0
    widget._live.receive({"type": "hello"})
    thread = widget._live._thread
    widget.close()
    thread.join(WAIT)
    assert not thread.is_alive()


def test_a_collected_widget_ends_its_thread(monkeypatch):
    widgets = pytest.importorskip("ipywidgets")
    monkeypatch.setattr(views, "_is_in_notebook", lambda: True)
    widget = make_scene().view(size=(48, 32), samples=2)
    widget._live.receive({"type": "hello"})
    thread = widget._live._thread
    widgets.Widget.close(widget)  # only forgets it
    del widget
    gc.collect()
    thread.join(WAIT)
    assert not thread.is_alive()


def test_a_still_picture_without_anywidget(monkeypatch):
    monkeypatch.setattr(views, "_is_in_notebook", lambda: True)
    monkeypatch.setitem(sys.modules, "anywidget", None)
    views._live_view.cache_clear()
    image = make_scene().view(size=(48, 32), samples=1)
    assert isinstance(image, raio.Image) and image.size == (48, 32)
    views._live_view.cache_clear()


def test_errors_outside_of_notebooks(monkeypatch, tmp_path):
    scene = make_scene()
    with pytest.raises(TypeError, match="unknown option"):
        scene.view(sample=3)
    monkeypatch.setattr(views, "_program", lambda: None)
    with pytest.raises(RuntimeError, match="needs a notebook, or the program"):
        scene.view()
    if sys.platform.startswith("linux"):
        monkeypatch.setattr(views, "_program", lambda: "raio")
        monkeypatch.delenv("DISPLAY", raising=False)
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        with pytest.raises(RuntimeError, match="needs a display"):
            scene.view()


def test_opens_the_window(monkeypatch, tmp_path):
    program, told = tmp_path / "raio", tmp_path / "told"
    program.write_text(f'#!/bin/sh\nif [ "$1" = --help ]; then echo "  view  Explore"; exit; fi\n'
                       f'[ -s "$2" ] && echo "$@" > {told}\n')
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("DISPLAY", ":0")
    scene = make_scene()
    scene.background = "white"
    assert scene.view(samples=4, soft_shadows=True) is None
    assert told.read_text().split()[2:] == ["--samples=4", "--soft-shadows", "--background=white"]
