// Raio's own filter, and pictures that are denoised when they are written.
#include "integrate/denoise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/executor.h"
#include "integrate/oidn.h"
#include "one_picture.h"
#include "render/job.h"
#include "render/part.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using tests::same_bytes;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A picture whose colours have noise of known variance. Without features everything is one plane.
struct Noisy {
  static constexpr int kWidth = 50, kHeight = 38;
  static constexpr uint32_t kSamples = 4;

  Image color{kWidth, kHeight};
  std::vector<float> alpha, albedo, normal, depth, variance;
  std::vector<uint32_t> samples;

  Noisy() {
    const size_t pixels = color.pixels.size();
    albedo.assign(3 * pixels, 0.5f), normal.assign(3 * pixels, 0), variance.assign(3 * pixels, 0);
    depth.assign(pixels, 4), samples.assign(pixels, kSamples);
    for (size_t i = 0; i < pixels; ++i) normal[3 * i + 2] = 1;
  }
  // Adds noise, of uniform distribution, to all colours.
  void add_noise(float half_width) {
    for (size_t i = 0; i < color.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const size_t at = 3 * i + size_t(c);
        const double unit = double(hash_of(uint32_t(at))) * 0x1p-32;
        color.pixels[i][c] += half_width * float(2 * unit - 1);
        variance[at] = half_width * half_width / 3 * kSamples;
      }
  }
  PixelGuides guides() const { return {alpha, albedo, normal, depth, variance, samples}; }
  Image denoised() const {
    Image image = color;
    denoise(image, guides());
    return image;
  }

 private:
  static uint32_t hash_of(uint32_t x) {
    x ^= x >> 16, x *= 0x7feb352d, x ^= x >> 15, x *= 0x846ca68b;
    return x ^ x >> 16;
  }
};

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3d apart = Vec3d(a.pixels[i]) - Vec3d(b.pixels[i]);
    sum += dot(apart, apart);
  }
  return std::sqrt(sum / double(3 * a.pixels.size()));
}

// Light that changes across the picture, with a curve.
Noisy slope() {
  Noisy noisy;
  for (int y = 0; y < Noisy::kHeight; ++y)
    for (int x = 0; x < Noisy::kWidth; ++x) {
      const float u = float(x) / Noisy::kWidth, v = float(y) / Noisy::kHeight;
      noisy.color.at(x, y) = Rgb(0.2f + 0.5f * u, 0.3f + 0.3f * v * v, 0.8f - 0.4f * u * v);
    }
  return noisy;
}

TEST(Denoise, AConstantPictureStaysExactly) {
  Noisy flat;
  std::ranges::fill(flat.color.pixels, Rgb(0.3f, 0.7f, 12.5f));
  std::ranges::fill(flat.variance, 0.25f);
  EXPECT_TRUE(same_bytes(flat.denoised(), flat.color));
}

TEST(Denoise, APictureWithoutNoiseStays) {
  const Noisy clean = slope();
  EXPECT_LT(rms(clean.denoised(), clean.color), 1e-6);
}

TEST(Denoise, NoiseOnASlopeFallsToAThird) {
  Noisy noisy = slope();
  const Image truth = noisy.color;
  noisy.add_noise(0.2f);
  EXPECT_LT(rms(noisy.denoised(), truth), rms(noisy.color, truth) / 3);
}

// Two objects that differ in colour: none of one's light gets into the other.
TEST(Denoise, EdgesBetweenObjectsStay) {
  Noisy noisy;
  const auto is_left = [](int x) { return x < Noisy::kWidth / 2; };
  for (int y = 0; y < Noisy::kHeight; ++y)
    for (int x = 0; x < Noisy::kWidth; ++x) {
      const size_t i = size_t(y) * Noisy::kWidth + size_t(x);
      noisy.color.at(x, y) = is_left(x) ? Rgb(0.8f, 0.2f, 0.2f) : Rgb(0.2f, 0.2f, 0.8f);
      for (size_t c = 0; c < 3; ++c) noisy.albedo[3 * i + c] = noisy.color.at(x, y)[int(c)];
    }
  const Image truth = noisy.color;
  noisy.add_noise(0.15f);  // a quarter of the difference
  const Image image = noisy.denoised();
  for (int y = 0; y < Noisy::kHeight; ++y)
    for (const int x : {Noisy::kWidth / 2 - 1, Noisy::kWidth / 2})
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(image.at(x, y)[c], truth.at(x, y)[c], 0.15f) << x << " " << y;
  EXPECT_LT(rms(image, truth), rms(noisy.color, truth) / 2.5);
}

