// The commands of keys, buttons and clicks.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "view/app_state.h"
#include "view/camera_control.h"
#include "view/projection.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr double kDoubleClick = 0.35;  // seconds

}  // namespace

void AppState::obey(const KeySpec& key) {
  switch (key.command) {
    case Command::antialiasing:
    case Command::soft_shadows:
    case Command::depth_of_field:
    case Command::structure:
    case Command::reflection:
    case Command::refraction:
    case Command::gloss:
    case Command::translucency:
    case Command::motion:
      return switch_effect(key.command);
    case Command::split:
      return switch_split();
    case Command::compare:
      return switch_comparing();
    case Command::pause:
      return switch_pause();
    case Command::panel:
      return switch_panel();
    case Command::boxes:
      view.boxes.shown = !view.boxes.shown;
      return say(view.boxes.shown ? tr("boxes of the structure shown")
                                  : tr("boxes of the structure hidden"));
    case Command::inspect:
      return switch_picking();
    case Command::focus:
      return switch_focusing();
    case Command::theme:
      return switch_look(&Theme::light);
    case Command::projector:
      return switch_look(&Theme::projector);
    case Command::full_screen:
      ask(request::SetFullScreen{!facts_.full_screen});
      return say(facts_.full_screen ? tr("window") : tr("full screen; F11 leaves it"));
    case Command::measure:
      return switch_work(Measuring::Work::table, tr("measuring all combinations; m stops"));
    case Command::curve:
      return switch_work(Measuring::Work::curve,
                         tr("measuring grids from coarse to fine; n stops"));
    case Command::fit:
      say(tr("the scene fits"));
      return move_camera(fit());
    case Command::home:
      say(tr("the scene's own camera"));
      return move_camera(view.own_camera());
    case Command::show_view:
      view.show(View(key.key - '1'));
      say(trf("view: {}", tr(key.help)));
      return void(renew());
    case Command::walk_back:
    case Command::walk_on:
    case Command::walk_play:
      ask(request::WalkRay{key.command == Command::walk_back ? Inspector::Walk::back
                           : key.command == Command::walk_on ? Inspector::Walk::on
                                                             : Inspector::Walk::play});
      return refresh();
    case Command::undo:
    case Command::redo:
      return go_back(key.command == Command::undo);
    case Command::copy:
      return copy_command(command_line(view.scene->name + ".png"));
    case Command::save_png:
    case Command::save_exr:
      to_save_ = key.command == Command::save_png ? ".png" : ".exr";
      return save_when_whole();
    case Command::lesson:
      return switch_lesson();
    case Command::open:
      ask(request::AskForFile{FileDialog::Purpose::open});
      return refresh();
    case Command::save_scene:
      if (view.path.empty()) return say(tr("no scene is open"));
      ask(request::AskForFile{FileDialog::Purpose::save});
      return refresh();
    case Command::help:
      ask(request::SwitchHelp{});
      return refresh();
    case Command::quit:
      if (key.key == 'Q' || !leave()) return ask(request::CloseWindow{});
      return refresh();
  }
}

void AppState::finish(Gestures::Done gesture, bool ctrl) {
  using enum Gestures::Done;
  if (gesture == nothing) return;
  const double x = gestures.x(), y = gestures.y();
  if (gesture == click && !facts_.picks && (focuses || !view.compared)) {
    const Pick under = pick_at(x, y);
    if (focuses) return focus_on(under);
    const bool is_second = facts_.now - std::exchange(last_click_, facts_.now) < kDoubleClick;
    if (is_second && !ctrl) return choose_pivot(under);
    return select(under, ctrl);
  }
  const auto at = [&](double across, double down) {
    return ImVec2(float(stage.across(across)), float(stage.down(down)));
  };
  ask(request::Inspect{gesture == region ? at(gestures.from_x(), gestures.from_y()) : at(x, y),
                       at(x, y)});
  if (!has_panel()) say(tr("h shows the panel with the numbers"));
}

void AppState::select(const Pick& pick, bool more) {
  if (!pick.hit.found()) {
    if (!selection.empty()) say(tr("nothing is selected"));
    return selection.clear();
  }
  selection.pick(pick, more);
  view.chosen_material = int(pick.material);
  const std::string measure = measured();
  say(measure.empty() ? fmt::format("{}", fmt::join(selection.lines(*view.scene, view.box), ", "))
                      : measure);
}

void AppState::choose_pivot(const Pick& pick) {
  last_click_ = -1;
  view.pivot.reset();
  if (!pick.hit.found()) return say(tr("turns as before"));
  view.pivot = pick.place;
  say(trf("turns about {}", pick.what));
}

void AppState::use_selection(SelectionUse use) {
  if (use == SelectionUse::nothing || selection.empty()) return;
  const Pick pick = selection.picks().back();
  switch (use) {
    case SelectionUse::focus:
      return focus_on(pick);
    case SelectionUse::turn:
      return choose_pivot(pick);
    case SelectionUse::inspect:
      return inspect(pick.point);
    case SelectionUse::hide:
    case SelectionUse::hide_residue:
    case SelectionUse::hide_chain:
      return hide_selected(use);
    case SelectionUse::color:
    case SelectionUse::color_residue:
    case SelectionUse::color_chain:
      return color_selected(use);
    default:
      selection.clear();
      return refresh();
  }
}

void AppState::inspect(const Vec3d& point) {
  if (const auto at = Projection(shown_camera(), stage).point(point)) {
    const ImVec2 place(float(stage.across(at->x)), float(stage.down(at->y)));
    if (place.x >= 0 && place.x < 1 && place.y >= 0 && place.y < 1)
      return ask(request::Inspect{place, place});
  }
  say(tr("it is outside of the picture"));
}

