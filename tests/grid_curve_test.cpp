// The curve over grids: counts equal those of direct renders, and the points are the requested
// ones. Times are only checked to be positive.
#include "measure/grid_curve.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "render/render.h"
#include "scenes.h"

namespace raio::core {
namespace {

RenderOptions small() {
  RenderOptions o;
  o.width = 32, o.height = 24, o.accel.kind = AccelKind::bvh;
  return o;
}

constexpr MeasuringEffort kLittle{.close_enough = 1e9, .least_run_s = 0};

TEST(GridCurve, GoesFromCoarseToFine) {
  const Scene scene = tests::random_scene(400, 3);
  WorkControl control;
  int news = 0;
  const auto curve = measure_grid_curve(
      scene, small(), control,
      [&](const GridCurve& c) {
        ++news;
        EXPECT_FALSE(c.points.empty());
      },
      kLittle);
  ASSERT_TRUE(curve.has_value()) << curve.error().text();
  EXPECT_TRUE(curve->finished);
  EXPECT_GE(curve->points.size(), 8u);
  EXPECT_GE(news, 10);
  for (size_t i = 0; i < curve->points.size(); ++i) {
    const GridPoint& p = curve->points[i];
    EXPECT_GT(p.seconds.median, 0);
    EXPECT_EQ(p.rounds, 5);
    if (i == 0) continue;
    EXPECT_GT(p.factor, curve->points[i - 1].factor);
    EXPECT_GT(p.cells, curve->points[i - 1].cells);
    EXPECT_GE(p.references, curve->points[i - 1].references);
  }
  // With coarse cells few are visited, but each has many tests.
  EXPECT_GT(curve->points.front().tests, curve->points.back().tests);
  EXPECT_LT(curve->points.front().steps, curve->points.back().steps);
  const std::string csv = grid_curve_csv(*curve);
  EXPECT_EQ(size_t(std::ranges::count(csv, '\n')), curve->points.size() + 1);
}

TEST(GridCurve, CountsMatchARender) {
  const Scene scene = tests::random_scene(400, 3);
  WorkControl control;
  const auto curve = measure_grid_curve(scene, small(), control, {}, kLittle);
  ASSERT_TRUE(curve.has_value());
  const GridPoint& point = curve->points[4];
  RenderOptions o = small();
  o.accel = {.kind = AccelKind::grid, .grid_factor = point.factor, .counters = true};
  const RenderSettings s = resolve_options(o, scene);
  const auto accel = build_accel(scene, s.accel, s.one_sided);
  const auto film = make_film(scene, s);
  ASSERT_TRUE(accel && film);
  // The tiles counted by the curve: one for a small picture.
  EXPECT_TRUE(render(scene, **accel, s, **film, control, {.shards = 16}).finished);
  const RayCounts& rays = (*film)->rays();
  EXPECT_EQ(point.tests, double(rays.tests) / double(rays.total()));
  EXPECT_EQ(point.steps, double(rays.steps) / double(rays.total()));
  EXPECT_EQ(point.resolution, (*accel)->info().resolution);
  EXPECT_EQ(point.references, (*accel)->info().references);
}

TEST(GridCurve, StopsSoonOnRequestAndRefusesEmptyScenes) {
  WorkControl control;
  control.stop = true;
  const auto stopped =
      measure_grid_curve(tests::random_scene(400, 3), small(), control, {}, kLittle);
  ASSERT_TRUE(stopped.has_value());
  EXPECT_FALSE(stopped->finished);
  WorkControl other;
  Scene empty;
  empty.materials = {{}};
  EXPECT_FALSE(measure_grid_curve(empty, small(), other).has_value());
}

TEST(GridCurve, LiesOnStraightLinesBetweenItsPoints) {
  GridCurve curve;
  for (const float factor : {1.0f, 4.0f}) {
    const double s = factor;
    curve.points.push_back({.factor = factor, .rounds = 5, .seconds = {s, s, s}});
  }
  EXPECT_EQ(curve.fastest(), curve.points.data());
  EXPECT_DOUBLE_EQ(curve.seconds_at(1), 1);
  EXPECT_NEAR(curve.seconds_at(2), 2.5, 1e-6);
  EXPECT_EQ(curve.seconds_at(0.5f), 0);
  EXPECT_EQ(curve.seconds_at(5), 0);
  EXPECT_EQ(GridCurve().fastest(), nullptr);
}

}  // namespace
}  // namespace raio::core
