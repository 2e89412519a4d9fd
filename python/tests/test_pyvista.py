"""plotter.raio, against VTK's own matrices, colours and pictures."""

import tomllib

import numpy as np
import pytest
import raio
from conftest import ROOT

pv = pytest.importorskip("pyvista")
import raio.pyvista  # noqa: E402
from raio._overlay import has_opengl  # noqa: E402

SIZE = (80, 60)
opengl = pytest.mark.skipif(not has_opengl(pv.Plotter(off_screen=True).render_window),
                            reason="VTK draws overlays with OpenGL")


@pytest.fixture
def plotter():
    made = []

    def make(**options):
        made.append(pv.Plotter(off_screen=True, window_size=SIZE, **options))
        return made[-1]

    yield make
    for each in made:
        each.close()


def test_entry_point():
    from pyvista.plotting.component_registry import COMPONENT_ENTRY_POINT_GROUP
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    assert groups[COMPONENT_ENTRY_POINT_GROUP] == {"raio": raio.pyvista.__name__}
    assert any(c.name == "raio" for c in pv.registered_plotter_components())


# --- the camera


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("is_parallel", [False, True])
def test_camera(plotter, rng, seed, is_parallel):
    """VTK's matrix takes what each pixel shows to the middle of that pixel."""
    rng = np.random.default_rng(seed)
    pl = plotter()
    pl.add_mesh(pv.Sphere(radius=30, theta_resolution=40, phi_resolution=40))
    pl.camera_position = [rng.normal(size=3) * 4, rng.normal(size=3), rng.normal(size=3)]
    pl.camera.view_angle = rng.uniform(10, 70)
    pl.camera.SetUseHorizontalViewAngle(seed == 3)
    if is_parallel:
        pl.enable_parallel_projection()
        pl.camera.parallel_scale = rng.uniform(1, 20)
    shown = pl.raio.scene().render(size=SIZE, aa=1, channels=["position"])["position"]
    matrix = pl.camera.GetCompositeProjectionTransformMatrix(SIZE[0] / SIZE[1], -1, 1)
    places = np.c_[shown.reshape(-1, 3), np.ones(SIZE[0] * SIZE[1])] @ pv.array_from_vtkmatrix(matrix).T
    places = (places[:, :2] / places[:, 3:] + 1) / 2 * SIZE
    rows, columns = np.mgrid[:SIZE[1], :SIZE[0]] + 0.5
    assert np.abs(places - np.c_[columns.ravel(), (SIZE[1] - rows).ravel()]).max() < 0.01


@opengl
def test_camera_is_that_of_show(plotter):
    """Rendering before show() neither needs nor changes the camera that PyVista would choose."""
    pl, other = plotter(), plotter()
    for each in (pl, other):
        each.add_mesh(pv.Cone(center=(3, 1, 2)))
    pl.raio.render(size=(8, 6), samples=1)
    for each in (pl, other):
        each.add_mesh(pv.Cube(center=(9, 9, 9)))
    pl.raio.scene()
    other.screenshot()
    assert np.allclose(pl.camera.position, other.camera.position)
    assert np.allclose(pl.camera.focal_point, other.camera.focal_point)


# --- colours


def plane(**options):
    """A plane of 4 x 3 units, of which a picture of 80 x 60 shows everything."""
    return pv.Plane(i_size=4, j_size=3, **options)


def facing(pl):
    pl.view_xy()
    pl.enable_parallel_projection()
    pl.camera.parallel_scale = 1.5
    return pl


def albedo(pl, *pixels):
    """Display colours of pixels, (column, row), without light, 0 to 255."""
    light = pl.raio.scene().render(size=SIZE, aa=1, channels=["albedo"])["albedo"]
    shown = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)
    return [np.rint(shown[row, column] * 255).astype(int).tolist() for column, row in pixels]


@opengl
@pytest.mark.parametrize("look", [
    {"cmap": "plasma"}, {"cmap": "plasma", "n_colors": 5}, {"clim": [0.3, 0.6], "below_color": "navy",
     "above_color": "red", "n_colors": 4}, {"clim": [0.4, 0.5]}, {"log_scale": True, "clim": [0.1, 1]},
    {"nan_color": "green"}, {"preference": "cell"}])
