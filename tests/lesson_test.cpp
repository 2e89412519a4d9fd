// The lessons of the course as the window reads them: commands that become buttons, answers that
// are judged, solutions.
#include "view/lesson.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>

#include "temporary_folder.h"
#include "view/page_pictures.h"

namespace raio::core::view {
namespace {

namespace fs = std::filesystem;
using app::shown_scene;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const fs::path kCourse = fs::path(RAIO_SOURCE_DIR) / "docs/course";

TEST(ShownScene, IsThatOfAWindowARenderAndAnExplanation) {
  const auto view = shown_scene({"view", "a.nff", "--soft-shadows", "--light-size", "2"});
  ASSERT_TRUE(view);
  EXPECT_EQ(view->scene, "a.nff");
  EXPECT_TRUE(view->options.soft_shadows);
  EXPECT_EQ(view->options.light_size, 2);
  EXPECT_FALSE(view->pixel);

  const auto render =
      shown_scene({"render", "a.pdb", "--size", "30x20", "--crop", "1,2,3,4", "--aa", "4",
                   "--style", "sticks", "--threads", "2", "-o", "a.png"});
  ASSERT_TRUE(render);
  RenderOptions options;
  options.aa = 4;
  EXPECT_EQ(render->options, options);
  EXPECT_EQ(render->read.style, AtomStyle::sticks);
  EXPECT_FALSE(render->size);

  const auto explain =
      shown_scene({"explain", "a.nff", "--size", "120x90", "--pixel", "60,45", "--depth", "3"});
  ASSERT_TRUE(explain);
  EXPECT_THAT(*explain->pixel, ElementsAre(60, 45));
  EXPECT_THAT(*explain->size, ElementsAre(120, 90));
  EXPECT_EQ(explain->options.width, 0);
  EXPECT_EQ(explain->options.depth, 3);
}

TEST(ShownScene, IsNothingForOtherCommandsAndInvalidOnes) {
  using Words = std::vector<std::string>;
  for (const Words& words : {Words{},
                             {"view"},
                             {"info", "a.nff"},
                             {"render"},
                             {"render", "a.nff", "b.nff"},
                             {"render", "-"},
                             {"render", "a.nff", "--turntable", "9"},
                             {"render", "a.nff", "--memory-limit", "1G"},
                             {"render", "a.nff", "--nonsense"},
                             {"render", "a.nff", "--aa", "many"},
                             {"explain", "a.nff"},
                             {"view", "--help"},
                             {"view", "a.nff", "--background", "transparent"}})
    EXPECT_FALSE(shown_scene(words)) << testing::PrintToString(words);
}

// All text of the blocks, also of tables, lists and commands.
std::string text_of(const Blocks& blocks) {
  std::string text;
  const auto add = [&](const Runs& runs) {
    for (const view::Run& run : runs) text += run.text;
    text += '\n';
  };
  for (const Block& block : blocks) {
    add(block.runs);
    for (const auto& row : block.rows) std::ranges::for_each(row, add);
    for (const CodeLine& line : block.lines) text += line.text + '\n';
    for (const Blocks& item : block.items) text += text_of(item);
  }
  return text;
}

template <class Visit>
void for_each_line(const Blocks& blocks, const Visit& visit) {
  for (const Block& block : blocks) {
    for (const CodeLine& line : block.lines) visit(line);
    for (const Blocks& item : block.items) for_each_line(item, visit);
  }
}

TEST(Lessons, AreTwelveWithExercisesWhoseSolutionsHaveTheAnswers) {
  const auto lessons = lessons_in(RAIO_SOURCE_DIR);
  ASSERT_EQ(lessons.size(), 12u);
  fs::path previous;
  int place = 0;
  for (const LessonEntry& entry : lessons) {
    SCOPED_TRACE(entry.page);
    EXPECT_TRUE(entry.title.starts_with(fmt::format("{}. ", ++place))) << entry.title;
    const auto lesson = read_lesson(entry.page);
    ASSERT_TRUE(lesson) << lesson.error().text();
    EXPECT_EQ(lesson->title, entry.title);
    EXPECT_TRUE(entry.question.ends_with('?'));
    EXPECT_TRUE(fs::exists(entry.picture)) << entry.picture;
    EXPECT_EQ(lesson->previous, previous);
    previous = entry.page;
    EXPECT_FALSE(text_of(lesson->text).contains("answer:"));
    EXPECT_EQ(lesson->exercises.size(), 3u);
    for (const Exercise& exercise : lesson->exercises) {
      EXPECT_FALSE(exercise.task.empty());
      EXPECT_FALSE(exercise.answers.empty()) << text_of(exercise.task);
      const std::string solution = text_of(exercise.solution);
      EXPECT_FALSE(solution.empty()) << text_of(exercise.task);
      for (const Answer& answer : exercise.answers) {
        if (!answer.words.empty()) {
          EXPECT_EQ(judge(answer, answer.words.front()), Verdict::right);
          continue;
        }
        const std::string number = fmt::format("{}", answer.number);
        EXPECT_EQ(judge(answer, number), Verdict::right) << number;
        const std::regex whole("(^|[^0-9.])" +
                               std::regex_replace(number, std::regex("\\."), "\\.") +
                               "($|[^0-9.]|\\.\\D)");
        EXPECT_TRUE(std::regex_search(solution, whole)) << number << " is not in " << solution;
      }
    }
  }
}

TEST(Lessons, EachWindowAndEachSceneThatIsRenderedHasAButton) {
  int views = 0, environments = 0;
  for (const LessonEntry& entry : lessons_in(RAIO_SOURCE_DIR)) {
    const auto lesson = read_lesson(entry.page);
    ASSERT_TRUE(lesson);
    const auto check = [&](const CodeLine& line) {
      const bool is_view = line.text.contains("./raio view"), shows = !line.buttons.empty();
      // The window shows neither.
      const bool is_other =
          line.text.contains("--projection omnidirectional") || line.text.contains("--denoise");
      if (is_view || line.text.contains("./raio render scenes/") ||
          line.text.contains("./raio explain scenes/")) {
        EXPECT_EQ(shows, !is_other) << line.text;
      }
      views += is_view;
      for (const Button& button : line.buttons) {
        EXPECT_TRUE(fs::exists(button.shown.scene));
        const std::string& environment = button.shown.read.environment;
        EXPECT_TRUE(environment.empty() || fs::exists(environment)) << environment;
        environments += !environment.empty();
      }
    };
    for_each_line(lesson->text, check);
    for (const Exercise& exercise : lesson->exercises) for_each_line(exercise.solution, check);
  }
  EXPECT_EQ(views, 12);
  EXPECT_GE(environments, 3);
}

TEST(Lessons, ALoopHasAButtonForEachValue) {
  const auto lesson = read_lesson(kCourse / "7-depth-of-field.md");
  ASSERT_TRUE(lesson);
  std::vector<std::string> values;
  std::vector<float> apertures;
  for_each_line(lesson->text, [&](const CodeLine& line) {
    if (!line.text.contains("$aperture")) return;
    for (const Button& button : line.buttons)
      values.push_back(button.value), apertures.push_back(button.shown.options.aperture);
  });
  EXPECT_THAT(values, ElementsAre("0.05", "0.15", "0.4"));
  EXPECT_THAT(apertures, ElementsAre(0.05f, 0.15f, 0.4f));
}

using LessonPage = TemporaryFolder;

TEST_F(LessonPage, IsReadAsItLooks) {
  const fs::path course = folder() / "docs/course";
  fs::create_directories(course);
  put(course / "2-b.md", "# 2. B\n");
  put(course / "1-a.md",
      "# 1. A\n\nPlain **bold** *italic* `code` [next](2-b.md) [other](x.md)\n"
      "![a ball](../pictures/ball.png)\n\n```\na  = b\n```\n\n"
      "    ./raio view scenes/gone.nff\n    sed x\n\n"
      "- one\n- two\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n"
      "## Exercises\n\n1. Why?\n   <!-- answer: a = 5 ± 1; b = yes | sim -->\n"
      "2. How?\n\n## The paper\n\nP\n\n## Solutions\n\nBoth:\n\n"
      "1. Five.\n2. So.\n\nMore.\n");
  const auto lesson = read_lesson(course / "1-a.md");
  ASSERT_TRUE(lesson) << lesson.error().text();
  EXPECT_EQ(lesson->title, "1. A");
  EXPECT_EQ(lesson->next, course / "2-b.md");
  EXPECT_TRUE(lesson->previous.empty());
  using Kind = Block::Kind;
  std::vector<Kind> kinds;
  for (const Block& block : lesson->text) kinds.push_back(block.kind);
  EXPECT_THAT(kinds, ElementsAre(Kind::paragraph, Kind::formula, Kind::commands, Kind::list,
                                 Kind::table, Kind::heading));
  const Runs& runs = lesson->text[0].runs;
  const auto run = [&](std::string_view text) {
    return *std::ranges::find(runs, text,
                              [](const view::Run& r) { return std::string_view(r.text); });
  };
  EXPECT_TRUE(run("bold").bold);
  EXPECT_TRUE(run("italic").italic);
  EXPECT_TRUE(run("code").code);
  EXPECT_EQ(run("next").lesson, course / "2-b.md");
  EXPECT_EQ(run("a ball").picture, folder() / "docs/pictures/ball.png");
  EXPECT_THAT(text_of(lesson->text), AllOf(HasSubstr(" other"), HasSubstr("a  = b\n")));
  EXPECT_TRUE(lesson->text[2].lines[0].buttons.empty());  // there is no such scene
  EXPECT_EQ(lesson->text[4].rows.size(), 2u);
  ASSERT_EQ(lesson->exercises.size(), 2u);
  EXPECT_EQ(lesson->exercises[0].answers.size(), 2u);
  EXPECT_TRUE(lesson->exercises[1].answers.empty());
  EXPECT_EQ(text_of(lesson->exercises[1].solution), "Both:\nSo.\n");
  EXPECT_EQ(text_of(lesson->after), "The paper\nP\n");
  EXPECT_EQ(text_of(lesson->more_answers), "Solutions\nMore.\n");
  EXPECT_FALSE(read_lesson(course / "3-c.md"));
}

TEST(Answers, AreJudgedWithinTheirTolerance) {
  const Answer side{"side", {}, 0.0249, 0.0005};
  for (const char* right : {"0.0249", " 0,025 ", "0.0245 units", "2.49e-2", "+0.0249"})
    EXPECT_EQ(judge(side, right), Verdict::right) << right;
  EXPECT_EQ(judge(side, "0.03"), Verdict::too_large);
  EXPECT_EQ(judge(side, "0.02"), Verdict::too_small);
  EXPECT_EQ(judge(side, "0.249"), Verdict::ten_times_too_large);
  EXPECT_EQ(judge(side, "0.00249"), Verdict::ten_times_too_small);
  EXPECT_EQ(judge(side, "-0.0249"), Verdict::wrong_sign);
  for (const char* none : {"", "x", "1/40", "4 or 5", "nan", "inf"})
    EXPECT_EQ(judge(side, none), Verdict::no_number) << none;

  const Answer count{"count", {}, 5238, 60};
  for (const char* right : {"5238", "5,238", "5200"})
    EXPECT_EQ(judge(count, right), Verdict::right) << right;
  EXPECT_EQ(judge(count, "5,2"), Verdict::too_small);
  EXPECT_EQ(judge({"y", {}, -4.18, 0.08}, "\u22124.2"), Verdict::right);
  EXPECT_EQ(judge({"angle", {}, 41.8, 0.8}, "41.8°"), Verdict::right);
  EXPECT_EQ(judge({"share", {}, 16, 1}, "16 %"), Verdict::right);
  EXPECT_EQ(judge({"depth", {}, 6, 0}, "6"), Verdict::right);

  const Answer word{"better", {"samples", "sobol"}};
  for (const char* right : {"Sobol", "--samples", " samples "})
    EXPECT_EQ(judge(word, right), Verdict::right) << right;
  EXPECT_EQ(judge(word, "aa"), Verdict::wrong);
}

TEST(PagePicture, DiagramsHaveTwiceTheirSizeOnWhite) {
  const auto diagram =
      read_page_picture(fs::path(RAIO_SOURCE_DIR) / "docs/pictures/course/1-camera.svg");
  ASSERT_TRUE(diagram) << diagram.error();
  EXPECT_EQ(diagram->width, 1080);
  EXPECT_EQ(diagram->height, 504);
  EXPECT_EQ(diagram->at(0, 0), Rgb(1));
  // The red of its normal and the blue of its ray.
  EXPECT_TRUE(
      std::ranges::any_of(diagram->pixels, [](const Rgb& c) { return c.x > 0.6f && c.z < 0.3f; }));
  EXPECT_TRUE(
      std::ranges::any_of(diagram->pixels, [](const Rgb& c) { return c.z > 0.6f && c.x < 0.3f; }));
  EXPECT_FALSE(read_page_picture(kCourse / "README.md"));
  EXPECT_FALSE(read_page_picture(kCourse / "none.svg"));
}

}  // namespace
}  // namespace raio::core::view
