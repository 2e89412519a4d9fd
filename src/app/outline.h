// Commands and options for help, manual page and completion, read from CLI11's tree.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/options.h"

namespace raio::core::app {

/// "NAME:{auto,grid}": the type that CLI11 stores for an option with a list of words.
std::string value_type(std::string_view value_name, std::span<const std::string_view> words);

/// "NAME" and "auto", "grid" of such a type; "[NAME]" for an option that needs no value.
std::string value_name(const CLI::Option& option);
std::string value_usage(const CLI::Option& option);
std::vector<std::string> value_words(const CLI::Option& option);

bool takes_value(const CLI::Option& option);
bool needs_value(const CLI::Option& option);
bool is_list(const CLI::Option& option);

/// "-o", "--output".
std::vector<std::string> option_names(const CLI::Option& option);

/// The help text of an option up to its first parenthesis, colon or semicolon.
std::string first_clause(const CLI::Option& option);

/// The positional arguments of a command, its other options, and its commands.
std::vector<const CLI::Option*> positionals(const CLI::App& app);
std::vector<const CLI::Option*> named_options(const CLI::App& app);
std::vector<const CLI::App*> commands(const CLI::App& app);

/// The named options by section of the help: first "Options", the command's own, then kOptionGroups
/// (render/options.h).
struct OptionSection {
  std::string_view title;
  std::vector<const CLI::Option*> options;
};
std::vector<OptionSection> option_sections(const CLI::App& app);

/// Options added to `app` between these calls are in this section; others in "Options".
void begin_group(CLI::App& app, OptionGroup group);
void end_groups(CLI::App& app);

/// The command of `app` with this name, or null.
const CLI::App* find_command(const CLI::App& app, std::string_view name);

/// `app` and all commands below it, parents first.
std::vector<const CLI::App*> all_commands(const CLI::App& app);

/// "raio spd verify".
std::string full_name(const CLI::App& command);

/// " SCENE [OPTION ...]", the usage after the name of a command.
std::string usage_of_arguments(const CLI::App& app);

}  // namespace raio::core::app
