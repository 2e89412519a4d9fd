// Presses every control of a lesson, on an off-screen display.
#include "view/lesson_panel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <ranges>
#include <set>
#include <string>
#include <vector>

#include "screen.h"
#include "temporary_folder.h"

namespace raio::core::view {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsSupersetOf;

// A course of two lessons, the first open.
class LessonWindow : public TemporaryFolder {
 protected:
  LessonWindow() {
    fs::create_directories(course_), fs::create_directories(folder() / "scenes");
    put(folder() / "scenes/ball.nff", "b 0 0 0\n");
    put(course_ / "2-next.md", "# 2. Next\n" + std::string(9000, 'x') + "\n");
    std::string page =
        "# 1. First\n\nText, and [the next lesson](2-next.md).\n\n"
        "    ./raio view scenes/ball.nff\n\nand\n\n"
        "    for n in 2 3; do\n      ./raio render scenes/ball.nff --aa $n -o a.png\n    done\n\n";
    for (int i = 0; i < 20; ++i) page += "Paragraph " + std::to_string(i) + ".\n\n";
    page +=
        "## Exercises\n\n1. How many?\n   <!-- answer: number = 5 -->\n\n"
        "## Solutions\n\n1. Five, as\n\n       ./raio view scenes/ball.nff --depth 9\n\n"
        "   shows.\n";
    put(course_ / "1-first.md", page);
    panel_.open(course_ / "1-first.md");
  }

  // The controls that the screen shows.
  std::vector<ImVec2> from_the_top() {
    std::vector<ImVec2> places;
    for (const ImVec2 place : screen().widgets() | std::views::values) places.push_back(place);
    std::ranges::sort(places, {}, &ImVec2::y);
    return places;
  }

  void press_all() {
    for (const ImVec2 place : from_the_top()) {
      screen().click(place);
      panel_.open(course_ / "1-first.md");
    }
  }

  Screen& screen() {
    if (!screen_) screen_ = std::make_unique<Screen>([this] { draw(); }, size_);
    return *screen_;
  }

  const ImGuiWindow& page(const char* name) const {
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
      if (std::string_view(window->Name).contains(name)) return *window;
    ADD_FAILURE() << name;
    return *ImGui::GetCurrentContext()->Windows[0];
  }

  fs::path course_ = folder() / "docs/course";
  LessonPanel panel_;
  ImVec2 size_{420, 1300};
  std::multiset<std::string> events_;
  bool needs_scene_ = false;

 private:
  void draw() {
    const LessonResult now = panel_.draw({0, 0, size_.x, size_.y}, needs_scene_);
    if (now.show) events_.insert("show " + option_arguments(now.show->options));
    if (now.page) events_.insert(fs::path(*now.page).filename().string());
    if (now.copied) events_.insert(*now.copied);
    if (now.closes) events_.insert("closes");
  }

  std::unique_ptr<Screen> screen_;
};

TEST_F(LessonWindow, HasButtonsForCommandsLinksAndNeighbours) {
  press_all();
  EXPECT_THAT(events_, IsSupersetOf({"show ", "show  --aa 2", "show  --aa 3", "closes", "2-next.md",
                                     "./raio view scenes/ball.nff\n"}));
  // The words of the link, and the next lesson.
  EXPECT_GE(events_.count("2-next.md"), 2u);
  EXPECT_EQ(events_.count("show  --depth 9"), 0u);
  // The solution is open now. Its button is the lowest but one, above that which copies.
  screen().click(from_the_top().end()[-2]);
  EXPECT_EQ(events_.count("show  --depth 9"), 1u);
}

TEST_F(LessonWindow, ShowsItsFirstSceneIfNoneIsOpen) {
  needs_scene_ = true;
  screen().frame();
  EXPECT_THAT(events_, ElementsAre("show "));
  panel_.open(course_ / "2-next.md");
  screen().frame();
  EXPECT_EQ(events_.size(), 1u) << "this page shows none";
  needs_scene_ = false;
  panel_.open(course_ / "1-first.md");
  screen().frame();
  EXPECT_EQ(events_.size(), 1u);
}

TEST_F(LessonWindow, JudgesAnAnswerWhenItIsGiven) {
  const ImVec2 field = from_the_top().end()[-2];  // above the solution
  const uint64_t empty = screen().sum();
  std::set<uint64_t> looks{empty};
  for (const char* digit : {"5", "0"}) {  // right, then 50
    screen().click(field);
    ImGui::GetIO().AddInputCharactersUTF8(digit), screen().frame();
    const uint64_t typing = screen().sum();
    screen().type("");
    EXPECT_TRUE(looks.insert(screen().sum()).second);
    EXPECT_TRUE(looks.insert(typing).second);
  }
}

TEST_F(LessonWindow, EachPageKeepsItsPlace) {
  size_ = {420, 300};
  screen().frame();
  ImGui::SetScrollY(const_cast<ImGuiWindow*>(&page("1-first")), 200);
  screen().frame(), screen().frame();
  EXPECT_EQ(page("1-first").Scroll.y, 200);
  panel_.open(course_ / "2-next.md");
  screen().frame(), screen().frame();
  EXPECT_EQ(page("2-next").Scroll.y, 0);
  panel_.open(course_ / "1-first.md");
  screen().frame(), screen().frame();
  EXPECT_EQ(page("1-first").Scroll.y, 200);
}

TEST_F(LessonWindow, SaysWhyAPageIsNotThere) {
  EXPECT_TRUE(panel_.is_open());
  panel_.open(course_ / "3-gone.md");
  EXPECT_TRUE(panel_.is_open());
  press_all();
  EXPECT_TRUE(events_.contains("closes"));
  panel_.close();
  EXPECT_FALSE(panel_.is_open());
}

}  // namespace
}  // namespace raio::core::view
