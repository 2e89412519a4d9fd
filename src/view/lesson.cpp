#include "view/lesson.h"

#include <md4c.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "base/spelling.h"
#include "io/file.h"

namespace raio::core::view {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxPage = 1 << 20;  // bytes
constexpr double kUsualTolerance = 0.02;

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(at, begin), text.size());
    parts.emplace_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

// A number at the beginning, and the text behind it.
std::optional<std::pair<double, std::string>> number_in(const std::string& text) {
  std::string plain(trimmed(text));
  for (const auto& [from, to] : {std::pair("\u2212", "-"), {",", "."}})
    for (size_t at = 0; (at = plain.find(from, at)) != std::string_view::npos;)
      plain.replace(at, std::string_view(from).size(), to);
  if (plain.starts_with('+')) plain.erase(0, 1);
  double number = 0;
  const char* const end = plain.data() + plain.size();
  const auto [rest, error] = std::from_chars(plain.data(), end, number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  return std::pair(number, std::string(rest, end));
}

// "side of a pixel = 0.0249; does it change = no | none"
std::vector<Answer> answers_of(std::string_view comment) {
  constexpr std::string_view kBegin = "<!-- answer:", kEnd = "-->";
  if (!comment.starts_with(kBegin)) return {};
  comment = comment.substr(kBegin.size(), comment.find(kEnd) - kBegin.size());
  std::vector<Answer> answers;
  for (const std::string& part : split(comment, ';')) {
    const size_t sign = part.rfind(" = ");
    if (sign == std::string_view::npos) continue;
    Answer answer{std::string(trimmed(part.substr(0, sign))), {}};
    const std::string value = part.substr(sign + 3);
    if (const auto number = number_in(value)) {
      answer.number = number->first;
      constexpr std::string_view kPlusMinus = "±";
      const size_t at = number->second.find(kPlusMinus);
      const auto tolerance = at == std::string::npos
                                 ? number
                                 : number_in(number->second.substr(at + kPlusMinus.size()));
      answer.tolerance = at == std::string::npos || !tolerance
                             ? kUsualTolerance * std::abs(answer.number)
                             : tolerance->first;
    } else {
      answer.words = split(lower_case(value), '|');
    }
    answers.push_back(std::move(answer));
  }
  return answers;
}

bool is_lesson(const fs::path& file) {
  const std::string name = file.filename().string();
  std::error_code ignored;
  return std::isdigit(static_cast<unsigned char>(name.front())) && file.extension() == ".md" &&
         fs::exists(file, ignored);
}

// The number at the beginning of a lesson's name; 10 comes after 2.
int number_of(const fs::path& page) {
  const std::string name = page.filename().string();
  int number = 0;
  std::from_chars(name.data(), name.data() + name.size(), number);
  return number;
}

// Builds blocks from the events of md4c.
class PageParser {
 public:
  explicit PageParser(const fs::path& page) : folder_(page.parent_path()) {}

  Blocks parse(const std::string& text) {
    MD_PARSER events{};
    events.flags = MD_FLAG_TABLES;
    events.enter_block = [](MD_BLOCKTYPE type, void* detail, void* self) {
      static_cast<PageParser*>(self)->enter(type, detail);
      return 0;
    };
    events.leave_block = [](MD_BLOCKTYPE type, void*, void* self) {
      static_cast<PageParser*>(self)->leave(type);
      return 0;
    };
    events.enter_span = [](MD_SPANTYPE type, void* detail, void* self) {
      static_cast<PageParser*>(self)->enter(type, detail);
      return 0;
    };
    events.leave_span = [](MD_SPANTYPE type, void*, void* self) {
      static_cast<PageParser*>(self)->leave(type);
      return 0;
    };
    events.text = [](MD_TEXTTYPE type, const char* letters, MD_SIZE size, void* self) {
      static_cast<PageParser*>(self)->add(type, {letters, size});
      return 0;
    };
    md_parse(text.data(), MD_SIZE(text.size()), &events, this);
    return std::move(blocks_);
  }

 private:
  Block& begin(Block::Kind kind) {
    open_.back()->push_back({.kind = kind});
    runs_ = nullptr;
    return open_.back()->back();
  }

  void enter(MD_BLOCKTYPE type, void* detail) {
    switch (type) {
      case MD_BLOCK_H: {
        Block& heading = begin(Block::Kind::heading);
        heading.level = int(static_cast<MD_BLOCK_H_DETAIL*>(detail)->level);
        runs_ = &heading.runs;
        break;
      }
      case MD_BLOCK_P:
        runs_ = &begin(Block::Kind::paragraph).runs;
        break;
      case MD_BLOCK_CODE:
        begin(static_cast<MD_BLOCK_CODE_DETAIL*>(detail)->fence_char ? Block::Kind::formula
                                                                     : Block::Kind::commands);
        break;
      case MD_BLOCK_UL:
        begin(Block::Kind::list);
        break;
      case MD_BLOCK_OL:
        begin(Block::Kind::list).first = int(static_cast<MD_BLOCK_OL_DETAIL*>(detail)->start);
        break;
      case MD_BLOCK_LI: {
        // The blocks that are open do not grow meanwhile, so the pointer stays valid.
        auto& items = open_.back()->back().items;
        open_.push_back(&items.emplace_back());
        runs_ = nullptr;
        break;
      }
      case MD_BLOCK_HTML:  // ends the text of an item
        runs_ = nullptr;
        break;
      case MD_BLOCK_TABLE:
        begin(Block::Kind::table);
        break;
      case MD_BLOCK_TR:
        open_.back()->back().rows.emplace_back();
        break;
      case MD_BLOCK_TH:
      case MD_BLOCK_TD:
        runs_ = &open_.back()->back().rows.back().emplace_back();
        break;
      default:
        break;
    }
  }

  void leave(MD_BLOCKTYPE type) {
    runs_ = nullptr;
    if (type == MD_BLOCK_LI) open_.pop_back();
    if (type == MD_BLOCK_CODE) {
      std::istringstream lines(std::exchange(verbatim_, {}));
      for (std::string line; std::getline(lines, line);)
        open_.back()->back().lines.push_back({line});
    }
    if (type == MD_BLOCK_HTML)
      if (auto answers = answers_of(trimmed(std::exchange(verbatim_, {}))); !answers.empty())
        begin(Block::Kind::answers).answers = std::move(answers);
  }

  void enter(MD_SPANTYPE type, void* detail) {
    const auto file = [&](const MD_ATTRIBUTE& name) {
      return (folder_ / std::string(name.text, name.size)).lexically_normal();
    };
    if (type == MD_SPAN_STRONG) style_.bold = true;
    if (type == MD_SPAN_EM) style_.italic = true;
    if (type == MD_SPAN_IMG) style_.picture = file(static_cast<MD_SPAN_IMG_DETAIL*>(detail)->src);
    if (type == MD_SPAN_A)
      if (const fs::path target = file(static_cast<MD_SPAN_A_DETAIL*>(detail)->href);
          is_lesson(target))
        style_.lesson = target;
  }

  void leave(MD_SPANTYPE type) {
    if (type == MD_SPAN_STRONG) style_.bold = false;
    if (type == MD_SPAN_EM) style_.italic = false;
    if (type == MD_SPAN_IMG) style_.picture.clear();
    if (type == MD_SPAN_A) style_.lesson.clear();
  }

  void add(MD_TEXTTYPE type, std::string_view letters) {
    const bool is_in_code = !open_.back()->empty() && !runs_ &&
                            (open_.back()->back().kind == Block::Kind::formula ||
                             open_.back()->back().kind == Block::Kind::commands);
    if (type == MD_TEXT_HTML || (type == MD_TEXT_CODE && is_in_code)) {
      if (!runs_) verbatim_ += letters;
      return;
    }
    // The text of an item of a list without empty lines has no block of its own.
    if (!runs_) runs_ = &begin(Block::Kind::paragraph).runs;
    Run run = style_;
    run.code = type == MD_TEXT_CODE;
    run.text = type == MD_TEXT_BR || type == MD_TEXT_SOFTBR ? " " : letters;
    if (!runs_->empty()) {
      Run& last = runs_->back();
      if (last.bold == run.bold && last.italic == run.italic && last.code == run.code &&
          last.lesson == run.lesson && last.picture == run.picture) {
        last.text += run.text;
        return;
      }
    }
    runs_->push_back(std::move(run));
  }

  fs::path folder_;
  Blocks blocks_;
  std::vector<Blocks*> open_{&blocks_};
  Runs* runs_ = nullptr;  // that the text goes to; null: none is open
  std::string verbatim_;  // of a block of code or a comment
  Run style_;
};

std::expected<Blocks, Error> parse_page(const fs::path& page) {
  const auto text = read_file(page, kMaxPage);
  if (!text) return std::unexpected(text.error());
  return PageParser(page).parse(*text);
}

// Calls `visit` for all blocks, also those of lists.
template <class Visit>
void for_each(Blocks& blocks, const Visit& visit) {
  for (Block& block : blocks) {
    visit(block);
    for (Blocks& item : block.items) for_each(item, visit);
  }
}

std::string plain_text(const Runs& runs) {
  std::string text;
  for (const Run& run : runs) text += run.text;
  return text;
}

// The words of a line of a shell, up to a pipe or a redirection.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word && word != "|" && word != ">";) words.push_back(word);
  return words;
}

