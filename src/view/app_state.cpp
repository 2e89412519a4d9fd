#include "view/app_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/exact_math.h"
#include "io/atoms/labels.h"
#include "render/render.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr double kFrameSeconds = 0.038;   // of rendering; drawing takes the rest of a 20th
constexpr double kDrawGapSeconds = 0.03;  // between drawings without a new picture
constexpr double kRestSeconds = 0.15;     // after the last movement
constexpr double kBeforeCosts = 0.8;      // of rest, before costs are measured
constexpr double kFocusSeconds = 2.5;     // for showing the focal plane
constexpr double kWaitingSeconds = 0.5;   // between drawings while nothing new arrives

std::string text_of(Vec3f v) { return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z); }

// Whether these options give the same atoms.
bool same_but_colors(ReadOptions a, const ReadOptions& b) {
  a.color_by = b.color_by, a.colormap = b.colormap, a.color_range = b.color_range;
  a.color_atoms = b.color_atoms;
  return a == b;
}

}  // namespace

AppState::AppState(ViewState first_view, const RenderOptions& first, const Theme& first_look,
                   std::vector<std::string> warnings_of_file)
    : view(std::move(first_view)),
      history(view),
      saved_scene(view.scene),
      look(first_look),
      gestures(view, stage, [this](double x, double y) { return pick_at(x, y); }),
      warnings(std::move(warnings_of_file)) {
  stage.picture_width = first.width, stage.picture_height = first.height;
  if (view.compared) other = Other::compared;
}

Requests AppState::update(const Event& event, const Facts& facts) {
  facts_ = facts;
  std::visit([this](const auto& e) { on(e); }, event);
  return std::exchange(requests_, {});
}

bool AppState::is_waiting() const {
  return !is_moving() && (!picture || picture->request != request || picture->samples == 0);
}

bool AppState::is_covered() const {
  return view.path.empty() ||
         (facts_.over_controls && (facts_.has_dialog || covers_ || shows_lesson));
}

Pick AppState::pick_at(double x, double y) const {
  if (!baked() || baked()->scene != view.scene) return {};
  return pick(*baked()->accel, shown_camera(), stage.across(x), stage.down(y), stage.aspect(),
              view.file.get());
}

ReadOut AppState::under_cursor() const {
  if (is_covered() || gestures.is_busy() || is_waiting() || is_moving()) return {};
  const double x = stage.across(gestures.x()), y = stage.down(gestures.y());
  ReadOut out = read_out(view, *picture, x, y, pick_at(gestures.x(), gestures.y()));
  if (!view.compared || out.text.empty() || !picture->image) return out;
  const auto bytes_at = [&](const Image& image) {
    const auto c = display_bytes(image.at(int(x * image.width), int(y * image.height)));
    return fmt::format("{} {} {}", c[0], c[1], c[2]);
  };
  out.text += fmt::format(" \xc2\xb7 A {}, B {}", bytes_at(*picture->image),
                          bytes_at(view.compared->image));
  return out;
}

std::string AppState::measured() const {
  return selection.measure(view.file ? view.file->unit : "");
}

SelectionFacts AppState::selection_facts() const {
  if (selection.empty()) return {};
  SelectionFacts facts;
  facts.lines = selection.lines(*view.scene, view.box);
  if (const std::string measure = measured(); !measure.empty()) facts.lines.push_back(measure);
  const Pick& pick = selection.picks().back();
  facts.can_focus = !view.camera.is_parallel();
  facts.material = pick.material;
  facts.is_atom = pick.atom && view.file && view.file->atoms;
  facts.has_residue = facts.is_atom && view.file->atoms->residue(*pick.atom);
  facts.has_chain = facts.is_atom && view.file->atoms->chain(*pick.atom);
  return facts;
}

std::string AppState::command_line(const std::string& output) const {
  return view.command_line(stage.picture_width, stage.picture_height,
                           picture ? std::max(1, picture->samples) : 1, output);
}

void AppState::say(std::string text, bool is_error) {
  log(text);
  says_error = is_error;
  message.say(std::move(text), facts_.now);
  refresh();
}

