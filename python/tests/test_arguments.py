"""Wrong and unusual arguments: each is right, or an error that names the argument."""

import numpy as np
import pytest
import raio

N = 5
NAN, INF = float("nan"), float("inf")
centers = np.arange(15, dtype=np.float32).reshape(5, 3)
read_only = centers.copy()
read_only.flags.writeable = False
masked = np.ma.array(centers, mask=centers > 13)
structured = np.zeros(5, dtype=[("p", np.float32, 3), ("r", np.float32)])
odd = np.frombuffer(bytes(61), np.uint8)[1:].view(np.float32).reshape(5, 3)


def row(index, column, value):
    changed = centers.copy()
    changed[index, column] = value
    return changed


# An argument of spheres(), its value, and the error; None: it is right.
SPHERES = [
    ("centers", centers, None),
    ("centers", centers.astype(float), None),
    ("centers", centers.astype(np.float16), None),
    ("centers", centers.astype(">f4"), None),
    ("centers", centers.astype(">f8"), None),
    ("centers", centers.astype(np.int64), None),
    ("centers", centers.astype(np.uint8), None),
    ("centers", centers.astype(np.longdouble), None),
    ("centers", centers > 3, None),
    ("centers", centers.tolist(), None),
    ("centers", tuple(map(tuple, centers)), None),
    ("centers", np.asfortranarray(centers), None),
    ("centers", centers[::-1], None),
    ("centers", np.repeat(centers, 2, axis=0)[::2], None),
    ("centers", np.hstack([centers, centers])[:, 1:4], None),
    ("centers", centers[:, ::-1], None),
    ("centers", np.broadcast_to(np.float32([1, 2, 3]), (5, 3)), None),
    ("centers", read_only, None),
    ("centers", structured["p"], None),
    ("centers", odd, None),
    ("centers", np.ma.array(centers), None),
    ("centers", row(2, 1, -0.0), None),
    ("centers", row(2, 1, 1e-40), None),
    ("centers", np.zeros((0, 3)), r"radii|colors|opacity|ok"),
    ("centers", centers[:, :2], r"centers: expected the shape \(N, 3\), found \(5, 2\)"),
    ("centers", centers.ravel(), r"centers: expected the shape \(N, 3\), found \(15,\)"),
    ("centers", centers[None], r"centers: expected the shape \(N, 3\), found \(1, 5, 3\)"),
    ("centers", 3.0, r"centers: expected the shape \(N, 3\), found \(\)"),
    ("centers", centers * 1j, r"centers: expected real numbers, found an array of complex"),
    ("centers", centers.astype(str), r"centers: expected real numbers"),
    ("centers", [["a", "b", "c"]], r"centers: expected real numbers"),
    ("centers", None, r"centers: expected real numbers, found an array of object"),
    ("centers", [[1, 2, 3], [1, 2]], r"centers|inhomogeneous"),
    ("centers", masked, r"centers: some values are masked"),
    ("centers", row(2, 1, NAN), r"sphere 2: the centre must be finite"),
    ("centers", row(4, 0, INF), r"sphere 4: the centre must be finite"),
    ("centers", np.where(centers == 4, 1e39, centers.astype(float)), r"sphere 1: the centre must be finite"),
    ("centers", "centers", r"centers: expected real numbers"),
    ("radii", 0.5, None),
    ("radii", np.float64(0.5), None),
    ("radii", np.array(0.5), None),
    ("radii", 1, None),
    ("radii", np.ones(5), None),
    ("radii", np.ones(5, np.float32)[::-1], None),
    ("radii", np.ones(10, np.float32)[::2], None),
    ("radii", structured["r"] + np.float32(1), None),
    ("radii", [1, 2, 3, 4, 5], None),
    ("radii", 0, r"sphere 0: the radius must be finite and not zero"),
    ("radii", np.ones(4), r"radii: expected the shape \(5,\), found \(4,\)"),
    ("radii", np.ones((5, 1)), r"radii: expected the shape \(5,\), found \(5, 1\)"),
    ("radii", np.ones(0), r"radii: expected the shape \(5,\), found \(0,\)"),
    ("radii", -1, r"sphere 0: a radius is negative"),
    ("radii", [1, 1, -1e-9, 1, 1], r"sphere 2: a radius is negative"),
    ("radii", NAN, r"sphere 0: the radius must be finite"),
    ("radii", INF, r"sphere 0: the radius must be finite"),
    ("radii", "big", r"radii: expected real numbers"),
    ("radii", None, r"radii: expected real numbers"),
    ("colors", None, None),
    ("colors", "red", None),
    ("colors", "#f80", None),
    ("colors", (0.1, 0.2, 0.3), None),
    ("colors", np.ones((5, 3)), None),
    ("colors", np.ones((5, 4), np.float32), None),
    ("colors", np.full((5, 3), 200, np.uint8), None),
    ("colors", np.full((5, 4), 200, np.uint8), None),
    ("colors", np.ones((5, 3), np.float32)[:, ::-1], None),
    ("colors", (9.0, 9.0, 9.0), None),
    ("colors", "reddish", r"colors: expected .*reddish"),
    ("colors", "transparent", r"colors: expected"),
    ("colors", np.ones(5), r"colors: \(5,\) are values; give a colour map"),
    ("colors", np.ones((4, 3)), r"colors: expected the shape .*found \(4, 3\)"),
    ("colors", np.ones((5, 2)), r"colors: expected the shape .*found \(5, 2\)"),
    ("colors", np.full((5, 3), 200), r"colors: integers of int64"),
    ("colors", ["red"] * 5, r"colors: a list of names"),
    ("colors", (255, 0, 0), r"colors: integers of int64"),
    ("colors", np.array([255, 0, 0], np.uint8), None),
    ("colors", (-1, 0, 0), r"colors: .*not negative"),
    ("colors", (NAN, 0, 0), r"colors: .*finite"),
    ("colors", row(3, 1, NAN), r"colour 3 must be finite"),
    ("colors", np.full((5, 3), -0.1), r"colour 0 must be finite and not negative"),
    ("opacity", None, None),
    ("opacity", 0.5, None),
    ("opacity", 0, None),
    ("opacity", np.linspace(0, 1, 5), None),
    ("opacity", 1.5, r"opacity: expected a number from 0 to 1"),
    ("opacity", NAN, r"opacity: expected a number from 0 to 1"),
    ("opacity", np.ones(4), r"opacity: expected the shape \(5,\), found \(4,\)"),
    ("opacity", [0, 0, 2, 0, 0], r"opacity 2 is 2, expected 0 to 1"),
    ("cmap", "viridis", r"cmap colours values"),
    ("vmin", 3, r"vmin and vmax"),
]