def test_colors_are_those_of_vtk(plotter, look):
    """A plane without light has the same colours in both pictures."""
    mesh = plane(i_resolution=8, j_resolution=6)
    mesh["v"] = mesh.points[:, 0] / 5 + 0.5
    if "nan_color" in look:
        mesh["v"][mesh.points[:, 0] > 1] = np.nan
    if "preference" in look:
        mesh.cell_data["v"] = np.linspace(0, 1, mesh.n_cells)
    pl = facing(plotter())
    pl.add_mesh(mesh, scalars="v", lighting=False, show_scalar_bar=False, **look)
    facing(pl)
    theirs = pl.screenshot()
    pixels = [(c, r) for c in range(0, 80, 3) for r in range(0, 60, 7)]
    with pytest.warns(raio.SceneWarning, match="without shading"):
        ours = albedo(pl, *pixels)
    differ = np.abs(np.array(ours) - [theirs[r, c].astype(int) for c, r in pixels]).max(axis=1)
    assert np.percentile(differ, 90) <= 3  # apart from the bounds of bands
    assert (differ > 40).mean() < 0.06


def test_plain_colors(plotter):
    pl = plotter()
    pl.add_mesh(plane(i_resolution=1, j_resolution=1), color="#336699")
    facing(pl)
    assert albedo(pl, (9, 9)) == [[0x33, 0x66, 0x99]]
    pl = plotter()
    mesh = plane(i_resolution=2, j_resolution=1)
    pl.add_mesh(mesh, scalars=np.array([[255, 0, 0], [0, 128, 255]], np.uint8), rgb=True)
    facing(pl)
    assert albedo(pl, (9, 9), (70, 9)) == [[255, 0, 0], [0, 128, 255]]


def test_texture(plotter):
    texels = np.zeros((2, 2, 3), np.uint8)
    texels[0, 0], texels[0, 1], texels[1, 0] = (255, 0, 0), (0, 255, 0), (0, 0, 255)  # from the top
    texels = texels.repeat(8, axis=0).repeat(8, axis=1)
    pl = plotter()
    pl.add_mesh(plane(i_resolution=1, j_resolution=1), texture=pv.Texture(texels))
    facing(pl)
    assert albedo(pl, (20, 15), (60, 15), (20, 45), (60, 45)) == [
        [255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]]


def alpha(pl, *pixels):
    image = pl.raio.scene().render(size=SIZE, samples=16, background="transparent").numpy()
    return [float(image[row, column, 3]) for column, row in pixels]


def test_opacity(plotter):
    pl = plotter()
    mesh = plane(i_resolution=4, j_resolution=1)
    mesh.point_data["v"] = mesh.points[:, 0]
    pl.add_mesh(mesh, scalars="v", opacity=(mesh.points[:, 0] > 0.5).astype(float), show_scalar_bar=False)
    facing(pl)
    assert alpha(pl, (5, 30), (75, 30)) == pytest.approx([0, 1], abs=0.01)
    pl = plotter()
    pl.add_mesh(plane(), color="w", opacity=0.25)
    facing(pl)
    assert alpha(pl, (40, 30)) == pytest.approx([0.25], abs=1e-3)


# --- sizes


@pytest.mark.parametrize("is_parallel", [False, True])
def test_points_and_lines_have_their_sizes(plotter, is_parallel):
    pl = plotter()
    pl.add_points(np.array([[-1.5, 0, -5]]), point_size=20, render_points_as_spheres=True)
    pl.add_mesh(pv.Line((1, -9, 1), (1, 9, 1)), line_width=6)
    facing(pl)
    if not is_parallel:
        pl.disable_parallel_projection()
        pl.camera_position = [(0, 0, 9), (0, 0, 0), (0, 1, 0)]
    covered = pl.raio.scene().render(size=(320, 240), samples=16, background="transparent").numpy()[..., 3]
    line, disc = covered[:, 160:].sum() / 240 / 4, covered[:, :160].sum() / 16
    assert line == pytest.approx(6, rel=0.02)
    assert disc == pytest.approx(np.pi * 10 ** 2, rel=0.03)


def test_edges_and_styles(plotter):
    mesh = plane(i_resolution=2, j_resolution=1)
    pl = plotter()
    pl.add_mesh(mesh, color="white", show_edges=True, edge_color="red", line_width=4)
    facing(pl)
    assert albedo(pl, (40, 20), (20, 20)) == [[255, 0, 0], [255, 255, 255]]  # and no diagonal
    for style, seen in (("wireframe", [1, 0]), ("points", [0, 0])):
        pl = plotter()
        pl.add_mesh(mesh, style=style, line_width=4, point_size=4)
        facing(pl)
        assert alpha(pl, (40, 20), (20, 20)) == pytest.approx(seen, abs=0.01)


