"""Scenes from arrays: what is shown, borrowed and rebuilt."""

import gc
import pickle
import sys
import weakref

import numpy as np
import pytest
import raio
from conftest import pixels
from raio._color import paint


def same(a, b):
    return np.array_equal(a, b, equal_nan=True)


def test_every_kind_of_primitive_is_drawn():
    tri = [[0, 1, 2]]
    corners = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
    for add in [
        lambda s: s.spheres([[0, 0, 0]], 1),
        lambda s: s.points([[0, 0, 0], [1, 1, 1]]),
        lambda s: s.cylinders([[0, 0, -1]], [[0, 0, 1]], 0.5),
        lambda s: s.cones([[0, 0, -1]], [[0, 0, 1]], 0.5, 0),
        lambda s: s.lines([[0, 0, 0], [0, 0, 1], [0, 1, 1]], 0.1),
        lambda s: s.ellipsoids([[0, 0, 0]], [[[1, 0, 0], [0, 2, 0], [0, 0, 3]]]),
        lambda s: s.discs([[0, 0, 0]], [[1, 1, 1]], 1, 0.5),
        lambda s: s.mesh(corners, tri),
        lambda s: s.mesh(corners, tri, normals=[[0, 0, 1]] * 3),
        lambda s: s.mesh(corners + [[0, -2, 0]], [[0, 3, 1, 2]]),
    ]:
        scene = raio.Scene(background="transparent")
        part = add(scene)
        assert len(part) >= 1 and len(scene) >= len(part)
        alpha = pixels(scene)[..., 3]
        assert 0.005 < alpha.mean() < 0.98


def test_float32_is_borrowed_and_everything_else_is_copied(rng):
    scene = raio.Scene()
    wide = rng.random((20, 7)).astype(np.float32)
    for centers in (wide[:, :3], wide[::2, 2:5], wide[::-1, 1:4], np.ascontiguousarray(wide[:, :3])):
        part = scene.spheres(centers, wide[: len(centers), 6])
        assert np.shares_memory(part.centers, centers)
        assert np.shares_memory(part.radii, wide)
    for centers in (wide[:, :3].astype(float), wide[:, 2::-1], wide[:, :3].astype(">f4"),
                    np.asfortranarray(wide[:, :3]), wide[:, :3].tolist(), np.arange(9).reshape(3, 3)):
        part = scene.spheres(centers, 1)
        assert not isinstance(centers, np.ndarray) or not np.shares_memory(part.centers, centers)
        assert np.array_equal(part.centers, np.asarray(centers, dtype=np.float32))


def test_layouts_give_the_same_picture(rng):
    whole = rng.uniform(-2, 2, (30, 8)).astype(np.float32)
    centers, radii, colors = whole[:, 1:4], abs(whole[:, 4]), abs(whole[:, 5:8])

    def picture(c, r, k):
        scene = raio.Scene()
        scene.spheres(c, r, colors=k)
        return pixels(scene)

    expected = picture(centers.copy(), radii.copy(), colors.copy())
    for change in (lambda a: a, lambda a: a.astype(float), lambda a: a.astype(">f4"), np.asfortranarray,
                   lambda a: a.tolist(), lambda a: a[::-1][::-1]):
        assert same(picture(change(centers), change(radii), change(colors)), expected)


def test_arrays_live_as_long_as_they_are_needed():
    class Array(np.ndarray):
        pass

    centers = np.zeros((1, 3), np.float32).view(Array)
    ends = weakref.ref(centers)
    scene = raio.Scene()
    scene.spheres(centers, 1)
    before = pixels(scene)
    del centers
    gc.collect()
    assert same(pixels(scene), before)
    del scene
    gc.collect()
    assert ends() is None


def test_borrowed_arrays_cannot_be_resized(cloud):
    _, _, centers, _ = cloud
    with pytest.raises(ValueError):
        centers.resize((7, 3))


