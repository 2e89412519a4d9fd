#include "app/manual.h"

#include <fmt/ranges.h>

#include <array>
#include <set>

#include "app/commands.h"
#include "app/help.h"
#include "app/outline.h"
#include "app/output.h"
#include "app/version.h"

namespace raio::core::app {
namespace {

constexpr std::array<std::string_view, 3> kShells = {"bash", "zsh", "fish"};

// Escapes text for troff.
std::string troff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    line_begins = c == '\n';
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  return out;
}

// A ".TP" paragraph: "\fB--size\fR \fIWxH\fR" over its description.
std::string troff_entry(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option_names(option))
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", troff(name));
  const std::string value =
      takes_value(option) ? fmt::format("\\fI{}\\fR", troff(value_usage(option))) : "";
  return fmt::format(".TP\n{}{}{}\n{}\n", names, names.empty() || value.empty() ? "" : " ", value,
                     troff(option.get_description()));
}

// An option that an earlier command explained in the same words is only named.
std::string troff_options(const CLI::App& command, std::set<std::string>& explained) {
  std::string out;
  std::vector<std::string> again;
  for (const CLI::Option* option : positionals(command)) out += troff_entry(*option);
  for (const auto& [title, options] : option_sections(command)) {
    std::string entries;
    for (const CLI::Option* option : options) {
      if (const std::string entry = troff_entry(*option); explained.insert(entry).second)
        entries += entry;
      else
        again.push_back(fmt::format("\\fB{}\\fR", troff(option_names(*option).back())));
    }
    if (!entries.empty()) out += fmt::format(".PP\n.B {}\n{}", title, entries);
  }
  if (!again.empty()) out += fmt::format(".PP\nAlso, as above: {}.\n", fmt::join(again, ", "));
  return out;
}

std::string troff_footer(const CLI::App& command) {
  if (command.get_footer().empty()) return {};
  return fmt::format(".PP\n.nf\n{}.fi\n", troff(command.get_footer()));
}

constexpr std::string_view kExitStatus =
    ".SH EXIT STATUS\n"
    ".TP\n0\nSuccess.\n"
    ".TP\n1\nA requested check failed.\n"
    ".TP\n2\nBad usage or bad input.\n"
    ".TP\n3\nA file could not be written, or memory or another resource ran out.\n"
    ".TP\n130\nInterrupted.\n";

void add_help(CLI::App& app, int& status) {
  auto* sub = app.add_subcommand("help", "Print the help of a command");
  const auto words = std::make_shared<std::vector<std::string>>();
  std::vector<std::string> names;
  for (const CLI::App* command : commands(app)) names.push_back(command->get_name());
  const std::vector<std::string_view> offered(names.begin(), names.end());
  sub->add_option("command", *words, "Command, as in spd verify (default: raio itself)")
      ->type_name(value_type("COMMAND", offered));
  sub->footer("Example:\n  raio help render\n");
  sub->callback([&app, &status, words] {
    const CLI::App* chosen = &app;
    for (const std::string& word : *words) {
      const CLI::App* next = find_command(*chosen, word);
      if (!next) throw CLI::ParseError(unknown_command(*chosen, word), kBadInput);
      chosen = next;
    }
    status = deliver("-", help_text(*chosen));
  });
}

}  // namespace

std::string manual_text(const CLI::App& app) {
  std::string out;
  for (const CLI::App* command : all_commands(app)) {
    const std::string title = full_name(*command);
    out += fmt::format("{}{}\n{:=<{}}\n\n{}", out.empty() ? "" : "\n\n", title, "", title.size(),
                       help_text(*command));
  }
  return out;
}

std::string manual_page(const CLI::App& app) {
  std::string out = ".\\\" Made by: raio manual --man\n";
  out +=
      fmt::format(".TH RAIO 1 \"{}\" \"raio {}\" \"User Commands\"\n", commit().date, RAIO_VERSION);
  std::string summary = app.get_description();
  summary = summary.substr(summary.find(": a ") + 4);
  out += fmt::format(".SH NAME\nraio \\- {}\n", troff(summary));
  out += ".SH SYNOPSIS\n";
  for (const CLI::App* command : all_commands(app))
    if (commands(*command).empty())
      out += fmt::format("{}.B {}\n{}\n", out.ends_with("SYNOPSIS\n") ? "" : ".br\n",
                         troff(full_name(*command)), troff(usage_of_arguments(*command).substr(1)));
  std::set<std::string> explained;
  out += ".SH OPTIONS\n" + troff_options(app, explained);
  out += ".SH COMMANDS\n";
  for (const CLI::App* command : all_commands(app)) {
    if (command == &app) continue;
    out += fmt::format(".SS {}{}\n{}.\n", troff(full_name(*command)),
                       troff(usage_of_arguments(*command)), troff(command->get_description()));
    out += troff_options(*command, explained) + troff_footer(*command);
  }
  return out + std::string(kExitStatus);
}

void add_manual_commands(CLI::App& app, int& status) {
  auto* version =
      app.add_subcommand("version", "Print the version and the commit it was built from");
  version->footer("Example:\n  raio version\n");
  version->callback([&status] { status = deliver("-", version_text() + "\n"); });

  auto* manual = app.add_subcommand("manual", "Print the help of all commands");
  const auto as_page = std::make_shared<bool>(false);
  manual->add_flag("--man", *as_page, "Print a page for man(1) instead");
  manual->footer("Example:\n  raio manual --man > raio.1\n");
  manual->callback([&app, &status, as_page] {
    status = deliver("-", *as_page ? manual_page(app) : manual_text(app));
  });

  auto* options = app.add_subcommand(
      "options", "Print the options of rendering and reading as JSON, for other programs");
  options->footer("Example:\n  raio options > options.json\n");
  options->callback([&status] { status = deliver("-", options_json()); });

  auto* script = app.add_subcommand("completion", "Print a shell completion script");
  const auto shell = std::make_shared<std::string>();
  script->add_option("shell", *shell, "Shell: bash, zsh or fish")
      ->required()
      ->type_name(value_type("SHELL", kShells));
  script->footer("Examples:\n  source <(raio completion bash)\n  raio completion fish | source\n");
  script->callback([&app, &status, shell] {
    if (std::ranges::find(kShells, *shell) == kShells.end())
      throw CLI::ParseError(fmt::format("expected bash, zsh or fish, found '{}'", *shell),
                            kBadInput);
    status = deliver("-", completion(app, *shell));
  });
  add_help(app, status);
}

}  // namespace raio::core::app
