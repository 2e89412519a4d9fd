// The manual page and the completions, held against the shells where they are installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdio.h>
#include <sys/wait.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"
#include "render/options.h"

namespace raio::core {
namespace {

using testing::Contains;
using testing::Each;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

class Manual : public CommandLine {
 protected:
  Manual() {
    for (const char* shell : {"bash", "zsh", "fish"})
      put(file(std::string("raio.") + shell), raio({"completion", shell}).out);
  }

  static bool has(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
  }

  struct Result {
    int status = -1;
    std::vector<std::string> lines;
  };

  // A shell's output on both streams, in the test's folder.
  Result shell(const std::string& script) const {
    put(file("script"), "cd '" + folder().string() + "'\n" + script);
    const std::string name = script.substr(2, script.find('\n') - 2);
    FILE* const pipe = ::popen((name + " '" + file("script").string() + "' 2>&1").c_str(), "r");
    Result result;
    std::string line;
    for (int c; (c = ::getc(pipe)) != EOF;) {
      if (c != '\n')
        line += char(c);
      else
        result.lines.push_back(std::exchange(line, {}));
    }
    result.status = WEXITSTATUS(::pclose(pipe));
    return result;
  }

  // Bash's completions for the last of these words.
  std::vector<std::string> bash_offers(const std::string& words) const {
    return shell("# bash\ncompopt() { :; }\nsource raio.bash\nCOMP_WORDS=(" + words +
                 ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_raio\n"
                 "for word in \"${COMPREPLY[@]}\"; do echo \"$word\"; done\n")
        .lines;
  }

