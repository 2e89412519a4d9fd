// The public interface with features of data files: a style, opacity, textures, a fitted camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <raio/raio.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "temporary_folder.h"

namespace {

using testing::HasSubstr;
using Floats = std::vector<float>;

const raio::Settings& small() {
  static const raio::Settings settings =
      raio::Settings().set("size", "48x36").set("threads", "2").set("samples", "4");
  return settings;
}

// Spheres in a row along z, with these opacities, or without any.
raio::Scene row(const Floats& opacity, bool stored = true) {
  raio::Scene scene;
  const Floats radii(opacity.size(), 1);
  Floats centers;
  for (size_t i = 0; i < opacity.size(); ++i) centers.insert(centers.end(), {0, 0, -4 * float(i)});
  raio::Appearance look(0);
  if (stored) look.opacity = {opacity.data(), opacity.size()};
  scene.add_spheres({centers.data(), opacity.size()}, {radii.data(), radii.size()}, look);
  scene.set_camera({{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 30});
  scene.add_light({5, 5, 9});
  return scene;
}

class LibraryData : public raio::core::TemporaryFolder {
 protected:
  raio::Scene molecule() const {
    put(file("a.xyz"), "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
    return raio::Scene::read(file("a.xyz"));
  }
  // A square with a picture of two texels, red and green.
  raio::Scene textured() const {
    put(file("square.obj"),
        "mtllib a.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    put(file("a.mtl"), "newmtl m\nKd 1 1 1\nmap_Kd a.ppm\n");
    put(file("a.ppm"), std::string_view("P6\n2 1\n255\n\xff\0\0\0\xff\0", 17));
    return raio::Scene::read(file("square.obj"));
  }
};

TEST_F(LibraryData, TheCameraIsTheOneGiven) {
  const auto width = [&](double fov_deg) {
    raio::Scene scene = molecule();
    scene.set_camera({{0, 0, 40}, {0, 0, 0}, {0, 1, 0}, fov_deg});
    const Floats pixels =
        raio::Job(scene, raio::Settings(small()).set("background", "transparent")).run().rgba();
    float sum = 0;
    for (size_t i = 3; i < pixels.size(); i += 4) sum += pixels[i];
    return sum;
  };
  EXPECT_GT(width(5), 0);
  EXPECT_NEAR(width(5) / width(10), 4, 0.4) << "half the angle, four times the pixels";
}

TEST_F(LibraryData, TheBackgroundIsTheOneGiven) {
  const auto corner = [](const raio::Scene& scene) {
    const Floats pixels = raio::Job(scene, small()).run().rgba();
    const Floats through = raio::Job(raio::Accel(scene), small()).run().rgba();
    EXPECT_EQ(pixels, through);
    return Floats(pixels.begin(), pixels.begin() + 3);
  };
  raio::Scene scene = molecule();
  EXPECT_EQ(corner(scene), (Floats{1, 1, 1})) << "that of the look";
  scene.set_background({0, 0, 1});
  EXPECT_EQ(corner(scene), (Floats{0, 0, 1}));
  scene.set_background({0, 0, 0});
  EXPECT_EQ(corner(scene), (Floats{0, 0, 0}));
}

TEST_F(LibraryData, MeshesHaveVertexColoursAndTextures) {
  const Floats corners = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, uv = {0, 0, 1, 0, 1, 1, 0, 1};
  const Floats reds = {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0};
  const std::vector<uint32_t> faces = {0, 1, 2, 0, 2, 3};
  const std::vector<uint8_t> texels = {255, 0, 0, 0, 255, 0};  // red, green
  const auto albedo = [&](bool textured, bool colored) {
    raio::Scene scene;
    raio::Material material{.color = {1, 1, 1}, .kd = 1};
    if (textured) material.texture = scene.add_texture(2, 1, texels.data());
    scene.add_mesh({corners.data(), 4}, {faces.data(), 2}, {},
                   textured ? raio::Column<float, 2>{uv.data(), 4} : raio::Column<float, 2>{},
                   colored ? raio::Column<float, 3>{reds.data(), 4} : raio::Column<float, 3>{},
                   scene.add_material(material));
    scene.set_camera({{0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 30});
    return raio::Job(scene, raio::Settings(small()).set("channels", "albedo"))
        .run()
        .channel("albedo");
  };
  const size_t left = 3 * (18 * 48 + 16), right = 3 * (18 * 48 + 32);
  const Floats textured = albedo(true, false), both = albedo(true, true);
  EXPECT_GT(textured[left], 0.7f);
  EXPECT_GT(textured[right + 1], 0.7f);
  EXPECT_GT(albedo(false, true)[right], 0.99f);
  EXPECT_GT(both[left], 0.7f);
  EXPECT_LT(both[right + 1], 0.01f) << "red times green";
  raio::Scene scene;
  const auto refused = [&](const auto& add, const char* why) {
    try {
      add();
      ADD_FAILURE() << "nothing was refused: " << why;
    } catch (const raio::Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
    EXPECT_EQ(scene.primitive_count(), 0u);
  };
  const raio::Column<float, 3> points{corners.data(), 4};
  const raio::Column<uint32_t, 3> triangles{faces.data(), 2};
  refused([&] { scene.add_mesh({corners.data(), 3}, triangles, {}, {}, {}); },
          "triangle 1 refers to vertex 3 of 3");
  refused([&] { scene.add_mesh(points, triangles, {}, {uv.data(), 3}, {}); },
          "found 4 positions but 3 texture coordinates");
  refused([&] { scene.add_mesh(points, triangles, {}, {}, {}, 7); }, "unknown material 7");
  refused([&] { scene.add_texture(0, 1, texels.data()); }, "found 0 x 1");
  refused([&] { scene.add_material({.texture = 3}); }, "unknown texture 3");
}

TEST_F(LibraryData, FittedCamerasShowEverything) {
  raio::Scene scene = row({1, 1, 1});
  scene.set_figure(true);
  const auto covered = [&] {
    const Floats pixels =
        raio::Job(
            scene,
            raio::Settings(small()).set("integrator", "ambient").set("background", "transparent"))
            .run()
            .rgba();
    float edge = 0, all = 0;
    for (size_t y = 0; y < 36; ++y)
      for (size_t x = 0; x < 48; ++x) {
        const float alpha = pixels[4 * (48 * y + x) + 3];
        all += alpha;
        if (x == 0 || y == 0 || x == 47 || y == 35) edge += alpha;
      }
    EXPECT_LT(edge, 1);
    return all;
  };
  scene.fit_camera(raio::Triple{-1, 0, 0}, {0, 1, 0});
  const float side = covered();
  EXPECT_LT(scene.camera().at[2], 0) << "the middle of the row";
  scene.fit_camera(raio::Triple{-1, 0, 0}, {0, 1, 0}, 0.25);
  EXPECT_NEAR(side / covered(), 4, 0.5) << "half the size";
  scene.fit_camera();
  EXPECT_GT(covered(), 50);
  scene.fit_camera(raio::Triple{0, 0, -1}, {0, 0, 1});
  EXPECT_GT(covered(), 50) << "from above";
  EXPECT_EQ(scene.camera().up, (raio::Triple{0, 1, 0}));
  for (const double margin : {-0.1, 0.5})
    EXPECT_THROW(scene.fit_camera(std::nullopt, {0, 0, 1}, margin), raio::Error);
  EXPECT_THROW(scene.fit_camera(raio::Triple{0, 0, 0}), raio::Error);
}

TEST_F(LibraryData, FilesAreReadAsTheSettingsSay) {
  put(file("a.xyz"), "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
  const auto filled = raio::Settings(small()).set("style", "space-filling");
  const raio::Scene scene = raio::Scene::read(file("a.xyz"), filled);
  EXPECT_NE(scene.primitive_count(), molecule().primitive_count());
  const raio::Film film = raio::Job(scene, filled).run();
  EXPECT_EQ(film.settings().get("style"), "space-filling");
  EXPECT_EQ(film.rgba(), raio::Job(scene, small()).run().rgba());
  try {
    raio::Job job(molecule(), filled);
    FAIL() << "nothing was refused";
  } catch (const raio::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("style is for reading a file"));
  }
}

TEST_F(LibraryData, PicturesAreDisplayedAndEncodedInMemory) {
  const raio::Film film =
      raio::Job(row({1, 0.5f}),
                raio::Settings(small()).set("background", "transparent").set("channels", "depth"))
          .run();
  const std::string png = film.encode(".png");
  EXPECT_EQ(png.substr(1, 3), "PNG");
  const std::vector<uint8_t> shown = film.display();
  ASSERT_EQ(shown.size(), 4u * 48 * 36);
  EXPECT_EQ(shown[3], 0) << "nothing in the corner";
  EXPECT_EQ(shown[4 * (18 * 48 + 24) + 3], 255);
  film.write(file("a.npz"));
  EXPECT_EQ(film.encode(".npz"), get(file("a.npz")));
  EXPECT_THROW((void)film.encode(".gif"), raio::Error);
}

TEST_F(LibraryData, DisplayedPicturesAreThoseOfFiles) {
  const raio::Film film = raio::Job(molecule(), small()).run();
  const std::vector<uint8_t> shown = film.display();
  const std::string pixels = film.encode(".ppm");
  const size_t head = pixels.size() - shown.size() / 4 * 3;
  for (size_t i = 0; i < shown.size() / 4; ++i)
    for (size_t k = 0; k < 3; ++k)
      ASSERT_EQ(shown[4 * i + k], uint8_t(pixels[head + 3 * i + k])) << i;
}

TEST_F(LibraryData, FilesInMemoryAreReadWithSettings) {
  const std::string text = "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n";
  const raio::Scene all = raio::Scene::parse(text, "a.xyz", {});
  EXPECT_EQ(all.to_bytes(), molecule().to_bytes());
  const raio::Settings one = raio::Settings().set("only", "element O");
  EXPECT_EQ(raio::Scene::parse(text, "a.xyz", one).primitive_count(), 1u);
  try {
    raio::Scene::parse("3\n\nO 0 0\n", "b.xyz", {});
    FAIL() << "nothing was refused";
  } catch (const raio::Error& error) {
    EXPECT_EQ(error.file(), "b.xyz");
  }
}

TEST_F(LibraryData, ColoursBecomeLight) {
  EXPECT_EQ(raio::parse_color("0.1,0.2,0.3"), (raio::Triple{0.1f, 0.2f, 0.3f}));
  EXPECT_NEAR(raio::parse_color("#808080")[0], 0.2158, 1e-3);
  float value = 0.5f;
  raio::to_linear(&value, 1);
  EXPECT_NEAR(value, 0.214, 1e-3);
  EXPECT_EQ(raio::colormap("viridis").size(), 3u * 256);
  EXPECT_THROW(raio::parse_color("reddish"), raio::Error);
  EXPECT_THROW(raio::colormap("jet"), raio::Error);
}

TEST_F(LibraryData, RaysHitTransparentPrimitives) {
  const raio::Accel accel(row({0.5f, 1, 0.25f}));
  const raio::Ray down{{0, 0, 9}, {0, 0, -1}}, up{{0, 0, -20}, {0, 0, 1}};
  EXPECT_EQ(accel.closest(down).index, 0u);
  EXPECT_DOUBLE_EQ(accel.closest(down).distance, 8);
  EXPECT_EQ(accel.closest(up).index, 2u);
  EXPECT_EQ(accel.closest({{0, 0, -2}, {0, 0, -1}}).index, 1u) << "what is opaque may be nearer";
  EXPECT_TRUE(accel.occluded({{0, 0, 9}, {0, 0, -1}, 8.5}));
  EXPECT_FALSE(accel.occluded({{0, 0, 9}, {0, 0, -1}, 7.5}));
  EXPECT_TRUE(accel.occluded(up));
  EXPECT_FALSE(accel.occluded({{0, 3, 9}, {0, 0, -1}}));
}

TEST_F(LibraryData, OpacityIsThatOfTheStructure) {
  const raio::Scene scene = row({1}, false);
  const auto clear = raio::Settings(small()).set("opacity", "0.5");
  const raio::Accel opaque(scene), built_transparent(scene, clear);
  EXPECT_EQ(raio::Job(built_transparent, small()).run().rgba(),
            raio::Job(scene, clear).run().rgba());
  EXPECT_EQ(raio::Job(built_transparent, clear).run().rgba(), raio::Job(scene, clear).run().rgba());
  EXPECT_NE(raio::Job(scene, clear).run().rgba(), raio::Job(scene, small()).run().rgba());
  try {
    raio::Job job(opaque, clear);
    FAIL() << "nothing was refused";
  } catch (const raio::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("opacity is 0.5, but the structure was built without it"));
  }
}

TEST_F(LibraryData, TexturesGoWithTheirObjects) {
  const raio::Scene square = textured();
  const auto albedo = [&](raio::Scene scene) {
    scene.set_camera({{0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 30});
    return raio::Job(scene, raio::Settings(small()).set("channels", "albedo"))
        .run()
        .channel("albedo");
  };
  const Floats expected = albedo(square);
  EXPECT_GT(expected[3 * (18 * 48 + 16)], 0.9f) << "red on the left";
  EXPECT_GT(expected[3 * (18 * 48 + 32) + 1], 0.9f) << "green on the right";
  raio::Scene copied;
  copied.add_prototype(raio::Scene());  // another one, with another texture or none
  const uint32_t number = copied.add_prototype(square);
  const Floats identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  copied.add_instances(number, {identity.data(), 1});
  EXPECT_EQ(albedo(copied), expected);
  copied.add_material({});
  EXPECT_EQ(albedo(copied), expected) << "a material after it";
}

std::string masked_at(double alpha) {
  return R"("doubleSided": true, "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor":
            [1, 1, 1, )" +
         std::to_string(alpha) + "]}";
}

// A square with a material, before a lamp.
raio::Scene lit_square(const std::function<uint32_t(raio::Scene&)>& material,
                       const raio::Appearance& look = {}) {
  static const Floats corners = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0},
                      uv = {0, 0, 1, 0, 1, 1, 0, 1};
  static const std::vector<uint32_t> faces = {0, 1, 2, 0, 2, 3};
  raio::Scene scene;
  raio::Appearance own = look;
  own.material = material(scene);
  if (look.colors.data)
    scene.add_triangles({corners.data(), 4}, {faces.data(), 2}, {}, own);
  else
    scene.add_mesh({corners.data(), 4}, {faces.data(), 2}, {}, {uv.data(), 4}, {}, own.material);
  raio::Light lamp{.kind = raio::Light::Kind::directional, .direction = {-1, 0, -3}};
  lamp.angular_diameter = 20;
  scene.add_light(lamp);
  scene.set_camera({{1, 0, 6}, {0, 0, 0}, {0, 1, 0}, 15});
  return scene;
}

Floats traced(const raio::Scene& scene) {
  return raio::Job(scene, raio::Settings(small()).set("samples", 4)).run().rgba();
}

TEST_F(LibraryData, EachParameterOfStandardMaterialsShows) {
  const uint8_t texels[] = {255, 128, 64, 0, 10, 200, 128, 255};
  const auto add = [&](raio::StandardMaterial m) {
    return [&texels, m](raio::Scene& scene) {
      raio::StandardMaterial own = m;
      const uint32_t texture =
          scene.add_texture(2, 1, texels, raio::TextureWrap::clamp, raio::TextureWrap::clamp, 4);
      for (auto* used : {&own.texture, &own.metallic_roughness_texture, &own.normal_texture,
                         &own.emission_texture, &own.transmission_texture})
        if (*used) *used = texture;
      return scene.add_material(own);
    };
  };
  const auto shown = [&](const raio::StandardMaterial& m) { return traced(lit_square(add(m))); };
  const raio::Scene plain = lit_square(add({}));
  const auto by_path = raio::Settings(small()).set("samples", 4).set("integrator", "path");
  EXPECT_EQ(traced(plain), raio::Job(plain, by_path).run().rgba())
      << "the default with such a material";
  using M = raio::StandardMaterial;
  // Each against the same material without the parameter.
  const std::vector<std::pair<M, M>> changes = {
      {{}, {.color = {0.8, 0, 0}}},
      {{}, {.metallic = 1}},
      {{}, {.roughness = 0.2}},
      {{}, {.ior = 2}},
      {{}, {.specular = 0}},
      {{}, {.specular_color = {0, 1, 0}}},
      {{}, {.transmission = 1}},
      {{.transmission = 1}, {.transmission = 1, .thin = true}},
      {{.transmission = 1},
       {.transmission = 1, .attenuation_color = {0, 1, 0}, .attenuation_distance = 0.1}},
      {{}, {.emission = {0, 1, 3}}},
      {{}, {.clearcoat = 1}},
      {{.clearcoat = 1}, {.clearcoat = 1, .clearcoat_roughness = 0.7}},
      {{}, {.sheen_color = {1, 0, 0}, .sheen_roughness = 0.5}},
      {{.sheen_color = {1, 0, 0}, .sheen_roughness = 0.2},
       {.sheen_color = {1, 0, 0}, .sheen_roughness = 1}},
      {{}, {.unlit = true}},
      {{}, {.opacity = 0.5}},
      {{.texture = 0}, {.alpha_mode = raio::AlphaMode::opaque, .texture = 0}},
      {{.alpha_mode = raio::AlphaMode::mask, .texture = 0},
       {.alpha_mode = raio::AlphaMode::mask, .alpha_cutoff = 0, .texture = 0}},
      {{.normal_texture = 0}, {.normal_scale = 0.1, .normal_texture = 0}},
      {{}, {.texture = 0}},
      {{.metallic = 1, .roughness = 1},
       {.metallic = 1, .roughness = 1, .metallic_roughness_texture = 0}},
      {{}, {.normal_texture = 0}},
      {{.emission = {1, 1, 1}}, {.emission = {1, 1, 1}, .emission_texture = 0}},
      {{.transmission = 1}, {.transmission = 1, .transmission_texture = 0}},
  };
  for (size_t i = 0; i < changes.size(); ++i) {
    if (i == 8) continue;  // a sheet absorbs nothing
    EXPECT_NE(shown(changes[i].first), shown(changes[i].second)) << i;
  }
  const auto ball = [&](const M& m) {
    raio::Scene scene;
    const Floats center = {0, 0, 0}, radius = {1};
    scene.add_spheres({center.data(), 1}, {radius.data(), 1}, scene.add_material(m));
    scene.set_camera({{0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 25});
    scene.set_background({0.5, 0.5, 0.5});
    return traced(scene);
  };
  EXPECT_NE(ball(changes[8].first), ball(changes[8].second)) << "light is absorbed inside";
  EXPECT_NE(ball({.alpha_mode = raio::AlphaMode::mask}),
            ball({.opacity = 0.4, .alpha_mode = raio::AlphaMode::mask}))
      << "masked as a whole";
  // The back of a square whose front emits.
  const auto behind = [&](bool two_sided) {
    raio::Scene scene = lit_square(add({.emission = {1, 1, 1}, .two_sided = two_sided}));
    scene.set_camera({{1, 0, -6}, {0, 0, 0}, {0, 1, 0}, 15});
    return traced(scene);
  };
  EXPECT_NE(behind(true), behind(false));
}

TEST_F(LibraryData, StandardMaterialsAreThoseOfGltf) {
  std::string buffer;
  const Floats corners = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  const std::vector<uint32_t> faces = {0, 1, 2, 0, 2, 3};
  buffer.append(reinterpret_cast<const char*>(corners.data()), 48);
  buffer.append(reinterpret_cast<const char*>(faces.data()), 24);
  put(file("square.bin"), buffer);
  const auto of_file = [&](const std::string& material) {
    put(file("square.gltf"),
        R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "square.bin", "byteLength": 72}],
            "bufferViews": [{"buffer": 0, "byteLength": 48},
                            {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                           "min": [-1, -1, 0], "max": [1, 1, 0]},
                          {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1,
                                        "material": 0}]}],
            "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0,
            "materials": [{)" +
            material + "}]}");
    return raio::Scene::read(file("square.gltf"));
  };
  const auto of_code = [&](const raio::StandardMaterial& m) {
    raio::Scene scene;
    scene.set_figure(true);
    scene.add_mesh({corners.data(), 4}, {faces.data(), 2}, {}, {}, {}, scene.add_material(m));
    return scene;
  };
  const auto same = [&](const std::string& gltf, const raio::StandardMaterial& m) {
    raio::Scene read = of_file(gltf), made = of_code(m);
    for (raio::Scene* scene : {&read, &made}) {
      scene->set_camera({{1, 1, 4}, {0, 0, 0}, {0, 1, 0}, 40});
      raio::Light lamp{.position = {2, 1, 3}};
      lamp.color = {10, 10, 10};
      scene->add_light(lamp);
    }
    for (const char* integrator : {"path", "ambient"}) {
      const auto settings = raio::Settings(small()).set("samples", 4).set("integrator", integrator);
      EXPECT_EQ(raio::Job(read, settings).run().rgba(), raio::Job(made, settings).run().rgba())
          << integrator << gltf;
    }
    raio::Scene again = raio::Scene::from_bytes(made.to_bytes());
    EXPECT_EQ(traced(again), traced(made)) << gltf;
  };
  using M = raio::StandardMaterial;
  same(R"("doubleSided": true)",
       M{.color = {1, 1, 1}, .metallic = 1, .roughness = 1, .thin = true});
  same(R"("doubleSided": true, "alphaMode": "BLEND", "emissiveFactor": [0.5, 0.25, 0],
          "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.75, 0.25, 0.5],
                                   "metallicFactor": 0.25, "roughnessFactor": 0.5})",
       M{.color = {0.5, 0.75, 0.25},
         .metallic = 0.25,
         .thin = true,
         .emission = {0.5, 0.25, 0},
         .opacity = 0.5});
  for (const double alpha : {0.75, 0.25})
    same(masked_at(alpha), M{.color = {1, 1, 1},
                             .metallic = 1,
                             .roughness = 1,
                             .thin = true,
                             .opacity = alpha,
                             .alpha_mode = raio::AlphaMode::mask});
  same(R"("doubleSided": true, "extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness":
          {"baseColorFactor": [0.5, 0.75, 0.25, 1]})",
       M{.color = {0.5, 0.75, 0.25}, .unlit = true, .alpha_mode = raio::AlphaMode::opaque});
  same(R"("doubleSided": true, "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
          "extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 0.75},
            "KHR_materials_ior": {"ior": 1.75},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2,
                                     "attenuationColor": [0.5, 1, 0.5]},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 0]},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25},
            "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0, 0], "sheenRoughnessFactor": 0.5}})",
       M{.color = {1, 1, 1},
         .roughness = 0,
         .ior = 1.75,
         .specular = 0.5,
         .specular_color = {1, 0.5, 0},
         .transmission = 0.75,
         .attenuation_color = {0.5, 1, 0.5},
         .attenuation_distance = 2,
         .clearcoat = 0.5,
         .clearcoat_roughness = 0.25,
         .sheen_color = {0.5, 0, 0},
         .sheen_roughness = 0.5});
}

