#include "view/viewer.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <expected>
#include <filesystem>

#include "app/output.h"
#include "app/terminal.h"
#include "render/provenance.h"
#include "render/render.h"
#include "render/session.h"
#include "view/camera_control.h"
#include "view/comparison.h"
#include "view/controls.h"
#include "view/edit.h"
#include "view/files.h"
#include "view/gestures.h"
#include "view/history.h"
#include "view/inspector.h"
#include "view/layout.h"
#include "view/legend.h"
#include "view/measure.h"
#include "view/memory.h"
#include "view/pictures.h"
#include "view/structure_overlay.h"
#include "view/texts.h"
#include "view/theme.h"
#include "view/window.h"

namespace raio::view {
namespace {

constexpr double kFrameSeconds = 0.024;   // of rendering; drawing takes the rest of a 30th
constexpr double kDrawGapSeconds = 0.03;  // between drawings that show no new picture
constexpr double kRestSeconds = 0.15;     // after the last movement
constexpr double kBeforeCosts = 0.8;      // of rest, until costs are measured
constexpr double kFocusSeconds = 2.5;     // that the plane in focus is shown
constexpr double kWaitingSeconds = 0.5;   // between drawings while nothing new comes
constexpr double kIdleSeconds = 0.1;      // between looks at the disk
constexpr double kSlowSeconds = 0.8;      // a first sample that takes longer shows its progress

std::string text_of(Vec3f v) { return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z); }

class Viewer final : public WindowEvents {
 public:
  /// `session` has got `first_request` already, whose rays need no window.
  Viewer(Window& window, ViewState state, Memory memory, std::vector<std::string> warnings,
         bool logs, std::unique_ptr<Session> session, const RenderOptions& first_request)
      : window_(window),
        logs_(logs),
        opened_{0, 0, float(window.width()), float(window.height())},
        first_width_(state.path.empty() ? 0 : first_request.width),
        first_height_(state.path.empty() ? 0 : first_request.height),
        state_(std::move(state)),
        history_(state_),
        saved_scene_(state_.scene),
        keeper_(std::move(memory)),
        file_(state_.path),
        pictures_(std::move(session)),
        warnings_(std::move(warnings)),
        gestures_(state_, stage_, [this](double x, double y) { return pick_at(x, y); }) {
    window_.listen(this);
    log("request: 1");
    stage_.picture_width = first_request.width, stage_.picture_height = first_request.height;
    lay_out();
    log(fmt::format("place: {},{}", stage_.lo.x, stage_.lo.y));
    if (!state_.path.empty()) keeper_.opened(state_.path);
  }
  ~Viewer() override { window_.listen(nullptr); }

  void run() {
    while (!window_.should_close()) {
      Window::wait_events(drawings_ > 0 || inspector_.is_playing() ? 0.004 : kIdleSeconds);
      step();
    }
    log("closed");
  }

  void key_pressed(int key, Modifiers held) override {
    if (gestures_.is_looking() && steps_held().any()) return;
    if (const KeySpec* spec = find_key(key, held)) obey(*spec);
  }
  void button(int number, bool down, bool shift) override {
    needs_drawing();
    if (number > GLFW_MOUSE_BUTTON_MIDDLE) return;
    const auto which = Gestures::Button(number);
    if (down && is_covered()) return;
    if (down)
      gestures_.press(which, shift, inspector_.is_open() || inspector_.is_picking());
    else
      finish(gestures_.release(which));
  }
  void cursor_moved(double x, double y) override {
    needs_drawing();
    if (gestures_.move(x, y)) camera_moved();
  }
  void scrolled(double steps, bool ctrl) override {
    needs_drawing();
    if (is_covered() || !stage_.contains(gestures_.x(), gestures_.y())) return;
    if (ctrl || shows_focus()) {
      state_.scale_aperture(float(std::pow(1.1, steps)));
      if (!state_.is_on(Command::depth_of_field)) (void)state_.toggle(Command::depth_of_field);
      focus_until_ = now() + kFocusSeconds;
      say(trf("aperture {:.4g}", state_.options.aperture));
      renew();
    } else if (gestures_.dolly(steps)) {
      camera_moved();
    }
  }
  void file_dropped(const std::string& path) override { file_.open(path); }
  void needs_drawing() override { drawings_ = 3; }  // the panel takes some to settle

