// Regions of pixels, with known geometry.
#include "render/regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "io/nff/nff.h"
#include "render/options.h"

namespace raio::core {
namespace {

// A matt floor from straight above, a matt ball over it, a mirror and a shiny ball next to it, one
// light.
constexpr std::string_view kScene =
    "b 0.1 0.2 0.3\nv\nfrom 0 0 10\nat 0 0 0\nup 0 1 0\nangle 60\nhither 0\nresolution 200 200\n"
    "l 30 0 30\n"
    "f 1 1 1 1 0 1 0 1\np 4\n-4 -4 0\n4 -4 0\n4 4 0\n-4 4 0\ns 0 0 2 1\n"
    "f 1 1 1 0.5 0.5 10 0 1\ns 0 3 0.5 0.5\nf 1 1 1 0.8 0.2 10 0 1\ns 0 -3 0.5 0.5\n";

std::vector<Region> regions(const Scene& scene, AccelKind kind) {
  RenderOptions options;
  options.accel.kind = kind;
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  EXPECT_TRUE(accel);
  const WorkControl control;
  return regions_of(scene, **accel, settings, control);
}

TEST(Regions, MatchGeometry) {
  const Scene scene = parse_nff(kScene, "scene")->scene;
  const auto found = regions(scene, AccelKind::bvh);
  ASSERT_EQ(found.size(), 200u * 200u);
  // On the floor's plane, in scene units.
  const double half = 10 * std::tan(std::numbers::pi / 6), pixel = 2 * half / 200;
  const auto at = [&](double x, double y) {
    const int column = int((x + half) / pixel), row = int((half - y) / pixel);
    return found[size_t(row * 200 + column)];
  };
  EXPECT_EQ(at(5, 5), Region::background);
  EXPECT_EQ(at(-3, -3), Region::lit);
  EXPECT_EQ(at(4, 0), Region::edge);
  EXPECT_EQ(at(0, 3.05), Region::mirror);
  EXPECT_EQ(at(0, -3.05), Region::shiny);
  // From the light, the ball appears 43 degrees down, with a half angle of 1.4 degrees.
  EXPECT_EQ(at(-2, 0), Region::shadow);
  EXPECT_EQ(at(-3.74, 0), Region::shadow_border);
  EXPECT_EQ(at(0.3, 0), Region::lit);
  std::map<Region, size_t> counts;
  for (const Region r : found) ++counts[r];
  const double all = double(found.size());
  EXPECT_NEAR(double(counts[Region::background]) / all, 1 - 64 / (4 * half * half), 0.02);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid})
    EXPECT_EQ(regions(scene, kind), found);
}

TEST(Regions, TrianglesOfOneSurfaceHaveNoEdges) {
  std::string text(kScene.substr(0, kScene.find("p 4")));
  for (const char* triangle : {"p 3\n-9 -9 0\n9 -9 0\n9 9 0\n", "p 3\n-9 -9 0\n9 9 0\n-9 9 0\n"})
    text += triangle;
  const Scene scene = parse_nff(text, "scene")->scene;
  const auto found = regions(scene, AccelKind::bvh);
  for (size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], Region::lit) << i;
}

TEST(Regions, StopOnRequest) {
  const Scene scene = parse_nff(kScene, "scene")->scene;
  const RenderSettings settings = resolve_options({}, scene);
  const auto accel = build_accel(scene, settings.accel);
  WorkControl control;
  control.stop = true;
  EXPECT_TRUE(regions_of(scene, **accel, settings, control).empty());
}

}  // namespace
}  // namespace raio::core