void AppState::switch_focusing() {
  if (view.path.empty()) return;
  if (view.camera.is_parallel()) return say(tr("parallel rays have no lens"));
  focuses = !focuses;
  say(focuses ? tr("click what shall be sharp; the wheel sets the aperture; e ends it")
              : tr("focus tool off"));
  renew_other(0);
}

void AppState::open(const std::string& path) {
  if (!has_picture_suffix(path)) return ask(request::OpenFile{path});
  if (view.path.empty())
    return complain(tr("open the scene of this picture first, then the picture again"));
  ask(request::CompareWith{path});
}

void AppState::switch_split() {
  if (view.compared) {
    view.shows_difference = !view.shows_difference;
    say(view.shows_difference ? tr("differences, eight times as large")
                              : tr("side by side: A and B"));
    return renew_other(0);
  }
  view.split = !view.split;
  say(view.split ? tr("side by side: with and without the last effect") : tr("one picture"));
  renew();
}

void AppState::switch_comparing() {
  if (view.path.empty()) return say(tr("no scene is open"));
  if (view.compared) return stop_comparing();
  ask(request::AskForFile{FileDialog::Purpose::compare});
  refresh();
}

void AppState::stop_comparing() {
  view.compared.reset();
  ask(request::StopComparing{});
  say(tr("one picture"));
  renew_other(0);
}

void AppState::switch_effect(Command effect) {
  const uint64_t request_before = request;
  const RenderOptions options = view.options;
  const std::string what = view.toggle(effect);
  log(what);
  if (view.options == options) return say(what);
  if (renew()) say(comparison_.begin(what, picture.get(), request_before));
}

void AppState::switch_panel() {
  bool& shown = is_narrow() ? covers_ : view.panel;
  shown = !shown;
  say(shown ? tr("panel shown") : tr("panel hidden; h shows it"));
}

void AppState::switch_pause() {
  view.paused = !view.paused;
  if (measuring == Measuring::Work::costs) cancel_measuring(), costs_are_old = true;
  ask(request::Pause{view.paused});
  say(view.paused ? tr("paused") : tr("resumed"));
}

void AppState::switch_picking() {
  if (view.path.empty()) return;
  ask(request::PickPixel{!facts_.picks});
  say(facts_.picks ? tr("no pixel chosen")
                   : tr("click a pixel to see its rays; shift and drag: a region"));
}

void AppState::switch_look(bool Theme::* what) {
  look.*what = !(look.*what);
  ask(request::SetLook{look});
  if (what == &Theme::projector) return say(look.projector ? tr("big type") : tr("normal type"));
  say(look.light ? tr("light colours") : tr("dark colours"));
}

void AppState::switch_work(Measuring::Work work, const char* what) {
  if (wanted_ == work) return wanted_ = Measuring::Work::none, say(tr("stopped"));
  if (measuring == work) return cancel_measuring();
  costs_are_old |= measuring != Measuring::Work::none;
  cancel_measuring();
  wanted_ = work;
  say(what);
}

void AppState::move_camera(const Camera& camera) {
  view.camera = camera;
  moving_until_ = 0;
  view.follow_focus();
  renew();
}

Camera AppState::fit() const {
  Camera camera = fitted(shown_camera(), view.box, stage.aspect());
  camera.fov_deg = view.camera.fov_deg;
  return camera;
}

void AppState::focus_on(const Pick& pick) {
  if (!pick.hit.found()) return say(tr("nothing there to focus on"));
  if (view.camera.is_parallel()) return say(tr("parallel rays have no lens"));
  view.focus_on(pick.point);
  show_focus();
  say(trf("focus on {}, distance {:.6g}", pick.what, view.options.focus));
  renew();
}

void AppState::close_inspector() {
  ask(request::CloseInspector{});
  log("inspector closed");
  refresh();
}

void AppState::copy_command(const std::string& command) {
  ask(request::CopyText{command});
  log("command: " + command);
  say(is_scene_of_file()
          ? trf("copied: {}", command)
          : trf("copied, but your changes are not in the file yet; Ctrl+S saves them: {}",
                command));
}

void AppState::save_scene(const std::string& path) {
  if (std::exchange(is_saving_, true)) return say(tr("the scene is still being saved"));
  ask(request::SaveScene{path});
}

void AppState::go_back(bool back) {
  history.settle(view);
  if (!(back ? history.can_undo() : history.can_redo()))
    return say(back ? tr("nothing to undo") : tr("nothing to redo"));
  ViewState next = back ? history.undo() : history.redo();
  next.keep_habits(view);
  // The file is the one last saved or opened.
  if (next.path != view.path)
    next.path = view.path, next.read_options = view.read_options, next.file = view.file;
  wanted_read_.reset();
  if (next.file != view.file) selection.clear();  // its atoms have other numbers there
  view = std::move(next);
  moving_until_ = 0;
  say(back ? tr("undone") : tr("redone"));
  renew();
}

bool AppState::leave() {
  if (facts_.has_dialog)
    ask(request::CloseDialogs{});
  else if (facts_.inspects || facts_.picks)
    close_inspector();
  else if (focuses)
    switch_focusing();
  else if (!selection.empty())
    selection.clear();
  else if (view.compared)
    stop_comparing();
  else if (shows_lesson)
    switch_lesson();
  else if (facts_.full_screen)
    ask(request::SetFullScreen{false});
  else
    return false;
  return true;
}

}  // namespace raio::core::view
