"""Raio as a writer and a viewer of ASE, which finds both by their entry points (docs/programs.md):

    ase.io.write("figure.png", atoms, format="raio", rotation="10z,-80x")
    ase.visualize.view(atoms, viewer="raio")

ASE imports this module whenever it is used itself, so this one imports the rest only when it is needed.
"""

import math
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ase.utils.plugins import ExternalIOFormat, ExternalViewer

if TYPE_CHECKING:
    from ._scene import Scene

IO_FORMAT = ExternalIOFormat("Picture by the ray tracer Raio", "1S", module="raio.ase")
VIEWER = ExternalViewer("View atoms using Raio.", module="raio.ase")

# Settings of ASE's other writers, and what to give instead.
_FOREIGN = {
    "area_light": "key_light=False switches the light off",
    "auto_image_plane_z": "nothing, as nothing is cut off",
    "camera_dist": "nothing, or projection='perspective'",
    "camera_type": "projection='perspective'",
    "cell": "show_unit_cell",
    "cue_density": "depth_cue, from 0 to 1",
    "depth_cueing": "depth_cue, from 0 to 1",
    "display": "ase.visualize.view(atoms, viewer='raio')",
    "image_plane": "nothing, as nothing is cut off",
    "images": "repeat",
    "isosurface_data": "a mesh of its own, by raio.Scene.mesh()",
    "pause": "nothing, as nothing is displayed",
    "point_lights": "key_light=False switches the light off",
    "textures": "look: paper, dark, flat or matte",
    "width": "canvas_width, in pixels, with dpi",
}


def write_raio(filename: str, atoms: Any, **settings: Any) -> None:
    """Writes a picture, in any format of raio.Image.save(); or for .raio the scene, with its camera.

    Args:
        filename: the file.
        atoms: an ase.Atoms.
        settings: as for figure(); `povray_settings` may hold any of them.
    """
    scene, options = figure(atoms, **_merged(settings))
    if os.path.splitext(filename)[1] != ".raio":
        scene.render(**options).save(filename)
        return
    for name in options.keys() - {"size"}:
        raise TypeError(f"{name}: {filename} is a scene, not a picture; give it when the scene is rendered")
    scene.save(filename)


def view_raio(atoms: Any, data: Any = None, repeat: Any = None, **settings: Any) -> Any:
    """A live picture in a notebook, else the window: raio.Scene.view(). Of several atoms objects the
    last one is shown, with a warning. Arguments as for figure()."""
    from .convert import warn

    if data is not None:
        raise TypeError("data: volumetric data is not drawn; leave it out")
    if isinstance(atoms, Sequence):
        if len(atoms) > 1:
            warn(f"the last of {len(atoms)} structures is shown; choose others by index")
        atoms = atoms[-1]
    scene, options = figure(atoms, repeat=repeat, **_merged(settings))
    return scene.view(**options)


def _merged(settings: dict[str, Any]) -> dict[str, Any]:
    merged = {**(settings.pop("povray_settings", None) or {}), **settings}
    for name in merged.keys() & _FOREIGN.keys():
        raise TypeError(f"{name} is not a setting of Raio's writer; give {_FOREIGN[name]}")
    return merged


