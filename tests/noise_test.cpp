// Pictures with the option `noise`: each tile gets as many samples as it needs, in any order of
// work, on any machine.
#include "render/noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "one_picture.h"
#include "render/job.h"
#include "render/options.h"
#include "render/part.h"
#include "render/render.h"
#include "sanitized.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::expect_one_picture;
using tests::random_scene;

/// A scene with soft shadows, and empty corners.
struct NoisyStudio {
  Scene scene = random_scene(60, 5);
  RenderOptions request;
  RenderSettings settings;
  std::unique_ptr<Accel> accel;

  NoisyStudio() {
    request.width = 70, request.height = 50;
    request.soft_shadows = true;
    request.noise = 0.02f, request.max_samples = 100;
    request.threads = 2;
    settings = resolve_options(request, scene);
    accel = *build_accel(scene, settings.accel);
  }

  std::unique_ptr<Film> film() const { return *make_film(scene, settings); }
  bool add_to(Film& film, WorkControl& control, const RenderTask& task = {}) const {
    return render(scene, *accel, settings, film, control, task).finished;
  }
  Part part(const RenderTask& task = {}) const {
    Part part{{settings_of(scene, settings), task.shard, task.shards},
              *make_film(scene, settings, task.shards)};
    WorkControl control;
    EXPECT_TRUE(add_to(*part.film, control, task));
    return part;
  }
};

std::string bytes_of(const Part& part) { return encode_part(part.header, *part.film); }

TEST(SampleRounds, Double) {
  const SampleRounds rounds{5};
  for (const auto& [sample, start, end] : std::vector<std::array<uint32_t, 3>>{{0, 0, 5},
                                                                               {4, 0, 5},
                                                                               {5, 5, 10},
                                                                               {9, 5, 10},
                                                                               {10, 10, 20},
                                                                               {39, 20, 40},
                                                                               {40, 40, 80}}) {
    EXPECT_EQ(rounds.start(sample), start) << sample;
    EXPECT_EQ(rounds.end(rounds.start(sample)), end) << sample;
  }
}

TEST(Noise, EachTileHasWhatItNeeds) {
  const NoisyStudio studio;
  const Part part = studio.part();
  const SampleCounts counts = samples_of(part);
  EXPECT_EQ(counts.fewest, 16);
  EXPECT_EQ(counts.most, 100);  // the end of a round that is cut
  const double wanted = double(studio.settings.noise) * studio.settings.noise;
  for (size_t t = 0; t < part.film->tiles(); ++t) {
    const SampleSet samples = part.film->samples(t);
    ASSERT_EQ(samples, SampleSet({0, samples.end()}));
    EXPECT_THAT(samples.end(), testing::AnyOf(16, 32, 64, 100));
    EXPECT_TRUE(samples.end() == 100 || square_noise(*part.film, t) <= wanted);
    EXPECT_EQ(need_of(*part.film, t, studio.settings).end, samples.end());
  }
  EXPECT_EQ(missing_samples(part, 1), "");
}

TEST(Noise, IsOnePictureOnAllThreadsAndInstructionSets) {
  NoisyStudio studio;
  studio.request.width = tests::if_sanitized(24, 40);
  studio.request.height = tests::if_sanitized(18, 30);
  expect_one_picture(studio.scene, studio.request);
}

TEST(Noise, ResumesAfterAnyStopToTheSameBytes) {
  const NoisyStudio studio;
  const Part whole = studio.part();
  int stops = 0;
  for (const uint64_t step : {1, 97, 400}) {
    Part part{whole.header, studio.film()};
    for (bool finished = false; !finished; ++stops) {
      WorkControl control;
      const RenderTask task{.interval_s = 1e-9, .at_interval = [&] {
                              if (control.work_done >= step) control.stop = true;
                            }};
      finished = studio.add_to(*part.film, control, task);
      const std::string bytes = bytes_of(part);
      auto back = decode_part(bytes);
      ASSERT_TRUE(back.has_value()) << back.error().text();
      EXPECT_EQ(bytes_of(*back), bytes);
      EXPECT_EQ(missing_samples(part, 1).empty(), finished);
      part = std::move(*back);
    }
    EXPECT_TRUE(bytes_of(part) == bytes_of(whole)) << step;
  }
  EXPECT_GT(stops, 20);
}

TEST(Noise, ShardsMergeToTheSameBytes) {
  const NoisyStudio studio;
  std::vector<NamedPart> parts;
  for (const uint32_t shard : {2, 0, 1})
    parts.push_back({"part", studio.part({.shard = shard, .shards = 3})});
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged.has_value()) << merged.error().text();
  EXPECT_TRUE(bytes_of(*merged) == bytes_of(studio.part()));
  EXPECT_EQ(missing_samples(*merged, 3), "");
}

