// The program as users run it: with arguments, judged by its exit status, its output, and the files
// it leaves.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <ranges>
#include <thread>
#include <vector>

#include "app/json.h"
#include "app/window_keys.h"
#include "io/generate/generate.h"
#include "io/image/image.h"
#include "program.h"
#include "render/options.h"

namespace raio::core {
namespace {

using nlohmann::json;

TEST_F(CommandLine, RefusesFilesThatAreNotScenes) {
  std::filesystem::create_directory(file("folder.nff"));
  std::string noise;
  for (unsigned i = 0, x = 1; i < 20000; ++i) noise += char((x = x * 1664525 + 1013904223) >> 24);
  for (const auto& [name, bytes, message] :
       {std::tuple("truncated", std::string(kScene.substr(0, 150)), "the file ends"),
        {"noise", noise, "not a text file"},
        {"empty", std::string(), "the file is empty"},
        {"count", replaced("p 4", "p 4000000000"), "4000000000"},
        {"nan", replaced("s 0 0 0 1", "s nan 0 0 1"), "not finite"},
        {"huge", replaced("s 0 0 0 1", "s 1e39 0 0 1"), "too large for a float"}}) {
    put(file("bad.nff"), bytes);
    expect_refusal({"render", "bad.nff", "-o", "x.png"}, 2, message);
    expect_refusal({"info", "bad.nff"}, 2, message);
  }
  expect_refusal({"render", "folder.nff", "-o", "x.png"}, 2, "folder");
  expect_refusal({"render", "missing.nff", "-o", "x.png"}, 2, "No such file");
  expect_refusal({"render", "/dev/zero", "-o", "x.png"}, 2, "device");
  // A name is shown without its control characters.
  expect_refusal({"render", "a\nb\x1b[31m.nff", "-o", "x.png"}, 2, "a?b?[31m.nff");
}

TEST_F(CommandLine, RefusesTargetsThatCannotBeWritten) {
  std::filesystem::create_directory(file("folder.png"));
  const auto render = [](std::string output) {
    return std::vector<std::string>{"render", "ok.nff", "--quiet", "-o", output};
  };
  for (const char* target : {"no/x.png", "folder.png", "/proc/x.png", "/sys/x.png", "/dev/full"}) {
    // It may be missing in a minimal system image.
    if (std::string_view(target).starts_with("/sys") && !std::filesystem::exists("/sys/kernel"))
      continue;
    expect_refusal(render(target), 3, target);
  }
  for (const char* target : {"no/x.json", "folder.png", "/proc/x.json"})
    expect_refusal({"render", "ok.nff", "--quiet", "-o", "/dev/null", "--stats", target}, 3,
                   target);
  expect_refusal({"render", "ok.nff", "--quiet", "-o", "/dev/null", "--stats", "/dev/full"}, 3,
                 "/dev/full");
  expect_refusal(render("-"), 3, "standard output",
                 {.output = {}, .errors = {}, .close_output = true});
  expect_refusal(render("-"), 3, "standard output", {.output = "/dev/full", .errors = {}});
  expect_refusal({"info", "ok.nff"}, 3, "standard output", {.output = "/dev/full", .errors = {}});
  expect_refusal({"render", "--help"}, 3, "standard output", {.output = "/dev/full", .errors = {}});
  for (const char* target : {"x.gif", "x"}) expect_refusal(render(target), 2, ".png");
  expect_refusal({"render", "ok.nff", "-o", "-", "--stats", "-"}, 2, "standard output");
  expect_refusal({"render", "ok.nff", "-o", "x.png", "--stats", "x.png"}, 2, "x.png");
}

TEST_F(CommandLine, DoesItsWorkWhenStandardErrorIsFull) {
  const Redirections full{.output = {}, .errors = "/dev/full"};
  EXPECT_EQ(raio({"render", "missing.nff"}, full).status, 2);
  EXPECT_EQ(raio({"render", "ok.nff", "--progress", "on"}, full).status, 0);
  EXPECT_TRUE(std::filesystem::exists(file("ok.png")));
}

TEST_F(CommandLine, RefusesWrongUsage) {
  expect_usage_error({"rendr", "ok.nff"}, "did you mean render?");
  expect_refusal({"spd"}, 2, "expected a command; see raio spd --help");
  expect_refusal({"spd", "verfy"}, 2, "did you mean verify?; see raio spd --help");
  expect_refusal({"spd", "verify", "--jso"}, 2, "--json?; see raio spd verify --help");
  expect_usage_error({"frobnicate"}, "'frobnicate'");
  expect_usage_error({"--frob"}, "--frob");
  expect_usage_error({"render"}, "SCENE is missing");
  expect_refusal({"info", "ok.nff", "b.nff"}, 2, "one argument too many: 'b.nff'");
  expect_usage_error({"render", "ok.nff", "--siz", "3x3"}, "did you mean --size?");
  expect_usage_error({"render", "ok.nff", "--soft-shadow"}, "did you mean --soft-shadows?");
  expect_usage_error({"render", "ok.nff", "-x"}, "unknown option -x");
  expect_usage_error({"render", "ok.nff", "--size"}, "--size needs a value");
  expect_usage_error({"render", "ok.nff", "--stats", "-o", "x.png"}, "--stats needs a value");
  expect_usage_error({"render", "ok.nff", "--aa="}, "--aa needs a value");
  expect_usage_error({"render", ""}, "expected a file name");
  expect_usage_error({"render", "ok.nff", "-o", ""}, "expected a file name");
  expect_refusal({"compare", "a.png"}, 2, "B is missing");
  expect_refusal({"generate", "bals"}, 2, "balls");
  expect_refusal({"generate", "balls", "--size", "x"}, 2, "1 to 1000000");
}

TEST_F(CommandLine, WithoutACommandListsThem) {
  const Outcome o = raio({});
  EXPECT_EQ(o.status, 2);
  EXPECT_EQ(o.out, "");
  EXPECT_THAT(o.err, StartsWith("Usage: raio COMMAND"));
  for (const char* command : {"  render ", "  info ", "  spd ", "  help "})
    EXPECT_THAT(o.err, HasSubstr(command));
  EXPECT_THAT(o.err, Not(HasSubstr("--help")));
}

// A separate terminal with its other end open.
TEST_F(CommandLine, NoPictureGoesToATerminal) {
  const int other_end = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (other_end < 0 || ::grantpt(other_end) != 0 || ::unlockpt(other_end) != 0)
    GTEST_SKIP() << "there are no terminals here";
  const Redirections to_terminal{.output = ::ptsname(other_end), .errors = {}};
  ASSERT_EQ(raio({"render", "ok.nff", "-o", "a.raio"}).status, 0);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"render", "ok.nff", "-o", "-"},
        {"render", "ok.nff", "-o", "/dev/stdout"},
        {"merge", "a.raio", "-o", "-"},
        {"compare", "a.png", "b.png", "--diff", "-"}})
    expect_refusal(command, 2, "terminal", to_terminal);
  EXPECT_EQ(raio({"render", "ok.nff", "-o", "x.png"}, to_terminal).status, 0);
  EXPECT_EQ(raio({"info", "ok.nff"}, to_terminal).status, 0);
  ::close(other_end);
}

