"""Scenes from the objects of other libraries, none of which this module imports.

Atoms of ASE, MDAnalysis and Biotite become the text of a file in memory, which the library reads:
their colours, radii, bonds and options are those of files. What has no counterpart in a picture is
left out with a SceneWarning.
"""

import re
import sys
import warnings
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np
import numpy.typing as npt

from . import _raio
from ._color import linear
from ._files import read_settings, scene_of
from ._material import Material
from ._options import with_keywords
from ._scene import Scene, SceneError, SceneWarning

if TYPE_CHECKING:
    from ._render_options import ReadOptions

Array = npt.NDArray[Any]


def warn(text: str) -> None:
    """A SceneWarning that names the line of the user."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back and frame.f_globals["__name__"].partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, SceneWarning, stacklevel=level)


# --- atoms


def from_ase(atoms: Any, **options: "Unpack[ReadOptions]") -> Scene:
    """A scene of an ase.Atoms.

    Kept: elements, positions (angstroms), the cell and its periodic directions. Options are those of
    load(): `style="ball-and-stick"`, `cell=True`, `images=(2, 2, 1)`, `only="element C"`.
    `color_by` takes "element", "index", or the name of any array of numbers in `atoms.arrays` or in
    the results of its calculator, such as "forces.1", the first of three. Bonds are found by
    distance. Constraints, velocities and dipoles are not drawn.

    Warns of partial occupancies, and of what the reader guesses or leaves out. Raises SceneError and
    ValueError as load() does.

    >>> from ase.build import molecule                                       # doctest: +SKIP
    >>> raio.from_ase(molecule("C6H6"), style="sticks").render()             # doctest: +SKIP
    """
    check_ase(atoms)
    values = {name: v for name, v in {**getattr(atoms.calc, "results", {}), **atoms.arrays}.items()
              if name not in ("numbers", "positions", "radius", "pos", "species")}
    cell = np.asarray(atoms.cell[:])
    box = None
    if cell.any(axis=1).all():
        box = cell
    elif cell.any():
        warn("the cell has fewer than three sides and is not drawn")
    by = options.get("color_by")
    if by is not None:
        options["color_by"] = _plain(str(by))
    text = _xyz(atoms.get_chemical_symbols(), atoms.get_positions(), box, atoms.get_pbc(),
                {} if by is None else values)
    return _read(text, "atoms.xyz", options)


def check_ase(atoms: Any) -> None:
    """Raises TypeError for other objects than atoms of ASE, and ValueError for no atoms and positions
    that are not finite; warns of partial occupancies."""
    if not hasattr(atoms, "get_atomic_numbers"):
        raise TypeError(f"atoms: expected an ase.Atoms, found {type(atoms).__name__}")
    _checked(atoms.positions)
    sites = (atoms.info.get("occupancy") or {}).values()
    if any(share < 1 for site in sites for share in site.values()):
        warn("partial occupancies: each site is drawn as its one element in atoms.numbers")


def from_mdanalysis(atoms: Any, **options: "Unpack[ReadOptions]") -> Scene:
    """A scene of an MDAnalysis Universe or AtomGroup, in the current frame of its trajectory (XTC,
    TRR, DCD, ...): go to another one with `universe.trajectory[n]` and call it again.

    Kept, as far as present: positions (angstroms), elements, names, residues, chains (chainIDs, else
    segments), temperature factors, occupancies, bonds and the box. Options are those of load(), with
    the selections of the command line: `style="sticks"`, `color_by="chain"`, `only="protein"`.
    `cell=True` draws the box. Atoms without elements get them from their names, with a warning. Listed
    bonds are added to those found by distance. Velocities and forces are not drawn.
    """
    group = getattr(atoms, "atoms", None)
    if group is None or not hasattr(group, "positions"):
        raise TypeError(
            f"atoms: expected a Universe or an AtomGroup of MDAnalysis, found {type(atoms).__name__}")

    def of_atoms(name: str) -> Any:
        try:
            return getattr(group, name)
        except (AttributeError, ValueError):  # NoDataError is both
            return None

    chains = of_atoms("chainIDs")
    if chains is None or not any(chains):
        chains = of_atoms("segids")
    bonds = of_atoms("bonds")
    listed = np.empty((0, 2), int) if bonds is None else np.asarray(bonds.indices).reshape(-1, 2)
    places = np.full(group.universe.atoms.n_atoms, -1)
    places[group.indices] = np.arange(len(group))
    listed = places[listed]
    dimensions = getattr(group, "dimensions", None)
    text = _mmcif(
        {"element": of_atoms("elements"), "name": of_atoms("names"), "residue": of_atoms("resnames"),
         "number": of_atoms("resids"), "insertion": of_atoms("icodes"), "chain": chains,
         "b_factor": of_atoms("tempfactors"), "occupancy": of_atoms("occupancies")},
        np.asarray(group.positions), of_atoms("resindices"), listed[(listed >= 0).all(axis=1)],
        None if dimensions is None or not np.all(dimensions) else np.asarray(dimensions, float))
    return _read(text, "atoms.cif", options)


def from_biotite(atoms: Any, **options: "Unpack[ReadOptions]") -> Scene:
    """A scene of a Biotite AtomArray.

    Kept, as far as present: positions (angstroms), elements, names, residues, chains, B factors,
    occupancies, the box, and bonds, which are added to those found by distance. Options are those of
    load(): `style="ball-and-stick"`, `color_by="residue"`, `only="ligand"`, `cell=True`. Of an AtomArrayStack,
    the first model is drawn, with a warning. Charges and orders of bonds are not drawn.
    """
    if not hasattr(atoms, "get_annotation_categories"):
        raise TypeError(f"atoms: expected a Biotite AtomArray, found {type(atoms).__name__}")
    if np.ndim(atoms.coord) == 3:
        if len(atoms) > 1:
            warn(f"{len(atoms)} models; the first is drawn, choose others by atoms[n]")
        atoms = atoms[0]
    kept = set(atoms.get_annotation_categories())

    def of_atoms(name: str) -> Any:
        return atoms.get_annotation(name) if name in kept else None

    # A residue begins where any part of its name changes.
    keys = [np.asarray(of_atoms(n)) for n in ("chain_id", "res_id", "ins_code", "res_name")
            if n in kept]
    starts = np.zeros(len(atoms.coord), int)
    for key in keys:
        starts[1:] |= key[1:] != key[:-1]
    bonds = np.empty((0, 2), int) if atoms.bonds is None else atoms.bonds.as_array()[:, :2]
    box = None
    if atoms.box is not None:
        lengths = np.linalg.norm(atoms.box, axis=1)
        b, c, a = np.roll(atoms.box / lengths[:, None], -1, axis=0)
        angles = np.degrees(np.arccos(np.clip([b @ c, c @ a, a @ b], -1, 1)))
        box = np.concatenate((lengths, angles))
        if not np.allclose(np.triu(atoms.box, 1), 0, atol=1e-4 * lengths.max()):
            warn("the box is turned; only boxes whose first side is along x, and whose second is in "
                  "the plane of x and y, are kept")
            box = None
    text = _mmcif(
        {"element": of_atoms("element"), "name": of_atoms("atom_name"),
         "residue": of_atoms("res_name"), "number": of_atoms("res_id"),
         "insertion": of_atoms("ins_code"), "chain": of_atoms("chain_id"),
         "b_factor": of_atoms("b_factor"), "occupancy": of_atoms("occupancy")},
        np.asarray(atoms.coord), np.cumsum(starts), bonds, box)
    return _read(text, "atoms.cif", options)


def _read(text: str, name: str, options: Any) -> Scene:
    wanted = read_settings(options)
    try:
        core = _raio.Scene.parse(text.encode(), name, wanted)
    except SceneError as error:
        raise SceneError(_about_atoms(str(error))) from None
    return scene_of(core, 4, _about_atoms)


def _about_atoms(message: str) -> str:
    """A message about the text of a file as one about the caller's object."""
    message = re.sub(r"^atoms\.\w+(:\d+)*: (error: )?", "atoms: ", with_keywords(message))
    return re.sub(r"\b(the|this) file\b", r"\1 object", message)


