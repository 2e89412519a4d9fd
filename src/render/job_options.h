// The options of a JobRequest that do not affect its picture, in one table for the command line and
// the library's settings.
#pragma once

#include <span>

#include "render/job.h"
#include "render/option.h"

namespace raio::core {

using JobOptionSpec = OptionEntry<JobRequest>;

/// All of them.
std::span<const JobOptionSpec> job_option_table();

}  // namespace raio::core