def test_shading(plotter):
    """Flat faces have one normal, smooth ones those of their points."""
    for smooth, several in ((False, False), (True, True)):
        pl = plotter()
        pl.add_mesh(pv.Sphere(theta_resolution=6, phi_resolution=6), smooth_shading=smooth)
        normals = pl.raio.scene().render(size=SIZE, aa=1, channels=["normal"])["normal"].reshape(-1, 3)
        found = np.unique(np.round(normals[np.isfinite(normals).all(axis=1)], 3), axis=0)
        assert (len(found) > 50) == several


def test_sides(plotter):
    mesh = plane(i_resolution=1, j_resolution=1)
    for culling, seen in (("back", 1), ("front", 0)):
        pl = plotter()
        pl.add_mesh(mesh, culling=culling)
        facing(pl)
        assert alpha(pl, (40, 30)) == [pytest.approx(seen, abs=1e-3)]
    pl = plotter()
    pl.add_mesh(mesh, color="white", backface_params={"color": "red"})
    facing(pl)
    assert albedo(pl, (9, 9)) == [[255, 255, 255]]
    pl.view_xy(negative=True)
    assert albedo(pl, (40, 30)) == [[255, 0, 0]]


def test_actors(plotter):
    pl = plotter()
    actor = pl.add_mesh(pv.Cube(), color="red")
    actor.user_matrix = np.diag([1, 1, 3, 1])
    actor.position = (0, 0, 5)
    hidden = pl.add_mesh(pv.Sphere(radius=50))
    hidden.visibility = False
    cut = pl.add_mesh(pv.Cube(center=(5, 0, 0)))
    cut.mapper.AddClippingPlane(_half_space())
    low, high = pl.raio.scene().bounds
    assert low == pytest.approx((-0.5, -0.5, -0.5), abs=1e-5)
    assert high == pytest.approx((5, 0.5, 16.5), abs=1e-5)


def _half_space():
    """x below 5."""
    from vtkmodules.vtkCommonDataModel import vtkPlane
    out = vtkPlane()
    out.SetOrigin(5, 0, 0)
    out.SetNormal(-1, 0, 0)
    return out


def test_blocks(plotter):
    pl = plotter()
    _, mapper = pl.add_composite(pv.MultiBlock([plane(i_resolution=1, j_resolution=1), pv.Sphere(radius=9)]),
                                 color="white")
    mapper.block_attr[1].color = "blue"
    mapper.block_attr[2].visible = False
    facing(pl)
    assert albedo(pl, (9, 9)) == [[0, 0, 255]]


def test_lights(plotter):
    pl = plotter(lighting="none")
    pl.add_mesh(plane(i_resolution=1, j_resolution=1), color="white")
    facing(pl)
    assert "integrator" not in pl.raio.scene().render(size=(4, 3)).settings()
    light = pv.Light(position=(0, 0, 9), focal_point=(0, 0, 0), color=(1.0, 0, 0), intensity=0.5)
    pl.add_light(light)
    seen = pl.raio.scene().render(size=(4, 3), aa=1).numpy()[1, 1]
    assert seen[:3] == pytest.approx([0.5, 0, 0], abs=1e-5)
    pl.add_light(pv.Light(light_type="headlight", color=(0, 1.0, 0)))
    pl.view_xy(negative=True)
    seen = pl.raio.scene().render(size=(4, 3), aa=1).numpy()[1, 1]
    assert seen[:3] == pytest.approx([0, 1, 0], abs=1e-5)  # which only the other light shines on
    light.positional, light.cone_angle = True, 30
    with pytest.warns(raio.SceneWarning, match="^left out: cones of lights$"):
        pl.raio.scene()


# --- the whole window


def test_picture(plotter, tmp_path):
    pl = plotter(shape=(1, 2))
    pl.set_background("red")
    pl.subplot(0, 1)
    pl.set_background("black", top="white", all_renderers=False)
    image = pl.raio.render(tmp_path / "a.png", overlay=False, samples=1, dpi=300)
    pixels = np.asarray(image)
    assert pixels.shape == (60, 80, 3)
    assert (pixels[:, :39] == (255, 0, 0)).all()
    assert pixels[0, 60].tolist() == [253] * 3 and pixels[59, 60].tolist() == [2] * 3
    from PIL import Image
    with Image.open(tmp_path / "a.png") as written:
        assert written.info["dpi"] == pytest.approx((300, 300), abs=0.1)
        assert (np.asarray(written) == pixels).all()
    assert pl.raio.render(overlay=False, samples=1, size=(40, 30), background="transparent").mode == "RGBA"


