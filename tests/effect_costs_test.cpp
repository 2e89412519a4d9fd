// Costs of effects: counts equal those of direct renders, and effects that cannot matter have no
// cost. Times are only checked to be positive.
#include "measure/effect_costs.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "render/render.h"
#include "scenes.h"

namespace raio::core {
namespace {

// A mirror, glass and a wall under a light, or without some of them.
struct Contents {
  bool mirror = true, glass = true, light = true, motion = true;
};
Scene small_scene(Contents has = {}) {
  Scene s;
  s.name = "small";
  s.camera.from = {0, -6, 1}, s.camera.at = {0, 0, 0}, s.camera.up = {0, 0, 1};
  Material plain, mirror, glass;
  mirror.ks = has.mirror ? 0.5f : 0;
  glass.transmission = has.glass ? 0.8f : 0, glass.ior = 1.5f;
  s.materials = std::vector<Material>{plain, mirror, glass};
  s.spheres = std::vector<Sphere>{{{-1, 0, 0}, 0.8f}, {{0.6f, 0, 0}, 0.7f}, {{0, 3, 0}, 2}};
  s.sphere_materials = std::vector<MaterialId>{1, 2, 0};
  if (has.motion) {
    s.moving_spheres = std::vector<MovingSphere>{{{0, -1, -0.8f}, {0.5f, -1, -0.8f}, 0.2f, 1, 3}};
    s.moving_sphere_materials = std::vector<MaterialId>{0};
  }
  if (has.light) s.lights.push_back({{3, -4, 5}, {}});
  return s;
}

RenderOptions small() {
  RenderOptions o;
  o.width = 40, o.height = 32, o.accel.kind = AccelKind::bvh;
  return o;
}

// Counts are exact however short the times are that go with them.
constexpr MeasuringEffort kLittle{.close_enough = 1e9, .least_run_s = 0};

EffectCosts measured(const Scene& scene, const RenderOptions& options) {
  const RenderSettings s = resolve_options(options, scene);
  const auto accel = build_accel(scene, s.accel, s.one_sided);
  WorkControl control;
  auto costs = measure_effects(scene, **accel, options, CostOf::report, control, {}, kLittle);
  EXPECT_TRUE(costs.has_value());
  EXPECT_TRUE(costs->finished);
  EXPECT_EQ(costs->effects.size(), kEffects.size());
  return *costs;
}

const EffectCost& cost(const EffectCosts& costs, Effect effect) {
  return costs.effects[size_t(effect)];
}

// Of `raio render --counters` with the samples of the benchmark.
RayCounts counted(const Scene& scene, RenderOptions o) {
  o.accel.counters = true;
  const RenderSettings s = resolve_options(o, scene);
  const auto accel = build_accel(scene, s.accel, s.one_sided);
  const auto film = make_film(scene, s);
  WorkControl control;
  EXPECT_TRUE(render(scene, **accel, s, **film, control).finished);
  return (*film)->rays();
}

TEST(EffectCosts, CountsMatchRenders) {
  const Scene scene = small_scene();
  for (const AccelKind kind : {AccelKind::bvh, AccelKind::grid, AccelKind::none}) {
    RenderOptions o = small();
    o.accel.kind = kind, o.soft_shadows = true, o.dof = true;
    const EffectCosts costs = measured(scene, o);
    o.aa = 1, o.lens_samples = 3;
    for (const EffectCost& c : costs.effects) {
      ASSERT_EQ(c.presence, EffectCost::in_picture);
      EXPECT_EQ(c.on, is_on(c.effect, o, scene));
      EXPECT_EQ(c.pixels, 40u * 32) << "a small picture is measured as a whole";
      EXPECT_TRUE(c.with.has_steps && c.without.has_steps);
      EXPECT_EQ(c.with.rays, counted(scene, with_effect(o, c.effect, true, scene)))
          << int(c.effect);
      EXPECT_EQ(c.without.rays, counted(scene, with_effect(o, c.effect, false, scene)))
          << int(c.effect);
      EXPECT_GT(c.with.seconds, 0);
      EXPECT_GT(c.without.seconds, 0);
      EXPECT_LE(c.rounds, 5) << "no interval is wanted that takes more";
      EXPECT_GE(c.rounds, 3) << "on slow machines";
      EXPECT_GT(c.factor.low, 0);
      EXPECT_LE(c.factor.low, c.factor.median);
      EXPECT_LE(c.factor.median, c.factor.high);
    }
    EXPECT_EQ(cost(costs, Effect::antialiasing).with.rays.eye, 27u * 40 * 32);
    EXPECT_EQ(cost(costs, Effect::antialiasing).without.rays.eye, 3u * 40 * 32);
    EXPECT_EQ(cost(costs, Effect::depth_of_field).without.rays.eye, 40u * 32);
    EXPECT_EQ(cost(costs, Effect::reflection).without.rays.reflection, 0u);
    EXPECT_GT(cost(costs, Effect::structure).without.rays.tests,
              cost(costs, Effect::structure).without.rays.total());
  }
}

// One sample per pixel: antialiasing and depth of field share it.
TEST(EffectCosts, CountsOneSampleOfThePicture) {
  const Scene scene = small_scene();
  RenderOptions o = small();
  o.samples = 64, o.soft_shadows = true, o.dof = true;
  const RenderSettings s = resolve_options(o, scene);
  const auto accel = build_accel(scene, s.accel, s.one_sided);
  WorkControl control;
  const auto costs = measure_effects(scene, **accel, o, CostOf::sample, control, {}, kLittle);
  ASSERT_TRUE(costs.has_value());
  EXPECT_EQ(costs->of, CostOf::sample);
  for (const EffectCost& c : costs->effects) {
    EXPECT_EQ(c.pixels, 40u * 32);
    EXPECT_EQ(c.with.rays.eye, 40u * 32) << int(c.effect);
    EXPECT_EQ(c.without.rays.eye, 40u * 32) << int(c.effect);
    const double factor = c.effect == Effect::structure ? c.without.seconds / c.with.seconds
                                                        : c.with.seconds / c.without.seconds;
    EXPECT_NEAR(factor, c.factor.median, 1e-9 * factor) << "the three numbers agree";
  }
  const RenderOptions plain = with_effect(o, Effect::soft_shadows, false, scene);
  const RenderSettings without = resolve_options(plain, scene);
  const auto film = make_film(scene, without);
  EXPECT_TRUE(render(scene, **accel, without, **film, control, {.samples = 1}).finished);
  EXPECT_EQ(cost(*costs, Effect::soft_shadows).without.rays.total(), (*film)->rays().total());
}

// Brute force on a tile would take minutes.
TEST(EffectCosts, LeavesOutBruteForceOnMillions) {
  Scene scene = small_scene();
  Object cloud;
  cloud.spheres = std::vector<Sphere>(2000, Sphere{{0, 0, 0}, 0.1f});
  cloud.sphere_materials = std::vector<MaterialId>(2000, 0);
  scene.prototypes.push_back(cloud);
  for (int i = 0; i < 3000; ++i)
    scene.instances.push_back({0, {1, 0, 0, float(i % 60), 0, 1, 0, float(i / 60), 0, 0, 1, 0}});
  RenderOptions o = small();
  const RenderSettings s = resolve_options(o, scene);
  const auto accel = build_accel(scene, s.accel, s.one_sided);
  ASSERT_TRUE(accel.has_value());
  WorkControl control;
  const auto costs = measure_effects(scene, **accel, o, CostOf::sample, control, {}, kLittle);
  ASSERT_TRUE(costs.has_value());
  EXPECT_TRUE(costs->finished);
  EXPECT_EQ(cost(*costs, Effect::structure).presence, EffectCost::too_slow);
  EXPECT_EQ(cost(*costs, Effect::soft_shadows).presence, EffectCost::in_picture);
}

// Runs are repeated until they take the requested time.
TEST(EffectCosts, RunsHaveTheRequestedLength) {
  const Scene scene = small_scene();
  RenderOptions o = small();
  o.no_reflection = o.no_refraction = true;
  const auto accel = build_accel(scene, o.accel);
  WorkControl control;
  const auto start = std::chrono::steady_clock::now();
  const auto costs = measure_effects(scene, **accel, o, CostOf::report, control, {},
                                     {.close_enough = 100, .least_run_s = 0.005});
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  ASSERT_TRUE(costs.has_value());
  double least = 0;
  for (const EffectCost& c : costs->effects) least += 0.005 * c.rounds;
  EXPECT_GE(passed.count(), least);
}

TEST(EffectCosts, IgnoresViewAndNumbersOfSamples) {
  const Scene scene = small_scene();
  RenderOptions o = small();
  o.view = View::normals, o.aa = 0, o.samples = 1000;
  const EffectCosts costs = measured(scene, o);
  EXPECT_TRUE(cost(costs, Effect::antialiasing).on);
  EXPECT_EQ(cost(costs, Effect::antialiasing).with.rays.eye, 9u * 40 * 32);
  EXPECT_GT(cost(costs, Effect::antialiasing).with.rays.shadow, 0u);
}

// Known before the first round.
std::vector<EffectCost::Presence> presence(const Scene& scene, const RenderOptions& options) {
  const auto accel = build_accel(scene, options.accel);
  WorkControl control;
  const auto stop_after_a_round = [&](const EffectCosts& now) {
    for (const EffectCost& c : now.effects) control.stop = control.stop || c.rounds > 0;
  };
  const auto costs = measure_effects(scene, **accel, options, CostOf::report, control,
                                     stop_after_a_round, kLittle);
  std::vector<EffectCost::Presence> all;
  for (const EffectCost& c : costs->effects) {
    all.push_back(c.presence);
    if (c.presence != EffectCost::in_picture) {
      EXPECT_EQ(c.rounds, 0);
    }
  }
  return all;
}

constexpr auto kIn = EffectCost::in_picture;
constexpr auto kNotScene = EffectCost::not_in_scene;
constexpr auto kNotPicture = EffectCost::not_in_picture;

TEST(EffectCosts, ImpossibleEffectsAreNotInTheScene) {
  using Presences = std::vector<EffectCost::Presence>;
  const auto of = [](Contents has) { return presence(small_scene(has), small()); };
  EXPECT_EQ(of({}), (Presences(kEffects.size(), kIn)));
  EXPECT_EQ(of({.mirror = false}),
            (Presences{kIn, kIn, kIn, kNotScene, kIn, kNotScene, kIn, kIn, kIn}));
  EXPECT_EQ(of({.glass = false}),
            (Presences{kIn, kIn, kIn, kIn, kNotScene, kIn, kNotScene, kIn, kIn}));
  EXPECT_EQ(of({.light = false}), (Presences{kIn, kNotScene, kIn, kIn, kIn, kIn, kIn, kIn, kIn}));
  EXPECT_EQ(of({.motion = false}), (Presences{kIn, kIn, kIn, kIn, kIn, kIn, kIn, kNotScene, kIn}));
  Scene empty = small_scene();
  empty.spheres = {}, empty.sphere_materials = {};
  empty.moving_spheres = {}, empty.moving_sphere_materials = {};
  EXPECT_EQ(presence(empty, small()), Presences(kEffects.size(), kNotScene));
}

TEST(EffectCosts, UnusedMaterialsDoNotMatter) {
  Scene s = small_scene();
  s.sphere_materials = std::vector<MaterialId>{0, 0, 0};
  EXPECT_FALSE(is_in_scene(Effect::reflection, s, Fresnel::none));
  EXPECT_FALSE(is_in_scene(Effect::refraction, s, Fresnel::none));
  Mesh mesh;
  mesh.positions = std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = std::vector<TriangleIndices>{{0, 1, 2}};
  mesh.materials = std::vector<MaterialId>{2};
  s.meshes.push_back(mesh);
  EXPECT_TRUE(is_in_scene(Effect::refraction, s, Fresnel::none));
  EXPECT_FALSE(is_in_scene(Effect::reflection, s, Fresnel::none));
  EXPECT_TRUE(is_in_scene(Effect::reflection, s, Fresnel::exact)) << "glass mirrors";
}

TEST(EffectCosts, EffectsThatNoRayShowsAreNotInThePicture) {
  using Presences = std::vector<EffectCost::Presence>;
  RenderOptions o = small();
  o.depth = 1;  // no rays after the eye's
  EXPECT_EQ(presence(small_scene(), o), (Presences{kIn, kIn, kIn, kNotPicture, kNotPicture,
                                                   kNotPicture, kNotPicture, kIn, kIn}));
  o = small();
  o.at = Vec3d(0, -100, 1);  // looks away
  Presences nothing(kEffects.size(), kNotPicture);
  nothing.back() = kIn;  // the structure
  EXPECT_EQ(presence(small_scene(), o), nothing);
  o = small();
  o.no_reflection = true;  // no ray is mirrored that could spread
  EXPECT_EQ(presence(small_scene(), o),
            (Presences{kIn, kIn, kIn, kIn, kIn, kNotPicture, kIn, kIn, kIn}));
}

TEST(EffectCosts, RoughnessComesFromOptionsThenMaterialsThenDefault) {
  Scene scene = small_scene();
  const auto gloss = [&](std::optional<float> given, bool on) {
    RenderOptions o;
    o.gloss = given;
    const RenderOptions found = with_effect(o, Effect::gloss, on, scene);
    EXPECT_EQ(is_on(Effect::gloss, found, scene), on);
    EXPECT_EQ(found.translucency, std::nullopt);
    return found.gloss;
  };
  EXPECT_EQ(gloss({}, true), kUsualRoughness);
  EXPECT_EQ(gloss(0.0f, true), kUsualRoughness);
  EXPECT_EQ(gloss(0.4f, true), 0.4f);
  EXPECT_EQ(gloss({}, false), std::nullopt);
  EXPECT_EQ(gloss(0.4f, false), std::nullopt);
  scene.material_roughness = std::vector<float>{0, 0.2f, 0};
  EXPECT_EQ(gloss({}, true), std::nullopt) << "the materials'";
  EXPECT_EQ(gloss(0.0f, true), std::nullopt);
  EXPECT_EQ(gloss(0.4f, true), 0.4f);
  EXPECT_EQ(gloss({}, false), 0.0f);
  EXPECT_EQ(gloss(0.4f, false), 0.0f);
}

TEST(EffectCosts, WithoutMotionTheShutterClosesWhenItOpens) {
  const Scene scene = small_scene();
  const RenderOptions off = with_effect({}, Effect::motion, false, scene);
  EXPECT_EQ(off.shutter, (std::array{1.0f, 1.0f})) << "the movement's beginning";
  EXPECT_FALSE(is_on(Effect::motion, off, scene));
  EXPECT_EQ(with_effect(off, Effect::motion, true, scene), RenderOptions());
  RenderOptions half;
  half.shutter = {2.0f, 3.0f};
  EXPECT_EQ(with_effect(half, Effect::motion, true, scene), half);
  EXPECT_EQ(with_effect(half, Effect::motion, false, scene).shutter, (std::array{2.0f, 2.0f}));
  const Scene still = small_scene({.motion = false});
  EXPECT_FALSE(is_on(Effect::motion, {}, still));
  EXPECT_EQ(with_effect({}, Effect::motion, true, still), RenderOptions()) << "no conflict";
}

TEST(EffectCosts, StopsOnRequestAndReportsProgress) {
  const Scene scene = small_scene();
  RenderOptions o = small();
  const auto accel = build_accel(scene, o.accel);
  WorkControl control;
  int news = 0;
  double done = 0;
  const auto costs =
      measure_effects(scene, **accel, o, CostOf::report, control, [&](const EffectCosts& now) {
        EXPECT_EQ(now.effects.size(), kEffects.size());
        EXPECT_FALSE(now.finished);
        done = now.done;
        if (++news == 3) control.stop = true;
      });
  ASSERT_TRUE(costs.has_value());
  EXPECT_FALSE(costs->finished);
  EXPECT_EQ(news, 3);
  EXPECT_GT(done, 0);
  EXPECT_LT(done, 1);
}

TEST(EffectCosts, AnIntervalOfTheMedianHoldsIt) {
  EXPECT_EQ(median_interval({3}).median, 3);
  const MedianInterval four = median_interval({4, 1, 3, 2});
  EXPECT_EQ(four.low, 1);
  EXPECT_EQ(four.median, 2.5);
  EXPECT_EQ(four.high, 4);
  // Order statistics of the sign test at 90 %: tables have 1 of 5, 2 of 8, 6 of 20, 18 of 48.
  for (const auto& [n, place] : {std::pair(5, 1), {7, 1}, {8, 2}, {20, 6}, {48, 18}}) {
    std::vector<double> values;
    for (int i = 1; i <= n; ++i) values.push_back(i);
    EXPECT_EQ(median_interval(values).low, place) << n;
    EXPECT_EQ(median_interval(values).high, n + 1 - place) << n;
  }
  // With the stated probability, for a distribution that is not normal.
  std::mt19937 random(1);
  std::exponential_distribution<double> draw(1);
  int held = 0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values(11);
    for (double& v : values) v = draw(random);
    const MedianInterval found = median_interval(values);
    held += found.low <= std::log(2.0) && std::log(2.0) <= found.high;
  }
  EXPECT_GE(held, int(0.9 * kTrials));
}

}  // namespace
}  // namespace raio::core