def _checked(positions: Array) -> Array:
    if not len(positions):
        raise ValueError("atoms: expected at least one")
    if not np.isfinite(positions).all():
        row = int(np.argmin(np.isfinite(positions).all(axis=1)))
        raise ValueError(f"the position of atom {row} is {positions[row].tolist()}")
    return positions


def _words(array: Array) -> list[str]:
    # Decimals that give the same number.
    if array.dtype == np.float32:
        return [f"{v:.9g}" for v in array.tolist()]
    return [repr(v) for v in array.tolist()]


def _rows(columns: Iterable[Sequence[str]]) -> str:
    return "\n".join(map(" ".join, zip(*columns, strict=True))) + "\n"


def _plain(name: str) -> str:
    return re.sub(r'[:\s"]', "_", name)


def _xyz(symbols: Sequence[str], positions: Array, cell: Array | None, periodic: Sequence[bool],
         values: dict[str, Any]) -> str:
    """Extended XYZ."""
    columns = [symbols, *map(_words, _checked(positions).T)]
    properties = "species:S:1:pos:R:3"
    for name, value in values.items():
        rows = np.asanyarray(value)
        if rows.dtype.kind not in "iuf" or rows.ndim not in (1, 2) or len(rows) != len(positions):
            continue
        rows = rows.reshape(len(rows), -1)
        columns += map(_words, rows.T)
        properties += f":{_plain(name)}:R:{rows.shape[1]}"
    lattice = "" if cell is None else 'Lattice="{}" pbc="{}" '.format(
        " ".join(_words(cell.ravel())), " ".join("T" if p else "F" for p in periodic))
    return f"{len(positions)}\n{lattice}Properties={properties}\n{_rows(columns)}"


