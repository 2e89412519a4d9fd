// Complete renders without the program: their start, their stored work, their end, and their
// failures.
#include "render/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <thread>

#include "io/image/image.h"
#include "render/picture.h"
#include "render/render.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using tests::random_scene;

class Job : public TemporaryFolder {
 protected:
  JobRequest request(std::string_view output) const {
    JobRequest r;
    r.loaded = scene_;
    r.options.width = 70, r.options.height = 50;
    r.options.soft_shadows = true;
    r.options.samples = 6;
    r.options.threads = 2;
    r.output = file(output);
    return r;
  }

  static std::expected<void, Error> done(RenderJob& job) {
    if (auto ready = job.prepare(); !ready) return ready;
    if (auto rendered = job.run(); !rendered) return rendered;
    return job.write();
  }
  // The bytes of the output.
  static std::string bytes(const JobRequest& r) {
    RenderJob job(r);
    const auto all = done(job);
    EXPECT_TRUE(all) << all.error().text();
    EXPECT_TRUE(job.kept());
    return get(r.output);
  }
  static Error error(const JobRequest& r) {
    RenderJob job(r);
    const auto all = done(job);
    EXPECT_FALSE(all);
    return all ? Error() : all.error();
  }

  std::shared_ptr<const Scene> scene_ = std::make_shared<const Scene>(random_scene(40, 3));
};

TEST_F(Job, ReportsItsResults) {
  RenderJob job(request("a.png"));
  ASSERT_TRUE(done(job));
  const RenderFigures figures = job.figures();
  EXPECT_EQ(figures.scene, scene_);
  EXPECT_EQ(figures.settings, job.settings());
  EXPECT_EQ(figures.samples, 6u);
  EXPECT_EQ(figures.rays.eye, 70u * 50 * 6);
  EXPECT_EQ(figures.rays_before, 0u);
  EXPECT_EQ(figures.accel.name, "bvh");
  EXPECT_GT(figures.times.total, figures.times.render);
  EXPECT_EQ(job.control().work_done, job.control().work_total);
}

TEST_F(Job, ReusesALoadedSceneAndStructure) {
  WorkControl control;
  RenderJob first(request("a.png"), {}, &control);
  ASSERT_TRUE(done(first));
  EXPECT_EQ(&first.control(), &control);
  JobRequest r = request("b.png");
  r.loaded = first.loaded(), r.built = first.built();
  r.options.from = Vec3d(1, -4, 2);
  RenderJob second(r, {}, &control);
  EXPECT_EQ(control.work_done, 0u);
  ASSERT_TRUE(done(second));
  EXPECT_EQ(&second.accel(), &first.accel());
  JobRequest alone = request("c.png");
  alone.options.from = r.options.from;
  EXPECT_TRUE(bytes(alone) == get(r.output));
  // Stopped before it starts, none starts.
  control.stop = true;
  RenderJob third(r, {}, &control);
  EXPECT_EQ(third.prepare().error().kind, ErrorKind::stopped);
}

TEST_F(Job, AResumedJobGivesTheWholePicture) {
  const std::string whole = bytes(request("whole.exr"));
  JobRequest begun = request("few.exr");
  begun.options.samples = 2;
  begun.checkpoint = file("c.raio");
  bytes(begun);
  JobRequest more = request("on.exr");
  more.checkpoint = begun.checkpoint;
  EXPECT_EQ(error(more).kind, ErrorKind::bad_input);
  more.resume = true;
  RenderJob job(more);
  ASSERT_TRUE(done(job));
  EXPECT_TRUE(get(more.output) == whole);
  EXPECT_EQ(job.figures().rays.eye, 70u * 50 * 6);
  EXPECT_GT(job.figures().rays_before, 70u * 50 * 2);
  EXPECT_EQ(read_part(more.checkpoint)->header.settings, job.part().header.settings);

  more.options.samples = 3;
  const Error fewer = error(more);
  EXPECT_EQ(fewer.kind, ErrorKind::bad_input);
  EXPECT_EQ(fewer.subject, more.checkpoint);
  EXPECT_THAT(fewer.message, HasSubstr("already has 6 samples per pixel"));
  more.options.samples = 6, more.options.depth = 2;
  EXPECT_THAT(error(more).text("--"), HasSubstr("--depth 5, not 2"));
}

