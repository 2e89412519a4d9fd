"""What the tests share."""

import os
import pathlib
import shutil
import signal
import tempfile

import numpy as np
import pytest
import raio

if not shutil.which("ffmpeg"):  # PyPI has it under another name
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError:
        pass
    else:
        folder = tempfile.TemporaryDirectory()
        os.symlink(get_ffmpeg_exe(), os.path.join(folder.name, "ffmpeg"))
        os.environ["PATH"] += os.pathsep + folder.name

# A shell ignores it for work in the background, and programs that tests start would, too.
signal.signal(signal.SIGINT, signal.default_int_handler)

collect_ignore = ["browser"]  # by hand, in a real browser
ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def program():
    """The command-line program; RAIO_PROGRAM names another one."""
    path = pathlib.Path(os.environ.get("RAIO_PROGRAM", ROOT / "build/release/raio"))
    assert path.exists(), f"{path} is missing; build it, or set RAIO_PROGRAM"
    return path


@pytest.fixture
def rng():
    return np.random.default_rng(1)


@pytest.fixture
def cloud(rng):
    """A scene of 50 spheres, and their centres and radii."""
    scene = raio.Scene()
    centers = rng.uniform(-3, 3, (50, 3)).astype(np.float32)
    radii = rng.uniform(0.2, 0.6, 50).astype(np.float32)
    return scene, scene.spheres(centers, radii), centers, radii


def pixels(scene, **options):
    return scene.render(**{"size": (40, 30), "samples": 4, **options}).numpy()
