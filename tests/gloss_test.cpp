// Rough mirrors and rough glass: directions of rays against the density of docs/shading.md, and
// pictures against the same density integrated.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "integrate/explain.h"
#include "one_picture.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::expect_one_picture;
using tests::picture_of;
using tests::random_scene;
using tests::same_bytes;

constexpr double kPi = std::numbers::pi;

// A plane through the origin, seen at an angle from its normal.
Scene plane_seen_at(double degrees, const Material& material) {
  const double a = degrees * kPi / 180;
  Scene scene;
  scene.camera.from = {float(3 * std::sin(a)), 0, float(3 * std::cos(a))};
  scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 1, 0}, scene.camera.fov_deg = 0.01f;
  scene.materials = {material};
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {0};
  return scene;
}

// The density of the lobe at angle `a` from its middle, per solid angle (docs/shading.md).
double density(double a, double r) {
  const double s = std::sin(a);
  if (r < 1 && (s >= r || a > kPi / 2)) return 0;
  const double q = std::sqrt(std::max(r * r - s * s, 0.0));
  if (q == 0) return 0;
  return r < 1 ? (std::cos(2 * a) + r * r) / (2 * kPi * r * q)
               : std::pow(std::cos(a) + q, 2) / (4 * kPi * r * q);
}

// The part of the lobe within angle `a` of its middle: integrated by the midpoint rule in a
// variable without a pole at the end of the lobe.
double within(double a, double r) {
  constexpr int kSteps = 20000;
  const double end = std::min(a, r < 1 ? std::asin(r) : kPi);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    // sin a = R sin u up to the edge of the cone, where q = R cos u.
    if (r < 1) {
      const double last = std::asin(std::min(1.0, std::sin(end) / r));
      const double u = last * (i + 0.5) / kSteps, at = std::asin(r * std::sin(u));
      const double slope = r * std::cos(u) / std::cos(at);
      sum += density(at, r) * 2 * kPi * std::sin(at) * slope * last / kSteps;
    } else {
      const double at = end * (i + 0.5) / kSteps;
      sum += density(at, r) * 2 * kPi * std::sin(at) * end / kSteps;
    }
  }
  return sum;
}

TEST(Gloss, TheDensityOfTheLobeIsOne) {
  for (const double r : {0.01, 0.2, 0.7, 0.99, 1.3, 4.0}) EXPECT_NEAR(within(kPi, r), 1, 1e-4) << r;
}

// The value of chi-square with k degrees of freedom that is exceeded once in ten thousand times
// (Wilson and Hilferty 1931).
double chi_square_limit(int k) {
  const double c = 2.0 / (9 * k);
  return k * std::pow(1 - c + 3.719 * std::sqrt(c), 3);
}

// Directions of the children of `kind`, one for each sample of the pixel.
std::vector<Vec3d> directions(const Scene& scene, RenderOptions o, ExplainedRay::Kind kind) {
  o.width = o.height = 1;
  const RenderSettings settings = resolve_options(o, scene);
  const auto accel = build_accel(scene, settings.accel);
  std::vector<Vec3d> out;
  for (int i = 0; i < settings.samples_per_pixel(); ++i) {
    const auto e = explain_sample(scene, **accel, settings, 0, 0, uint32_t(i));
    EXPECT_TRUE(e);
    for (const ExplainedRay& r : e->rays)
      if (r.kind == kind) out.push_back(Vec3d(r.ray.dir));
  }
  return out;
}

// Rings of equal probability around the middle, and equal sectors of each.
void expect_lobe(const std::vector<Vec3d>& found, Vec3d middle, double r) {
  constexpr int kRings = 10, kSectors = 8;
  std::vector<double> edges;
  for (int k = 1; k < kRings; ++k) {
    double low = 0, high = r < 1 ? std::asin(r) : kPi;
    for (int i = 0; i < 40; ++i) {
      const double a = (low + high) / 2;
      (within(a, r) < double(k) / kRings ? low : high) = a;
    }
    edges.push_back(low);
  }
  const Frame<double> frame(middle);
  std::vector<int> counts(kRings * kSectors);
  for (const Vec3d& d : found) {
    EXPECT_NEAR(length(d), 1, 1e-5);
    const double a = std::atan2(length(cross(d, middle)), dot(d, middle));
    const double turn = std::atan2(dot(d, frame.v), dot(d, frame.u)) / (2 * kPi) + 0.5;
    const auto ring = std::ranges::upper_bound(edges, a) - edges.begin();
    ++counts[size_t(ring) * kSectors + size_t(std::min(turn * kSectors, kSectors - 1.0))];
  }
  const double expected = double(found.size()) / double(counts.size());
  double chi = 0;
  for (const int n : counts) chi += (n - expected) * (n - expected) / expected;
  const int degrees = kRings * kSectors - 1;
  fmt::print("lobe of {}: chi-square {:.1f} of at most {:.1f}\n", r, chi,
             chi_square_limit(degrees));
  EXPECT_LT(chi, chi_square_limit(degrees)) << r;
  // Samples that share the square out among them are more even than chance; all in one cell of it
  // would not be.
  EXPECT_GT(chi, 0.0);
}