TEST_F(LibraryData, StandardMaterialsGoWithTheirObjects) {
  const auto material = [](raio::Scene& scene) {
    const uint8_t texels[] = {255, 0, 0, 0, 255, 0};
    scene.add_texture(1, 1, texels);
    raio::StandardMaterial m{.color = {1, 1, 1}, .emission = {1, 1, 1}};
    m.texture = m.emission_texture = scene.add_texture(2, 1, texels);
    return scene.add_material(m);
  };
  const raio::Scene square = lit_square(material);
  raio::Scene copied = lit_square([](raio::Scene& scene) {
    const uint8_t texel[] = {0, 0, 255};
    raio::StandardMaterial m;
    m.texture = scene.add_texture(1, 1, texel);
    return scene.add_material(m);
  });
  const Floats away = {1, 0, 0, 50, 0, 1, 0, 0, 0, 0, 1, 0};
  copied.add_instances(copied.add_prototype(square), {away.data(), 1});
  copied.set_camera({{51, 0, 6}, {50, 0, 0}, {0, 1, 0}, 15});
  const Floats seen = traced(copied), expected = traced(square);
  double difference = 0, sum = 0;
  for (size_t i = 0; i < seen.size(); ++i)
    difference += double(std::abs(seen[i] - expected[i])), sum += double(expected[i]);
  EXPECT_LT(difference / sum, 0.02) << "its textures have other numbers";
}

