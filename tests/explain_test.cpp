// A sample explained ray by ray: its terms add up to the rendered pixel, exactly, and each ray's
// log to the counts.
#include "integrate/explain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>

#include "accel_rays.h"
#include "integrate/classic.h"
#include "io/scene_file.h"
#include "render/options.h"
#include "render/render.h"
#include "scenes.h"

namespace raio::core {
namespace {

using Kind = ExplainedRay::Kind;

RenderSettings all_effects(const Scene& scene, AccelKind kind, RenderOptions o = {}) {
  o.width = 160, o.height = 120;
  o.aa = 2, o.lens_samples = 2;
  o.soft_shadows = true, o.dof = true;
  o.accel.kind = kind;
  o.accel.counters = true;
  return resolve_options(o, scene);
}

// The film's sum for each surface, recomputed from the terms of its rays.
Vec3d sum_of_terms(const Explanation& e, double scale) {
  Vec3d sum;
  for (size_t i = 0; i < e.rays.size(); ++i) {
    const ExplainedRay& r = e.rays[i];
    if (r.kind == Kind::shadow) continue;
    Rgb radiance = r.surface ? r.ambient : r.background;
    for (const ExplainedRay& s : e.rays)
      if (s.kind == Kind::shadow && s.parent == int(i) && !s.occluded)
        radiance = radiance + Rgb(s.diffuse + s.highlight);
    for (int c = 0; c < 3; ++c)
      sum[c] += std::nearbyint(double(radiance[c] * r.weight[c]) * scale) / scale;
  }
  return sum;
}

std::unique_ptr<Film> rendered_pixel(const Scene& scene, const Accel& accel,
                                     RenderSettings settings, int x, int y) {
  settings.crop = Crop{x, y, x + 1, y + 1};
  auto film = make_film(scene, settings);
  EXPECT_TRUE(film.has_value());
  WorkControl control;
  render(scene, accel, settings, **film, control);
  return std::move(*film);
}

// Pixels of a scene, chosen at random.
void expect_pixels_explained(const Scene& scene, AccelKind kind, int pixels, uint32_t seed,
                             const RenderOptions& models = {}) {
  const RenderSettings settings = all_effects(scene, kind, models);
  const auto accel = build_accel(scene, settings.accel);
  ASSERT_TRUE(accel.has_value());
  const double scale = Film(1, 1, classic_bound(scene, settings)).scale();
  const auto n = uint32_t(settings.samples_per_pixel());
  std::mt19937 rng(seed);
  for (int k = 0; k < pixels; ++k) {
    const int x = int(rng() % uint32_t(settings.width)), y = int(rng() % uint32_t(settings.height));
    SCOPED_TRACE(testing::Message() << scene.name << " pixel " << x << "," << y);
    Vec3d rgb;
    RayCounts counts;
    uint64_t steps = 0, tests = 0;
    for (uint32_t s = 0; s < n; ++s) {
      const auto e = explain_sample(scene, **accel, settings, x, y, s);
      ASSERT_TRUE(e.has_value());
      EXPECT_EQ(sum_of_terms(*e, scale), e->rgb);
      rgb = rgb + e->rgb;
      counts += e->counts;
      for (const ExplainedRay& r : e->rays) {
        if (!r.traced) continue;
        const bool shadow = r.kind == Kind::shadow;
        const auto log = (*accel)->log(r.ray, shadow);
        ASSERT_TRUE(log.has_value());
        steps += log->count_steps(), tests += log->count_tests();
        // The last nearest one is the hit, or the blocker of a shadow ray.
        PrimitiveId last = kNoPrimitive;
        for (const TraceLog::Test& test : log->tests)
          if (test.nearest) last = test.primitive;
        EXPECT_EQ(last != kNoPrimitive, shadow ? r.occluded : r.hit.found());
        EXPECT_TRUE(shadow || last == r.hit.primitive);
      }
    }
    const auto film = rendered_pixel(scene, **accel, settings, x, y);
    EXPECT_EQ(Rgb(rgb / double(n)), film->resolve().at(0, 0));
    const RayCounts rendered = film->rays();
    EXPECT_EQ(counts, rendered);
    if (kind == AccelKind::bvh) continue;  // its rays share work
    EXPECT_EQ(steps, rendered.steps);
    EXPECT_EQ(tests, rendered.tests);
  }
}

// RAIO_EXPLAIN_PIXELS: the number of pixels per shared scene; more take longer.
int pixels_of_each() {
  const char* const text = std::getenv("RAIO_EXPLAIN_PIXELS");
  return text ? std::atoi(text) : 3;
}

TEST(Explain, TermsAddUpToThePixelAndLogsToTheCounts) {
  const Scene scene = tests::random_scene(60, 7);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh})
    expect_pixels_explained(scene, kind, 40, 1);
}

TEST(Explain, TermsAddUpInTheOtherShadingModels) {
  const Scene scene = tests::random_scene(60, 7);
  for (const ShadingModel shading : {ShadingModel::phong, ShadingModel::blinn_phong})
    for (const Fresnel fresnel : {Fresnel::exact, Fresnel::schlick}) {
      RenderOptions models;
      models.shading = shading, models.fresnel = fresnel;
      expect_pixels_explained(scene, AccelKind::grid, 20, 1, models);
    }
}