def test_changes_are_shown_like_a_new_scene(cloud, rng):
    scene, spheres, centers, radii = cloud
    pixels(scene)

    def fresh(**look):
        other = raio.Scene()
        other.spheres(spheres.centers, spheres.radii, **look)
        return pixels(other)

    spheres.centers = rng.uniform(-2, 2, (50, 3))
    assert same(pixels(scene), fresh())
    spheres.radii = 0.3
    assert same(pixels(scene), fresh())
    centers[:] = rng.uniform(-1, 1, (50, 3))
    spheres.centers = centers
    assert same(pixels(scene), fresh())
    centers[:25] += 1
    spheres.changed()
    assert same(pixels(scene), fresh())
    spheres.colors = "navy"
    assert same(pixels(scene), fresh(colors="navy"))
    spheres.colors = rng.random((50, 3)).astype(np.float32)
    assert same(pixels(scene), fresh(colors=spheres.colors))
    spheres.colors[:] = 0.25
    spheres.changed()
    assert same(pixels(scene), fresh(colors=spheres.colors))
    values = rng.random(50)
    spheres.recolor(values, cmap="plasma", vmax=2)
    assert same(pixels(scene), fresh(colors=values, cmap="plasma", vmax=2))
    spheres.colors = values[::-1]
    assert same(pixels(scene), fresh(colors=values[::-1], cmap="plasma", vmax=2))
    with pytest.raises(ValueError, match="are values"):
        spheres.recolor(values)
    spheres.colors = np.full((50, 3), 0.25, np.float32)
    spheres.opacity = 0.5
    assert same(pixels(scene), fresh(colors=spheres.colors, opacity=0.5))
    spheres.opacity = None
    spheres.material = raio.Material(color="red")
    spheres.colors = None
    assert same(pixels(scene), fresh(material=spheres.material))
    spheres.remove()
    assert len(scene) == 0


def test_a_change_that_fails_leaves_the_part_as_it_was(cloud):
    scene, spheres, centers, _ = cloud
    before = pixels(scene)
    for wrong in (np.zeros((49, 3)), np.zeros((50, 2)), "no", None):
        with pytest.raises((ValueError, TypeError)):
            spheres.centers = wrong
    with pytest.raises(ValueError):
        scene.spheres([[0, 0, np.nan]], 1)
    assert np.shares_memory(spheres.centers, centers)
    assert same(pixels(scene), before)


def test_colours_of_all_forms(rng):
    values = np.linspace(0, 1, 50)

    def picture(colors, **look):
        scene = raio.Scene()
        scene.spheres(np.random.default_rng(1).uniform(-3, 3, (50, 3)), 0.5, colors=colors, **look)
        return pixels(scene)

    orange = picture("orange")
    assert same(picture("#ffa500"), orange)
    assert same(picture(tuple(raio.linear(np.array([255, 165, 0], np.uint8)))), orange)
    many = np.tile(np.array([255, 165, 0], np.uint8), (50, 1))
    assert same(picture(many), orange)
    assert same(picture(raio.linear(many)), orange)
    assert same(picture(values, cmap="viridis"), picture(raio.colormap("viridis")[
        np.rint(values.astype(np.float32) * np.float32(255)).astype(int)]))
    assert same(picture(values, cmap="plasma", vmin=0, vmax=1), picture(values, cmap="plasma"))
    half = np.full((50, 4), 0.5, np.float32)
    assert same(picture(half), picture(half[:, :3], opacity=0.5 * np.ones(50)))
    assert same(picture((1, 0, 0), opacity=0.25), picture(np.float32([[1, 0, 0]] * 50), opacity=0.25))
    with pytest.warns(UserWarning, match="1 values are not finite"):
        picture(np.where(values == 0, np.nan, values), cmap="viridis")