def _cif_word(text: str) -> str:
    is_plain = re.fullmatch(r"[A-Za-z0-9+*.-][^\s#\"]*", text) and not re.match(
        r"(?i)(data_|loop_|save_|stop_|global_)", text)
    return text if is_plain else f'"{text}"' if text else "?"


def _cif_words(values: Array) -> list[str]:
    if values.dtype.kind in "iuf":
        return ["?" if w == "nan" else w for w in _words(values)]
    texts = values.tolist()
    words = {t: _cif_word(str(t).strip()) for t in set(texts)}
    return [words[t] for t in texts]


_CIF = {"element": "type_symbol", "name": "label_atom_id", "residue": "label_comp_id",
        "number": "auth_seq_id", "insertion": "pdbx_PDB_ins_code", "chain": "auth_asym_id",
        "b_factor": "B_iso_or_equiv", "occupancy": "occupancy"}


def _mmcif(columns: dict[str, Any], positions: Array, residues: Array | None, bonds: Array,
           cell: Array | None) -> str:
    """mmCIF. `residues`: a number of each atom's residue; `cell`: lengths and angles."""
    text = ["data_atoms\n"]
    if cell is not None:
        names = [f"{of}_{axis}" for of, axes in (
            ("length", "abc"), ("angle", ("alpha", "beta", "gamma"))) for axis in axes]
        text += [f"_cell.{name} {value!r}\n" for name, value in zip(names, cell.tolist(), strict=True)]
    given = {name: np.asarray(value) for name, value in columns.items() if value is not None}
    count = len(_checked(positions))
    if residues is not None and "number" in given:
        # Reading joins residues of one number, and keeps one of several names.
        _, firsts = np.unique(residues, return_index=True)
        keys = [given[n][firsts].tolist() for n in ("chain", "number", "insertion") if n in given]
        if len(set(zip(*keys, strict=True))) < len(firsts):
            warn("several residues have the same number; they are numbered from 1")
            given["number"] = residues - residues.min() + 1
            given.pop("insertion", None)
    given.setdefault("chain", np.full(count, "A"))
    given.setdefault("residue", np.full(count, "UNL"))
    given.setdefault("number", np.ones(count, int))
    rows = {_CIF[name]: _cif_words(value) for name, value in given.items()}
    if "type_symbol" not in rows:
        rows["type_symbol"] = ["?"] * count
    rows["label_asym_id"] = rows["auth_asym_id"]
    # Names that are unique, for bonds; elements follow from label_atom_id.
    rows["auth_atom_id"] = [f"a{i}" for i in range(count)]
    rows |= {f"Cartn_{axis}": _words(column) for axis, column in zip("xyz", positions.T, strict=True)}
    text += ["loop_\n", *(f"_atom_site.{name}\n" for name in rows), _rows(rows.values())]
    if len(bonds):
        ends = [("label_atom_id", "auth_atom_id"), ("auth_asym_id",) * 2, ("auth_seq_id",) * 2,
                ("label_comp_id",) * 2, ("pdbx_PDB_ins_code",) * 2, ("label_asym_id",) * 2]
        links = {"id": [f"b{i}" for i in range(len(bonds))], "conn_type_id": ["covale"] * len(bonds)}
        for k, column in enumerate(bonds.T):
            for tag, source in ends:
                if source in rows:
                    prefix = f"pdbx_ptnr{k + 1}" if tag.startswith("pdbx") else f"ptnr{k + 1}"
                    links[f"{prefix}_{tag.removeprefix('pdbx_')}"] = [rows[source][i] for i in column]
        text += ["loop_\n", *(f"_struct_conn.{name}\n" for name in links), _rows(links.values())]
    return "".join(text)


# --- meshes