TEST(Denoise, BytesDoNotDependOnThreads) {
  Noisy noisy = slope();
  noisy.add_noise(0.2f);
  const Image one = Executor(1).run([&] { return noisy.denoised(); });
  EXPECT_TRUE(same_bytes(one, Executor(3).run([&] { return noisy.denoised(); })));
}

// Half transparent colours are denoised as opaque ones; what is not covered stays black.
TEST(Denoise, WorksOnColoursWithoutAlpha) {
  Noisy noisy = slope();
  noisy.add_noise(0.2f);
  const Image opaque = noisy.denoised();
  for (size_t i = 0; i < noisy.color.pixels.size(); ++i) {
    noisy.color.pixels[i] *= 0.5f;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c)
      noisy.albedo[c] *= 0.5f, noisy.normal[c] *= 0.5f, noisy.variance[c] *= 0.25f;
  }
  noisy.alpha.assign(noisy.color.pixels.size(), 0.5f);
  const Image half = noisy.denoised();
  for (size_t i = 0; i < half.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(half.pixels[i][c], opaque.pixels[i][c] / 2, 1e-5f);

  noisy.alpha[777] = 0, noisy.color.pixels[777] = Rgb();
  EXPECT_EQ(noisy.denoised().pixels[777], Rgb());
}

TEST(Denoise, WildNumbersStayInTheirPixels) {
  Noisy noisy = slope();
  noisy.add_noise(0.2f);
  const Image usual = noisy.denoised();
  constexpr int kX = 20, kY = 20;
  for (const float wild : {kNan, kInfinity, -kInfinity, 3e38f}) {
    noisy.color.at(kX, kY) = Rgb(0.5f, wild, 0.5f);
    const Image image = noisy.denoised();
    EXPECT_EQ(std::isnan(image.at(kX, kY).y), std::isnan(wild));
    EXPECT_EQ(image.at(kX, kY).x, 0.5f);
    for (int y = 0; y < Noisy::kHeight; ++y)
      for (int x = 0; x < Noisy::kWidth; ++x)
        if (x != kX || y != kY) {
          for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(image.at(x, y)[c], usual.at(x, y)[c], 0.1f) << wild << " " << x << " " << y;
        }
  }
  std::ranges::fill(noisy.depth, kInfinity);
  std::ranges::fill(noisy.variance, 3e38f);
  std::ranges::fill(noisy.albedo, 1e30f);
  noisy.color.at(kX, kY) = Rgb(1e14f);
  for (const Rgb& c : noisy.denoised().pixels) EXPECT_TRUE(is_finite(c));
}

class DenoisedFile : public TemporaryFolder {
 protected:
  // A ball on the ground, in a soft shadow.
  JobRequest request(std::string_view output, int samples, Denoiser denoiser) const {
    auto scene = std::make_shared<Scene>();
    scene->name = "ball";
    scene->camera.from = {0, -6, 4}, scene->camera.at = {}, scene->camera.up = {0, 0, 1};
    scene->lights = {{{3, -4, 5}, std::nullopt}};
    scene->materials = {{{1, 0.7f, 0.4f}, 0.9f, 0, 1, 0, 1}};
    scene->spheres = {{{0, 0, 1}, 1}}, scene->sphere_materials = {0};
    scene->planes = {{{0, 0, 0}, {0, 0, 1}}}, scene->plane_materials = {0};
    JobRequest r;
    r.loaded = scene;
    r.options.width = 96, r.options.height = 72;
    r.options.soft_shadows = true, r.options.light_size = 3;
    r.options.samples = samples, r.options.denoise = denoiser;
    r.output = file(output);
    return r;
  }
  std::vector<std::string> notes(const JobRequest& r) const {
    RenderJob job(r);
    for (const auto& done : {job.prepare(), job.run(), job.write()})
      EXPECT_TRUE(done) << done.error().text();
    return job.notes();
  }
  Error refusal(const JobRequest& r) const {
    const auto prepared = RenderJob(r).prepare();
    return prepared ? Error() : prepared.error();
  }
};

TEST_F(DenoisedFile, IsNearerToManySamples) {
  notes(request("few.pfm", 8, Denoiser::none));
  notes(request("many.pfm", 1024, Denoiser::none));
  EXPECT_THAT(notes(request("denoised.pfm", 8, Denoiser::raio)),
              ElementsAre("denoised by Raio's own filter"));
  const Image few = *read_image(file("few.pfm")), many = *read_image(file("many.pfm"));
  EXPECT_LT(rms(*read_image(file("denoised.pfm")), many), 0.7 * rms(few, many));
}

