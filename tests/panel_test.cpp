// Presses every widget of the panel and of the tool bar, on an off-screen display: the cursor
// sweeps over everything.
#include "view/panel.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <imgui.h>

#include <memory>
#include <ranges>
#include <set>
#include <string>
#include <vector>

#include "io/nff/nff.h"
#include "screen.h"
#include "view/bars.h"
#include "view/edit.h"
#include "view/history.h"
#include "view/options_panel.h"
#include "view/panel_parts.h"
#include "view/scene_panel.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

// The differences to an earlier state, in words.
std::string difference(const ViewState& a, const ViewState& b) {
  const auto axes = [](const char* name, const Vec3f& x, const Vec3f& y) -> std::string {
    for (int i = 0; i < 3; ++i)
      if (x[i] != y[i]) return fmt::format("{} {}", name, i);
    return {};
  };
  for (std::string found :
       {axes("from", a.camera.from, b.camera.from), axes("at", a.camera.at, b.camera.at),
        axes("up", a.camera.up, b.camera.up),
        axes("background", a.scene->background, b.scene->background)})
    if (!found.empty()) return found;
  if (a.camera.fov_deg != b.camera.fov_deg) return "angle";
  if (a.chosen_light != b.chosen_light)
    return fmt::format("light of {}", b.chosen_light > a.chosen_light ? "+" : "-");
  if (a.chosen_material != b.chosen_material && a.scene == b.scene)
    return fmt::format("material of {}", b.chosen_material > a.chosen_material ? "+" : "-");
  if (a.scene->lights.size() != b.scene->lights.size()) return "fewer lights";
  const Light &l = a.scene->lights[1], &m = b.scene->lights[1];
  if (!(l.position == m.position)) return axes("position", l.position, m.position);
  if (l.color.has_value() != m.color.has_value()) return "own colour";
  if (l.color && *l.color != *m.color) return axes("its light", *l.color, *m.color);
  const auto of_second = [](const ViewState& s) {
    return s.scene->materials[s.scene->sphere_materials[1]];
  };
  const Material x = of_second(a), y = of_second(b);
  if (x.color != y.color) return axes("colour", x.color, y.color);
  if (x.kd != y.kd) return "Kd";
  if (x.ks != y.ks) return "Ks";
  if (x.shine != y.shine) return "shine";
  if (x.transmission != y.transmission) return "T";
  if (x.ior != y.ior) return "index";
  return {};
}

// A change of the scene after saving and reading back.
void expect_saved(const ViewState& state) {
  const Scene seen = as_seen(*state.scene, state.camera, state.scene->background);
  const auto read = parse_nff(write_nff(seen), "three");
  ASSERT_TRUE(read);
  ViewState again("three.nff", std::make_shared<const Scene>(read->scene), {});
  again.chosen_light = state.chosen_light, again.chosen_material = state.chosen_material;
  EXPECT_EQ(difference(state, again), "");
}

const std::set<std::string> kSections = {"###Selection",
                                         "###Effects",
                                         "###Statistics",
                                         "###Your picture",
                                         "###The structure's boxes",
                                         "###What each effect costs",
                                         "###All combinations of effects",
                                         "###The grid's resolution",
                                         "###Scene",
                                         "###All options",
                                         "###Window"};

std::shared_ptr<const Scene> state_with(size_t spheres) {
  Scene s = *state_of_three().scene;
  while (s.spheres.size() < spheres)
    s.spheres.push_back({{float(s.spheres.size()), 0, 0}, 0.5f}), s.sphere_materials.push_back(0);
  return std::make_shared<const Scene>(std::move(s));
}

// Only those sections.
void open_sections(ImGuiWindow& panel, const std::set<std::string>& names) {
  for (const std::string& name : kSections)
    panel.StateStorage.SetInt(panel.GetID(name.c_str()), names.contains(name));
}