std::optional<app::ShownScene> shown_by(const std::string& line, const fs::path& root) {
  std::vector<std::string> words = words_of(line);
  if (words.empty() || words.front() != "./raio") return std::nullopt;
  words.erase(words.begin());
  auto shown = app::shown_scene(words);
  if (!shown) return std::nullopt;
  // Makes the path whole. Not of files that the page's other commands would make first.
  const auto find = [&](std::string& file) {
    std::error_code ignored;
    if (!file.starts_with("scenes/") || !fs::exists(root / file, ignored)) return false;
    file = (root / file).string();
    return true;
  };
  std::string& environment = shown->read.environment;
  if (!find(shown->scene) || (!environment.empty() && !find(environment))) return std::nullopt;
  return shown;
}

// Gives a button to the commands that show a scene: within "for NAME in a b c; do", one for each
// value.
void add_buttons(std::vector<CodeLine>& lines, const fs::path& root) {
  std::string variable;
  std::vector<std::string> values{""};
  for (CodeLine& line : lines) {
    const std::string text(trimmed(line.text));
    if (text.starts_with("for ") && text.ends_with("; do")) {
      values = words_of(text.substr(0, text.size() - std::string_view("; do").size()));
      variable = values.size() > 3 ? "$" + values[1] : "";
      values.erase(values.begin(), values.begin() + std::min<long>(3, long(values.size())));
    } else if (text == "done") {
      variable.clear(), values = {""};
    } else if (text.starts_with("./raio ")) {
      for (const std::string& value : values) {
        std::string command = text;
        for (size_t at = 0;
             !variable.empty() && (at = command.find(variable)) != std::string_view::npos;)
          command.replace(at, variable.size(), value);
        if (auto shown = shown_by(command, root))
          line.buttons.push_back({value, std::move(*shown)});
      }
    }
  }
}

