"""Scenes from objects of other libraries; each test needs its library."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import raio

SMALL = {"size": (64, 48), "samples": 4}


def same(a: raio.Image, b: raio.Image) -> bool:
    return np.array_equal(a.numpy(), b.numpy())


def hit(scene: raio.Scene, origin, direction) -> float:
    return float(scene.intersect([origin], [direction]).distance[0])


def color(scene: raio.Scene, from_, at, up=(0, 0, 1)) -> np.ndarray:
    """The colour in the middle of the picture, without light and shade."""
    image = scene.render(size=(3, 3), samples=1, from_=from_, at=at, up=up, fov=0.2, channels=["albedo"])
    return image["albedo"][1, 1]


@pytest.fixture
def silent():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


# --- ASE


@pytest.fixture
def ase():
    return pytest.importorskip("ase")


@pytest.mark.filterwarnings("ignore:.*images of atoms")
def test_ase_like_the_file(ase, tmp_path: Path):
    from ase.build import bulk
    from ase.io import write
    salt = bulk("NaCl", "rocksalt", a=5.64, cubic=True) * (2, 2, 1)
    write(tmp_path / "salt.xyz", salt)
    for options in ({}, {"style": "ball-and-stick"}, {"cell": True, "images": (2, 1, 1)},
                    {"only": "element Na"}):
        assert same(raio.from_ase(salt, **options).render(**SMALL),
                    raio.load(tmp_path / "salt.xyz", **options).render(**SMALL))


def test_ase_radii_and_places(ase, silent):
    atoms = ase.Atoms("CO", [[0, 0, 0], [1 / 3, 0, 5]])
    scene = raio.from_ase(atoms, style="space-filling")
    assert len(scene) == 2
    assert hit(scene, [0, 0, -10], [0, 0, 1]) == pytest.approx(10 - 1.7, abs=1e-5)
    assert hit(scene, [1 / 3, 0, 20], [0, 0, -1]) == pytest.approx(15 - 1.52, abs=1e-5)


def test_ase_values(ase, silent):
    atoms = ase.Atoms("Ar3", [[0, 0, 0], [5, 0, 0], [10, 0, 0]])
    atoms.arrays["my charge"] = np.array([0.0, 1, 2])
    atoms.arrays["f"] = np.arange(9.0).reshape(3, 3)
    for name in ("my charge", "f.1"):
        scene = raio.from_ase(atoms, color_by=name, style="space-filling")
        for k, entry in ((0, 0), (1, 128), (2, 255)):
            shown = color(scene, (5 * k, 0, 9), (5 * k, 0, 0), (0, 1, 0))
            assert shown == pytest.approx(raio.colormap("viridis")[entry], abs=0.02)
    with pytest.raises(raio.SceneError, match=r"^atoms: .*; the object has .*f\.3"):
        raio.from_ase(atoms, color_by="force")


def test_ase_warns_and_refuses(ase):
    atoms = ase.Atoms("X", [[0, 0, 0]], cell=[3, 0, 0])
    with pytest.warns(raio.SceneWarning, match="three sides"), pytest.warns(
            raio.SceneWarning, match="^atoms: warning: labels that are not elements") as told:
        raio.from_ase(atoms)
    assert told[0].filename == __file__
    shared = ase.Atoms("Cu", info={"occupancy": {"0": {"Cu": 0.75, "Au": 0.25}}})
    with pytest.warns(raio.SceneWarning, match="partial occupancies"):
        raio.from_ase(shared)
    with pytest.raises(ValueError, match="atom 0"):
        raio.from_ase(ase.Atoms("H", [[np.nan, 0, 0]]))
    with pytest.raises(ValueError, match="at least one"):
        raio.from_ase(ase.Atoms())
    with pytest.raises(TypeError, match="samples"):
        raio.from_ase(ase.Atoms("H"), samples=3)
    with pytest.raises(TypeError, match="found list"):
        raio.from_ase([1])


# --- MDAnalysis


def universe(n: int = 4):
    mda = pytest.importorskip("MDAnalysis")
    u = mda.Universe.empty(n, n_residues=2, atom_resindex=[0, 0, 1, 1][:n], trajectory=True)
    u.add_TopologyAttr("elements", ["N", "C", "C", "O"])
    u.add_TopologyAttr("names", ["N", "CA", "CA", "O5'"])
    u.add_TopologyAttr("resnames", ["ALA", "GLY"])
    u.add_TopologyAttr("resids", [7, 8])
    u.add_TopologyAttr("chainIDs", ["A", "A", "B", "B"])
    u.add_TopologyAttr("tempfactors", [1.0, 2, 3, 4])
    u.atoms.positions = [[0, 0, 0], [4, 0, 0], [8, 0, 0], [12, 0, 0]]
    return u


def test_mdanalysis_atoms(silent):
    u = universe()
    scene = raio.from_mdanalysis(u, style="space-filling")
    assert len(scene) == 4
    assert hit(scene, [0, 0, 10], [0, 0, -1]) == pytest.approx(10 - 1.55, abs=1e-5)
    assert len(raio.from_mdanalysis(u.atoms[:3], style="space-filling")) == 3
    assert len(raio.from_mdanalysis(u, style="space-filling", only="chain B")) == 2
    assert len(raio.from_mdanalysis(u, style="space-filling", only="residue ALA")) == 2
    scene = raio.from_mdanalysis(u, style="space-filling", color_by="bfactor")
    assert color(scene, (12, 0, 9), (12, 0, 0), (0, 1, 0)) == pytest.approx(
        raio.colormap("viridis")[255], abs=0.02)


def test_mdanalysis_bonds_and_names(silent):
    u = universe()
    u.add_TopologyAttr("bonds", [(0, 1), (2, 3)])  # too long to be found by distance
    scene = raio.from_mdanalysis(u, style="ball-and-stick")
    assert hit(scene, [2, 0, 10], [0, 0, -1]) == pytest.approx(10 - 0.12, abs=1e-5)
    assert np.isinf(hit(scene, [6, 0, 10], [0, 0, -1]))
    # A group without the second end of a bond.
    assert len(raio.from_mdanalysis(u.atoms[[1, 2]], style="ball-and-stick")) == 2


@pytest.mark.filterwarnings("ignore:::MDAnalysis")
@pytest.mark.parametrize("suffix", ["xtc", "trr", "dcd"])
def test_mdanalysis_frames(tmp_path: Path, suffix: str):
    u = universe()
    u.dimensions = [30, 30, 30, 90, 90, 90]
    with pytest.importorskip("MDAnalysis").Writer(str(tmp_path / f"t.{suffix}"), 4) as writer:
        for z in (0, 3):
            u.atoms.positions = [[0, 0, z], [4, 0, z], [8, 0, z], [12, 0, z]]
            writer.write(u.atoms)
    u.load_new(str(tmp_path / f"t.{suffix}"))
    tops = [hit(raio.from_mdanalysis(u, style="space-filling"), [4, 0, 20], [0, 0, -1])
            for _ in u.trajectory]
    assert tops == pytest.approx([20 - 1.7, 17 - 1.7], abs=1e-4)


def test_mdanalysis_repeated_numbers():
    u = universe()
    u.residues.resids = [7, 7]
    u.add_TopologyAttr("chainIDs", ["A"] * 4)
    with pytest.warns(raio.SceneWarning, match="same number"):
        assert len(raio.from_mdanalysis(u, style="space-filling")) == 4


@pytest.mark.filterwarnings("ignore:.*images of atoms")
def test_mdanalysis_box():
    u = universe()
    u.dimensions = [20, 20, 20, 90, 90, 90]
    assert len(raio.from_mdanalysis(u, style="space-filling", cell=True)) > 12
    with pytest.raises(TypeError):
        raio.from_mdanalysis(3)


# --- Biotite


@pytest.mark.filterwarnings("ignore:.*images of atoms")
def test_biotite(tmp_path: Path):
    struc = pytest.importorskip("biotite.structure")
    pdbx = pytest.importorskip("biotite.structure.io.pdbx")
    residue = struc.AtomArray(5)
    residue.coord = np.array([[0, 0, 0], [1.5, 0, 0], [2.2, 1.2, 0], [-1, 0.3, 0], [9, 0, 0]], np.float32)
    residue.element[:] = ["C", "C", "O", "H", "C"]
    residue.atom_name[:] = ["C1", "C2", "O5'", "H1", "C3"]
    residue.res_name[:] = "LIG"
    residue.chain_id[:] = "A"
    residue.res_id[:] = 1
    residue.bonds = struc.BondList(5, np.array([[0, 1], [1, 2], [0, 3], [2, 4]]))  # the last is long
    scene = raio.from_biotite(residue, style="ball-and-stick")
    assert len(scene) == 5 + 3 * 2 + 1  # a bond of two elements has two halves
    file = pdbx.CIFFile()
    pdbx.set_structure(file, residue)
    file.write(tmp_path / "tyr.cif")
    read = raio.load(tmp_path / "tyr.cif", style="ball-and-stick")
    assert len(read) == 5 + 2 * 2 + 1
    residue.bonds = None
    assert same(raio.from_biotite(residue, style="ball-and-stick").render(**SMALL), read.render(**SMALL))
    assert len(raio.from_biotite(residue, hide="hydrogen", style="space-filling")) == int(
        (residue.element != "H").sum())
    residue.box = np.diag([30.0, 30, 30])
    assert len(raio.from_biotite(residue, style="space-filling", cell=True)) > len(residue)
    with pytest.warns(raio.SceneWarning, match="2 models"):
        raio.from_biotite(struc.stack([residue, residue]))


# --- trimesh


@pytest.fixture
def trimesh():
    return pytest.importorskip("trimesh")


def test_trimesh_colors(trimesh, silent):
    box = trimesh.creation.box()
    box.visual.face_colors = [[255, 0, 0, 255]] * 6 + [[0, 0, 255, 255]] * 6
    scene = raio.from_trimesh(box)
    assert len(scene) == 12
    shown = [tuple(color(scene, v, (0.1, 0.05, 0), (0.3, 1, 0.2))) for v in np.vstack(
        (np.eye(3), -np.eye(3))) * 5]
    assert {c for c in shown} == {(1, 0, 0), (0, 0, 1)}
    ball = trimesh.creation.icosphere(1)
    ball.visual.vertex_colors = [[0, 255, 0, 255]] * len(ball.vertices)
    assert tuple(color(raio.from_trimesh(ball), (5, 0, 0), (0, 0, 0))) == (0, 1, 0)


def test_trimesh_faces_as_many_as_vertices(trimesh, silent):
    square = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
                             [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3]], process=False)
    square.visual.face_colors = [[255, 0, 0, 255], [0, 255, 0, 255]] * 2
    scene = raio.from_trimesh(square)
    assert tuple(color(scene, (0.8, 0.3, 3), (0.8, 0.3, 0), (0, 1, 0))) == (1, 0, 0)
    assert tuple(color(scene, (0.2, 0.7, 3), (0.2, 0.7, 0), (0, 1, 0))) == (0, 1, 0)


def test_trimesh_opacity(trimesh):
    ball = trimesh.creation.icosphere(1)
    ball.visual.vertex_colors = [[0, 255, 0, 128]] * (len(ball.vertices) - 1) + [[0, 255, 0, 255]]
    with pytest.warns(raio.SceneWarning, match="opacities of vertices"):
        image = raio.from_trimesh(ball).render(background="transparent", **SMALL)
    assert 0.4 < image.numpy()[24, 32, 3] < 0.9


def test_trimesh_normals(trimesh, silent):
    ball = trimesh.creation.icosphere(1)
    flat = trimesh.Trimesh(ball.vertices, ball.faces, process=False)
    smooth = trimesh.Trimesh(ball.vertices, ball.faces, vertex_normals=ball.vertices, process=False)
    pictures = [raio.from_trimesh(m, smooth=s).render(**SMALL) for m, s in (
        (flat, None), (flat, False), (smooth, None), (smooth, True), (smooth, False))]
    assert same(pictures[0], pictures[1]) and same(pictures[2], pictures[3])
    assert same(pictures[0], pictures[4]) and not same(pictures[0], pictures[2])


def test_trimesh_texture(trimesh, silent):
    image = pytest.importorskip("PIL.Image")
    texels = np.zeros((2, 2, 3), np.uint8)
    texels[0, 0], texels[0, 1], texels[1, 0], texels[1, 1] = (255, 0, 0), (0, 255, 0), (
        0, 0, 255), (255, 255, 255)
    visual = trimesh.visual.TextureVisuals(
        uv=[[0, 0], [1, 0], [1, 1], [0, 1]], image=image.fromarray(texels))
    square = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]],
                             visual=visual, process=False)
    scene = raio.from_trimesh(square)
    at = {(0.25, 0.75): (1, 0, 0), (0.75, 0.75): (0, 1, 0), (0.25, 0.25): (0, 0, 1),
          (0.75, 0.25): (1, 1, 1)}
    for (x, y), expected in at.items():
        assert color(scene, (x, y, 3), (x, y, 0), (0, 1, 0)) == pytest.approx(expected, abs=0.02)


def test_trimesh_scene(trimesh, silent):
    ball = trimesh.creation.icosphere(1)
    scene = trimesh.Scene()
    for x in (0, 3, 6):
        matrix = np.eye(4)
        matrix[0, 3] = x
        scene.add_geometry(ball, geom_name="ball", transform=matrix)
    scene.add_geometry(trimesh.PointCloud([[0, 0, 9]]), transform=np.eye(4))
    made = raio.from_trimesh(scene, radius=0.5)
    assert len(made) == 3 * 80 + 1
    assert hit(made, [6, 0.1, -9], [0, 0, 1]) < 9
    assert hit(made, [0, 0, 20], [0, 0, -1]) == pytest.approx(10.5, abs=1e-4)


def test_trimesh_like_the_file(trimesh, tmp_path: Path, silent):
    ball = trimesh.creation.icosphere(1)
    ball.visual.vertex_colors = trimesh.visual.interpolate(ball.vertices[:, 2], "viridis")
    scene = trimesh.Scene()
    for x in (0, 3):
        scene.add_geometry(ball, geom_name="ball",
                           transform=trimesh.transformations.translation_matrix([x, x / 3, 0]))
    scene.camera = trimesh.scene.Camera(fov=(60, 45), resolution=(64, 48))
    scene.camera_transform = trimesh.transformations.translation_matrix([1.5, 0.5, 6])
    made = raio.from_trimesh(scene)
    tops = made.render(channels=["depth"], **SMALL)["depth"]
    assert np.nanmin(tops) == pytest.approx(5, abs=0.1)
    scene.export(tmp_path / "a.glb")
    read = raio.load(tmp_path / "a.glb")
    assert len(made) == len(read) == 160
    view = {"from_": (1.5, 0.5, 6), "at": (1.5, 0.5, 0), "up": (0, 1, 0), "fov": 45, "filter": "box",
            **SMALL}
    # trimesh writes displayed colours where glTF has light.
    a, b = (s.render(channels=["depth"], **view)["depth"] for s in (made, read))
    assert np.allclose(a, b, atol=1e-4, equal_nan=True)
    assert same(made.render(**SMALL), made.render(**view))


# --- PyVista


@pytest.fixture
def pv():
    return pytest.importorskip("pyvista")


def test_pyvista_polydata(pv, silent):
    plane = pv.Plane(i_resolution=2, j_resolution=1)  # quadrilaterals
    plane.cell_data["v"] = [0.0, 1]
    scene = raio.from_pyvista(plane, scalars="v", vmin=0, vmax=1)
    assert len(scene) == 4
    ends = raio.colormap("viridis")[[0, 255]]
    for x, expected in ((-0.3, ends[0]), (0.3, ends[1])):
        assert color(scene, (x, 0.1, 3), (x, 0.1, 0), (0, 1, 0)) == pytest.approx(expected, abs=1e-6)
    plane = pv.Plane(i_resolution=1, j_resolution=1)
    plane.point_data["c"] = np.full((4, 3), [255, 0, 0], np.uint8)
    shown = color(raio.from_pyvista(plane, scalars="c"), (0.2, 0.1, 3), (0.2, 0.1, 0), (0, 1, 0))
    assert tuple(shown) == (1, 0, 0)


def test_pyvista_polygons_and_strips(pv, silent):
    points = np.array([[0., 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 2, 0]])
    mesh = pv.PolyData(points, [4, 0, 1, 2, 3, 3, 3, 2, 4])
    mesh.cell_data["v"] = [0.0, 1]
    scene = raio.from_pyvista(mesh, scalars="v")
    assert len(scene) == 3
    for y, entry in ((0.3, 0), (1.3, 255)):
        assert color(scene, (0.5, y, 3), (0.5, y, 0), (0, 1, 0)) == pytest.approx(
            raio.colormap("viridis")[entry], abs=1e-6)
    assert len(raio.from_pyvista(pv.PolyData(points, strips=[5, 0, 1, 3, 2, 4]))) == 3


def test_pyvista_cells_as_many_as_points(pv, silent):
    mesh = pv.PolyData(np.array([[0., 0, 0], [1, 0, 0], [1, 1, 0]]), [3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2])
    mesh.cell_data["v"] = [5.0, 5, 5]
    raio.from_pyvista(mesh, scalars="v", vmin=0, vmax=9).render(**SMALL)


def test_pyvista_lines_and_points(pv, silent):
    line = pv.lines_from_points(np.array([[0., 0, 0], [1, 0, 0], [2, 0, 0]]))
    line.point_data["v"] = [0.0, 1, 2]
    scene = raio.from_pyvista(line, scalars="v", radius=0.1)
    assert len(scene) == 2 + 3  # segments and joints
    assert hit(scene, [0.5, 0, 3], [0, 0, -1]) == pytest.approx(2.9, abs=1e-5)
    cloud = pv.PolyData(np.array([[0., 0, 0], [1, 0, 0]]))
    cloud.cell_data["w"] = [0.0, 1]
    scene = raio.from_pyvista(cloud, scalars="w", radius=0.2)
    assert len(scene) == 2
    assert color(scene, (1, 0, 3), (1, 0, 0), (0, 1, 0)) == pytest.approx(
        raio.colormap("viridis")[255], abs=1e-6)


def test_pyvista_volumes_and_blocks(pv, silent):
    grid = pv.ImageData(dimensions=(3, 3, 3))
    grid["v"] = np.arange(27.0)
    assert len(raio.from_pyvista(grid, scalars="v")) == 6 * 4 * 2
    assert len(raio.from_pyvista(grid.cast_to_unstructured_grid(), scalars="v")) == 48
    ball = pv.Sphere()
    smooth, flat = raio.from_pyvista(ball), raio.from_pyvista(ball, smooth=False)
    assert not same(smooth.render(**SMALL), flat.render(**SMALL))
    blocks = pv.MultiBlock([ball, grid])
    with pytest.warns(raio.SceneWarning, match="1 of 2 blocks"):
        assert len(raio.from_pyvista(blocks, scalars="v")) == 48 + len(smooth)
    ball.point_data["c"] = np.full((ball.n_points, 4), 100, np.uint8)
    alpha = raio.from_pyvista(ball, scalars="c", opacity=0.5).render(
        background="transparent", **SMALL).numpy()[24, 32, 3]
    assert alpha == pytest.approx(1 - (1 - 100 / 255 / 2) ** 2, abs=1e-3)  # two sides
    ball.point_data["c"] = np.full((ball.n_points, 3), 100)
    with pytest.raises(TypeError, match="colours of int64"):
        raio.from_pyvista(ball, scalars="c")
    with pytest.warns(raio.SceneWarning, match="no cells"):
        raio.from_pyvista(pv.PolyData())
    with pytest.raises(ValueError, match="no 'w', but v"):
        raio.from_pyvista(grid, scalars="w")


# --- OVITO


def test_ovito(silent):
    pytest.importorskip("ovito")
    from ovito.data import DataCollection, ParticleType
    data = DataCollection()
    particles = data.create_particles(count=3)
    particles.create_property("Position", data=[[0.5, 1, 1], [3.5, 1, 1], [2, 3, 3]])
    types = particles.create_property("Particle Type", data=[1, 2, 2])
    types.types.append(ParticleType(id=1, name="A", color=(1, 0, 0), radius=0.3))
    types.types.append(ParticleType(id=2, name="B", color=(0, 0.5, 0), radius=0.2))
    bonds = particles.create_bonds(count=1)
    bonds.create_property("Topology", data=[[0, 1]])
    bonds.create_property("Periodic Image", data=[[-1, 0, 0]])
    bonds.vis.width = 0.2
    data.create_cell(np.eye(3) * 4)
    data.cell.vis.line_width = 0.01
    scene = raio.from_ovito(data)
    assert len(scene) == 3 + 2 + 12 + 8
    assert hit(scene, [0.5, 1, 9], [0, 0, -1]) == pytest.approx(7.7, abs=1e-5)
    # The bond leaves the cell on both sides.
    assert hit(scene, [0.1, 1, 9], [0, 0, -1]) == pytest.approx(7.9, abs=1e-5)
    assert hit(scene, [3.9, 1, 9], [0, 0, -1]) == pytest.approx(7.9, abs=1e-5)
    assert np.isinf(hit(scene, [2, 1, 9], [0, 0, -1]))
    green = color(scene, (2, 3, 9), (2, 3, 3), (0, 1, 0))
    assert green == pytest.approx(raio.linear([0, 0.5, 0]), abs=1e-6)
    particles.create_property("Transparency", data=[0, 0, 0.5])
    particles.create_property("Radius", data=[0.5, 0, 0])
    scene = raio.from_ovito(data)
    assert hit(scene, [0.5, 1, 9], [0, 0, -1]) == pytest.approx(7.5, abs=1e-5)


def test_ovito_shapes():
    pytest.importorskip("ovito")
    from ovito.data import DataCollection
    from ovito.vis import ParticlesVis
    data = DataCollection()
    particles = data.create_particles(count=1)
    particles.create_property("Position", data=[[0, 0, 0]])
    particles.create_property("Aspherical Shape", data=[[1, 2, 3]])
    half = np.sqrt(0.5)
    particles.create_property("Orientation", data=[[0, 0, half, half]])  # x to y
    scene = raio.from_ovito(data)
    assert scene.bounds[1] == pytest.approx((2, 1, 3), abs=1e-5)
    particles.vis.shape = ParticlesVis.Shape.Box
    with pytest.warns(raio.SceneWarning, match="Box"):
        raio.from_ovito(data)
    particles.vis.shape = ParticlesVis.Shape.Sphere
    particles.create_property("Force", data=[[1, 0, 0]]).vis.enabled = True
    with pytest.warns(raio.SceneWarning, match="arrows are left out: Force"):
        raio.from_ovito(data)


def test_ovito_surface(silent):
    pytest.importorskip("ovito")
    from ovito.data import DataCollection
    from ovito.modifiers import ConstructSurfaceModifier
    from ovito.pipeline import Pipeline, StaticSource
    data = DataCollection()
    grid = np.stack(np.meshgrid(*[np.arange(3.0)] * 3), axis=-1).reshape(-1, 3) + 4
    data.create_particles(count=27).create_property("Position", data=grid)
    data.create_cell(np.eye(3) * 10)
    data.cell.vis.enabled = data.particles.vis.enabled = False
    pipeline = Pipeline(source=StaticSource(data=data))
    pipeline.modifiers.append(ConstructSurfaceModifier(radius=1.0))
    scene = raio.from_ovito(pipeline.compute())
    assert hit(scene, [5.1, 5.2, 9], [0, 0, -1]) == pytest.approx(3, abs=0.3)
    assert scene.bounds[0] == pytest.approx((4, 4, 4), abs=0.3)
