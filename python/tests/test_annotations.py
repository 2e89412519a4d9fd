"""Colour bars, legends and scale bars on pictures."""

import pickle

import numpy as np
import pytest
import raio
from raio import _raio

SIZE = {"size": (160, 120), "samples": 1}


@pytest.fixture
def scene():
    scene = raio.Scene()
    scene.spheres([[0, 0, 0], [0, 0, 1]], 0.1, colors=[0, 1], cmap="viridis")
    scene.look(direction=(0, 1, 0), margin=0.4)
    return scene


def drawn(scene, **options):
    """Where the annotations changed the picture."""
    plain, marked = (scene.render(**SIZE, **o).display().astype(int) for o in ({}, options))
    return abs(plain - marked).max(axis=2) > 8


def test_each_is_drawn_in_its_place(scene):
    left, right, top, bottom = np.s_[:, :53], np.s_[:, 107:], np.s_[:40], np.s_[80:]
    for options, inside, outside in [
        ({"color_bar": True}, right, left),
        ({"color_bar": True, "color_bar_side": "left"}, left, right),
        ({"legend": {"one": "navy"}}, top, bottom),
        ({"legend": {"one": "navy"}}, left, right),
        ({"legend": {"one": "navy"}, "color_bar_side": "left"}, right, left),
        ({"scale_bar": True}, bottom, top),
        ({"scale_bar": "nm"}, left, right),
    ]:
        where = drawn(scene, **options)
        assert where[inside].any() and not where[outside].any(), options
    assert not drawn(scene, color_bar=False, legend=None, scale_bar=False, color_bar_side="left").any()
    assert (drawn(scene, color_bar="speed") ^ drawn(scene, color_bar=True)).sum() > 20
    assert (drawn(scene, scale_bar="nm") ^ drawn(scene, scale_bar=True)).sum() > 10


def test_the_bar_has_the_colours_of_the_map(scene):
    twilight = pytest.importorskip("matplotlib").colormaps["twilight"]
    for cmap in ("plasma", "twilight", twilight):
        scene.parts[0].recolor([0, 1], cmap=cmap)
        shown = scene.render(**SIZE, color_bar=True).display()[..., :3].astype(int)
        for i in (60, 128, 200):
            light = raio.colormap(cmap)[i]
            close = abs(raio.linear(shown.astype(np.uint8)) - light).max(axis=2) < 0.03
            assert close[:, 107:].any(), (cmap, i)


def test_films_and_copies_keep_them(scene):
    options = {"color_bar": "x", "legend": {"one": "navy"}, "scale_bar": "nm"}
    image = scene.render(size=(160, 120), samples=4, **options)
    film = scene.start(size=(160, 120), **options).add(1).add(3)
    assert film._repr_png_() == film.image()._repr_png_()
    assert np.array_equal(film.image().display(), image.display())
    assert np.array_equal(pickle.loads(pickle.dumps(film)).image().display(), image.display())
    assert pickle.loads(pickle.dumps(image))._repr_png_() == image._repr_png_()
    assert np.array_equal(image.numpy(), scene.render(size=(160, 120), samples=4).numpy())


def test_instances_and_equal_scales_share_a_bar(scene):
    many = raio.Scene()
    many.instances(scene, np.eye(4)[None])
    other = many.spheres([[3, 0, 0]], 1, colors=[0.5], cmap="viridis", vmin=0, vmax=1)
    many.render(**SIZE, color_bar=True)
    other.clim = (0, 2)
    with pytest.raises(ValueError, match=r"color_bar: .*differ \(0 to 1, 0 to 2\)"):
        many.render(**SIZE, color_bar=True)


@pytest.mark.parametrize("options, error", [
    ({"legend": True}, "legend: the colours have no names"),
    ({"legend": {"one": "no colour"}}, r"legend\['one'\]: expected"),
    ({"color_bar_side": "top", "color_bar": True}, "color_bar_side: expected left or right"),
    ({"legend": {"one": "red"}, "size": (20, 15)}, "no room for a legend"),
    ({"color_bar": True, "integrator": "views"}, "a view has its own colours"),
])
def test_what_cannot_be_drawn_is_refused(scene, options, error):
    with pytest.raises(ValueError, match=error):
        scene.render(**{**SIZE, **options})


def test_views_have_none(scene):
    with pytest.raises(TypeError, match="color_bar is for render"):
        scene.view(color_bar=True)


def test_a_bar_needs_values():
    scene = raio.Scene()
    scene.spheres([[0, 0, 0]], 1, colors="red")
    with pytest.raises(ValueError, match="color_bar: nothing is coloured by values"):
        scene.render(**SIZE, color_bar=True)


def test_without_cairo_the_work_does_not_begin(scene, monkeypatch):
    monkeypatch.setattr(_raio, "drawing_problem", lambda: "cannot load a library")
    told = []
    with pytest.raises(RuntimeError, match="^color_bar, scale_bar: cannot load a library"):
        scene.render(size=(4000, 3000), color_bar=True, scale_bar=True,
                     progress=lambda *what: told.append(what))
    assert not told
    with pytest.raises(RuntimeError, match="^legend: "):
        scene.start(legend={"one": "red"})
    scene.render(**SIZE)
