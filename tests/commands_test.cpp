// The commands around rendering, called directly; their output is captured.
#include "app/commands.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <thread>

#include "app/command_line.h"
#include "app/terminal.h"
#include "base/srgb.h"
#include "data_files.h"
#include "io/image/image.h"
#include "io/nff/nff.h"
#include "sanitized.h"

namespace raio::core::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string kStandardOutput = "-";

constexpr std::string_view kScene =
    "b 0.1 0.2 0.3\n"
    "v\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 40 30\n"
    "l 3 -4 5\n"
    "f 1 0 0 0.8 0.2 10 0 1\ns 0 0 0 1\ns 1.5 0 0.5 0.4\n"
    "f 0 1 0 0.5 0 1 0.5 1.5\nc -2 0 0 0.3 -2 0 1 0.3\n"
    "p 4\n-5 -5 -1\n5 -5 -1\n5 5 -1\n-5 5 -1\n";

class Commands : public testing::Test {
 protected:
  Commands() {
    folder_ = std::filesystem::temp_directory_path() / "raio_commands_";
    folder_ += std::to_string(getpid());
    std::filesystem::create_directory(folder_);
  }
  ~Commands() override { std::filesystem::remove_all(folder_); }

  std::string path(std::string_view name) const { return (folder_ / name).string(); }

  std::string file(std::string_view name, std::string_view bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  std::string contents(std::string_view name) const {
    std::ifstream stream(path(name), std::ios::binary);
    return {std::istreambuf_iterator(stream), {}};
  }

  template <class Command>
  int run_captured(const Command& command) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int status = run(command);
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return status;
  }

  std::filesystem::path folder_;
  std::string out_, err_;
};

// A scene from a pipe is being read until the pipe is closed.
TEST_F(Commands, ThreadsApplyToReadingToo) {
  const std::string scene = path("tetra.nff"), picture = path("a.png");
  ASSERT_EQ(::mkfifo(scene.c_str(), 0600), 0);
  for (std::vector<std::string> words :
       {std::vector<std::string>{"raio", "render", scene, "-o", picture, "--size", "8x8"},
        {"raio", "bench", scene, "--size", "8x8"},
        {"raio", "spd", "verify", scene}}) {
    words.insert(words.end(), {"--threads", "3"});
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    std::thread program([&] { run_command_line(int(arguments.size()), arguments.data()); });
    const int pipe = ::open(scene.c_str(), O_WRONLY);  // waits for a reader
    const size_t threads =
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    EXPECT_EQ(::write(pipe, kScene.data(), kScene.size()), ssize_t(kScene.size()));
    ::close(pipe);
    program.join();
    testing::internal::GetCapturedStdout();
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(threads, 3u) << words[1] << ": " << said;
  }
}

// In a new process, because threads started by oneTBB stay.
TEST_F(Commands, OneThreadIsOneFromReadingToWriting) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  std::string many(kScene);
  for (int i = 0; i < tests::if_sanitized(2000, 20000); ++i) many += "s 0 0 0 1\n";
  const std::string scene = file("many.nff", many), picture = path("a.exr");
  const auto threads_now = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
  };
  const char* const size = tests::if_sanitized("60x40", "300x200");
  const auto work = [&](const char* threads) {
    std::thread([] {}).join();  // with the first thread, a sanitizer starts one of its own
    const auto before = threads_now();
    std::vector<std::string> words = {"raio",         "render",       scene,       "-o",
                                      picture,        "--quiet",      "--size",    size,
                                      "--checkpoint", path("c.raio"), "--threads", threads};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    const int status = run_command_line(int(arguments.size()), arguments.data());
    // The system may list a joined thread a little longer.
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (threads_now() != before && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto after = threads_now();
    std::filesystem::remove_all(folder_);
    std::_Exit(status == kDone && after == before ? 0 : 1);
  };
  EXPECT_EXIT(work("1"), testing::ExitedWithCode(0), "");
#ifndef __SANITIZE_THREAD__  // oneTBB's threads end there before they can be counted
  EXPECT_EXIT(work("2"), testing::ExitedWithCode(1), "");  // so it is told
#endif
}

