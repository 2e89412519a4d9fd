// The commands of the program and their options as they are described to people: what help, the
// manual page and completion have in common. All of it is read from CLI11's tree, where it is said
// once.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raio::app {

/// The text that CLI11 keeps with an option whose value is one of some words: "NAME:{auto,grid}".
std::string value_type(std::string_view value_name, std::span<const std::string_view> words);

/// "NAME" of it, and "auto", "grid".
std::string value_name(const CLI::Option& option);
std::vector<std::string> value_words(const CLI::Option& option);

bool takes_value(const CLI::Option& option);
bool is_list(const CLI::Option& option);

/// "-o", "--output".
std::vector<std::string> option_names(const CLI::Option& option);

/// The arguments of a command that have no name, in order; the options that have one; the commands
/// of a command.
std::vector<const CLI::Option*> positionals(const CLI::App& app);
std::vector<const CLI::Option*> named_options(const CLI::App& app);
std::vector<const CLI::App*> commands(const CLI::App& app);

/// The command of `app` with this name, or null.
const CLI::App* find_command(const CLI::App& app, std::string_view name);

/// `app` and all commands below it, each before its own.
std::vector<const CLI::App*> all_commands(const CLI::App& app);

/// "raio spd verify".
std::string full_name(const CLI::App& command);

/// " SCENE [OPTION ...]": what follows the name of a command.
std::string usage_of_arguments(const CLI::App& app);

}  // namespace raio::app