TEST_F(CommandLine, RefusesValuesOutOfRange) {
  for (const auto& [option, value, expected] : {std::tuple("--aa", "0", "from 1 to 256"),
                                                {"--aa", "257", "from 1 to 256"},
                                                {"--aa", "1.5", "whole number"},
                                                {"--size", "3", "640x480"},
                                                {"--size", "0x3", "640x480"},
                                                {"--accel", "grd", "embree"},
                                                {"--grid-factor", "0", "0.01 to 100"},
                                                {"--grid-resolution", "3x3", "XxYxZ"},
                                                {"--light-size", "nan", "number"},
                                                {"--aperture", "-1", "number"},
                                                {"--focus", "inf", "number"},
                                                {"--depth", "33", "1 to 32"},
                                                {"--threads", "0", "1 to 4096"},
                                                {"--seed", "-5", "0 to 4294967295"},
                                                {"--progress", "maybe", "auto, on or off"}}) {
    expect_usage_error({"render", "ok.nff", option, value}, expected);
    expect_usage_error({"render", "ok.nff", option, value}, "found '" + std::string(value) + "'");
  }
  EXPECT_EQ(raio({"render", "ok.nff", "--dof", "--aperture", "1e30"}).status, 0);
}

TEST_F(CommandLine, NamesOptionsWithoutEffect) {
  const auto refused = [&](std::vector<std::string> options, std::string_view message) {
    options.insert(options.begin(), {"render", "ok.nff", "-o", "x.png"});
    expect_refusal(options, 2, message);
  };
  for (const char* other : {"none", "embree"}) {
    refused({"--grid-factor", "2", "--accel", other}, "--grid-factor");
    refused({"--accel", other, "--grid-factor", "2"}, "--grid-factor");
    refused({"--grid-resolution", "3x3x3", "--accel", other}, "--grid-resolution");
    refused({"--accel", other, "--grid-resolution", "3x3x3"}, "--grid-resolution");
  }
  refused({"--grid-factor", "3", "--grid-resolution", "3x3x3"}, "--grid-factor");
  refused({"--counters", "--accel", "embree"}, "--counters");
  refused({"--light-size", "1"}, "add --soft-shadows");
  refused({"--aperture", "1"}, "add --dof");
  refused({"--focus", "1", "--no-dof"}, "add --dof");
  refused({"--lens-samples", "4"}, "--dof");
  refused({"--aa", "256", "--lens-samples", "65536"}, "4294967296 samples");

  const auto accepted = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"render", "ok.nff", "-o", "x.png"});
    const Outcome o = raio(options);
    EXPECT_EQ(o.status, 0) << o.err;
  };
  accepted({"--grid-factor", "3"});
  accepted({"--accel", "grid", "--grid-resolution", "3x3x3"});
  accepted({"--soft-shadows", "--light-size", "1"});
  accepted({"--dof", "--aperture", "1", "--focus", "4", "--lens-samples", "2"});
  accepted({"--soft-shadows", "--lens-samples", "2"});
  accepted({"--aa", "2", "--aa", "3"});
  // A lens of the scene's own is enough.
  put(file("ok.nff"), replaced("resolution 24 16", "resolution 24 16\naperture 2 focal 1"));
  accepted({"--aperture", "1", "--focus", "4", "--lens-samples", "2"});
  refused({"--aperture", "1", "--no-dof"}, "add --dof");
}