def from_trimesh(mesh: Any, *, smooth: bool | None = None, radius: float | None = None) -> Scene:
    """A scene of a trimesh.Trimesh, PointCloud or Scene.

    Kept: triangles, colours of vertices or faces, opacity, texture coordinates with the picture of
    base colour; of scenes, the graph, whose repeated objects are stored once, and the camera. smooth:
    True interpolates normals, computing them if needed; False draws flat faces; None: as in the mesh,
    if it has normals. radius: of points (default: half of their spacing) and of lines (default: 0.002
    of the diagonal).

    Warns of what is left out: other textures, opacity that varies within faces, lights.
    """
    if hasattr(mesh, "graph") and hasattr(mesh, "geometry"):
        return _trimesh_scene(mesh, smooth, radius)
    scene = Scene()
    _add_trimesh(scene, mesh, smooth, radius)
    return scene


def _trimesh_scene(source: Any, smooth: bool | None, radius: float | None) -> Scene:
    scene = Scene()
    matrices: dict[str, list[Array]] = {}
    for node in source.graph.nodes_geometry:
        matrix, name = source.graph[node]
        matrices.setdefault(name, []).append(np.asarray(matrix))
    for name, of_object in matrices.items():
        target = scene if np.array_equal(of_object, [np.eye(4)]) else Scene()
        _add_trimesh(target, source.geometry[name], smooth, radius)
        if target is not scene and len(target):
            scene.instances(target, np.array(of_object))
    if source.has_camera:
        pose = np.asarray(source.camera_transform)
        scene.camera(pose[:3, 3], pose[:3, 3] - pose[:3, 2], pose[:3, 1],
                     float(source.camera.fov[1]))
    if getattr(source, "_lights", None):
        warn("lights are left out; add them by light()")
    return scene


def _add_trimesh(scene: Scene, mesh: Any, smooth: bool | None, radius: float | None) -> None:
    if hasattr(mesh, "entities"):
        width = radius or 0.002 * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
        colors = getattr(mesh, "colors", None)
        for k, entity in enumerate(mesh.entities):
            path = np.asarray(entity.discrete(mesh.vertices))
            path = np.pad(path, ((0, 0), (0, 3 - path.shape[1])))
            color = None if colors is None or colors[k] is None else tuple(
                linear(np.asarray(colors[k], np.uint8)[:3]).tolist())
            scene.lines(path, width, colors=color or "black")
        return
    if not hasattr(mesh, "faces"):
        if not hasattr(mesh, "vertices"):
            raise TypeError(f"mesh: expected a mesh or a scene of trimesh, found {type(mesh).__name__}")
        colors = np.asarray(mesh.colors)
        scene.points(mesh.vertices, radius, colors=colors if len(colors) == len(mesh.vertices) else None)
        return
    look: dict[str, Any] = {}
    visual = mesh.visual
    if visual.kind == "texture":
        look = _texture(visual)
    elif visual.kind in ("vertex", "face"):
        colors = np.asarray(visual.vertex_colors if visual.kind == "vertex" else visual.face_colors)
        look = _rgba(colors, visual.kind == "face")
    # trimesh keeps given normals among cached values.
    if smooth or (smooth is None and "vertex_normals" in mesh._cache):
        look["normals"] = mesh.vertex_normals
    faces = np.asarray(mesh.faces)
    if look.pop("by_face", False) and len(faces) == len(mesh.vertices):
        # Colours of this number would be taken as those of vertices.
        look["colors"] = np.concatenate((look["colors"], look["colors"][:1]))
        if np.ndim(look.get("opacity", 1)):
            look["opacity"] = np.append(look["opacity"], 0)
        faces = np.concatenate((faces, faces[:1, [0, 0, 0]]))
    scene.mesh(mesh.vertices, faces, **look)


def _rgba(colors: Array, by_face: bool) -> dict[str, Any]:
    look: dict[str, Any] = {"colors": np.ascontiguousarray(colors[:, :3]), "by_face": by_face}
    if colors.shape[1] == 4 and (colors[:, 3] < 255).any():
        opacity = (colors[:, 3] / 255).astype(np.float32)
        if by_face:
            look["opacity"] = opacity
        else:
            look["opacity"] = float(opacity.mean())
            if np.ptp(opacity) > 0:
                warn(f"opacities of vertices are not supported; their mean is used, "
                      f"{look['opacity']:.3g}")
    return look


