"""ASE's writer and viewer: frames, looks and refusals, against ASE's own numbers."""

import tomllib
from importlib.metadata import EntryPoint

import numpy as np
import pytest
import raio
from conftest import ROOT

ase = pytest.importorskip("ase")

from ase.build import bulk, molecule  # noqa: E402
from ase.io import write  # noqa: E402
from ase.visualize import view, viewers  # noqa: E402
from raio.ase import figure  # noqa: E402


@pytest.fixture
def plugin(monkeypatch):
    """ASE with the entry points of pyproject.toml, as after an installation."""
    from ase.io import formats
    monkeypatch.setattr(formats, "ioformats", dict(formats.ioformats))
    monkeypatch.setattr(viewers, "VIEWERS", dict(viewers.VIEWERS))
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    for group, known, define in (
            ("ase.ioformats", formats.ioformats, formats.define_external_io_format),
            ("ase.visualize", viewers.VIEWERS, viewers.define_external_viewer)):
        for name, value in groups[group].items():
            known.pop(name, None)
            define(EntryPoint(name, value, group))
    return groups


def test_write(plugin, tmp_path):
    pytest.importorskip("matplotlib")
    image = pytest.importorskip("PIL.Image")
    atoms = bulk("NaCl", "rocksalt", a=5.64, cubic=True)
    frame = {"rotation": "10z,-80x", "scale": 30, "show_unit_cell": 0}
    write(tmp_path / "ours.png", atoms, format="raio", samples=4, **frame)
    write(tmp_path / "theirs.png", atoms, **frame)
    ours, theirs = (np.asarray(image.open(tmp_path / f"{n}.png").convert("L")) for n in ("ours", "theirs"))
    assert ours.shape == theirs.shape
    assert ((ours < 250) == (theirs < 250)).mean() > 0.98  # those of atoms


@pytest.mark.parametrize("settings", [
    {"rotation": "10z,-80x"}, {"rotation": "30x,40y,5z", "show_unit_cell": 3}, {"bbox": (-1, -2, 5, 3)},
    {"extra_offset": (20, 10), "auto_bbox_size": 1.4}, {"maxwidth": 100}, {"repeat": (2, 1, 1)}])
def test_frame(settings, rng):
    """The middle of each atom is where ASE has it."""
    from ase.io.utils import PlottingVariables
    atoms = ase.Atoms("H9", rng.uniform(0, 5, (9, 3)), cell=[5, 4, 3])
    scene, options = figure(atoms, **settings, radii=0.6, celllinewidth=1e-3)
    width, height = (4 * side for side in options["size"])
    seen = scene.render(size=(width, height), aa=1, channels=["id"])["id"]
    own = dict(settings)
    atoms = atoms.repeat(own.pop("repeat", 1))
    where = PlottingVariables(atoms, radii=0.6, **own)
    assert (int(where.w), int(where.h)) == options["size"]
    zoom = min(width / where.w, height / where.h)
    whole = 0
    for atom, (x, y, _) in enumerate(where.positions[:len(atoms)]):
        rows, columns = np.nonzero(seen == atom + 1)
        if len(rows) > 0.97 * np.pi * (zoom * where.d[atom] / 2) ** 2:  # not hidden nor cut off
            assert np.mean(columns) + 0.5 - width / 2 == pytest.approx((x - where.w / 2) * zoom, abs=0.2)
            assert height / 2 - np.mean(rows) - 0.5 == pytest.approx((y - where.h / 2) * zoom, abs=0.2)
            whole += 1
    assert whole >= 2


def sphere(scene, atom):
    part = scene._parts[0]
    return float(part.radii[atom]), part.colors[atom].tolist()


def test_looks():
    from ase.data import covalent_radii
    from ase.data.colors import jmol_colors
    atoms = molecule("H2O")
    scene, _ = figure(atoms)
    radius, color = sphere(scene, 0)
    assert radius == pytest.approx(covalent_radii[8])
    assert color == pytest.approx(raio.linear(jmol_colors[8]).tolist())
    assert sphere(figure(atoms, radii=0.5)[0], 1)[0] == pytest.approx(covalent_radii[1] / 2)
    assert sphere(figure(atoms, radii=[1, 2, 3])[0], 2)[0] == 3
    scene, _ = figure(atoms, radii={"O": 1.5}, colors={"H": "white", "O": "#000000"})
    assert sphere(scene, 0) == (1.5, [0, 0, 0])
    assert sphere(scene, 1) == (pytest.approx(covalent_radii[1]), [1, 1, 1])
    scene, _ = figure(atoms, colors=[(1, 0, 0), "white", (0, 0, 0.5)], transmittances=[0, 0.25, 1])
    assert sphere(scene, 2)[1] == pytest.approx([0, 0, float(raio.linear(0.5))])
    assert scene._parts[0].opacity.tolist() == [1, 0.75, 0]


