// What the command line says of itself: the help texts, and what is wrong with arguments that name
// what there is not. Values are checked by the options themselves.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raio::app {

/// Names and what they mean in two columns, wrapped at 100, each line indented by two.
std::string two_columns(std::span<const std::pair<std::string, std::string>> rows);

/// Gives the program and its commands their help texts.
class HelpFormatter final : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override;
};

/// The help of this command, also while another one runs; CLI11's own would then be of that.
std::string help_text(const CLI::App& command);

/// "there is no command 'rendr'; did you mean render?"
std::string unknown_command(const CLI::App& app, std::string_view name);

/// For who typed the program's name alone: how it is used, and its commands.
std::string short_help(const CLI::App& app);

/// The command that the first arguments name: `app`, one of its commands, one of theirs.
const CLI::App& chosen_command(const CLI::App& app, std::span<const std::string> arguments);

/// The first thing in the arguments (without the program's name) that `app` has no use for, or
/// that is missing: the command, an option that is none, an argument too many or too few. One line,
/// with the name that may have been meant; empty when there is nothing.
std::string usage_problem(const CLI::App& app, std::span<const std::string> arguments);

}  // namespace raio::app
