// Properties of every scene and every picture, tested on many random ones.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io/image/image.h"
#include "io/nff/nff.h"
#include "noise.h"
#include "one_picture.h"
#include "sanitized.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using tests::expect_one_picture;
using tests::if_sanitized;
using tests::noise;
using tests::picture_of;
using tests::random_scene;
using tests::same_bytes;

constexpr uint32_t kRounds = if_sanitized(4, 24);
constexpr int kSide = if_sanitized(40, 200);

RenderOptions random_options(std::mt19937& random) {
  RenderOptions o;
  o.width = 1 + int(random() % 40), o.height = 1 + int(random() % 40);
  o.aa = 1 + int(random() % 2);
  o.lens_samples = 1 + int(random() % 2);
  o.soft_shadows = random() % 2;
  o.dof = random() % 2 == 0;
  o.one_sided = random() % 2;
  o.depth = 1 + int(random() % 6);
  o.seed = uint32_t(random());
  return o;
}

TEST(Property, EveryStructureAndNumberOfThreadsGivesThePicture) {
  for (uint32_t seed = 0; seed < kRounds; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const float scale = std::exp2(float(random() % 41) - 20);
    const Vec3f shift(float(random() % 10), float(random() % 100), float(random() % 1000));
    const Scene scene = random_scene(1 + int(random() % 400), seed, scale, shift * scale);
    const RenderOptions options = random_options(random);
    expect_one_picture(scene, options);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(Property, EveryStructureGivesThePictureOfAScene) {
  for (const char* name : {"sphereflake", "shapes", "tree"}) {
    SCOPED_TRACE(name);
    const auto read = read_nff(std::string(RAIO_SOURCE_DIR "/scenes/") + name + ".nff");
    ASSERT_TRUE(read);
    RenderOptions options;
    options.width = options.height = kSide;
    expect_one_picture(read->scene, options);
  }
}

TEST(Property, AWrittenSceneGivesTheSamePicture) {
  for (uint32_t seed = 0; seed < kRounds; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    // Kind by kind and material by material, as they are written.
    const auto first = parse_nff(write_nff(random_scene(200, seed)), "t.nff");
    ASSERT_TRUE(first);
    const auto again = parse_nff(write_nff(first->scene), "t.nff");
    ASSERT_TRUE(again);
    const RenderOptions options = random_options(random);
    ASSERT_TRUE(same_bytes(picture_of(first->scene, options), picture_of(again->scene, options)));
  }
}

class PropertyOfPictures : public TemporaryFolder {};

TEST_F(PropertyOfPictures, PicturesReadBack) {
  std::mt19937 random(1);
  for (uint32_t round = 0; round < 4 * kRounds; ++round) {
    const int width = 1 + int(random() % 70), height = 1 + int(random() % 70);
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    const Image image = noise(width, height, round);
    EXPECT_TRUE(std::isinf(compare(image, image).psnr_db));
    for (const char* name : {"a.png", "a.ppm", "a.exr", "a.pfm"}) {
      ASSERT_TRUE(write_image(image, file(name)));
      const auto back = read_image(file(name));
      ASSERT_TRUE(back) << back.error().message;
      ASSERT_EQ(back->width, width);
      ASSERT_EQ(back->height, height);
      EXPECT_EQ(compare(image, *back).largest, 0) << name;
      const bool of_bytes = name[2] == 'p' && name[3] != 'f';
      if (!of_bytes) {
        EXPECT_TRUE(same_bytes(image, *back)) << name;
      }
      const std::string bytes = get(file(name));
      ASSERT_TRUE(write_image(*back, file(name)));
      EXPECT_EQ(get(file(name)), bytes) << name;
    }
  }
}

}  // namespace
}  // namespace raio::core
