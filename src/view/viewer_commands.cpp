// The commands of keys and buttons.
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <filesystem>

#include "view/texts.h"
#include "view/viewer.h"

namespace raio::core::view {

void Viewer::obey(const KeySpec& key) {
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
    case Command::pause:
      return switch_pause();
    case Command::panel:
      return switch_panel();
    case Command::boxes:
      return switch_boxes();
    case Command::inspect:
      return switch_picking();
    case Command::theme:
      return switch_look(&Theme::light);
    case Command::projector:
      return switch_look(&Theme::projector);
    case Command::full_screen:
      return switch_full_screen();
    case Command::measure:
      return switch_work(Measuring::Work::table, tr("measuring all combinations; m stops"));
    case Command::curve:
      return switch_work(Measuring::Work::curve,
                         tr("measuring grids from coarse to fine; n stops"));
    case Command::fit:
      return move_camera(fitted(state_.camera, bounds(*state_.scene), stage_.aspect()),
                         tr("the scene fits"));
    case Command::home:
      return move_camera(state_.own_camera(), tr("the scene's own camera"));
    case Command::show_view:
      state_.show(View(key.key - '1'));
      say(trf("view: {}", tr(key.help)));
      return void(renew());
    case Command::walk_back:
      return step_ray(Inspector::Walk::back);
    case Command::walk_on:
      return step_ray(Inspector::Walk::on);
    case Command::walk_play:
      return step_ray(Inspector::Walk::play);
    case Command::undo:
    case Command::redo:
      return go_back(key.command == Command::undo);
    case Command::copy:
      return copy_command();
    case Command::save_png:
    case Command::save_exr:
      to_save_ = key.command == Command::save_png ? ".png" : ".exr";
      return save_when_whole();
    case Command::open:
      controls_.files.ask(FileDialog::Purpose::open, file_.folder(), {});
      return needs_drawing();
    case Command::save_scene:
      return ask_where_to_save();
    case Command::help:
      controls_.switch_help();
      return needs_drawing();
    case Command::quit:
      if (key.key == GLFW_KEY_ESCAPE && leave()) return needs_drawing();
      return window_.close();
  }
}

void Viewer::finish(Gestures::Done gesture) {
  const double x = gestures_.x(), y = gestures_.y();
  using enum Gestures::Done;
  if (gesture == nothing) return;
  if (gesture == click && !inspector_.is_picking()) return focus_on(pick_at(x, y));
  const auto at = [&](double across, double down) {
    return ImVec2(float(stage_.across(across)), float(stage_.down(down)));
  };
  log(inspector_.look(state_, stage_, baked(),
                      gesture == region ? at(gestures_.from_x(), gestures_.from_y()) : at(x, y),
                      at(x, y)));
  if (!state_.panel) say(tr("h shows the panel with the numbers"));
}

void Viewer::switch_effect(Command effect) {
  const auto before = pictures_.main.picture;
  const uint64_t request = pictures_.main.request;
  const RenderOptions options = state_.options;
  const std::string what = state_.toggle(effect);
  log(what);
  if (state_.options == options) return say(what);
  if (renew()) say(comparison_.begin(what, before.get(), request));
}

void Viewer::switch_split() {
  state_.split = !state_.split;
  say(state_.split ? tr("side by side: with and without the last effect") : tr("one picture"));
  renew();
}

void Viewer::switch_pause() {
  state_.paused = !state_.paused;
  if (measuring_.work() == Measuring::Work::costs) measuring_.cancel(), costs_are_old_ = true;
  pictures_.pause(state_.paused || measuring_.busy());
  say(state_.paused ? tr("paused") : tr("resumed"));
}

void Viewer::switch_panel() {
  state_.panel = !state_.panel;
  say(state_.panel ? tr("panel shown") : tr("panel hidden; h shows it"));
  lay_out();
}

void Viewer::switch_boxes() {
  state_.boxes.shown = !state_.boxes.shown;
  say(state_.boxes.shown ? tr("boxes of the structure shown")
                         : tr("boxes of the structure hidden"));
}