std::vector<Exercise> exercises_of(Block&& list) {
  std::vector<Exercise> exercises;
  for (Blocks& item : list.items) {
    Exercise& exercise = exercises.emplace_back();
    for (Block& block : item)
      if (block.kind == Block::Kind::answers)
        std::ranges::move(block.answers, std::back_inserter(exercise.answers));
      else
        exercise.task.push_back(std::move(block));
  }
  return exercises;
}

// Moves the blocks of a page to the parts of the lesson.
void sort_into(Lesson& lesson, Blocks&& blocks) {
  enum class Part { text, exercises, after, solutions, more_answers } part = Part::text;
  Blocks preface;  // of the solutions, for each of them
  for (Block& block : blocks) {
    if (block.level == 1) {
      lesson.title = plain_text(block.runs);
      continue;
    }
    if (block.level == 2) {
      const std::string heading = plain_text(block.runs);
      if (part == Part::exercises) part = Part::after;
      if (heading == "Exercises") part = Part::exercises;
      if (heading == "Solutions") part = Part::solutions;
    }
    const bool is_numbered = block.kind == Block::Kind::list && block.first > 0;
    if (part == Part::exercises && is_numbered) {
      lesson.exercises = exercises_of(std::move(block));
    } else if (part == Part::solutions && is_numbered) {
      for (size_t i = 0; i < std::min(block.items.size(), lesson.exercises.size()); ++i) {
        lesson.exercises[i].solution = preface;
        std::ranges::move(block.items[i], std::back_inserter(lesson.exercises[i].solution));
      }
      part = Part::more_answers;
    } else if (part == Part::solutions && block.level == 0) {
      preface.push_back(std::move(block));
    } else {
      (part == Part::after                                     ? lesson.after
       : part == Part::solutions || part == Part::more_answers ? lesson.more_answers
                                                               : lesson.text)
          .push_back(std::move(block));
    }
  }
}