TEST_F(Job, AStoppedJobKeepsItsSamples) {
  const std::string whole = bytes(request("whole.png"));
  JobRequest r = request("x.png");
  r.checkpoint = file("c.raio");
  {
    RenderJob job(r);
    ASSERT_TRUE(job.prepare());
    ASSERT_TRUE(job.build());
    job.control().stop = true;
    const auto run = job.run();
    ASSERT_FALSE(run);
    EXPECT_EQ(run.error().kind, ErrorKind::stopped);
    EXPECT_THAT(run.error().text("--"), HasSubstr("c.raio, and --resume continues"));
  }
  EXPECT_FALSE(fs::exists(r.output));
  r.resume = true;
  EXPECT_TRUE(bytes(r) == whole);

  RenderJob never(request("z.png"));
  never.control().stop = true;
  EXPECT_EQ(never.prepare().error().kind, ErrorKind::stopped);
}

#ifndef RAIO_NO_THREADS
TEST_F(Job, AStoppedJobWritesItsCheckpoint) {
  JobRequest endless = request("y.png");
  endless.options.samples = kMaxSamples;
  endless.checkpoint = file("d.raio"), endless.checkpoint_interval_s = 0.02;
  RenderJob job(endless);
  ASSERT_TRUE(job.prepare());
  std::thread watcher([&] {
    // A tile's samples reach the film in portions of some dozens.
    while (!fs::exists(endless.checkpoint) || job.part().film->rays().total() == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    job.control().stop = true;
  });
  EXPECT_EQ(job.run().error().kind, ErrorKind::stopped);
  watcher.join();
  EXPECT_TRUE(!read_part(endless.checkpoint)->film->samples(0).empty() ||
              job.part().film->rays().total() > 0);
}
#endif

TEST_F(Job, ShardsMergeToTheWholePicture) {
  const std::string whole = bytes(request("whole.exr"));
  std::vector<NamedPart> parts;
  for (uint32_t i = 0; i < 3; ++i) {
    JobRequest r = request(std::to_string(i) + ".raio");
    r.shard = i, r.shards = 3;
    bytes(r);
    parts.push_back({r.output, *read_part(r.output)});
  }
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged) << merged.error().text();
  ASSERT_TRUE(write_result(file("merged.exr"), *merged));
  EXPECT_TRUE(get(file("merged.exr")) == whole);
}

TEST_F(Job, SamplesAreAdded) {
  const std::string whole = bytes(request("whole.exr"));
  JobRequest few = request("few.raio");
  few.options.samples = 2;
  bytes(few);
  JobRequest more = request("more.exr");
  more.options = {}, more.options.threads = 3;
  more.checkpoint = few.output, more.add_samples = 4;
  EXPECT_TRUE(bytes(more) == whole);
  more.add_samples = kMaxSamples;
  EXPECT_THAT(error(more).message, HasSubstr("samples per pixel are possible"));
  more.of_picture = {"depth"};
  EXPECT_EQ(error(more).text("--"),
            "--add-samples: it takes the options from the picture's file; leave out --depth");
}

TEST_F(Job, APictureIsRepeatedFromItself) {
  JobRequest r = request("a.png");
  r.options.samples = 0, r.options.aa = 2, r.options.accel.grid_factor = 2;
  const std::string picture = bytes(r);
  JobRequest again = request("b.png");
  again.options = {};
  again.repeat = r.output;
  EXPECT_TRUE(bytes(again) == picture);

  again.loaded = std::make_shared<const Scene>(random_scene(40, 4));
  const Error other = error(again);
  EXPECT_EQ(other.kind, ErrorKind::bad_input);
  EXPECT_EQ(other.text(), again.repeat + ": the scene differs");

  // A picture of another version is repeated with a warning.
  Metadata settings = *read_metadata(r.output);
  for (auto& [key, text] : settings)
    if (key == "version") text = "0.0.1";
  ASSERT_TRUE(write_image(Image(70, 50), file("old.png"), settings));
  again.loaded = scene_, again.repeat = file("old.png"), again.output = file("c.png");
  std::vector<Error> warnings;
  RenderJob job(again, {.warning = [&](const Error& w) { warnings.push_back(w); }});
  ASSERT_TRUE(done(job));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0].text(), HasSubstr("made by Raio 0.0.1"));
}