bool AppState::renew() {
  const RenderOptions o = view.request(stage.picture_width, stage.picture_height);
  comparison_.end();
  if (const auto why = option_conflict(o, view.scene.get()))
    return complain(why->text("--")), false;
  // Options waiting for another scene or integrator are reported once.
  RenderOptions as_picture = view.options;
  as_picture.view = View::picture;
  const auto waiting = ignored_option(as_picture, view.scene.get());
  const std::string option = waiting ? waiting->subject : "";
  if (std::exchange(waiting_option_, option) != option && waiting) say(waiting->text("--"));
  const double frame_s = is_moving() ? kFrameSeconds : 0;
  moved_ = frame_s > 0;
  ask(request::Render{{view.scene, o, frame_s}});
  ++request;
  requested_at = facts_.now;
  if (!moved_) log(fmt::format("request: {}", request));
  cancel_measuring();
  costs_are_old = true;
  renew_other(frame_s);
  if (!moved_) ask(request::FollowInspection{});
  return true;
}

void AppState::renew_other(double frame_s) {
  using enum Other;
  const Other of_picture = !view.compared          ? view.split ? without : none
                           : view.shows_difference ? difference
                                                   : compared;
  const Other wanted = shows_focus() ? focus : of_picture;
  const bool is_new = std::exchange(other, wanted) != wanted;
  if (wanted != focus && wanted != without) return ask(request::RenderOther{});
  ViewState shown = view;
  if (wanted == focus) shown.show(View::focus);
  const int width = stage.picture_width, height = stage.picture_height;
  const RenderOptions o =
      wanted == focus ? shown.request(width, height) : shown.other_request(width, height);
  if (option_conflict(o, view.scene.get())) return;
  ask(request::RenderOther{SessionRequest{view.scene, o, frame_s}, is_new});
}

void AppState::camera_moved() {
  moving_until_ = facts_.now + kRestSeconds;
  renew();
}

void AppState::settle() {
  if (!is_moving() && !gestures.is_busy() && !facts_.control_held && !is_reading() &&
      !view.form.plays && history.settle(view))
    limit_history();
}

void AppState::show_focus() { focus_until_ = facts_.now + kFocusSeconds; }

void AppState::on(const event::KeyPressed& e) {
  if (gestures.is_looking() && facts_.walking.any()) return;
  const KeySpec* const spec = find_key(e.key, e.held);
  if (!spec) return;
  // Behind a dialog nothing changes; Escape leaves a field before it ends anything but dialogs.
  const bool is_escape = spec->command == Command::quit && e.key != 'Q';
  if (facts_.has_dialog && !is_escape && spec->command != Command::help) return;
  const bool closes = facts_.has_dialog || facts_.inspects || facts_.picks;
  if (facts_.types && is_escape && !closes) return;
  settle();  // the keys of one poll are separate steps of the history
  obey(*spec);
}

void AppState::on(const event::MouseButton& e) {
  refresh();
  const auto which = Gestures::Button(e.number);
  if (which > Gestures::Button::middle || (e.down && is_covered())) return;
  if (e.down)
    gestures.press(which, e.shift, facts_.inspects || facts_.picks);
  else
    finish(gestures.release(which), e.ctrl);
}

void AppState::on(const event::CursorMoved& e) {
  refresh();
  if (gestures.move(e.x, e.y)) camera_moved();
}

void AppState::on(const event::Scrolled& e) {
  refresh();
  if (is_covered() || !stage.contains(gestures.x(), gestures.y())) return;
  if ((e.ctrl || focuses) && !view.camera.is_parallel()) {
    view.scale_aperture(float(exact_pow(1.1, e.steps)));
    if (!view.is_on(Command::depth_of_field)) (void)view.toggle(Command::depth_of_field);
    show_focus();
    say(trf("aperture {:.4g}", view.options.aperture));
    renew();
  } else if (gestures.dolly(e.steps)) {
    camera_moved();
  }
}

