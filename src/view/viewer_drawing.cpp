// The window's contents: the picture, its overlays, and the controls around it.
#include <imgui.h>

#include <cmath>
#include <filesystem>

#include "view/texts.h"
#include "view/theme.h"
#include "view/viewer.h"

namespace raio::core::view {
namespace {

constexpr double kSlowSeconds = 0.8;  // a slower first sample shows its progress

}  // namespace

void Viewer::lay_out() {
  const float width = float(window_.width()), height = float(window_.height());
  layout_ = Layout(width, height, em(), state_.panel && !state_.path.empty());
  const float unit = 1 / window_.pixels_per_unit();
  const bool follows = !state_.panel || width != opened_.right || height != opened_.bottom ||
                       layout_.picture.width() < std::floor(float(first_width_) * unit) ||
                       layout_.picture.height() < std::floor(float(first_height_) * unit);
  const RenderOptions& o = state_.options;
  const auto wanted = [&](int given, int first) { return given > 0 ? given : follows ? 0 : first; };
  const Stage before =
      std::exchange(stage_, Stage(layout_.picture, window_.pixels_per_unit(),
                                  wanted(o.width, first_width_), wanted(o.height, first_height_)));
  if (stage_.picture_width == before.picture_width &&
      stage_.picture_height == before.picture_height)
    return;
  log(fmt::format("size: {}x{}", stage_.picture_width, stage_.picture_height));
  renew();
}

bool Viewer::is_covered() const {
  return state_.path.empty() || (controls_.has_dialog() && Window::is_over_controls());
}

Pick Viewer::pick_at(double x, double y) const {
  const auto& picture = pictures_.main.picture;
  if (!picture || !picture->baked || picture->baked->scene != state_.scene) return {};
  return pick(*picture->baked->accel, state_.edge_to_edge(stage_.picture_height), stage_.across(x),
              stage_.down(y), stage_.aspect());
}

ReadOut Viewer::under_cursor() const {
  if (is_covered() || gestures_.is_busy() || is_waiting() || is_moving()) return {};
  const double x = gestures_.x(), y = gestures_.y();
  return read_out(state_, *pictures_.main.picture, stage_.across(x), stage_.down(y), pick_at(x, y));
}

void Viewer::draw() {
  last_draw_ = now();
  window_.begin_frame();
  lay_out();
  if (!state_.path.empty()) pictures_.draw(state_, stage_, float(gestures_.split_at));
  const ReadOut under = under_cursor();
  overlay_.draw(layout_.picture, state_, baked(), stage_);
  draw_inspector();
  ViewState shown = state_;
  if (shows_focus()) shown.show(View::focus);
  const bool is_of_boxes = overlay_.facts().all > 0;
  ControlFacts facts = control_facts(under.text);
  facts.legend = draw_legend(layout_.picture, is_of_boxes ? overlay_.legend() : legend_of(shown),
                             is_of_boxes ? std::nullopt : under.at);
  take_controls(controls_.draw(state_, layout_, facts));
  window_.end_frame();
  if (wants_letters()) needs_drawing();
  window_.set_title(state_.path.empty() ? "Raio" : state_.title());
  keeper_.looks(window_.look(), language());
  if (std::exchange(typing_, Window::is_typing()) != typing_) log(typing_ ? "types" : "typed");
  log_picture(pictures_.main, "picture");
  log_picture(pictures_.other, "other");
}

void Viewer::draw_inspector() {
  inspector_.draw_rays(layout_.picture, state_.edge_to_edge(stage_.picture_height), stage_);
  if (gestures_.is_selecting())
    ImGui::GetBackgroundDrawList()->AddRect({float(gestures_.from_x()), float(gestures_.from_y())},
                                            {float(gestures_.x()), float(gestures_.y())},
                                            color(palette().accent), 0, 0, 2);
  if (!inspector_.is_open() || !state_.panel) return;
  take_inspector(inspector_.draw_panel(layout_.panel, now()));
  if (std::string places = inspector_.places(); logs_ && places != button_places_) {
    button_places_ = places;
    log("buttons:" + places);
  }
}

void Viewer::take_inspector(const InspectorResult& did) {
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
  writer_.write(inspector_.drawing(did.save, state_.edge_to_edge(stage_.picture_height)), path,
                inspector_.command_line(state_));
}

void Viewer::take_controls(const ControlResult& result) {
  wants_costs_ = result.wants_costs;
  if (result.open) file_.open(short_path(*result.open));
  if (result.save) save_scene(*result.save);
  if (result.saves_curve)
    writer_.write([csv = grid_curve_csv(measuring_.curve())] { return csv; },
                  free_name(state_.scene->name + "-grid", ".csv"), "");
  for (const KeySpec* key : result.pressed) obey(*key);
  if (!result.problem.empty()) complain(result.problem);
  if (!result.changed) return;
  if (result.dragging) return camera_moved();
  renew();
}

std::optional<SessionProgress> Viewer::progress() const {
  const auto progress = pictures_.main.session->progress();
  if (!progress || progress->passed_s + progress->left_s < kSlowSeconds) return std::nullopt;
  return progress;
}

CostFacts Viewer::cost_facts() const {
  return {
      .picture = pictures_.main.picture,
      .picture_width = stage_.picture_width,
      .picture_height = stage_.picture_height,
      .costs = measuring_.costs(),
      .table = measuring_.table(),
      .curve = measuring_.curve(),
      .is_curve_old = !measuring_.is_curve_of(state_, stage_.picture_width, stage_.picture_height),
      .measuring = measuring_.work(),
      .progress = measuring_.progress(),
      .are_old = costs_are_old_,
      .waits = progress().transform(progress_line)};
}

ControlFacts Viewer::control_facts(const std::string& under) const {
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
  // An error in the file stays until it is fixed.
  const bool stays = message_.text().empty() && !errors_.empty();
  facts.message = stays ? errors_.front().text() : message_.text();
  facts.is_error = stays || says_error_;
  return facts;
}

void Viewer::log_picture(Side& side, std::string_view name) {
  if (!logs_) return;
  if (const auto news = side.news()) log(fmt::format("{}: {}", name, *news));
}

}  // namespace raio::core::view