def _texture(visual: Any) -> dict[str, Any]:
    material = visual.material
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    look: dict[str, Any] = {}
    factor = getattr(material, "baseColorFactor", None)
    if factor is not None:  # light, unlike the colours of other materials
        rgba = np.asarray(factor)
        rgba = rgba / 255 if rgba.dtype == np.uint8 else rgba
        look["colors"] = tuple(rgba[:3].tolist())
        if len(rgba) == 4 and rgba[3] < 1:
            look["opacity"] = float(rgba[3])
    elif image is None and getattr(material, "diffuse", None) is not None:
        look["colors"] = tuple(linear(np.asarray(material.diffuse, np.uint8)[:3]).tolist())
    for name in ("normalTexture", "metallicRoughnessTexture", "emissiveTexture", "occlusionTexture"):
        if getattr(material, name, None) is not None:
            warn(f"{name} is left out")
    if image is not None and visual.uv is not None:
        if "A" in image.getbands() and np.asarray(image.getchannel("A")).min() < 255:
            warn("the texture's opacity is left out")
        look.update(uv=visual.uv, material=Material(texture=np.asarray(image.convert("RGB"))))
    elif image is not None:
        warn("the texture is left out, since the mesh has no texture coordinates")
    return look


def from_pyvista(dataset: Any, *, scalars: str | None = None, cmap: Any = "viridis",
                 vmin: float | None = None, vmax: float | None = None, color: Any = None,
                 opacity: float | None = None, smooth: bool | None = None,
                 radius: float | None = None) -> Scene:
    """A scene of a PyVista dataset, in its units.

    Of PolyData, polygons become triangles, lines cylinders and vertices spheres; of other datasets the
    surface is drawn; of a MultiBlock, all blocks. scalars: the name of point or cell data (those of
    points if both have it): numbers, which `cmap` shows from `vmin` to `vmax`, or (N, 3) or (N, 4)
    colours, uint8 as displayed or floats as displayed; a fourth column is opacity, of which each
    triangle has the mean. color: for what has no scalars. smooth: True computes normals of vertices,
    False draws flat faces, None uses point data "Normals" if there are any. radius: of lines and
    points (default: 0.004 of the diagonal).

    Textures are left out. Raises ValueError if no block has the scalars.
    """
    if not hasattr(dataset, "bounds"):
        raise TypeError(f"dataset: expected one of PyVista, found {type(dataset).__name__}")
    surfaces = [surface_of(block) for block in blocks_of(dataset)]
    has = [scalars in s.point_data or scalars in s.cell_data for s in surfaces]
    if scalars is not None and not any(has):
        names = sorted({n for s in surfaces for n in (*s.point_data.keys(), *s.cell_data.keys())})
        raise ValueError(f"scalars: found no {scalars!r}, but {', '.join(names) or 'no data'}")
    if scalars is not None and not all(has):
        warn(f"{has.count(False)} of {len(has)} blocks have no {scalars!r}; they have one colour")
    scene = Scene()
    diagonal = float(np.linalg.norm(np.subtract(dataset.bounds[1::2], dataset.bounds[::2])))
    ends = _ends(surfaces, scalars, vmin, vmax)
    if not any(s.n_cells for s in surfaces):
        warn("the dataset has no cells to draw")
    size = radius or 0.004 * diagonal or 1.0
    for surface in surfaces:
        values, by_cell = _values(surface, scalars)
        if values is None:
            paint = Paint(None, False, {"colors": color, "opacity": opacity})
        elif values.ndim == 2:
            paint = Paint(light_of(values, opacity), by_cell, {})
        else:
            least, most = (None, None) if ends[0] == ends[1] else ends  # nothing to map
            paint = Paint(values, by_cell, {"cmap": cmap, "vmin": least, "vmax": most,
                                            "opacity": opacity})
        add_surface(scene, surface, paint, smooth, size, size)
    return scene


def blocks_of(dataset: Any) -> Iterable[Any]:
    """The datasets with points in a dataset of PyVista, which may be a MultiBlock."""
    if hasattr(dataset, "n_blocks"):
        for block in dataset:
            if block is not None:
                yield from blocks_of(block)
    elif dataset.n_points:
        yield dataset


def surface_of(dataset: Any) -> Any:
    """A dataset of PyVista as PolyData."""
    is_surface = hasattr(dataset, "n_strips")
    return dataset if is_surface else dataset.extract_surface(algorithm="dataset_surface")


def _values(surface: Any, scalars: str | None) -> tuple[Array | None, bool]:
    """The data, and whether it belongs to cells."""
    if scalars is None:
        return None, False
    for data, by_cell in ((surface.point_data, False), (surface.cell_data, True)):
        if scalars in data:
            values = np.asarray(data[scalars])
            if values.ndim == 2 and values.dtype.kind in "iu" and values.dtype != np.uint8:
                raise TypeError(f"scalars: {scalars!r} has colours of {values.dtype}; expected uint8 "
                                f"for 0 to 255, or floats for 0 to 1")
            if values.ndim == 1 or values.shape[1] in (3, 4):
                return values, by_cell
            raise ValueError(f"scalars: {scalars!r} has the shape {values.shape}; expected (N,), or "
                             f"(N, 3) colours")
    return None, False


