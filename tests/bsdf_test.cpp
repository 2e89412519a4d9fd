// How surfaces scatter light (integrate/bsdf-inl.h): conservation of energy, reciprocity, and
// samples against their density, with every instruction set of this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "../tests/bsdf_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/bsdf-inl.h"
#include "sanitized.h"

#ifndef RAIO_TESTS_BSDF_TEST_
#define RAIO_TESTS_BSDF_TEST_
namespace raio::core {

// Lobes of one surface.
struct TestLobes {
  std::string name;
  float diffuse = 0, mirror = 0, edge = 0, coat = 0, cover = 0, glass = 0, tint = 1;
  float roughness = 1, ior = 1.5f;
  bool thin = false, leaving = false;
  float clearcoat = 0, clearcoat_roughness = 0, sheen = 0, sheen_roughness = 0;

  bool has_layers() const { return clearcoat > 0 || sheen > 0; }
  float eta() const { return leaving ? 1 / ior : ior; }
  // The same surface, seen from the other side.
  TestLobes behind() const {
    TestLobes other = *this;
    other.leaving = !leaving;
    return other;
  }
};

struct BsdfAnswer {
  Vec3f in;
  float value = 0, pdf = 0;  // of samples: weight instead of value
  bool through = false;
};

}  // namespace raio::core
#endif

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Answers for directions, or for samples with numbers x, y of the square and choice z.
void ask_bsdf(const TestLobes& t, EnergyTables& tables, Vec3f out, bool samples,
              const std::vector<Vec3f>& questions, std::vector<BsdfAnswer>& answers) {
  const EnergyTables::Layers layers = {t.clearcoat, t.clearcoat_roughness, t.sheen,
                                       t.sheen_roughness};
  const uint32_t conductor = tables.conductor(layers);
  EnergyTables::Dielectric of_ior{conductor, conductor, conductor};
  if (t.ior != 1) of_ior = tables.dielectric(t.ior, layers, t.glass > 0);
  if (t.thin) of_ior.entering = of_ior.leaving = conductor;
  const auto wide = [](float x) { return hn::Set(d, x); };
  const Lobes lobes = {.diffuse = set3(d, Rgb(t.diffuse)),
                       .mirror = set3(d, Rgb(t.mirror)),
                       .mirror_edge = wide(t.edge),
                       .coat = set3(d, Rgb(t.coat)),
                       .cover = wide(t.cover),
                       .glass = wide(t.glass),
                       .tint = set3(d, Rgb(t.tint)),
                       .roughness = wide(t.roughness),
                       .ior = wide(t.ior),
                       .eta = wide(t.eta()),
                       .thin = hn::Gt(wide(t.thin ? 1.f : 0.f), hn::Zero(d)),
                       .conductor = hn::Set(du, conductor),
                       .reflection = hn::Set(du, of_ior.reflection),
                       .front = hn::Set(du, t.leaving ? of_ior.leaving : of_ior.entering),
                       .back = hn::Set(du, t.leaving ? of_ior.entering : of_ior.leaving),
                       .clearcoat = wide(t.clearcoat),
                       .clearcoat_roughness = wide(t.clearcoat_roughness),
                       .clearcoat_normal = set3(d, Vec3f(0, 0, 1)),
                       .sheen = set3(d, Rgb(t.sheen)),
                       .sheen_roughness = wide(t.sheen_roughness),
                       .layers = hn::Set(du, t.has_layers() ? tables.layers(layers) : 0)};
  const Bsdf bsdf(lobes, set3(d, out), tables);
  answers.resize(questions.size());
  for (size_t i = 0; i < questions.size(); i += kWidth) {
    HWY_ALIGN float at[3][kWidth], found[6][kWidth];
    const size_t lanes = std::min(kWidth, questions.size() - i);
    for (size_t k = 0; k < kWidth; ++k)
      for (size_t c = 0; c < 3; ++c) at[c][k] = questions[i + std::min(k, lanes - 1)][int(c)];
    const V3 question = {hn::Load(d, at[0]), hn::Load(d, at[1]), hn::Load(d, at[2])};
    BsdfSample s = {.in = question, .weight = {}, .pdf = {}, .through = hn::FirstN(d, 0)};
    if (samples) {
      s = bsdf.sample({question.x, question.y}, question.z);
    } else {
      const BsdfValue v = bsdf.evaluate(question);
      s.weight = v.value, s.pdf = v.pdf;
    }
    const V through = hn::IfThenElseZero(s.through, hn::Set(d, 1));
    const V columns[] = {s.in.x, s.in.y, s.in.z, s.weight.x, s.pdf, through};
    for (size_t c = 0; c < 6; ++c) hn::Store(columns[c], d, found[c]);
    for (size_t k = 0; k < lanes; ++k)
      answers[i + k] = {
          {found[0][k], found[1][k], found[2][k]}, found[3][k], found[4][k], found[5][k] > 0};
  }
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {
namespace {

HWY_EXPORT(ask_bsdf);
using std::numbers::pi;
using Answers = std::vector<BsdfAnswer>;

Answers ask(const TestLobes& lobes, Vec3f out, bool samples, const std::vector<Vec3f>& questions) {
  static EnergyTables tables;
  Answers answers;
  HWY_DYNAMIC_DISPATCH(ask_bsdf)(lobes, tables, out, samples, questions, answers);
  return answers;
}
Answers evaluated(const TestLobes& lobes, Vec3f out, const std::vector<Vec3f>& in) {
  return ask(lobes, out, false, in);
}
Answers sampled(const TestLobes& lobes, Vec3f out, const std::vector<Vec3f>& numbers) {
  return ask(lobes, out, true, numbers);
}

Vec3f direction(double cosine, double azimuth) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return Vec3f(Vec3d(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine));
}

// Surfaces that absorb nothing, with clear coats of at least this roughness.
std::vector<TestLobes> white_lobes(float roughness = 0) {
  std::vector<TestLobes> all = {
      {.name = "diffuse", .diffuse = 1},
      {.name = "metal", .mirror = 1, .edge = 1},
      {.name = "coat", .diffuse = 1, .coat = 1, .cover = 1},
      {.name = "glass", .glass = 1},
      {.name = "glass from inside", .glass = 1, .leaving = true},
      {.name = "dense glass", .glass = 1, .ior = 2.4f},
      {.name = "dense glass from inside", .glass = 1, .ior = 2.4f, .leaving = true},
      {.name = "thin glass", .glass = 1, .thin = true},
      {.name = "metal and coat",
       .diffuse = 0.5f,
       .mirror = 0.5f,
       .edge = 0.5f,
       .coat = 0.5f,
       .cover = 1},
      {.name = "all",
       .diffuse = 0.25f,
       .mirror = 0.25f,
       .edge = 0.25f,
       .coat = 0.25f,
       .cover = 1,
       .glass = 0.5f},
      {.name = "all from inside",
       .diffuse = 0.25f,
       .mirror = 0.25f,
       .edge = 0.25f,
       .coat = 0.25f,
       .cover = 1,
       .glass = 0.5f,
       .leaving = true},
      {.name = "smooth clearcoat", .diffuse = 1, .clearcoat = 1},
      {.name = "clearcoat on plastic",
       .diffuse = 1,
       .coat = 1,
       .cover = 1,
       .clearcoat = 1,
       .clearcoat_roughness = 0.3f},
      {.name = "clearcoat on metal",
       .mirror = 1,
       .edge = 1,
       .clearcoat = 1,
       .clearcoat_roughness = 0.1f},
      {.name = "half a clearcoat",
       .diffuse = 0.5f,
       .mirror = 0.5f,
       .edge = 0.5f,
       .coat = 0.5f,
       .cover = 1,
       .clearcoat = 0.5f,
       .clearcoat_roughness = 0.8f},
      {.name = "clearcoat on glass", .glass = 1, .clearcoat = 1},
      {.name = "clearcoat on thin glass",
       .glass = 1,
       .thin = true,
       .clearcoat = 1,
       .clearcoat_roughness = 0.2f},
      {.name = "sheen", .diffuse = 1, .sheen = 1, .sheen_roughness = 0.3f},
      {.name = "sheen on plastic",
       .diffuse = 1,
       .coat = 1,
       .cover = 1,
       .sheen = 1,
       .sheen_roughness = 1},
      {.name = "sheen on metal", .mirror = 1, .edge = 1, .sheen = 0.5f, .sheen_roughness = 0.6f},
      {.name = "clearcoat, sheen, plastic",
       .diffuse = 1,
       .coat = 1,
       .cover = 1,
       .clearcoat = 1,
       .clearcoat_roughness = 0.4f,
       .sheen = 0.8f,
       .sheen_roughness = 0.5f}};
  for (TestLobes& lobes : all)
    lobes.clearcoat_roughness = std::max(lobes.clearcoat_roughness, roughness);
  return all;
}

constexpr float kRoughnesses[] = {0,     0.02f, 0.0313f, 0.05f, 0.1f, 0.2f,
                                  0.35f, 0.5f,  0.7f,    0.87f, 1};
constexpr float kCosines[] = {1, 0.9f, 0.7f, 0.5f, 0.3f, 0.1f, 0.03f, 0.01f, 1e-3f};

// Points of the unit cube: Halton 1964.
std::vector<Vec3f> halton(size_t n) {
  const auto reversed = [](size_t i, size_t base) {
    double value = 0, digit = 1;
    for (; i > 0; i /= base) value += double(i % base) * (digit /= double(base));
    return std::min(float(value), 1 - 0x1p-24f);
  };
  std::vector<Vec3f> points;
  for (size_t i = 1; i <= n; ++i)
    points.emplace_back(reversed(i, 2), reversed(i, 3), reversed(i, 5));
  return points;
}

double mean_weight(const TestLobes& lobes, Vec3f out, size_t n) {
  static const std::vector<Vec3f> kPoints = halton(1 << 16);
  double sum = 0;
  for (const BsdfAnswer& a : sampled(lobes, out, {kPoints.begin(), kPoints.begin() + long(n)}))
    sum += double(a.value);
  return sum / double(n);
}

// The error is that of the energy tables, where they are interpolated; nearly all are below 1e-3.
TEST(Bsdf, WhiteSurfacesReflectAllLight) {
  constexpr size_t kCount = tests::if_sanitized(1 << 12, 1 << 16);
  for (TestLobes lobes : white_lobes())
    for (const float roughness : kRoughnesses) {
      lobes.roughness = roughness;
      for (const float cosine : kCosines)
        EXPECT_NEAR(mean_weight(lobes, direction(double(cosine), 0.4), kCount), 1,
                    tests::if_sanitized(2e-2, 1.5e-3))
            << lobes.name << ", roughness " << roughness << ", cosine " << cosine;
    }
}

// Otherwise rare samples would be bright dots in pictures.
TEST(Bsdf, WeightsAreBounded) {
  for (TestLobes lobes : white_lobes())
    for (const float roughness : kRoughnesses) {
      lobes.roughness = roughness;
      for (const float cosine : kCosines)
        for (const BsdfAnswer& a :
             sampled(lobes, direction(double(cosine), 0.4), halton(tests::if_sanitized(64, 4096))))
          ASSERT_LT(a.value, 20) << lobes.name << ", roughness " << roughness << ", cosine "
                                 << cosine;
    }
}

// The centres of cells of equal solid angle.
std::vector<Vec3f> sphere_of(size_t heights, size_t azimuths) {
  std::vector<Vec3f> points;
  for (size_t h = 0; h < heights; ++h)
    for (size_t a = 0; a < azimuths; ++a)
      points.push_back(direction(1 - 2 * (double(h) + 0.5) / double(heights),
                                 2 * pi * (double(a) + 0.5) / double(azimuths)));
  return points;
}

// By quadrature: what samples find is the integral of the value, and of the density, which lacks
// only the samples that are lost.
TEST(Bsdf, SamplesIntegrateTheValue) {
  constexpr float kRough[] = {0.5f, 0.8f, 1}, kSlants[] = {0.4f, 0.95f, 0.1f};
  constexpr size_t kRounds = tests::if_sanitized(1, 3);
  const std::vector<Vec3f> in = sphere_of(768, 512);
  const std::vector<Vec3f> numbers = halton(1 << 16);
  for (TestLobes lobes : white_lobes(0.4f))
    for (const float roughness : std::span(kRough).first(kRounds))
      for (const float cosine : std::span(kSlants).first(kRounds)) {
        lobes.roughness = roughness;
        const Vec3f out = direction(double(cosine), 0.4);
        double value = 0, density = 0, lost = 0;
        for (const BsdfAnswer& a : evaluated(lobes, out, in))
          value += double(a.value), density += double(a.pdf);
        for (const BsdfAnswer& a : sampled(lobes, out, numbers)) lost += a.in.z == 0;
        const double cell = 4 * pi / double(in.size());
        lost /= double(numbers.size());
        EXPECT_NEAR(value * cell, mean_weight(lobes, out, numbers.size()), 2e-3)
            << lobes.name << ", roughness " << roughness << ", cosine " << cosine;
        EXPECT_NEAR(density * cell, 1 - lost, 3e-3)
            << lobes.name << ", roughness " << roughness << ", cosine " << cosine;
      }
}

// Pearson's test, with the density integrated over the cells of a histogram.
TEST(Bsdf, SamplesHaveTheirDensity) {
  constexpr size_t kHeights = 16, kAzimuths = 16, kFine = 24;
  constexpr size_t kSamples = tests::if_sanitized(20'000, 100'000);
  const std::vector<Vec3f> in = sphere_of(kHeights * kFine, kAzimuths * kFine);
  const auto cell_of = [](Vec3f w) {
    const double turns = std::atan2(double(w.y), double(w.x)) / (2 * pi);
    const auto height = std::min(size_t((1 - double(w.z)) / 2 * kHeights), kHeights - 1);
    const auto azimuth = size_t((turns - std::floor(turns)) * kAzimuths);
    return height * kAzimuths + std::min(azimuth, kAzimuths - 1);
  };
  std::mt19937 rng(5);
  std::vector<Vec3f> numbers;
  const auto unit = [&] { return float(rng() >> 8) * 0x1p-24f; };
  for (size_t i = 0; i < kSamples; ++i) {
    const float x = unit(), y = unit(), z = unit();
    numbers.emplace_back(x, y, z);
  }
  for (TestLobes lobes : white_lobes(0.4f))
    for (const float roughness : {0.35f, 0.6f, 1.0f})
      for (const float cosine : {0.8f, 0.2f}) {
        lobes.roughness = roughness;
        const Vec3f out = direction(double(cosine), 0.4);
        std::vector<double> expected(kHeights * kAzimuths), found(expected.size());
        for (const BsdfAnswer& a : evaluated(lobes, out, in))
          expected[cell_of(a.in)] += double(a.pdf) * 4 * pi / double(in.size()) * kSamples;
        for (const BsdfAnswer& a : sampled(lobes, out, numbers))
          if (a.in.z != 0) found[cell_of(a.in)] += 1;
        double sum = 0, cells = 0;
        for (size_t i = 0; i < expected.size(); ++i) {
          if (expected[i] < 10) continue;
          const double off = found[i] - expected[i];
          sum += off * off / expected[i], cells += 1;
        }
        EXPECT_LT(sum, cells + 5 * std::sqrt(2 * cells))
            << lobes.name << ", roughness " << roughness << ", cosine " << cosine;
      }
}

TEST(Bsdf, WeightsAreValuesOverDensities) {
  const std::vector<Vec3f> numbers = halton(500);
  for (TestLobes lobes : white_lobes(0.05f))
    for (const float roughness : {0.05f, 0.3f, 1.0f}) {
      lobes.roughness = roughness;
      const Vec3f out = direction(0.6, 2);
      const Answers samples = sampled(lobes, out, numbers);
      std::vector<Vec3f> in;
      for (const BsdfAnswer& a : samples) in.push_back(a.in);
      const Answers values = evaluated(lobes, out, in);
      for (size_t i = 0; i < in.size(); ++i) {
        EXPECT_EQ(samples[i].pdf, values[i].pdf);
        EXPECT_NEAR(samples[i].value * values[i].pdf, values[i].value, 1e-5f * values[i].value);
        EXPECT_EQ(samples[i].through, in[i].z < 0);
      }
    }
}

// Helmholtz: exchanging the directions changes nothing, with radiance divided by the square of the
// index of refraction on its side.
TEST(Bsdf, IsReciprocal) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> unit(0, 1);
  for (TestLobes lobes : white_lobes(0.1f))
    for (const float roughness : {0.1f, 0.5f, 1.0f}) {
      lobes.roughness = roughness;
      for (int i = 0; i < 50; ++i) {
        const double z1 = unit(rng), a1 = 7 * unit(rng), z2 = 2 * unit(rng) - 1, a2 = 7 * unit(rng);
        const Vec3f out = direction(0.05 + 0.95 * z1, a1);
        const Vec3f in = direction(z2 + (z2 < 0 ? -0.05 : 0.05) * (1 - std::abs(z2)), a2);
        const bool through = in.z < 0;
        // Light that leaves glass does not meet its layers.
        if (through && !lobes.thin && lobes.has_layers()) continue;
        const float there = evaluated(lobes, out, {in})[0].value / std::abs(in.z);
        const Vec3f side(1, 1, through ? -1 : 1);  // to the frame on the side of `in`
        const float back =
            evaluated(through && !lobes.thin ? lobes.behind() : lobes, in * side, {out * side})[0]
                .value /
            out.z;
        const float scale = through && !lobes.thin ? lobes.eta() * lobes.eta() : 1;
        if (there == 0 && back == 0) continue;
        EXPECT_NEAR(there / (back * scale), 1, 2e-3f)
            << lobes.name << ", roughness " << roughness << ", in.z " << in.z << " out.z " << out.z;
      }
    }
}

TEST(Bsdf, ExtremeSurfacesGiveFiniteNumbers) {
  const std::vector<Vec3f> numbers = halton(300), in = sphere_of(30, 10);
  for (TestLobes lobes : white_lobes())
    for (const float ior : {1.0f, 1.0001f, 1.01f, 3.0f})
      for (const float roughness : {0.0f, 0.03125f, 0.03126f, 1.0f})
        for (const float tint : {0.0f, 1.0f})
          for (const double cosine : {1e-6, 1e-3, 1.0}) {
            lobes.ior = ior, lobes.roughness = roughness, lobes.tint = tint;
            const Vec3f out = direction(cosine, 0);
            for (const bool samples : {false, true})
              for (const BsdfAnswer& a : ask(lobes, out, samples, samples ? numbers : in)) {
                ASSERT_TRUE(std::isfinite(a.value) && a.value >= 0 && std::isfinite(a.pdf) &&
                            a.pdf >= 0 && is_finite(a.in))
                    << lobes.name << ", ior " << ior << ", roughness " << roughness << ", cosine "
                    << cosine << ", tint " << tint << ", value " << a.value << ", pdf " << a.pdf;
                if (samples) {
                  ASSERT_LT(a.value, 1e3f) << lobes.name << ", ior " << ior << ", roughness "
                                           << roughness << ", cosine " << cosine;
                }
              }
          }
}

// A surface between equal media is not there.
TEST(Bsdf, GlassWithoutRefractionIsClear) {
  for (const float ior : {1.0f, 1.0001f})
    for (const float roughness : {0.0f, 0.1f, 0.2f}) {
      const TestLobes lobes = {
          .name = "clear", .glass = 1, .roughness = roughness, .ior = ior, .leaving = false};
      EXPECT_NEAR(mean_weight(lobes, direction(0.7, 0.4), 1 << 12), 1, 3e-3)
          << ior << ", roughness " << roughness;
    }
}

TEST(Bsdf, InstructionSetsAgree) {
  const std::vector<Vec3f> numbers = halton(200);
  for (TestLobes lobes : white_lobes())
    for (const float roughness : {0.0f, 0.2f, 0.9f}) {
      lobes.roughness = roughness;
      const auto numbers_of = [&] {
        std::vector<float> all;
        for (const bool samples : {false, true})
          for (const BsdfAnswer& a : ask(lobes, direction(0.3, 1), samples, numbers))
            all.insert(all.end(), {a.in.x, a.in.y, a.in.z, a.value, a.pdf});
        return all;
      };
      const std::vector<float> expected = numbers_of();
      for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        EXPECT_EQ(numbers_of(), expected) << hwy::TargetName(target) << ", " << lobes.name;
      }
      hwy::SetSupportedTargetsForTest(0);
    }
}

}  // namespace
}  // namespace raio::core
#endif