void AppState::on(const event::Resized& e) {
  size_ = e;
  const bool wants_panel = !view.path.empty() && (is_narrow() ? covers_ : view.panel);
  layout = Layout(e.width, e.height, e.em, wants_panel, shows_lesson);
  const auto [width, height] = view.picture_size();
  const bool grows = view.grows || view.compared;
  const Stage before =
      std::exchange(stage, Stage(layout.picture, e.pixels_per_unit, width, height, grows));
  if (stage.picture_width == before.picture_width && stage.picture_height == before.picture_height)
    return;
  log(fmt::format("size: {}x{}", stage.picture_width, stage.picture_height));
  renew();
}

void AppState::on(const event::ControlsUsed& e) {
  const ControlResult& did = e.did;
  const bool other_costs = e.view.costs_of != view.costs_of;
  view = e.view;
  wants_costs_ = did.wants_costs;
  const bool measures_costs = measuring == Measuring::Work::costs;
  if (other_costs || (measures_costs && !wants_costs_)) {
    if (measures_costs) cancel_measuring();
    costs_are_old = true;
  }
  if (did.open) open(short_path(*did.open));
  if (did.compare) ask(request::CompareWith{short_path(*did.compare)});
  if (did.save) save_scene(*did.save);
  if (did.saves_curve) ask(request::WriteCurve{});
  use_figure_panel(did.figure);
  use_lesson(did.lesson);
  for (const KeySpec* key : did.pressed) obey(*key);
  use_selection(did.selection);
  if (!did.problem.empty()) complain(did.problem);
  if (!did.changed) return;
  if (did.dragging) return camera_moved();
  renew();
}

void AppState::on(const event::InspectorUsed& e) {
  if (e.did.closed) close_inspector();
  if (e.did.camera) move_camera(*e.did.camera);
  if (e.did.copied) {
    ask(request::CopyText{e.command});
    say(trf("copied: {}", e.command));
  }
  if (!e.did.save.empty()) ask(request::WriteDrawing{e.did.save});
}

void AppState::on(const event::PictureTaken& e) {
  has_new_picture_ = true;
  if (e.picture->error) complain(e.picture->error->text("--"));
  if (!e.is_main) return;
  picture = e.picture;
  if (auto line = comparison_.take(*picture, request)) say(std::move(*line));
  if (wanted_rays_ && picture->request == request && picture->samples > 0)
    inspect(*std::exchange(wanted_rays_, {}));
}

void AppState::on(const event::Inspected& e) {
  e.found ? log(*e.found) : complain(e.found.error().text("--"));
  refresh();
}

void AppState::on(const event::Measured& e) {
  measuring = Measuring::Work::none;
  refresh();
  if (!e.said.empty()) return say(e.said);
  for (const EffectCost& c : e.costs.effects) log(cost_line(c));
  log(e.costs.finished ? "measured the costs" : "did not measure the costs");
}

void AppState::on(const SceneFile::Read& read) {
  if (!is_wanted(read)) return;
  if (!read.scene && read.is_reread) return refuse_reading(read);
  if (!read.scene) {
    wanted_show_.reset();
    // For another file they are reported once; the panel shows those of the current file.
    if (read.path == view.path) errors = read.scene.error();
    return complain(read.scene.error().front().text());
  }
  settle();
  errors.clear();
  const bool is_other = read.path != view.path;
  if (is_other || read.options == read_options()) {
    wanted_read_.reset();
    view.form.option.clear();
  }
  if (is_other) view.form.plays = false;
  const bool keeps_atoms =
      read.is_reread && selection.is_of_atoms() && same_but_colors(view.read_options, read.options);
  view.open(read.path, *read.scene, read.options, read.file);
  if (!keeps_atoms) selection.clear();
  ask(request::ForgetMeasurements{});
  warnings = Warnings(read.warnings);
  // A new version of the file, or other options, are a step that can be undone; another scene is a
  // new start.
  if (is_other) {
    ask(request::CloseInspector{});
    if (view.compared) stop_comparing();
    history = History<ViewState>(view);
  }
  saved_scene = view.scene;
  if (!read.is_reread) {
    ++file_version_;
    ask(request::FollowFile{read.path});
    say(trf("opened {}", read.path));
  }
  view.file_version = file_version_;
  if (wanted_show_ && read.path == wanted_show_->scene)
    take_shown(*std::exchange(wanted_show_, {}));
  renew();
}

