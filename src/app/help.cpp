#include "app/help.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "app/outline.h"
#include "base/spelling.h"

namespace raio::app {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

constexpr size_t kColumns = 100;
constexpr size_t kWidestName = 26;  // a longer one has its text on the next line

// Breaks between words; every line but the first is indented.
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
  return takes_value(option) ? names + " " + value_name(option) : names;
}

Rows command_rows(const CLI::App& app) {
  Rows rows;
  for (const CLI::App* command : commands(app))
    rows.emplace_back(command->get_name(), command->get_description());
  return rows;
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
  return with_suggestion(fmt::format("there is no option {}", name), name, names);
}

bool is_option(const CLI::App& command, const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' && command.get_option_no_throw(argument);
}

// After the command's name. A list comes last.
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
      if (option == command.get_help_ptr()) return {};
      if (!takes_value(*option)) continue;
      const bool apart = argument == name;
      if (apart) ++i;
      const bool nothing = apart ? i == arguments.size() || is_option(command, arguments[i])
                                 : argument == name + "=";
      if (nothing) return fmt::format("{} wants a value: {}", name, option_name(*option));
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

std::string HelpFormatter::make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const {
  Rows arguments, options;
  for (const CLI::Option* o : positionals(*app))
    arguments.emplace_back(value_name(*o), o->get_description());
  for (const CLI::Option* o : named_options(*app))
    options.emplace_back(option_name(*o), o->get_description());

  std::string out = wrapped(app->get_description(), 0, 0) + "\n\n";
  out += "Usage: " + full_name(*app) + usage_of_arguments(*app) + "\n";
  const auto section = [&](std::string_view title, const Rows& rows) {
    if (!rows.empty()) out += fmt::format("\n{}:\n{}", title, two_columns(rows));
  };
  section("Arguments", arguments);
  section("Commands", command_rows(*app));
  section("Options", options);
  if (!app->get_footer().empty()) out += "\n" + app->get_footer();
  return out;
}

std::string unknown_command(const CLI::App& app, std::string_view name) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands(app)) names.push_back(command->get_name());
  return with_suggestion(fmt::format("there is no command '{}'", name), name, names);
}

std::string help_text(const CLI::App& command) {
  return HelpFormatter().make_help(&command, {}, CLI::AppFormatMode::Normal);
}

std::string short_help(const CLI::App& app) {
  return fmt::format("Usage: {}{}\n\nCommands:\n{}\nMore by {} help COMMAND.", full_name(app),
                     usage_of_arguments(app), two_columns(command_rows(app)), full_name(app));
}

const CLI::App& chosen_command(const CLI::App& app, std::span<const std::string> arguments) {
  const CLI::App* command = arguments.empty() ? nullptr : find_command(app, arguments.front());
  return command ? chosen_command(*command, arguments.subspan(1)) : app;
}

std::string usage_problem(const CLI::App& app, std::span<const std::string> arguments) {
  if (arguments.empty()) return "a command is missing";
  const std::string& first = arguments.front();
  if (const CLI::App* command = find_command(app, first)) {
    const auto rest = arguments.subspan(1);
    return commands(*command).empty() ? arguments_problem(*command, rest)
                                      : usage_problem(*command, rest);
  }
  if (!first.starts_with('-')) return unknown_command(app, first);
  return app.get_option_no_throw(first) ? "" : unknown_option(app, first);
}

}  // namespace raio::app
