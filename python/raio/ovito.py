"""Raio as a renderer of OVITO. Once this module is imported, OVITO's renderer for ANARI devices is Raio:

    import raio.ovito
    viewport.render_image(filename="figure.png", renderer=raio.ovito.renderer(samples=64))
"""

import ctypes
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from . import _options

if TYPE_CHECKING:
    from ._render_options import RenderOptions

_LIBRARY = Path(__file__).parent / "libanari_library_raio.so"

if not _LIBRARY.exists():
    raise ImportError("this raio was built without its ANARI device, which OVITO needs; "
                      "build it where ANARI's SDK is installed (docs/programs.md)")
# OVITO asks the loader for this library by its name, which it knows once the library is in memory.
ctypes.CDLL(str(_LIBRARY), mode=ctypes.RTLD_GLOBAL)
os.environ["OVITO_ANARI_DEVICE"] = "raio"


def renderer(**options: Unpack["RenderOptions"]) -> Any:
    """OVITO's renderer for ANARI devices, with options of `Scene.render()`.

    They count for all pictures until the next call: `samples` (16 if not given), `occlusion_rays`,
    `occlusion_distance`, `outline`, `depth_cue`, `seed`, `threads`. A `look` replaces OVITO's lights by its own.
    OVITO sets size, camera and background.
    """
    for keyword in ("size", "width", "crop", "from_", "at", "up", "fov", "projection", "background", "channels"):
        if options.get(keyword) is not None:
            raise TypeError(f"{keyword}: OVITO sets it, by its viewport and render_image()")
    _options.settings(options)  # refuses wrong values
    from ovito.vis import VisRTXRenderer

    os.environ["RAIO_OPTIONS"] = " ".join(f"{name}={text}" for name, text in _options.texts(options).items())
    return VisRTXRenderer()
