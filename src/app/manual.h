// The program describing itself: the commands help, version, manual and completion.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace raio::app {

/// Adds the four commands; what they print goes to standard output. To be called last, when `app`
/// has all others.
void add_manual_commands(CLI::App& app, int& status);

/// Everything that help says of all commands, one after the other.
std::string manual_text(const CLI::App& app);

/// The same as a page of section 1 for man(1), in the macros of man(7).
std::string manual_page(const CLI::App& app);

/// A script for the shell "bash", "zsh" or "fish" that completes commands, options, their words,
/// and names of files.
std::string completion(const CLI::App& app, std::string_view shell);

}  // namespace raio::app
