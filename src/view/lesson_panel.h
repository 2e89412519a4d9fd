// The panel with a lesson of the course: its text, buttons for its commands, fields for the answers
// of its exercises, and solutions on request.
#pragma once

#include <expected>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "view/layout.h"
#include "view/lesson.h"
#include "view/page_pictures.h"
#include "view/page_text.h"

namespace raio::core::view {

struct LessonResult : PageEvents {
  bool closes = false;
};

class LessonPanel {
 public:
  void open(const std::filesystem::path& page) {
    page_ = page, lesson_ = read_lesson(page), is_new_ = true;
  }
  void close() { lesson_.reset(); }
  bool is_open() const { return lesson_.has_value(); }

  /// Draws the open lesson. Each page keeps its place and its answers while the window is open. A
  /// new page asks for its first scene if it `needs_scene`: none is open.
  LessonResult draw(const Rect& where, bool needs_scene = false);

 private:
  struct Typed {
    std::string text;
    std::string judged;  // when the field was left
  };

  void draw_head(LessonResult& result) const;
  void draw_exercise(size_t number, LessonResult& result);
  static void draw_answer(const Answer& answer, Typed& typed);

  std::filesystem::path page_;
  bool is_new_ = false;                                 // not drawn yet
  std::optional<std::expected<Lesson, Error>> lesson_;  // none: closed
  PagePictures pictures_;
  std::map<std::string, Typed> typed_;  // by page, exercise and answer
};

}  // namespace raio::core::view
