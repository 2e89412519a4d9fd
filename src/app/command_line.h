// The command line: arguments to commands.
#pragma once

#include "app/commands.h"

namespace raio::core::app {

/// Parses, runs the subcommand, and returns the exit status. Never throws. Without `open_window`,
/// `raio view` replaces itself by the window's program.
int run_command_line(int argc, char** argv, OpenWindow open_window = nullptr);

}  // namespace raio::core::app
