// Help texts, and checks of the names of commands and options. Options check their own values.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raio::core::app {

/// Names and descriptions in two columns, 80 characters wide, indented by two.
std::string two_columns(std::span<const std::pair<std::string, std::string>> rows);

/// All of a command's help: --help.
std::string help_text(const CLI::App& command);

/// The same for a command with few options; for others the most common options, on one screen: -h.
std::string brief_help(const CLI::App& command);

/// "unknown command 'rendr'; did you mean render?"
std::string unknown_command(const CLI::App& app, std::string_view name);

/// Usage and commands, for a call without arguments.
std::string list_of_commands(const CLI::App& app);

/// The command named by the first arguments: `app` or one below it.
const CLI::App& chosen_command(const CLI::App& app, std::span<const std::string> arguments);

/// The first error in the arguments (without the program's name): an unknown command or option, a
/// missing argument or one too many. One line, with the nearest known name; empty if there is none.
std::string usage_problem(const CLI::App& app, std::span<const std::string> arguments);

}  // namespace raio::core::app
