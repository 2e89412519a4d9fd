#include "view/viewer.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/output.h"
#include "base/exact_math.h"
#include "render/provenance.h"
#include "render/render.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr double kFrameSeconds = 0.024;   // of rendering; drawing takes the rest of a 30th
constexpr double kDrawGapSeconds = 0.03;  // between drawings without a new picture
constexpr double kRestSeconds = 0.15;     // after the last movement
constexpr double kBeforeCosts = 0.8;      // of rest, before costs are measured
constexpr double kFocusSeconds = 2.5;     // for showing the focal plane
constexpr double kWaitingSeconds = 0.5;   // between drawings while nothing new arrives
constexpr double kIdleSeconds = 0.1;      // between checks of the disk

std::string text_of(Vec3f v) { return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z); }

}  // namespace

Viewer::Viewer(Window& window, ViewState state, Memory memory, std::vector<std::string> warnings,
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
      file_(state_.path, state_.read_options),
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

void Viewer::run() {
  while (!window_.should_close()) {
    Window::wait_events(drawings_ > 0 || inspector_.is_playing() ? 0.004 : kIdleSeconds);
    step();
  }
  log("closed");
}

void Viewer::key_pressed(int key, Modifiers held) {
  if (gestures_.is_looking() && steps_held().any()) return;
  if (const KeySpec* spec = find_key(key, held)) obey(*spec);
}

void Viewer::button(int number, bool down, bool shift) {
  needs_drawing();
  if (number > GLFW_MOUSE_BUTTON_MIDDLE) return;
  const auto which = Gestures::Button(number);
  if (down && is_covered()) return;
  if (down)
    gestures_.press(which, shift, inspector_.is_open() || inspector_.is_picking());
  else
    finish(gestures_.release(which));
}

void Viewer::cursor_moved(double x, double y) {
  needs_drawing();
  if (gestures_.move(x, y)) camera_moved();
}

void Viewer::scrolled(double steps, bool ctrl) {
  needs_drawing();
  if (is_covered() || !stage_.contains(gestures_.x(), gestures_.y())) return;
  if ((ctrl || shows_focus()) && !state_.camera.is_parallel()) {
    state_.scale_aperture(float(exact_pow(1.1, steps)));
    if (!state_.is_on(Command::depth_of_field)) (void)state_.toggle(Command::depth_of_field);
    show_focus();
    say(trf("aperture {:.4g}", state_.options.aperture));
    renew();
  } else if (gestures_.dolly(steps)) {
    camera_moved();
  }
}

void Viewer::log(std::string_view event) const {
  if (logs_) app::print_line(fmt::format("{:.1f} {}", now() * 1e3, event));
}

void Viewer::say(std::string message, bool is_error) {
  log(message);
  says_error_ = is_error;
  message_.say(std::move(message), now());
  needs_drawing();
}

std::shared_ptr<const BakedScene> Viewer::baked() const {
  return pictures_.main.picture ? pictures_.main.picture->baked : nullptr;
}

void Viewer::show_focus() { focus_until_ = now() + kFocusSeconds; }

bool Viewer::is_waiting() const {
  const auto& p = pictures_.main.picture;
  return !is_moving() && (!p || p->request != pictures_.main.request || p->samples == 0);
}

Steps Viewer::steps_held() const {
  if (Window::is_typing()) return {};
  return walking_steps([this](int key) { return window_.is_held(key); }, gestures_.is_looking());
}

bool Viewer::renew() {
  const RenderOptions o = state_.request(stage_.picture_width, stage_.picture_height);
  comparison_.end();
  if (const auto why = option_conflict(o, state_.scene.get()))
    return complain(why->text("--")), false;
  // Options waiting for another scene or integrator are reported once.
  RenderOptions picture = state_.options;
  picture.view = View::picture;
  const auto waiting = ignored_option(picture, state_.scene.get());
  const std::string option = waiting ? waiting->subject : "";
  if (std::exchange(waiting_option_, option) != option && waiting) say(waiting->text("--"));
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

void Viewer::renew_other(double frame_s) {
  const Pictures::Other wanted = shows_focus()  ? Pictures::Other::focus
                                 : state_.split ? Pictures::Other::without
                                                : Pictures::Other::none;
  pictures_.request_other(wanted, state_, stage_, frame_s);
}

void Viewer::camera_moved() {
  moving_until_ = now() + kRestSeconds;
  renew();
}

void Viewer::step() {
  const double time = now(), passed = time - std::exchange(last_step_, time);
  if (gestures_.walk(steps_held(), passed)) camera_moved();
  lay_out();
  if (moved_ && !is_moving()) {
    log(fmt::format("camera: from {} at {}", text_of(state_.camera.from),
                    text_of(state_.camera.at)));
    renew();
  }
  if (pictures_.wanted_other() == Pictures::Other::focus && !shows_focus())
    renew_other(0), needs_drawing();
  if (message_.expire(time)) needs_drawing();
  if (!is_moving() && !gestures_.is_busy() && !Window::is_busy()) history_.settle(state_);
  // Time passes while waiting for the first sample.
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

void Viewer::take_results() {
  if (const auto written = scene_writer_.poll()) take_saved_scene(*written);
  // A file being saved is no change on the disk.
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

void Viewer::log_costs() const {
  for (const EffectCost& c : measuring_.costs().effects) log(cost_line(c));
  log(measuring_.costs().finished ? "measured the costs" : "did not measure the costs");
}

bool Viewer::take_picture(Side& side) {
  if (!side.take()) return false;
  const SessionPicture& p = *side.picture;
  if (p.error) complain(p.error->text("--"));
  if (&side == &pictures_.main)
    if (auto line = comparison_.take(p, side.request)) say(std::move(*line));
  return true;
}

void Viewer::take_scene(const SceneFile::Read& read) {
  if (!read.scene) {
    // For another file they are reported once; the panel shows those of the current file.
    if (read.path == state_.path) errors_ = read.scene.error();
    return complain(read.scene.error().front().text());
  }
  errors_.clear();
  const bool is_other = read.path != state_.path;
  state_.open(read.path, *read.scene);
  measuring_.forget();
  warnings_ = Warnings(read.warnings);
  // A new version of the file is a step that can be undone; another scene is a new start.
  if (is_other) {
    inspector_.close();
    state_.read_options = kForPictures;
    history_ = History<ViewState>(state_);
  }
  saved_scene_ = state_.scene;
  keeper_.opened(read.path);
  say(trf("opened {}", read.path));
  renew();
}

void Viewer::take_saved_scene(const SceneWriter::Written& written) {
  if (!written.result) return complain(written.result.error().text("--"));
  take_saved(state_, written);
  errors_.clear();
  saved_scene_ = written.scene;
  file_.follow(state_.path);
  keeper_.opened(written.path);
  say(trf("saved the scene as {}", written.path) +
      (written.result->empty() ? "" : "; " + trf("lost: {}", *written.result)));
  renew();
}

void Viewer::find_warnings() {
  if (is_moving() || is_waiting()) return;
  if (warnings_.find(*state_.scene, *pictures_.main.picture)) needs_drawing();
}

void Viewer::measure() {
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

bool Viewer::may_measure_costs() const {
  const auto& picture = pictures_.main.picture;
  return !state_.path.empty() && costs_are_old_ && wants_costs_ && !state_.paused && !is_moving() &&
         picture && picture->request == pictures_.main.request && picture->sample_s.median > 0 &&
         now() >= moving_until_ + kBeforeCosts && message_.age(now()) >= kBeforeCosts;
}

void Viewer::save_when_whole() {
  if (to_save_.empty()) return;
  const auto picture = pictures_.whole(state_);
  if (!picture) return;
  const std::string path = free_name(state_.scene->name, std::exchange(to_save_, {}));
  const RenderSettings s = resolve_options(
      state_.request(stage_.picture_width, stage_.picture_height, picture->samples), *state_.scene);
  writer_.write(picture->image, path, settings_of(*state_.scene, s, state_.read_options),
                command_line(path));
}

}  // namespace raio::core::view
