// The light of the sun and of a clear sky.
#include "io/clear_sky.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "io/scene_file.h"
#include "render/read_options.h"

namespace raio::core {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

double luminance(Vec3d c) { return (0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z) * kSkyUnit; }

double elevation_of(const Image& image, int y) { return (0.5 - (y + 0.5) / image.height) * 180; }

// The direct light on a surface that faces the sun, and that of the sky on level ground.
struct Illumination {
  Vec3d sun, sky;
};
Illumination light_of(const Image& image, double sun_elevation) {
  const double pixel = pi / image.height, degree = pi / 180;
  Illumination all;
  for (int y = 0; y < image.height; ++y) {
    const double e = elevation_of(image, y) * degree;
    for (int x = 0; x < image.width; ++x) {
      const double azimuth = (x + 0.5 - image.width * 0.5) * pixel;
      const double to_sun = std::sin(e) * std::sin(sun_elevation * degree) +
                            std::cos(e) * std::cos(sun_elevation * degree) * std::cos(azimuth);
      const Vec3d light = Vec3d(image.at(x, y)) * (pixel * pixel * std::cos(e));
      if (to_sun > std::cos(0.5 * degree))
        all.sun = all.sun + light;
      else if (e > 0)
        all.sky = all.sky + light * std::sin(e);
    }
  }
  return all;
}

// Published values for clear air: 100 to 120 klx of direct sunlight when it is high, 10 to 20 klx
// of the sky.
TEST(ClearSky, IlluminatesLikeTheReal) {
  const Illumination noon = light_of(clear_sky(2, 70), 70);
  EXPECT_GT(luminance(noon.sun), 95'000);
  EXPECT_LT(luminance(noon.sun), 120'000);
  EXPECT_GT(luminance(noon.sky), 8'000);
  EXPECT_LT(luminance(noon.sky), 20'000);
  double last_sun = luminance(noon.sun), last_sky = luminance(noon.sky);
  for (const double elevation : {30.0, 10.0, 1.0}) {
    const Illumination light = light_of(clear_sky(2, elevation), elevation);
    EXPECT_LT(luminance(light.sun), last_sun) << elevation;
    EXPECT_LT(luminance(light.sky), last_sky) << elevation;
    last_sun = luminance(light.sun), last_sky = luminance(light.sky);
  }
}

TEST(ClearSky, HazeMovesLightFromTheSunToTheSky) {
  Illumination last = light_of(clear_sky(1, 45), 45);
  for (const double turbidity : {2.0, 4.0, 8.0}) {
    const Illumination light = light_of(clear_sky(turbidity, 45), 45);
    EXPECT_LT(luminance(light.sun), luminance(last.sun));
    EXPECT_GT(luminance(light.sky), luminance(last.sky));
    // Nothing is gained.
    EXPECT_LT(luminance(light.sun * std::sqrt(0.5) + light.sky),
              luminance(last.sun * std::sqrt(0.5) + last.sky));
    last = light;
  }
}

TEST(ClearSky, HasTheColoursOfTheSky) {
  const Image noon = clear_sky(2, 60);
  const auto at = [](const Image& image, double elevation, double azimuth) {
    const int x = int((azimuth / 360 + 0.5) * image.width);
    return Vec3d(image.at(x, int((0.5 - elevation / 180) * image.height)));
  };
  const Vec3d high = at(noon, 70, 170), low = at(noon, 1, 170), ground = at(noon, -20, 0);
  EXPECT_GT(high.z, 1.8 * high.x);
  EXPECT_LT(low.z / low.x, high.z / high.x);
  EXPECT_GT(luminance(low), luminance(high));
  // The ground reflects a fifth of what it receives.
  const Illumination light = light_of(noon, 60), evening = light_of(clear_sky(3, 6), 6);
  const Vec3d received = light.sun * std::sin(pi / 3) + light.sky;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ground[c] / (received[c] * 0.2 / pi), 1, 0.02);

  EXPECT_LT(light.sun.x / light.sun.z, 1.6);
  EXPECT_GT(evening.sun.x / evening.sun.z, 4);
}

TEST(ClearSky, IsFiniteAndSymmetricEverywhere) {
  for (const auto& [turbidity, elevation] : {std::array{1.0, 0.0}, {10.0, 0.3}, {10.0, 90.0}}) {
    const Image image = clear_sky(turbidity, elevation);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Rgb c = image.at(x, y);
        ASSERT_TRUE(is_finite(c) && c.x >= 0 && c.y >= 0 && c.z >= 0) << x << ", " << y;
        ASSERT_GT(c.x + c.y + c.z, 0) << x << ", " << y;
        if (x < image.width / 2) {
          const Rgb other = image.at(image.width - 1 - x, y);
          ASSERT_NEAR(c.y, other.y, 1e-5 * c.y + 1e-9) << x << ", " << y;
        }
      }
  }
}

// Half of a setting sun is seen.
TEST(ClearSky, TheSunSets) {
  const Image image = clear_sky(2, 0);
  double above = 0, below = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = image.width / 2 - 3; x < image.width / 2 + 3; ++x) {
      const double e = elevation_of(image, y);
      if (std::abs(e) < 0.5) (e > -0.11 ? above : below) += double(image.at(x, y).x);
    }
  EXPECT_GT(above, 10 * below);
}

TEST(ClearSky, LightsScenesOfFiles) {
  const auto file = std::filesystem::path(RAIO_SOURCE_DIR) / "scenes/teapot.nff";
  const auto direction = [&](std::array<float, 3> sky, float rotation) {
    const auto read = read_scene(file, {.sky = sky, .environment_rotation = rotation});
    EXPECT_TRUE(read);
    EXPECT_EQ(read->scene.environment[0].width, uint32_t(kSkyWidth));
    return read->scene.environment[0].direction;
  };
  // Z is up; north is +Y, and east +X.
  EXPECT_LT(length(direction({3, 45, 0}, 0) - Vec3f(0, 1, 0)), 1e-6f);
  EXPECT_LT(length(direction({3, 45, 90}, 0) - Vec3f(1, 0, 0)), 1e-6f);
  EXPECT_LT(length(direction({3, 45, 90}, 90) - Vec3f(0, 1, 0)), 1e-6f);
  const auto both = read_scene(file, {.environment = "sky.hdr", .sky = {{3, 45, 0}}});
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().front().text(), HasSubstr("sky cannot be combined with environment"));
}

TEST(ClearSky, RefusesWhatIsNoSky) {
  ReadOptions options;
  const ReadOptionSpec& spec = read_option_of("sky");
  for (const char* const text : {"", "3", "3,45", "0.9,45,0", "11,45,0", "3,-1,0", "3,91,0",
                                 "3,45,361", "3,45,nan", "clear,45,0", "3,45,0,0"}) {
    const auto set = spec.set(options, text);
    ASSERT_FALSE(set) << text;
    EXPECT_THAT(set.error(), HasSubstr("as in 3,45,120")) << text;
  }
  EXPECT_FALSE(options.sky);
}

}  // namespace
}  // namespace raio::core