def test_cell_and_bonds():
    from ase.constraints import FixAtoms
    atoms = bulk("Cu", cubic=True)
    plain = len(figure(atoms, show_unit_cell=0)[0])
    scene, _ = figure(atoms, celllinewidth=0.2, radii=0.1)
    assert len(scene) == plain + 12 * 3
    assert scene.intersect([[1.8, -9, 0]], [[0, 1, 0]]).distance[0] == pytest.approx(9 - 0.2, abs=1e-5)
    pair = ase.Atoms("NN", [[0, 0, 0], [0, 0, 2]], cell=[9, 9, 9])
    for order, gap in ((1, None), (2, 0), (3, None)):
        scene, _ = figure(pair, radii=0.1, bondatoms=[(0, 1, (0, 0, 0), order, (0, 0.4, 0))],
                          show_unit_cell=0, bondlinewidth=0.1)
        assert len(scene) == 2 + 2 * order
        hit = scene.intersect([[-5, 0, 1.5], [-5, 0.2 * (1 + (order == 3)), 1.5]], [[1, 0, 0]] * 2).distance
        assert np.isinf(hit[0]) == (gap == 0)
        assert np.isinf(hit[1]) == (order == 1)
    # Across the boundary of the cell, two halves end at it.
    scene, _ = figure(pair, radii=0.1, bondatoms=[(1, 0, (0, 0, 1))], show_unit_cell=0)
    assert scene.intersect([[-5, 0, 4], [-5, 0, -2]], [[1, 0, 0]] * 2).distance == pytest.approx([4.9] * 2)
    atoms.set_constraint(FixAtoms([1]))
    assert len(figure(atoms, exportconstraints=True)[0]) > len(figure(atoms)[0])


def test_sizes():
    atoms = bulk("Cu", cubic=True) * (4, 2, 1)
    ratio = np.divide(*figure(atoms, scale=100, maxwidth=1e9)[1]["size"])
    for name, k in (("canvas_width", 0), ("canvas_height", 1)):
        size = figure(atoms, **{name: 300})[1]["size"]
        assert size[k] == 300
        assert size[0] / size[1] == pytest.approx(ratio, rel=0.02)
    assert figure(atoms, size=(64, 64))[1]["size"] == (64, 64)
    assert figure(atoms, transparent=True)[1]["background"] == "transparent"
    with pytest.raises(ValueError, match="one of them"):
        figure(atoms, canvas_width=1, canvas_height=1)


@pytest.mark.filterwarnings("ignore:.*images of atoms")
def test_style_of_raio():
    atoms = bulk("NaCl", "rocksalt", a=5.64, cubic=True)
    scene, options = figure(atoms, style="ball-and-stick", show_unit_cell=0, samples=1)
    assert len(scene) == len(raio.from_ase(atoms, style="ball-and-stick", cell=False))
    assert options.keys() == {"size", "samples"}
    with pytest.raises(TypeError, match="radii: not together with style"):
        figure(atoms, style="sticks", radii=1.0)


def test_refusals(plugin, tmp_path):
    atoms = molecule("H2O")
    path = tmp_path / "a.png"
    for name, hint in (("camera_type", "projection"), ("textures", "look"), ("isosurface_data", "mesh"),
                       ("cell", "show_unit_cell"), ("width", "canvas_width")):
        with pytest.raises(TypeError, match=f"{name} is not a setting.*{hint}"):
            write(path, atoms, format="raio", **{name: 1})
    with pytest.raises(TypeError, match="pause is not"):
        write(path, atoms, format="raio", povray_settings={"pause": False})
    with pytest.raises(TypeError, match="unknown option 'rotations'"):
        write(path, atoms, format="raio", rotations="x")
    for name, value, expected in (("rotation", "10q", "10z,-80x"), ("rotation", [1, 2], "matrix"),
                                  ("show_unit_cell", 4, "0, 1, 2 or 3"), ("size", "8x6", "two whole")):
        with pytest.raises(ValueError, match=f"{name}: expected .*{expected}"):
            figure(atoms, **{name: value})
    with pytest.raises(ValueError, match="radii: expected one for each of 3 atoms"):
        figure(atoms, radii=[1, 2])
    with pytest.raises(ValueError, match="colors: expected one for each of 3"):
        figure(atoms, colors=["red"])
    with pytest.raises(ValueError, match="order from 0 to 3"):
        figure(atoms, bondatoms=[(0, 1, (0, 0, 0), 7)])
    with pytest.raises(ValueError, match="atoms from 0 to 2, found"):
        figure(atoms, bondatoms=[(0, 3)])
    with pytest.raises(TypeError, match="ase.Atoms"):
        figure([1])
    with pytest.raises(ValueError, match="at least one"):
        figure(ase.Atoms())
    assert not path.exists()


def test_scene_files(plugin, tmp_path):
    atoms = molecule("H2O")
    write(tmp_path / "a.raio", atoms, rotation="90x")  # ASE knows the format by the suffix
    assert len(raio.load(tmp_path / "a.raio")) == 3
    with pytest.raises(TypeError, match="samples.*is a scene"):
        write(tmp_path / "a.raio", atoms, samples=3)
    write(tmp_path / "a.png", atoms, format="raio", povray_settings={"canvas_width": 40}, samples=1)
    assert (tmp_path / "a.png").exists()


def test_view(plugin, monkeypatch):
    shown = []
    monkeypatch.setattr(raio.Scene, "view", lambda scene, **options: shown.append((scene, options)))
    atoms = bulk("Cu", cubic=True)
    view(atoms, viewer="raio", repeat=(2, 1, 1), show_unit_cell=0, samples=9)
    assert len(shown[0][0]) == 8 and shown[0][1]["samples"] == 9
    with pytest.warns(raio.SceneWarning, match="last of 2"):
        view([atoms * 2, atoms], viewer="raio", show_unit_cell=0)
    assert len(shown[1][0]) == 4
    with pytest.raises(TypeError, match="volumetric"):
        view(atoms, viewer="raio", data=np.zeros((2, 2, 2)))