TEST(Explain, TermsAddUpWhereMirrorsHaveColours) {
  Scene scene = tests::random_scene(60, 7);
  for (size_t m = 0; m < scene.materials.size(); ++m)
    scene.material_specular.push_back({1, 0.25f * float(m % 4), 0.5f});
  RenderOptions models;
  expect_pixels_explained(scene, AccelKind::grid, 20, 1, models);
  models.shading = ShadingModel::blinn_phong, models.fresnel = Fresnel::schlick;
  expect_pixels_explained(scene, AccelKind::bvh, 20, 2, models);
}

TEST(Explain, TermsAddUpInTheSharedScenes) {
  const auto paths = tests::shared_scenes();
  if (paths.empty()) GTEST_SKIP() << "the shared scenes are not here";
  for (const auto& path : paths) {
    const auto read = read_scene(path.string());
    ASSERT_TRUE(read.has_value()) << path;
    for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh})
      expect_pixels_explained(read->scene, kind, pixels_of_each(), 5);
  }
}

// A floor and a mirror below an emitting square, a lamp, a glass ball, in a world with a picture.
Scene path_scene() {
  Scene scene = tests::random_scene(20, 7);
  const auto emitter = MaterialId(scene.materials.size());
  scene.add_material({.color = Rgb(0.5f), .kd = 1, .ior = 1.5f});
  scene.set_standard_surface({.emission = {3, 2, 1}});
  scene.add_material({.color = {0.2f, 0.7f, 0.9f}, .kd = 1, .ior = 1.5f});
  scene.set_standard_surface({.roughness = 0.2f,
                              .transmission = 0.9f,
                              .is_thin = 0,
                              .attenuation_color = {0.9f, 0.5f, 0.8f},
                              .attenuation_distance = 1});
  Mesh mesh;
  mesh.positions = {{-2, -2, 3}, {2, -2, 3}, {2, 2, 3}, {-2, 2, 3}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.materials = {emitter};
  scene.meshes.push_back(mesh);
  scene.spheres.push_back({{0, 0, 0}, 0.8f}), scene.sphere_materials.push_back(emitter + 1);
  scene.environment = {{.width = 3, .height = 2}};
  scene.environment_texels = {Rgb(1), Rgb(0), Rgb(0.5f), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return scene;
}

// The weights of multiple importance sampling follow from the densities, the radiance of surfaces
// and the weights of rays from the terms, and all rays add up to the pixel.
TEST(Explain, PathsAddUpToThePixel) {
  const Scene scene = path_scene();
  RenderOptions options;
  options.width = 80, options.height = 60, options.samples = 4, options.depth = 9;
  options.integrator = IntegratorKind::path;
  options.accel.kind = AccelKind::bvh, options.accel.counters = true;
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  ASSERT_TRUE(accel.has_value());
  std::mt19937 rng(3);
  std::array<size_t, 5> seen{};
  const auto near = [](Rgb a, Rgb b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 2e-6f * (1 + std::abs(b[c])));
  };
  for (int k = 0; k < 40; ++k) {
    const int x = int(rng() % 80), y = int(rng() % 60);
    SCOPED_TRACE(testing::Message() << "pixel " << x << "," << y);
    Vec3d rgb;
    RayCounts counts;
    for (uint32_t s = 0; s < 4; ++s) {
      const auto e = explain_sample(scene, **accel, settings, x, y, s);
      ASSERT_TRUE(e.has_value());
      rgb = rgb + e->rgb, counts += e->counts;
      std::vector<Rgb> direct(e->rays.size());
      for (const ExplainedRay& r : e->rays) {
        if (r.kind == Kind::eye) continue;
        const ExplainedRay& from = e->rays[size_t(r.parent)];
        const ExplainedRay::Bounce& b = *from.bounce;
        if (r.kind == Kind::shadow) {
          if (!r.occluded) direct[size_t(r.parent)] = b.direct, ++seen[0];
          const float p = b.light_density, q = b.light_bsdf_density;
          EXPECT_NEAR(b.light_weight, p > 0 ? p / (p + q) : 1, 1e-6f);
          near(b.direct, b.transmittance * b.light_bsdf * b.light_radiance * b.light_weight);
          EXPECT_GT(b.light_probability, 0);
          continue;
        }
        near(r.weight, from.weight * b.weight / b.chance);
        seen[1] += b.chance < 1;
        EXPECT_EQ(dot(r.ray.dir, from.surface->geometric) < 0, r.kind == Kind::refraction);
        const float density = b.density;
        if (r.escape) {
          ++seen[2];
          const float other = r.escape->light_density;
          EXPECT_NEAR(r.escape->weight, density > 0 ? density / (density + other) : 1, 1e-6f);
        } else if (r.bounce && r.bounce->emission != Rgb()) {
          ++seen[3];
          const float other = r.bounce->emission_density;
          EXPECT_NEAR(r.bounce->emission_weight, density > 0 ? density / (density + other) : 1,
                      1e-6f);
        }
        seen[4] += b.transmittance != Rgb(1);
      }
      for (size_t i = 0; i < e->rays.size(); ++i) {
        const auto& b = e->rays[i].bounce;
        if (!b) continue;
        EXPECT_EQ(e->rays[i].surface->radiance,
                  b->transmittance * (b->emission * b->emission_weight) + direct[i]);
      }
    }
    const auto film = rendered_pixel(scene, **accel, settings, x, y);
    EXPECT_EQ(Rgb(rgb / 4), film->resolve().at(0, 0));
    EXPECT_EQ(counts, film->rays());
  }
  for (const size_t count : seen) EXPECT_GT(count, 0u);
}

// The cost of a single ray equals its log.
TEST(Explain, LogsMatchTheCostOfASingleRay) {
  const Scene scene = tests::random_scene(400, 3);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh}) {
    const auto accel = build_accel(scene, {.kind = kind, .counters = true});
    ASSERT_TRUE(accel.has_value());
    const RayBatch rays = tests::awkward_rays(scene, 500, 9);
    for (size_t i = 0; i < rays.size(); ++i)
      for (const bool any : {false, true}) {
        RayBatch one;
        one.push(rays[i]);
        TraceContext context;
        HitBatch hits;
        hits.reset(1);
        uint8_t occluded[kBatchPad];
        if (any)
          (*accel)->occluded(one, occluded, context);
        else
          (*accel)->closest(one, hits, context);
        const auto log = (*accel)->log(rays[i], any);
        ASSERT_TRUE(log.has_value());
        EXPECT_EQ(log->count_steps(), context.steps);
        if (kind != AccelKind::none || !any) {
          EXPECT_EQ(log->count_tests(), context.tests);
        }
      }
  }
}

