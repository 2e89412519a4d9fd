#include "view/lesson_panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <utility>

#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr float kField = 7;  // ems

const char* text_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::right:
      return tr("right");
    case Verdict::too_large:
      return tr("too large");
    case Verdict::too_small:
      return tr("too small");
    case Verdict::ten_times_too_large:
      return tr("ten times too large");
    case Verdict::ten_times_too_small:
      return tr("ten times too small");
    case Verdict::wrong_sign:
      return tr("check the sign");
    case Verdict::no_number:
      return tr("not a number");
    case Verdict::wrong:
      return tr("not right");
  }
  return "";
}

void wrapped_text(const std::string& line) {
  ImGui::PushTextWrapPos(0);
  text(line);
  ImGui::PopTextWrapPos();
}

// A line that opens what is below it.
bool opens(const char* title) {
  return ImGui::TreeNodeEx(title,
                           ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_NoTreePushOnOpen);
}

// The first scene of the text; nothing if it has none.
std::optional<app::ShownScene> first_shown(const Lesson& lesson) {
  for (const Block& block : lesson.text)
    for (const CodeLine& line : block.lines)
      if (!line.buttons.empty()) return line.buttons.front().shown;
  return std::nullopt;
}

}  // namespace

LessonResult LessonPanel::draw(const Rect& where, bool needs_scene) {
  LessonResult result;
  begin_panel("lesson", where, false);
  ImGui::GetWindowDrawList()->AddLine({where.right - 1, where.top}, {where.right - 1, where.bottom},
                                      color(palette().line));
  draw_head(result);
  // A window of its own for each page, which keeps its place.
  ImGui::BeginChild(page_.c_str(), {}, false, ImGuiWindowFlags_AlwaysVerticalScrollbar);
  if (!*lesson_) {
    wrapped_text(lesson_->error().text());
  } else {
    const Lesson& lesson = **lesson_;
    if (std::exchange(is_new_, false) && needs_scene) result.show = first_shown(lesson);
    draw_blocks(lesson.text, pictures_, result);
    for (size_t i = 0; i < lesson.exercises.size(); ++i) draw_exercise(i, result);
    draw_blocks(lesson.after, pictures_, result);
    if (lesson.more_answers.size() > 1) {
      ImGui::Spacing();
      if (opens(tr("Answers to the questions of the text")))
        draw_blocks(lesson.more_answers, pictures_, result);
    }
    ImGui::Dummy({0, 2 * em()});
  }
  ImGui::EndChild();
  ImGui::End();
  return result;
}

void LessonPanel::draw_head(LessonResult& result) const {
  const auto offer = [&](const char* name, const char* about, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", about);
    ImGui::EndDisabled();
    ImGui::SameLine();
    return pressed;
  };
  const Lesson none;
  const Lesson& lesson = *lesson_ ? **lesson_ : none;
  result.closes = offer("x", tr("Close the lesson"), true);
  if (offer("<", tr("Previous lesson"), !lesson.previous.empty()))
    result.page = lesson.previous.string();
  if (offer(">", tr("Next lesson"), !lesson.next.empty())) result.page = lesson.next.string();
  ImGui::AlignTextToFramePadding();
  ImGui::PushFont(heading_font());
  wrapped_text(lesson.title);
  ImGui::PopFont();
  ImGui::Separator();
}

void LessonPanel::draw_exercise(size_t number, LessonResult& result) {
  const Exercise& exercise = (*lesson_)->exercises[number];
  ImGui::PushID(int(number));
  ImGui::Spacing();
  ImGui::PushFont(heading_font());
  text(fmt::format("{}.", number + 1));
  ImGui::PopFont();
  const float indent = 1.4f * em();
  ImGui::SameLine(indent);
  ImGui::Indent(indent);
  draw_blocks(exercise.task, pictures_, result);
  for (size_t i = 0; i < exercise.answers.size(); ++i) {
    ImGui::PushID(int(i));
    draw_answer(exercise.answers[i], typed_[fmt::format("{} {} {}", page_.string(), number, i)]);
    ImGui::PopID();
  }
  if (!exercise.solution.empty() && opens(tr("Show the solution")))
    draw_blocks(exercise.solution, pictures_, result);
  ImGui::Unindent(indent);
  ImGui::PopID();
}

// Draws the question, the field, and the verdict on the last answer.
void LessonPanel::draw_answer(const Answer& answer, Typed& typed) {
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float width = ImGui::GetContentRegionAvail().x;
  const float question = ImGui::CalcTextSize(answer.question.c_str()).x;
  ImGui::AlignTextToFramePadding();
  wrapped_text(answer.question);
  if (question + gap + kField * em() <= width) ImGui::SameLine();
  ImGui::SetNextItemWidth(kField * em());
  ImGui::InputText("##answer", &typed.text);
  if (ImGui::IsItemDeactivatedAfterEdit()) typed.judged = typed.text;
  if (typed.judged.empty() || typed.judged != typed.text) return;
  const Verdict verdict = judge(answer, typed.judged);
  const char* const words = text_of(verdict);
  if (ImGui::GetItemRectMax().x + gap + ImGui::CalcTextSize(words).x <=
      ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x)
    ImGui::SameLine();
  ImGui::PushStyleColor(ImGuiCol_Text,
                        verdict == Verdict::right ? palette().good : palette().warning);
  text(words);
  ImGui::PopStyleColor();
}

}  // namespace raio::core::view
