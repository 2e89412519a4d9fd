// The real window, with real keys and a real mouse, on a display of its own.
#include <X11/keysym.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <random>

#include "io/image/image.h"
#include "io/nff/nff.h"
#include "temporary_folder.h"
#include "view/state.h"
#include "window_driver.h"

namespace raio {
namespace {

using testing::HasSubstr;

// A mirror, a ball of glass and a coloured one over a floor.
constexpr std::string_view kScene =
    "b 0.1 0.2 0.3\n"
    "v\nfrom 0 -6 2\nat 0 0 0.5\nup 0 0 1\nangle 40\nhither 0\nresolution 160 120\n"
    "l 3 -4 5\n"
    "f 1 0 0 0.8 0.4 10 0 1\ns 0 0 0.7 0.7\n"
    "f 0 1 0 0.8 0 1 0 1\ns 1.4 -0.5 0.5 0.5\n"
    "f 1 1 1 0.1 0.1 10 0.8 1.5\ns -1.4 -0.8 0.5 0.5\n"
    "f 0.8 0.8 0.7 0.9 0 1 0 1\np 4\n-5 -5 0\n5 -5 0\n5 5 0\n-5 5 0\n";

class WindowTest : public TemporaryFolder {
 protected:
  static void SetUpTestSuite() { display_ = new Display; }
  static void TearDownTestSuite() { delete std::exchange(display_, nullptr); }

  void SetUp() override {
    ASSERT_FALSE(display_->name().empty()) << "Xvfb does not start; packages.txt has it";
    put(file("scene.nff"), kScene);
  }

  std::unique_ptr<WindowDriver> open(std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.begin(), "scene.nff");
    return std::make_unique<WindowDriver>(*display_, arguments, folder().string());
  }

  // Runs a command line of the log with another name for the picture.
  void run(std::string command, const std::string& output) const {
    ASSERT_TRUE(command.starts_with("raio render ")) << command;
    command = RAIO_PROGRAM + command.substr(4, command.rfind(" -o ") - 4) + " -o " + output;
    ASSERT_EQ(std::system(("cd " + folder().string() + " && " + command + " --quiet").c_str()), 0)
        << command;
  }

