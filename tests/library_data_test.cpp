// The public interface with features of data files: a style, opacity, textures, a fitted camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <raio/raio.h>

#include <string>
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

}  // namespace
