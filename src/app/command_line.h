// The command line: arguments to commands.
#pragma once

#include <initializer_list>
#include <string_view>

#include "app/commands.h"
#include "render/options.h"

namespace CLI {
class App;
}

namespace raio::app {

/// Parses, runs the subcommand, and returns the exit status. Never throws. Without `open_window`,
/// `raio view` becomes the program that has it.
int run_command_line(int argc, char** argv, OpenWindow open_window = nullptr);

/// Gives a command the options of render_option_table() that are `wanted`, or all when it is empty.
void add_render_options(CLI::App& app, RenderOptions& options,
                        std::initializer_list<std::string_view> wanted = {});

}  // namespace raio::app
