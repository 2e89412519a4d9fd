// The options of a JobRequest that are not of its picture, in one table that feeds the command line
// and the library's settings.
#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "render/job.h"

namespace raio::core {

/// One option of JobRequest.
struct JobOptionSpec {
  std::string_view name;        // --name on the command line
  std::string_view value_name;  // "N"; empty for a switch
  std::string_view help;        // with the default and the unit; settings as in Error::message

  /// Sets it from text ("true" or "false" for a switch); the error says what was expected.
  std::expected<void, std::string> (*set)(JobRequest&, std::string_view);
  /// Its value in the form of set(); empty for the default.
  std::string (*text)(const JobRequest&);

  bool is_switch() const { return value_name.empty(); }
};

/// All of them; the group is OptionGroup::long_renders.
std::span<const JobOptionSpec> job_option_table();

}  // namespace raio::core