void Viewer::switch_picking() {
  if (state_.path.empty()) return;
  inspector_.pick(!inspector_.is_picking());
  say(inspector_.is_picking() ? tr("click a pixel to see its rays; shift and drag: a region")
                              : tr("no pixel chosen"));
}

void Viewer::switch_look(bool Theme::* what) {
  Theme look = window_.look();
  look.*what = !(look.*what);
  window_.set_look(look);
  if (what == &Theme::projector) return say(look.projector ? tr("big type") : tr("normal type"));
  say(look.light ? tr("light colours") : tr("dark colours"));
}

void Viewer::switch_full_screen() {
  window_.set_full_screen(!window_.is_full_screen());
  say(window_.is_full_screen() ? tr("full screen; F11 leaves it") : tr("window"));
}

void Viewer::switch_work(Measuring::Work work, const char* what) {
  if (wanted_ == work) return wanted_ = Measuring::Work::none, say(tr("stopped"));
  if (measuring_.work() == work) return measuring_.cancel();
  costs_are_old_ |= measuring_.busy();
  measuring_.cancel();
  wanted_ = work;
  say(what);
}

void Viewer::move_camera(const Camera& camera, const char* what) {
  state_.camera = camera;
  moving_until_ = 0;
  state_.follow_focus();
  say(what);
  renew();
}

void Viewer::focus_on(const Pick& pick) {
  if (!pick.hit.found()) return say(tr("nothing there to focus on"));
  if (state_.camera.is_parallel()) return say(tr("parallel rays have no lens"));
  state_.focus_on(pick.point);
  state_.chosen_material = int(pictures_.main.picture->baked->accel->geometry().material_of(
      pick.hit.primitive, pick.hit.instance));
  show_focus();
  say(trf("focus on {}, distance {:.6g}; while the colours show, the wheel sets the aperture",
          pick.what, state_.options.focus));
  renew();
}

void Viewer::step_ray(Inspector::Walk where) {
  if (const std::string at = inspector_.walk(where, now()); !at.empty()) log(at);
  needs_drawing();
}

void Viewer::close_inspector() {
  inspector_.close();
  log("inspector closed");
  needs_drawing();
}

void Viewer::copy_command() {
  const std::string command = command_line(state_.scene->name + ".png");
  window_.set_clipboard(command);
  log("command: " + command);
  say(state_.scene == saved_scene_
          ? trf("copied: {}", command)
          : trf("copied, but your changes are not in the file yet; Ctrl+S saves them: {}",
                command));
}

void Viewer::ask_where_to_save() {
  if (state_.path.empty()) return say(tr("no scene is open"));
  const std::string name = free_name((file_.folder() / state_.scene->name).string(), ".nff");
  controls_.files.ask(FileDialog::Purpose::save, file_.folder(),
                      std::filesystem::path(name).filename().string());
  needs_drawing();
}

void Viewer::save_scene(const std::string& path) {
  if (scene_writer_.is_busy()) return say(tr("the scene is still being saved"));
  scene_writer_.write(state_, path);
}

void Viewer::go_back(bool back) {
  history_.settle(state_);
  if (!(back ? history_.can_undo() : history_.can_redo()))
    return say(back ? tr("nothing to undo") : tr("nothing to redo"));
  ViewState next = back ? history_.undo() : history_.redo();
  next.paused = state_.paused, next.panel = state_.panel, next.boxes = state_.boxes;
  // The file is the one last saved or opened.
  next.path = state_.path;
  next.read_options = state_.read_options;
  state_ = std::move(next);
  moving_until_ = 0;
  say(back ? tr("undone") : tr("redone"));
  renew();
}

bool Viewer::leave() {
  if (controls_.close()) return true;
  if (inspector_.is_open() || inspector_.is_picking()) return close_inspector(), true;
  if (!window_.is_full_screen()) return false;
  window_.set_full_screen(false);
  return true;
}

std::string Viewer::command_line(const std::string& output) const {
  const int samples = pictures_.main.picture ? std::max(1, pictures_.main.picture->samples) : 1;
  return state_.command_line(stage_.picture_width, stage_.picture_height, samples, output);
}

}  // namespace raio::core::view