// A film keeps the sums of the last round however its samples are put together.
TEST(Noise, SamplesOfATileMerge) {
  const NoisyStudio studio;
  const auto rendered = [&](std::vector<SampleSpan> spans) {
    auto film = studio.film();
    WorkControl control;
    for (const SampleSpan span : spans)
      EXPECT_TRUE(studio.add_to(*film, control, {.samples = span.end, .first_sample = span.first}));
    return film;
  };
  const auto whole = rendered({{0, 50}});
  const auto pieces = rendered({{16, 40}, {3, 7}, {0, 50}});
  const auto low = rendered({{0, 20}}), middle = rendered({{20, 45}}), high = rendered({{45, 50}});
  for (size_t t = 0; t < whole->tiles(); ++t) {
    EXPECT_EQ(whole->copy(t), pieces->copy(t));
    for (const auto& order : {std::array{&low, &middle, &high}, {&high, &low, &middle}}) {
      const auto film = studio.film();
      for (const auto* part : order) film->add(t, (*part)->copy(t));
      EXPECT_EQ(whole->copy(t), film->copy(t));
    }
  }
}

TEST(Noise, AFlatPictureHasTheFewestSamplesAndANoisyOneTheMost) {
  NoisyStudio studio;
  studio.settings.noise = 1e-4f;
  EXPECT_GT(samples_of(studio.part()).mean, 50);
  studio.scene = Scene();
  studio.scene.background = {0.2f, 0.3f, 0.4f};
  studio.accel = *build_accel(studio.scene, {});
  const SampleCounts counts = samples_of(studio.part());
  EXPECT_EQ(counts.fewest, 16);
  EXPECT_EQ(counts.most, 16);
}

/// Half of a square light is hidden: a pixel of the floor sees a share between 0 and 1 of it, which
/// the closed form of tests/closed_form_test.cpp (Penumbra) gives.
struct PenumbraPicture {
  static constexpr int kSide = 64;
  double mean_square = 0, bias = 0;  // of the relative error, over pixels in the penumbra
  double samples = 0;

  explicit PenumbraPicture(float noise, uint32_t seed) {
    const double H = 100, S = 10, h = 10;
    Scene s;
    s.camera.from = {0, 0, float(h / 2)}, s.camera.at = {}, s.camera.up = {0, 1, 0};
    s.camera.fov_deg = 6;
    s.lights = {{{0, 0, float(H)}, Rgb(1)}};
    s.materials = {{Rgb(1), 1, 0, 1, 0, 1}};
    s.planes = {{{0, 0, 0}, {0, 0, 1}}}, s.plane_materials = {0};
    RenderOptions o;
    o.width = o.height = kSide, o.seed = seed;
    o.soft_shadows = true, o.light_size = float(S), o.noise = noise;
    const Image whole = tests::picture_of(s, o);
    s.polygons.push_back({0, 4}), s.polygon_materials.push_back(0);
    s.positions = {
        {-99, -99, float(h)}, {0, -99, float(h)}, {0, 99, float(h)}, {-99, 99, float(h)}};
    const RenderSettings settings = resolve_options(o, s);
    const auto accel = build_accel(s, settings.accel);
    Part cut{{}, *make_film(s, settings)};
    WorkControl control;
    EXPECT_TRUE(render(s, **accel, settings, *cut.film, control).finished);
    samples = samples_of(cut).mean;
    const Image image = cut.film->resolve();
    const double pixel =
        h / 2 * std::tan(double(s.camera.fov_deg) * std::acos(-1.0) / 360) * 2 / kSide;
    int inside = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double place = (x + 0.5 - kSide / 2.0) * pixel;
        const double seen = (S / 2 - place * (1 - H / h)) / S;
        if (seen < 0.1 || seen > 0.9) continue;
        const double error = double(image.at(x, y).x / whole.at(x, y).x) / seen - 1;
        mean_square += error * error, bias += error, ++inside;
      }
    EXPECT_GT(inside, 1000);
    mean_square /= inside, bias /= inside;
  }
};

TEST(Noise, OfAPenumbraIsAsAskedFor) {
  double fewer = 0;
  for (const float wanted : {0.1f, 0.05f, 0.02f}) {
    double mean_square = 0, bias = 0, samples = 0;
    for (const uint32_t seed : {1, 2, 3}) {
      const PenumbraPicture picture(wanted, seed);
      mean_square += picture.mean_square / 3, bias += picture.bias / 3;
      samples += picture.samples / 3;
    }
    EXPECT_GT(samples, std::exchange(fewer, samples));
    EXPECT_LT(std::sqrt(mean_square), wanted);
    EXPECT_GT(std::sqrt(mean_square), wanted / 6);
    EXPECT_LT(std::abs(bias), wanted / 20);
  }
}

TEST(Noise, OfATransparentPictureIncludesAlpha) {
  // A black disc over nothing: all noise is in the coverage of its edge.
  Scene scene;
  scene.camera.from = {0, 0, 5}, scene.camera.at = {}, scene.camera.up = {0, 1, 0};
  scene.materials = {{Rgb(0), 0, 0, 1, 0, 1}};
  scene.spheres = {{{0, 0, 0}, 1}}, scene.sphere_materials = {0};
  RenderOptions o;
  o.width = o.height = 64, o.noise = 0.01f;
  const auto samples = [&] {
    const RenderSettings settings = resolve_options(o, scene);
    const auto accel = build_accel(scene, settings.accel);
    Part part{{}, *make_film(scene, settings)};
    WorkControl control;
    EXPECT_TRUE(render(scene, **accel, settings, *part.film, control).finished);
    return samples_of(part).mean;
  };
  EXPECT_EQ(samples(), 16);
  o.background = WrittenColor{.color = {}, .transparent = true};
  EXPECT_GT(samples(), 20);
}