TEST_F(CommandLine, RefusesScenesBeyondMemory) {
  expect_refusal({"render", "ok.nff", "--size", "1000000x1000000"}, 3, "--size");
  expect_refusal({"render", "ok.nff", "--grid-resolution", "1000000x1000000x1000000"}, 3,
                 "fewer cells");
}

TEST_F(CommandLine, HelpIsNarrowAndComplete) {
  for (const char* command :
       {"", "render", "view", "merge", "bench", "info", "explain", "generate", "compare", "export",
        "spd", "spd verify", "help", "version", "manual", "options", "completion"}) {
    std::vector<std::string> arguments;
    for (const auto word : std::views::split(std::string_view(command), ' '))
      if (!word.empty()) arguments.emplace_back(word.begin(), word.end());
    arguments.emplace_back(*command ? "--help" : "-h");
    const Outcome o = raio(arguments);
    EXPECT_EQ(o.status, 0);
    EXPECT_EQ(o.err, "");
    EXPECT_THAT(o.out, HasSubstr("Usage: raio "));
    EXPECT_THAT(o.out, HasSubstr("Example"));
    for (size_t at = 0, end = 0; (end = o.out.find('\n', at)) != o.out.npos; at = end + 1) {
      EXPECT_LE(end - at, 80u) << o.out.substr(at, end - at);
      EXPECT_FALSE(end > at && o.out[end - 1] == ' ') << o.out.substr(at, end - at);
    }
  }
  for (const char* command :
       {"  render ", "  bench ", "  info ", "  generate ", "  compare ", "  export ", "  spd "})
    EXPECT_THAT(raio({"--help"}).out, HasSubstr(command));
  const std::string help = raio({"render", "--help"}).out;
  for (const OptionSpec& option : render_option_table())
    EXPECT_THAT(help, HasSubstr("--" + std::string(option.name)));
  EXPECT_THAT(help, HasSubstr("--dof, --no-dof "));
  EXPECT_EQ(raio({"help", "render"}).out, help);
  EXPECT_EQ(raio({"help", "spd", "verify"}).out, raio({"spd", "verify", "--help"}).out);
  EXPECT_EQ(raio({"help"}).out, raio({"--help"}).out);
  for (const std::string_view group : kOptionGroups)
    EXPECT_THAT(help, HasSubstr("\n\n" + std::string(group) + ":\n  -"));
  EXPECT_LT(help.find("\n\nCamera:\n"), help.find("  --fov DEG "));
  EXPECT_LT(help.find("  --fov DEG "), help.find("\n\nSampling:\n"));
  expect_refusal({"help", "rendr"}, 2, "did you mean render?");
  expect_refusal({"help", "render", "verify"}, 2, "unknown command 'verify'");
}