  static Display* display_;
};
Display* WindowTest::display_ = nullptr;

TEST_F(WindowTest, EveryEffectKeyChangesThePictureAndTheTitle) {
  const auto window = open();
  auto before = window->picture(0);
  ASSERT_TRUE(before) << window->log();
  for (const auto& [key, says, title] : {std::tuple(XK_a, "antialiasing on", "antialiasing"),
                                         {XK_s, "soft shadows on", "soft shadows"},
                                         {XK_d, "depth of field on", "depth of field"},
                                         {XK_r, "reflection off", ""},
                                         {XK_t, "refraction off", ""}}) {
    const size_t from = window->mark();
    window->key(key);
    ASSERT_TRUE(window->wait_for(says, from)) << window->log();
    const auto after = window->picture(from);
    ASSERT_TRUE(after) << window->log();
    EXPECT_NE(after->sum, before->sum) << says;
    EXPECT_THAT(window->title(), HasSubstr(title));
    before = after;
  }
  EXPECT_THAT(window->title(), testing::Not(HasSubstr("refraction")));
}

TEST_F(WindowTest, StructuresShowTheSamePicture) {
  const auto window = open();
  const auto before = window->picture(0);
  for (const char* name : {"grid", "embree", "none", "bvh"}) {
    const size_t from = window->mark();
    window->key(XK_g);
    ASSERT_TRUE(window->wait_for(std::string("structure ") + name, from)) << window->log();
    const auto after = window->picture(from);
    ASSERT_TRUE(after) << window->log();
    if (std::string(name) != "embree") {
      EXPECT_EQ(after->sum, before->sum) << name;
    }
    EXPECT_THAT(window->title(), HasSubstr(name));
  }
}

TEST_F(WindowTest, DigitsShowWhatIsBehindThePicture) {
  // In a tree every ray would visit the one node there is, and each pixel has one sample.
  const auto window = open({"--accel", "grid"});
  std::vector<std::string> sums = {window->picture(0)->sum};
  for (unsigned long key = XK_2; key <= XK_9; ++key) {
    const size_t from = window->mark();
    window->key(key);
    const auto shown = window->picture(from);
    ASSERT_TRUE(shown) << window->log();
    EXPECT_THAT(sums, testing::Not(testing::Contains(shown->sum))) << window->log();
    sums.push_back(shown->sum);
  }
  const size_t from = window->mark();
  window->key(XK_1);
  EXPECT_EQ(window->picture(from)->sum, sums.front());
}

TEST_F(WindowTest, HandsMoveTheCameraAndOneKeyBringsTheScenesBack) {
  const auto window = open();
  const auto before = window->picture(0);
  const auto moves = [&](const char* what, const auto& hand) {
    const size_t from = window->mark();
    hand();
    const auto rest = window->wait_for("camera: ", from);
    ASSERT_TRUE(rest) << what << window->log();
    const auto after = window->picture(rest->next - 1);
    ASSERT_TRUE(after) << what << window->log();
    EXPECT_NE(after->sum, before->sum) << what;
    const size_t home = window->mark();
    window->key(XK_o);
    EXPECT_EQ(window->picture(home)->sum, before->sum) << what;
  };
  moves("orbit", [&] { window->drag(80, 60, 110, 70); });
  moves("pan", [&] { window->drag(80, 60, 110, 70, 2); });
  moves("look", [&] { window->drag(80, 60, 90, 70, 3); });
  moves("dolly", [&] { window->wheel(60, 50, 2); });
  moves("walk", [&] {
    window->hold(XK_Up, true);
    ASSERT_TRUE(window->wait_for("picture: .* samples 0", window->mark()));
    window->hold(XK_Up, false);
  });
  moves("walk with w", [&] {
    window->move(80, 60);
    window->button(3, true);
    window->hold(XK_w, true);
    ASSERT_TRUE(window->wait_for("picture: .* samples 0", window->mark()));
    window->hold(XK_w, false);
    window->button(3, false);
  });
}

TEST_F(WindowTest, AClickFocusesOnWhatIsThereAndTheWheelSetsTheAperture) {
  const auto window = open();
  const auto read = read_nff(file("scene.nff"));
  const auto accel = build_accel(read->scene, {});
  const auto expected = view::pick(**accel, read->scene.camera, 111.0 / 160, 60.0 / 120, 4.0 / 3);
  ASSERT_EQ(expected.what, "sphere 1");

  const size_t from = window->mark();
  window->click(111, 60);
  const auto focus = window->wait_for("focus on (.*), distance ([0-9.]+)", from);
  ASSERT_TRUE(focus) << window->log();
  EXPECT_EQ(focus->groups[1], expected.what);
  EXPECT_NEAR(std::stod(focus->groups[2]), expected.depth, 1e-4);
  ASSERT_TRUE(window->wait_for("other: ", from)) << "the plane in focus is not shown";
  const auto before = window->picture(from);
  EXPECT_THAT(window->title(), HasSubstr("depth of field"));

  const size_t wheel = window->mark();
  window->wheel(111, 60, 3);
  ASSERT_TRUE(window->wait_for("aperture ", wheel)) << window->log();
  EXPECT_NE(window->picture(wheel)->sum, before->sum);
  EXPECT_FALSE(window->log().find("camera: ") < std::string::npos) << "the wheel moved the camera";
}

TEST_F(WindowTest, SavedPicturesAreThoseOfTheCommandLine) {
  const auto window = open({"--light-size", "0.5", "--soft-shadows"});
  window->key(XK_a);
  window->key(XK_d);
  window->drag(80, 60, 113, 77);
  ASSERT_TRUE(window->wait_for("camera: ", 0)) << window->log();
  for (const auto& [shift, suffix] : {std::pair(false, ".png"), {true, ".exr"}}) {
    const size_t from = window->mark();
    ASSERT_TRUE(window->wait_for("picture: .* samples [5-9]", from)) << window->log();
    window->key(XK_p, shift);
    const auto saved = window->wait_for("saved (.*)", from);
    ASSERT_TRUE(saved) << window->log();
    EXPECT_EQ(saved->groups[1], std::string("scene") + suffix);
    const auto command = window->wait_for("command: (.*)", from);
    ASSERT_TRUE(command) << window->log();
    EXPECT_THAT(command->groups[1], HasSubstr(" --samples "));
    run(command->groups[1], std::string("again") + suffix);
    EXPECT_TRUE(get(file(saved->groups[1])) == get(file(std::string("again") + suffix)))
        << command->groups[1];
    window->key(XK_s);  // another one
  }
  // A second one does not replace the first.
  const size_t from = window->mark();
  window->key(XK_p);
  EXPECT_EQ(window->wait_for("saved (.*)", from)->groups[1], "scene-2.png");
}

// The bytes that are shown, and those that are saved, are of the exposure and the tone curve.
TEST_F(WindowTest, ShowsPicturesAsTheyAreWritten) {
  const auto window =
      open({"--aa", "1", "--exposure", "0.5", "--tone", "agx", "--background", "navy"});
  const auto shown = window->picture(0);
  ASSERT_TRUE(shown) << window->log();
  size_t from = window->mark();
  window->key(XK_p);
  const auto command = window->wait_for("command: (.*)", from);
  ASSERT_TRUE(command) << window->log();
  ASSERT_TRUE(window->wait_for("saved scene.png", from)) << window->log();
  run(command->groups[1], "again.png");
  EXPECT_TRUE(get(file("scene.png")) == get(file("again.png"))) << command->groups[1];
  const auto picture = read_image(file("again.png"));
  ASSERT_TRUE(picture);
  uint64_t sum = 14695981039346656037u;  // FNV-1a, as Texture::checksum() has it
  for (const Rgb& c : picture->pixels)
    for (const uint8_t byte : {to_byte(c.x), to_byte(c.y), to_byte(c.z), uint8_t(255)})
      sum = (sum ^ byte) * 1099511628211u;
  EXPECT_EQ(shown->sum, fmt::format("{:016x}", sum));
  // A view has no exposure, and it is not lost by looking at one.
  from = window->mark();
  window->key(XK_2);
  ASSERT_TRUE(window->picture(from)) << window->log();
  from = window->mark();
  window->key(XK_1);
  EXPECT_EQ(window->picture(from)->sum, shown->sum);
}

TEST_F(WindowTest, ABrokenEditKeepsTheSceneAndAGoodOneReplacesIt) {
  const auto window = open();
  const auto before = window->picture(0);
  size_t from = window->mark();
  put(file("scene.nff"), "b 0 0 0\ns 1 2 three 4\n");
  ASSERT_TRUE(window->wait_for("scene.nff:2:7: error: ", from)) << window->log();
  from = window->mark();
  window->key(XK_2);
  window->key(XK_1);
  ASSERT_TRUE(window->wait_for("view: picture", from));
  EXPECT_EQ(window->picture(window->wait_for("view: picture", from)->next)->sum, before->sum);

  from = window->mark();
  put(file("scene.nff"), std::string(kScene) + "f 0 0 1 1 0 1 0 1\ns 0 -2 0.4 0.4\n");
  ASSERT_TRUE(window->wait_for("opened scene.nff", from)) << window->log();
  EXPECT_NE(window->picture(from)->sum, before->sum);
}

TEST_F(WindowTest, ResizesMinimisesAndEnds) {
  const auto window = open();
  size_t from = window->mark();
  window->resize(700, 300);
  ASSERT_TRUE(window->wait_for("size: 400x300", from)) << window->log();
  ASSERT_TRUE(window->wait_for("picture: 400x300 samples 1", from)) << window->log();
  from = window->mark();
  window->key(XK_h);
  ASSERT_TRUE(window->wait_for("picture: 700x300 samples 1", from)) << window->log();
  window->minimise(true);
  window->minimise(false);
  from = window->mark();
  window->key(XK_s);
  ASSERT_TRUE(window->picture(from)) << window->log();
  window->key(XK_q);
  EXPECT_EQ(window->end(), 0) << window->log();
}

TEST_F(WindowTest, SplitsThePicture) {
  const auto window = open({"--soft-shadows"});
  window->key(XK_s);
  const size_t from = window->mark();
  window->key(XK_x);
  const auto other =
      window->wait_for("other: 160x120 samples [1-9][0-9]* .* sum ([0-9a-f]+)", from);
  ASSERT_TRUE(other) << window->log();
  const auto main = window->picture(from);
  ASSERT_TRUE(main);
  EXPECT_NE(other->groups[1], main->sum);
}

TEST_F(WindowTest, MeasuresTheSixteenEvenWhileItMeasuresCosts) {
  const auto window = open({"--size", "32x32"});
  ASSERT_TRUE(window->wait_for("measures the costs", 0)) << window->log();
  const size_t from = window->mark();
  window->key(XK_m);
  ASSERT_TRUE(window->wait_for("measured the table", from)) << window->log();
}

TEST_F(WindowTest, MeasuresWhatEffectsCostAtRestAndStopsForInput) {
  const auto window = open();
  auto costs = window->wait_for("measures the costs", 0);
  ASSERT_TRUE(costs) << window->log();
  // What is measured when a key comes begins again afterwards, for the new picture.
  size_t from = window->mark();
  window->key(XK_s);
  ASSERT_TRUE(window->picture(from)) << window->log();
  ASSERT_TRUE(window->wait_for("soft shadows on: .* a sample, before ", from)) << window->log();
  costs = window->wait_for("measures the costs", from);
  ASSERT_TRUE(costs) << window->log();
  ASSERT_TRUE(window->wait_for("measured the costs", costs->next)) << window->log();
  for (const char* line : {"soft shadows: [0-9.]+ x.*rays .* x, tests .* x, steps .* x",
                           "refraction: [0-9.]+ x", "structure: [0-9.]+ x faster"})
    EXPECT_TRUE(window->wait_for(line, costs->next)) << line << window->log();
}

TEST_F(WindowTest, WhatIsNotInTheSceneHasNoCost) {
  put(file("scene.nff"),
      "b 0.1 0.2 0.3\nv\nfrom 0 -6 2\nat 0 0 0.5\nup 0 0 1\nangle 40\nhither 0\n"
      "resolution 160 120\nf 1 0 0 0.8 0 10 0 1\ns 0 0 0.7 0.7\n");
  const auto window = open();
  ASSERT_TRUE(window->wait_for("measured the costs", 0)) << window->log();
  for (const char* effect : {"soft shadows", "reflection", "refraction"})
    EXPECT_THAT(window->log(), HasSubstr(std::string(effect) + ": not in this scene"));
}

TEST_F(WindowTest, TheSameKeyStopsALongMeasurement) {
  const auto window = open({"--size", "512x384"});
  size_t from = window->mark();
  window->key(XK_m);
  ASSERT_TRUE(window->wait_for("measuring all combinations", from)) << window->log();
  from = window->mark();
  window->key(XK_m);
  ASSERT_TRUE(window->wait_for("stopped", from)) << window->log();
  from = window->mark();
  window->key(XK_s);
  EXPECT_TRUE(window->picture(from)) << "the picture lives on" << window->log();
}

TEST_F(WindowTest, SurvivesAThousandRandomEvents) {
  auto window = open();
  std::mt19937 random(20260101);
  const auto below = [&](int n) { return int(random() % unsigned(n)); };
  const std::string keys = "asdgrtx hfo123456789cwe";
  for (int i = 0; i < 1000; ++i) {
    const int x = below(520), y = below(400);
    switch (below(8)) {
      case 0:
        window->drag(x, y, below(520), below(400), 1 + below(3));
        break;
      case 1:
        window->wheel(x, y, below(7) - 3);
        break;
      case 2:
        window->click(x, y);
        break;
      case 3:
        if (below(4) == 0) window->resize(64 + below(600), 64 + below(500));
        break;
      case 4:
        if (below(20) == 0) window->minimise(true), window->minimise(false);
        break;
      default:
        window->key(static_cast<unsigned long>(keys[size_t(below(int(keys.size())))]));
    }
    // Some come in a burst, others meet pictures in the making.
    if (i % 8 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (window->is_running()) continue;
    // The panel has a button for that.
    ASSERT_EQ(window->end(), 0) << window->log();
    window = open();
  }
  // Whatever is open or held, Escape ends it; in a field of the panel the first one leaves that.
  for (int number = 1; number <= 3; ++number) window->button(number, false);
  while (window->is_running()) {
    window->key(XK_Escape);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_EQ(window->end(), 0) << window->log();
}

TEST_F(WindowTest, WithoutADisplaySaysWhatToDo) {
  const std::string command = "cd " + folder().string() + " && env -u DISPLAY -u WAYLAND_DISPLAY " +
                              RAIO_PROGRAM " view scene.nff 2> said";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 3);
  const std::string said = get(file("said"));
  EXPECT_THAT(said, HasSubstr("raio render"));
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
}

}  // namespace
}  // namespace raio
