// The commands help, version, manual, completion and options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace raio::core::app {

/// Adds these commands, which print to standard output. `app` must have all others already.
void add_manual_commands(CLI::App& app, int& status);

/// The help of all commands, one after the other.
std::string manual_text(const CLI::App& app);

/// The same as a page for man(1), in the macros of man(7).
std::string manual_page(const CLI::App& app);

/// A completion script for the shell "bash", "zsh" or "fish": commands, options, words and files.
std::string completion(const CLI::App& app, std::string_view shell);

/// All options of rendering and reading as JSON (docs/statistics.md).
std::string options_json();

}  // namespace raio::core::app
