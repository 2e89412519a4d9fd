// Pixel filters: the window against its integral, and edges of pictures against both.
#include "integrate/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "one_picture.h"

namespace raio::core {
namespace {

double window(double pixels) {  // from its centre
  const double turns = 2 * std::numbers::pi * (pixels / kFilterSide + 0.5);
  return (0.35875 - 0.48829 * std::cos(turns) + 0.14128 * std::cos(2 * turns) -
          0.01168 * std::cos(3 * turns)) /
         (kFilterSide * 0.35875);
}
// From the left end to a place in pixels, by Simpson's rule.
double integral(double to) {
  constexpr int kSteps = 2000;
  const double from = -kFilterSide / 2.0, step = (to - from) / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i)
    sum += window(from + step * i) * (i == 0 || i == kSteps ? 1 : i % 2 ? 4 : 2);
  return sum * step / 3;
}

TEST(PixelFilter, PlacesDivideTheWindowEvenly) {
  const auto& places = filter_places();
  EXPECT_EQ(places.front(), -1);
  EXPECT_EQ(places[kFilterSteps / 2], 0.5f);
  EXPECT_EQ(places.back(), 2);
  for (int i = 0; i <= kFilterSteps; ++i)
    EXPECT_NEAR(integral(double(places[size_t(i)]) - 0.5), double(i) / kFilterSteps, 1e-6) << i;
}

// A black half of the picture, whose edge is at this column.
Scene half(float edge) {
  Scene scene;
  scene.background = Rgb(1);
  scene.camera.from = {0, 0, 5}, scene.camera.at = {}, scene.camera.up = {0, 1, 0};
  scene.camera.projection = Projection::orthographic;
  scene.camera.fov_deg = 2 * std::atan(1.6f) * 180 / std::numbers::pi_v<float>;
  scene.add_material({.color = Rgb(0), .kd = 1});
  // 16 x 16 pixels of a unit each.
  scene.positions = {
      {edge - 8, -50, 0}, {edge + 50, -50, 0}, {edge - 8, 50, 0}, {edge + 50, 50, 0}};
  scene.triangles = {{0, 1, 2}, {1, 3, 2}};
  scene.triangle_materials = {0, 0};
  return scene;
}
RenderOptions filtered(PixelFilter filter, IntegratorKind integrator) {
  RenderOptions options;
  options.width = options.height = 16;
  options.samples = 4096;
  options.integrator = integrator;
  options.filter = filter;
  options.shading = ShadingModel::phong;
  options.sky_light = Rgb(0), options.key_light = KeyLight::off;
  return options;
}

TEST(PixelFilter, EdgesAreTheIntegralOfTheFilter) {
  for (const IntegratorKind integrator :
       {IntegratorKind::classic, IntegratorKind::ambient, IntegratorKind::path})
    for (const float edge : {7.5f, 8.2f}) {
      const Image smooth =
          tests::picture_of(half(edge), filtered(PixelFilter::blackman_harris, integrator));
      const Image box = tests::picture_of(half(edge), filtered(PixelFilter::box, integrator));
      for (int x = 0; x < 16; ++x) {
        const double to_edge = double(edge) - (x + 0.5);
        const double part = to_edge < -1.5 ? 0 : to_edge > 1.5 ? 1 : integral(to_edge);
        EXPECT_NEAR(smooth.at(x, 5).x, part, 2e-3) << x;
        EXPECT_NEAR(box.at(x, 5).x, std::clamp(to_edge + 0.5, 0.0, 1.0), 1e-3) << x;
      }
    }
}

TEST(PixelFilter, IsUsualForPaths) {
  RenderOptions options;
  EXPECT_EQ(resolve_options(options, half(8)).filter, PixelFilter::box);
  options.integrator = IntegratorKind::path;
  EXPECT_EQ(resolve_options(options, half(8)).filter, PixelFilter::blackman_harris);
  RenderSettings settings = resolve_options(options, half(8));
  EXPECT_EQ(options_of(settings, half(8)).filter, std::nullopt);
  settings.filter = PixelFilter::box;
  EXPECT_EQ(options_of(settings, half(8)).filter, PixelFilter::box);
  // One sample per pixel goes through its centre.
  options = filtered(PixelFilter::blackman_harris, IntegratorKind::classic);
  options.samples = 0, options.aa = 1;
  EXPECT_EQ(tests::picture_of(half(7.6f), options).at(7, 3), Rgb(1));
  EXPECT_EQ(tests::picture_of(half(7.4f), options).at(7, 3), Rgb(0));
}

TEST(PixelFilter, IsRefusedWithOneSample) {
  const Scene scene = half(8);
  RenderOptions options;
  options.filter = PixelFilter::blackman_harris;
  const auto why = option_conflict(options, &scene);
  ASSERT_TRUE(why);
  EXPECT_NE(why->text().find("several samples"), std::string::npos) << why->text();
  options.aa = 2;
  EXPECT_FALSE(option_conflict(options, &scene));
  options.aa = 0, options.samples = 1;  // anywhere in the filter's support
  EXPECT_FALSE(option_conflict(options, &scene));
}

TEST(PixelFilter, HasTheSameBytesEverywhere) {
  RenderOptions options = filtered(PixelFilter::blackman_harris, IntegratorKind::path);
  options.samples = 5;
  (void)tests::expect_one_picture(half(7.7f), options);
}

}  // namespace
}  // namespace raio::core