// The cells are face neighbours in sequence, and each is left where the smallest t_max says.
TEST(Explain, CellsMatchTheTextbook) {
  const Scene scene = tests::random_scene(400, 3);
  const auto accel = build_accel(
      scene, {.kind = AccelKind::grid, .grid_resolution = {60, 45, 80}, .counters = true});
  ASSERT_TRUE(accel.has_value());
  const RayBatch rays = tests::awkward_rays(scene, 300, 4);
  size_t moves = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto log = (*accel)->log(rays[i], false);
    for (size_t k = 1; k < log->steps.size(); ++k, ++moves) {
      const TraceLog::Step &from = log->steps[k - 1], &to = log->steps[k];
      int moved = 0, axis = 0;
      for (int a = 0; a < 3; ++a)
        if (const int by = std::abs(to.cell[size_t(a)] - from.cell[size_t(a)]))
          moved += by, axis = a;
      EXPECT_EQ(moved, 1);
      EXPECT_EQ(from.t_max[axis], std::min({from.t_max.x, from.t_max.y, from.t_max.z}));
      EXPECT_NEAR(to.t_max[axis], from.t_max[axis] + log->t_delta[axis],
                  1e-9 * (1 + std::abs(to.t_max[axis])));
    }
  }
  EXPECT_GT(moves, 1000u);
}

// Boxes contain their children's, and every leaf is below an earlier node.
TEST(Explain, BoxesOfATreeNarrow) {
  const Scene scene = tests::random_scene(400, 3);
  const auto accel = build_accel(scene, {.kind = AccelKind::bvh});
  const RayBatch rays = tests::awkward_rays(scene, 100, 4);
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto log = (*accel)->log(rays[i], false);
    for (const TraceLog::Step& step : log->steps) {
      EXPECT_FALSE(step.box.empty());
      EXPECT_EQ(step.depth == 0, &step == &log->steps[0]);
      for (int a = 0; a < 3; ++a) {
        EXPECT_GE(step.box.lo[a], log->steps[0].box.lo[a]);
        EXPECT_LE(step.box.hi[a], log->steps[0].box.hi[a]);
      }
    }
  }
}

// From within shells of glass that mirrors, every ray has two children until one is outside.
TEST(Explain, TooManyRaysAreRefused) {
  Scene scene;
  scene.materials = {{{1, 1, 1}, 0.1f, 0.5f, 10, 0.5f, 1.1f}};
  for (int i = 1; i <= 20; ++i) {
    scene.spheres.push_back({{}, float(i)});
    scene.sphere_materials.push_back(0);
  }
  scene.camera.from = {0.1f, 0.2f, 0.3f};
  scene.camera.at = {1, 0, 0};
  scene.camera.up = {0, 0, 1};
  RenderSettings settings = all_effects(scene, AccelKind::bvh);
  const auto accel = build_accel(scene, settings.accel);
  settings.depth = 8;
  const auto few = explain_sample(scene, **accel, settings, 5, 5, 0);
  ASSERT_TRUE(few.has_value());
  EXPECT_GT(few->rays.size(), 200u);
  settings.depth = kMaxDepth;
  const auto many = explain_sample(scene, **accel, settings, 5, 5, 0);
  ASSERT_FALSE(many.has_value());
  EXPECT_EQ(many.error().kind, ErrorKind::no_resource);
}

}  // namespace
}  // namespace raio::core