TEST_F(LibraryData, StandardMaterialsHaveOwnColoursAndClassicLooks) {
  const Floats reds = {1, 0, 0, 1, 0, 0};
  raio::Appearance red;
  red.colors = {reds.data(), 2};
  const auto with = [](const raio::StandardMaterial& m) {
    return [m](raio::Scene& scene) { return scene.add_material(m); };
  };
  const Floats own = traced(lit_square(with({.color = {0, 0, 1}}), red));
  EXPECT_EQ(own, traced(lit_square(with({.color = {0, 1, 0}}), red)));
  EXPECT_NE(own, traced(lit_square(with({.color = {0, 0, 1}}))));
  const auto shown = [](const char* integrator, const auto& material) {
    return raio::Job(lit_square(material), raio::Settings(small()).set("integrator", integrator))
        .run()
        .rgba();
  };
  const raio::Material shiny{.kd = 0.5, .ks = 0.5, .shine = 8};
  const auto both = [&](raio::Scene& scene) {
    return scene.add_material(raio::StandardMaterial{}, shiny);
  };
  const auto classic = [&](raio::Scene& scene) { return scene.add_material(shiny); };
  EXPECT_EQ(shown("ambient", both), shown("ambient", classic));
  EXPECT_EQ(shown("path", both), shown("path", with({})));
}

