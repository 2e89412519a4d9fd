// Raio's counts in the standard scenes compared with the published ones.
#include "app/spd.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "integrate/camera.h"
#include "io/generate/generate.h"
#include "render/options.h"
#include "render/render.h"
#include "temporary_folder.h"

namespace raio::core::app {
namespace {

using testing::HasSubstr;

// For mount, all as published by Haines where he has a number; occluded ones as known from Raio.
RayCounts published_mount() {
  return {.eye = 263169,
          .eye_hits = 173125,
          .reflection = 354769,
          .refraction = 354769,
          .shadow = 412922,
          .shadow_hits = uint64_t(74555 * 3.411)};
}

std::vector<SpdVerdict> verdicts(const RayCounts& rays) {
  std::vector<SpdVerdict> out;
  for (const SpdRow& row : beside_published(*find_published("mount"), rays, {}).rays)
    out.push_back(row.verdict());
  return out;
}

TEST(Spd, ChangedCountsAreOff) {
  using enum SpdVerdict;
  EXPECT_EQ(verdicts(published_mount()), (std::vector{ok, ok, ok, ok, ok, known}));
  const auto moved = [](uint64_t RayCounts::* count, double by) {
    RayCounts rays = published_mount();
    rays.*count = uint64_t(double(rays.*count) * by);
    return verdicts(rays);
  };
  EXPECT_EQ(moved(&RayCounts::eye_hits, 0.99)[0], off);
  EXPECT_EQ(moved(&RayCounts::eye_hits, 1.01)[0], off);
  EXPECT_EQ(moved(&RayCounts::reflection, 0.95)[1], off);
  EXPECT_EQ(moved(&RayCounts::refraction, 1.05)[2], off);
  // The two authors are 14 % apart here.
  EXPECT_EQ(moved(&RayCounts::shadow, 0.95)[4], ok);
  EXPECT_EQ(moved(&RayCounts::shadow, 1.02)[4], off);
  // A known deviation must stay the same.
  EXPECT_EQ(moved(&RayCounts::shadow_hits, 1.05)[5], off);
  EXPECT_EQ(moved(&RayCounts::shadow_hits, 0.5)[5], off);
}

TEST(Spd, PublishedNumbersAgreeWithOneAnother) {
  for (const PublishedScene& scene : kPublished) {
    SCOPED_TRACE(scene.name);
    EXPECT_TRUE(generate_scene(scene.name, 1));
    if (!scene.haines) continue;
    EXPECT_NEAR(double(scene.haines->eye_hits), double(scene.havran.eye_hits),
                0.0034 * double(scene.havran.eye_hits));
  }
}

// 5 x 5 rays of a picture with the angle between centres are the corners of 4 x 4 pixels with the
// angle between edges.
TEST(Spd, AngleToCentersPutsRaysIntoTheCornersOfPixels) {
  Camera camera;
  camera.from = {1, 2, 3}, camera.at = {0, 0, 0}, camera.up = {0, 0, 1};
  const EyeRays edges(camera, 4, 4), centers(camera, 5, 5, true);
  for (int y = 0; y <= 4; ++y)
    for (int x = 0; x <= 4; ++x) {
      const Vec3f corner = edges.pinhole(float(x), float(y)).dir;
      const Vec3f ray = centers.pinhole(float(x) + 0.5f, float(y) + 0.5f).dir;
      EXPECT_LT(length(corner - ray), 3e-7f) << x << " " << y;
    }
}

// The lists of the plain grid hold everything, and it counts more tests than with a mailbox; the
// picture is the same.
TEST(Spd, PlainGridHasNoOversizedPrimitivesAndNoMailbox) {
  const auto scene = generate_scene("balls", 2);
  ASSERT_TRUE(scene);
  RenderOptions options;
  options.width = options.height = 40;
  RenderSettings o = resolve_options(options, *scene);
  o.accel = {.kind = AccelKind::grid, .grid_resolution = {20, 20, 2}, .counters = true};
  const auto picture = [&](AccelInfo& info, RayCounts& rays) {
    const auto accel = build_accel(*scene, o.accel);
    EXPECT_TRUE(accel);
    const auto film = make_film(*scene, o);
    EXPECT_TRUE(film);
    WorkControl control;
    render(*scene, **accel, o, **film, control);
    info = (*accel)->info(), rays = (*film)->rays();
    return (*film)->resolve().pixels;
  };
  AccelInfo usual, plain;
  RayCounts usual_rays, plain_rays;
  const auto a = picture(usual, usual_rays);
  o.accel.grid_plain = true;
  const auto b = picture(plain, plain_rays);
  EXPECT_TRUE(a == b);
  EXPECT_GT(usual.oversized, 0u);
  EXPECT_EQ(plain.oversized, 0u);
  EXPECT_EQ(plain.cells, 800u);
  EXPECT_GE(plain.references, 400u);  // the floor in all cells of a layer
  EXPECT_GT(plain_rays.tests, usual_rays.tests);
}

class SpdCommand : public TemporaryFolder {};

#ifndef RAIO_SANITIZED  // half a thousand million tests
TEST_F(SpdCommand, BallsAreWithinTheTolerance) {
  testing::internal::CaptureStdout();
  const int status =
      run(SpdVerifyCommand{.scenes = {"balls"}, .progress = "off", .json = true, .options = {}});
  const auto json = nlohmann::json::parse(testing::internal::GetCapturedStdout());
  EXPECT_EQ(status, kDone);
  EXPECT_EQ(json["off"], 0);
  ASSERT_EQ(json["scenes"].size(), 1u);
  const auto& scene = json["scenes"][0];
  EXPECT_EQ(scene["scene"], "balls");
  ASSERT_EQ(scene["rays"].size(), 4u);
  EXPECT_EQ(scene["rays"][0]["raio"], 513 * 513);
  ASSERT_EQ(scene["grids"].size(), 2u);
  EXPECT_EQ(scene["grids"][0]["resolution"], (nlohmann::json{46, 46, 3}));
}
#endif

TEST_F(SpdCommand, AnotherSceneUnderTheNameIsOff) {
  const std::string path = file("tetra.nff");
  testing::internal::CaptureStdout();
  EXPECT_EQ(run(GenerateCommand{.name = "tetra", .size = 2, .output = path}), kDone);
  const int status =
      run(SpdVerifyCommand{.scenes = {path}, .progress = "off", .json = false, .options = {}});
  const std::string out = testing::internal::GetCapturedStdout();
  EXPECT_EQ(status, kCheckFailed);
  EXPECT_THAT(out, HasSubstr("  off\n"));
  for (size_t at = 0, end = 0; (end = out.find('\n', at)) != out.npos; at = end + 1)
    EXPECT_LE(end - at, 100u) << out.substr(at, end - at);
}

TEST_F(SpdCommand, UnpublishedScenesAreRefused) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(SpdVerifyCommand{
                .scenes = {"balls", "cubes.nff"}, .progress = "off", .json = false, .options = {}}),
            kBadInput);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("'cubes.nff' has no published counts; expected balls, "));
}

}  // namespace
}  // namespace raio::core::app