TEST_F(CommandLine, HelpOfTheWindowEndsWithItsKeys) {
  const std::string help = raio({"view", "--help"}).out;
  EXPECT_TRUE(help.ends_with("\n" + app::list_of_keys()));
  for (const char* line : {"\nKeys in the window:\n  a ", "\n  o, Home ",
                           "\n  Ctrl+Y, Ctrl+Shift+Z ", "\n  Esc ", "\nMouse:\n  drag "})
    EXPECT_THAT(help, HasSubstr(line));
  for (const app::KeySpec& key : app::key_table())
    EXPECT_THAT(help, HasSubstr((*key.about ? "\n  " : ", ") + std::string(key.name))) << key.name;
}

TEST_F(CommandLine, BriefHelpFitsOnAScreen) {
  for (const char* command : {"render", "view", "explain"}) {
    const std::string help = raio({command, "-h"}).out;
    EXPECT_LE(std::ranges::count(help, '\n'), 24) << help;
    for (const auto line : std::views::split(help, '\n')) EXPECT_LE(line.size(), 80u);
    for (const char* text : {"Usage: raio ", "\n  --size ", "\n  --accel ", " --help\n"})
      EXPECT_THAT(help, HasSubstr(text));
  }
  EXPECT_THAT(raio({"render", "-h"}).out, HasSubstr("\n  -o, --output IMAGE "));
  EXPECT_THAT(raio({"explain", "-h"}).out, HasSubstr("\n  --pixel X,Y ")) << "it is required";
  EXPECT_EQ(raio({"info", "-h"}).out, raio({"info", "--help"}).out) << "it has few options";
}

TEST_F(CommandLine, PrintsItsVersion) {
  const std::string version = raio({"--version"}).out;
  EXPECT_THAT(version,
              testing::MatchesRegex("raio [0-9.]+ \\((unknown commit|[0-9a-f]+( with changes)?, "
                                    "[0-9]{4}-[0-9]{2}-[0-9]{2})\\)\n"));
  EXPECT_EQ(raio({"version"}).out, version);
  const std::string number = version.substr(5, version.find(' ', 5) - 5);
  const std::filesystem::path root = RAIO_SOURCE_DIR;
  EXPECT_THAT(get(root / "CITATION.cff"), HasSubstr("\nversion: " + number + "\n"));
  EXPECT_THAT(get(root / "CHANGELOG.md"), HasSubstr("\n## [" + number + "] - "));
}

