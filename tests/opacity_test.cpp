// Surfaces that let a part of the light through: against closed forms, and that every structure and
// any order gives the same.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "accel_rays.h"
#include "integrate/film.h"
#include "one_picture.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::awkward_rays;
using tests::expect_one_picture;
using tests::if_sanitized;
using tests::moving_scene;
using tests::picture_of;
using tests::random_scene;

// Looks down the z axis from above at a white background; the primitives are black.
Scene looking_down() {
  Scene scene;
  scene.camera.from = {0, 0, 10}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 1, 0};
  scene.camera.fov_deg = 1;
  scene.background = Rgb(1);
  scene.materials = {{.color = Rgb(0), .kd = 0}};
  return scene;
}

float middle(const Scene& scene, RenderOptions options = {}) {
  options.width = options.height = 1;
  options.tone = Tone::none;
  return expect_one_picture(scene, options).pixels[0].x;
}

TEST(Opacity, LayersMultiply) {
  for (const float a : {0.02f, 0.1f, 0.3f, 0.5f, 0.9f, 0.999f})
    for (const int k : {1, 2, 3, 8, 30}) {
      Scene scene = looking_down();
      for (int i = 0; i < k; ++i) {
        scene.discs.push_back({{0, 0, float(i) * 0.1f}, {0, 0, 1}, 1, 0});
        scene.disc_materials.push_back(0);
        scene.disc_opacity.push_back(a);
      }
      const double passes = std::pow(1 - double(a), k);
      // Little light behind few layers, and much behind any number, is not randomized.
      if (k == 1 || passes > (k <= 4 ? 1 / 128. : 1 / 8.)) {
        EXPECT_NEAR(middle(scene), passes, 1e-4) << a << ' ' << k;
        continue;
      }
      // With many layers a pixel sees one: 40,000 pixels average the transmittance, to six
      // deviations at most.
      RenderOptions options;
      options.width = options.height = 200;
      options.tone = Tone::none;
      double sum = 0;
      for (const Rgb& c : picture_of(scene, options).pixels) sum += double(c.x);
      EXPECT_NEAR(sum / 40000, passes, 6 * std::sqrt(passes / 40000) + 1e-4) << a << ' ' << k;
    }
}

// Layers lit from the eye's side: each is as bright as what passes those in front of it, and has
// that weight again.
TEST(Opacity, ManyLayersHaveTheRightMean) {
  for (const auto& [a, k] : {std::pair{0.03f, 40}, std::pair{0.1f, 9}, std::pair{0.1f, 30},
                             std::pair{0.3f, 6}, std::pair{0.5f, 8}, std::pair{0.9f, 5}}) {
    Scene scene = looking_down();
    scene.lights = {{{0, 0, 50}, Rgb(1), {}}};
    scene.materials.push_back({.color = Rgb(1), .kd = 1});
    const double passes = 1 - double(a);
    double expected = std::pow(passes, k);
    for (int i = 0; i < k; ++i) {
      const bool is_white = i % 3 == 1;
      scene.discs.push_back({{0, 0, float(-i) * 0.1f}, {0, 0, 1}, 1, 0});
      scene.disc_materials.push_back(is_white ? 1 : 0);
      scene.disc_opacity.push_back(a);
      if (is_white) expected += double(a) * std::pow(passes, 2 * i);
    }
    RenderOptions options;
    options.width = options.height = 200;
    options.tone = Tone::none;
    double sum = 0, squares = 0;
    for (const Rgb& c : picture_of(scene, options).pixels)
      sum += double(c.x), squares += double(c.x) * double(c.x);
    const double mean = sum / 40000, variance = squares / 40000 - mean * mean;
    EXPECT_NEAR(mean, expected, 5 * std::sqrt(variance / 40000) + 1e-4) << a << ' ' << k;
  }
}

