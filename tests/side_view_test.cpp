// The side view of a sample's rays shows all of them, with the camera and the lights, in every
// scene of the tree.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "app/explain.h"
#include "io/scene_file.h"
#include "render/options.h"
#include "scenes.h"

namespace raio::core::app {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> scenes_of_the_tree() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(RAIO_SOURCE_DIR "/scenes"))
    if (entry.is_regular_file() && std::ranges::count(std::array{".md", ".bin", ".png", ".pfm"},
                                                      entry.path().extension()) == 0)
      paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

// Where the camera shows a point: -1 to 1 from the left and from below; nothing behind it.
std::optional<std::array<double, 2>> seen_at(const Camera& c, double aspect, const Vec3d& p) {
  const Vec3d forward = normalize(Vec3d(c.at) - Vec3d(c.from));
  const Vec3d right = normalize(cross(forward, Vec3d(c.up))), up = cross(right, forward);
  const Vec3d v = p - Vec3d(c.from);
  const double tangent = std::tan(double(c.fov_deg) * std::numbers::pi / 360);
  if (!(dot(v, forward) > 0)) return std::nullopt;
  return std::array{dot(v, right) / dot(v, forward) / tangent / aspect,
                    dot(v, up) / dot(v, forward) / tangent};
}

void expect_framed(const SideView& view, const Explanation& sample, double aspect) {
  double widest = 0;
  const auto check = [&](const char* what, const Vec3d& p) {
    const auto at = seen_at(view.camera, aspect, p);
    ASSERT_TRUE(at) << what << " is behind the viewer";
    for (const double x : *at) {
      EXPECT_LT(std::abs(x), 0.95) << what;
      widest = std::max(widest, std::abs(x));
    }
  };
  check("camera", view.eye);
  check("origin of the eye ray", Vec3d(sample.rays[0].ray.origin));
  for (const Vec3d& corner : view.image) check("image plane", corner);
  size_t lights = 0;
  for (const ExplainedRay& r : sample.rays)
    if (r.hit.found()) check("hit", Vec3d(r.ray.at(r.hit.t)));
  for (const SideView::Light& light : view.lights) {
    check("light", light.at);
    const Vec3d at(sample.lights[size_t(light.number)].position);
    if (light.towards) {
      // An arrow in the light's direction.
      EXPECT_GT(length(at - light.at), 0);
      EXPECT_LT(length(normalize(at - light.at) - *light.towards), 1e-6);
    } else {
      EXPECT_EQ(light.at, at);
    }
    ++lights;
  }
  std::vector<bool> used(sample.lights.size());
  for (const ExplainedRay& r : sample.rays)
    if (r.light >= 0) used[size_t(r.light)] = true;
  EXPECT_EQ(lights, size_t(std::ranges::count(used, true)));
  EXPECT_GT(widest, 0.3) << "too small";
}

TEST(SideView, ShowsEyeHitsCameraAndLightsInEveryScene) {
  const auto paths = scenes_of_the_tree();
  EXPECT_GT(paths.size(), 25u);
  std::mt19937 rng(3);
  size_t pixels = 0, distant = 0, near = 0;
  for (const fs::path& path : paths) {
    const auto read = read_scene(path.string());
    ASSERT_TRUE(read.has_value()) << path;
    RenderOptions options;
    options.width = 60, options.height = 45;
    options.integrator = IntegratorKind::classic;
    options.accel.kind = AccelKind::bvh;
    for (const bool soft : {false, true}) {
      options.soft_shadows = soft;
      const RenderSettings settings = explained_settings(options, read->scene);
      const auto accel = build_accel(read->scene, settings.accel);
      ASSERT_TRUE(accel.has_value());
      if ((*accel)->geometry().any_transparent()) break;  // not explained
      for (int k = 0; k < 8; ++k) {
        const std::array pixel{int(rng() % 60), int(rng() % 45)};
        SCOPED_TRACE(testing::Message() << path << " pixel " << pixel[0] << ',' << pixel[1]);
        const auto sample = explain_sample(read->scene, **accel, settings, pixel[0], pixel[1], 0);
        ASSERT_TRUE(sample.has_value()) << sample.error().message;
        for (const double aspect : {0.8, 1.2, 1.7}) {
          const SideView view = side_view(*sample, settings, pixel, aspect);
          expect_framed(view, *sample, aspect);
          for (const auto& light : view.lights) ++(light.towards ? distant : near);
        }
        ++pixels;
      }
    }
  }
  EXPECT_GT(pixels, 400u);
  EXPECT_GT(distant, 50u);
  EXPECT_GT(near, 50u);
}

// The eye ray passes through the centre of the pixel that is drawn on the image plane.
TEST(SideView, ThePixelIsOnTheEyeRay) {
  const Scene scene = tests::random_scene(60, 7);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    RenderOptions options;
    options.width = 40, options.height = 30;
    options.projection = projection;
    const RenderSettings settings = explained_settings(options, scene);
    const auto accel = build_accel(scene, settings.accel);
    ASSERT_TRUE(accel.has_value());
    for (const std::array pixel : {std::array{0, 0}, {39, 29}, {20, 14}, {3, 25}}) {
      const auto sample = explain_sample(scene, **accel, settings, pixel[0], pixel[1], 0);
      ASSERT_TRUE(sample.has_value());
      const SideView view = side_view(*sample, settings, pixel, 1.2);
      const Vec3d center = (view.pixel[0] + view.pixel[2]) * 0.5;
      const Vec3d way = center - Vec3d(sample->rays[0].ray.origin), dir(sample->rays[0].ray.dir);
      EXPECT_LT(length(way - dir * dot(way, dir)), 1e-4 * view.extent);
      const Vec3d across = view.image[1] - view.image[0], down = view.image[3] - view.image[0];
      EXPECT_NEAR(length(across) / length(down), 4.0 / 3, 1e-4);
      const Vec3d in_image = center - view.image[0];
      EXPECT_NEAR(dot(in_image, across) / dot(across, across), (pixel[0] + 0.5) / 40, 1e-4);
      EXPECT_NEAR(dot(in_image, down) / dot(down, down), (pixel[1] + 0.5) / 30, 1e-4);
    }
  }
}

}  // namespace
}  // namespace raio::core::app