TEST(Panel, EveryFieldOfTheSceneChangesItAndIsUndone) {
  ViewState state = state_of_three();
  bool changed = false;
  Screen screen([&] {
    ImGui::SetNextWindowPos({0, 0}), ImGui::SetNextWindowSize({kWidth, kHeight});
    ImGui::Begin("scene", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    changed |= draw_scene(state);
    ImGui::End();
  });
  std::set<std::string> found;
  for (const auto& [id, place] : screen.widgets()) {
    const ViewState before = state = state_of_three();
    History<ViewState> history(before);
    changed = false;
    screen.drag(place);
    if (difference(before, state).empty()) screen.click(place);
    if (screen.is_popup_open()) {  // a colour's square: a picker
      screen.click({kWidth - 2, kHeight - 2}), screen.frame();
      found.insert("picker");
      continue;
    }
    const std::string what = difference(before, state);
    if (what.empty()) continue;
    found.insert(what);
    if (what.ends_with("+") || what.ends_with("-")) continue;  // the panel's own, not the scene's
    EXPECT_TRUE(changed) << what;
    if (what != "fewer lights") expect_saved(state);
    history.settle(state);
    ASSERT_TRUE(history.can_undo()) << what;
    EXPECT_EQ(difference(before, history.undo()), "") << what;
    EXPECT_EQ(history.redo(), state) << what;
  }
  std::set<std::string> expected = {"angle",
                                    "light of +",
                                    "light of -",
                                    "material of +",
                                    "material of -",
                                    "fewer lights",
                                    "own colour",
                                    "Kd",
                                    "Ks",
                                    "shine",
                                    "T",
                                    "index",
                                    "picker"};
  for (const char* field : {"from", "at", "up", "background", "position", "its light", "colour"})
    for (int i = 0; i < 3; ++i) expected.insert(fmt::format("{} {}", field, i));
  EXPECT_EQ(found, expected);
}

TEST(Panel, FieldsThatAFigureDoesNotShowAreOff) {
  const auto begin = [] {
    ViewState state = state_of_three();
    state.options.integrator = IntegratorKind::ambient;
    return state;
  };
  ViewState state = begin();
  Screen screen([&] {
    ImGui::SetNextWindowPos({0, 0}), ImGui::SetNextWindowSize({kWidth, kHeight});
    ImGui::Begin("scene", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    (void)draw_scene(state);
    ImGui::End();
  });
  std::set<std::string> found;
  for (const ImVec2 place : screen.widgets() | std::views::values) {
    const ViewState before = state = begin();
    screen.drag(place);
    found.insert(difference(before, state));
  }
  EXPECT_THAT(found, testing::IsSupersetOf({"from 0", "at 1", "up 2", "angle", "Kd"}));
  for (const char* off : {"position 0", "position 1", "position 2", "Ks", "shine", "T", "index"})
    EXPECT_FALSE(found.contains(off)) << off;
}

// A field that takes text, a list or a picker that opens, a section that closes, a state that
// changes, a key's command: whatever is under the cursor is one of these.
TEST(Panel, EveryPanelControlResponds) {
  ViewState state = state_of_three();
  PanelFacts facts;
  facts.costs.picture_width = 160, facts.costs.picture_height = 120;
  facts.costs.curve.points = {{.factor = 1, .tests = 4, .steps = 2}};
  facts.boxes = {.drawn = 8, .all = 8, .levels = 3, .most = 10};
  facts.selection.lines = {"sphere 1"};
  facts.selection.material = 1, facts.selection.can_focus = true;
  PanelResult result;
  std::set<std::string> pressed;
  size_t presses = 0;
  const auto begin = [&] {
    state = state_of_three();
    state.options.accel.kind = AccelKind::grid;
    return state;
  };
  const auto draw = [&] {
    const PanelResult now = draw_panel(state, facts, {0, 0, kWidth, kHeight});
    for (const KeySpec* key : now.pressed) pressed.insert(key->help), ++presses;
    result.changed |= now.changed, result.saves_curve |= now.saves_curve;
    if (now.selection != SelectionUse::nothing) result.selection = now.selection;
    if (!now.problem.empty()) result.problem = now.problem;
  };
  Screen screen(draw);
  ImGuiWindow* const panel = ImGui::FindWindowByName("panel");
  ASSERT_TRUE(panel);
  const auto open_all = [&] {
    open_sections(*panel, kSections);
    screen.move({kWidth - 2, 1}), screen.frame();
  };
  begin();
  open_all();
  ASSERT_LT(panel->ContentSize.y, kHeight) << "some are out of sight";
  const auto all = screen.widgets();
  size_t options = 0;
  for (const OptionSpec& spec : render_option_table()) options += spec.of_window;
  EXPECT_GT(all.size(), options + 60);
  for (const ImVec2 place : all | std::views::values) {
    const ViewState before = begin();
    const size_t presses_before = presses;
    const Language spoken = language();
    result = {};
    bool answers = false;
    const auto look = [&] {
      answers |= screen.is_popup_open() || ImGui::GetIO().WantTextInput || result.changed ||
                 !result.problem.empty() || presses > presses_before || language() != spoken ||
                 result.saves_curve || state.boxes != before.boxes ||
                 result.selection != SelectionUse::nothing || !difference(before, state).empty();
      for (const std::string& name : kSections)
        answers |= !panel->StateStorage.GetInt(panel->GetID(name.c_str()), 1);
    };
    screen.move(place), screen.button(true), look(), screen.button(false), look();
    screen.frame(), look();
    if (!answers) screen.drag(place), look();
    EXPECT_TRUE(answers) << "at " << place.x << "," << place.y;
    ImGui::ClosePopupsOverWindow(nullptr, false);
    ImGui::ClearActiveID();
    set_language(Language::english);
    open_all();
  }
  for (const char* key : {"antialiasing", "soft shadows", "depth of field", "reflection",
                          "refraction", "gloss", "translucency", "structure", "measure 16",
                          "show boxes", "measure grids", "light or dark", "big type", "compare"})
    EXPECT_TRUE(pressed.contains(key)) << key;
  EXPECT_FALSE(pressed.contains("motion blur")) << "nothing moves in this scene";
}

TEST(Panel, TheSelectionMovesNothingAndOffersWhatFits) {
  ViewState state = state_of_three();
  PanelFacts facts;
  std::set<SelectionUse> uses;
  bool changed = false;
  Screen screen([&] {
    const PanelResult now = draw_panel(state, facts, {0, 0, kWidth, kHeight});
    uses.insert(now.selection), changed |= now.changed;
  });
  ImGuiWindow* const panel = ImGui::FindWindowByName("panel");
  open_sections(*panel, {"###Selection"}), screen.frame(), screen.frame();
  float height = 0;  // from the first selection on
  const auto offered = [&](const SelectionFacts& selection) {
    facts.selection = selection, uses.clear(), changed = false;
    screen.frame(), screen.frame();
    if (height > 0) {
      EXPECT_EQ(panel->ContentSize.y, height) << "the sections below stay";
    }
    if (!selection.lines.empty()) height = panel->ContentSize.y;
    const ImGuiWindow* part = nullptr;
    for (const ImGuiWindow* window : screen.context().Windows)
      if (window->ParentWindow == panel) part = window;
    EXPECT_TRUE(part);
    if (!part) return uses;
    EXPECT_LE(part->ContentSize.y, part->Size.y) << "all is visible";
    const ImVec2 lo = part->Pos, hi(lo.x + part->Size.x, lo.y + part->Size.y);
    for (const ImVec2 place : screen.widgets({lo.x, lo.y, hi.x, hi.y}) | std::views::values) {
      const ViewState before = state;
      screen.drag(place);
      if (state.scene == before.scene) screen.click(place);
      ImGui::ClosePopupsOverWindow(nullptr, false), ImGui::ClearActiveID(), screen.frame();
    }
    uses.erase(SelectionUse::nothing);
    return uses;
  };
  using enum SelectionUse;
  EXPECT_THAT(offered({}), testing::IsEmpty());
  SelectionFacts atom;
  atom.lines = {"sphere 1, material 1", "C, ALA 1 CA", "atom 1", "at 0, 0, 0", "distance 1"};
  atom.material = 1, atom.is_atom = true;
  EXPECT_THAT(offered(atom), testing::ElementsAre(inspect, turn, clear, hide, color));
  EXPECT_FALSE(changed) << "its material is that of other atoms";
  atom.has_residue = atom.has_chain = atom.can_focus = true;
  EXPECT_THAT(offered(atom), testing::ElementsAre(focus, inspect, turn, clear, hide, hide_residue,
                                                  hide_chain, color, color_residue, color_chain));
  SelectionFacts mesh;
  mesh.lines = {"triangle 1, material 1", "at 0, 0, 0"}, mesh.material = 1;
  const Rgb first = state.scene->materials[0].color, second = state.scene->materials[1].color;
  EXPECT_THAT(offered(mesh), testing::ElementsAre(inspect, turn, clear));
  EXPECT_TRUE(changed);
  EXPECT_NE(state.scene->materials[1].color, second);
  EXPECT_EQ(state.scene->materials[0].color, first);
  EXPECT_THAT(offered({}), testing::IsEmpty()) << "and the place stays";
}

TEST(Panel, EveryOptionShowsTheValueInUse) {
  ViewState state = state_of_three();
  ViewState figure = state;
  figure.options.integrator = IntegratorKind::ambient;
  CostFacts facts;
  facts.picture_width = 160, facts.picture_height = 120;
  for (const ViewState& one : {state, figure})
    for (const OptionSpec& spec : render_option_table()) {
      if (spec.of_window) {
        EXPECT_NE(shown_value(spec, one, facts), "") << spec.name;
      }
    }
  const auto shown = [&](std::string_view name) {
    return shown_value(option_of(name), state, facts);
  };
  // Lights at (3, -4, 5 to 7), the point looked at is (0, 0, 0.5).
  EXPECT_EQ(shown("light-size"), "0.67268 to 0.82006");
  EXPECT_EQ(shown("opacity"), "1");
  EXPECT_EQ(shown("gloss"), "0");
  EXPECT_EQ(shown("shutter"), "0,1");
  EXPECT_EQ(shown("grid-factor"), "one cell") << "of three spheres";
  EXPECT_EQ(shown("from"), "0,-6,2");
  EXPECT_EQ(shown("up"), "0,0.1,1");
  EXPECT_EQ(shown("view"), "picture");
  EXPECT_EQ(shown("exposure"), "0");
  EXPECT_EQ(shown("background"), "0.25,0.5,0.75");
  EXPECT_EQ(shown("size"), "160x120");
  EXPECT_EQ(shown("samples"), "1");
  EXPECT_EQ(shown("integrator"), "classic");
  EXPECT_EQ(shown_value(option_of("integrator"), figure, facts), "ambient");
  EXPECT_EQ(shown("soft-shadows"), "false");
  (void)state.toggle(Command::antialiasing);
  EXPECT_EQ(shown("samples"), "1024");
  EXPECT_EQ(shown("aa"), "samples");
  state.options.light_size = 0.25f, state.options.accel.grid_factor = 2;
  EXPECT_EQ(shown("light-size"), "0.25");
  EXPECT_EQ(shown("grid-factor"), "2");
  auto picture = std::make_shared<SessionPicture>();
  auto baked = std::make_shared<BakedScene>();
  baked->info.resolution = {3, 4, 5};
  picture->baked = baked, facts.picture = picture;
  EXPECT_EQ(shown("grid-resolution"), "3x4x5");
  state = ViewState("many", state_with(33), {});
  EXPECT_EQ(shown("grid-factor"), "0.3");
}

TEST(Panel, LabelsOfTheCombinationsAreWhole) {
  CostFacts facts;
  facts.table.emplace();
  for (const Combination& c : combinations({}))
    facts.table->rows.push_back({.combination = c, .runs_s = {123.4}, .rays = 1000});
  for (const bool projector : {false, true}) {
    Screen screen([] {}, {800, 800});
    apply_look({.projector = projector}, 1);
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    for (int frame = 0; frame < 4; ++frame) {
      ImGui::NewFrame();
      begin_panel("panel", {0, 0, kPanelEms * em(), 800});
      (void)draw_table(facts);
      const ImGuiTable* const table = ImGui::TableFindByID(ImGui::GetID("sixteen"));
      ASSERT_TRUE(table);
      for (const BenchmarkRow& row : facts.table->rows) {
        const std::string label = short_label(row.combination);
        const float room = table->Columns[0].WidthGiven;
        EXPECT_TRUE(frame < 3 || ImGui::CalcTextSize(label.c_str()).x <= room) << label;
      }
      ImGui::End();
      ImGui::Render();
    }
  }
}

TEST(Panel, SlidersOfRoughnessSwitchTheirEffects) {
  ViewState state = state_of_three();
  PanelFacts facts;
  bool changed = false;
  Screen screen([&] { changed |= draw_panel(state, facts, {0, 0, kWidth, kHeight}).changed; });
  ImGuiWindow* const panel = ImGui::FindWindowByName("panel");
  open_sections(*panel, {"###Effects"}), screen.frame();
  std::set<Command> moved;
  for (const ImVec2 place : screen.widgets() | std::views::values) {
    const ViewState before = state = state_of_three();
    History<ViewState> history(before);
    open_sections(*panel, {"###Effects"}), changed = false, screen.frame();
    screen.drag(place);
    for (const Command effect : {Command::gloss, Command::translucency}) {
      if (!state.roughness(effect)) continue;
      moved.insert(effect);
      EXPECT_TRUE(changed);
      EXPECT_TRUE(state.is_on(effect));
      EXPECT_LE(*state.roughness(effect), 1);
      EXPECT_EQ(state.split_effect, effect);
      history.settle(state);
      EXPECT_EQ(history.undo(), before);
    }
  }
  EXPECT_EQ(moved.size(), 2u);
}

TEST(Panel, EveryToolPressesItsKey) {
  const ViewState state = state_of_three();
  std::vector<const KeySpec*> now;
  std::vector<std::string> pressed;
  Screen screen(
      [&] {
        now.clear();
        draw_tool_bar({0, 0, 1600, 42}, state, {.can_undo = true, .can_redo = true}, now);
        for (const KeySpec* key : now) pressed.push_back(key->help);
      },
      {1600, 900});
  std::set<ImGuiID> seen;
  for (float x = 2; x < 1600; x += 6) {
    screen.move({x, 21});
    const ImGuiID id = screen.context().HoveredId;
    if (!id || !seen.insert(id).second) continue;
    const size_t before = pressed.size();
    screen.click({x + 4, 21});
    if (screen.is_popup_open()) {  // the views
      screen.click({1590, 890}), screen.frame();
      pressed.emplace_back("a list");
    }
    EXPECT_EQ(pressed.size(), before + 1) << "at " << x;
  }
  for (const char* key : {"open", "save scene", "undo", "redo", "antialiasing", "soft shadows",
                          "depth of field", "reflection", "refraction", "gloss", "translucency"})
    EXPECT_THAT(pressed, testing::Contains(key));
  EXPECT_THAT(pressed, testing::Not(testing::Contains("motion blur"))) << "nothing moves";
  EXPECT_EQ(std::set<std::string>(pressed.begin(), pressed.end()).size(), pressed.size());
}

// Each choice of an option's list gives another state, or a reason why it cannot be combined.
TEST(Panel, EveryEntryOfEveryListIsTaken) {
  ViewState state = state_of_three();
  PanelFacts facts;
  facts.costs.picture_width = 160, facts.costs.picture_height = 120;
  std::string problem;
  Screen screen([&] {
    if (std::string now = draw_panel(state, facts, {0, 0, kWidth, kHeight}).problem; !now.empty())
      problem = std::move(now);
  });
  ImGuiWindow* const panel = ImGui::FindWindowByName("panel");
  open_sections(*panel, {"###All options"}), screen.frame();
  size_t lists = 0;
  for (const ImVec2 place : screen.widgets() | std::views::values) {
    state = state_of_three();
    screen.click(place);
    open_sections(*panel, {"###All options"});
    if (!screen.is_popup_open()) continue;
    const std::vector<ImVec2> entries = screen.entries();
    screen.click({kWidth - 2, kHeight - 2});
    std::set<std::string> outcomes;
    bool moves = true;
    for (const ImVec2 entry : entries) {
      state = state_of_three(), problem.clear();
      screen.click(place), screen.click(entry);
      moves &= state.camera.from != state_of_three().camera.from;
      // The camera of the window has the rays that were chosen.
      const auto rays = std::string(projection_name(state.camera.projection));
      outcomes.insert(problem.empty() ? option_arguments(state.options) + rays : problem);
    }
    // Options without effect on this scene are refused, whichever entry is chosen; here most are.
    const bool refused = outcomes.size() == 1 && outcomes.begin()->contains("has no effect");
    EXPECT_TRUE(refused || moves || outcomes.size() == entries.size())
        << testing::PrintToString(outcomes);
    EXPECT_GT(entries.size(), 1u);
    ++lists;
  }
  size_t expected = 0;
  for (const OptionSpec& spec : render_option_table())
    expected += spec.of_window && spec.type() == OptionType::words;
  EXPECT_GE(lists, expected);
}

TEST(Panel, EveryFieldTakesInput) {
  ViewState state = state_of_three();
  PanelFacts facts;
  facts.costs.picture_width = 160, facts.costs.picture_height = 120;
  PanelResult result;
  Screen screen([&] {
    const PanelResult now = draw_panel(state, facts, {0, 0, kWidth, kHeight});
    result.changed |= now.changed;
    if (!now.problem.empty()) result.problem = now.problem;
  });
  ImGuiWindow* const panel = ImGui::FindWindowByName("panel");
  open_sections(*panel, {"###Scene", "###All options"}), screen.frame();
  std::set<std::string> changed;
  for (const ImVec2 place : screen.widgets() | std::views::values) {
    state = state_of_three();
    ImGui::GetIO().KeyCtrl = true, screen.click(place), ImGui::GetIO().KeyCtrl = false;
    if (ImGui::GetIO().WantTextInput) {
      const ViewState before = state = state_of_three();
      result = {};
      screen.type("3.5");
      EXPECT_TRUE(result.changed || !result.problem.empty() || !difference(before, state).empty())
          << "at " << place.x << ',' << place.y;
      for (const OptionSpec& spec : render_option_table())
        if (spec.text(before.options) != spec.text(state.options))
          changed.insert(std::string(spec.name));
    }
    ImGui::ClosePopupsOverWindow(nullptr, false);
    ImGui::ClearActiveID();
    open_sections(*panel, {"###Scene", "###All options"}), screen.frame();
  }
  EXPECT_THAT(changed, testing::IsSupersetOf({"aperture", "exposure", "focus", "grid-factor",
                                              "lens-samples", "light-size", "threads"}));
}

}  // namespace
}  // namespace raio::core::view