def test_meshes_take_colours_of_vertices_and_faces_and_textures():
    corners = np.float32([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0, 1, 0]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])

    def picture(**look):
        scene = raio.Scene(background="black")
        scene.mesh(corners, faces, **look)
        scene.look(direction=(0, 1, 0))
        return pixels(scene, key_light=False)

    red = picture(colors="red")
    assert same(picture(colors=np.float32([[1, 0, 0]] * 2)), red)
    assert np.allclose(picture(colors=np.float32([[1, 0, 0]] * 5)), red, atol=1e-6)
    texture = raio.Material(texture=np.full((2, 2, 3), (255, 0, 0), np.uint8))
    uv = np.float32([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    assert np.allclose(picture(material=texture, uv=uv), red, atol=1e-6)
    assert not same(picture(colors=np.float32([[1, 0, 0], [0, 0, 1]])), red)
    scene = raio.Scene(background="black")
    quad = scene.mesh(corners, [[0, 1, 2, 3]], colors=np.float32([[1, 0, 0]]))
    scene.look(direction=(0, 1, 0))
    assert len(quad) == 1 and same(pixels(scene, key_light=False), red)
    quad.recolor([0.5], cmap="viridis")
    with pytest.raises(ValueError):
        quad.recolor([0.5, 1], cmap="viridis")
    quad.vertices = corners + 1
    quad.opacity = [0.5]
    assert not same(pixels(scene, key_light=False), red)
    assert picture(colors="red", opacity=0.5)[15, 20, 0] < red[15, 20, 0]


def test_instances_equal_copies():
    ball = raio.Scene()
    ball.spheres([[0, 0, 0], [0, 0, 1]], 0.5, colors="teal")
    moved = np.tile(np.eye(4), (3, 1, 1))
    moved[:, 0, 3] = (0, 2, 4)
    many, plain = raio.Scene(), raio.Scene()
    many.instances(ball, moved)
    plain.spheres([[x, 0, z] for x in (0, 2, 4) for z in (0, 1)], 0.5, colors="teal")
    assert len(many) == len(plain) == 6
    assert np.abs(pixels(many) - pixels(plain)).max() < 1e-3
    parts = many._parts[0]
    before = pixels(many)
    parts.transforms = moved[:, :3]
    assert same(pixels(many), before)
    with pytest.raises(ValueError, match="those of their object"):
        parts.colors = "red"
    with pytest.raises(ValueError, match="cannot contain itself"):
        many.instances(many, moved)


def test_the_camera_is_the_one_given(cloud):
    scene, *_ = cloud
    scene.camera(from_=(0, -20, 0), at=(0, 0, 0), fov=30)
    placed = pixels(scene)
    assert same(placed, pixels(scene, from_=(0, -20, 0), at=(0, 0, 0), up=(0, 0, 1), fov=30))
    scene.look(direction=(0, 1, 0))
    fitted = pixels(scene)
    assert not same(fitted, placed)
    for direction in ((0, 0, -1), (0, 0, 1), (0, -1, 0)):
        scene.look(direction=direction, up=direction)
        assert 0.1 < (pixels(scene)[..., :3] < 1).mean() < 0.9
    scene.look(direction=(0, 1, 0), margin=0.2)
    assert (pixels(scene)[0] == 1).all()  # nothing at the edges
    scene.camera(from_=(0, -20, 0), at=(0, 0, 0), aperture=2, focus=20)
    assert not same(pixels(scene), placed)


def test_lights_make_a_classic_scene(cloud):
    scene, *_ = cloud
    ambient = pixels(scene)
    scene.light(direction=(0, 1, -1))
    lit = pixels(scene)
    assert not same(lit, ambient)
    assert same(lit, pixels(scene, integrator="classic", background="white", tone="srgb"))
    scene.light(position=(0, -5, 9), color="white", size=2)
    assert not same(pixels(scene, soft_shadows=True), pixels(scene))


def test_rays(cloud, rng):
    scene, spheres, centers, radii = cloud
    origins = rng.uniform(-5, 5, (500, 3))
    towards = rng.normal(size=(500, 3))
    hits = scene.intersect(origins, towards)
    unit = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    # All spheres, one by one, in double precision.
    along = (origins[:, None] - centers) @ unit[..., None]
    square = ((origins[:, None] - centers) ** 2).sum(-1) - radii**2
    under = along[..., 0] ** 2 - square
    root = np.sqrt(np.maximum(under, 0))
    near, far = -along[..., 0] - root, -along[..., 0] + root
    t = np.where(under < 0, np.inf, np.where(near > 0, near, np.where(far > 0, far, np.inf)))
    found = np.isfinite(t.min(1))
    assert np.array_equal(np.isfinite(hits.distance), found)
    assert np.array_equal(hits.id, np.where(found, t.argmin(1), -1))
    assert np.allclose(hits.distance[found], t.min(1)[found], rtol=1e-3, atol=1e-3)
    assert set(hits.kind[found]) == {raio.KINDS.index("sphere")}
    assert np.allclose(hits.position[found], (origins + unit * hits.distance[:, None])[found], atol=1e-3)
    assert np.isnan(hits.position[~found]).all()
    assert np.array_equal(scene.occluded(origins, towards), found)
    short = scene.intersect(origins, towards, 0.5)
    assert np.array_equal(np.isfinite(short.distance), found & (t.min(1) < 0.5))


def test_hits_name_rows_of_parts(program):
    with_triangles = raio.load(program.parents[2] / "scenes/knot.obj")
    with_spheres = raio.load(program.parents[2] / "scenes/fullerene.xyz", style="ball-and-stick")
    for scene in (raio.Scene(), with_triangles, with_spheres):
        (_, _, _), (x, y, z) = scene.bounds or ((0, 0, 0), (0, 0, 0))

        def at(k):  # places beside each other, outside of the file's primitives
            return np.float32([[x + 10 * k, y + 9, z + 9], [x + 10 * k, y + 12, z + 9]])  # noqa: B023

        def quads(k):
            corners = np.concatenate([p + [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]] for p in at(k)])
            return corners, np.arange(8).reshape(2, 4)

        ball = raio.Scene()
        ball.spheres([[0, 0, 0], [0, 0, 9]], 1)
        moved = np.tile(np.eye(4), (2, 1, 1))
        moved[:, :3, 3] = at(8)
        parts = [scene.spheres(at(1), 1), scene.mesh(*quads(2), colors=np.eye(8)[:, :3]),
                 scene.mesh(*quads(3)), scene.mesh(*quads(4), colors=np.eye(8)[:, 3:6]),
                 scene.discs(at(5), [[0, 0, 1]] * 2, 1), scene.spheres(np.zeros((0, 3)), 1),
                 scene.cylinders(at(6), at(6) + np.float32([0, 1, 0]), 0.5), scene.mesh(*quads(7)),
                 scene.instances(ball, moved), scene.spheres(at(9), 1)]
        targets = np.concatenate([at(k) + [0, 0.4, 0] for k in range(1, 10)])
        hits = scene.intersect(targets + [0, 0, 1e3], np.tile([0, 0, -1], (18, 1)))
        assert (hits.id >= 0).all()
        columns = [p for p in parts if len(p)]
        for part in parts:
            expected = np.full(18, -1)
            if len(part):
                expected[2 * columns.index(part):][:2] = (0, 1)
            assert hits.rows(part).tolist() == expected.tolist()
        assert scene.parts == tuple(parts)
        parts[0].remove()
        assert hits.rows(parts[0])[1] == 1  # as they were traced
        with pytest.raises(ValueError, match="was not in the scene"):
            scene.intersect(targets, targets).rows(parts[0])
        later = scene.intersect(targets + [0, 0, 1e3], np.tile([0, 0, -1], (18, 1)))
        assert later.rows(parts[-1])[-2:].tolist() == [0, 1]


def test_the_range_of_a_map_stays_until_another_is_given(cloud):
    _, part, *_ = cloud

    def shown():
        return paint(part.colors, len(part), *part._map).each

    viridis = raio.colormap("viridis")
    values = np.linspace(0, 10, 50)
    assert part.clim is None
    part.recolor(np.ones(50), cmap="viridis")
    assert part.clim is None and same(shown(), viridis[[128] * 50])
    part.colors = values
    assert part.clim == (0, 10)
    part.colors = values / 2 + 10
    assert part.clim == (0, 10) and same(shown(), viridis[[255] * 50])
    part.colors[:] = 0
    assert same(shown(), viridis[[0] * 50])
    part.clim = (-5, 0)
    assert same(shown(), viridis[[255] * 50])
    part.recolor(values, cmap="viridis", vmin=-10)
    assert part.clim == (-10, 10)
    for wrong in ({"vmin": 11}, {"vmax": -1}, {"vmin": 3, "vmax": 3}):
        with pytest.raises(ValueError, match="vmin must be below vmax"):
            part.recolor(values, cmap="viridis", **wrong)
    assert part.clim == (-10, 10)
    part.colors = "red"
    assert part.clim is None
    with pytest.raises(ValueError, match="give cmap"):
        part.clim = (0, 1)


def test_lines_are_coloured_by_points(rng):
    path = np.float32([[0, 0, 0], [0, 0, 0], [2, 0, 0], [2, 0, 2]])
    values = np.array([0, 1, 3, 5])

    def picture(add):
        scene = raio.Scene()
        add(scene)
        scene.look(direction=(0, 1, 0))
        return pixels(scene)

    def by_hand(joints, segments, cmap=None, vmax=None):
        def add(scene):
            scene.spheres(path, 0.2, colors=joints, cmap=cmap, vmin=cmap and 0, vmax=vmax)
            scene.cylinders(path[1:-1], path[2:], 0.2, colors=segments, cmap=cmap, vmin=cmap and 0, vmax=vmax)
        return picture(add)

    def lines(**look):
        return picture(lambda scene: scene.lines(path, 0.2, **look))

    assert same(lines(colors="red"), by_hand("red", "red"))
    assert same(lines(colors=values, cmap="viridis"), by_hand(values, [2, 4], "viridis", 5))
    colors = rng.random((4, 3)).astype(np.float32)
    assert same(lines(colors=colors), by_hand(colors, (colors[1:-1] + colors[2:]) / np.float32(2)))
    scene = raio.Scene()
    part = scene.lines(path, [0.1, 0.1, 0.2, 0.3])
    hits = scene.intersect([[1, 5, 0], [2, 5, 1], [2, 5, 2.2], [0, 5, 9]], [[0, -1, 0]] * 4)
    assert hits.rows(part).tolist() == [1, 2, 3, -1]
    assert hits.position[0, 1] < hits.position[1, 1]  # it widens
    part.points = path[::-1]
    assert scene.intersect([[1, 5, 0]], [[0, -1, 0]]).rows(part).tolist() == [1]


def test_pickles_are_the_same_scene(cloud, program):
    scene, spheres, *_ = cloud
    scene.cylinders([[0, 0, 0]], [[1, 1, 1]], 0.1, colors="red")
    scene.light(direction=(1, 1, -1))
    scene.camera((0, -20, 3), (0, 0, 0))
    copy = pickle.loads(pickle.dumps(scene))
    assert same(pixels(copy), pixels(scene))
    from_file = raio.load(program.parents[2] / "scenes/shapes.nff")
    assert same(pixels(pickle.loads(pickle.dumps(from_file))), pixels(from_file))
    image = scene.render(size=(8, 8), channels=["depth"])
    assert same(pickle.loads(pickle.dumps(image))["depth"], image["depth"])


def test_saved_scenes_look_the_same(cloud, tmp_path):
    scene, *_ = cloud
    scene.save(tmp_path / "a.raio")
    loaded = raio.load(tmp_path / "a.raio")
    scene.background = "black"
    with pytest.warns(raio.SceneWarning, match="background is not stored"):
        scene.save(tmp_path / "b.raio")
    scene.background = None
    assert same(pixels(loaded), pixels(scene))


def test_files_can_be_extended_with_arrays(program):
    with pytest.warns(raio.SceneWarning, match="images of atoms"):
        scene = raio.load(program.parents[2] / "scenes/quartz.cif", style="ball-and-stick")
    before, count = pixels(scene), len(scene)
    scene.spheres([[0, 0, 0]], 3, colors="red")
    assert len(scene) == count + 1
    assert not same(pixels(scene), before)


def test_errors_of_files_tell_where(tmp_path):
    (tmp_path / "a.nff").write_text("v\nfrom 1 2\n")
    with pytest.raises(raio.SceneError) as caught:
        raio.load(tmp_path / "a.nff")
    assert caught.value.line == 2 and caught.value.file.endswith("a.nff") and caught.value.column > 0
    assert pickle.loads(pickle.dumps(caught.value)).line == 2
    with pytest.raises(FileNotFoundError, match="missing.nff"):
        raio.render(tmp_path / "missing.nff")
    with pytest.raises(TypeError, match="option of render"):
        raio.load(tmp_path / "a.nff", samples=3)


def test_import_is_quick_and_needs_no_numpy():
    import subprocess

    code = "import sys, raio; assert 'numpy' not in sys.modules; raio.__version__; dir(raio)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_empty_scene_is_a_picture_of_nothing():
    scene = raio.Scene(background="transparent")
    assert scene.bounds is None and len(scene) == 0
    scene.spheres(np.zeros((0, 3)), np.zeros(0))
    assert (pixels(scene) == 0).all()
    assert scene.intersect(np.zeros((0, 3)), np.zeros((0, 3))).distance.shape == (0,)