TEST_F(Job, ACheckpointMustMatchTheRepeatedPicture) {
  JobRequest r = request("a.png");
  const std::string picture = bytes(r);
  JobRequest again = request("b.png");
  again.options = {};
  again.repeat = r.output;
  again.checkpoint = file("c.raio"), again.resume = true;
  JobRequest begun = request("d.png");
  begun.checkpoint = again.checkpoint;
  EXPECT_TRUE(bytes(begun) == picture);
  EXPECT_TRUE(bytes(again) == picture);
  fs::remove(again.checkpoint);
  begun.options.seed = 9;
  (void)bytes(begun);
  const std::string part = get(again.checkpoint);
  const Error other = error(again);
  EXPECT_EQ(other.kind, ErrorKind::bad_input);
  EXPECT_THAT(other.text(), AllOf(HasSubstr("c.raio"), HasSubstr("seed")));
  EXPECT_TRUE(get(again.checkpoint) == part) << "it is left as it is";
}

TEST_F(Job, ATimeLimitStopsIt) {
  JobRequest r = request("a.exr");
  r.options.samples = kMaxSamples, r.time_limit_s = 0.3;
  RenderJob job(r);
  const auto all = done(job);
  if (!all) {  // a machine too busy for one sample
    EXPECT_EQ(all.error().kind, ErrorKind::no_resource);
    return;
  }
  EXPECT_GT(job.figures().samples, 0u);
  EXPECT_EQ(job.settings().samples, int(job.figures().samples));
  JobRequest again = request("b.exr");
  again.options = {};
  again.repeat = r.output;
  EXPECT_TRUE(bytes(again) == get(r.output));

  r.options.width = r.options.height = 2000, r.time_limit_s = 1e-6;
  const Error late = error(r);
  EXPECT_EQ(late.kind, ErrorKind::no_resource);
  EXPECT_THAT(late.message, HasSubstr("too short for one sample"));
}

TEST_F(Job, AFolderThatVanishesLosesTheCheckpointOnly) {
  JobRequest r = request("x.png");
  fs::create_directory(file("kept"));
  r.checkpoint = file("kept/c.raio"), r.checkpoint_interval_s = 0.01;
  r.options.width = 300, r.options.height = 200, r.options.samples = 40;
  std::vector<Error> warnings;
  RenderJob job(r, {.warning = [&](const Error& w) { warnings.push_back(w); }});
  ASSERT_TRUE(job.prepare());
  fs::remove_all(file("kept"));
  ASSERT_TRUE(job.run());
  ASSERT_FALSE(job.kept());
  EXPECT_EQ(job.kept().error().kind, ErrorKind::cannot_write);
  EXPECT_EQ(job.kept().error().subject, r.checkpoint);
  for (const Error& warning : warnings)
    EXPECT_THAT(warning.text(), HasSubstr("rendering continues"));
  EXPECT_LE(warnings.size(), 1u);
  EXPECT_TRUE(job.write());
  EXPECT_TRUE(read_image(r.output));
}

