// Pictures do not depend on the unit of length or on the scene's position. Every test prints its
// measurement for the table of docs/verify.md.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "io/generate/generate.h"
#include "io/nff/nff.h"
#include "render/options.h"
#include "render/render.h"

namespace raio::core {
namespace {

// The scenes that come with Raio, and small ones of all generators.
std::vector<Scene> scenes() {
  std::vector<Scene> out;
  const auto folder = std::filesystem::path(RAIO_SOURCE_DIR) / "scenes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".nff") continue;
    auto read = read_nff(entry.path());
    EXPECT_TRUE(read) << entry.path();
    if (read) out.push_back(std::move(read->scene));
  }
  for (const SceneRecipe& recipe : scene_recipes()) {
    auto scene = generate_scene(recipe.name, std::min(recipe.max_size, 2));
    EXPECT_TRUE(scene) << recipe.name;
    if (scene) out.push_back(std::move(*scene)), out.back().name += ", generated";
  }
  return out;
}

// One ray per pixel, with all reflected and refracted rays.
Image picture(const Scene& scene) {
  RenderOptions options;
  options.width = 240, options.height = 180, options.aa = 1, options.dof = false;
  const RenderSettings o = resolve_options(options, scene);
  const auto accel = build_accel(scene, o.accel);
  const auto film = make_film(scene, o);
  EXPECT_TRUE(accel && film);
  WorkControl control;
  render(scene, **accel, o, **film, control);
  return (*film)->resolve();
}

Scene scaled(Scene s, float k) {
  const auto grow = [k](auto& value) { value = value * k; };
  grow(s.camera.from), grow(s.camera.at);
  for (Light& l : s.lights) grow(l.position);
  for (Plane& p : s.planes) grow(p.point);
  for (Sphere& b : s.spheres) grow(b.center), grow(b.radius);
  for (Cone& c : s.cones) grow(c.base), grow(c.base_radius), grow(c.apex), grow(c.apex_radius);
  for (Ellipsoid& e : s.ellipsoids) {
    grow(e.center);
    for (Vec3f& axis : e.axes) grow(axis);
  }
  for (Disc& disc : s.discs) grow(disc.center), grow(disc.radius), grow(disc.inner);
  for (Vec3f& p : s.positions) grow(p);
  return s;
}

// The same scene about another point, as exported there.
Scene moved(Scene s, Vec3d by) {
  s.origin = s.origin + by;
  auto read = parse_nff(write_nff(s), s.name);
  EXPECT_TRUE(read) << s.name;
  return read ? std::move(read->scene) : Scene();
}

// Rounding moves edges: a pixel with a grazing ray may change, and mirror balls multiply that.
template <class Change>
void expect_same_pictures(std::string_view what, double bound, Change&& change) {
  double worst = 0;
  std::string worst_scene;
  for (const Scene& scene : scenes()) {
    const ImageDifference d = compare(picture(scene), picture(change(scene)));
    if (d.above_8 >= worst) worst = d.above_8, worst_scene = scene.name;
    EXPECT_LE(d.above_8, bound) << scene.name << ", " << what;
  }
  fmt::print("numerics: {:<24} {:>6.3f} % {:>6.3f} %  {}\n", what, 100 * worst, 100 * bound,
             worst_scene);
  testing::Test::RecordProperty(std::string(what), fmt::format("{}", worst));
}

TEST(Numerics, ASceneThatIsTiny) {
  expect_same_pictures("scaled by 1e-6", 0.005, [](const Scene& s) { return scaled(s, 1e-6f); });
}

TEST(Numerics, ASceneThatIsHuge) {
  expect_same_pictures("scaled by 1e6", 0.005, [](const Scene& s) { return scaled(s, 1e6f); });
}

TEST(Numerics, ASceneFarFromTheOrigin) {
  expect_same_pictures("moved by 1e5", 0.001,
                       [](const Scene& s) { return moved(s, {1e5, -1e5, 1e5}); });
}

// A tangent of a round body, moved out by a part of its radius, misses it; moved in it hits. The
// largest part for which some of the rays are wrong.
template <class Point>
double grazing_error(const Scene& scene, double distance, Point&& random_point) {
  std::mt19937 rng(7);
  const auto accel = build_accel(scene, {});
  EXPECT_TRUE(accel);
  for (double part = 0.1; part > 1e-9; part /= 2) {
    RayBatch rays;
    for (int i = 0; i < 4000; ++i) {
      const auto [p, n, across] = random_point(rng);
      const Vec3d dir = normalize(across * (i % 4 < 2 ? 1.0 : -1.0));
      const Vec3f origin(p + n * (i % 2 ? part : -part) - dir * distance);
      rays.push({origin, Vec3f(dir)});
    }
    HitBatch hits;
    TraceContext context;
    (*accel)->closest(rays, hits, context);
    for (size_t i = 0; i < rays.size(); ++i)
      if (hits[i].found() != (i % 2 == 0)) return part;
  }
  return 0;
}

struct Tangent {
  Vec3d point, normal, across;  // of a body of radius 1
};

void expect_grazing(std::string_view what, const Scene& scene,
                    const std::function<Tangent(std::mt19937&)>& random_point) {
  for (const double distance : {2.0, 100.0}) {
    const double error = grazing_error(scene, distance, random_point);
    // Origin and direction of a ray are floats.
    const double bound = 4 * distance * std::numeric_limits<float>::epsilon();
    fmt::print("numerics: {:<24} {:>6.1g}   {:>6.1g}    of the radius, from {} radii\n", what,
               error, bound, distance);
    EXPECT_LE(error, bound) << what << " from " << distance;
  }
}

TEST(Numerics, SpheresAndConesAtGrazingAngles) {
  const auto direction = [](std::mt19937& rng) {
    std::normal_distribution<double> normal;
    return normalize(Vec3d(normal(rng), normal(rng), normal(rng)));
  };
  Scene sphere;
  sphere.materials = {{}};
  sphere.spheres = {{{0, 0, 0}, 1}}, sphere.sphere_materials = {0};
  expect_grazing("grazing a sphere", sphere, [&](std::mt19937& rng) {
    const Vec3d n = direction(rng);
    return Tangent{n, n, cross(n, direction(rng))};
  });
  for (const double slope : {0.0, 0.25}) {  // of the radius, which is 1 at z = 0
    Scene cone;
    cone.materials = {{}};
    cone.cones = {{{0, 0, -2}, float(1 + 2 * slope), {0, 0, 2}, float(1 - 2 * slope)}};
    cone.cone_materials = {0};
    expect_grazing(slope == 0 ? "grazing a cylinder" : "grazing a cone", cone,
                   [&](std::mt19937& rng) {
                     std::uniform_real_distribution<double> uniform(-1, 1);
                     const double angle = 3.2 * uniform(rng), z = 0.2 * uniform(rng);
                     const Vec3d out(std::cos(angle), std::sin(angle), 0);
                     const Vec3d along = Vec3d(0, 0, 1) - out * slope;
                     const Vec3d around(-out.y, out.x, 0);
                     return Tangent{out * (1 - slope * z) + Vec3d(0, 0, z),
                                    normalize(out + Vec3d(0, 0, slope)),
                                    around + along * (0.5 * uniform(rng))};
                   });
  }
}

}  // namespace
}  // namespace raio::core
