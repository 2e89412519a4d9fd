#include "view/viewer.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <expected>

#include "app/output.h"
#include "app/terminal.h"
#include "render/provenance.h"
#include "render/render.h"
#include "render/session.h"
#include "view/camera_control.h"
#include "view/comparison.h"
#include "view/files.h"
#include "view/gestures.h"
#include "view/measure.h"
#include "view/panel.h"
#include "view/pictures.h"
#include "view/window.h"

namespace raio::view {
namespace {

constexpr double kFrameSeconds = 0.024;    // of rendering; drawing takes the rest of a 30th
constexpr double kDrawGapSeconds = 0.03;   // between drawings that show no new picture
constexpr double kRestSeconds = 0.15;      // after the last movement
constexpr double kBeforeCosts = 0.8;       // of rest, until costs are measured
constexpr double kFocusSeconds = 2.5;      // that the plane in focus is shown
constexpr double kIdleSeconds = 0.1;       // between looks at the disk
constexpr double kSlowSeconds = 0.8;       // a first sample that takes longer shows its progress
constexpr double kProgressSeconds = 0.25;  // between two drawings of that

std::string text_of(Vec3f v) { return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z); }

class Viewer final : public WindowEvents {
 public:
  /// `session` has got `first_request` already, whose rays need no window.
  Viewer(Window& window, ViewState state, bool logs, std::unique_ptr<Session> session,
         const RenderOptions& first_request)
      : window_(window),
        logs_(logs),
        opened_(float(window.width()), float(window.height())),
        first_width_(first_request.width),
        first_height_(first_request.height),
        state_(std::move(state)),
        file_(state_.path),
        pictures_(std::move(session)),
        gestures_(state_, stage_, [this](double x, double y) { return pick_at(x, y); }) {
    window_.listen(this);
    log("request: 1");
    stage_.picture_width = first_request.width, stage_.picture_height = first_request.height;
    // A screen that is too small for the picture has made the window so.
    const float unit = 1 / window_.pixels_per_unit();
    follows_window_ = opened_.x - window_.panel_width() < std::floor(float(first_width_) * unit) ||
                      opened_.y < std::floor(float(first_height_) * unit);
    lay_out();
    log(fmt::format("place: {},{}", stage_.lo.x, stage_.lo.y));
  }
  ~Viewer() override { window_.listen(nullptr); }

  void run() {
    while (!window_.should_close()) {
      Window::wait_events(drawings_ > 0 ? 0.004 : kIdleSeconds);
      step();
    }
    log("closed");
  }