def _ends(surfaces: list[Any], scalars: str | None, vmin: float | None,
          vmax: float | None) -> tuple[float | None, float | None]:
    """The range of all blocks, so that equal values have equal colours."""
    all_values = [v for v, _ in (_values(s, scalars) for s in surfaces) if v is not None and v.ndim == 1]
    finite = [v[np.isfinite(v)] for v in all_values]
    finite = [v for v in finite if len(v)]
    if not finite:
        return vmin, vmax
    return (min(float(v.min()) for v in finite) if vmin is None else vmin,
            max(float(v.max()) for v in finite) if vmax is None else vmax)


def light_of(shown: Array, opacity: float | None = None) -> Array:
    """Display colours, (N, 3) or (N, 4), uint8 or 0 to 1, as light, with a fourth column only if some
    are transparent."""
    shares = shown / 255 if shown.dtype == np.uint8 else shown
    alpha = (shares[:, 3:] if shown.shape[1] == 4 else np.ones((len(shown), 1))) * (
        1 if opacity is None else opacity)
    light = linear(shares[:, :3])
    return np.concatenate((light, alpha), axis=1) if (alpha < 1).any() else light


class Paint(NamedTuple):
    """The look of a surface."""

    colors: Array | None  # of points or cells: (N,) values, or light, (N, 3) or (N, 4)
    by_cell: bool
    others: dict[str, Any]  # arguments for all primitives
    of_faces: dict[str, Any] | None = None  # for meshes instead of colours: uv and material

    def of(self, points: Array, cells: Array) -> dict[str, Any]:
        """Arguments for primitives of `cells` that have the `points`, (N, points of each)."""
        if self.colors is None:
            return self.others
        own = self.colors[cells] if self.by_cell else self.colors[points].mean(axis=1)
        return {**self.others, "colors": own}

    def of_mesh(self, faces: Array, cells: Array) -> dict[str, Any]:
        """Arguments for a mesh, with colours of vertices where possible."""
        if self.of_faces is not None:
            return {**self.others, **self.of_faces}
        if self.by_cell or self.colors is None or self.colors.shape[1:] == (4,):
            return self.of(faces, cells)
        return {**self.others, "colors": self.colors}


def add_surface(scene: Scene, surface: Any, paint: Paint, smooth: bool | None,
                point_radii: Array | float, line_radii: Array | float) -> None:
    """Adds PolyData of PyVista: polygons as triangles, lines as cylinders and vertices as spheres,
    whose radii may be those of each point. smooth: as for from_pyvista()."""
    points = np.asarray(surface.points)
    of_spheres, of_lines = (np.broadcast_to(r, len(points)) for r in (point_radii, line_radii))
    # The cells of PolyData are vertices, lines, polygons and strips, in this order.
    rows, vertices = _cells(surface.verts)
    if len(rows):
        scene.spheres(points[rows], of_spheres[rows], **paint.of(rows[:, None], vertices))
    first = surface.n_verts
    rows, lines = _cells(surface.lines)
    if len(rows):
        lines += first
        inside = lines[1:] == lines[:-1]
        pairs = np.stack((rows[:-1], rows[1:]))[:, inside]
        scene.cones(*points[pairs], *of_lines[pairs], **paint.of(pairs.T, lines[1:][inside]))
        joints, places = np.unique(rows, return_index=True)
        scene.spheres(points[joints], of_lines[joints], **paint.of(joints[:, None], lines[places]))
    first += surface.n_lines
    if first == surface.n_cells:
        return
    # Numbers of cells, through the triangulation; strips become triangles, too.
    own = surface.copy(deep=False)
    own.clear_data()
    own.cell_data["cell"] = np.arange(surface.n_cells)
    own = own.triangulate()
    faces = np.asarray(own.regular_faces)
    cells = np.asarray(own.cell_data["cell"])[-len(faces):] if len(faces) else np.empty(0, int)
    if not len(faces):
        return
    normals = None
    if smooth:
        normals = np.asarray(surface.compute_normals(
            cell_normals=False, split_vertices=False, consistent_normals=False,
            auto_orient_normals=False).point_data["Normals"])
    elif smooth is None and "Normals" in surface.point_data:
        normals = np.asarray(surface.point_data["Normals"])
    if normals is not None:  # 0 where all faces have no area
        normals = np.where(normals.any(axis=1, keepdims=True), normals, (0, 0, 1))
    out = paint.of_mesh(faces, cells)
    if len(faces) == len(points) and isinstance(out.get("colors"), np.ndarray) and (
            out["colors"] is not paint.colors):
        # Colours of this number would be taken as those of vertices.
        faces = np.concatenate((faces, faces[:1, [0, 0, 0]]))
        out = {**out, "colors": np.concatenate((out["colors"], out["colors"][:1]))}
    scene.mesh(points, faces, normals=normals, **out)


