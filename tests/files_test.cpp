// Properties of all data files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "data_files.h"
#include "io/scene_file.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

TEST(Files, OptionsWithoutEffectAreRefused) {
  EXPECT_THAT(error("s 0 0 0 1\n", "a.nff", {.style = AtomStyle::points}),
              HasSubstr("style has no effect on this file"));
  EXPECT_THAT(error(ply("ascii", 5, false), "a.ply", {.style = AtomStyle::points}),
              HasSubstr("style has no effect"));
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off", {.color_by = "x"}),
              HasSubstr("color-by has no effect"));
}

TEST(Files, FarCoordinatesHaveACamera) {
  const auto far = read("2\n\nC 0 0 0\nC 1e24 0 0\n", "a.xyz");
  ASSERT_TRUE(far);
  EXPECT_TRUE(validate(far->scene).empty());
}

// Seen along a row of ions a crystal would hide most of them.
TEST(Files, CrystalsAreShownAtAnAngle) {
  const auto salt = read_scene(RAIO_SOURCE_DIR "/scenes/salt.xyz");
  ASSERT_TRUE(salt) << salt.error().front().text();
  const Camera& camera = salt->scene.camera;
  const Vec3f forward = normalize(camera.at - camera.from);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(std::abs(forward[axis]), 0.3f);
}

// Any bytes give a scene or an error with a message.
TEST(Files, AnyBytesEndWell) {
  std::mt19937 rng(9);
  const std::string seeds[] = {std::string(kWater),     std::string(kPdb),
                               std::string(kMesh),      ply("binary_little_endian", 20, true),
                               ply("ascii", 20, false), std::string(kDump),
                               std::string(kData),      std::string(kGro),
                               std::string(kStl),       std::string(kObj)};
  const char* names[] = {"a.xyz",  "a.pdb", "a.ply", "a.ply", "a.ply",
                         "a.dump", "a.lmp", "a.gro", "a.stl", "a.obj"};
  for (size_t s = 0; s < std::size(seeds); ++s)
    for (int round = 0; round < 1500; ++round) {
      std::string text = seeds[s];
      for (size_t k = 0, changes = 1 + rng() % 4; k < changes; ++k) {
        const size_t at = rng() % text.size();
        switch (rng() % 4) {
          case 0:
            text[at] = char(rng());
            break;
          case 1:
            text.erase(at, 1 + rng() % 8);
            break;
          case 2:
            text.insert(at, 1 + rng() % 3, "0123456789 .-e\nxA"[rng() % 17]);
            break;
          case 3:
            text.resize(at);
            break;
        }
        if (text.empty()) text = "x";
      }
      if (const auto result = read(text, names[s]))
        EXPECT_TRUE(validate(result->scene).empty()) << text;
      else
        EXPECT_FALSE(result.error().front().message.empty());
    }
}

}  // namespace
}  // namespace raio::core