TEST(Noise, OptionsThatExcludeItAreNamed) {
  const auto conflict = [](auto change) {
    RenderOptions o;
    o.noise = 0.02f;
    change(o);
    const auto why = option_conflict(o);
    return why ? why->text("--") : "";
  };
  EXPECT_EQ(conflict([](RenderOptions&) {}), "");
  EXPECT_EQ(conflict([](RenderOptions& o) { o.aa = 1; }), "");
  EXPECT_THAT(conflict([](RenderOptions& o) { o.aa = 2; }), HasSubstr("--aa"));
  EXPECT_THAT(conflict([](RenderOptions& o) { o.lens_samples = 2; }), HasSubstr("--lens-samples"));
  EXPECT_THAT(conflict([](RenderOptions& o) { o.samples = 2; }), HasSubstr("--samples"));
  EXPECT_THAT(conflict([](RenderOptions& o) { o.sampler = SamplerKind::jitter; }),
              HasSubstr("--sampler jitter"));
  EXPECT_THAT(conflict([](RenderOptions& o) { o.min_samples = 20, o.max_samples = 19; }),
              HasSubstr("above --max-samples"));
  EXPECT_THAT(conflict([](RenderOptions& o) { o.noise = 0, o.max_samples = 19; }),
              HasSubstr("without --noise"));
  EXPECT_THAT(conflict([](RenderOptions& o) { o.integrator = IntegratorKind::views; }),
              HasSubstr("has no effect with --integrator views"));
  RenderOptions window;
  window.noise = 0.02f;
  EXPECT_TRUE(window_conflict(window));
}

class NoiseJob : public TemporaryFolder {
 protected:
  JobRequest request(const std::string& output) const {
    const NoisyStudio studio;
    JobRequest r;
    r.loaded = std::make_shared<const Scene>(studio.scene);
    r.options = studio.request;
    r.output = file(output);
    return r;
  }
  static std::string failure(const JobRequest& request) {
    RenderJob job(request);
    auto done = job.prepare();
    if (done) done = job.run();
    if (done) done = job.write();
    return done ? "" : done.error().text("--");
  }
};

// As the program stops it: by the executor around all of its work.
TEST_F(NoiseJob, KeepsItsSamplesIfStopped) {
  const JobRequest whole = request("whole.raio");
  ASSERT_EQ(failure(whole), "");
  JobRequest r = request("x.raio");
  r.checkpoint = file("c.raio");
  WorkControl control;
  RenderJob job(r, {}, &control);
  ASSERT_TRUE(job.prepare());
  ASSERT_TRUE(job.build());
  Executor(2, &control).run([&] {
    control.stop = true;
    EXPECT_THAT(job.run().error().text("--"), HasSubstr("c.raio, and --resume continues"));
  });
  r.resume = true;
  ASSERT_EQ(failure(r), "");
  EXPECT_TRUE(get(r.output) == get(whole.output));
}

TEST_F(NoiseJob, IsRefinedToLessNoise) {
  JobRequest coarse = request("coarse.raio");
  coarse.options.noise = 0.1f, coarse.options.max_samples = 32;
  ASSERT_EQ(failure(coarse), "");
  JobRequest fine = request("fine.raio");
  fine.checkpoint = coarse.output, fine.resume = true;
  ASSERT_EQ(failure(fine), "");
  const JobRequest alone = request("alone.raio");
  ASSERT_EQ(failure(alone), "");
  EXPECT_TRUE(bytes_of(*read_part(fine.output)) == bytes_of(*read_part(alone.output)));
  fine.options.noise = 0.05f;
  EXPECT_THAT(failure(fine), HasSubstr("--noise 0.02, not 0.05"));
  fine.options.noise = 0.02f, fine.options.min_samples = 32;
  EXPECT_THAT(failure(fine), HasSubstr("--min-samples 16, not 32"));
}

TEST_F(NoiseJob, CannotBeDividedBySamples) {
  JobRequest r = request("a.raio");
  r.sample_range = {0, 16};
  EXPECT_THAT(failure(r), HasSubstr("split the picture with --shard"));
  r = request("a.raio");
  ASSERT_EQ(failure(r), "");
  JobRequest more;
  more.loaded = r.loaded, more.checkpoint = r.output, more.add_samples = 5;
  more.output = file("b.png");
  EXPECT_THAT(failure(more), HasSubstr("--resume it with a smaller --noise"));
}

TEST_F(NoiseJob, IsRepeatedFromItsPicture) {
  const JobRequest r = request("a.exr");
  ASSERT_EQ(failure(r), "");
  JobRequest again;
  again.repeat = r.output, again.loaded = r.loaded;
  again.output = file("b.exr");
  ASSERT_EQ(failure(again), "");
  EXPECT_TRUE(get(r.output) == get(again.output));
}

}  // namespace
}  // namespace raio::core