// A floor below many layers, which hide it from the light, but not from the eye.
TEST(Opacity, ShadowsOfManyLayersHaveTheRightMean) {
  for (const auto& [a, k] : {std::pair{0.1f, 20}, std::pair{0.3f, 8}, std::pair{0.5f, 4}}) {
    Scene scene = looking_down();
    scene.background = Rgb(0);
    scene.camera.from = {40, 0, 10};
    scene.lights = {{{0, 0, 50}, Rgb(1), {}}};
    scene.materials.push_back({.color = Rgb(1), .kd = 1});
    scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
    scene.plane_materials = {1};
    RenderOptions options;
    options.width = options.height = 100;
    options.tone = Tone::none;
    const auto mean = [&] {
      double sum = 0;
      for (const Rgb& c : picture_of(scene, options).pixels) sum += double(c.x);
      return sum / 10000;
    };
    const double lit = mean();
    for (int i = 0; i < k; ++i) {
      scene.discs.push_back({{0, 0, 30 + float(i) * 0.1f}, {0, 0, 1}, 3, 0});
      scene.disc_materials.push_back(0);
      scene.disc_opacity.push_back(a);
    }
    const double passes = std::pow(1 - double(a), k);
    EXPECT_NEAR(mean(), passes * lit, 0.06 * std::sqrt(passes)) << a << ' ' << k;
  }
}

TEST(Opacity, ADepthStopsRaysInProportion) {
  for (const float a : {0.001f, 0.05f, 0.3f, 0.5f, 0.9f, 0.9999f}) {
    const uint32_t depth = depth_of_opacity(a);
    // The least number that is stopped.
    uint64_t low = 0, high = uint64_t(1) << 32;
    while (low < high) {
      const uint64_t middle = (low + high) / 2;
      if (stops(depth, uint32_t(middle)))
        high = middle;
      else
        low = middle + 1;
    }
    EXPECT_NEAR(double(low) / 0x1p32, 1 - double(a), 1e-6) << a;
  }
}

TEST(Opacity, OfAMaterialAppliesToPrimitivesWithoutTheirOwn) {
  Scene scene = looking_down();
  scene.material_opacity = std::vector<float>{0.25f};
  scene.planes = {{{0, 0, 1}, {0, 0, 1}}};
  scene.plane_materials = {0};
  EXPECT_NEAR(middle(scene), 0.75, 1e-6);
  scene.spheres = {{{0, 0, 0}, 0.5f}};
  scene.sphere_materials = {0};
  scene.sphere_opacity = std::vector<float>{0.5f};
  EXPECT_NEAR(middle(scene), 0.375, 1e-6);
}

TEST(Opacity, TheOptionIsTheDefault) {
  Scene scene = looking_down();
  scene.spheres = {{{0, 0, 0}, 0.5f}};
  scene.sphere_materials = {0};
  scene.discs = {{{0, 0, 2}, {0, 0, 1}, 1, 0}};
  scene.disc_materials = {0};
  scene.disc_opacity = std::vector<float>{0.5f};
  for (const float opacity : {0.0f, 0.25f, 1.0f}) {
    RenderOptions options;
    options.opacity = opacity;
    EXPECT_NEAR(middle(scene, options), 0.5 * (1 - double(opacity)), 1e-6);
    const RenderSettings settings = resolve_options(options, scene);
    EXPECT_EQ(resolve_options(options_of(settings, scene), scene), settings);
  }
  // Defaults are not stored in pictures.
  EXPECT_FALSE(options_of(resolve_options({}, scene), scene).opacity);
}

TEST(Opacity, NothingAndAllOfIt) {
  Scene scene = looking_down();
  scene.spheres = {{{0, 0, 0}, 0.5f}, {{0, 0, 2}, 0.5f}};
  scene.sphere_materials = {0, 0};
  scene.sphere_opacity = std::vector<float>{0, 0};
  EXPECT_EQ(middle(scene), 1);
  scene.sphere_opacity = std::vector<float>{1, 0};
  EXPECT_EQ(middle(scene), 0);
}

