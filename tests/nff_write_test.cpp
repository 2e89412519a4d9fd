// Scenes written as NFF and read back.
#include <gtest/gtest.h>

#include "nff_text.h"
#include "shape/polygon.h"
#include "shape/triangle.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using tests::expect_same;
using tests::kCamera;
using tests::kMaterial;
using tests::kSharedFolder;
using tests::RandomScene;
using tests::read;
using tests::read_objects;
using tests::texts;

TEST(NffWrite, RandomScenesReadBackTheSame) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = RandomScene(seed).make();
    ASSERT_THAT(validate(scene), IsEmpty());
    const std::string text = write_nff(scene, "made\nby chance");
    expect_same(scene, read(text));
    if (HasFailure()) return;
  }
}

TEST(NffWrite, EveryPlaneOfUnitNormalReadsBack) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Scene scene;
  scene.materials.emplace_back();
  for (int i = 0; i < 20'000; ++i) {
    const double far = std::pow(10, double(random() % 12) - 4);
    const Vec3d p(normal(random), normal(random), normal(random));
    const Vec3d n(normal(random), normal(random), normal(random) * std::pow(0.1, random() % 30));
    scene.planes.push_back({Vec3f(p * far), Vec3f(normalize(n))});
    scene.plane_materials.push_back(0);
  }
  expect_same(scene, read(write_nff(scene)));
}

TEST(NffWrite, TheFloatThatRoundsTwice) {
  // The shortest digits of this float are nearest to a double halfway to the next float.
  Scene scene;
  scene.materials.emplace_back();
  scene.spheres.push_back({{0x1.5c87fap-84f, 0, 0}, 1});
  scene.sphere_materials.push_back(0);
  EXPECT_EQ(read(write_nff(scene)).spheres[0].center.x, 0x1.5c87fap-84f);
}

TEST(NffWrite, FewDigitsAndKindByKind) {
  const std::string text = write_nff(
      read_objects("p 3 0 0 0 1 0 0 0 1 0\ns 0.1 0.2 0.3 1\npl 0 0 0.7 1 0 0.7 0 1 0.7\n"),
      "two\nlines");
  EXPECT_EQ(text, "# two\n# lines\n" + kCamera + "b 0 0 0\n" + kMaterial +
                      "pl 0 0 0.7 1 0 0.7 0 1 0.7\ns 0.1 0.2 0.3 1\np 3\n0 0 0\n1 0 0\n0 1 0\n");
}

// Real files.

struct Shared {
  const char* file;
  std::array<size_t, kShapeKinds> counts;  // plane, sphere, triangle, polygon, cone, cylinder
  size_t lights;
};

constexpr Shared kShared[] = {
    {"p3d/balls_high.nff", {0, 7381, 2, 0, 0, 0}, 3},
    {"p3d/balls_low.nff", {0, 10, 2, 0, 0, 0}, 3},
    {"p3d/balls_medium.nff", {0, 91, 2, 0, 0, 0}, 3},
    {"p3d/mount_high.nff", {0, 4, 2048, 0, 0, 0}, 1},
    {"p3d/mount_low.nff", {0, 4, 8, 0, 0, 0}, 1},
    {"p3d/mount_very_high.nff", {0, 4, 32768, 0, 0, 0}, 1},
    {"p3d/plane.nff", {1, 10, 0, 0, 0, 0}, 3},
    {"spd/balls.nff", {0, 7381, 0, 1, 0, 0}, 3},
    {"spd/gears.nff", {0, 0, 0, 9345, 0, 0}, 5},
    {"spd/lattice.nff", {0, 2197, 0, 0, 0, 6084}, 6},
    {"spd/mount.nff", {0, 4, 8192, 0, 0, 0}, 1},
    {"spd/rings.nff", {0, 4200, 0, 1, 0, 4200}, 3},
    {"spd/teapot.nff", {0, 0, 9120, 144, 0, 0}, 2},
    {"spd/tetra.nff", {0, 0, 4096, 0, 0, 0}, 1},
    {"spd/tree.nff", {0, 4095, 0, 1, 4095, 0}, 7},
};

TEST(NffShared, ReadWithoutWarningAndWriteBackTheSame) {
  if (!std::filesystem::exists(kSharedFolder)) GTEST_SKIP() << "no " << kSharedFolder;
  for (const Shared& shared : kShared) {
    SCOPED_TRACE(shared.file);
    const auto result = read_nff(kSharedFolder / shared.file);
    ASSERT_TRUE(result) << texts(result.error());
    EXPECT_EQ(texts(result->notices), "");
    EXPECT_EQ(count_primitives(result->scene), shared.counts);
    EXPECT_EQ(result->scene.lights.size(), shared.lights);
    EXPECT_THAT(validate(result->scene), IsEmpty());
    EXPECT_EQ(result->scene.origin, Vec3d());
    expect_same(result->scene, read(write_nff(result->scene)));
  }
}

}  // namespace
}  // namespace raio::core