def figure(atoms: Any, *, rotation: Any = "", show_unit_cell: int = 2, radii: Any = None, colors: Any = None,
           bbox: Any = None, scale: float = 20, maxwidth: float = 500, extra_offset: Any = (0, 0),
           auto_bbox_size: float = 1.05, repeat: Any = None, canvas_width: int | None = None,
           canvas_height: int | None = None, celllinewidth: float = 0.05, bondatoms: Sequence[Any] = (),
           bondlinewidth: float = 0.1, transmittances: Any = None, exportconstraints: bool = False,
           transparent: bool = False, **options: Any) -> tuple["Scene", dict[str, Any]]:
    """A scene of atoms, framed as ASE's writers of PNG and POV-Ray do, and the options to render it.

    Args:
        atoms: an ase.Atoms.
        rotation: as in "10z,-80x", degrees, or a matrix (3, 3).
        show_unit_cell: 0: no; 1: yes; 2: the frame includes it; 3: the frame is that of the cell.
        radii: angstroms, one for each atom, or by symbol, as in {"Au": 1.5}; or a factor of the
            covalent radii, which are the default.
        colors: display values from 0 to 1 or names, one for each atom or by symbol; default: Jmol's.
        bbox: the frame, (left, bottom, right, top) in angstroms, after the rotation.
        scale: pixels of an angstrom.
        maxwidth: the largest width, pixels.
        extra_offset: moves the picture, pixels.
        auto_bbox_size: the size of the frame, as a multiple of that of its content.
        repeat: a number of copies of the cell, or three.
        canvas_width: the width in pixels, instead of scale.
        canvas_height: the height in pixels, instead of scale and canvas_width.
        celllinewidth: the radius of the edges of the cell, angstroms.
        bondatoms: (a, b), (a, b, cell), (a, b, cell, order) or (a, b, cell, order, shift), as
            ase.io.pov.get_bondpairs() finds them.
        bondlinewidth: the radius of bonds, angstroms.
        transmittances: of each atom, 0 (opaque) to 1.
        exportconstraints: crosses atoms with FixAtoms.
        transparent: a transparent background.
        options: those of raio.Scene.render(). With options of raio.from_ase(), such as
            style="ball-and-stick" or color_by="forces.2", that draws the atoms.

    Raises:
        TypeError, ValueError: an argument does not fit, or is one of other writers.
        RuntimeError: ASE is older than 3.25.
    """
    import ase
    from ase.io.utils import PlottingVariables

    from ._options import pixel_size, split
    from ._scene import Scene
    from .convert import check_ase, from_ase

    if not hasattr(PlottingVariables, "to_atom_positions"):
        raise RuntimeError(f"Raio's frames need ASE 3.25 or newer; found {ase.__version__}")
    check_ase(atoms)
    if show_unit_cell not in (0, 1, 2, 3):
        raise ValueError(f"show_unit_cell: expected 0, 1, 2 or 3, found {show_unit_cell!r}")
    if canvas_width is not None and canvas_height is not None:
        raise ValueError("canvas_width and canvas_height: give one of them, the other one follows")
    if repeat is not None:
        atoms = atoms.repeat(repeat)
    read, wanted = split(options)
    sizes = _radii(atoms, radii, by_van_der_waals=bool(read))
    frame = PlottingVariables(atoms, _turn(rotation), show_unit_cell, sizes, bbox, None, scale, maxwidth,
                              extra_offset, auto_bbox_size)
    if read:
        for name, value in (("radii", radii), ("colors", colors), ("transmittances", transmittances),
                            ("bondatoms", bondatoms or None)):
            if value is not None:
                raise TypeError(f"{name}: not together with {next(iter(read))}, which is for raio.from_ase()")
        scene = from_ase(atoms, **read, cell=False)
    else:
        scene = Scene()
        light = _colors(atoms, colors)
        opacity = None if transmittances is None else 1 - _each("transmittances", transmittances, atoms)
        scene.spheres(atoms.positions, sizes, colors=light, opacity=opacity)
        for bond in bondatoms:
            _add_bond(scene, atoms, bond, bondlinewidth, frame.rotation, light, opacity)
    if show_unit_cell and atoms.cell.rank:
        _add_cell(scene, atoms, celllinewidth)
    if exportconstraints:
        _add_crosses(scene, atoms, sizes, celllinewidth, frame.rotation)
    if transparent:
        wanted["background"] = "transparent"
    # Pixels of a unit of ASE's image plane.
    zoom = canvas_width / frame.w if canvas_width else canvas_height / frame.h if canvas_height else 1
    wanted.setdefault("size", (max(int(frame.w * zoom), 1), max(int(frame.h * zoom), 1)))
    _place_camera(scene, frame, *pixel_size(wanted["size"]))
    return scene, wanted


def _turn(rotation: Any) -> Any:
    """A matrix whose columns point right, up and to the viewer."""
    import numpy as np
    from ase.utils import rotate

    try:
        turn = rotate(rotation) if isinstance(rotation, str) else np.asarray(rotation, float)
    except (ValueError, IndexError):
        turn = np.empty(0)
    if turn.shape != (3, 3):
        raise ValueError(f"rotation: expected angles as in '10z,-80x', or a matrix (3, 3), found {rotation!r}")
    return turn


def _place_camera(scene: "Scene", frame: Any, width: int, height: int) -> None:
    """Shows the frame in a picture of width x height pixels, with space on two sides if need be."""
    half = float(max(frame.h, frame.w * height / width)) / frame.scale / 2
    # All objects are behind the plane of the frame.
    at, distance = frame.to_atom_positions([frame.w / 2, frame.h / 2, 0]), 4 * half
    scene.camera(at + frame.rotation[:, 2] * distance, at, frame.rotation[:, 1],
                 math.degrees(2 * math.atan(half / distance)), projection="orthographic")