TEST_F(Commands, InfoCountsPrimitives) {
  const std::string scene = file("some.nff", kScene);
  EXPECT_EQ(run_captured(InfoCommand{.scene = scene}), kDone);
  EXPECT_EQ(err_, "");
  for (const char* part : {"primitives  4\n", "sphere             2\n", "40x30", "from 0 -5 0",
                           "materials   2, of which 1 reflect and 1 refract\n"})
    EXPECT_THAT(out_, HasSubstr(part));

  EXPECT_EQ(run_captured(InfoCommand{.scene = scene, .json = true}), kDone);
  const json info = json::parse(out_);
  EXPECT_EQ(info["scene"], "some");
  EXPECT_EQ(info["resolution"], (json{40, 30}));
  EXPECT_EQ(info["primitives"]["sphere"], 2);
  EXPECT_EQ(info["primitives"]["cylinder"], 1);
  EXPECT_EQ(info["primitives"]["polygon"], 1);
  EXPECT_EQ(info["primitive_count"], 4);
  EXPECT_EQ(info["bounds"]["hi"][0], 5);
  EXPECT_EQ(info["background"][0], 0.1);  // not 0.10000000149
  EXPECT_TRUE(info["lights"][0]["color"].is_null());
  EXPECT_EQ(info["materials"]["refracting"], 1);
  EXPECT_TRUE(info["warnings"].empty());
}

TEST_F(Commands, InfoCountsInstances) {
  const std::string scene = file("some.pdb", std::string(kPdb));
  InfoCommand command{.scene = scene, .read = {.style = AtomStyle::space_filling}};
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_THAT(out_, HasSubstr("primitives  4\n"));
  EXPECT_THAT(out_, HasSubstr("instances   2, prototypes 1\n"));
  command.json = true;
  EXPECT_EQ(run_captured(command), kDone);
  const json info = json::parse(out_);
  EXPECT_EQ(info["instances"], 2);
  EXPECT_EQ(info["prototypes"], 1);
  EXPECT_EQ(info["primitive_count"], 4);
}

TEST_F(Commands, InfoDrawsTheColourBar) {
  const std::string two = std::string(kWater) + std::string(kWater);
  InfoCommand command{.scene = file("water.xyz", two), .color_bar = path("bar.svg")};
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr("nothing is coloured by numbers"));
  command.read = {.color_by = "index", .color_range = std::array{-2.0, 5.0}};
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_THAT(out_, HasSubstr("colours     index from -2 to 5, viridis\n"));
  EXPECT_THAT(out_, HasSubstr("frames      2\n"));
  EXPECT_THAT(contents("bar.svg"), HasSubstr("<svg"));
  command.json = true, command.color_bar = path("bar.png");
  EXPECT_EQ(run_captured(command), kDone);
  const json info = json::parse(out_);
  EXPECT_EQ(info["colors"]["range"][0], -2);
  EXPECT_EQ(info["frames"], 2);
  const auto bar = read_picture(path("bar.png"));
  ASSERT_TRUE(bar);
  // The ends of viridis, a pixel inside of each.
  const auto row = [&](int x) { return bar->color.pixels[size_t(64 * bar->color.width + x)]; };
  EXPECT_NEAR(row(41).x, 68 / 255.0, 0.01);
  EXPECT_NEAR(row(598).x, 253 / 255.0, 0.01);
  // Ends that hardly differ have an end, too.
  command.read.color_range = std::array{1e17, 1.0000000000000005e17};
  EXPECT_EQ(run_captured(command), kDone);
  command.color_bar = path("bar.txt");
  EXPECT_EQ(run_captured(command), kBadInput);
}

