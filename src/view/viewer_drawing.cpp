// The window's contents: the picture, its overlays, and the controls around it.
#include <imgui.h>

#include <utility>

#include "view/texts.h"
#include "view/theme.h"
#include "view/viewer.h"

namespace raio::core::view {
namespace {

constexpr double kSlowSeconds = 0.8;  // a slower first sample shows its progress

}  // namespace

void Viewer::draw() {
  window_.begin_frame();
  handle(size());
  const Rect& area = app_.layout.picture;
  if (!app_.view.path.empty())
    pictures_.draw(app_.view, app_.stage, app_.other, float(app_.gestures.split_at));
  const ReadOut under = app_.under_cursor();
  overlay_.draw(area, app_.view, app_.baked(), app_.stage);
  draw_inspector();
  ViewState shown = app_.view;
  if (app_.shows_focus()) shown.show(View::focus);
  const bool is_of_boxes = overlay_.facts().all > 0;
  ControlFacts facts = control_facts(under.text);
  facts.legend = draw_legend(area, is_of_boxes ? overlay_.legend() : legend_of(shown),
                             is_of_boxes ? std::nullopt : under.at);
  event::ControlsUsed used{app_.view, {}};
  used.did = controls_.draw(used.view, app_.layout, facts);
  handle(used);
  window_.end_frame();
  if (wants_letters()) handle(event::Refresh{});
  window_.set_title(app_.view.path.empty() ? "Raio" : app_.view.title());
  keeper_.looks(app_.look, language());
  if (std::exchange(typing_, Window::is_typing()) != typing_) log(typing_ ? "types" : "typed");
  if (!logs_) return;
  if (const auto news = pictures_.main.news()) log("picture: " + *news);
  if (const auto news = pictures_.other.news()) log("other: " + *news);
}

void Viewer::draw_inspector() {
  const Gestures& hand = app_.gestures;
  inspector_.draw_rays(app_.layout.picture, app_.view.edge_to_edge(app_.stage.picture_height),
                       app_.stage);
  if (hand.is_selecting())
    ImGui::GetBackgroundDrawList()->AddRect({float(hand.from_x()), float(hand.from_y())},
                                            {float(hand.x()), float(hand.y())},
                                            color(palette().accent), 0, 0, 2);
  if (!inspector_.is_open() || !app_.view.panel) return;
  const InspectorResult did = inspector_.draw_panel(app_.layout.panel, Window::seconds());
  handle(event::InspectorUsed{did, did.copied ? inspector_.command_line(app_.view) : ""});
  if (did.copied_text) window_.set_clipboard(inspector_.explanation());
  if (std::string places = inspector_.places(); logs_ && places != button_places_) {
    button_places_ = places;
    log("buttons:" + places);
  }
}

std::optional<SessionProgress> Viewer::progress() const {
  const auto progress = pictures_.main.session->progress();
  if (!progress || progress->passed_s + progress->left_s < kSlowSeconds) return std::nullopt;
  return progress;
}

CostFacts Viewer::cost_facts() const {
  const int width = app_.stage.picture_width, height = app_.stage.picture_height;
  return {.picture = app_.picture,
          .picture_width = width,
          .picture_height = height,
          .costs = measuring_.costs(),
          .table = measuring_.table(),
          .curve = measuring_.curve(),
          .is_curve_old = !measuring_.is_curve_of(app_.view, width, height),
          .measuring = app_.measuring,
          .progress = measuring_.progress(),
          .are_old = app_.costs_are_old,
          .waits = progress().transform(progress_line)};
}

ControlFacts Viewer::control_facts(const std::string& under) const {
  ControlFacts facts;
  facts.panel = {cost_facts(), app_.errors, app_.warnings.lines(), app_.look, overlay_.facts()};
  facts.tools = {app_.history.can_undo(), app_.history.can_redo(), window_.is_full_screen(),
                 inspector_.is_open() || inspector_.is_picking()};
  facts.status = {.picture = app_.picture.get(),
                  .request = app_.request,
                  .since_request_s = Window::seconds() - app_.requested_at,
                  .progress = progress(),
                  .picture_width = app_.stage.picture_width,
                  .picture_height = app_.stage.picture_height,
                  .moving = app_.is_moving(),
                  .paused = app_.view.paused,
                  .measuring = app_.measuring};
  facts.has_inspector = inspector_.is_open();
  facts.read_out = under;
  if (app_.view.path.empty()) facts.welcome = {keeper_.memory().recent, samples_, &cards_};
  // An error in the file stays until it is fixed.
  const bool stays = app_.message.text().empty() && !app_.errors.empty();
  facts.message = stays ? app_.errors.front().text() : app_.message.text();
  facts.is_error = stays || app_.says_error;
  return facts;
}

}  // namespace raio::core::view