void AppState::on(const ComparedFile::Read& read) {
  if (!read.picture) return complain(read.picture.error().text());
  view.compared = *read.picture;
  say(tr("A is Raio's picture, B the other; a click shows the rays of a pixel"));
  renew_other(0);
}

void AppState::on(const SceneWriter::Written& written) {
  is_saving_ = false;
  if (!written.result) return complain(written.result.error().text("--"));
  settle();
  take_saved(view, written);
  wanted_read_.reset(), view.form.plays = false;
  ++file_version_;
  errors.clear();
  saved_scene = written.scene;
  ask(request::FollowFile{written.path, true});
  say(trf("saved the scene as {}", written.path) +
      (written.result->empty() ? "" : "; " + trf("lost: {}", *written.result)));
  renew();
}

void AppState::on(const event::Printed& e) {
  is_printing_ = false;
  const auto& result = e.written.result;
  if (!result && result.error().kind == ErrorKind::stopped) return say(tr("stopped"));
  on(e.written);
}

void AppState::on(const PictureWriter::Written& written) {
  if (!written.result) return complain(written.result.error().text());
  const std::filesystem::path path = std::filesystem::absolute(written.path);
  say(trf("saved {} in {}", path.filename().string(), path.parent_path().string()));
  log("command: " + written.command);
}

void AppState::on(const event::Tick&) {
  const double now = facts_.now, passed = now - std::exchange(last_tick_, now);
  if (gestures.walk(facts_.walking, passed)) camera_moved();
  if (moved_ && !is_moving()) {
    log(fmt::format("camera: from {} at {}", text_of(view.camera.from), text_of(view.camera.at)));
    renew();
  }
  if (other == Other::focus && !shows_focus()) renew_other(0), refresh();
  if (message.expire(now)) refresh();
  play();
  settle();
  // Time passes while waiting for the first sample.
  if ((is_waiting() || is_reading()) && now > last_draw_ + kWaitingSeconds) refresh();
  save_when_whole();
  if (!is_moving() && !is_waiting() && warnings.find(*view.scene, *picture)) refresh();
  measure();
  draw();
}

void AppState::draw() {
  const bool is_new = std::exchange(has_new_picture_, false);
  if (facts_.hidden) drawings = 0;
  if (is_new && !facts_.hidden) drawings = std::max(drawings, 1);
  const bool may_draw = is_new || !is_moving() || facts_.now > last_draw_ + kDrawGapSeconds;
  if (drawings == 0 || !may_draw) return;
  --drawings;
  last_draw_ = facts_.now;
  ask(request::Draw{});
}

void AppState::measure() {
  using enum Measuring::Work;
  if (measuring != none) return;
  if (wanted_ == none && !may_measure_costs()) return;
  measuring = wanted_ == none ? costs : std::exchange(wanted_, none);
  if (measuring == costs) {
    costs_are_old = false;
    log("measures the costs");
  }
  ask(request::Measure{measuring});
}

bool AppState::may_measure_costs() const {
  return !view.path.empty() && costs_are_old && wants_costs_ && !view.paused && !is_moving() &&
         picture && picture->request == request && picture->sample_s.median > 0 &&
         facts_.now >= moving_until_ + kBeforeCosts && message.age(facts_.now) >= kBeforeCosts;
}

void AppState::cancel_measuring() {
  if (measuring != Measuring::Work::none) ask(request::Measure{});
}

void AppState::save_when_whole() {
  const bool is_whole = picture && picture->request == request && picture->samples > 0 &&
                        (view.endless() || picture->finished);
  if (is_whole && !to_save_.empty())
    ask(request::WritePicture{picture, std::exchange(to_save_, {})});
}

}  // namespace raio::core::view
