"""The results of ray queries."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._parts import Part
    from ._scene import Spans

KINDS = ("plane", "sphere", "cone", "triangle", "polygon", "ellipsoid", "disc", "moving sphere",
         "moving triangle")


@dataclass(frozen=True)
class Hits:
    """The nearest hits of N rays, by Scene.intersect()."""

    distance: npt.NDArray[np.float32]  #: (N,), scene units; infinite: nothing was hit
    kind: npt.NDArray[np.uint8]  #: (N,), an index into raio.KINDS; only where `id` is not -1
    id: npt.NDArray[np.int64]  #: (N,), among the primitives of the kind, as added; -1: nothing
    instance: npt.NDArray[np.int64]  #: (N,), -1: none
    position: npt.NDArray[np.float32]  #: (N, 3); NaN: nothing was hit
    normal: npt.NDArray[np.float32]  #: (N, 3), outward, of length 1; 0: nothing was hit
    uv: npt.NDArray[np.float32]  #: (N, 2), weights of a triangle's second and third vertex
    _spans: "Mapping[Part, Spans]"
    _own_triangles: int  # those of meshes follow

    def rows(self, part: "Part") -> npt.NDArray[np.int64]:
        """Where a part of the scene was hit, (N,): rows of its arrays; -1: it was not hit.

        For a Mesh these are faces; for Lines, points at which the segment starts; for Instances,
        transforms. Raises ValueError for a part that was not in the scene when the rays were traced.

        Examples:
            >>> import raio
            >>> scene = raio.Scene()
            >>> ball, floor = scene.spheres([[0, 0, 1]], 1), scene.discs([[0, 0, 0]], [[0, 0, 1]], 9)
            >>> hits = scene.intersect([[0, 0, 5], [4, 0, 5]], [[0, 0, -1], [0, 0, -1]])
            >>> hits.rows(floor)
            array([-1,  0])
        """
        if part not in self._spans:
            raise ValueError(f"part: {part!r} was not in the scene when the rays were traced")
        rows = np.full(len(self.id), -1)
        for pool, (first, last, rows_of) in self._spans[part].items():
            if pool == "instance":
                numbers = self.instance
            else:
                is_mesh = pool == "mesh"
                of_pool = (self.kind == KINDS.index("triangle" if is_mesh else pool)) & (self.instance < 0)
                numbers = np.where(of_pool, self.id - is_mesh * self._own_triangles, -1)
            hit = (first <= numbers) & (numbers < last)
            found = numbers[hit] - first
            rows[hit] = found if rows_of is None else rows_of[found]
        return rows
