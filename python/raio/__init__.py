"""Raio: a fast, reproducible ray tracer.

>>> import numpy as np, raio
>>> scene = raio.Scene()
>>> spheres = scene.spheres(np.random.default_rng(1).uniform(-5, 5, (1000, 3)), 0.5)
>>> image = scene.render(size=(320, 240), samples=4)
>>> image.numpy().shape
(240, 320, 4)

The same scene and options give the same bytes on any machine, for any number of threads.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import distribute as distribute
    from ._annotations import AnnotationOptions as AnnotationOptions
    from ._color import colormap as colormap, linear as linear
    from ._files import load as load, render as render
    from ._film import Film as Film, Image as Image, load_film as load_film, merge as merge
    from ._material import Material as Material, StandardMaterial as StandardMaterial
    from ._parts import (
        Cones as Cones,
        Discs as Discs,
        Ellipsoids as Ellipsoids,
        Instances as Instances,
        Lines as Lines,
        Mesh as Mesh,
        Part as Part,
        Spheres as Spheres,
    )
    from ._rays import KINDS as KINDS, Hits as Hits
    from ._render_options import ReadOptions as ReadOptions, RenderOptions as RenderOptions
    from ._scene import Scene as Scene, SceneError as SceneError, SceneWarning as SceneWarning
    from .convert import (
        from_ase as from_ase,
        from_biotite as from_biotite,
        from_mdanalysis as from_mdanalysis,
        from_ovito as from_ovito,
        from_pyvista as from_pyvista,
        from_trimesh as from_trimesh,
    )
    from .movies import movie as movie

    __version__: str

# Imported on first use, with numpy: `import raio` takes a millisecond.
_MODULES = {
    "_annotations": ("AnnotationOptions",),
    "_color": ("colormap", "linear"),
    "_files": ("load", "render"),
    "_film": ("Film", "Image", "load_film", "merge"),
    "_material": ("Material", "StandardMaterial"),
    "_parts": ("Cones", "Discs", "Ellipsoids", "Instances", "Lines", "Mesh", "Part", "Spheres"),
    "_rays": ("KINDS", "Hits"),
    "_render_options": ("ReadOptions", "RenderOptions"),
    "_scene": ("Scene", "SceneError", "SceneWarning"),
    "convert": ("from_ase", "from_biotite", "from_mdanalysis", "from_ovito", "from_pyvista",
                "from_trimesh"),
    "movies": ("movie",),
}
_WHERE = {name: module for module, names in _MODULES.items() for name in names}

__all__ = sorted(_WHERE)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from . import _raio

        value: Any = _raio.version()
    elif name == "distribute":  # only where dask.distributed is installed
        value = importlib.import_module("." + name, __name__)
    elif name in _WHERE:
        value = getattr(importlib.import_module("." + _WHERE[name], __name__), name)
    else:
        raise AttributeError(f"module 'raio' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_WHERE, "__version__"])
