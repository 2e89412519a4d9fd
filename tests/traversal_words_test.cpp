// A ray's traversal and shading in words: each step of the log is described, in both languages,
// with the ray's numbers.
#include "view/traversal_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "accel_rays.h"
#include "render/options.h"
#include "scenes.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

using Kind = ExplainedRay::Kind;
using testing::HasSubstr;

RenderSettings settings_of(const Scene& scene, AccelKind kind, RenderOptions o = {}) {
  o.width = 160, o.height = 120;
  o.soft_shadows = true;
  o.accel = {.kind = kind, .counters = true};
  return resolve_options(o, scene);
}

// Calls f(explanation, accel) for pixels chosen at random.
template <class F>
void for_samples(const Scene& scene, AccelKind kind, int pixels, F&& f,
                 const RenderOptions& options = {}) {
  const RenderSettings settings = settings_of(scene, kind, options);
  const auto accel = build_accel(scene, settings.accel);
  ASSERT_TRUE(accel.has_value());
  std::mt19937 rng(11);
  for (int i = 0; i < pixels; ++i) {
    const int x = int(rng() % 160), y = int(rng() % 120);
    const auto e = explain_sample(scene, **accel, settings, x, y, 0);
    ASSERT_TRUE(e.has_value());
    SCOPED_TRACE(testing::Message() << "pixel " << x << "," << y);
    f(*e, **accel);
  }
}

std::string value_of(const TraversalStep& step, std::string_view name) {
  for (const auto& [key, value] : step.variables)
    if (key == name) return value;
  return "";
}
Vec3d vector_of(const std::string& text) {
  Vec3d v;
  const char* at = text.c_str();
  for (int c = 0; c < 3; ++c) {
    char* end = nullptr;
    v[c] = std::strtod(at, &end);
    EXPECT_NE(at, end) << text;
    at = end;
  }
  return v;
}

void expect_told(const ExplainedRay& ray, const TraceLog& log, const Geometry& geometry,
                 AccelKind kind) {
  const std::vector<TraversalStep> steps = traversal_words(ray, log, geometry, kind);
  ASSERT_FALSE(steps.empty());
  size_t tests = 0;
  int last_step = -1;
  std::set<std::string> tested;
  for (const TraversalStep& step : steps) {
    EXPECT_FALSE(step.words.empty());
    if (step.test >= 0) {
      EXPECT_EQ(step.test, int(tests)) << "in the order of the log";
      ++tests;
      EXPECT_EQ(log.tests[size_t(step.test)].repeated, step.formula.empty());
    }
    EXPECT_TRUE(step.log_step == last_step || step.log_step == last_step + 1);
    last_step = step.log_step;
  }
  EXPECT_EQ(last_step, int(log.steps.size()) - 1);
  // Boxes behind the hit are not entered.
  for (size_t k = 1; k < steps.size(); ++k) {
    if (!steps[k - 1].words.ends_with("none of its children is hit") || steps[k].log_step < 0)
      continue;
    EXPECT_LE(log.steps[size_t(steps[k].log_step)].depth, 1);
  }
  const auto repeated = size_t(std::ranges::count_if(log.tests, &TraceLog::Test::repeated));
  EXPECT_EQ(tests + log.unlisted, log.count_tests() + repeated);
  const TraversalStep& end = steps.back();
  EXPECT_EQ(end.test, -1);
  if (ray.hit.found()) {
    EXPECT_THAT(end.words, HasSubstr(fmt::format(
                               "{} {} at t = {:.4g}",
                               kPrimitiveKindNames[size_t(geometry.kind_of(ray.hit.primitive))],
                               geometry.index_of(ray.hit.primitive), ray.hit.t)));
    EXPECT_GE(end.t, double(ray.hit.t) * (1 - 1e-6));
  }
  if (kind != AccelKind::grid) return;
  for (size_t k = 1; k < steps.size(); ++k) EXPECT_GE(steps[k].t, steps[k - 1].t);
}

// A hit found by a separate trace, as for a sample's ray.
ExplainedRay ray_of(const Accel& accel, const Ray& ray, bool any) {
  RayBatch one;
  one.push(ray);
  TraceContext context;
  HitBatch hits;
  hits.reset(1);
  ExplainedRay out{.kind = any ? Kind::shadow : Kind::eye, .ray = ray};
  if (!any) accel.closest(one, hits, context), out.hit = hits[0];
  return out;
}