TEST_F(Job, ErrorsHaveTheRightKind) {
  put(file("foreign.raio"), "nothing");
  put(file("broken.nff"), "v\nfrom 1 2\n");
  const auto with = [&](auto change) {
    JobRequest r = request("x.png");
    change(r);
    return error(r);
  };
  const auto expect = [&](ErrorKind kind, std::string_view text, auto change) {
    const Error e = with(change);
    EXPECT_EQ(e.kind, kind) << e.text();
    EXPECT_THAT(e.text("--"), HasSubstr(std::string(text)));
  };
  using enum ErrorKind;
  expect(bad_option, "--scene", [](auto& r) { r.loaded = nullptr; });
  expect(bad_option, "--checkpoint", [](auto& r) { r.resume = true; });
  expect(bad_option, "add --checkpoint", [](auto& r) { r.add_samples = 3; });
  expect(bad_option, "--shard", [](auto& r) { r.shards = 2; });
  expect(bad_option, "--light-size: has no effect without --soft-shadows",
         [](auto& r) { r.options.light_size = 1, r.options.soft_shadows = false; });
  expect(bad_option, "--samples",
         [](auto& r) { r.options.aa = 1, r.options.soft_shadows = false; });
  expect(bad_option, "both be", [](auto& r) { r.checkpoint = r.output; });
  expect(bad_input, ".png", [&](auto& r) { r.output = file("x.foo"); });
  expect(bad_input, ".exr", [](auto& r) { r.options.channels.add(Channel::depth); });
  expect(bad_input, "Raio part file",
         [&](auto& r) { r.checkpoint = file("foreign.raio"), r.resume = true; });
  expect(cannot_write, "no/x.png", [&](auto& r) { r.output = file("no/x.png"); });
  expect(cannot_write, "no/c.raio", [&](auto& r) { r.checkpoint = file("no/c.raio"); });
  expect(cannot_read, "No such file", [&](auto& r) { r.repeat = file("no.png"); });
  expect(no_resource, "choose a smaller --size",
         [](auto& r) { r.options.width = r.options.height = 1 << 20; });
  expect(no_resource, "fewer cells",
         [](auto& r) { r.options.accel.grid_resolution = {100000, 100000, 100000}; });

  JobRequest r = request("x.png");
  r.loaded = nullptr, r.scene = file("broken.nff");
  Diagnostics said;
  RenderJob job(r, {.scene_read = [&](const Diagnostics& d) { said = d; }});
  const auto ready = job.prepare();
  ASSERT_FALSE(ready);
  ASSERT_FALSE(said.empty());
  EXPECT_EQ(ready.error(), error_of(said.front()));
  EXPECT_EQ(ready.error().subject, r.scene);
  EXPECT_EQ(ready.error().place.line, said.front().line);
}

// The values of a film and of the files agree number by number.
TEST_F(Job, ChannelsComeThroughFiles) {
  JobRequest r = request("a.exr");
  r.options.integrator = IntegratorKind::path;  // has light groups
  for (const ChannelSpec& spec : kChannels) r.options.channels.add(spec.channel);
  RenderJob job(r);
  ASSERT_TRUE(done(job));
  const Film& film = *job.part().film;
  const auto read = read_picture(r.output);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->alpha, std::get<Column<float>>(film.resolve(Channel::alpha)));
  const auto values = [](const Layer& layer) { return layer.values; };
  EXPECT_EQ(read->layers.size(), kChannels.size() - 1);
  for (const Layer& layer : read->layers) {
    const auto spec = std::ranges::find(kChannels, layer.name, &ChannelSpec::name);
    ASSERT_NE(spec, kChannels.end()) << layer.name;
    EXPECT_EQ(values(layer), film.resolve(spec->channel)) << layer.name;
    std::string components;
    for (const std::string& component : layer.components) components += component;
    EXPECT_EQ(components, spec->components);
  }
  const Picture picture = picture_of(film, job.settings());
  EXPECT_EQ(picture.layers.size(), read->layers.size());

  // A part has them, too: another program's merge writes the same bytes.
  JobRequest part = request("a.raio");
  part.options.channels = r.options.channels, part.options.integrator = r.options.integrator;
  bytes(part);
  std::vector<NamedPart> parts;
  parts.push_back({"a", *read_part(part.output)});
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged);
  ASSERT_TRUE(write_result(file("b.exr"), *merged));
  EXPECT_TRUE(get(file("b.exr")) == get(r.output));
  for (const char* name : {"b.npz", "c.npz"})
    ASSERT_TRUE(write_result(file(name), name[0] == 'b' ? *merged : job.part()));
  EXPECT_TRUE(get(file("b.npz")) == get(file("c.npz")));
  EXPECT_EQ(output_problem(file("b.png"), r.options.channels)->kind, ErrorKind::bad_input);
  EXPECT_FALSE(output_problem(file("b.png"), {}));
}