@opengl
def test_overlay(plotter):
    """VTK's lines are in front of Raio's objects, or hidden behind them; the plotter stays as it was."""
    from vtkmodules.vtkCommonTransforms import vtkTransform
    from vtkmodules.vtkRenderingAnnotation import vtkAxesActor
    pl = plotter()
    pl.add_mesh(plane(), scalars=plane().points[:, 0], cmap="gray", show_scalar_bar=False)
    pl.add_text("MMMM", font_size=16, color="blue")
    front, back = vtkAxesActor(), vtkAxesActor()
    for axes, z in ((front, 1), (back, -9)):
        axes.AxisLabelsOff()
        matrix = vtkTransform()
        matrix.Translate(0, 0, z)
        axes.SetUserTransform(matrix)
        axes.SetShaftTypeToCylinder()
        axes.GetXAxisShaftProperty().SetColor(0, 1, 0)
        axes.GetXAxisShaftProperty().LightingOff()
        pl.add_actor(axes)
    facing(pl)
    before = pl.screenshot()
    image = np.asarray(pl.raio.render(samples=1)).astype(int)
    assert (pl.screenshot() == before).all()
    assert (image[:, :, 2] - image[:, :, 0] > 150).any()  # the text
    assert (image[:, :, 1] - image[:, :, 0] > 150).any()  # the axis in front
    plain = np.asarray(pl.raio.render(samples=1, overlay=False)).astype(int)
    assert np.abs(image - plain)[40:].max() <= 1  # below them
    front.SetVisibility(False)
    hidden = np.asarray(pl.raio.render(samples=1)).astype(int)
    assert not (hidden[:, :, 1] - hidden[:, :, 0] > 150).any()
    back.SetVisibility(False)
    only_text = np.asarray(pl.raio.render(samples=1)).astype(int)
    assert np.abs(only_text - plain)[40:].max() <= 1
    large = np.asarray(pl.raio.render(samples=1, size=(240, 180))).astype(int)
    assert large.shape == (180, 240, 3)
    texts = [(i[:, :, 2] - i[:, :, 0] > 150).mean() for i in (image, large)]
    assert texts[1] == pytest.approx(texts[0], rel=0.4)  # it grows with the picture


def test_reports(plotter):
    pl = plotter()
    pl.add_volume(pv.ImageData(dimensions=(3, 3, 3)), scalars=np.arange(27.0), show_scalar_bar=False)
    pl.add_mesh(plane(), lighting=False)
    with pytest.warns(raio.SceneWarning) as told:
        pl.raio.render(samples=1, size=(8, 6))
    assert [str(w.message) for w in told] == ["left out: volumes, surfaces without shading, which are lit"]
    assert told[0].filename == __file__


def test_without_opengl(plotter, monkeypatch):
    monkeypatch.setattr("raio._overlay.has_opengl", lambda window: False)
    pl = plotter()
    pl.add_text("MMMM")
    with pytest.warns(raio.SceneWarning, match="^left out: scalar bars, axes and text, which need OpenGL$"):
        image = pl.raio.render(samples=1)
    assert (np.asarray(image) == 255).all()


def test_refusals(plotter, tmp_path):
    pl = plotter()
    pl.add_mesh(plane())
    with pytest.raises(ValueError, match=r"cannot write '\.exr'.*scene\(\)"):
        pl.raio.render(tmp_path / "a.exr")
    with pytest.raises(ValueError, match="size: expected two whole numbers"):
        pl.raio.render(size="88x66mm")
    with pytest.raises(TypeError, match="crop is not for a window"):
        pl.raio.render(crop=(0, 0, 1, 1))
    with pytest.raises(TypeError, match="unknown option 'sample'"):
        pl.raio.render(sample=1)
    pl.close()
    with pytest.raises(RuntimeError, match="the plotter is closed.*auto_close=False"):
        pl.raio.render()


def test_show(plotter, monkeypatch):
    shown = []
    monkeypatch.setattr(raio.Scene, "view", lambda scene, **options: shown.append(options))
    pl = plotter()
    pl.add_mesh(plane())
    pl.raio.show(samples=9)
    assert shown == [{"size": SIZE, "samples": 9}]