#ifndef RAIO_NO_PLOTS
// A bar of plasma at a side of pictures of all formats; other pixels are unchanged.
TEST_F(Commands, PicturesHaveAColourBar) {
  RenderCommand plain;
  plain.scenes = {file("water.xyz", kWater)};
  plain.read = {.color_by = "index", .colormap = "plasma", .color_range = std::array{0.0, 8.0}};
  plain.options.width = 320, plain.options.height = 240;
  plain.quiet = true;
  const auto rendered = [&](RenderCommand command, bool bar, const std::string& name) {
    command.color_bar = bar, command.output = path(name);
    EXPECT_EQ(run_captured(command), kDone) << err_;
    auto picture = read_picture(path(name));
    EXPECT_TRUE(picture) << name;
    return picture ? std::move(*picture) : Picture();
  };
  const auto changed = [](const Picture& a, const Picture& b) {
    Box3f box;
    for (int y = 0; y < a.color.height; ++y)
      for (int x = 0; x < a.color.width; ++x)
        if (a.color.at(x, y) != b.color.at(x, y)) box.extend(Vec3f(float(x), float(y), 0));
    return box;
  };
  const Picture without = rendered(plain, false, "a.png"), with = rendered(plain, true, "b.png");
  const Box3f box = changed(without, with);
  ASSERT_FALSE(box.empty());
  EXPECT_GT(box.lo.x, 200);
  EXPECT_NEAR(box.size().y, 0.45 * 240, 40);
  // The drawing has the colours of both ends of the map.
  const auto has = [&](Rgb display) {
    const Image& a = without.color;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
      const Rgb c = with.color.pixels[i];
      if (c != a.pixels[i] && length(c - display) < 0.02f) return true;
    }
    return false;
  };
  const Rgb top(240 / 255.0f, 249 / 255.0f, 33 / 255.0f),
      end(13 / 255.0f, 8 / 255.0f, 135 / 255.0f);
  EXPECT_TRUE(has(top) && has(end));

  RenderCommand left = plain;
  left.color_bar_side = "left";
  EXPECT_LT(changed(without, rendered(left, true, "c.png")).hi.x, 120);

  // As light, which the tone curve maps to the same.
  const Picture light = rendered(plain, true, "b.exr");
  Image shown = light.color;
  for (Rgb& c : shown.pixels)
    c = {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z)};
  size_t differ = 0;
  for (size_t i = 0; i < shown.pixels.size(); ++i)
    differ += length(shown.pixels[i] - with.color.pixels[i]) > 0.01f;
  EXPECT_LT(differ, 600u);  // half covered ones, at the rims of letters

  RenderCommand clear = plain;
  clear.options.background.emplace().transparent = true;
  const Picture seen = rendered(clear, true, "d.png"), bare = rendered(clear, false, "e.png");
  size_t covered = 0;
  for (size_t i = 0; i < seen.alpha.size(); ++i) {
    EXPECT_GE(seen.alpha[i], bare.alpha[i]);
    covered += bare.alpha[i] == 0 && seen.alpha[i] == 1;
  }
  EXPECT_GT(covered, 500u);

  plain.options.crop = Crop{0, 0, 160, 120};
  EXPECT_FALSE(changed(rendered(plain, false, "f.ppm"), rendered(plain, true, "g.ppm")).empty());
}

TEST_F(Commands, ImpossibleColourBarsAreRefused) {
  RenderCommand command;
  command.scenes = {file("water.xyz", kWater)};
  command.options.width = command.options.height = 20;
  command.output = path("a.png");
  command.color_bar = true;
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr("nothing is coloured by numbers"));
  command.read.color_by = "index";
  command.frames = FrameRange{0, 1};
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr("give --color-range"));
  command.read.color_range = std::array{0.0, 3.0};
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_TRUE(std::filesystem::exists(path("a-0001.png")));
  command.frames = {}, command.output = path("a.raio");
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr("not on part files"));
}
#endif

TEST_F(Commands, ConvertKeepsTheCellOfImages) {
  ConvertCommand convert{RAIO_SOURCE_DIR "/scenes/quartz.cif", path("some.raio"), {}};
  convert.read = {.style = AtomStyle::space_filling, .cell = true, .images = {20, 20, 1}};
  EXPECT_EQ(run_captured(convert), kDone) << err_;
  const InfoCommand info{.scene = path("some.raio"), .json = true};
  EXPECT_EQ(run_captured(info), kDone) << err_;
  EXPECT_EQ(json::parse(out_)["instances"], 400);
}

TEST_F(Commands, ConvertKeepsInstancesInRaioScenes) {
  const std::string scene = file("some.pdb", std::string(kPdb));
  ConvertCommand convert{scene, path("some.raio"), {.style = AtomStyle::space_filling}};
  EXPECT_EQ(run_captured(convert), kDone) << err_;
  EXPECT_EQ(err_, scene +
                      ": guessed: the biological assembly of 4 atoms is drawn; the file lists 3; "
                      "--assembly none draws those\n" +
                      scene + ":11:1: left out: atoms of alternate conformers (1: ALA A1)\n");
  InfoCommand info{.scene = path("some.raio"), .json = true};
  EXPECT_EQ(run_captured(info), kDone) << err_;
  const json said = json::parse(out_);
  EXPECT_EQ(said["instances"], 2);
  EXPECT_EQ(said["primitive_count"], 4);
  // Other formats have primitives.
  convert.input = path("some.raio"), convert.output = path("some.nff"), convert.read = {};
  EXPECT_EQ(run_captured(convert), kDone) << err_;
  info.scene = path("some.nff");
  EXPECT_EQ(run_captured(info), kDone) << err_;
  EXPECT_EQ(json::parse(out_)["instances"], 0);
  EXPECT_EQ(json::parse(out_)["primitive_count"], 4);
}

