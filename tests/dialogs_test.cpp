// Presses every control of the dialogs, the tool bar's lists and the inspector's panel, on an
// off-screen display.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "io/nff/nff.h"
#include "screen.h"
#include "view/bars.h"
#include "view/file_dialog.h"
#include "view/help.h"
#include "view/inspector.h"
#include "view/legend.h"
#include "view/welcome.h"

namespace raio::core::view {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

const ImVec2 kSize(900, 700);

TEST(Dialogs, WelcomeOpensEachOfItsScenesAndLessons) {
  const ImVec2 size(kSize.x, 1000);  // shows all of them
  const WelcomeFacts facts{
      .recent = {"/a/one.nff", "/b/two.nff"},
      .samples = {.course = {"/s/course/four.nff"}, .others = {"/s/three.nff"}},
      .lessons = {{"/d/1-camera.md", "1. Camera", "Which ray?", ""}}};
  std::multiset<std::string> opened;
  Screen screen(
      [&] {
        const WelcomeResult now = draw_welcome({0, 0, size.x, size.y}, facts);
        if (now.open) opened.insert(*now.open);
        if (now.lesson) opened.insert(*now.lesson);
        if (now.asks) opened.insert("asks");
      },
      size);
  for (const ImVec2 place : screen.widgets() | std::views::values) screen.click(place);
  EXPECT_THAT(opened, UnorderedElementsAre("/a/one.nff", "/b/two.nff", "/s/course/four.nff",
                                           "/s/three.nff", "/d/1-camera.md", "asks"));
}

// Below the last row there is nothing, and no card is cut at the right.
TEST(Dialogs, WelcomeFillsAnyWindow) {
  const WelcomeFacts facts{
      .recent = std::vector<std::string>(1, "/a/one.nff"),
      .samples = {.course = {},
                  .others = {"/s/a.nff", "/s/b.nff", "/s/c.nff", "/s/d.nff", "/s/e.nff"}}};
  for (const ImVec2 size : {ImVec2(700, 500), ImVec2(1600, 1000), ImVec2(150, 300)}) {
    Screen screen([&] { (void)draw_welcome({0, 0, size.x, size.y}, facts); }, size);
    screen.frame();
    const ImGuiWindow* const page = ImGui::FindWindowByName("welcome");
    EXPECT_EQ(page->ScrollMax.x, 0) << size.x;
    EXPECT_EQ(page->ScrollMax.y > 0, size.y <= 500) << size.y;
    if (size.x > 200) {
      EXPECT_LE(page->ContentSize.x, size.x);
    }
  }
}

class FileDialogs : public testing::Test {
 protected:
  FileDialogs() {
    fs::create_directories(folder_ / "sub");
    for (const char* name : {"a.nff", "b.nff", "sub/c.nff"}) std::ofstream(folder_ / name) << "b";
  }
  ~FileDialogs() override { fs::remove_all(folder_); }

  // Presses controls until the dialog closes or does not change; returns everything chosen.
  std::set<std::string> press_all(FileDialog::Purpose purpose, const std::string& name) {
    std::set<std::string> chosen;
    dialog_.ask(purpose, folder_, name);
    screen_.frame(), screen_.frame();
    for (const ImVec2 place : screen_.widgets() | std::views::values) {
      chosen_.reset();
      dialog_.ask(purpose, folder_, name);
      screen_.frame(), screen_.frame(), screen_.click(place);
      if (chosen_)
        chosen.insert(fs::path(*chosen_).lexically_relative(folder_).string());
      else if (!dialog_.is_open())
        chosen.insert("closed");
    }
    return chosen;
  }