@pytest.mark.parametrize("name, value, error", SPHERES)
def test_spheres(name, value, error):
    arguments = {"centers": centers, "radii": 1, name: value}
    if isinstance(value, np.ndarray) and value.shape == (0, 3):
        error = None
    scene = raio.Scene()
    if error is None:
        with np.errstate(all="ignore"):
            part = scene.spheres(**arguments)
        expected = np.asarray(arguments["centers"], dtype=np.float32).reshape(-1, 3)
        assert np.array_equal(part.centers, expected)
        scene.render(size=(8, 6), samples=1)
    else:
        with pytest.raises((ValueError, TypeError), match=error):
            scene.spheres(**arguments)
        assert len(scene) == 0


CALLS = [
    (lambda s: s.cylinders(centers, centers[:4], 1), r"starts and ends.*\(5, 3\) and \(4, 3\)"),
    (lambda s: s.cylinders(centers, centers, 1), r"cone 0: base and apex are the same point"),
    (lambda s: s.cylinders(centers, centers + 1, 1), None),
    (lambda s: s.cones(centers, centers + 1, 1, np.ones(3)), r"end_radii: .*\(5,\), found \(3,\)"),
    (lambda s: s.cones(centers, centers + 1, 1, -1), r"cone 0: a radius is negative"),
    (lambda s: s.ellipsoids(centers, np.ones((5, 3))), r"axes: expected the shape \(5, 9\)"),
    (lambda s: s.ellipsoids(centers, np.ones((5, 3, 3))), r"ellipsoid 0: "),
    (lambda s: s.discs(centers, np.zeros((5, 3)), 1), r"the normal of disc 0 is zero"),
    (lambda s: s.discs(centers, centers, 1), None),
    (lambda s: s.discs(centers, centers + 1, 1, 2), r"disc 0: "),
    (lambda s: s.mesh(centers, [[0, 1, 5]]), r"faces\[0\] is \[0, 1, 5\], expected indices from 0 to 4"),
    (lambda s: s.mesh(centers, [[0, 1, 2], [0, -1, 2]]), r"faces\[1\] is"),
    (lambda s: s.mesh(centers, [[0.0, 1, 2]]), r"faces: expected integers"),
    (lambda s: s.mesh(centers, [0, 1, 2]), r"faces: expected the shape"),
    (lambda s: s.mesh(centers, np.array([[0, 1, 2**40]])), r"faces\[0\]"),
    (lambda s: s.mesh(centers, np.array([[0, 1, 2]], ">i8")), None),
    (lambda s: s.mesh(centers, np.array([[0, 1, 2]], np.uint8)), None),
    (lambda s: s.mesh(centers, np.zeros((0, 3), int)), None),
    (lambda s: s.mesh(centers, [[0, 1, 2]], normals=np.zeros((4, 3))), r"normals: .*\(5, 3\), found"),
    (lambda s: s.mesh(centers, [[0, 1, 2]], normals=np.zeros((5, 3))), r"normal of vertex 0 is zero"),
    (lambda s: s.mesh(centers, [[0, 1, 2]], uv=np.zeros((5, 3))), r"uv: .*\(5, 2\), found"),
    (lambda s: s.mesh(row(0, 0, NAN), [[0, 1, 2]]), r"position 0 is not finite"),
    (lambda s: s.lines(centers[:1], 1), r"points: expected at least two"),
    (lambda s: s.lines(centers[[0, 0, 1]], 1), None),
    (lambda s: s.instances(raio.Scene(), np.eye(4)), r"transforms: "),
    (lambda s: s.instances(raio.Scene(), np.zeros((2, 4, 4))), r"transforms: the last rows"),
    (lambda s: s.light(), r"give position or direction"),
    (lambda s: s.light(direction=(0, 0, 0)), r"direction: "),
    (lambda s: s.light(position=(0, NAN, 0)), r"position: expected three finite numbers"),
    (lambda s: s.camera((0, 0, 0), (0, 0, 0)), r"same point"),
    (lambda s: s.camera((0, 0, 1), (0, 0, 0), fov=400), r"fov: expected"),
    (lambda s: s.camera((0, 0, 1), (0, 0, 0), focus=1), r"focus"),
    (lambda s: s.look(up=(0, 0, 0)), r"zero"),
    (lambda s: s.look(margin=0.5), r"margin"),
    (lambda s: s.render(samples=0.5), r"samples: expected a whole number"),
    (lambda s: s.render(size=(0, 5)), r"size: expected"),
    (lambda s: s.render(size=object()), r"size: expected"),
    (lambda s: s.render(sizes=3), r"did you mean size"),
    (lambda s: s.render(style="sticks"), r"reading a file"),
    (lambda s: s.render(integrator="pathological"), r"integrator: expected"),
    (lambda s: s.render(background=(1, 2)), r"background: expected"),
    (lambda s: s.render(light_size=-1), r"^light_size: expected"),
    (lambda s: s.render(from_=(1, 2)), r"^from_: expected"),
    (lambda s: s.render(aa=2, samples=3), r"aa|samples"),
    (lambda s: s.intersect(centers, centers[:4]), r"directions: .*\(5, 3\), found \(4, 3\)"),
    (lambda s: s.intersect(centers, centers * 0), r"ray 0: the direction is zero"),
    (lambda s: s.intersect(row(3, 0, NAN), centers + 1), r"ray 3: a number is not finite"),
    (lambda s: s.start(seed="many"), r"seed: expected"),
    (lambda s: raio.Scene(background="nothing"), None),
    (lambda s: raio.colormap("virdis"), r"cmap: expected viridis, .*'virdis'; did you mean viridis\?"),
]


