// The options for reading data files, in one table that feeds the command line, its help and the
// settings of pictures.
#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "io/read_scene.h"
#include "render/options.h"

namespace raio::core {

/// One option of ReadOptions.
struct ReadOptionSpec {
  OptionGroup group;
  std::string_view name;        // --name on the command line
  std::string_view value_name;  // "N"; empty for a switch
  std::string_view help;        // with the default and the unit; settings as in Error::message

  /// Sets it from text ("true" or "false" for a switch); the error says what was expected.
  std::expected<void, std::string> (*set)(ReadOptions&, std::string_view);
  /// Its value in the form of set(); empty for the default.
  std::string (*text)(const ReadOptions&);
  std::span<const std::string_view> words = {};  // NOLINT(readability-redundant-member-init)

  bool is_switch() const { return value_name.empty(); }
};

/// All of them, in the order of the help.
std::span<const ReadOptionSpec> read_option_table();

/// The command-line arguments for these options: " --style sticks --cell".
std::string option_arguments(const ReadOptions& options);

}  // namespace raio::core
