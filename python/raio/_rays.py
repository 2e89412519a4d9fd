"""The results of ray queries."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

KINDS = ("plane", "sphere", "cone", "triangle", "polygon", "ellipsoid", "disc", "moving sphere",
         "moving triangle")


class Hits(NamedTuple):
    """The nearest hits of N rays, by Scene.intersect()."""

    distance: npt.NDArray[np.float32]  #: (N,), scene units; infinite: nothing was hit
    kind: npt.NDArray[np.uint8]  #: (N,), an index into raio.KINDS; only where `id` is not -1
    id: npt.NDArray[np.int64]  #: (N,), among the primitives of the kind, as added; -1: nothing
    instance: npt.NDArray[np.int64]  #: (N,), -1: none
    position: npt.NDArray[np.float32]  #: (N, 3); NaN: nothing was hit
    normal: npt.NDArray[np.float32]  #: (N, 3), outward, of length 1; 0: nothing was hit
    uv: npt.NDArray[np.float32]  #: (N, 2), weights of a triangle's second and third vertex