  // Names come with a tab and their description.
  std::vector<std::string> fish_offers(const std::string& line) const {
    auto lines = shell("# fish\nsource raio.fish\ncomplete -C '" + line + "'\n").lines;
    for (std::string& offer : lines) offer = offer.substr(0, offer.find('\t'));
    return lines;
  }
};

TEST_F(Manual, PageHasEveryCommandAndOption) {
  const std::string page = raio({"manual", "--man"}).out;
  for (const char* section :
       {".TH RAIO 1 ", "\n.SH NAME\n", "\n.SH SYNOPSIS\n", "\n.SS raio render ",
        "\n.SS raio spd verify ", "\n.B Long renders\n", "\n.SH EXIT STATUS\n"})
    EXPECT_THAT(page, HasSubstr(section));
  for (const OptionSpec& option : render_option_table()) {
    std::string name;
    for (const char c : option.name) name += c == '-' ? std::string("\\-") : std::string(1, c);
    EXPECT_THAT(page, HasSubstr("\\fB\\-\\-" + name + "\\fR"));
  }
  if (!has("man")) GTEST_SKIP() << "there is no man here";
  put(file("raio.1"), page);
  const Result shown =
      shell("# sh\nLC_ALL=C MANROFFSEQ= man --warnings -l -Tascii raio.1 2>&1 > text\n");
  EXPECT_EQ(shown.status, 0);
  EXPECT_THAT(shown.lines, IsEmpty());
  EXPECT_GT(std::filesystem::file_size(file("text")), 5000u);
}

TEST_F(Manual, TextIsTheHelpOfAllCommands) {
  const std::string text = raio({"manual"}).out;
  EXPECT_THAT(text, HasSubstr(raio({"--help"}).out));
  EXPECT_THAT(text, HasSubstr(raio({"spd", "verify", "--help"}).out));
  EXPECT_THAT(text, HasSubstr(raio({"manual", "--help"}).out));
}

TEST_F(Manual, ScriptsAreSound) {
  for (const std::string name : {"bash", "zsh", "fish"}) {
    if (!has(name)) continue;
    const Result checked = shell("# sh\n" + name + " -n raio." + name + "\n");
    EXPECT_EQ(checked.status, 0) << name;
    EXPECT_THAT(checked.lines, IsEmpty()) << name;
  }
  expect_refusal({"completion", "tcsh"}, 2, "bash, zsh or fish");
}

TEST_F(Manual, BashCompletesCommandsOptionsWordsAndFiles) {
  put(file("two words.nff"), kScene), put(file("notes.txt"), ""), put(file("a.png"), "");
  put(file("atoms.pdb"), "");
  std::filesystem::create_directory(file("folder"));
  EXPECT_THAT(bash_offers("raio re"), UnorderedElementsAre("render"));
  EXPECT_THAT(bash_offers("raio spd ''"), UnorderedElementsAre("verify"));
  EXPECT_THAT(bash_offers("raio --v"), UnorderedElementsAre("--version"));
  EXPECT_THAT(bash_offers("raio render --grid"),
              UnorderedElementsAre("--grid-factor", "--grid-resolution"));
  EXPECT_THAT(bash_offers("raio render --color-bar-side ''"),
              UnorderedElementsAre("right", "left"));
  EXPECT_THAT(bash_offers("raio render --accel ''"),
              UnorderedElementsAre("auto", "none", "grid", "bvh", "embree"));
  EXPECT_THAT(bash_offers("raio view ok.nff --view = st"), UnorderedElementsAre("steps"));
  EXPECT_THAT(bash_offers("raio render ''"),
              UnorderedElementsAre("folder", "ok.nff", "two words.nff", "atoms.pdb"));
  EXPECT_THAT(bash_offers("raio render ok.nff -o ''"), UnorderedElementsAre("folder", "a.png"));
  EXPECT_THAT(bash_offers("raio convert ''"),
              UnorderedElementsAre("folder", "ok.nff", "two words.nff", "atoms.pdb"));
  EXPECT_THAT(bash_offers("raio compare ''"), UnorderedElementsAre("folder", "a.png"));
  EXPECT_THAT(bash_offers("raio view --style s"), UnorderedElementsAre("space-filling", "sticks"));
  EXPECT_THAT(bash_offers("raio render ok.nff --stats n"), UnorderedElementsAre("notes.txt"));
  EXPECT_THAT(bash_offers("raio render --size ''"), IsEmpty());
  EXPECT_THAT(bash_offers("raio spd verify te"), UnorderedElementsAre("teapot", "tetra"));
  EXPECT_THAT(bash_offers("raio help comp"), UnorderedElementsAre("compare", "completion"));
}

TEST_F(Manual, FishCompletesTheSame) {
  if (!has("fish")) GTEST_SKIP() << "there is no fish here";
  put(file("a.png"), "");
  EXPECT_THAT(fish_offers("raio re"), UnorderedElementsAre("render"));
  EXPECT_THAT(fish_offers("raio spd "), UnorderedElementsAre("verify"));
  EXPECT_THAT(fish_offers("raio render --grid"),
              UnorderedElementsAre("--grid-factor", "--grid-resolution"));
  EXPECT_THAT(fish_offers("raio render --accel "),
              UnorderedElementsAre("auto", "none", "grid", "bvh", "embree"));
  EXPECT_THAT(fish_offers("raio render "), UnorderedElementsAre("ok.nff"));
  EXPECT_THAT(fish_offers("raio render ok.nff -o "), UnorderedElementsAre("a.png"));
  EXPECT_THAT(fish_offers("raio render ok.nff --output=a"), Contains(EndsWith("a.png")));
  EXPECT_THAT(fish_offers("raio spd verify te"), UnorderedElementsAre("teapot", "tetra"));
  EXPECT_THAT(fish_offers("raio help verif"), IsEmpty());
}

// zsh completes only on a terminal; the test prints what the script passes to its helpers.
TEST_F(Manual, ZshDescribesTheSame) {
  if (!has("zsh")) GTEST_SKIP() << "there is no zsh here";
  const auto said = [&](const std::string& words) {
    return shell(
               "# zsh\n_describe() { print -l -- $names; }\n"
               "_arguments() { print -l -- \"$@\"; }\nwords=(" +
               words + ")\nCURRENT=$#words\nsource ./raio.zsh\n")
        .lines;
  };
  EXPECT_THAT(said("raio ''"), Contains("render:Render a scene to a picture"));
  EXPECT_THAT(said("raio ''"), Each(Not(StartsWith("-"))));
  EXPECT_THAT(said("raio spd ''"), UnorderedElementsAre(StartsWith("verify:")));
  const auto render = said("raio render ok.nff --accel ''");
  EXPECT_THAT(render,
              Contains("--accel=[Acceleration structure]:NAME:(auto none grid bvh embree)"));
  EXPECT_THAT(render, Contains("(--dof --no-dof)--no-dof[Depth of field]"));
  EXPECT_THAT(render, Contains(StartsWith("*:SCENE:_files -g \"*.(nff|p3f|raio|")));
  EXPECT_THAT(render, Contains(HasSubstr("in the file's coordinates]")));
}

}  // namespace
}  // namespace raio::core
