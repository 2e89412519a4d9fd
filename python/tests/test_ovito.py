"""Raio inside OVITO, where it was built with its ANARI device."""

import importlib
from pathlib import Path

import numpy as np
import pytest
import raio

HAS_DEVICE = (Path(raio.__file__).parent / "libanari_library_raio.so").exists()


@pytest.mark.skipif(HAS_DEVICE, reason="built with the device")
def test_without_device():
    with pytest.raises(ImportError, match="built without its ANARI device"):
        importlib.import_module("raio.ovito")


@pytest.mark.skipif(not HAS_DEVICE, reason="built without the device")
def test_renderer(tmp_path):
    pytest.importorskip("ovito")
    from ovito.data import DataCollection, Particles
    from ovito.pipeline import Pipeline, StaticSource
    from ovito.vis import Viewport

    ovito = importlib.import_module("raio.ovito")
    with pytest.raises(TypeError, match="size: OVITO sets it"):
        ovito.renderer(size=(10, 10))
    with pytest.raises(TypeError, match="unknown option 'sample'"):
        ovito.renderer(sample=1)
    data = DataCollection()
    particles = Particles()
    data.objects.append(particles)
    particles.create_property("Position", data=[[0.0, 0, 0]])
    particles.create_property("Radius", data=[1.0])
    particles.create_property("Color", data=[[0.0, 1, 0]])
    pipeline = Pipeline(source=StaticSource(data=data))
    pipeline.add_to_scene()
    viewport = Viewport(type=Viewport.Type.Front, camera_pos=(0, -5, 0), fov=2)
    image = viewport.render_image(size=(64, 64), filename=str(tmp_path / "ball.png"), background=(1, 1, 1),
                                  renderer=ovito.renderer(samples=4))
    pipeline.remove_from_scene()
    pixels = np.array([[image.pixelColor(x, y).getRgb()[:3] for x in range(64)] for y in range(64)])
    assert tuple(pixels[2, 2]) == (255, 255, 255)
    red, green, blue = pixels[32, 32]
    assert green > 150 and red < 60 and blue < 60