TEST(TraversalWords, DescribeEveryStepAndTest) {
  const Scene scene = tests::random_scene(400, 3);
  const RayBatch rays = tests::awkward_rays(scene, 400, 9);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh}) {
    const auto accel = build_accel(scene, {.kind = kind, .counters = true});
    ASSERT_TRUE(accel.has_value());
    for (size_t i = 0; i < rays.size(); ++i)
      for (const bool any : {false, true}) {
        SCOPED_TRACE(testing::Message() << "ray " << i << " any " << any);
        const auto log = (*accel)->log(rays[i], any);
        ASSERT_TRUE(log.has_value());
        expect_told(ray_of(**accel, rays[i], any), *log, (*accel)->geometry(), kind);
      }
  }
}

TEST(TraversalWords, DescribeTheRaysOfASample) {
  const Scene scene = tests::random_scene(60, 7);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh})
    for_samples(scene, kind, 20, [&](const Explanation& e, const Accel& accel) {
      for (const ExplainedRay& ray : e.rays) {
        if (!ray.traced) {
          EXPECT_EQ(traversal_words(ray, {}, accel.geometry(), kind).size(), 1u);
          continue;
        }
        const auto log = accel.log(ray.ray, ray.kind == Kind::shadow);
        ASSERT_TRUE(log.has_value());
        expect_told(ray, *log, accel.geometry(), kind);
      }
    });
}

// A row of 4 cells of length 1, with spheres in the first, third and last.
TEST(TraversalWords, DescribeAKnownTraversal) {
  Scene scene;
  scene.materials = {{}};
  scene.spheres = {
      {{0.25f, 0.5f, 0.5f}, 0.25f}, {{2.5f, 0.5f, 0.5f}, 0.25f}, {{3.75f, 0.5f, 0.5f}, 0.25f}};
  scene.sphere_materials = {0, 0, 0};
  const auto accel =
      build_accel(scene, {.kind = AccelKind::grid, .grid_resolution = {4, 1, 1}, .counters = true});
  ASSERT_TRUE(accel.has_value());
  const Ray ray{{-1, 0.73f, 0.73f}, {1, 0, 0}};  // past all spheres, through all cells
  auto log = (*accel)->log(ray, false);
  auto steps =
      traversal_words(ray_of(**accel, ray, false), *log, (*accel)->geometry(), AccelKind::grid);
  EXPECT_EQ(steps.front().words, "The ray enters the grid in cell (0, 0, 0) at t = 1");
  EXPECT_NEAR(std::atof(value_of(steps.front(), "tMax.x").c_str()), 2, 1e-4);
  EXPECT_EQ(value_of(steps.front(), "tDelta.x"), "1");
  EXPECT_EQ(value_of(steps.front(), "tDelta.y"), "inf");
  EXPECT_EQ(value_of(steps.front(), "step.x"), "+1");
  EXPECT_EQ(value_of(steps.front(), "step.y"), "0");
  EXPECT_THAT(steps.back().words, HasSubstr("the ray leaves the grid at t = 5"));

  const Ray middle{{1.5f, 0.5f, 0.5f}, {1, 0, 0}};
  log = (*accel)->log(middle, false);
  steps =
      traversal_words(ray_of(**accel, middle, false), *log, (*accel)->geometry(), AccelKind::grid);
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[0].words, "The ray starts in cell (1, 0, 0) of the grid");
  EXPECT_THAT(steps[1].words,
              HasSubstr("tMax.x is the smallest: go one cell along x, to (2, 0, 0)"));
  EXPECT_EQ(steps[1].formula, "x := x + step.x\ntMax.x := tMax.x + tDelta.x");
  EXPECT_EQ(steps[2].words, "Test sphere 1: hit at t = 0.75, the nearest so far");
  EXPECT_EQ(
      steps[3].words,
      "The hit of sphere 1 at t = 0.75 lies in this cell (t <= min tMax), so the traversal ends");
  log = (*accel)->log(middle, true);
  steps =
      traversal_words(ray_of(**accel, middle, true), *log, (*accel)->geometry(), AccelKind::grid);
  EXPECT_EQ(steps.back().words,
            "Any hit ends the traversal of a shadow ray: sphere 1 is in front of the light");
}

// One number, or one for each of red, green and blue.
Rgb rgb_of(const std::string& text) {
  return text.find(' ') == std::string::npos ? Rgb(std::strtof(text.c_str(), nullptr))
                                             : Rgb(vector_of(text));
}