TEST_F(CommandLine, EveryStructureWithEveryEffect) {
  for (const char* accel : {"none", "grid", "embree", "auto"})
    for (unsigned effects = 0; effects < 8; ++effects) {
      std::vector<std::string> arguments = {"render",  "ok.nff", "-o",      "x.png",
                                            "--stats", "x.json", "--accel", accel};
      if (effects & 1) arguments.insert(arguments.end(), {"--aa", "2"});
      if (effects & 2) arguments.emplace_back("--soft-shadows");
      if (effects & 4) arguments.insert(arguments.end(), {"--dof", "--lens-samples", "3"});
      ASSERT_EQ(raio(arguments).status, 0) << accel << effects;
      const json stats = json::parse(get(file("x.json")));
      const uint64_t samples = (effects & 1 ? 4 : 1) * (effects & 4 ? 3 : 1);
      EXPECT_EQ(stats["samples_per_pixel"], samples);
      EXPECT_EQ(stats["rays"]["eye"], 24 * 16 * samples) << accel << effects;
    }
}

TEST_F(CommandLine, StatisticsFollowTheirSchema) {
  const auto statistics = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"render", "ok.nff", "--stats", "x.json"});
    EXPECT_EQ(raio(options).status, 0);
    return json::parse(get(file("x.json")));
  };
  const json s = statistics({"--accel", "grid", "--counters", "--aa", "2", "--seed", "9",
                             "--threads", "2", "--size", "30x20"});
  const std::vector<std::pair<std::string, std::vector<std::string>>> whole_numbers = {
      {"",
       {"samples_per_pixel", "seed", "threads", "depth", "lights", "materials",
        "peak_memory_bytes"}},
      {"/primitives",
       {"sphere", "triangle", "polygon", "cone", "cylinder", "ellipsoid", "disc", "plane"}},
      {"/accelerator", {"bytes", "cells", "references"}},
      {"/effects", {"aa"}},
      {"/rays", {"eye", "eye_hits", "reflection", "refraction", "shadow", "shadow_hits", "total"}}};
  for (const auto& [path, keys] : whole_numbers)
    for (const std::string& key : keys)
      EXPECT_TRUE(s.at(json::json_pointer(path + "/" + key)).is_number_unsigned() ||
                  s.at(json::json_pointer(path + "/" + key)) >= 0)
          << path << key;
  for (const char* key : {"load", "build", "render", "write", "total"})
    EXPECT_TRUE(s.at("time_s").at(key).is_number_float()) << key;
  EXPECT_TRUE(s.at("rays_per_s").is_number_float());
  EXPECT_TRUE(s.at("version").is_string());
  EXPECT_EQ(s.at("scene"), "ok");
  EXPECT_EQ(s.at("resolution"), (json{30, 20}));
  EXPECT_EQ(s.at("effects"), (json{{"aa", 2}, {"soft_shadows", false}, {"dof", false}}));
  EXPECT_EQ(s.at("seed"), 9);
  EXPECT_EQ(s.at("nan_samples"), (json{{"count", 0}, {"first_pixel", nullptr}}));
  EXPECT_EQ(s.at("threads"), 2);
  EXPECT_EQ(s.at("primitives").at("sphere"), 2);
  EXPECT_EQ(s.at("accelerator").at("name"), "grid");
  EXPECT_GT(s.at("accelerator").at("cells"), 0);
  EXPECT_GT(s.at("per_ray").at("tests"), 0);
  EXPECT_GT(s.at("per_ray").at("steps"), 0);

  const json& rays = s.at("rays");
  EXPECT_EQ(rays.at("eye"), 30 * 20 * 4);
  EXPECT_EQ(rays.at("total"), rays["eye"].get<int>() + rays["reflection"].get<int>() +
                                  rays["refraction"].get<int>() + rays["shadow"].get<int>());
  EXPECT_LE(rays.at("eye_hits"), rays.at("eye"));
  EXPECT_LE(rays.at("shadow_hits"), rays.at("shadow"));
  EXPECT_GT(rays.at("refraction"), 0);
  const json& time = s.at("time_s");
  EXPECT_GE(time["total"].get<double>(), time["load"].get<double>() + time["build"].get<double>() +
                                             time["render"].get<double>() +
                                             time["write"].get<double>());
  EXPECT_FALSE(statistics({}).contains("per_ray"));
}