// The JSON suffices to sum up the pixel, which equals that of the picture.
TEST_F(Commands, ExplainedRaysAddUpToThePicture) {
  const std::string scene = file("some.nff", kScene), picture = path("a.pfm");
  RenderOptions options;
  options.soft_shadows = true;
  RenderCommand render;
  render.scenes = {scene};
  render.output = picture;
  render.quiet = true;
  render.options = options;
  ASSERT_EQ(run_captured(render), kDone) << err_;
  const auto image = read_image(picture);
  ASSERT_TRUE(image.has_value());
  size_t rays = 0;
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh})
    for (int y = 0; y < 30; y += 3)
      for (int x = 0; x < 40; x += 3) {
        options.accel.kind = kind;
        ASSERT_EQ(run_captured(ExplainCommand{
                      .scene = scene, .pixel = {x, y}, .json = true, .options = options}),
                  kDone)
            << err_;
        const json told = json::parse(out_);
        Vec3d sum;
        for (const json& ray : told["rays"]) {
          ++rays;
          for (int c = 0; c < 3; ++c)
            if (ray.contains("adds")) sum[c] += ray["adds"][size_t(c)].get<double>();
          if (kind == AccelKind::grid && ray["traced"]) {
            EXPECT_EQ(ray["cells"].size(), ray["counts"]["steps"]);
          }
        }
        for (int c = 0; c < 3; ++c) {
          EXPECT_EQ(float(sum[c]), image->at(x, y)[c]);
          EXPECT_EQ(told["rgb"][size_t(c)].get<float>(), image->at(x, y)[c]);
        }
      }
  EXPECT_GT(rays, 500u);
}

TEST_F(Commands, ExplainPrintsTheTreeOfRays) {
  const std::string scene = file("some.nff", kScene);
  EXPECT_EQ(run_captured(ExplainCommand{.scene = scene, .pixel = {20, 15}, .options = {}}), kDone);
  for (const char* part : {"pixel 20,15 of 40x30, sample 0 of 1\n", "eye ray, level 1, weight 1",
                           "hits        ", "light 0     ", "material    "})
    EXPECT_THAT(out_, HasSubstr(part));
  EXPECT_EQ(run_captured(ExplainCommand{.scene = scene, .pixel = {40, 0}, .options = {}}),
            kBadInput);
  EXPECT_THAT(err_, HasSubstr("the picture of 40x30 has no pixel 40,0; the last is 39,29"));
  RenderOptions embree;
  embree.accel.kind = AccelKind::embree;
  EXPECT_EQ(run_captured(ExplainCommand{.scene = scene, .options = embree}), kBadInput);
  EXPECT_THAT(err_, HasSubstr("Embree does not log its steps"));
  EXPECT_EQ(run_captured(ExplainCommand{.scene = scene, .sample = 1, .options = {}}), kBadInput);
  EXPECT_THAT(err_, HasSubstr("a pixel has 1 sample, numbered from 0; found 1"));
}

TEST_F(Commands, ExplainDrawsTheRays) {
  const std::string scene = file("some.nff", kScene);
  RenderOptions options;
  const std::pair<AccelKind, std::optional<Vec3d>> all[] = {
      {AccelKind::none, {}}, {AccelKind::grid, {{5.0, 1, 2}}}, {AccelKind::bvh, {{0.0, -5, 0}}}};
  for (const auto& [kind, from] : std::span(all).last(tests::if_sanitized(1, 3))) {
    options.accel.kind = kind;
    ExplainCommand explain{.scene = scene, .pixel = {20, 15}, .options = options};
    explain.plot = path("rays.svg");
    explain.plot_from = from;
    EXPECT_EQ(run_captured(explain), kDone) << err_;
    std::ifstream svg(explain.plot);
    const std::string drawn(std::istreambuf_iterator<char>(svg), {});
    EXPECT_THAT(drawn, HasSubstr("<svg"));
    EXPECT_THAT(drawn, HasSubstr("<image"));
    EXPECT_THAT(drawn, Not(HasSubstr("nan")));
    EXPECT_THAT(drawn, Not(HasSubstr("inf")));
    explain.plot = path("rays.jpg");
    EXPECT_EQ(run_captured(explain), kBadInput);
    EXPECT_THAT(err_, HasSubstr(".png, .svg or .pdf"));
  }
}

