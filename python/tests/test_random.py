"""Random arguments: a picture, or an error; nothing else.

RAIO_EXAMPLES sets how many, and makes them different in each run.
"""

import os
import warnings

import numpy as np
import raio
from hypothesis import HealthCheck, given, settings, strategies as st
from hypothesis.extra import numpy as hnp

EXAMPLES = settings(max_examples=int(os.environ.get("RAIO_EXAMPLES", "150")),
                    derandomize="RAIO_EXAMPLES" not in os.environ, deadline=None,
                    suppress_health_check=list(HealthCheck))
DTYPES = st.sampled_from(["f4", "f8", ">f4", ">f8", "f2", "i4", "i8", "u1", "u4", "?", "c8", "U3", "O"])
SHAPES = st.one_of(st.tuples(), hnp.array_shapes(max_dims=3, max_side=6),
                   st.tuples(st.integers(0, 6), st.sampled_from([1, 2, 3, 4, 9, 12])))


@st.composite
def arrays(draw):
    """An array in any layout, or a number."""
    array = draw(DTYPES.flatmap(lambda dtype: hnp.arrays(dtype, SHAPES)))
    layout = draw(st.sampled_from(["as it is", "fortran", "reversed", "every second", "read-only", "list"]))
    if layout == "fortran":
        array = np.asfortranarray(array)
    elif layout == "reversed" and array.ndim:
        array = array[::-1]
    elif layout == "every second" and array.ndim:
        array = array[::2]
    elif layout == "read-only":
        array.flags.writeable = False
    elif layout == "list":
        array = array.tolist()
    return array


@st.composite
def fitting(draw, count, width):
    """An array of the right shape, mostly."""
    if draw(st.integers(0, 9)) == 0:
        return draw(arrays())
    dtype = draw(st.sampled_from(["f4", "f8", ">f4", "i4"]))
    values = st.integers(-9, 9) if dtype == "i4" else st.one_of(
        st.floats(-100, 100, width=32), st.floats(width=32))
    return draw(hnp.arrays(dtype, (count,) if width is None else (count, width), elements=values))


def attempt(add):
    scene = raio.Scene(background="transparent")
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            add(scene)
            picture = scene.render(size=(6, 4), samples=1).numpy()
        except (ValueError, TypeError) as error:
            assert str(error)
            return
    assert picture.shape == (4, 6, 4) and not np.isnan(picture).any()


@EXAMPLES
@given(st.data())
def test_spheres(data):
    n = data.draw(st.integers(0, 5))
    attempt(lambda s: s.spheres(
        data.draw(fitting(n, 3)), data.draw(st.one_of(fitting(n, None), st.floats(), arrays())),
        colors=data.draw(st.one_of(st.none(), fitting(n, 3), fitting(n, 4), arrays())),
        opacity=data.draw(st.one_of(st.none(), st.floats(), fitting(n, None)))))


@EXAMPLES
@given(st.data())
def test_cones_discs_ellipsoids(data):
    n = data.draw(st.integers(0, 4))
    attempt(lambda s: s.cones(data.draw(fitting(n, 3)), data.draw(fitting(n, 3)),
                              data.draw(fitting(n, None)), data.draw(st.floats(0, 2))))
    attempt(lambda s: s.discs(data.draw(fitting(n, 3)), data.draw(fitting(n, 3)),
                              data.draw(fitting(n, None)), data.draw(st.floats(0, 2))))
    attempt(lambda s: s.ellipsoids(data.draw(fitting(n, 3)), data.draw(fitting(n, 9))))


@EXAMPLES
@given(st.data())
def test_meshes(data):
    n = data.draw(st.integers(0, 6))
    faces = st.one_of(hnp.arrays("i8", (data.draw(st.integers(0, 4)), data.draw(st.sampled_from([3, 4]))),
                                 elements=st.integers(-1, max(n, 1))), arrays())
    attempt(lambda s: s.mesh(
        data.draw(fitting(n, 3)), data.draw(faces),
        normals=data.draw(st.one_of(st.none(), fitting(n, 3))),
        colors=data.draw(st.one_of(st.none(), fitting(n, 3))),
        uv=data.draw(st.one_of(st.none(), fitting(n, 2))),
        opacity=data.draw(st.one_of(st.none(), st.floats()))))


@EXAMPLES
@given(st.data())
def test_instances_rays_lights(data):
    ball = raio.Scene()
    ball.spheres([[0, 0, 0]], 1)
    n = data.draw(st.integers(0, 4))
    attempt(lambda s: s.instances(ball, data.draw(fitting(n, 12))))

    def trace(scene):
        scene.instances(ball, np.eye(4)[None])
        scene.light(position=data.draw(fitting(3, None)))
        hits = scene.intersect(data.draw(fitting(n, 3)), data.draw(fitting(n, 3)),
                               data.draw(st.one_of(st.none(), st.floats(), fitting(n, None))))
        assert not np.isnan(hits.distance).any()

    attempt(trace)