TEST_F(CommandLine, StandardOutputHasOnlyThePicture) {
  const Outcome o = raio({"render", "ok.nff", "-o", "-", "--progress", "on"});
  EXPECT_EQ(o.status, 0);
  EXPECT_THAT(o.err, HasSubstr("\r"));
  EXPECT_THAT(o.err, HasSubstr(" %"));
  put(file("o.png"), o.out);
  const auto picture = read_image(file("o.png"));
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 24);
  // The last chunk of a PNG.
  EXPECT_THAT(o.out, EndsWith(std::string_view("\0\0\0\0IEND\xae\x42\x60\x82", 12)));

  const Outcome piped = raio({"render", "ok.nff", "-o", "-"});
  EXPECT_EQ(piped.out, o.out);
  EXPECT_EQ(std::ranges::count(piped.err, '\n'), 1);
  EXPECT_EQ(piped.err.find_first_of("\r\x1b"), piped.err.npos);
  EXPECT_EQ(raio({"render", "ok.nff", "-o", "-", "--quiet", "--progress", "on"}).err, "");
}

TEST_F(CommandLine, ThreadsDoNotChangeTheBytes) {
  std::vector<std::string> pictures;
  for (const char* threads : {"1", "2", "5"}) {
    EXPECT_EQ(raio({"render", "ok.nff", "-o", "x.png", "--size", "100x70", "--aa", "2", "--dof",
                    "--soft-shadows", "--threads", threads})
                  .status,
              0);
    pictures.push_back(get(file("x.png")));
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
  for (const char* setting : {"raio.scene", "raio.size", "raio.aa", "raio.aperture", "raio.dof"})
    EXPECT_THAT(pictures[0], HasSubstr(setting));
}

TEST_F(CommandLine, FormatsOfFloatsHoldTheSameValues) {
  for (const char* picture : {"x.exr", "x.pfm", "x.ppm", "x.PNG"})
    ASSERT_EQ(raio({"render", "ok.nff", "-o", picture}).status, 0);
  const auto exr = read_image(file("x.exr")), pfm = read_image(file("x.pfm"));
  ASSERT_TRUE(exr && pfm);
  for (size_t i = 0; i < exr->pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) ASSERT_EQ(exr->pixels[i][c], pfm->pixels[i][c]) << i;
  EXPECT_EQ(raio({"compare", "x.PNG", "x.ppm", "--min-psnr", "100"}).status, 0);
}

TEST_F(CommandLine, NamesThePictureAfterTheScene) {
  std::filesystem::create_directory(file("deep down"));
  // The last is no valid UTF-8.
  for (const std::string name :
       {"deep down/two words.nff", "\u00fcber.nff", "a.b.p3f", "plain", ".nff", "caf\xe9.nff"}) {
    put(file(name), kScene);
    const Outcome o = raio({"render", name, "--stats", "x.json"});
    EXPECT_EQ(o.status, 0) << o.err;
    const std::string stem = std::filesystem::path(name).stem();
    EXPECT_TRUE(read_image(file(stem + ".png"))) << stem;
    EXPECT_TRUE(json::accept(get(file("x.json"))));
  }
}

TEST_F(CommandLine, ReadsP3fWithItsLens) {
  put(file("lens.p3f"),
      replaced("resolution 24 16", "resolution 24 16\naperture 2 focal 1") + "spp 9\n");
  EXPECT_EQ(raio({"render", "lens.p3f", "--stats", "x.json"}).status, 0);
  const json stats = json::parse(get(file("x.json")));
  EXPECT_EQ(stats["effects"], (json{{"aa", 3}, {"soft_shadows", false}, {"dof", true}}));
  EXPECT_EQ(raio({"render", "lens.p3f", "--stats", "x.json", "--no-dof", "--aa", "1"}).status, 0);
  EXPECT_EQ(json::parse(get(file("x.json")))["effects"]["dof"], false);
}

TEST_F(CommandLine, GeneratedScenesGoThroughPipes) {
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  // Open until the reader runs; a quick writer is done by then.
  const int both = ::open(file("pipe").c_str(), O_RDWR | O_CLOEXEC);
  EXPECT_EQ(raio({"generate", "balls_low"}, {.output = file("pipe"), .errors = {}}).status, 0);
  const Running reader(*this, {"render", "/dev/stdin", "-o", "x.png", "--size", "32x32"},
                       {.input = file("pipe"), .output = {}, .errors = {}});
  ::close(both);
  const Outcome o = reader.wait();
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_TRUE(read_image(file("x.png")));

  for (const SceneRecipe& recipe : scene_recipes()) {
    std::vector<std::string> generate = {"generate", std::string(recipe.name), "-o", "g.nff"};
    if (recipe.max_size > 0) generate.insert(generate.end(), {"--size", "2"});
    EXPECT_EQ(raio(generate).status, 0);
    const Outcome info = raio({"info", "g.nff", "--json"});
    EXPECT_EQ(info.status, 0) << recipe.name;
    EXPECT_EQ(info.err, "") << recipe.name;
    EXPECT_GT(json::parse(info.out).at("primitive_count"), 0);
  }
}

class Interrupted : public CommandLine {
 protected:
  // It takes half a second; this only distinguishes stopping from continuing, even on a busy
  // machine.
  static constexpr double kSoon = 20;

  void expect_soon(const Running& running, int signal) {
    const auto sent = std::chrono::steady_clock::now();
    running.send(signal);
    const Outcome o = running.wait();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - sent;
    EXPECT_EQ(o.status, 130) << o.err;
    EXPECT_LT(taken.count(), kSoon);
    EXPECT_EQ(o.out, "");
    EXPECT_THAT(o.err, StartsWith("raio: interrupted"));
    EXPECT_EQ(std::ranges::count(o.err, '\n'), 1) << o.err;
  }

  // Until it is likely to work.
  static void pause(const Running& running, int signal) {
    running.wait_for_handler(signal);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
  }
};

TEST_F(Interrupted, RenderLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Running running(*this,
                          {"render", "ok.nff", "--size", "2000x2000", "--aa", "64", "-o", "x.png",
                           "--stats", "x.json"},
                          {});
    pause(running, signal);
    expect_soon(running, signal);
    EXPECT_EQ(names(), std::vector<std::string>{"ok.nff"});
  }
}