def _cells(packed: Any) -> tuple[Array, Array]:
    """The points of VTK's list of cells, each a number of points and then these; and the number of
    the cell of each."""
    numbers = np.asarray(packed)
    step = int(numbers[0]) + 1 if len(numbers) else 1
    starts = np.arange(0, len(numbers), step)
    if not (numbers[starts] == step - 1).all():  # of several sizes
        places, at = [], 0
        while at < len(numbers):
            places.append(at)
            at += 1 + int(numbers[at])
        starts = np.array(places)
    return np.delete(numbers, starts), np.repeat(np.arange(len(starts)), numbers[starts])


# --- OVITO


def from_ovito(data: Any) -> Scene:
    """A scene of an OVITO DataCollection, as `pipeline.compute()` returns, in OVITO's units.

    Kept, as OVITO shows them: particles with positions, radii, colours, transparency and the shapes
    sphere and ellipsoid; bonds; the simulation cell; surface meshes. Elements whose display is
    switched off are left out. Warns of what is left out: other shapes of particles, dislocations,
    vectors, lines, and overlays.
    """
    if not hasattr(data, "particles") or not hasattr(data, "surfaces"):
        raise TypeError(f"data: expected an ovito.data.DataCollection, found {type(data).__name__}")
    scene = Scene()
    cell = data.cell
    particles = data.particles
    if particles is not None and particles.count:
        colors, radii = _ovito_particles(scene, particles)
        if particles.bonds is not None and particles.bonds.count:
            _ovito_bonds(scene, particles, cell, colors)
        arrows = [name for name in particles.keys()
                  if getattr(getattr(particles[name], "vis", None), "enabled", False)]
        if arrows:
            warn(f"arrows are left out: {', '.join(arrows)}")
    if cell is not None and cell.vis is not None and cell.vis.enabled and cell.vis.render_cell:
        _ovito_cell(scene, cell)
    for surface in data.surfaces.values():
        _ovito_surface(scene, surface)
    for name in ("dislocations", "lines", "vectors", "trajectories", "triangle_meshes", "grids"):
        if getattr(data, name, None):
            warn(f"{name} of OVITO are left out")
    return scene


def _property(of: Any, name: str) -> Array | None:
    return np.asarray(of[name]) if name in of else None


def _ovito_particles(scene: Scene, particles: Any) -> tuple[Array, Array]:
    count, vis = particles.count, particles.vis
    radii, colors = np.zeros(count), np.tile(np.asarray(vis.default_color, float), (count, 1))
    shapes = {str(vis.shape).rpartition(".")[2]}
    kinds = particles.particle_types if "Particle Type" in particles else None
    if kinds is not None:
        numbers = np.asarray(kinds)
        for kind in kinds.types:
            of_kind = numbers == kind.id
            radii[of_kind], colors[of_kind] = kind.radius, kind.color
            shape = str(getattr(kind, "shape", "")).rpartition(".")[2]
            if of_kind.any() and shape not in ("", "Unspecified"):
                shapes.add(shape)
    own = _property(particles, "Radius")
    if own is not None:
        radii = np.where(own > 0, own, radii)
    radii = np.where(radii > 0, radii, vis.radius) * vis.scaling
    own = _property(particles, "Color")
    colors = linear(colors if own is None else own)
    chosen = _property(particles, "Selection")
    if chosen is not None and chosen.any():
        colors[chosen != 0] = linear(np.asarray(vis.selection_color))
    if not vis.enabled:
        return colors, radii
    transparency = _property(particles, "Transparency")
    opacity = None if transparency is None or not transparency.any() else 1 - np.clip(
        transparency, 0, 1)
    others = sorted(shapes - {"Sphere", "Circle"})
    if others:
        warn(f"shapes of particles are drawn as spheres: {', '.join(others)}")
    positions = np.asarray(particles.positions)
    axes = _property(particles, "Aspherical Shape")
    round_ones = np.ones(count, bool) if axes is None else ~axes.any(axis=1)
    look: list[dict[str, Any]] = [
        {"colors": colors[s], "opacity": None if opacity is None else opacity[s]}
        for s in (round_ones, ~round_ones)]
    if round_ones.any():
        scene.spheres(positions[round_ones], radii[round_ones], **look[0])
    if axes is not None and not round_ones.all():
        turns = _rotations(_property(particles, "Orientation"), count)
        half = turns * np.where(axes > 0, axes, axes[:, :1])[:, None, :] * vis.scaling
        scene.ellipsoids(positions[~round_ones], half.transpose(0, 2, 1)[~round_ones], **look[1])
    return colors, radii


