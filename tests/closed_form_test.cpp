// Pictures with known closed forms. Every test prints its measurement for the table of
// docs/verify.md: the error, and its bound.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/options.h"
#include "render/render.h"

namespace raio::core {
namespace {

constexpr double kPi = std::numbers::pi;

struct Rendered {
  int width, height;
  Column<Rgb> pixels;

  double at(int x, int y) const { return double(pixels[size_t(y) * size_t(width) + size_t(x)].x); }
};

Rendered picture(const Scene& scene, RenderOptions options) {
  EXPECT_TRUE(validate(scene).empty()) << validate(scene).front();
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  const auto film = make_film(scene, settings);
  EXPECT_TRUE(accel && film);
  WorkControl control;
  EXPECT_TRUE(render(scene, **accel, settings, **film, control).finished);
  return {settings.width, settings.height, (*film)->resolve().pixels};
}

// A line for the table, a property for machines, and the check.
void expect_error(std::string_view what, double error, double bound, std::string_view unit) {
  fmt::print("closed form: {:<48} {:>9.2g} {:>9.2g}  {}\n", what, error, bound, unit);
  testing::Test::RecordProperty(std::string(what), fmt::format("{}", error));
  EXPECT_LE(error, bound) << what;
}

// Without lights a material of colour c has the radiance c / 10 everywhere.
Material glow(float brightness) { return {Rgb(10 * brightness), 0, 0, 1, 0, 1}; }

Scene scene_from(Vec3f from, Vec3f at, Vec3f up, float fov_deg) {
  Scene s;
  s.camera.from = from, s.camera.at = at, s.camera.up = up, s.camera.fov_deg = fov_deg;
  return s;
}

RenderOptions sized(int width, int height) {
  RenderOptions o;
  o.width = width, o.height = height;
  return o;
}

void add_polygon(Scene& s, std::initializer_list<Vec3f> corners, MaterialId material) {
  s.polygons.push_back({uint32_t(s.positions.size()), uint32_t(corners.size())});
  s.positions.insert(s.positions.end(), corners);
  s.polygon_materials.push_back(material);
}

// tan of the angle from the direction of view at the middle of column i of a picture one pixel
// high.
double column_tan(const Scene& s, int width, int i) {
  return std::tan(double(s.camera.fov_deg) * kPi / 360) * (2 * i + 1 - width);
}

// Stripes across x on a wall at height z, each 1 wide, every other one bright.
void add_stripes(Scene& s, float z, int reach, MaterialId bright) {
  for (int x = -reach; x < reach; x += 2) {
    const auto f = float(x);
    add_polygon(s, {{f, -9, z}, {f + 1, -9, z}, {f + 1, 9, z}, {f, 9, z}}, bright);
  }
}

// Columns of a picture of stripes with a brightness that differs from the formula's position on the
// wall, unless an edge is nearer than `margin`. Counts all columns with a position.
struct StripeCount {
  int wrong = 0, all = 0;
};
template <class Place>
StripeCount compare_stripes(const Scene& s, const Rendered& p, double reach, Place&& place,
                            double margin) {
  StripeCount count;
  for (int i = 0; i < p.width; ++i) {
    const double x = place(column_tan(s, p.width, i));
    if (!(std::abs(x) < reach) || std::abs(x - std::round(x)) < margin) continue;
    const bool bright = int(std::floor(x)) % 2 == 0;
    ++count.all;
    count.wrong += (p.at(i, 0) > 0.05) != bright;
  }
  return count;
}

// A square white light of side S at height H over a floor, and a straight edge at height h between:
// at x on the floor, the fraction (S/2 - x (1 - H/h)) / S of the square is visible.
TEST(ClosedForm, Penumbra) {
  const double H = 100, S = 10, h = 10;
  Scene s = scene_from({0, 0, float(h / 2)}, {}, {0, 1, 0}, 0.1f);
  s.lights = {{{0, 0, float(H)}, Rgb(1)}};
  s.materials = {{Rgb(1), 1, 0, 1, 0, 1}};
  s.planes = {{{0, 0, 0}, {0, 0, 1}}}, s.plane_materials = {0};
  RenderOptions o = sized(240, 1);
  o.soft_shadows = true, o.light_size = float(S), o.lens_samples = 4096;
  const Rendered whole = picture(s, o);
  add_polygon(s, {{-99, -99, float(h)}, {0, -99, float(h)}, {0, 99, float(h)}, {-99, 99, float(h)}},
              0);
  const Rendered cut = picture(s, o);
  double worst = 0;
  int inside = 0;
  for (int i = 0; i < cut.width; ++i) {
    const double x = h / 2 * column_tan(s, cut.width, i);
    const double seen = std::clamp((S / 2 - x * (1 - H / h)) / S, 0.0, 1.0);
    inside += seen > 0 && seen < 1;
    worst = std::max(worst, std::abs(cut.at(i, 0) / whole.at(i, 0) - seen));
  }
  EXPECT_GT(inside, 100);
  expect_error("penumbra of a square light", worst, 0.004, "of the light");
}

// A lens of radius R in focus at D shows a point at distance d as a disc, of the radius
// R |1/d - 1/D| in tangents of the angle of view. A uniform disc of radius r has the mean r^2 / 2
// of the squared distance from its centre; the small object's own adds to it.
TEST(ClosedForm, CircleOfConfusion) {
  const double R = 0.2, D = 5;
  const int n = 80;
  for (const double d : {2.5, 4.0, 5.0, 10.0, 40.0}) {
    Scene s = scene_from({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 8);
    const double pixel = 2 * std::tan(8 * kPi / 360) / n;
    const double object = 2 * pixel;  // radius, in tangents
    s.spheres = {{{0, 0, float(-d)}, float(object * d)}};
    s.sphere_materials = {0};
    s.materials = {glow(1)};
    RenderOptions o = sized(n, n);
    o.dof = true, o.aperture = float(R), o.focus = float(D), o.lens_samples = 1024;
    const Rendered p = picture(s, o);
    const double expected = R * std::abs(1 / d - 1 / D);
    double sum = 0, moment = 0, outside = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double u = (x + 0.5 - n / 2.0) * pixel, v = (y + 0.5 - n / 2.0) * pixel;
        sum += p.at(x, y), moment += p.at(x, y) * (u * u + v * v);
        if (std::sqrt(u * u + v * v) > expected + object + pixel) outside += p.at(x, y);
      }
    ASSERT_GT(sum, 0);
    EXPECT_EQ(outside, 0);
    const double radius = std::sqrt(std::max(0.0, 2 * moment / sum - object * object));
    expect_error(fmt::format("disc of a point at {} in focus at {}", d, D),
                 std::abs(radius - expected) / pixel, 0.1, "pixels");
  }
}

// Through a slab of thickness t from a above it to a wall b below it: tan of the angle of incidence
// times (a + b), tan of the refracted angle times t.
TEST(ClosedForm, SnellSlab) {
  const double a = 1, t = 3, b = 1;
  for (const double ior : {1.1, 1.5, 2.4}) {
    Scene s = scene_from({0, 0, float(a)}, {}, {0, 1, 0}, 0.05f);
    s.materials = {{Rgb(0), 0, 0, 1, 1, float(ior)}, glow(0.1f)};
    s.planes = {{{0, 0, 0}, {0, 0, 1}}, {{0, 0, float(-t)}, {0, 0, -1}}};
    s.plane_materials = {0, 0};
    add_stripes(s, float(-t - b), 40, 1);
    const Rendered p = picture(s, sized(4000, 1));
    const auto place = [&](double tangent) {
      const double sine = tangent / std::sqrt(1 + tangent * tangent) / ior;
      return (a + b) * tangent + t * sine / std::sqrt(1 - sine * sine);
    };
    const StripeCount count = compare_stripes(s, p, 38, place, 2e-5);
    EXPECT_GT(count.all, 3900);
    expect_error(fmt::format("Snell's law, slab of index {}", ior), count.wrong, 0,
                 "columns of 4000");
  }
}

// From inside a medium of index n, its surface is transparent up to the angle asin(1/n).
TEST(ClosedForm, TotalInternalReflection) {
  for (const double ior : {1.1, 1.5, 2.4}) {
    Scene s = scene_from({0, 0, -1}, {0, 0, 0}, {0, 1, 0}, 0.05f);
    s.background = Rgb(1);
    s.materials = {{Rgb(0), 0, 0, 1, 1, float(ior)}};
    s.planes = {{{0, 0, 0}, {0, 0, 1}}}, s.plane_materials = {0};
    const Rendered p = picture(s, sized(8000, 1));
    int clear = 0;
    for (int i = 0; i < p.width; ++i) clear += p.at(i, 0) > 0.5;
    const double per_column = 2 * std::tan(0.05 * kPi / 360);
    const double expected = 2 * std::tan(std::asin(1 / ior)) / per_column;
    expect_error(fmt::format("critical angle of index {}", ior), std::abs(clear - expected), 2,
                 "columns of 8000");
  }
}

// A ball turns a ray that passes its centre at the distance q by 2 (asin q - asin(q / n)), and it
// leaves at the same distance. A mirror ball turns it by pi - 2 asin q.
TEST(ClosedForm, Balls) {
  const double eye = 4;
  const auto run_ball = [&](const Material& material, double wall, auto&& place,
                            std::string_view name) {
    Scene s = scene_from({0, 0, float(eye)}, {}, {0, 1, 0}, 0.01f);
    s.materials = {material, glow(0.1f)};
    s.spheres = {{{0, 0, 0}, 1}}, s.sphere_materials = {0};
    add_stripes(s, float(wall), 40, 1);
    const Rendered p = picture(s, sized(2900, 1));
    const StripeCount count = compare_stripes(s, p, 38, place, 2e-4);
    EXPECT_GT(count.all, 2000);
    expect_error(name, count.wrong, 0, "columns of 2900");
  };
  // The line of a ray in the plane of incidence, x across and z along the view: its angle to the
  // view and its distance q from the centre determine where it hits the wall.
  for (const double ior : {1.1, 1.5, 2.4}) {
    const double wall = -8;
    run_ball(
        {Rgb(0), 0, 0, 1, 1, float(ior)}, wall,
        [&](double tangent) {
          const double angle = std::atan(tangent), q = eye * std::sin(angle);
          if (std::abs(q) >= 1) return tangent * (eye - wall);
          const double turned = angle - 2 * (std::asin(q) - std::asin(q / ior));
          return (q - wall * std::sin(turned)) / std::cos(turned);
        },
        fmt::format("Snell's law, ball of index {}", ior));
  }
  // The wall is behind the eye: only mirrored rays hit it.
  const double wall = 6;
  run_ball(
      {Rgb(0), 0, 1, 1, 0, 1}, wall,
      [&](double tangent) {
        const double angle = std::atan(tangent), q = eye * std::sin(angle);
        if (std::abs(q) >= 1) return std::numeric_limits<double>::infinity();
        const double normal = std::asin(q) - angle;  // of the point hit, from the z axis
        const double out = normal + std::asin(q);    // the reflected ray's
        if (out >= kPi / 2 || out <= -kPi / 2) return std::numeric_limits<double>::infinity();
        return std::sin(normal) + (wall - std::cos(normal)) * std::tan(out);
      },
      "mirror ball");
}

// A plane mirror shows what would be visible through it as a window to its mirror image.
TEST(ClosedForm, PlaneMirror) {
  Scene mirror = scene_from({0, 0, 0}, {1, 0.3f, 0.2f}, {0, 0, 1}, 50);
  mirror.materials = {{Rgb(0), 0, 1, 1, 0, 1}, glow(0.9f), glow(0.5f)};
  mirror.planes = {{{2, 0, 0}, {-1, 0, 0}}}, mirror.plane_materials = {0};
  Scene window = mirror;
  window.planes.clear(), window.plane_materials.clear();
  const auto add = [&](Vec3f center, float radius, MaterialId material) {
    mirror.spheres.push_back({center, radius}), mirror.sphere_materials.push_back(material);
    window.spheres.push_back({{4 - center.x, center.y, center.z}, radius});
    window.sphere_materials.push_back(material);
  };
  add({-3, 1, 0.5f}, 1, 1), add({-1, 2, 2}, 0.5f, 2), add({-6, 3, -1}, 1.5f, 2);
  const Rendered a = picture(mirror, sized(400, 300)), b = picture(window, sized(400, 300));
  int different = 0, bright = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      different += std::abs(a.at(x, y) - b.at(x, y)) > 1e-3;
      bright += b.at(x, y) > 0;
    }
  EXPECT_GT(bright, 5000);
  expect_error("image in a plane mirror", different, 2, "pixels of 120000");
}

// Ks cos^n of the angle between the eye and the mirrored light, over a plane.
TEST(ClosedForm, PhongLobe) {
  for (const float shine : {1.0f, 3.0827f, 30.0f, 1000.0f}) {
    Scene s = scene_from({0, 0, 3}, {}, {0, 1, 0}, 0.5f);
    const Vec3d light(4, 0, 5);
    s.lights = {{Vec3f(light), Rgb(1)}};
    s.materials = {{Rgb(1), 0, 0.75f, shine, 0, 1}};
    s.planes = {{{0, 0, 0}, {0, 0, 1}}}, s.plane_materials = {0};
    RenderOptions o = sized(600, 1);
    o.depth = 1;
    const Rendered p = picture(s, o);
    double worst = 0, largest = 0;
    for (int i = 0; i < p.width; ++i) {
      const Vec3d point(3 * column_tan(s, p.width, i), 0, 0);
      const Vec3d to_light = normalize(light - point), to_eye = normalize(Vec3d(0, 0, 3) - point);
      const double cosine = dot(Vec3d(-to_light.x, -to_light.y, to_light.z), to_eye);
      const double value = 0.75 * std::pow(std::max(0.0, cosine), double(shine));
      worst = std::max(worst, std::abs(p.at(i, 0) - value)), largest = std::max(largest, value);
    }
    EXPECT_GT(largest, 0.74);
    expect_error(fmt::format("Phong's lobe, exponent {}", shine), worst,
                 3e-6 + 2e-7 * double(shine), "of white");
  }
}

// The horizon of an infinite plane stands where the direction of view is level, whatever the
// height of the eye.
TEST(ClosedForm, Horizon) {
  double worst = 0;
  for (const float height : {1e-3f, 1.0f, 1e4f})
    for (const double pitch_deg : {-20.0, -1.0, 0.0, 7.3, 20.0}) {
      const double pitch = pitch_deg * kPi / 180;
      const Vec3f forward(float(std::cos(pitch)), 0, float(-std::sin(pitch)));
      Scene s = scene_from({0, 0, height}, Vec3f(0, 0, height) + forward * height, {0, 0, 1}, 60);
      s.materials = {glow(1)};
      s.planes = {{{0, 0, 0}, {0, 0, 1}}}, s.plane_materials = {0};
      const int n = 400;
      const Rendered p = picture(s, sized(40, n));
      const double row = n / 2.0 - std::tan(pitch) / std::tan(kPi / 6) * n / 2;
      for (int x = 0; x < p.width; ++x) {
        int sky = 0;
        while (sky < n && p.at(x, sky) < 0.5) ++sky;
        for (int y = sky; y < n; ++y) EXPECT_GT(p.at(x, y), 0.5);
        worst = std::max(worst, std::abs(sky - row));
      }
    }
  expect_error("horizon of a plane", worst, 0.51, "rows of 400");
}

}  // namespace
}  // namespace raio::core