TEST_F(LibraryData, InvalidStandardMaterialsAreRefused) {
  using M = raio::StandardMaterial;
  raio::Scene scene;
  const uint8_t texel[] = {0, 0, 0, 0};
  const uint32_t texture = scene.add_texture(1, 1, texel);
  const auto refused = [&](const M& m, const char* why) {
    try {
      scene.add_material(m);
      ADD_FAILURE() << "nothing was refused: " << why;
    } catch (const raio::Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  refused({.color = {2, 0, 0}}, "color is (2, 0, 0), expected 0 to 1");
  refused({.metallic = 1.5}, "metallic is 1.5, expected 0 to 1");
  refused({.roughness = kNan}, "roughness is nan, expected 0 to 1");
  refused({.ior = 0}, "ior is 0, expected a number above 0");
  refused({.specular = -1}, "specular is -1");
  refused({.specular_color = {0, kNan, 0}}, "specular_color is (0, nan, 0)");
  refused({.transmission = 2}, "transmission is 2");
  refused({.attenuation_color = {0, 2, 0}}, "attenuation_color is (0, 2, 0)");
  refused({.attenuation_distance = 0}, "attenuation_distance is 0, expected a number above 0");
  refused({.thin = true, .attenuation_distance = 1}, "set thin to false");
  refused({.emission = {-1, 0, 0}}, "emission is (-1, 0, 0)");
  refused({.clearcoat = 2}, "clearcoat is 2");
  refused({.clearcoat_roughness = 2}, "clearcoat_roughness is 2");
  refused({.sheen_color = {0, 0, 3}}, "sheen_color is (0, 0, 3)");
  refused({.sheen_roughness = 2}, "sheen_roughness is 2");
  refused({.opacity = 1.5}, "opacity is 1.5");
  refused({.alpha_mode = raio::AlphaMode(7)}, "alpha_mode is 7");
  refused({.alpha_cutoff = -1}, "alpha_cutoff is -1");
  refused({.normal_scale = kNan}, "normal_scale is nan");
  refused({.texture = 9}, "unknown texture 9, expected a number below 1");
  refused({.normal_texture = 9}, "unknown normal_texture 9");
  refused({.emission_texture = texture}, "multiplied by the emission, which is 0");
  refused({.transmission_texture = texture}, "multiplied by the transmission, which is 0");
  const Floats point = {0, 0, 0}, radius = {1};
  raio::Appearance look = scene.add_material(M{.unlit = true});
  look.colors = {point.data(), 1};
  EXPECT_THROW(scene.add_spheres({point.data(), 1}, {radius.data(), 1}, look), raio::Error);
  EXPECT_THROW(
      scene.add_texture(1, 1, texel, raio::TextureWrap::clamp, raio::TextureWrap::clamp, 2),
      raio::Error);
}

}  // namespace