// A picture with alpha over the background is the picture without.
TEST_F(Job, AlphaLeavesTheBackgroundOut) {
  auto ball = std::make_shared<Scene>();
  ball->camera.from = {0, -5, 0}, ball->camera.at = {}, ball->camera.up = {0, 0, 1};
  ball->background = {0.25f, 0.5f, 1};
  ball->lights = {{{3, -4, 5}, std::nullopt}};
  ball->materials = {{{1, 0.5f, 0.25f}, 0.5f, 0.5f, 10, 0, 1}};
  ball->spheres = {{{0, 0, 0}, 1}, {{1.5f, 0, 0.5f}, 0.5f}};
  ball->sphere_materials = {0, 0};
  JobRequest r = request("plain.exr");
  r.loaded = ball;
  RenderJob plain(r);
  ASSERT_TRUE(done(plain));
  r.options.channels.add(Channel::alpha), r.output = file("alpha.exr");
  RenderJob cut(r);
  ASSERT_TRUE(done(cut));
  const Image whole = picture_of(*plain.part().film);
  const Picture picture = picture_of(*cut.part().film, cut.settings());
  int partly = 0, none = 0;
  for (size_t i = 0; i < whole.pixels.size(); ++i) {
    const float alpha = picture.alpha[i];
    partly += alpha > 0 && alpha < 1, none += alpha == 0;
    const Rgb over = picture.color.pixels[i] + ball->background * (1 - alpha);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(over[c], whole.pixels[i][c], 1e-5f);
    if (alpha == 0) {
      EXPECT_EQ(picture.color.pixels[i], Rgb());
    }
  }
  EXPECT_GT(partly, 10);
  EXPECT_GT(none, 1000);
}

TEST(Error, TextIsOneLine) {
  using enum ErrorKind;
  EXPECT_EQ((Error{cannot_read, "a\nb", "it is\tempty"}.text()), "cannot read a b: it is empty");
  EXPECT_EQ((Error{bad_input, "s.nff", "no number", {3, 7}}.text()), "s.nff:3:7: no number");
  const Error e{bad_option, "grid-factor",
                "cannot be combined with `grid-resolution`; `x y`, 'a`b"};
  EXPECT_EQ(e.text(), "grid-factor: cannot be combined with grid-resolution; `x y`, 'a`b");
  EXPECT_EQ(e.text("--"), "--grid-factor: cannot be combined with --grid-resolution; `x y`, 'a`b");
  EXPECT_EQ((Error{bad_input, "`aa`", "leave `aa` out"}.text("--")), "`aa`: leave --aa out");
  EXPECT_EQ(with_settings("```a``", "-"), "``-a`");
}

// The library's messages suit any program: they have no dashes.
TEST(Error, NoMessageBelowTheProgramHasItsWords) {
  const std::regex words("\"[^\"]*--[a-z]");
  const fs::path source = fs::path(RAIO_SOURCE_DIR) / "src";
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(source)) {
    const std::string room = fs::relative(entry.path(), source).begin()->string();
    if (!entry.is_regular_file() || room == "app" || room == "view") continue;
    ++files;
    std::ifstream stream(entry.path());
    for (std::string line; std::getline(stream, line);) {
      const size_t text = line.find_first_not_of(' ');
      if (text == line.npos || line.substr(text).starts_with("//")) continue;
      EXPECT_FALSE(std::regex_search(line, words)) << entry.path() << ": " << line;
    }
  }
  EXPECT_GT(files, 50);
}

}  // namespace
}  // namespace raio::core
