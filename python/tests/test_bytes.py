"""The package and the program make the same bytes."""

import subprocess
import warnings

import pytest
import raio
from conftest import ROOT

SCENES = ROOT / "scenes"

# A scene, options as keyword arguments, and the format.
CASES = [
    ("shapes.nff", {}, ".png"),
    ("shapes.nff", {"aa": 2, "soft_shadows": True, "dof": True, "aperture": 0.1}, ".png"),
    ("shapes.nff", {"gloss": 0.2, "samples": 4, "seed": 7}, ".exr"),
    ("shapes.nff", {"integrator": "ambient", "samples": 9}, ".png"),
    ("shapes.nff", {"accel": "grid", "grid_factor": 3}, ".ppm"),
    ("shapes.nff", {"accel": "none", "channels": ["depth", "normal"]}, ".npz"),
    ("shapes.nff", {"shading": "blinn-phong", "fresnel": "schlick"}, ".pfm"),
    ("shapes.nff", {"crop": (5, 5, 30, 20)}, ".png"),
    ("shapes.nff", {"from_": (4, 3, 9), "at": (0, 0, 0), "up": (0, 1, 0), "fov": 30}, ".png"),
    ("shapes.nff", {"fit": "all"}, ".npy"),
    ("shapes.nff", {"samples": 4}, ".raio"),
    ("sphereflake.nff", {"depth": 3}, ".png"),
    ("sphereflake.nff", {"background": "transparent", "samples": 4}, ".png"),
    ("metals.p3f", {"samples": 4}, ".png"),
    ("billiards.p3f", {"samples": 4, "shutter": (0, 0.5)}, ".png"),
    ("lens.p3f", {"samples": 4, "sampler": "sobol"}, ".png"),
    ("fullerene.xyz", {}, ".png"),
    ("fullerene.xyz", {"style": "sticks", "samples": 4}, ".png"),
    ("fullerene.xyz", {"color_by": "index", "colormap": "plasma", "samples": 4}, ".png"),
    ("fullerene.xyz", {"only": "index 0-29", "color_atoms": "index 3: navy", "samples": 4}, ".png"),
    ("droplet.dump", {"radius": 0.4, "samples": 4}, ".png"),
    ("quartz.cif", {"images": (2, 2, 1), "cell": True, "samples": 4}, ".png"),
    ("quartz.cif", {"cell": False, "opacity": 0.5, "samples": 4}, ".exr"),
    ("nanotube.gro", {"samples": 4}, ".png"),
    ("crates.gltf", {"samples": 4}, ".png"),
    ("spiral.ply", {"channels": ["id", "albedo"], "samples": 4}, ".exr"),
    ("knot.obj", {"smooth": 0, "samples": 4}, ".png"),
    ("knot.obj", {"key_light": False, "occlusion_rays": 2, "samples": 4}, ".png"),
    ("knot.obj", {"outline": 2, "depth_cue": 0.5, "samples": 4}, ".png"),
    ("knot.obj", {"projection": "orthographic", "samples": 4, "exposure": 1}, ".png"),
    ("rings.nff", {"integrator": "views"}, ".png"),
    ("fullerene.xyz", {"size": "160x120", "legend": True, "scale_bar": True, "samples": 4}, ".png"),
    ("droplet.dump", {"size": "160x120", "color_by": "c_pe", "color_bar": True, "dpi": 90}, ".exr"),
    ("fullerene.xyz", {"size": "160x120", "color_by": "index", "color_bar": True, "color_bar_side": "left",
                       "colormap": "coolwarm", "background": "transparent", "samples": 4}, ".png"),
    ("lattice.nff", {"threads": 1, "counters": True}, ".png"),
]


def argument(option, value):
    name = "--" + ("from" if option == "from_" else option.replace("_", "-"))
    if value is True:
        return [name]
    if value is False:
        return [name, "off"] if option == "key_light" else [f"--no-{name[2:]}"]
    return [name, ",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)]


@pytest.mark.parametrize("scene, options, suffix", CASES)
def test_same_bytes(scene, options, suffix, program, tmp_path):
    options = {"size": "60x45", **options}
    arguments = [word for option, value in options.items() for word in argument(option, value)]
    by_program, by_package = tmp_path / f"program{suffix}", tmp_path / f"package{suffix}"
    subprocess.run([program, "render", SCENES / scene, "-o", by_program, "--quiet", *arguments],
                   check=True, stderr=subprocess.PIPE, text=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", raio.SceneWarning)
        raio.render(SCENES / scene, **options).save(by_package)
    assert by_package.read_bytes() == by_program.read_bytes()
    if suffix == ".png":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", raio.SceneWarning)
            assert raio.render(SCENES / scene, **options)._repr_png_() == by_program.read_bytes()


def test_same_bytes_in_an_environment(program, tmp_path):
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n"
    (tmp_path / "sky.hdr").write_bytes(head + bytes([200, 100, 50, 129, 20, 40, 80, 129]))
    options = {"environment": tmp_path / "sky.hdr", "env_rotate": 30, "integrator": "path"}
    test_same_bytes("crates.gltf", {**options, "samples": 4}, ".png", program, tmp_path)
    del options["integrator"]
    lit, scene = raio.load(SCENES / "rings.nff", **options), raio.load(SCENES / "rings.nff")
    as_background = {"background": tmp_path / "sky.hdr", "env_rotate": 30, "samples": 4}
    test_same_bytes("crates.gltf", as_background, ".png", program, tmp_path)
    small = {"size": (60, 45), "integrator": "path", "samples": 1}
    assert lit.render(**small)._repr_png_() != scene.render(**small)._repr_png_()
    (tmp_path / "sky.hdr").write_bytes(head + bytes(7))
    with pytest.raises(raio.SceneError, match="sky.hdr.*7 bytes are too short for 2 x 1 pixels"):
        raio.load(SCENES / "rings.nff", **options)


def test_same_bytes_under_the_sky(program, tmp_path):
    test_same_bytes("rings.nff", {"background": "sky", "samples": 1}, ".png", program, tmp_path)
    small = {"size": (40, 30), "samples": 1}
    image = raio.render(SCENES / "rings.nff", background="sky", **small)
    assert image._repr_png_() == raio.load(SCENES / "rings.nff", sky=(3, 45, 0)).render(**small)._repr_png_()
    assert image._repr_png_() == raio.load(SCENES / "rings.nff", background="sky").render(**small)._repr_png_()
    with pytest.raises(ValueError, match="sky cannot be combined with environment"):
        raio.load(SCENES / "rings.nff", background="sky", environment="a.hdr")
    with pytest.raises(ValueError, match="sky is for reading a file"):
        raio.Scene(background="sky").render(**small)