// A ray's weight is its parent's times the factors named by the step.
void expect_weight(const TraversalStep& step, Rgb before, const std::string& weight) {
  Rgb expected = before;
  for (const char* factor : {"Ks", "specular", "Kr", "T", "1 - Kr"})
    if (const std::string v = value_of(step, factor); !v.empty()) expected = expected * rgb_of(v);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb_of(weight)[c], expected[c], 2e-5) << step.formula;
}

bool has_child_along(const Explanation& e, size_t parent, Kind kind, Vec3d dir) {
  return std::ranges::any_of(e.rays, [&](const ExplainedRay& r) {
    return r.parent == int(parent) && r.kind == kind && length(Vec3d(r.ray.dir) - dir) < 1e-4;
  });
}

// A light's terms follow from the variables of their steps.
void expect_light(const TraversalStep& step) {
  const auto expect = [](Rgb expected, const std::string& told) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb_of(told)[c], expected[c], 1e-4f) << told;
  };
  if (const std::string term = value_of(step, "diffuse"); !term.empty()) {
    const Vec3d n = vector_of(value_of(step, "N")), l = vector_of(value_of(step, "L"));
    const float cosine = rgb_of(value_of(step, "N.L")).x;
    EXPECT_NEAR(cosine, dot(n, l), 1e-4);
    expect(rgb_of(value_of(step, "I")) * rgb_of(value_of(step, "colour")) *
               (rgb_of(value_of(step, "Kd")).x * cosine),
           term);
  }
  const std::string term = value_of(step, "highlight");
  if (term.empty()) return;
  const bool halfway = value_of(step, "R").empty();
  const float cosine = rgb_of(value_of(step, halfway ? "N.H" : "R.V")).x;
  const float power = rgb_of(value_of(step, halfway ? "(N.H)^Shine" : "(R.V)^Shine")).x;
  EXPECT_NEAR(power, std::pow(std::clamp(cosine, 0.0f, 1.0f), rgb_of(value_of(step, "Shine")).x),
              1e-3);
  const std::string tint = value_of(step, "specular");
  expect(rgb_of(value_of(step, "I")) * (tint.empty() ? Rgb(1) : rgb_of(tint)) *
             (rgb_of(value_of(step, "Ks")).x * power),
         term);
}

// "ambient", "diffuse" and "highlight" add up to "C", and times the weight to the contribution.
void expect_sums(const Scene& scene, const RenderOptions& options) {
  size_t surfaces = 0, mirrors = 0, refractions = 0;
  const RenderSettings settings = settings_of(scene, AccelKind::bvh, options);
  const auto check = [&](const Explanation& e, const Accel&) {
    for (size_t i = 0; i < e.rays.size(); ++i) {
      const ExplainedRay& ray = e.rays[i];
      const std::vector<TraversalStep> steps = shading_words(e, scene, settings, i);
      ASSERT_FALSE(steps.empty());
      if (ray.kind == Kind::shadow) continue;
      Vec3d sum, told;
      for (const TraversalStep& step : steps) {
        for (const char* term : {"ambient", "diffuse", "highlight", "background"})
          if (const std::string v = value_of(step, term); !v.empty()) sum = sum + vector_of(v);
        if (const std::string v = value_of(step, "C"); !v.empty()) told = vector_of(v);
        expect_light(step);
        if (const std::string v = value_of(step, "R"), w = value_of(step, "weight'");
            !v.empty() && !w.empty()) {
          ++mirrors;
          expect_weight(step, ray.weight, w);
          const Vec3d d(ray.ray.dir), n = vector_of(value_of(step, "N"));
          EXPECT_LT(length(vector_of(v) - (d - n * (2 * dot(d, n)))), 1e-4);
          EXPECT_TRUE(has_child_along(e, i, Kind::reflection, vector_of(v)));
        }
        if (const std::string v = value_of(step, "D'"); !v.empty()) {
          ++refractions;
          expect_weight(step, ray.weight, value_of(step, "weight'"));
          const double eta = std::atof(value_of(step, "eta").c_str());
          const double c = std::atof(value_of(step, "c").c_str());
          const double k = std::atof(value_of(step, "k").c_str());
          const Vec3d d(ray.ray.dir), n = vector_of(value_of(step, "N"));
          EXPECT_LT(length(vector_of(v) - (d * eta + n * (eta * c - std::sqrt(k)))), 1e-4);
          EXPECT_TRUE(has_child_along(e, i, Kind::refraction, vector_of(v)));
        }
      }
      surfaces += ray.surface.has_value();
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sum[c], told[c], 1e-5 * (1 + std::abs(sum[c])));
        EXPECT_NEAR(told[c] * double(ray.weight[c]), ray.adds[c], 1e-5 * (1 + std::abs(told[c])));
      }
    }
  };
  for_samples(scene, AccelKind::bvh, 2000, check, options);
  EXPECT_GT(surfaces, 50u);
  EXPECT_GT(mirrors, 10u);
  EXPECT_GT(refractions, 10u);
}