 private:
  static double now() { return Window::seconds(); }

  void log(std::string_view event) const {
    if (logs_) app::print_line(fmt::format("{:.1f} {}", now() * 1e3, event));
  }
  // What was done, in the language of the screen.
  void say(std::string message, bool is_error = false) {
    log(message);
    says_error_ = is_error;
    message_.say(std::move(message), now());
    needs_drawing();
  }
  void complain(std::string message) { say(std::move(message), true); }

  void finish(Gestures::Done gesture) {
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

  // That of the newest picture; null before the first.
  std::shared_ptr<const BakedScene> baked() const {
    return pictures_.main.picture ? pictures_.main.picture->baked : nullptr;
  }

  bool is_moving() const { return now() < moving_until_; }
  // The picture, at the cursor.
  bool is_covered() const {
    return state_.path.empty() || (controls_.has_dialog() && Window::is_over_controls());
  }
  bool shows_focus() const { return now() < focus_until_; }

  Pick pick_at(double x, double y) const {
    const auto& picture = pictures_.main.picture;
    if (!picture || !picture->baked || picture->baked->scene != state_.scene) return {};
    return pick(*picture->baked->accel, state_.camera, stage_.across(x), stage_.down(y),
                stage_.aspect());
  }

  void camera_moved() {
    moving_until_ = now() + kRestSeconds;
    renew();
  }

  // Where things are in the window. The picture has the size that it was opened with while the
  // window is as it was opened, panel and all; else it fills the room that there is.
  void lay_out() {
    const float width = float(window_.width()), height = float(window_.height());
    layout_ = Layout(width, height, em(), state_.panel && !state_.path.empty());
    const float unit = 1 / window_.pixels_per_unit();
    const bool follows = !state_.panel || width != opened_.right || height != opened_.bottom ||
                         layout_.picture.width() < std::floor(float(first_width_) * unit) ||
                         layout_.picture.height() < std::floor(float(first_height_) * unit);
    const RenderOptions& o = state_.options;
    const auto wanted = [&](int given, int first) {
      return given > 0 ? given : follows ? 0 : first;
    };
    const Stage before = std::exchange(
        stage_, Stage(layout_.picture, window_.pixels_per_unit(), wanted(o.width, first_width_),
                      wanted(o.height, first_height_)));
    if (stage_.picture_width == before.picture_width &&
        stage_.picture_height == before.picture_height)
      return;
    log(fmt::format("size: {}x{}", stage_.picture_width, stage_.picture_height));
    renew();
  }

  // Tells the sessions what is wanted now. Whether it can be had.
  bool renew() {
    const RenderOptions o = state_.request(stage_.picture_width, stage_.picture_height);
    comparison_.end();
    if (const auto why = option_conflict(o, state_.scene.get()))
      return complain(why->text("--")), false;
    const double frame_s = is_moving() ? kFrameSeconds : 0;
    moved_ = frame_s > 0;
    pictures_.request(state_, stage_, frame_s);
    requested_at_ = now();
    if (!moved_) log(fmt::format("request: {}", pictures_.main.request));
    measuring_.cancel();
    costs_are_old_ = true;
    renew_other(frame_s);
    if (!moved_) inspector_.follow(state_);
    return true;
  }

  void renew_other(double frame_s) {
    const Other wanted = shows_focus() ? Other::focus : state_.split ? Other::without : Other::none;
    pictures_.request_other(wanted, state_, stage_, frame_s);
  }

  void obey(const KeySpec& key) {
    switch (key.command) {
      case Command::antialiasing:
      case Command::soft_shadows:
      case Command::depth_of_field:
      case Command::structure:
      case Command::reflection:
      case Command::refraction:
        return switch_effect(key.command);
      case Command::split:
        state_.split = !state_.split;
        say(state_.split ? tr("side by side with the last effect switched") : tr("one picture"));
        return void(renew());
      case Command::pause:
        state_.paused = !state_.paused;
        if (measuring_.work() == Measuring::Work::costs) measuring_.cancel(), costs_are_old_ = true;
        pictures_.pause(state_.paused || measuring_.busy());
        return say(state_.paused ? tr("paused") : tr("goes on"));
      case Command::panel:
        state_.panel = !state_.panel;
        say(state_.panel ? tr("panel shown") : tr("panel hidden; h shows it"));
        return lay_out();
      case Command::fit:
        state_.camera = fitted(state_.camera, bounds(*state_.scene), stage_.aspect());
        state_.follow_focus();
        say(tr("the scene fits"));
        return void(renew());
      case Command::home:
        state_.camera = state_.scene->camera;
        moving_until_ = 0;
        state_.follow_focus();
        say(tr("the scene's own camera"));
        return void(renew());
      case Command::save_png:
      case Command::save_exr:
        to_save_ = key.command == Command::save_png ? ".png" : ".exr";
        return save_when_whole();
      case Command::copy: {
        const std::string command = command_line(state_.scene->name + ".png");
        window_.set_clipboard(command);
        log("command: " + command);
        return say(
            state_.scene == saved_scene_
                ? trf("copied: {}", command)
                : trf("copied, but the file lacks your changes; Ctrl+S saves them: {}", command));
      }
      case Command::show_view:
        state_.show(View(key.key - '1'));
        say(trf("view: {}", tr(key.help)));
        return void(renew());
      case Command::measure:
        return switch_work(Measuring::Work::table, tr("measuring all combinations; m stops"));
      case Command::curve:
        if (state_.path.empty()) return;
        return switch_work(Measuring::Work::curve,
                           tr("measuring grids from coarse to fine; n stops"));
      case Command::boxes:
        state_.boxes.shown = !state_.boxes.shown;
        return say(state_.boxes.shown ? tr("boxes of the structure shown")
                                      : tr("boxes of the structure hidden"));
      case Command::inspect:
        if (state_.path.empty()) return;
        inspector_.pick(!inspector_.is_picking());
        return say(inspector_.is_picking()
                       ? tr("click a pixel to look into its rays; shift and drag: a region")
                       : tr("no pixel chosen"));
      case Command::walk_back:
        return step_ray(Inspector::Walk::back);
      case Command::walk_on:
        return step_ray(Inspector::Walk::on);
      case Command::walk_play:
        return step_ray(Inspector::Walk::play);
      case Command::undo:
      case Command::redo:
        return go_back(key.command == Command::undo);
      case Command::theme:
      case Command::projector: {
        Look look = window_.look();
        bool& changed = key.command == Command::theme ? look.light : look.projector;
        changed = !changed;
        window_.set_look(look);
        if (key.command == Command::projector)
          return say(look.projector ? tr("big type") : tr("usual type"));
        return say(look.light ? tr("light colours") : tr("dark colours"));
      }
      case Command::full_screen:
        window_.set_full_screen(!window_.is_full_screen());
        return say(window_.is_full_screen() ? tr("full screen; F11 ends it") : tr("window"));
      case Command::help:
        controls_.switch_help();
        return needs_drawing();
      case Command::quit:
        if (key.key == GLFW_KEY_ESCAPE && leave()) return needs_drawing();
        return window_.close();
      case Command::open:
        controls_.files.ask(FileDialog::Purpose::open, file_.folder(), {});
        return needs_drawing();
      case Command::save_scene: {
        if (state_.path.empty()) return say(tr("no scene is open"));
        const std::string name = free_name((file_.folder() / state_.scene->name).string(), ".nff");
        controls_.files.ask(FileDialog::Purpose::save, file_.folder(),
                            std::filesystem::path(name).filename().string());
        return needs_drawing();
      }
    }
  }

  void step_ray(Inspector::Walk where) {
    if (const std::string at = inspector_.walk(where, now()); !at.empty()) log(at);
    needs_drawing();
  }

  void take_inspector(const InspectorResult& did) {
    if (did.closed) close_inspector();
    if (did.camera) {
      state_.camera = *did.camera;
      state_.follow_focus();
      moving_until_ = 0;
      renew();
    }
    if (did.copied) {
      window_.set_clipboard(inspector_.command_line(state_));
      say(trf("copied: {}", inspector_.command_line(state_)));
    }
    if (did.save.empty()) return;
    const std::string path = free_name(inspector_.file_name(), did.save);
    writer_.write(inspector_.drawing(did.save, state_.camera), path,
                  inspector_.command_line(state_));
  }
  void close_inspector() {
    inspector_.close();
    log("inspector closed");
    needs_drawing();
  }

  void save_scene(const std::string& path) {
    if (scene_writer_.is_busy()) return say(tr("the scene is still being saved"));
    scene_writer_.write(state_, path);
  }

  void take_saved_scene(const SceneWriter::Written& written) {
    if (!written.result) return complain(written.result.error().text("--"));
    take_saved(state_, written);
    saved_scene_ = written.scene;
    file_.follow(state_.path);
    keeper_.opened(written.path);
    say(trf("saved the scene as {}", written.path) +
        (written.result->empty() ? "" : "; " + trf("not kept: {}", *written.result)));
    renew();
  }

  // What Escape ends before it ends the program.
  bool leave() {
    if (controls_.close()) return true;
    if (inspector_.is_open() || inspector_.is_picking()) return close_inspector(), true;
    if (!window_.is_full_screen()) return false;
    window_.set_full_screen(false);
    return true;
  }

  void go_back(bool back) {
    history_.settle(state_);
    if (!(back ? history_.can_undo() : history_.can_redo()))
      return say(back ? tr("nothing to undo") : tr("nothing to redo"));
    ViewState next = back ? history_.undo() : history_.redo();
    next.paused = state_.paused, next.panel = state_.panel, next.boxes = state_.boxes;
    state_ = std::move(next);
    moving_until_ = 0;
    say(back ? tr("undone") : tr("made again"));
    renew();
  }

  void switch_effect(Command effect) {
    const auto before = pictures_.main.picture;
    const uint64_t request = pictures_.main.request;
    const std::string what = state_.toggle(effect);
    log(what);
    if (renew()) say(comparison_.begin(what, before.get(), request));
  }

  void focus_on(const Pick& pick) {
    if (!pick.hit.found()) return say(tr("nothing there to focus on"));
    state_.focus_on(pick.point);
    state_.chosen_material =
        int(pictures_.main.picture->baked->accel->geometry().material_of(pick.hit.item));
    focus_until_ = now() + kFocusSeconds;
    say(trf("focus on {}, distance {:.6g}; while the colours show, the wheel sets the aperture",
            pick.what, state_.options.focus));
    renew();
  }

  int samples() const {
    return pictures_.main.picture ? std::max(1, pictures_.main.picture->samples) : 1;
  }
  std::string command_line(const std::string& output) const {
    return state_.command_line(stage_.picture_width, stage_.picture_height, samples(), output);
  }

  // What is saved is a picture that `raio render` makes: of the newest request, at rest, with as
  // many samples in every pixel.
  void save_when_whole() {
    if (to_save_.empty()) return;
    const auto picture = pictures_.whole(state_);
    if (!picture) return;
    const std::string path = free_name(state_.scene->name, std::exchange(to_save_, {}));
    const RenderSettings s = resolve_options(
        state_.request(stage_.picture_width, stage_.picture_height, picture->samples),
        *state_.scene);
    writer_.write(picture->image, path, settings_of(*state_.scene, s), command_line(path));
  }

  // The costs, which are measured unasked, make way for what is asked for.
  void switch_work(Measuring::Work work, const char* what) {
    if (wanted_ == work) return wanted_ = Measuring::Work::none, say(tr("stopped"));
    if (measuring_.work() == work) return measuring_.cancel();
    costs_are_old_ |= measuring_.busy();
    measuring_.cancel();
    wanted_ = work;
    say(what);
  }

  // Whoever measures wants the machine for themselves: sessions rest, and the window draws in
  // pauses that are left for it.
  void measure() {
    if (measuring_.busy()) return;
    if (wanted_ == Measuring::Work::none && !may_measure_costs()) {
      if (std::exchange(is_holding_, false)) pictures_.pause(state_.paused);
      return;
    }
    is_holding_ = true;
    pictures_.pause(true);
    if (!pictures_.are_idle()) return;
    const Measuring::Work work = std::exchange(wanted_, Measuring::Work::none);
    if (work == Measuring::Work::table) {
      measuring_.start_table(state_, stage_.picture_width, stage_.picture_height);
    } else if (work == Measuring::Work::curve) {
      measuring_.start_curve(state_, stage_.picture_width, stage_.picture_height);
    } else {
      costs_are_old_ = false;
      log("measures the costs");
      measuring_.start_costs(state_, pictures_.main.picture->baked, stage_.picture_width,
                             stage_.picture_height);
    }
  }

  // At rest, and after the picture itself.
  bool may_measure_costs() const {
    const auto& picture = pictures_.main.picture;
    return !state_.path.empty() && costs_are_old_ && wants_costs_ && !state_.paused &&
           !is_moving() && picture && picture->request == pictures_.main.request &&
           picture->sample_s.median > 0 && now() >= moving_until_ + kBeforeCosts &&
           message_.age(now()) >= kBeforeCosts;
  }

  void step() {
    const double time = now(), passed = time - std::exchange(last_step_, time);
    if (gestures_.walk(steps_held(), passed)) camera_moved();
    lay_out();
    if (moved_ && !is_moving()) {
      log(fmt::format("camera: from {} at {}", text_of(state_.camera.from),
                      text_of(state_.camera.at)));
      renew();
    }
    if (pictures_.wanted_other() == Other::focus && !shows_focus()) renew_other(0), needs_drawing();
    if (message_.expire(time)) needs_drawing();
    if (!is_moving() && !gestures_.is_busy() && !Window::is_busy()) history_.settle(state_);
    // Time goes by while the first sample is awaited.
    if (is_waiting() && time > last_draw_ + kWaitingSeconds) needs_drawing();
    take_results();
    bool is_new = take_picture(pictures_.main);
    is_new |= take_picture(pictures_.other);
    save_when_whole();
    find_warnings();
    measure();
    if (inspector_.advance(time)) drawings_ = std::max(drawings_, 1);
    if (measuring_.has_news()) drawings_ = std::max(drawings_, 1);
    if (window_.is_hidden()) {
      drawings_ = 0;
    } else if (is_new || (drawings_ > 0 && (!is_moving() || time > last_draw_ + kDrawGapSeconds))) {
      drawings_ = is_new ? std::max(drawings_, 1) : drawings_;
      draw();
      --drawings_;
    }
  }

  // For the first sample of what was requested.
  bool is_waiting() const {
    const auto& p = pictures_.main.picture;
    return !is_moving() && (!p || p->request != pictures_.main.request || p->samples == 0);
  }

  Steps steps_held() const {
    if (Window::is_typing()) return {};
    return walking_steps([this](int key) { return window_.is_held(key); }, gestures_.is_looking());
  }

  bool take_picture(Side& side) {
    if (!side.take()) return false;
    const SessionPicture& p = *side.picture;
    if (p.error) complain(p.error->text("--"));
    if (&side == &pictures_.main)
      if (auto line = comparison_.take(p, side.request)) say(std::move(*line));
    return true;
  }

  void take_results() {
    if (const auto written = scene_writer_.poll()) take_saved_scene(*written);
    // What is being saved is no news from the disk.
    if (!scene_writer_.is_busy())
      if (auto read = file_.poll(state_.options.threads)) take_scene(*read);
    while (auto written = writer_.poll()) {
      if (!written->result) {
        complain(written->result.error().text());
        continue;
      }
      const std::filesystem::path path = std::filesystem::absolute(written->path);
      say(trf("saved {} in {}", path.filename().string(), path.parent_path().string()));
      log("command: " + written->command);
    }
    if (const auto found = inspector_.poll()) {
      if (*found)
        log(**found);
      else
        complain(found->error().text("--"));
      needs_drawing();
    }
    if (const auto done = measuring_.poll()) {
      done->empty() ? log_costs() : say(*done);
      needs_drawing();
    }
  }

  void log_costs() const {
    for (const EffectCost& c : measuring_.costs().effects) log(cost_line(c));
    log(measuring_.costs().finished ? "measured the costs" : "did not measure the costs");
  }

  // Of a picture that keeps its viewer waiting.
  std::optional<SessionProgress> progress() const {
    const auto progress = pictures_.main.session->progress();
    if (!progress || progress->passed_s + progress->left_s < kSlowSeconds) return std::nullopt;
    return progress;
  }

  void take_scene(const SceneFile::Read& read) {
    if (!read.scene) {
      errors_ = read.scene.error();
      return complain(errors_.front().text());
    }
    errors_.clear();
    const bool is_other = read.path != state_.path;
    state_.open(read.path, *read.scene);
    measuring_.forget();
    warnings_ = Warnings(read.warnings);
    // A new version of the file is a step that can be taken back; another scene is a beginning.
    if (is_other) inspector_.close();
    if (is_other) history_ = History<ViewState>(state_);
    saved_scene_ = state_.scene;
    keeper_.opened(read.path);
    say(trf("opened {}", read.path));
    renew();
  }

  void find_warnings() {
    if (is_moving() || is_waiting()) return;
    if (warnings_.find(*state_.scene, *pictures_.main.picture)) needs_drawing();
  }

  void draw() {
    last_draw_ = now();
    window_.begin_frame();
    lay_out();
    if (!state_.path.empty()) pictures_.draw(state_, stage_, float(gestures_.split_at));
    const ReadOut under = under_cursor();
    overlay_.draw(layout_.picture, state_, baked(), stage_);
    draw_inspector();
    ViewState shown = state_;
    if (shows_focus()) shown.show(View::focus);
    if (overlay_.facts().all > 0)
      draw_legend(layout_.picture, overlay_.legend(), {});
    else
      draw_legend(layout_.picture, legend_of(shown), under.at);
    take_controls(controls_.draw(state_, layout_, control_facts(under.text)));
    window_.end_frame();
    window_.set_title(state_.path.empty() ? "Raio" : state_.title());
    keeper_.looks(window_.look(), language());
    if (std::exchange(typing_, Window::is_typing()) != typing_) log(typing_ ? "types" : "typed");
    log_picture(pictures_.main, "picture");
    log_picture(pictures_.other, "other");
  }

  void draw_inspector() {
    inspector_.draw_rays(layout_.picture, state_.camera, stage_);
    if (gestures_.is_selecting())
      ImGui::GetBackgroundDrawList()->AddRect(
          {float(gestures_.from_x()), float(gestures_.from_y())},
          {float(gestures_.x()), float(gestures_.y())}, color(palette().accent), 0, 0, 2);
    if (!inspector_.is_open() || !state_.panel) return;
    take_inspector(inspector_.draw_panel(layout_.panel, now()));
    if (std::string places = inspector_.places(); logs_ && places != button_places_) {
      button_places_ = places;
      log("buttons:" + places);
    }
  }

  // What the picture shows where the cursor is; nothing while something moves.
  ReadOut under_cursor() const {
    if (is_covered() || gestures_.is_busy() || is_waiting() || is_moving()) return {};
    const double x = gestures_.x(), y = gestures_.y();
    return read_out(state_, *pictures_.main.picture, stage_.across(x), stage_.down(y),
                    pick_at(x, y));
  }

  void log_picture(Side& side, std::string_view name) {
    if (!logs_) return;
    if (const auto news = side.news()) log(fmt::format("{}: {}", name, *news));
  }

  CostFacts cost_facts() const {
    return {.picture = pictures_.main.picture,
            .picture_width = stage_.picture_width,
            .picture_height = stage_.picture_height,
            .costs = measuring_.costs(),
            .table = measuring_.table(),
            .curve = measuring_.curve(),
            .is_curve_old =
                !measuring_.is_curve_of(state_, stage_.picture_width, stage_.picture_height),
            .measuring = measuring_.work(),
            .progress = measuring_.progress(),
            .are_old = costs_are_old_,
            .waits = progress().transform(progress_line)};
  }

  ControlFacts control_facts(const std::string& under) const {
    ControlFacts facts;
    facts.panel = {cost_facts(), errors_, warnings_.lines(), window_.look(), overlay_.facts()};
    facts.tools = {history_.can_undo(), history_.can_redo(), window_.is_full_screen(),
                   inspector_.is_open() || inspector_.is_picking()};
    facts.status = {.picture = pictures_.main.picture.get(),
                    .request = pictures_.main.request,
                    .since_request_s = now() - requested_at_,
                    .progress = progress(),
                    .picture_width = stage_.picture_width,
                    .picture_height = stage_.picture_height,
                    .moving = is_moving(),
                    .paused = state_.paused,
                    .measuring = measuring_.work()};
    facts.has_inspector = inspector_.is_open();
    facts.read_out = under;
    facts.recent = keeper_.memory().recent;
    // An error of the file stays until it is mended.
    const bool stays = message_.text().empty() && !errors_.empty();
    facts.message = stays ? errors_.front().text() : message_.text();
    facts.is_error = stays || says_error_;
    return facts;
  }

  void take_controls(const ControlResult& result) {
    wants_costs_ = result.wants_costs;
    if (result.open) file_.open(short_path(*result.open));
    if (result.save) save_scene(*result.save);
    if (result.saves_curve)
      writer_.write([csv = grid_curve_csv(measuring_.curve())] { return csv; },
                    free_name(state_.scene->name + "-grid", ".csv"), "");
    for (const KeySpec* key : result.pressed) obey(*key);
    if (!result.problem.empty()) complain(result.problem);
    if (!result.changed) return;
    if (result.dragging) moving_until_ = now() + kRestSeconds;
    renew();
  }

  using Other = Pictures::Other;

  Window& window_;
  const bool logs_;
  const Rect opened_;                     // the window's size
  const int first_width_, first_height_;  // the picture's
  Layout layout_;
  Stage stage_;
  ViewState state_;
  History<ViewState> history_;
  Controls controls_{sample_scenes()};
  SharedScene saved_scene_;  // as the file has it
  MemoryKeeper keeper_;
  SceneFile file_;
  PictureWriter writer_;
  SceneWriter scene_writer_;
  Pictures pictures_;
  Warnings warnings_;
  Gestures gestures_;
  StructureOverlay overlay_;
  Inspector inspector_{[] { Window::wake(); }};
  std::string button_places_;  // as they were logged
  Measuring measuring_{[] { Window::wake(); }};
  bool costs_are_old_ = true, wants_costs_ = false;
  Measuring::Work wanted_ = Measuring::Work::none;  // to be begun
  bool is_holding_ = false;                         // the sessions, for a measurement
  Diagnostics errors_;

  int drawings_ = 3;  // still to do, even if no new picture comes
  double last_step_ = 0, last_draw_ = 0, moving_until_ = 0, focus_until_ = 0;
  bool moved_ = false;  // the newest request is one of a movement
  double requested_at_ = 0;
  Message message_;
  bool says_error_ = false, typing_ = false;  // into a field
  Comparison comparison_;
  std::string to_save_;
};

}  // namespace

int open_window(const app::ViewCommand& command) {
  std::expected<Scene, int> scene;
  Diagnostics said;
  if (command.scene.empty()) {
    scene->materials = {Material()};  // nothing, until one is opened
  } else {
    on_threads(command.options.threads,
               [&] { scene = app::load_scene(command.scene, false, &said); });
    if (!scene) return scene.error();
  }
  if (const auto why = option_conflict(command.options, &*scene)) return app::fail(*why);
  const RenderSettings resolved = resolve_options(command.options, *scene);
  ViewState state(command.scene, std::make_shared<const Scene>(std::move(*scene)), command.options);
  const RenderOptions first_request = state.request(resolved.width, resolved.height);
  state.program = command.program;
  std::vector<std::string> warnings;
  for (const Diagnostic& d : said) warnings.push_back(d.text());
  auto session = std::make_unique<Session>(Window::wake);
  session->request({state.scene, first_request});

  Memory memory = recall(memory_file());
  set_language(!command.language.empty() ? language_of(command.language)
               : memory.language         ? *memory.language
                                         : language_of_system());
  const auto window = Window::open(resolved.width, resolved.height, memory.look);
  if (!window) return app::no_resource(window.error());
  Viewer viewer(**window, std::move(state), std::move(memory), std::move(warnings), command.log,
                std::move(session), first_request);
  viewer.run();
  return app::kDone;
}

}  // namespace raio::view