TEST(Opacity, ARoundShapeHidesOnce) {
  const auto black = [](auto&& add) {
    Scene scene = looking_down();
    add(scene);
    return scene;
  };
  const auto sphere = black([](Scene& s) {
    s.spheres = {{{0, 0, 0}, 1}}, s.sphere_materials = {0};
    s.sphere_opacity = std::vector<float>{0.3f};
  });
  const auto cylinder = black([](Scene& s) {  // crossed by the ray twice
    s.cones = {{{-1, 0, 0}, 0.5f, {1, 0, 0}, 0.5f}}, s.cone_materials = {0};
    s.cone_opacity = std::vector<float>{0.3f};
  });
  const auto ellipsoid = black([](Scene& s) {
    s.ellipsoids = {{{0, 0, 0}, {{2, 0, 0}, {0, 1, 0}, {0, 0, 0.5f}}}}, s.ellipsoid_materials = {0};
    s.ellipsoid_opacity = std::vector<float>{0.3f};
  });
  for (const Scene& scene : {sphere, cylinder, ellipsoid}) EXPECT_NEAR(middle(scene), 0.7, 1e-6);
  // Also one that overlaps another.
  Scene two = sphere;
  two.spheres.push_back({{0, 0, 0.5f}, 1}), two.sphere_materials.push_back(0);
  two.sphere_opacity.push_back(0.5f);
  EXPECT_NEAR(middle(two), 0.35, 1e-6);
  // And triangles hide once for each.
  Scene mesh = looking_down();
  mesh.positions = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, {-9, -9, 1}, {9, -9, 1}, {0, 9, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.triangle_materials = {0, 0};
  mesh.triangle_opacity = std::vector<float>{0.3f, 0.3f};
  EXPECT_NEAR(middle(mesh), 0.49, 1e-6);
}

// A white floor below a light; everything between is transparent.
TEST(Opacity, ShadowsLetThrough) {
  Scene scene = looking_down();
  scene.background = Rgb(0);
  scene.camera.from = {4, 0, 10}, scene.camera.at = {0, 0, 0};
  scene.lights = {{{0, 0, 5}, Rgb(1), {}}};
  scene.materials.push_back({.color = Rgb(1), .kd = 1});
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {1};
  const double lit = middle(scene);
  EXPECT_NEAR(lit, 1, 1e-4);
  // Not in the eye's way.
  scene.spheres = {{{0, 0, 2.5f}, 0.3f}};
  scene.sphere_materials = {0};
  scene.sphere_opacity = std::vector<float>{0.4f};
  EXPECT_NEAR(middle(scene), 0.6 * lit, 1e-4);
  // Around the light: light goes out of it, and is hidden once.
  scene.spheres = {{{0, 0, 5}, 0.3f}};
  EXPECT_NEAR(middle(scene), 0.6 * lit, 1e-4);
  // Around the floor's point, which hides it from the eye and the light from it.
  scene.spheres = {{{0, 0, 0}, 0.3f}};
  EXPECT_NEAR(middle(scene), 0.6 * 0.6 * lit, 1e-4);
}

TEST(Opacity, MirrorsShowTransparentPrimitives) {
  Scene scene = looking_down();
  scene.materials.push_back({.color = Rgb(0), .kd = 0, .ks = 1});
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {1};
  scene.discs = {{{0, 0, 12}, {0, 0, 1}, 3, 0}};  // behind the eye
  scene.disc_materials = {0};
  scene.disc_opacity = std::vector<float>{0.2f};
  EXPECT_NEAR(middle(scene), 0.8, 1e-6);
}

Scene with_opacity(Scene scene, uint32_t seed) {
  std::mt19937 rng(seed);
  for_each_pool([&](auto pool) {
    auto& opacity = scene.*pool.opacity;
    for (size_t i = 0; i < (scene.*pool.shapes).size(); ++i)
      opacity.push_back(rng() % 3 == 0 ? 1 : float(rng() % 1001) / 1000);
  });
  return scene;
}

TEST(Opacity, AllStructuresGiveOnePicture) {
  for (const uint32_t seed : {1u, 2u}) {
    RenderOptions options;
    options.width = if_sanitized(16, 48), options.height = if_sanitized(20, 40);
    options.aa = 2, options.soft_shadows = true;
    (void)expect_one_picture(with_opacity(random_scene(120, seed), seed), options);
    (void)expect_one_picture(with_opacity(moving_scene(seed), seed), options);
    options.integrator = IntegratorKind::ambient, options.soft_shadows = false;
    (void)expect_one_picture(with_opacity(random_scene(120, seed), seed), options);
  }
}

TEST(Opacity, TheTreeFindsTheLayersOfBruteForce) {
  for (const bool one_sided : {false, true}) {
    const Scene scene = with_opacity(random_scene(600, 7), 3);
    const auto none = build_accel(scene, {.kind = AccelKind::none}, one_sided);
    const auto tree = build_accel(scene, {.kind = AccelKind::bvh}, one_sided);
    const RayBatch rays = awkward_rays(scene, if_sanitized(500, 3000), 3);
    TraceContext context;
    HitBatch after, first, second;
    after.reset(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) after.set(i, {.t = 0, .primitive = 0});
    size_t found = 1;
    for (int layer = 0; found > 0; ++layer) {
      ASSERT_LT(layer, 500);
      (*none)->next_transparent(rays, after, first, context);
      (*tree)->next_transparent(rays, after, second, context);
      found = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(first.primitive[i], second.primitive[i]) << layer << ' ' << i;
        if (!first[i].found()) {
          after.set(i, {});  // behind everything
          continue;
        }
        ASSERT_EQ(first.t[i], second.t[i]);
        after.set(i, first[i]);
        ++found;
      }
    }
    // Also with limits, at which one of them stops sooner than the other.
    for (const bool limited : {false, true}) {
      DepthBatch a, b;
      a.reset(rays.size()), b.reset(rays.size());
      for (size_t i = 0; limited && i < rays.size(); ++i)
        a.limit[i] = b.limit[i] = uint32_t(i % 5) * kHalving / 2;
      (*none)->transparent_depths(rays, a, context);
      (*tree)->transparent_depths(rays, b, context);
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(a.sum[i], b.sum[i]) << i;
        if (!a.is_stopped(i)) {
          ASSERT_EQ(a.largest[i], b.largest[i]) << i;
        }
      }
    }
    // And by keys, one per ray.
    std::vector<uint32_t> keys;
    for (uint32_t i = 0; i < rays.size(); ++i) keys.push_back(scramble(i));
    for (size_t i = 0; i < rays.size(); ++i) after.set(i, {.t = 0, .primitive = 0});
    (*none)->next_transparent(rays, after, first, context, keys.data());
    (*tree)->next_transparent(rays, after, second, context, keys.data());
    for (size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(first.primitive[i], second.primitive[i]) << i;
      if (first[i].found()) {
        ASSERT_EQ(first.t[i], second.t[i]) << i;
      }
    }
  }
}

// Over any background, a picture with alpha equals one rendered on it.
TEST(Opacity, AlphaLaysOverAnyGround) {
  const Scene scene = with_opacity(random_scene(60, 5), 8);
  RenderOptions options;
  options.width = 32, options.height = 24, options.aa = 3;
  options.channels.add(Channel::alpha);
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  WorkControl control;
  const auto film = make_film(scene, settings);
  ASSERT_TRUE(render(scene, **accel, settings, **film, control).finished);
  const Image colors = (*film)->resolve();
  const auto alpha = std::get<Column<float>>((*film)->resolve(Channel::alpha));
  for (const Rgb ground : {Rgb(1), Rgb(0.2f, 0.9f, 0.4f)}) {
    RenderOptions on_ground = options;
    on_ground.channels = {};
    on_ground.background = WrittenColor{.color = ground};
    on_ground.no_reflection = on_ground.no_refraction = true;
    const Image whole = picture_of(scene, on_ground);
    on_ground.channels.add(Channel::alpha);
    const Image over = picture_of(scene, on_ground);
    for (size_t i = 0; i < whole.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(over.pixels[i][c] + (1 - alpha[i]) * ground[c], whole.pixels[i][c], 1e-5);
  }
}

}  // namespace
}  // namespace raio::core
