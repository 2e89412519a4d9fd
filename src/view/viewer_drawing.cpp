// The window's contents: the picture, its overlays, and the controls around it.
#include <imgui.h>

#include <utility>

#include "view/projection.h"
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
  draw_selection();
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
  inspector_.draw_rays(app_.layout.picture, app_.shown_camera(), app_.stage);
  if (hand.is_selecting())
    ImGui::GetBackgroundDrawList()->AddRect({float(hand.from_x()), float(hand.from_y())},
                                            {float(hand.x()), float(hand.y())},
                                            color(palette().accent), 0, 0, 2);
  if (!inspector_.is_open() || !app_.has_panel()) return;
  const InspectorResult did = inspector_.draw_panel(app_.layout.panel, Window::seconds());
  handle(event::InspectorUsed{did, did.copied ? inspector_.command_line(app_.view) : ""});
  if (did.copied_text) window_.set_clipboard(inspector_.explanation());
  if (std::string places = inspector_.places(); logs_ && places != button_places_) {
    button_places_ = places;
    log("buttons:" + places);
  }
}

// Marks the picked points, with lines between them and what they measure.
void Viewer::draw_selection() const {
  if (app_.selection.empty() || app_.is_waiting()) return;
  const Rect& area = app_.layout.picture;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect({area.left, area.top}, {area.right, area.bottom}, true);
  const Projection projection(app_.shown_camera(), app_.stage);
  const auto& picks = app_.selection.picks();
  const ImU32 ink = color(palette().accent);
  const float radius = 0.4f * em();
  for (size_t i = 0; i < picks.size(); ++i) {
    if (i > 0)
      if (const auto line = projection.segment(picks[i - 1].place, picks[i].place))
        draw.AddLine((*line)[0], (*line)[1], ink, 2);
    if (const auto at = projection.point(picks[i].place)) draw.AddCircle(*at, radius, ink, 0, 2);
  }
  const std::string measure = app_.measured();
  const size_t middle = (picks.size() - 1) / 2;
  const Vec3d place = picks.size() == 3
                          ? picks[1].place
                          : (picks[middle].place + picks[picks.size() / 2].place) * 0.5;
  if (const auto at = projection.point(place); at && !measure.empty())
    draw_label({at->x + radius * 2, at->y}, measure, Beside::right);
  draw.PopClipRect();
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

ControlFacts Viewer::control_facts(const std::string& under) {
  ControlFacts facts;
  PanelFacts& panel = facts.panel;
  panel.costs = cost_facts();
  panel.errors = app_.errors, panel.warnings = app_.warnings.lines();
  panel.look = app_.look, panel.boxes = overlay_.facts();
  if (app_.view.compared && difference_) panel.difference = &*difference_;
  panel.selection = app_.selection_facts();
  panel.figure.read = app_.read_options(), panel.figure.waits = app_.waits_for_file();
  panel.figure.picture_width = app_.stage.picture_width;
  panel.figure.picture_height = app_.stage.picture_height;
  if (app_.is_printing()) facts.panel.figure.printed = print_job_.share();
  facts.tools = {app_.history.can_undo(), app_.history.can_redo(), window_.is_full_screen(),
                 inspector_.is_open() || inspector_.is_picking(), app_.has_panel()};
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
  if (app_.view.path.empty())
    facts.welcome = {keeper_.memory().recent, samples_, &cards_, lessons_, &lesson_pictures_};
  // An error in the file stays until it is fixed.
  const bool stays = app_.message.text().empty() && !app_.errors.empty();
  facts.message = stays ? app_.errors.front().text() : app_.message.text();
  facts.is_error = stays || app_.says_error;
  return facts;
}

}  // namespace raio::core::view