def _each(name: str, value: Any, atoms: Any) -> Any:
    """Numbers of all atoms."""
    import numpy as np

    numbers = np.asarray(value, float)
    if numbers.shape != (len(atoms),):
        raise ValueError(f"{name}: expected one for each of {len(atoms)} atoms, found the shape {numbers.shape}")
    return numbers


def _radii(atoms: Any, radii: Any, by_van_der_waals: bool) -> Any:
    import numpy as np
    from ase.data import covalent_radii, vdw_radii

    own = covalent_radii[atoms.numbers]
    if by_van_der_waals:  # those of raio.from_ase(), of which sticks use a part
        return np.nan_to_num(vdw_radii[atoms.numbers], nan=2.0)
    if radii is None:
        return own
    if isinstance(radii, Mapping):
        return np.array([radii.get(s, r) for s, r in zip(atoms.symbols, own, strict=True)], float)
    return own * radii if np.ndim(radii) == 0 else _each("radii", radii, atoms)


def _colors(atoms: Any, colors: Any) -> Any:
    """Light, (N, 3)."""
    import numpy as np
    from ase.data.colors import jmol_colors

    from ._color import linear, one_color

    own = jmol_colors[atoms.numbers.clip(max=len(jmol_colors) - 1)]
    if isinstance(colors, Mapping):
        colors = [colors.get(s, c) for s, c in zip(atoms.symbols, own, strict=True)]
    shown = own if colors is None else colors
    if len(shown) != len(atoms):
        raise ValueError(f"colors: expected one for each of {len(atoms)} atoms, found {len(shown)}")
    return np.array([one_color("colors", c) if isinstance(c, str) else linear(c)[:3] for c in shown])


def _add_cell(scene: "Scene", atoms: Any, radius: float) -> None:
    from ase.io.utils import get_cell_vertex_points

    corners = get_cell_vertex_points(atoms.cell, atoms.get_celldisp().ravel())
    pairs = [(i, i | side) for i in range(8) for side in (1, 2, 4) if not i & side]
    for start, end in pairs:
        if (corners[start] != corners[end]).any():
            scene.lines(corners[[start, end]], radius, colors="black")


def _add_bond(scene: "Scene", atoms: Any, bond: Sequence[Any], radius: float, turn: Any, light: Any,
              opacity: Any) -> None:
    import numpy as np

    if not 2 <= len(bond) <= 5:
        raise ValueError(f"bondatoms: expected two to five entries for each bond, found {bond!r}")
    defaults = ((0, 0, 0), 1, (radius, radius, 0))
    entries: list[Any] = [*bond, *defaults[len(bond) - 2:]]
    a, b, cell, order, shift = entries
    if not (0 <= a < len(atoms) and 0 <= b < len(atoms)):
        raise ValueError(f"bondatoms: expected atoms from 0 to {len(atoms) - 1}, found {bond!r}")
    if order not in (0, 1, 2, 3):
        raise ValueError(f"bondatoms: expected an order from 0 to 3, found {bond!r}")
    ends = atoms.positions[[a, b]]
    across = ends[1] - ends[0] + np.asarray(cell) @ atoms.cell[:]
    aside = np.asarray(shift, float) @ turn.T
    length, along = np.linalg.norm(aside), across / np.linalg.norm(across)
    aside -= aside @ along * along
    aside *= length / max(float(np.linalg.norm(aside)), 1e-9)
    for step in ((), (0,), (-0.5, 0.5), (-1, 0, 1))[order]:
        starts = ends + step * aside
        scene.cylinders(starts, starts + np.array([across, -across]) / 2, radius, colors=light[[a, b]],
                        opacity=None if opacity is None else opacity[[a, b]])


def _add_crosses(scene: "Scene", atoms: Any, radii: Any, radius: float, turn: Any) -> None:
    """Two rings around each atom that FixAtoms holds."""
    import numpy as np
    from ase.constraints import FixAtoms

    angles = np.linspace(0, 2 * np.pi, 65)
    for atom in {int(i) for c in atoms.constraints if isinstance(c, FixAtoms) for i in c.index}:
        for side in (1, -1):
            slanted = (turn[:, 0] + side * turn[:, 1]) / math.sqrt(2)
            ring = np.outer(np.cos(angles), slanted) + np.outer(np.sin(angles), turn[:, 2])
            scene.lines(atoms.positions[atom] + radii[atom] * ring, radius, colors="black")
