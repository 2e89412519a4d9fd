"""Raio as a renderer of OVITO. Importing this module makes OVITO's renderer for ANARI devices use Raio:

    import raio.ovito
    viewport.render_image(filename="figure.png", renderer=raio.ovito.renderer(samples=64))
"""

import ctypes
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ._options import text_of_option

if TYPE_CHECKING:
    from ._render_options import RenderOptions

_LIBRARY = Path(__file__).parent / "libanari_library_raio.so"

if not _LIBRARY.exists():
    raise ImportError(
        "this raio was built without its ANARI device, which OVITO needs; build it where ANARI's SDK is installed "
        "(docs/programs.md)"
    )
# OVITO loads libanari_library_NAME.so, which the loader finds by its name once it is in memory.
ctypes.CDLL(str(_LIBRARY), mode=ctypes.RTLD_GLOBAL)
os.environ["OVITO_ANARI_DEVICE"] = "raio"


def renderer(**options: "Unpack[RenderOptions]") -> Any:
    """OVITO's renderer for ANARI devices, with options of scene.render().

    They count for all pictures until the next call: `samples` (16 if not given), `occlusion_rays`,
    `occlusion_distance`, `outline`, `depth_cue`, `seed`, `threads`; `look` replaces OVITO's lights by those of a look
    of figures. OVITO sets size, camera and background.
    """
    from ovito.vis import VisRTXRenderer

    words = {name.replace("_", "-"): text_of_option(name, value) for name, value in options.items()}
    os.environ["RAIO_OPTIONS"] = " ".join(f"{name}={value}" for name, value in words.items())
    return VisRTXRenderer()
