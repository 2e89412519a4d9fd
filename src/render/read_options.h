// The options for reading data files, in one table that feeds the command line, its help and the
// settings of pictures.
#pragma once

#include <span>
#include <string>

#include "io/read_scene.h"
#include "render/option.h"

namespace raio::core {

using ReadOptionSpec = OptionEntry<ReadOptions>;

/// All of them, in the order of the help.
std::span<const ReadOptionSpec> read_option_table();
/// The entry with this name, which must exist.
const ReadOptionSpec& read_option_of(std::string_view name);

/// The command-line arguments for these options: " --style sticks --cell".
std::string option_arguments(const ReadOptions& options);

}  // namespace raio::core