// Kr and the cosines follow from the indices of refraction, by Fresnel's equations in their usual
// form.
TEST(TraversalWords, TheReflectanceFollowsFromTheIndices) {
  const Scene scene = tests::random_scene(60, 7);
  RenderOptions options;
  options.fresnel = Fresnel::exact;
  const RenderSettings settings = settings_of(scene, AccelKind::bvh, options);
  size_t splits = 0, totals = 0;
  const auto check = [&](const Explanation& e, const Accel&) {
    for (size_t i = 0; i < e.rays.size(); ++i)
      for (const TraversalStep& step : shading_words(e, scene, settings, i)) {
        const std::string kr = value_of(step, "Kr");
        if (kr.empty()) continue;
        const auto value = [&](const char* name) {
          return std::atof(value_of(step, name).c_str());
        };
        if (value_of(step, "c'").empty()) {
          EXPECT_EQ(kr, "1");
          ++totals;
          continue;
        }
        const double n = value("n"), m = value("n'"), c = value("c"), b = value("c'");
        EXPECT_NEAR(n * n * (1 - c * c), m * m * (1 - b * b), 1e-4) << "Snell's law";
        const double s = (n * c - m * b) / (n * c + m * b), p = (n * b - m * c) / (n * b + m * c);
        EXPECT_NEAR(std::atof(kr.c_str()), (s * s + p * p) / 2, 1e-3);
        ++splits;
      }
  };
  for_samples(scene, AccelKind::bvh, 1000, check, options);
  EXPECT_GT(splits, 20u);
  EXPECT_GT(totals, 2u);
}

TEST(TraversalWords, TermsOfTheShadingAddUp) { expect_sums(tests::random_scene(60, 7), {}); }

TEST(TraversalWords, TermsOfOtherShadingModelsAddUp) {
  Scene scene = tests::random_scene(60, 7);
  for (const bool tinted : {false, true}) {
    for (size_t m = 0; tinted && m < scene.materials.size(); ++m)
      scene.material_specular.push_back({1, 0.25f * float(m % 4), 0.5f});
    for (const Fresnel fresnel : {Fresnel::none, Fresnel::exact, Fresnel::schlick}) {
      RenderOptions options;
      options.shading = ShadingModel::blinn_phong, options.fresnel = fresnel;
      expect_sums(scene, options);
    }
  }
}

// Texts.AllAreInPortuguese knows that the table has all; this, that all is taken from the table.
TEST(TraversalWords, AreAllTranslated) {
  const Scene scene = tests::random_scene(60, 7);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh}) {
    RenderOptions options;
    if (kind == AccelKind::grid) options.shading = ShadingModel::blinn_phong;
    if (kind == AccelKind::grid) options.gloss = options.translucency = 0.1f;
    const RenderSettings settings = settings_of(scene, kind, options);
    const auto check = [&](const Explanation& e, const Accel& accel) {
      for (size_t i = 0; i < e.rays.size(); ++i) {
        const ExplainedRay& ray = e.rays[i];
        const TraceLog log = accel.log(ray.ray, ray.kind == Kind::shadow).value();
        for (const bool walk : {true, false}) {
          const auto told = [&](Language language) {
            set_language(language);
            auto steps = walk ? traversal_words(ray, log, accel.geometry(), kind)
                              : shading_words(e, scene, settings, i);
            set_language(Language::english);
            return steps;
          };
          const auto english = told(Language::english), portuguese = told(Language::portuguese);
          ASSERT_EQ(english.size(), portuguese.size());
          for (size_t k = 0; k < english.size(); ++k) {
            EXPECT_NE(english[k].words, portuguese[k].words);
            EXPECT_EQ(english[k].formula, portuguese[k].formula);
          }
        }
      }
    };
    for_samples(scene, kind, 10, check, options);
  }
}

}  // namespace
}  // namespace raio::core::view