TEST(Gloss, MirroredRaysFollowTheLobe) {
  const Scene scene = plane_seen_at(20, {{0, 0, 0}, 0, 0.5f, 1, 0, 0});
  const Vec3d in = -normalize(Vec3d(scene.camera.from));
  for (const float r : {0.05f, 0.3f, 0.6f})
    for (const bool sobol : {false, true}) {
      RenderOptions o;
      o.gloss = r;
      if (sobol)
        o.samples = 4000;
      else
        o.aa = 1, o.lens_samples = 4000;
      o.aa = o.samples > 0 ? 0 : 1;
      const auto found = directions(scene, o, ExplainedRay::Kind::reflection);
      EXPECT_EQ(found.size(), 4000u);
      expect_lobe(found, Vec3d(in.x, in.y, -in.z), r);
    }
}

TEST(Translucency, RefractedRaysFollowTheLobe) {
  // With ior 1 they go straight.
  const Scene scene = plane_seen_at(30, {{0, 0, 0}, 0, 0, 1, 1, 1});
  const Vec3d in = -normalize(Vec3d(scene.camera.from));
  RenderOptions o;
  o.translucency = 0.4f, o.samples = 4000;
  const auto found = directions(scene, o, ExplainedRay::Kind::refraction);
  EXPECT_EQ(found.size(), 4000u);
  expect_lobe(found, in, 0.4f);
}

// At a grazing angle, and with a lobe wider than the hemisphere, all rays leave through their side.
TEST(Gloss, RaysStayOnTheirSide) {
  for (const float r : {0.5f, 3.0f}) {
    const Scene scene = plane_seen_at(80, {{0, 0, 0}, 0, 0.5f, 1, 0.5f, 1.2f});
    RenderOptions o;
    o.gloss = o.translucency = r, o.samples = 1000;
    int folded = 0;
    for (const Vec3d& d : directions(scene, o, ExplainedRay::Kind::reflection)) {
      EXPECT_GE(d.z, 0);
      folded += d.z > 0.3;
    }
    EXPECT_GT(folded, 50);
    for (const Vec3d& d : directions(scene, o, ExplainedRay::Kind::refraction)) EXPECT_LE(d.z, 0);
  }
}

// A dark ball in front of a bright background, seen in a rough mirror: the part of the lobe that
// hits it is missing.
TEST(Gloss, AMirrorShowsThePartOfTheLobe) {
  constexpr float kKs = 0.8f;
  Scene scene = plane_seen_at(0, {{0, 0, 0}, 0, kKs, 1, 0, 0});
  scene.background = Rgb(1, 0.5f, 0.25f);
  scene.materials.push_back({{0, 0, 0}, 0, 0, 1, 0, 0});
  // Behind the eye, at an angle of asin(2 / 10) around the mirrored direction.
  scene.spheres = {{{0, 0, 10}, 2}};
  scene.sphere_materials = {1};
  const double half_angle = std::asin(0.2);
  for (const float r : {0.15f, 0.3f, 0.8f, 2.0f}) {
    RenderOptions o;
    o.width = o.height = 8, o.gloss = r, o.samples = 1024;
    const Image picture = expect_one_picture(scene, o);
    Rgb mean;
    for (const Rgb& c : picture.pixels) mean = mean + c * (1.0f / float(picture.pixels.size()));
    // Wide lobes are mirrored back at the plane.
    const double missing =
        within(half_angle, r) + (r > 1 ? within(kPi, r) - within(kPi - half_angle, r) : 0);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(mean[c], kKs * (1 - missing) * scene.background[c], 2e-3) << r;
  }
}

TEST(Gloss, TheOptionOverridesMaterials) {
  Scene scene = random_scene(80, 3);
  RenderOptions o;
  o.width = 60, o.height = 50, o.aa = 2;
  const Image plain = picture_of(scene, o);
  o.gloss = o.translucency = 0.0f;
  EXPECT_TRUE(same_bytes(plain, picture_of(scene, o))) << "nothing spreads";
  scene.material_roughness.assign(scene.materials.size(), 0.2f);
  EXPECT_TRUE(same_bytes(plain, picture_of(scene, o))) << "switched off";
  o.gloss.reset(), o.translucency.reset();
  const Image rough = expect_one_picture(scene, o);
  EXPECT_FALSE(same_bytes(plain, rough));
  scene.material_roughness.clear();
  o.gloss = o.translucency = 0.2f;
  EXPECT_TRUE(same_bytes(rough, picture_of(scene, o)));
  const RenderOptions again = options_of(resolve_options(o, scene), scene);
  EXPECT_EQ(again.gloss, o.gloss);
  EXPECT_EQ(again.translucency, o.translucency);
  EXPECT_NE(option_arguments(o).find("--gloss 0.2 --translucency 0.2"), std::string::npos);
}

}  // namespace
}  // namespace raio::core