fs::path first_picture(Blocks& blocks) {
  fs::path found;
  const auto look = [&](const Runs& runs) {
    for (const Run& run : runs)
      if (found.empty() && run.picture.extension() == ".png") found = run.picture;
  };
  for_each(blocks, [&](const Block& block) {
    look(block.runs);
    for (const auto& row : block.rows) std::ranges::for_each(row, look);
  });
  return found;
}

}  // namespace

std::expected<Lesson, Error> read_lesson(const fs::path& page) {
  auto blocks = parse_page(page);
  if (!blocks) return std::unexpected(blocks.error());
  const fs::path root = page.parent_path().parent_path().parent_path();
  for_each(*blocks, [&](Block& block) {
    if (block.kind == Block::Kind::commands) add_buttons(block.lines, root);
  });
  Lesson lesson;
  std::error_code error;
  std::vector<fs::path> pages;
  for (const auto& entry : fs::directory_iterator(page.parent_path(), error))
    if (is_lesson(entry.path())) pages.push_back(entry.path());
  std::ranges::sort(pages, {}, [](const fs::path& p) { return std::pair(number_of(p), p); });
  for (size_t i = 1; i < pages.size(); ++i) {
    if (pages[i] == page) lesson.previous = pages[i - 1];
    if (pages[i - 1] == page) lesson.next = pages[i];
  }
  sort_into(lesson, std::move(*blocks));
  return lesson;
}

Verdict judge(const Answer& answer, std::string_view typed) {
  const std::string text(trimmed(typed));
  if (!answer.words.empty()) {
    const std::string word =
        lower_case(text.substr(std::min(text.find_first_not_of("-`"), text.size())));
    return std::ranges::count(answer.words, word) > 0 ? Verdict::right : Verdict::wrong;
  }
  const auto number = number_in(text);
  if (!number ||
      std::ranges::any_of(number->second, [](unsigned char c) { return std::isdigit(c); }))
    return Verdict::no_number;
  const double x = number->first;
  const auto is_near = [&](double y) {
    return std::abs(y - answer.number) <= answer.tolerance * (1 + 1e-9);
  };
  // A comma may separate thousands: "5,238".
  const size_t comma = text.find(',');
  const bool has_thousands =
      comma != std::string_view::npos && comma + 4 <= text.size() &&
      std::all_of(text.begin() + long(comma) + 1, text.begin() + long(comma) + 4,
                  [](unsigned char c) { return std::isdigit(c); });
  if (is_near(x) || (has_thousands && is_near(1000 * x))) return Verdict::right;
  if (is_near(-x)) return Verdict::wrong_sign;
  if (is_near(x / 10)) return Verdict::ten_times_too_large;
  if (is_near(10 * x)) return Verdict::ten_times_too_small;
  return x > answer.number ? Verdict::too_large : Verdict::too_small;
}

std::vector<LessonEntry> lessons_in(const fs::path& root) {
  std::vector<LessonEntry> lessons;
  if (root.empty()) return lessons;
  auto course = parse_page(root / "docs/course/README.md");
  if (!course) return lessons;
  for_each(*course, [&](const Block& block) {
    for (const auto& row : block.rows) {
      if (row.size() != 2 || row[0].size() != 1 || row[0][0].lesson.empty()) continue;
      const fs::path& page = row[0][0].lesson;
      auto blocks = parse_page(page);
      if (blocks)
        lessons.push_back({page, plain_text(row[0]), plain_text(row[1]), first_picture(*blocks)});
    }
  });
  return lessons;
}

}  // namespace raio::core::view
