// The ray inspector in the real window.
#include <X11/keysym.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <thread>
#include <utility>

#include "window_fixture.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using Held = WindowDriver::Held;

class InspectorWindowTest : public WindowTest {
 protected:
  void SetUp() override {
    WindowTest::SetUp();
    if (!HasFatalFailure()) window_ = open({"--soft-shadows"});
  }

  // The log line of the result.
  std::optional<WindowDriver::Line> click_with_shift(int x, int y) {
    const size_t from = window_->mark();
    window_->hold(XK_Shift_L, true);
    window_->click(x, y);
    window_->hold(XK_Shift_L, false);
    return found(from);
  }
  std::optional<WindowDriver::Line> found(size_t from) {
    return window_->wait_for("inspected: ([0-9]+) rays, sample ([0-9]+), rgb (.*)", from);
  }

  std::unique_ptr<WindowDriver> window_;
};

TEST_F(InspectorWindowTest, AClickShowsTheRaysOfExplain) {
  const auto with_shift = click_with_shift(80, 55);
  ASSERT_TRUE(with_shift) << window_->log();
  EXPECT_GE(std::stoi(with_shift->groups[1]), 3) << "eye ray, shadow ray, reflected ray";

  size_t from = window_->mark();
  window_->key(XK_i);
  ASSERT_TRUE(window_->wait_for("click a pixel", from)) << window_->log();
  window_->click(80, 55);
  const auto with_key = found(from);
  ASSERT_TRUE(with_key) << window_->log();
  EXPECT_EQ(with_key->groups[0], with_shift->groups[0]);

  // An effect that is switched changes the rays at once, and back.
  from = window_->mark();
  window_->key(XK_r);
  const auto dull = found(from);
  ASSERT_TRUE(dull) << window_->log();
  EXPECT_LT(std::stoi(dull->groups[1]), std::stoi(with_key->groups[1]));
  from = window_->mark();
  window_->key(XK_r);
  const auto again = found(from);
  ASSERT_TRUE(again) << window_->log();
  EXPECT_EQ(again->groups[0], with_key->groups[0]);

  // Escape leaves the inspector, and only then the window.
  from = window_->mark();
  window_->key(XK_Escape);
  ASSERT_TRUE(window_->wait_for("inspector closed", from)) << window_->log();
  window_->key(XK_Escape);
  EXPECT_EQ(window_->end(), 0) << window_->log();
}

TEST_F(InspectorWindowTest, StepsGoForwardAndBackAndPlay) {
  ASSERT_TRUE(click_with_shift(80, 55)) << window_->log();
  size_t from = window_->mark();
  window_->key(XK_period);
  const auto first = window_->wait_for("step 1 of ([0-9]+) of ray 0", from);
  ASSERT_TRUE(first) << window_->log();
  EXPECT_GE(std::stoi(first->groups[1]), 2);
  from = window_->mark();
  window_->key(XK_period);
  ASSERT_TRUE(window_->wait_for("step 2 of [0-9]+ of ray 0", from)) << window_->log();
  from = window_->mark();
  window_->key(XK_comma);
  ASSERT_TRUE(window_->wait_for("step 1 of [0-9]+ of ray 0", from)) << window_->log();
  window_->key(XK_Return);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  from = window_->mark();
  window_->key(XK_Return);
  const auto later = window_->wait_for("step ([0-9]+) of [0-9]+ of ray ([0-9]+)", from);
  ASSERT_TRUE(later) << window_->log();
  EXPECT_TRUE(std::stoi(later->groups[1]) > 1 || std::stoi(later->groups[2]) > 0) << window_->log();
}

TEST_F(InspectorWindowTest, SavesTheViewAndTheOutputOfExplain) {
  const auto place = window_->wait_for("place: ([0-9]+),([0-9]+)", 0);
  ASSERT_TRUE(place && click_with_shift(80, 55)) << window_->log();
  const auto buttons = window_->wait_for(
      "buttons: SVG ([0-9]+),([0-9]+) PNG ([0-9]+),([0-9]+) JSON "
      "([0-9]+),([0-9]+)",
      0);
  ASSERT_TRUE(buttons) << window_->log();
  std::map<std::string, std::string> bytes;
  std::string command;
  for (size_t k = 0; k < 3; ++k) {
    const size_t from = window_->mark();
    window_->move(std::stoi(buttons->groups[2 * k + 1]) - std::stoi(place->groups[1]),
                  std::stoi(buttons->groups[2 * k + 2]) - std::stoi(place->groups[2]));
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    window_->button(1, true);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    window_->button(1, false);
    const auto saved = window_->wait_for("saved (scene[^ ]*\\.(svg|png|json)) in", from);
    ASSERT_TRUE(saved) << window_->log();
    bytes[saved->groups[2]] = get(file(saved->groups[1]));
    const auto said = window_->wait_for("command: (.* explain .*)", from);
    ASSERT_TRUE(said) << window_->log();
    command = said->groups[1];
  }
  EXPECT_THAT(bytes["svg"], HasSubstr("<svg"));
  EXPECT_TRUE(bytes["png"].starts_with("\x89PNG"));
  ASSERT_EQ(std::system(("cd " + folder().string() + " && " + command + " > told.json").c_str()), 0)
      << command;
  EXPECT_EQ(bytes["json"], get(file("told.json")));
}

TEST_F(InspectorWindowTest, ARegionShowsTheRaysOfItsPixels) {
  size_t from = window_->mark();
  window_->key(XK_i);
  ASSERT_TRUE(window_->wait_for("click a pixel", from)) << window_->log();
  from = window_->mark();
  window_->hold(XK_Shift_L, true);
  window_->drag(20, 30, 59, 49);
  window_->hold(XK_Shift_L, false);
  const auto region = window_->wait_for("inspects: ([0-9]+),([0-9]+) to ([0-9]+),([0-9]+)", from);
  ASSERT_TRUE(region) << window_->log();
  const auto side = [&](size_t a, size_t b) {
    return std::stoi(region->groups[b]) - std::stoi(region->groups[a]) + 1;
  };
  const auto found = window_->wait_for("inspected: ([0-9]+) rays of ([0-9]+) pixels", from);
  ASSERT_TRUE(found) << window_->log();
  EXPECT_EQ(std::stoi(found->groups[2]), side(1, 3) * side(2, 4));
  EXPECT_GT(std::stoi(found->groups[1]), std::stoi(found->groups[2]));
}

}  // namespace
}  // namespace raio::core