TEST_F(Commands, InfoHasNoBoundsForPlanes) {
  const std::string scene = file("planes.nff",
                                 "b 0 0 0\nv\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0\n"
                                 "resolution 8 8\nf 1 1 1 1 0 1 0 1\npl 0 0 0 1 0 0 0 1 0\n");
  EXPECT_EQ(run_captured(InfoCommand{.scene = scene, .json = true}), kDone);
  EXPECT_TRUE(json::parse(out_)["bounds"].is_null());
  EXPECT_EQ(run_captured(InfoCommand{.scene = scene}), kDone);
  EXPECT_THAT(out_, HasSubstr("bounds      none"));
}

TEST_F(Commands, InfoWarnsOfProblemsInThePicture) {
  std::string dark(kScene);
  dark.erase(dark.find("l 3 -4 5\n"), 9);
  EXPECT_EQ(run_captured(InfoCommand{.scene = file("dark.nff", dark), .json = true}), kDone);
  EXPECT_THAT(err_, HasSubstr("dark.nff: warning: the scene has no light"));
  EXPECT_EQ(std::ranges::count(err_, '\n'), 1);
  const json info = json::parse(out_);
  ASSERT_EQ(info["warnings"].size(), 1u);
  EXPECT_THAT(std::string(info["warnings"][0]["message"]), HasSubstr("no light"));

  // A lens as wide as its focus is far (P3F: a quarter of the height at that distance).
  std::string blurred(kScene);
  const std::string_view size = "resolution 40 30";
  blurred.replace(blurred.find(size), size.size(), "resolution 40 30\naperture 30 focal 0.2");
  EXPECT_EQ(run_captured(InfoCommand{.scene = file("blurred.p3f", blurred)}), kDone);
  EXPECT_THAT(err_, HasSubstr("the lens blurs nearly the whole picture"));
  EXPECT_THAT(err_, HasSubstr("; try --aperture 0."));
  EXPECT_THAT(out_, HasSubstr("warnings    1\n"));
}

TEST_F(Commands, InfoNamesEveryErrorAndFails) {
  EXPECT_EQ(run_captured(InfoCommand{.scene = file("bad.nff", "s 0 0 zero 1\n")}), kBadInput);
  EXPECT_EQ(out_, "");
  EXPECT_THAT(err_, HasSubstr("bad.nff:1:"));
  EXPECT_EQ(run_captured(InfoCommand{.scene = path("absent.nff")}), kBadInput);
  EXPECT_THAT(err_, HasSubstr("absent.nff"));
}

