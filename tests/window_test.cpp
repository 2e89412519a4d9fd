// The real window, with real keys and a real mouse, on a separate display.
#include <X11/keysym.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "io/nff/nff.h"
#include "view/state.h"
#include "window_fixture.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using Held = WindowDriver::Held;

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

TEST_F(WindowTest, DigitsSelectViews) {
  // In a tree every ray would visit the only node, and each pixel has one sample.
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

TEST_F(WindowTest, MouseMovesTheCameraAndAKeyResetsIt) {
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

TEST_F(WindowTest, TheFocusToolFocusesAndTheWheelSetsTheAperture) {
  const auto window = open();
  const auto read = read_nff(file("scene.nff"));
  const auto accel = build_accel(read->scene, {});
  const auto expected = view::pick(**accel, read->scene.camera, 111.0 / 160, 60.0 / 120, 4.0 / 3);
  ASSERT_EQ(expected.what, "sphere 1");

  // A click alone selects.
  size_t from = window->mark();
  window->click(111, 60);
  ASSERT_TRUE(window->wait_for("sphere 1, material 1, at ", from)) << window->log();
  EXPECT_EQ(window->log().find("request: ", 0), window->log().rfind("request: ")) << window->log();
  from = window->mark();
  window->key(XK_e);
  ASSERT_TRUE(window->wait_for("click what shall be sharp", from)) << window->log();
  from = window->mark();
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

TEST_F(WindowTest, ResizesMinimisesAndQuits) {
  // The room between the bars and the panel.
  const auto window = open_filled(715, 371);
  ASSERT_TRUE(window->wait_for("picture: 400x300 samples 1", 0)) << window->log();
  size_t from = window->mark();
  window->resize(735, 371);
  ASSERT_TRUE(window->wait_for("size: 420x300", from)) << window->log();
  ASSERT_TRUE(window->wait_for("picture: 420x300 samples 1", from)) << window->log();
  from = window->mark();
  window->key(XK_h);
  ASSERT_TRUE(window->wait_for("picture: 735x300 samples 1", from)) << window->log();
  window->minimise(true);
  window->minimise(false);
  from = window->mark();
  window->key(XK_s);
  ASSERT_TRUE(window->picture(from)) << window->log();
  window->key(XK_q);
  EXPECT_EQ(window->end(), 0) << window->log();
}

TEST_F(WindowTest, HidingThePanelTwiceGivesTheSamePictureBack) {
  const auto window = open_filled(715, 371);
  ASSERT_TRUE(window->wait_for("picture: 400x300 samples 1", 0)) << window->log();
  const auto before = window->picture(1);
  size_t from = window->mark();
  window->key(XK_h);
  ASSERT_TRUE(window->wait_for("panel hidden", from)) << window->log();
  EXPECT_NE(window->picture(from)->sum, before->sum);
  from = window->mark();
  window->key(XK_h);
  ASSERT_TRUE(window->wait_for("size: 400x300", from)) << window->log();
  EXPECT_EQ(window->picture(from)->sum, before->sum);
}

TEST_F(WindowTest, UndoesAndRedoesEveryChange) {
  const auto window = open();
  std::vector<std::string> sums = {window->picture(0)->sum};
  const auto change = [&](const auto& hand) {
    const size_t from = window->mark();
    hand();
    const auto after = window->picture(from);
    ASSERT_TRUE(after) << window->log();
    ASSERT_NE(after->sum, sums.back()) << window->log();
    sums.push_back(after->sum);
  };
  change([&] { window->key(XK_r); });
  change([&] { window->key(XK_2); });
  change([&] { window->key(XK_1); });
  change([&] {
    window->drag(80, 60, 110, 70);
    ASSERT_TRUE(window->wait_for("camera: ", window->mark() - 1)) << window->log();
  });
  for (size_t i = sums.size() - 1; i-- > 0;) {
    const size_t from = window->mark();
    window->key(XK_z, Held::ctrl);
    ASSERT_TRUE(window->wait_for("undone", from)) << window->log();
    EXPECT_EQ(window->picture(from)->sum, sums[i]) << i;
  }
  size_t from = window->mark();
  window->key(XK_z, Held::ctrl);
  ASSERT_TRUE(window->wait_for("nothing to undo", from)) << window->log();
  for (size_t i = 1; i < sums.size(); ++i) {
    from = window->mark();
    window->key(XK_y, Held::ctrl);
    ASSERT_TRUE(window->wait_for("redone", from)) << window->log();
    EXPECT_EQ(window->picture(from)->sum, sums[i]) << i;
  }
  from = window->mark();
  window->key(XK_y, Held::ctrl);
  EXPECT_TRUE(window->wait_for("nothing to redo", from)) << window->log();
}

TEST_F(WindowTest, LettersWithCtrlSwitchNoEffect) {
  const auto window = open();
  const size_t from = window->mark();
  for (const unsigned long key : {XK_a, XK_d, XK_g, XK_r}) window->key(key, Held::ctrl);
  window->key(XK_t);
  ASSERT_TRUE(window->wait_for("refraction off", from)) << window->log();
  for (const char* said : {"antialiasing on", "depth of field on", "structure", "reflection off"})
    EXPECT_EQ(window->log().find(said), std::string::npos) << said;
}

TEST_F(WindowTest, ChangesColoursAndType) {
  const auto window = open_filled(715, 371);
  size_t from = window->mark();
  window->key(XK_l);
  ASSERT_TRUE(window->wait_for("light colours", from)) << window->log();
  from = window->mark();
  window->key(XK_l);
  ASSERT_TRUE(window->wait_for("dark colours", from)) << window->log();
  // Bigger bars leave less for the picture, and the panel is folded away.
  from = window->mark();
  window->key(XK_b);
  ASSERT_TRUE(window->wait_for("size: 715x2", from)) << window->log();
  from = window->mark();
  window->key(XK_b);
  ASSERT_TRUE(window->wait_for("normal type", from)) << window->log();
  ASSERT_TRUE(window->wait_for("size: 400x300", from)) << window->log();
}

TEST_F(WindowTest, HelpTakesTheKeysUntilEscape) {
  const auto window = open();
  for (const unsigned long closes : {XK_F1, XK_Escape}) {
    size_t from = window->mark();
    window->key(XK_F1);
    ASSERT_TRUE(window->wait_for(" types", from)) << window->log();
    from = window->mark();
    window->key(XK_a);  // into the search
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    window->key(closes);
    ASSERT_TRUE(window->wait_for(" typed", from)) << window->log();
  }
  const size_t from = window->mark();
  window->key(XK_s);
  ASSERT_TRUE(window->wait_for("soft shadows on", from)) << window->log();
  EXPECT_EQ(window->log().find("antialiasing on"), std::string::npos) << window->log();
  EXPECT_TRUE(window->is_running());
}

TEST_F(WindowTest, TogglesFullScreen) {
  const auto window = open_filled(715, 371);
  size_t from = window->mark();
  window->key(XK_F11);
  ASSERT_TRUE(window->wait_for("size: 965x953", from)) << window->log();
  from = window->mark();
  window->key(XK_Escape);
  ASSERT_TRUE(window->wait_for("size: 400x300", from)) << window->log();
  EXPECT_TRUE(window->is_running());
}

TEST_F(WindowTest, EveryOtherKeyResponds) {
  const auto window = open();
  const auto says = [&](unsigned long key, const char* said, Held held = Held::nothing) {
    const size_t from = window->mark();
    window->key(key, held);
    EXPECT_TRUE(window->wait_for(said, from)) << said << window->log();
  };
  // A key pressed again at once counts as held.
  says(XK_space, "paused");
  says(XK_f, "the scene fits");
  says(XK_space, "resumed");
  says(XK_Home, "the scene's own camera");
  says(XK_c, "copied: .* render scene.nff .* -o scene.png");
  says(XK_z, "undone", Held::ctrl);
  says(XK_z, "redone", Held::ctrl_shift);
  says(XK_x, "side by side");
  says(XK_r, "reflection off");
  says(XK_x, "one picture");
}

TEST_F(WindowTest, ToolsMatchTheirKeys) {
  const auto window = open();
  const auto place = window->wait_for("place: ([0-9]+),([0-9]+)", 0);
  ASSERT_TRUE(place);
  const int left = std::stoi(place->groups[1]), top = std::stoi(place->groups[2]);
  // Two tools, a gap, two more, a gap, and the effects, each as wide as two heights of the text.
  for (const auto& [x, said] : {std::pair(159, "antialiasing on"),
                                {189, "soft shadows on"},
                                {219, "depth of field on"},
                                {249, "reflection off"},
                                {279, "refraction off"},
                                {90, "undone"},
                                {120, "redone"}}) {
    const size_t from = window->mark();
    window->move(x - left, 21 - top);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    window->button(1, true);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    window->button(1, false);
    ASSERT_TRUE(window->wait_for(said, from)) << said << window->log();
  }
  // From the tool bar straight to the picture: the click is the picture's.
  const size_t from = window->mark();
  window->click(111, 60);
  EXPECT_TRUE(window->wait_for("sphere 1, material 1, at ", from)) << window->log();
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
  remember("section What each effect costs");
  const auto window = open({"--size", "32x32"});
  ASSERT_TRUE(window->wait_for("measures the costs", 0)) << window->log();
  const size_t from = window->mark();
  window->key(XK_m);
  ASSERT_TRUE(window->wait_for("measured the table", from)) << window->log();
}

TEST_F(WindowTest, MeasuresCostsAtRestAndStopsForInput) {
  remember("section What each effect costs");
  const auto window = open({"--soft-shadows", "--samples", "16"});
  auto costs = window->wait_for("measures the costs", 0);
  ASSERT_TRUE(costs) << window->log();
  // A measurement interrupted by a key restarts afterwards, for the new picture.
  size_t from = window->mark();
  window->key(XK_s);
  ASSERT_TRUE(window->picture(from)) << window->log();
  ASSERT_TRUE(window->wait_for("soft shadows off: .* per sample, before ", from)) << window->log();
  costs = window->wait_for("measures the costs", from);
  ASSERT_TRUE(costs) << window->log();
  ASSERT_TRUE(window->wait_for("measured the costs", costs->next)) << window->log();
  for (const char* line : {"soft shadows: [0-9.]+ x.*rays .* x, tests .* x, steps .* x",
                           "refraction: [0-9.]+ x", "structure: [0-9.]+ x faster"})
    EXPECT_TRUE(window->wait_for(line, costs->next)) << line << window->log();
  // Then nothing is left to do: no new picture, and almost no CPU time, even if sanitizers make
  // disk checks more expensive; continued drawing would take a whole core.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  for (const bool minimised : {false, true}) {
    if (minimised) window->minimise(true);
    const double before_s = window->processor_s();
    from = window->mark();
    std::this_thread::sleep_for(std::chrono::seconds(2));
    EXPECT_LE(window->processor_s() - before_s, 0.2) << (minimised ? "minimised" : "at rest");
    EXPECT_EQ(window->mark(), from) << window->log();
  }
  window->minimise(false);
}

TEST_F(WindowTest, ShowsBoxesOfTheStructure) {
  const auto window = open();
  const auto before = window->picture(0);
  ASSERT_TRUE(before);
  size_t from = window->mark();
  window->key(XK_k);
  EXPECT_TRUE(window->wait_for("boxes of the structure shown", from)) << window->log();
  from = window->mark();
  window->key(XK_k);
  EXPECT_TRUE(window->wait_for("boxes of the structure hidden", from)) << window->log();
}

TEST_F(WindowTest, MeasuresGridsAndStops) {
  const auto window = open({"--size", "64x48"});
  size_t from = window->mark();
  window->key(XK_n);
  EXPECT_TRUE(window->wait_for("measuring grids from coarse to fine; n stops", from));
  EXPECT_TRUE(window->wait_for("measured the curve", from)) << window->log();
  from = window->mark();
  window->key(XK_n), window->key(XK_n);
  EXPECT_TRUE(window->wait_for("stopped", from)) << window->log();
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

// RAIO_RANDOM_SECONDS: runs for this long, with different events for each number.
TEST_F(WindowTest, SurvivesAThousandRandomEvents) {
  const char* const text = std::getenv("RAIO_RANDOM_SECONDS");
  const int seconds = text ? std::atoi(text) : 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  auto window = open();
  std::mt19937 random(20260101u + unsigned(seconds));
  const auto below = [&](int n) { return int(random() % unsigned(n)); };
  std::vector<unsigned long> keys = {XK_F1,   XK_F11, XK_Escape, XK_Return, XK_Tab,  XK_BackSpace,
                                     XK_Home, XK_Up,  XK_Down,   XK_Left,   XK_Right};
  // Not q, which ends it.
  for (const char c : std::string("aabcddefgghhiijklmnooprssttuvwxyz 1234567890.,-ii"))
    keys.push_back(static_cast<unsigned long>(c));
  constexpr Held kHeld[] = {Held::nothing, Held::nothing, Held::nothing,   Held::nothing,
                            Held::shift,   Held::ctrl,    Held::ctrl_shift};
  for (int i = 0; i < 1000 || std::chrono::steady_clock::now() < end; ++i) {
    const int x = below(1000), y = below(700);
    switch (below(8)) {
      case 0:
        window->drag(x, y, below(1000), below(700), 1 + below(3));
        break;
      case 1:
        window->wheel(x, y, below(7) - 3);
        break;
      case 2:
        window->click(x, y);
        break;
      case 3:
        if (below(4) == 0) window->resize(64 + below(1000), 64 + below(700));
        break;
      case 4:
        if (below(20) == 0) window->minimise(true), window->minimise(false);
        break;
      default:
        window->key(keys[size_t(below(int(keys.size())))], kHeld[below(std::size(kHeld))]);
    }
    // Some come in a burst, others during rendering.
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
}  // namespace raio::core
