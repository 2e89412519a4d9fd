// The processor. Highway finds its instruction sets (base/platform/instruction_sets.cpp).
#pragma once

#include <string>

namespace raio::core {

/// The model name of the first processor; "unknown processor" if unavailable.
std::string processor_name();

/// The processor quota of this process's container, in cores, rounded up; the largest int if
/// unlimited.
int usable_cores();

}  // namespace raio::core