def _rotations(quaternions: Array | None, count: int) -> Array:
    """Matrices of (x, y, z, w); of 0, no rotation."""
    if quaternions is None:
        return np.tile(np.eye(3), (count, 1, 1))
    lengths = np.linalg.norm(quaternions, axis=1, keepdims=True)
    unit = np.where(lengths > 0, quaternions, (0, 0, 0, 1)) / np.where(lengths > 0, lengths, 1)
    x, y, z, w = unit.T
    return np.moveaxis(np.array(
        [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]), 2, 0)


def _ovito_bonds(scene: Scene, particles: Any, cell: Any, colors: Array) -> None:
    bonds, vis = particles.bonds, particles.bonds.vis
    if not vis.enabled:
        return
    ends, positions = np.asarray(bonds.topology), np.asarray(particles.positions)
    across = positions[ends[:, 1]] - positions[ends[:, 0]]
    images = _property(bonds, "Periodic Image")
    if images is not None and cell is not None:
        across = across + images @ np.asarray(cell[...])[:, :3].T
    mode, own = str(vis.coloring_mode).rpartition(".")[2], _property(bonds, "Color")
    kinds = bonds.bond_types if "Bond Type" in bonds else None
    if own is not None:
        halves = [linear(own)] * 2
    elif mode == "ByParticle":
        halves = [colors[ends[:, 0]], colors[ends[:, 1]]]
    else:
        of_bonds = np.tile(np.asarray(vis.color, float), (len(ends), 1))
        for kind in kinds.types if kinds is not None and mode == "ByType" else ():
            of_bonds[np.asarray(kinds) == kind.id] = kind.color
        halves = [linear(of_bonds)] * 2
    transparency = _property(bonds, "Transparency")
    opacity = None if transparency is None or not transparency.any() else 1 - np.clip(
        transparency, 0, 1)
    # Two halves, so that bonds across the boundary of the cell end at it on both sides.
    for start, way, half in zip(ends.T, (across / 2, -across / 2), halves, strict=True):
        scene.cylinders(positions[start], positions[start] + way, vis.width / 2, colors=half,
                        opacity=opacity)


def _ovito_cell(scene: Scene, cell: Any) -> None:
    matrix = np.asarray(cell[...])
    bits = np.array([[i >> k & 1 for k in range(2 if cell.is2D else 3)] for i in range(
        4 if cell.is2D else 8)])
    corners = matrix[:, 3] + bits @ matrix[:, :bits.shape[1]].T
    pairs = [(i, i | 1 << k) for i in range(len(bits)) for k in range(bits.shape[1]) if not i >> k & 1]
    color = tuple(linear(np.asarray(cell.vis.rendering_color)).tolist())
    first, second = corners[np.array(pairs).T]
    scene.cylinders(first, second, cell.vis.line_width, colors=color)
    scene.spheres(corners, cell.vis.line_width, colors=color)


def _ovito_surface(scene: Scene, surface: Any) -> None:
    vis = surface.vis
    if vis is None or not vis.enabled:
        return
    shown, caps, _ = surface.to_triangle_mesh()
    parts = [(shown, vis.surface_color, vis.surface_transparency)]
    if caps is not None and vis.show_cap:
        parts.append((caps, vis.cap_color, vis.cap_transparency))
    if str(vis.color_mapping_mode).rpartition(".")[2] not in ("Uniform", "None"):
        warn("surfaces have one colour; their colour mapping is left out")
    for mesh, color, transparency in parts:
        if mesh.face_count:
            vertices, faces = np.asarray(mesh.get_vertices()), np.asarray(mesh.get_faces())
            smooth = vis.smooth_shading and mesh is shown
            scene.mesh(vertices, faces, normals=_normals(vertices, faces) if smooth else None,
                       colors=tuple(linear(np.asarray(color)).tolist()),
                       opacity=float(1 - transparency))


def _normals(vertices: Array, faces: Array) -> Array:
    """Means of the normals of faces, by area."""
    a, b, c = vertices[faces].swapaxes(0, 1)
    out = np.zeros_like(vertices)
    np.add.at(out, faces.ravel(), np.repeat(np.cross(b - a, c - a), 3, axis=0))
    return out