  void key_pressed(int key, bool shift) override {
    if (gestures_.is_looking() && steps_held().any()) return;
    if (const KeySpec* spec = find_key(key, shift)) obey(*spec);
  }
  void button(int number, bool down, bool shift) override {
    needs_drawing();
    const auto which = number == GLFW_MOUSE_BUTTON_LEFT    ? Gestures::Button::left
                       : number == GLFW_MOUSE_BUTTON_RIGHT ? Gestures::Button::right
                                                           : Gestures::Button::middle;
    if (down)
      gestures_.press(which, shift);
    else if (gestures_.release(which))
      focus_on(pick_at(gestures_.x(), gestures_.y()));
  }
  void cursor_moved(double x, double y) override {
    needs_drawing();
    if (gestures_.move(x, y)) camera_moved();
  }
  void scrolled(double steps, bool ctrl) override {
    needs_drawing();
    if (!stage_.contains(gestures_.x(), gestures_.y())) return;
    if (ctrl || shows_focus()) {
      state_.scale_aperture(float(std::pow(1.1, steps)));
      if (!state_.is_on(Command::depth_of_field)) (void)state_.toggle(Command::depth_of_field);
      focus_until_ = now() + kFocusSeconds;
      say(fmt::format("aperture {:.4g}", state_.options.aperture));
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
  void say(std::string message) {
    log(message);
    message_.say(std::move(message), now());
    needs_drawing();
  }

  bool is_moving() const { return now() < moving_until_; }
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

  // Where things are in the window. The picture has the size that it was opened with until the
  // window gets another, or the panel makes room.
  void lay_out() {
    const ImVec2 window{float(window_.width()), float(window_.height())};
    const float panel = state_.panel ? window_.panel_width() : 0;
    follows_window_ |= panel == 0 || window.x != opened_.x || window.y != opened_.y;
    const RenderOptions& o = state_.options;
    const auto wanted = [&](int given, int first) {
      return given > 0 ? given : follows_window_ ? 0 : first;
    };
    const Stage before = std::exchange(
        stage_, Stage(window, panel, window_.pixels_per_unit(), wanted(o.width, first_width_),
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
    if (const auto why = option_conflict(o, state_.scene.get())) return say(why->text()), false;
    const double frame_s = is_moving() ? kFrameSeconds : 0;
    moved_ = frame_s > 0;
    pictures_.request(state_, stage_, frame_s);
    if (!moved_) log(fmt::format("request: {}", pictures_.main.request));
    measuring_.cancel();
    costs_are_old_ = true;
    renew_other(frame_s);
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
        say(state_.split ? "side by side with the last effect switched" : "one picture");
        return void(renew());
      case Command::pause:
        state_.paused = !state_.paused;
        if (measuring_.work() == Measuring::Work::costs) measuring_.cancel(), costs_are_old_ = true;
        pictures_.pause(state_.paused || measuring_.busy());
        return say(state_.paused ? "paused" : "goes on");
      case Command::panel:
        state_.panel = !state_.panel;
        say(state_.panel ? "panel shown" : "panel hidden; h shows it");
        return lay_out();
      case Command::fit:
        state_.camera = fitted(state_.camera, bounds(*state_.scene), stage_.aspect());
        say("the scene fits");
        return void(renew());
      case Command::home:
        state_.camera = state_.scene->camera;
        moving_until_ = 0;
        say("the scene's own camera");
        return void(renew());
      case Command::save_png:
      case Command::save_exr:
        to_save_ = key.command == Command::save_png ? ".png" : ".exr";
        return save_when_whole();
      case Command::copy: {
        const std::string command = command_line(state_.scene->name + ".png");
        window_.set_clipboard(command);
        log("command: " + command);
        return say("copied: " + command);
      }
      case Command::show_view:
        state_.show(View(key.key - '1'));
        say(fmt::format("view: {}", view_name(state_.options.view)));
        return void(renew());
      case Command::measure:
        return switch_table();
      case Command::quit:
        return window_.close();
    }
  }

  void switch_effect(Command effect) {
    const auto before = pictures_.main.picture;
    const uint64_t request = pictures_.main.request;
    const std::string what = state_.toggle(effect);
    log(what);
    if (renew()) say(comparison_.begin(what, before.get(), request));
  }

  void focus_on(const Pick& pick) {
    if (!pick.hit.found()) return say("nothing there to focus on");
    state_.focus_at(float(pick.depth));
    focus_until_ = now() + kFocusSeconds;
    say(fmt::format("focus on {}, distance {:.6g}", pick.what, state_.options.focus));
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

  // The costs, which are measured unasked, make way for the table.
  void switch_table() {
    if (wants_table_) return wants_table_ = false, say("stopped");
    if (measuring_.work() == Measuring::Work::table) return measuring_.cancel();
    costs_are_old_ |= measuring_.busy();
    measuring_.cancel();
    wants_table_ = true;
    say("measuring all combinations; m stops");
  }

  // Whoever measures wants the machine for themselves: sessions rest, and the window draws in
  // pauses that are left for it.
  void measure() {
    if (measuring_.busy()) return;
    if (!wants_table_ && !may_measure_costs()) {
      if (std::exchange(is_holding_, false)) pictures_.pause(state_.paused);
      return;
    }
    is_holding_ = true;
    pictures_.pause(true);
    if (!pictures_.are_idle()) return;
    if (std::exchange(wants_table_, false)) {
      measuring_.start_table(state_, stage_.picture_width, stage_.picture_height);
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
    return costs_are_old_ && wants_costs_ && !state_.paused && !is_moving() && picture &&
           picture->request == pictures_.main.request && picture->sample_s.median > 0 &&
           now() >= moving_until_ + kBeforeCosts && message_.age(now()) >= kBeforeCosts;
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
    take_results();
    bool is_new = take_picture(pictures_.main);
    is_new |= take_picture(pictures_.other);
    save_when_whole();
    measure();
    if (measuring_.has_news()) drawings_ = std::max(drawings_, 1);
    if (progress_text() && time > last_draw_ + kProgressSeconds) drawings_ = std::max(drawings_, 1);
    if (window_.is_hidden()) {
      drawings_ = 0;
    } else if (is_new || (drawings_ > 0 && (!is_moving() || time > last_draw_ + kDrawGapSeconds))) {
      drawings_ = is_new ? std::max(drawings_, 1) : drawings_;
      draw();
      --drawings_;
    }
  }

  Steps steps_held() const {
    if (Window::is_typing()) return {};
    return walking_steps([this](int key) { return window_.is_held(key); }, gestures_.is_looking());
  }

  bool take_picture(Side& side) {
    if (!side.take()) return false;
    const SessionPicture& p = *side.picture;
    if (p.error) say(p.error->text());
    if (&side == &pictures_.main)
      if (auto line = comparison_.take(p, side.request)) say(std::move(*line));
    return true;
  }

  void take_results() {
    if (auto read = file_.poll(state_.options.threads)) take_scene(*read);
    while (auto written = writer_.poll()) {
      if (!written->result) {
        say(written->result.error().text());
        continue;
      }
      say("saved " + written->path);
      log("command: " + written->command);
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
  std::optional<std::string> progress_text() const {
    const auto progress = pictures_.main.session->progress();
    if (!progress || progress->passed_s + progress->left_s < kSlowSeconds) return std::nullopt;
    return progress_line(*progress);
  }

  void take_scene(const SceneFile::Read& read) {
    if (!read.scene) {
      errors_ = read.scene.error();
      return say(errors_.front().text());
    }
    errors_.clear();
    state_.open(read.path, *read.scene);
    measuring_.forget();
    say("opened " + read.path);
    renew();
  }

  void draw() {
    last_draw_ = now();
    Window::begin_frame();
    pictures_.draw(state_, stage_, float(gestures_.split_at));
    if (state_.panel) draw_panel_and_obey();
    if (const auto line = progress_text()) {
      const float margin = ImGui::GetFontSize();
      draw_label({stage_.area_lo.x + margin, stage_.area_lo.y + margin}, *line, Beside::right);
    }
    draw_message();
    window_.end_frame();
    window_.set_title(state_.title());
    log_picture(pictures_.main, "picture");
    log_picture(pictures_.other, "other");
  }

  void log_picture(Side& side, std::string_view name) {
    if (!logs_) return;
    if (const auto news = side.news()) log(fmt::format("{}: {}", name, *news));
  }

  void draw_message() const {
    const std::string& text =
        message_.text().empty() && !errors_.empty() ? errors_.front().text() : message_.text();
    if (text.empty()) return;
    const float line = ImGui::GetFontSize();
    draw_label({stage_.area_lo.x + line, stage_.area_hi.y - 2 * line}, text, Beside::right);
  }

  CostFacts cost_facts() const {
    return {.picture = pictures_.main.picture,
            .picture_width = stage_.picture_width,
            .picture_height = stage_.picture_height,
            .costs = measuring_.costs(),
            .table = measuring_.table(),
            .measuring = measuring_.work(),
            .progress = measuring_.progress(),
            .are_old = costs_are_old_,
            .waits = progress_text()};
  }

  void draw_panel_and_obey() {
    PanelFacts facts;
    facts.costs = cost_facts();
    facts.errors = errors_;
    const PanelResult result = draw_panel(state_, facts, window_.panel_width());
    wants_costs_ = result.wants_costs;
    for (const KeySpec* key : result.pressed) obey(*key);
    if (!result.problem.empty()) say(result.problem);
    if (!result.changed) return;
    if (result.dragging) moving_until_ = now() + kRestSeconds;
    renew();
  }

  using Other = Pictures::Other;

  Window& window_;
  const bool logs_;
  const ImVec2 opened_;                   // the window's size
  const int first_width_, first_height_;  // the picture's
  bool follows_window_ = false;
  Stage stage_;
  ViewState state_;
  SceneFile file_;
  PictureWriter writer_;
  Pictures pictures_;
  Gestures gestures_;
  Measuring measuring_{[] { Window::wake(); }};
  bool costs_are_old_ = true, wants_costs_ = false, wants_table_ = false;
  bool is_holding_ = false;  // the sessions, for a measurement
  Diagnostics errors_;

  int drawings_ = 3;  // still to do, even if no new picture comes
  double last_step_ = 0, last_draw_ = 0, moving_until_ = 0, focus_until_ = 0;
  bool moved_ = false;  // the newest request is one of a movement
  Message message_;
  Comparison comparison_;
  std::string to_save_;
};

}  // namespace

int open_window(const app::ViewCommand& command) {
  std::expected<Scene, int> scene;
  on_threads(command.options.threads, [&] { scene = app::load_scene(command.scene); });
  if (!scene) return scene.error();
  if (const auto why = option_conflict(command.options, &*scene)) return app::fail(*why);
  const RenderSettings resolved = resolve_options(command.options, *scene);
  ViewState state(command.scene, std::make_shared<const Scene>(std::move(*scene)), command.options);
  const RenderOptions first_request = state.request(resolved.width, resolved.height);
  auto session = std::make_unique<Session>(Window::wake);
  session->request({state.scene, first_request});

  const auto window = Window::open(resolved.width, resolved.height);
  if (!window) return app::no_resource(window.error());
  Viewer viewer(**window, std::move(state), command.log, std::move(session), first_request);
  viewer.run();
  return app::kDone;
}

}  // namespace raio::view
