"""Materials with the parameters of glTF: their ranges, their textures, and pictures."""

import copy
import json
import pickle

import numpy as np
import pytest
import raio

SIZE = (40, 30)
RED_GREEN = np.array([[[255, 0, 0, 255], [0, 255, 0, 0]]], np.uint8)
TILTED = np.array([[[220, 128, 210]]], np.uint8)


def square(material, **look):
    scene = raio.Scene()
    part = scene.mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]],
                      uv=None if look else [[0, 0], [1, 0], [1, 1], [0, 1]], material=material, **look)
    scene.camera((1, 1, 4), (0, 0, 0), up=(0, 1, 0), fov=40)
    return scene, part


def shown(scene, **options):
    return scene.render(size=SIZE, samples=4, **options).numpy()


def pixels(**parameters):
    return shown(square(raio.StandardMaterial(**parameters))[0])


@pytest.mark.parametrize("before, change", [
    ({}, {"color": "red"}),
    ({}, {"metallic": 1}),
    ({}, {"roughness": 0.1}),
    ({}, {"ior": 2.5}),
    ({}, {"specular": 0}),
    ({}, {"specular_color": "orange"}),
    ({}, {"transmission": 1}),
    ({"transmission": 1}, {"thin": True}),
    ({}, {"emission": (0, 2.0, 4)}),
    ({}, {"clearcoat": 1, "clearcoat_roughness": 0.2}),
    ({}, {"sheen_color": "pink", "sheen_roughness": 0.5}),
    ({}, {"unlit": True}),
    ({}, {"opacity": 0.5}),
    ({}, {"texture": RED_GREEN}),
    ({"texture": RED_GREEN}, {"alpha_mode": "opaque"}),
    ({"texture": RED_GREEN, "alpha_mode": "mask"}, {"alpha_cutoff": 0}),
    ({"metallic": 1, "roughness": 1}, {"metallic_roughness_texture": RED_GREEN}),
    ({}, {"normal_texture": TILTED}),
    ({"normal_texture": TILTED}, {"normal_scale": 0.1}),
    ({}, {"emission_texture": RED_GREEN}),
    ({"transmission": 1}, {"transmission_texture": RED_GREEN}),
])
def test_each_parameter_shows(before, change):
    assert not np.array_equal(pixels(**before), pixels(**before, **change))


def test_light_is_absorbed_in_solids():
    def ball(**parameters):
        scene = raio.Scene(background="white")
        scene.spheres([[0, 0, 0]], 1, material=raio.StandardMaterial(transmission=1, **parameters))
        return shown(scene)[SIZE[1] // 2, SIZE[0] // 2, :3]

    clear = ball()
    green = ball(attenuation_color=(0.1, 1, 0.1), attenuation_distance=1)
    assert green[0] < 0.5 * clear[0] and green[1] > 0.8 * clear[1]


def test_pictures_are_those_of_gltf(tmp_path):
    """The same square, from a file and from arrays."""
    scene, _ = square(None)
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    (tmp_path / "a.bin").write_bytes(corners.tobytes() + faces.tobytes() + (uv * (1, -1) + (0, 1))
                                     .astype(np.float32).tobytes())
    document = {
        "asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 104}],
        "bufferViews": [{"buffer": 0, "byteLength": 48},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 24},
                        {"buffer": 0, "byteOffset": 72, "byteLength": 32}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                       "min": [-1, -1, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1,
                                    "material": 0}]}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0,
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 0.125, 1], "metallicFactor": 0.75, "roughnessFactor": 0.25}}]}
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    read = raio.load(tmp_path / "a.gltf")
    read.camera((1, 1, 4), (0, 0, 0), up=(0, 1, 0), fov=40)
    own, _ = square(raio.StandardMaterial(color=(0.5, 0.25, 0.125), metallic=0.75, roughness=0.25,
                                          thin=True))
    assert np.array_equal(shown(read, integrator="path"), shown(own, integrator="path"))


def test_parts_take_and_change_them():
    gold = raio.StandardMaterial(color=(1, 0.7, 0.3), metallic=1)
    scene, part = square(gold)
    first = shown(scene)
    part.material = raio.StandardMaterial(color=(1, 0.7, 0.3))
    assert not np.array_equal(shown(scene), first)
    part.material = gold
    assert np.array_equal(shown(scene), first)
    assert np.array_equal(shown(copy.deepcopy(scene)), first)
    assert np.array_equal(shown(pickle.loads(pickle.dumps(scene))), first)
    scene = raio.Scene()
    scene.cylinders([[0, 0, 0]], [[0, 0, 1]], 0.2, material=gold)
    scene.cones([[1, 0, 0]], [[1, 0, 1]], 0.2, 0, material=gold, colors="red")
    scene.discs([[2, 0, 0]], [[0, 0, 1]], 0.3, material=gold, opacity=0.5)
    other = raio.Scene()
    other.instances(scene, [np.eye(4)])
    assert np.isfinite(shown(other)).all()


def test_colours_of_primitives_replace_those_of_the_material():
    red = shown(square(raio.StandardMaterial(color="red"))[0])
    assert np.array_equal(shown(square(raio.StandardMaterial(color="blue"), colors="red")[0]), red)


@pytest.mark.parametrize("parameters, message", [
    ({"metallic": 2}, "metallic is 2, expected 0 to 1"),
    ({"roughness": float("nan")}, "roughness is nan"),
    ({"color": (2.0, 0, 0)}, r"color is \(2, 0, 0\)"),
    ({"color": "rde"}, "color: "),
    ({"ior": 0}, "ior is 0, expected a number above 0"),
    ({"emission": (-1.0, 0, 0)}, "emission: expected numbers"),
    ({"alpha_mode": "blends"}, "alpha_mode: expected opaque, mask, blend, found 'blends'"),
    ({"texture": np.zeros((2, 2), np.uint8)}, r"texture: expected .* found \(2, 2\)"),
    ({"normal_texture": np.zeros((2, 2, 3))}, "normal_texture: expected .* float64"),
    ({"thin": True, "attenuation_distance": 1}, "set thin to false"),
    ({"transmission_texture": RED_GREEN}, "multiplied by the transmission, which is 0"),
])
def test_wrong_values_are_named(parameters, message):
    with pytest.raises(ValueError, match=message):
        square(raio.StandardMaterial(**parameters))


def test_wrong_types_are_named():
    with pytest.raises(TypeError, match="clearcoat: expected a number"):
        square(raio.StandardMaterial(clearcoat="much"))
    with pytest.raises(TypeError, match="expected a raio.Material or raio.StandardMaterial"):
        square("gold")
    with pytest.raises(ValueError, match="unlit"):
        square(raio.StandardMaterial(unlit=True), colors=[[1, 0, 0], [0, 1, 0]])