TEST_F(Interrupted, LoadingLeavesNothing) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer holds signals back while a read waits";
#endif
  // A pipe without a writer: it waits for the scene.
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  const int writer = ::open(file("pipe").c_str(), O_RDWR | O_CLOEXEC);
  const Running running(*this, {"render", "pipe", "-o", "x.png"}, {});
  pause(running, SIGINT);
  expect_soon(running, SIGINT);
  ::close(writer);
  EXPECT_EQ(names(), (std::vector<std::string>{"ok.nff", "pipe"}));
}

// Without having to be ended, which has another message.
TEST_F(Interrupted, CommandsStopThemselvesWhileTheyRead) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer holds signals back while a read waits";
#endif
  ASSERT_EQ(::mkfifo(file("balls.nff").c_str(), 0600), 0);
  const int both = ::open(file("balls.nff").c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  ASSERT_GE(both, 0);
  std::jthread writer([&](const std::stop_token& done) {
    while (!done.stop_requested()) {
      [[maybe_unused]] const ssize_t count = ::write(both, "# endless\n", 10);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const std::vector<std::string> commands[] = {{"info", "balls.nff"},
                                               {"convert", "balls.nff", "x.nff"},
                                               {"export", "balls.nff", "-o", "x.pov"},
                                               {"explain", "balls.nff", "--pixel", "0,0"},
                                               {"bench", "balls.nff", "--csv", "x.csv"},
                                               {"spd", "verify", "balls.nff"},
                                               {"merge", "balls.nff", "-o", "x.png"},
                                               {"compare", "balls.nff", "y.png"}};
  for (const auto& command : commands) {
    const Running running(*this, command, {});
    pause(running, SIGINT);
    running.send(SIGINT);
    const Outcome o = running.wait();
    EXPECT_EQ(o.status, 130) << command[0];
    EXPECT_EQ(o.out, "") << command[0];
    EXPECT_EQ(o.err, "raio: interrupted; nothing was written\n") << command[0];
  }
  writer = {};
  ::close(both);
  EXPECT_EQ(names(), (std::vector<std::string>{"balls.nff", "ok.nff"}));
}

TEST_F(Interrupted, BuildingLeavesNothing) {
  // Forty coincident spheres, each in all of thirty million cells.
  std::string many;
  for (int i = 0; i < 40; ++i) many += "s 0 0 0 1\n";
  put(file("ok.nff"), std::string(kScene) + many);
  const Running running(
      *this, {"render", "ok.nff", "--grid-resolution", "300x300x300", "-o", "x.png"}, {});
  pause(running, SIGINT);
  expect_soon(running, SIGINT);
  EXPECT_EQ(names(), std::vector<std::string>{"ok.nff"});
}

TEST_F(Interrupted, GeneratingLeavesNothing) {
  const Running running(*this, {"generate", "balls", "--size", "7", "-o", "x.nff"}, {});
  pause(running, SIGTERM);
  expect_soon(running, SIGTERM);
  EXPECT_EQ(names(), std::vector<std::string>{"ok.nff"});
}

TEST_F(Interrupted, WritingLeavesNoTemporaryFile) {
  namespace fs = std::filesystem;
  const Running running(*this, {"generate", "balls", "--size", "6", "-o", "x.nff"}, {});
  const auto half_written = [&] {
    for (const auto& entry : fs::directory_iterator(folder())) {
      std::error_code gone;
      if (entry.path().extension() == ".tmp" && entry.file_size(gone) > 0 && !gone) return true;
    }
    return false;
  };
  // At the latest it is written whole.
  while (!half_written() && !fs::exists(file("x.nff"))) std::this_thread::yield();
  running.send(SIGINT);
  running.send(SIGTERM);
  const Outcome o = running.wait();
  if (o.status == 0)
    EXPECT_EQ(names(), (std::vector<std::string>{"ok.nff", "x.nff"}));
  else
    EXPECT_EQ(o.status, 130);
  for (const std::string& name : names()) EXPECT_FALSE(name.ends_with(".tmp")) << name;
}

// Strings are unchanged, and so is the data.
TEST(Json, AnArrayOfNumbersStandsOnOneLine) {
  const app::Json data = app::Json::parse(
      R"({"a": [1, -2.5e-9, 3], "b": [[1, 2], []], "c": "[1,\n 2] \" [3, 4]", "d\\": ["x", 1]})");
  const std::string text = app::json_text(data);
  EXPECT_EQ(text, R"({
  "a": [1, -2.5e-09, 3],
  "b": [
    [1, 2],
    []
  ],
  "c": "[1,\n 2] \" [3, 4]",
  "d\\": [
    "x",
    1
  ]
}
)");
  EXPECT_EQ(app::Json::parse(text), data);
}

}  // namespace
}  // namespace raio::core
