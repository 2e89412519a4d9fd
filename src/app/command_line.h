// The command line: arguments to commands.
#pragma once

namespace raio::app {

/// Parses, runs the subcommand, and returns the exit status. Never throws.
int run_command_line(int argc, char** argv);

}  // namespace raio::app