  const fs::path folder_ =
      fs::canonical(fs::temp_directory_path()) / ("raio-dialogs-" + std::to_string(::getpid()));
  FileDialog dialog_;
  std::optional<std::string> chosen_;
  Screen screen_{[this] {
                   const Layout layout(kSize.x, kSize.y, em(), false);
                   if (auto now = dialog_.draw(layout)) chosen_ = std::move(now);
                 },
                 kSize};
};

TEST_F(FileDialogs, EveryButtonResponds) {
  EXPECT_THAT(press_all(FileDialog::Purpose::open, "a.nff"),
              UnorderedElementsAre("a.nff", "b.nff", "closed"));
  // A file to be replaced takes two presses.
  EXPECT_THAT(press_all(FileDialog::Purpose::save, "new.nff"),
              UnorderedElementsAre("new.nff", "closed"));
}

TEST_F(FileDialogs, AllFilesAreListedOnRequest) {
  std::ofstream(folder_ / "notes.txt") << "b";
  EXPECT_THAT(press_all(FileDialog::Purpose::open, ""),
              UnorderedElementsAre("a.nff", "b.nff", "closed"));
  // The box was pressed on the way.
  EXPECT_THAT(press_all(FileDialog::Purpose::open, ""),
              UnorderedElementsAre("a.nff", "b.nff", "notes.txt", "closed"));
}

TEST_F(FileDialogs, FoldersAreEnteredAndNamesTyped) {
  dialog_.ask(FileDialog::Purpose::open, folder_, {});
  screen_.frame(), screen_.frame(), screen_.frame();
  ASSERT_TRUE(ImGui::GetIO().WantTextInput);
  const uint64_t above = screen_.sum();
  screen_.type("sub");
  ASSERT_TRUE(dialog_.is_open());
  const auto widgets = screen_.widgets();
  const auto press = [&](const char* name) {
    screen_.click(widgets.at(ImGui::FindWindowByName("###file")->GetID(name)));
  };
  EXPECT_NE(screen_.sum(), above);
  press("##name");
  screen_.type("c.nff");
  EXPECT_EQ(chosen_, folder_ / "sub" / "c.nff");

  dialog_.ask(FileDialog::Purpose::open, folder_ / "sub", {});
  screen_.frame(), screen_.frame();
  press("up");
  press("##name");
  screen_.type("b.nff");
  EXPECT_EQ(chosen_, folder_ / "b.nff");
}

TEST(Dialogs, HelpSearchesAndCloses) {
  std::string sought;
  bool open = true;
  Screen screen(
      [&] {
        if (open) open = draw_help(Layout(kSize.x, kSize.y, em(), false), sought);
      },
      kSize);
  screen.frame();
  const uint64_t all = screen.sum();
  ASSERT_TRUE(ImGui::GetIO().WantTextInput);
  screen.type("shadow");
  EXPECT_EQ(sought, "shadow");
  EXPECT_NE(screen.sum(), all);
  size_t closing = 0;
  for (const ImVec2 place : screen.widgets() | std::views::values) {
    open = true;
    screen.frame(), screen.click(place);
    closing += !open;
  }
  EXPECT_EQ(closing, 1u);
}

TEST(Dialogs, EveryEntryOfTheToolBarsListsPressesItsKey) {
  const ViewState state = state_of_three();
  std::vector<const KeySpec*> now;
  std::multiset<std::string> pressed;
  Screen screen(
      [&] {
        now.clear();
        draw_tool_bar({0, 0, 420, 42}, state, {.can_undo = true, .can_redo = true}, now);
        for (const KeySpec* key : now) pressed.insert(key->help);
      },
      kSize);
  const auto lists = screen.widgets({0, 0, 420, 42});
  for (const ImVec2 place : lists | std::views::values) {
    screen.click(place);
    if (!screen.is_popup_open()) continue;
    const auto entries = screen.entries();
    screen.click({890, 690});
    for (const ImVec2 entry : entries) screen.click(place), screen.click(entry);
  }
  // The tools of the bar, and those without room there; each once.
  EXPECT_EQ(std::set<std::string>(pressed.begin(), pressed.end()).size(), pressed.size());
  EXPECT_GE(pressed.size(), 21u);
  for (const char* key : {"help", "panel", "full screen", "copy command"})
    EXPECT_TRUE(pressed.contains(key)) << key;
}

// The id of a child window, as BeginChild() makes it.
ImGuiID child_of(ImGuiWindow& window, const char* name) {
  const ImGuiID id = window.GetID(name);
  char full[256];
  ImFormatString(full, sizeof full, "%s/%s_%08X", window.Name, name, id);
  return ImHashStr(full);
}

TEST(Dialogs, EveryInspectorControlResponds) {
  ViewState state("three.nff", state_of_three().scene, {});
  state.options.aa = 3;
  Inspector inspector([] {});
  InspectorResult result;
  const Rect where{0, 0, 400, 1400};
  Screen screen(
      [&] {
        const InspectorResult now = inspector.draw_panel(where, 0);
        result.closed |= now.closed, result.copied |= now.copied;
        if (now.camera) result.camera = now.camera;
        if (!now.save.empty()) result.save = now.save;
        result.copied_text |= now.copied_text;
      },
      {400, 1400});
  const auto wait = [&] {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    auto found = inspector.poll();
    for (; !found && std::chrono::steady_clock::now() < until; found = inspector.poll())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_TRUE(found && *found);
  };
  const Stage stage({0, 0, 400, 300}, 1, 40, 30);
  // The sections scroll by themselves.
  ImGuiWindow* const whole = ImGui::FindWindowByName("inspector");
  const ImGuiID rest = child_of(*whole, "rest");
  // In the middle of a traversal, at the second sample: there are earlier and later ones.
  ImVec2 next_sample;
  const auto begin = [&] {
    inspector.look(state, stage, nullptr, {0.5f, 0.55f}, {0.5f, 0.55f});
    wait();
    for (int i = 0; i < 3; ++i) inspector.walk(Inspector::Walk::on, 0);
    screen.frame();
    if (next_sample.x > 0) screen.click(next_sample), wait();
    ImGuiWindow* const sections = ImGui::FindWindowByID(rest);
    for (const char* section :
         {"###Tree of rays", "###Step by step", "###The ray", "###Contributions to the colour"})
      sections->StateStorage.SetInt(sections->GetID(section), 1);
    screen.frame();
    result = {};
  };
  begin();
  ImGuiWindow* const panel = ImGui::FindWindowByName("inspector");
  auto all = screen.widgets();
  all.erase(panel->GetID("##rgb"));  // which is only looked at
  EXPECT_GT(all.size(), 20u);
  next_sample = all.at(panel->GetID("+"));
  std::set<std::string> saved;
  size_t others = 0;
  bool copied_text = false;
  for (const auto& [id, place] : all) {
    begin();
    const uint64_t before = screen.sum();
    screen.click(place);
    if (id == panel->GetID("-") || id == panel->GetID("+") || id == panel->GetID("##sample"))
      wait();
    if (!result.save.empty()) saved.insert(result.save);
    const bool tells = result.closed || result.copied || result.copied_text || result.camera ||
                       !result.save.empty();
    copied_text |= result.copied_text;
    others += tells;
    EXPECT_TRUE(tells || screen.sum() != before) << "at " << place.x << ',' << place.y;
  }
  EXPECT_THAT(saved, ElementsAre(".json", ".png", ".svg"));
  EXPECT_GE(others, 8u);  // with "<", "copy command", and both cameras
  EXPECT_TRUE(copied_text);
  EXPECT_TRUE(inspector.explanation().starts_with("three, pixel 20,16 of 40x30, sample 1 of 9\n"))
      << inspector.explanation();
}

// The pixel and its buttons stay while the rest scrolls.
TEST(Dialogs, TheInspectorsHeadStaysInPlace) {
  ViewState state("three.nff", state_of_three().scene, {});
  Inspector inspector([] {});
  Screen screen([&] { (void)inspector.draw_panel({0, 0, 400, 500}, 0); }, {400, 500});
  inspector.look(state, Stage({0, 0, 400, 300}, 1, 40, 30), nullptr, {0.5f, 0.55f}, {0.5f, 0.55f});
  for (int k = 0; k < 20000 && !inspector.poll(); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(inspector.has_pixel());
  screen.frame(), screen.frame();
  ImGuiWindow* const panel = ImGui::FindWindowByName("inspector");
  ImGuiWindow* const sections = ImGui::FindWindowByID(child_of(*panel, "rest"));
  EXPECT_EQ(panel->ScrollMax.y, 0);
  ASSERT_GT(sections->ScrollMax.y, 100);
  const std::string before = inspector.places();
  sections->Scroll.y = 100;
  screen.frame(), screen.frame();
  EXPECT_EQ(sections->Scroll.y, 100);
  EXPECT_EQ(inspector.places(), before);
}

TEST(Message, AvoidsTheLegendAndStaysInThePicture) {
  Screen screen([] {
    const std::string message = "soft shadows on: 204 ms per sample, before 96.4 ms";
    for (const float width : {400.0f, 700.0f, 1000.0f, 2000.0f}) {
      const Rect picture{0, 40, width, 800};
      const Rect legend =
          draw_legend(picture, {"tests", {{Rgb(0), "0"}, {Rgb(0.5f), "10"}, {Rgb(1), "100"}}}, {});
      EXPECT_GT(legend.width(), 0);
      const Rect place = message_place(picture, legend, message);
      EXPECT_TRUE(place.right <= legend.left || place.bottom <= legend.top) << width;
      EXPECT_TRUE(place.left >= picture.left && place.right <= picture.right) << width;
      if (width == 400) {
        EXPECT_LE(place.bottom, legend.top) << "no room beside it";
      } else if (width == 2000) {
        EXPECT_EQ(place.bottom, legend.bottom) << "beside it";
      }
      draw_message(place, message, false);
      EXPECT_EQ(draw_legend(picture, {}, {}).width(), 0);
    }
  });
}

}  // namespace
}  // namespace raio::core::view
