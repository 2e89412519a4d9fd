// The course's lessons: a page of docs/course in Markdown, its commands that the window can carry
// out, and its exercises with answers to check and solutions. No drawing.
//
// A page gives the answers of an exercise in a comment below it, which other readers do not show:
//
//   <!-- answer: side of a pixel = 0.0249; pixels counted = 5238 ± 60; does it change = no | none
//   -->
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/shown_scene.h"
#include "base/error.h"

namespace raio::core::view {

/// Text of one style, or a picture.
struct Run {
  std::string text;  // of a picture: its description
  bool bold = false, italic = false, code = false;
  std::filesystem::path lesson = {};   // the page that the text links to; empty: none
  std::filesystem::path picture = {};  // file; empty: none
};
using Runs = std::vector<Run>;

/// A command of the page as a button of the window.
struct Button {
  std::string value;  // of the loop's variable; empty: no loop
  app::ShownScene shown;
};

struct CodeLine {
  std::string text;
  std::vector<Button> buttons = {};
};

struct Answer {
  std::string question;
  std::vector<std::string> words;  // accepted ones, in lower case; empty: a number
  double number = 0, tolerance = 0;
};

struct Block {
  enum class Kind : uint8_t { heading, paragraph, formula, commands, list, table, answers };

  Kind kind = Kind::paragraph;
  int level = 0;                               // of a heading, from 1
  Runs runs = {};                              // of a heading or a paragraph
  std::vector<CodeLine> lines = {};            // of formulas and commands
  int first = 0;                               // number of the first item; 0: bullets
  std::vector<std::vector<Block>> items = {};  // of a list
  std::vector<std::vector<Runs>> rows = {};    // of a table; the first is its head
  std::vector<Answer> answers = {};
};
using Blocks = std::vector<Block>;

struct Exercise {
  Blocks task;
  std::vector<Answer> answers;
  Blocks solution;
};

struct Lesson {
  std::filesystem::path previous, next;  // pages; empty: none
  std::string title;                     // "1. Camera and rays"
  Blocks text;                           // up to the exercises
  std::vector<Exercise> exercises;
  Blocks after;         // papers
  Blocks more_answers;  // the solutions of other questions, with their heading
};

/// Reads a page. Pictures and links are relative to it, scenes to the folder with scenes/ and
/// docs/. Only scenes that exist there have buttons.
std::expected<Lesson, Error> read_lesson(const std::filesystem::path& page);

/// The result of judge().
enum class Verdict : uint8_t {
  right,
  too_large,
  too_small,
  ten_times_too_large,
  ten_times_too_small,
  wrong_sign,
  no_number,
  wrong
};

/// Judges what a student typed. Numbers have "." or "," and may end in a unit; words may be in any
/// case.
Verdict judge(const Answer& answer, std::string_view typed);

/// A lesson in the list of the course.
struct LessonEntry {
  std::filesystem::path page;
  std::string title, question;
  std::filesystem::path picture;  // the page's first PNG; empty: none
};

/// The lessons in the table of docs/course/README.md in `root`, in its order; empty if there is
/// none.
std::vector<LessonEntry> lessons_in(const std::filesystem::path& root);

}  // namespace raio::core::view