// Parts keep the samples: the picture of a merge is that of one render, and says what filtered it.
TEST_F(DenoisedFile, APartHasTheSamples) {
  notes(request("whole.png", 8, Denoiser::raio));
  std::vector<NamedPart> parts;
  for (const uint32_t shard : {0, 1}) {
    JobRequest r = request("part.raio", 8, Denoiser::raio);
    r.shard = shard, r.shards = 2;
    EXPECT_TRUE(notes(r).empty());
    parts.push_back({"part", *read_part(r.output)});
  }
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged);
  ASSERT_TRUE(write_result(file("merged.png"), *merged));
  EXPECT_TRUE(get(file("merged.png")) == get(file("whole.png")));
  const auto settings = *read_metadata(file("whole.png"));
  EXPECT_EQ(setting(settings, "denoise"), "raio");
  EXPECT_EQ(setting(settings, "denoised_by"), "Raio's own filter");

  JobRequest plain = request("plain.raio", 8, Denoiser::none);
  notes(plain);
  EXPECT_TRUE(same_bytes(merged->film->resolve(), read_part(plain.output)->film->resolve()));

  JobRequest again;
  again.loaded = request("", 8, Denoiser::none).loaded;
  again.repeat = file("whole.png"), again.output = file("again.png");
  notes(again);
  EXPECT_TRUE(get(file("again.png")) == get(file("whole.png")));
}

TEST_F(DenoisedFile, HasTheChannelsThatWereRequested) {
  JobRequest r = request("a.npz", 4, Denoiser::raio);
  r.options.channels.add(Channel::depth);
  RenderJob job(r);
  ASSERT_TRUE(job.prepare() && job.run());
  EXPECT_TRUE(job.part().film->layout().has(Channel::variance));
  const auto finished = finished_picture(job.part(), r.output);
  ASSERT_TRUE(finished);
  ASSERT_EQ(finished->picture.layers.size(), 1u);
  EXPECT_EQ(finished->picture.layers[0].name, "depth");
}

TEST_F(DenoisedFile, AutoUsesWhatIsThere) {
  const std::vector<std::string> said = notes(request("a.png", 4, Denoiser::automatic));
  const auto version = oidn_version();
  EXPECT_THAT(said, ElementsAre("denoised by " + (version ? "Open Image Denoise " + *version
                                                          : std::string("Raio's own filter"))));
  // The picture names the filter, so that it can be repeated elsewhere.
  EXPECT_EQ(setting(*read_metadata(file("a.png")), "denoise"), version ? "oidn" : "raio");
  const Error missing = refusal(request("b.png", 4, Denoiser::oidn));
  EXPECT_EQ(missing.kind == ErrorKind::no_resource, !version) << missing.text();
  if (!version) {
    EXPECT_THAT(missing.message, StartsWith("Open Image Denoise is missing"));
  }
}

TEST_F(DenoisedFile, RefusesWhatHasNoNoise) {
  EXPECT_THAT(refusal(request("a.png", 1, Denoiser::raio)).message, HasSubstr("at least two"));
  JobRequest r = request("a.png", 4, Denoiser::raio);
  r.options.integrator = IntegratorKind::views;
  r.options.soft_shadows = false, r.options.light_size = 0;
  EXPECT_THAT(refusal(r).message, HasSubstr("has no effect with `integrator` views"));
  r.options.integrator.reset(), r.options.view = View::samples;
  EXPECT_THAT(refusal(r).message, HasSubstr("has no effect with `view` samples"));
}

TEST(Oidn, RemovesNoiseIfItIsInstalled) {
  if (!oidn_version()) GTEST_SKIP() << oidn_version().error();
  Noisy noisy = slope();
  const Image truth = noisy.color;
  noisy.add_noise(0.2f);
  noisy.color.at(3, 4) = Rgb(kNan);
  Image image = noisy.color;
  ASSERT_TRUE(denoise_by_oidn(image, noisy.guides()));
  EXPECT_TRUE(std::isnan(image.at(3, 4).x));
  image.at(3, 4) = truth.at(3, 4), noisy.color.at(3, 4) = truth.at(3, 4);
  EXPECT_LT(rms(image, truth), rms(noisy.color, truth) / 2);
}

}  // namespace
}  // namespace raio::core