@pytest.mark.parametrize("call, error", CALLS)
def test_calls(call, error):
    scene = raio.Scene()
    if error is None:
        call(scene)
        scene.render(size=(8, 6), samples=1)
    else:
        with pytest.raises((ValueError, TypeError), match=error):
            call(scene)
        assert len(scene) == 0


def test_too_many_rows_are_refused():
    many = np.broadcast_to(np.float32([0, 0, 0]), (2**31, 3))
    with pytest.raises(ValueError, match="centers: expected at most 2147483647 rows, found 2147483648"):
        raio.Scene().spheres(many, 1)


def test_coordinates_that_single_precision_cannot_tell_apart_are_reported():
    scene = raio.Scene()
    scene.spheres(centers + 1e6, 1)
    with pytest.warns(UserWarning, match="single precision keeps steps of 0.0625"):
        scene.render(size=(8, 6), samples=1)
    for unit in (1e20, 1e-30):
        scene = raio.Scene()
        scene.spheres(centers * unit, unit)
        with pytest.raises(ValueError, match="use other units"):
            scene.render(size=(8, 6), samples=1)


def test_misspelt_attributes_are_refused():
    scene = raio.Scene()
    part = scene.spheres(centers, 1)
    for of, name, near in ((part, "centres", "centers"), (part, "color", "colors"), (scene, "backgroud", "background")):
        with pytest.raises(AttributeError, match=f"did you mean {near}"):
            setattr(of, name, 1)
    with pytest.raises(TypeError, match="expected a raio.Material"):
        part.material = "red"
    with pytest.raises(TypeError, match="expected a raio.Material"):
        scene.spheres(centers, 1, material="red")
    with pytest.raises(TypeError, match="list of names"):
        scene.spheres(centers[:3], 1, colors=["red", "green", "blue"])
    part.remove()
    with pytest.raises(ValueError, match="no longer in the scene"):
        part.remove()


def test_classic_pictures_without_lights_are_reported():
    scene = raio.Scene()
    scene.spheres(centers, 1)
    with pytest.warns(UserWarning, match="no lights"):
        scene.render(size=(8, 6), integrator="classic")


def test_messages_name_keywords_and_leave_files_alone():
    from raio._options import with_keywords

    assert with_keywords("soft-shadows.") == "soft_shadows."
    for text in ("a/soft-shadows/b", "soft-shadows.nff", "not-soft-shadows", "light from above"):
        assert with_keywords(text) == text