TEST_F(Commands, GeneratedScenesReadBack) {
  GenerateCommand command{.name = "balls", .size = 2, .output = path("balls.nff")};
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_EQ(out_ + err_, "");
  const std::string text = contents("balls.nff");
  EXPECT_TRUE(text.starts_with("# balls, size 2, generated by raio ")) << text.substr(0, 60);
  const auto read = read_nff(path("balls.nff"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene.spheres.size(), 91u);

  for (const char* standard_output : {"", "-"}) {
    command.output = standard_output;
    EXPECT_EQ(run_captured(command), kDone);
    EXPECT_EQ(out_, text);
  }
}

TEST_F(Commands, GenerateListsTheNamesForAnUnknownOne) {
  EXPECT_EQ(run_captured(GenerateCommand{.name = "bals", .output = path("x.nff")}), kBadInput);
  EXPECT_THAT(err_, HasSubstr("balls"));
  EXPECT_EQ(std::ranges::count(err_, '\n'), 1);
  EXPECT_FALSE(std::filesystem::exists(path("x.nff")));
  EXPECT_EQ(run_captured(GenerateCommand{.name = "balls", .size = 1000000, .output = {}}),
            kBadInput);
  EXPECT_EQ(run_captured(GenerateCommand{.name = "balls", .size = 1, .output = path("no/x.nff")}),
            kNoResource);
}

TEST_F(Commands, CompareMeasuresDifferences) {
  Image image(10, 10);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = Rgb(float(i) / 100);
  ASSERT_TRUE(write_image(image, path("a.png")));
  image.at(3, 4) = Rgb(1);
  ASSERT_TRUE(write_image(image, path("b.png")));

  CompareCommand command{.a = path("a.png"), .b = path("a.png"), .diff = {}, .min_psnr_db = 90};
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_THAT(out_, HasSubstr("infinite"));

  command.b = path("b.png"), command.diff = path("d.png");
  EXPECT_EQ(run_captured(command), kCheckFailed);
  EXPECT_THAT(out_, HasSubstr("pixels above 8      1 %\n"));
  EXPECT_THAT(err_, HasSubstr("below the required 90 dB"));
  const auto difference = read_image(path("d.png"));
  ASSERT_TRUE(difference);
  EXPECT_EQ(to_byte(difference->at(3, 4).x), 255);

  command.min_psnr_db = 10;
  EXPECT_EQ(run_captured(command), kDone);
  command.min_psnr_db = -1;
  EXPECT_EQ(run_captured(command), kDone);

  // The picture of the differences goes to standard output alone.
  command.diff = kStandardOutput;
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_TRUE(out_.starts_with("\x89PNG"));
  EXPECT_THAT(err_, HasSubstr("PSNR"));
}

TEST_F(Commands, CompareShowsTheLightOfAnExr) {
  RenderCommand render;
  render.scenes = {file("water.xyz", std::string(kWater))};
  render.options.width = render.options.height = 24, render.options.samples = 4;
  render.options.exposure.ev = -1;
  for (const char* name : {"a.png", "a.exr"}) {
    render.output = path(name);
    EXPECT_EQ(run_captured(render), kDone) << err_;
  }
  const CompareCommand command{
      .a = path("a.png"), .b = path("a.exr"), .diff = {}, .min_psnr_db = 50};
  EXPECT_EQ(run_captured(command), kDone) << out_;
}

TEST_F(Commands, CompareExplainsDifferencesByRegion) {
  const auto rendered = [&](const char* name, std::string_view from, std::string_view to) {
    std::string text(
        "b 0.1 0.2 0.3\nv\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\n"
        "resolution 40 30\nl 3 -4 5 1 1 1\nf 1 0 0 0.8 0 1 0 1\ns 0 0 0 1\n"
        "f 0 1 0 0.8 0.2 10 0 1\ns 2 0 0 0.5\ns -2 0 0 1\n");
    if (const size_t place = text.find(from); place != std::string::npos)
      text.replace(place, from.size(), to);
    const std::string scene = file(std::string(name) + ".nff", text);
    RenderCommand render;
    render.scenes = {scene}, render.output = path(std::string(name) + ".png");
    EXPECT_EQ(run_captured(render), kDone) << err_;
    return render.output;
  };
  CompareCommand command{.a = rendered("a", "", ""), .b = {}, .diff = {}, .explain = path("a.nff")};
  command.b = command.a;
  EXPECT_EQ(run_captured(command), kDone) << err_;
  EXPECT_THAT(out_, Not(HasSubstr("look first")));
  command.b = rendered("background", "b 0.1 0.2 0.3", "b 0.4 0.2 0.3");
  EXPECT_EQ(run_captured(command), kDone) << err_;
  EXPECT_THAT(out_, HasSubstr("look first at the background: "));
  EXPECT_THAT(out_, HasSubstr("+25.3"));  // in red alone: a third of 0.3
  // What is wrong on matt surfaces is wrong on shiny ones, too, which here have more pixels.
  command.b = rendered("dark", "l 3 -4 5 1 1 1", "l 3 -4 5 0.5 0.5 0.5");
  EXPECT_EQ(run_captured(command), kDone) << err_;
  EXPECT_THAT(out_, HasSubstr("look first at the lit surfaces: "));
  command.b = rendered("mirror", "0.8 0.2", "0.8 0.5");
  EXPECT_EQ(run_captured(command), kDone) << err_;
  EXPECT_THAT(out_, HasSubstr("look first at the shiny surfaces: "));
  command.explain = path("none.nff");
  EXPECT_NE(run_captured(command), kDone);
  EXPECT_EQ(out_, "");
}

TEST_F(Commands, CompareRefusesUnreadableOrDifferentSizes) {
  ASSERT_TRUE(write_image(Image(10, 10), path("a.png")));
  ASSERT_TRUE(write_image(Image(10, 11), path("b.png")));
  EXPECT_EQ(run_captured(CompareCommand{.a = path("a.png"), .b = path("b.png"), .diff = {}}),
            kBadInput);
  EXPECT_THAT(err_, HasSubstr("10x11"));
  EXPECT_EQ(run_captured(CompareCommand{.a = path("a.png"), .b = path("none.png"), .diff = {}}),
            kBadInput);
  EXPECT_EQ(
      run_captured(CompareCommand{.a = path("a.png"), .b = path("a.png"), .diff = path("d.gif")}),
      kBadInput);
  EXPECT_EQ(out_, "");
}

TEST(Terminal, NumbersReadAsPeopleWriteThem) {
  EXPECT_EQ(human_count(0), "0");
  EXPECT_EQ(human_count(778), "778");
  EXPECT_EQ(human_count(999.6), "1.00 k");
  EXPECT_EQ(human_count(12345678), "12.3 M");
  EXPECT_EQ(human_count(9.996e6), "10.0 M");
  EXPECT_EQ(human_count(123e18), "123000 P");
  EXPECT_EQ(human_quantity(0, "rays/s"), "0 rays/s");
  EXPECT_EQ(human_quantity(778, "rays/s"), "778 rays/s");
  EXPECT_EQ(human_quantity(999.7, "rays/s"), "1.00 krays/s");
  EXPECT_EQ(human_quantity(2.5e6, "rays/s"), "2.50 Mrays/s");
  EXPECT_EQ(human_bytes(12), "12 B");
  EXPECT_EQ(human_bytes(999.9), "1.00 kB");
  EXPECT_EQ(human_bytes(4.5e6), "4.50 MB");
  EXPECT_EQ(counted(1, "cell"), "1 cell");
  EXPECT_EQ(counted(0, "cell"), "0 cells");
  EXPECT_EQ(counted(1.25e6, "primitive"), "1.25 M primitives");
}

BenchCommand small_bench(const std::string& scene) {
  BenchCommand command;
  command.scene = scene;
  command.progress = "off";
  command.request.options.width = command.request.options.height = 16;
  return command;
}

TEST_F(Commands, BenchMeasuresAllCombinations) {
  BenchCommand command = small_bench(file("balls_medium.nff", kScene));
  command.request.repeat = 3;
  command.json = path("b.json"), command.csv = path("b.csv"), command.plot = path("b.svg");
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_EQ(err_, "");
  EXPECT_THAT(out_, HasSubstr("balls_medium, 16x16"));
  EXPECT_THAT(contents("b.csv"), HasSubstr("\"balls_medium\",16,16"));
  EXPECT_THAT(contents("b.svg"), HasSubstr("</svg>"));

  const json bench = json::parse(contents("b.json"));
  ASSERT_EQ(bench["rows"].size(), 24u);
  for (const json& row : bench["rows"]) {
    EXPECT_EQ(row["runs_s"].size(), 3u);
    EXPECT_GT(row["seconds"], 0);
    // At least the eye rays, and the report's seconds are of another size.
    EXPECT_GE(row["rays"], 16 * 16 * int(row["samples_per_pixel"]));
    EXPECT_TRUE(row["report_s"].is_null());
  }
  // With the same rays whatever the structure.
  for (size_t i = 8; i < 24; ++i)
    EXPECT_EQ(bench["rows"][i]["rays"], bench["rows"][i % 8]["rays"]) << i;
}

TEST_F(Commands, BenchWritesCompleteJsonToStandardOutput) {
  BenchCommand command = small_bench(file("some.nff", kScene));
  command.json = kStandardOutput;
  EXPECT_EQ(run_captured(command), kDone);
  EXPECT_EQ(json::parse(out_)["scene"], "some");
}

TEST_F(Commands, BenchRefusesTargetsBeforeTheWork) {
  BenchCommand command = small_bench(path("absent.nff"));  // which would be the next error
  command.json = command.csv = kStandardOutput;
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr("--csv"));
  command.csv.clear(), command.plot = "plot.gif";
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr(".svg"));
  command.plot = path("no/plot.svg");
  EXPECT_EQ(run_captured(command), kNoResource);
  command.plot.clear();
  EXPECT_EQ(run_captured(command), kBadInput);
  EXPECT_THAT(err_, HasSubstr("absent.nff"));
}

}  // namespace
}  // namespace raio::core::app
