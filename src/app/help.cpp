#include "app/help.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "app/outline.h"
#include "base/spelling.h"

namespace raio::core::app {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

constexpr size_t kColumns = 80;
constexpr size_t kWidestName = 26;  // the text of a longer name starts on the next line

// brief_help() of a command with more options than kManyOptions shows these.
constexpr size_t kManyOptions = 30;
constexpr auto kCommonOptions = std::to_array<std::string_view>(
    {"--output", "--size", "--aa", "--soft-shadows", "--dof", "--from", "--fit", "--background",
     "--look", "--style", "--color-by", "--accel"});

// Breaks between words; all lines except the first are indented.
std::string wrapped(std::string_view text, size_t indent, size_t first_column) {
  std::string out;
  size_t column = first_column;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    const bool first = out.empty();
    if (!first && column + 1 + word.size() > kColumns) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!first) {
      out += ' ', ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

// "-o, --output IMAGE"
std::string option_name(const CLI::Option& option) {
  const std::string names = fmt::format("{}", fmt::join(option_names(option), ", "));
  return takes_value(option) ? names + " " + value_usage(option) : names;
}

Rows command_rows(const CLI::App& app) {
  Rows rows;
  for (const CLI::App* command : commands(app))
    rows.emplace_back(command->get_name(), command->get_description());
  return rows;
}

std::string usage(const CLI::App& command) {
  return fmt::format("{}\n\nUsage: {}{}\n", wrapped(command.get_description(), 0, 0),
                     full_name(command), usage_of_arguments(command));
}

std::string with_suggestion(std::string message, std::string_view word,
                            const std::vector<std::string>& names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string_view nearest = nearest_word(word, views);
  return nearest.empty() ? message : fmt::format("{}; did you mean {}?", message, nearest);
}

std::string unknown_option(const CLI::App& app, std::string_view name) {
  std::vector<std::string> names;
  for (const CLI::Option* o : app.get_options())
    for (const std::string& known : o->get_lnames()) names.push_back("--" + known);
  return with_suggestion(fmt::format("unknown option {}", name), name, names);
}

bool is_option(const CLI::App& command, const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' && command.get_option_no_throw(argument);
}

// Checks the arguments after the command's name. A list comes last.
std::string arguments_problem(const CLI::App& command, std::span<const std::string> arguments) {
  const auto wanted = positionals(command);
  const bool list = !wanted.empty() && is_list(*wanted.back());
  size_t given = 0;
  bool only_positionals = false;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (!only_positionals && argument == "--") {
      only_positionals = true;
    } else if (only_positionals || argument.size() < 2 || argument[0] != '-') {
      if (++given > wanted.size() && !list)
        return fmt::format("one argument too many: '{}'", argument);
    } else {
      const bool is_long = argument[1] == '-';
      const std::string name = argument.substr(0, is_long ? argument.find('=') : 2);
      const CLI::Option* option = command.get_option_no_throw(name);
      if (!option) return unknown_option(command, name);
      if (option == command.get_help_ptr() || option == command.get_help_all_ptr()) return {};
      if (!takes_value(*option)) continue;
      const bool apart = argument == name;
      if (apart) ++i;
      const bool nothing = apart ? i == arguments.size() || is_option(command, arguments[i])
                                 : argument == name + "=";
      if (nothing && !needs_value(*option)) {
        i -= size_t(apart);
        continue;
      }
      if (nothing) return fmt::format("{} needs a value: {}", name, option_name(*option));
    }
  }
  if (given < wanted.size() && wanted[given]->get_required())
    return fmt::format("{} is missing: {}", value_name(*wanted[given]),
                       wanted[given]->get_description());
  return {};
}

}  // namespace

std::string two_columns(std::span<const std::pair<std::string, std::string>> rows) {
  size_t width = 0;
  for (const auto& [name, text] : rows)
    if (name.size() <= kWidestName) width = std::max(width, name.size());
  const size_t indent = width + 4;
  std::string out;
  for (const auto& [name, text] : rows) {
    out += name.size() <= width ? fmt::format("  {:<{}}  ", name, width)
                                : fmt::format("  {}\n{:{}}", name, "", indent);
    out += wrapped(text, indent, indent) + "\n";
  }
  return out;
}

std::string help_text(const CLI::App& command) {
  Rows arguments;
  for (const CLI::Option* o : positionals(command))
    arguments.emplace_back(value_name(*o), o->get_description());
  std::string out = usage(command);
  const auto section = [&](std::string_view title, const Rows& rows) {
    if (!rows.empty()) out += fmt::format("\n{}:\n{}", title, two_columns(rows));
  };
  section("Arguments", arguments);
  section("Commands", command_rows(command));
  for (const auto& [title, options] : option_sections(command)) {
    Rows rows;
    for (const CLI::Option* o : options) rows.emplace_back(option_name(*o), o->get_description());
    section(title, rows);
  }
  if (!command.get_footer().empty()) out += "\n" + command.get_footer();
  return out;
}

std::string brief_help(const CLI::App& command) {
  if (named_options(command).size() <= kManyOptions) return help_text(command);
  Rows rows;
  for (const CLI::Option* o : positionals(command))
    rows.emplace_back(value_name(*o),
                      o->get_description().substr(0, o->get_description().find(';')));
  for (const CLI::Option* o : named_options(command))
    if (o->get_required()) rows.emplace_back(option_name(*o), first_clause(*o));
  for (const std::string_view name : kCommonOptions)
    if (const CLI::Option* o = command.get_option_no_throw(std::string(name))) {
      // Others accept more than words.
      const auto words = value_name(*o) == "NAME" ? value_words(*o) : std::vector<std::string>();
      rows.emplace_back(option_name(*o),
                        fmt::format("{}{}{}", first_clause(*o), words.empty() ? "" : ": ",
                                    fmt::join(words, ", ")));
    }
  const std::string examples = command.get_footer();
  return usage(command) + "\n" + two_columns(rows) +
         fmt::format("\nAll options, with defaults and units: {} --help\n", full_name(command)) +
         examples.substr(0, examples.find('\n', examples.find('\n') + 1) + 1);
}

std::string unknown_command(const CLI::App& app, std::string_view name) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands(app)) names.push_back(command->get_name());
  return with_suggestion(fmt::format("unknown command '{}'", name), name, names);
}

std::string list_of_commands(const CLI::App& app) {
  return fmt::format("Usage: {}{}\n\nCommands:\n{}\nOptions of a command: {} help COMMAND.",
                     full_name(app), usage_of_arguments(app), two_columns(command_rows(app)),
                     full_name(app));
}

const CLI::App& chosen_command(const CLI::App& app, std::span<const std::string> arguments) {
  const CLI::App* command = arguments.empty() ? nullptr : find_command(app, arguments.front());
  return command ? chosen_command(*command, arguments.subspan(1)) : app;
}

std::string usage_problem(const CLI::App& app, std::span<const std::string> arguments) {
  if (arguments.empty()) return "expected a command";
  const std::string& first = arguments.front();
  if (const CLI::App* command = find_command(app, first)) {
    const auto rest = arguments.subspan(1);
    return commands(*command).empty() ? arguments_problem(*command, rest)
                                      : usage_problem(*command, rest);
  }
  if (!first.starts_with('-')) return unknown_command(app, first);
  return app.get_option_no_throw(first) ? "" : unknown_option(app, first);
}

}  // namespace raio::core::app
