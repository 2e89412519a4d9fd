// The processor. Highway finds its instruction sets (base/platform/instruction_sets.cpp).
#pragma once

#include <string>

namespace raio::core {

/// The model name of the first processor; "unknown processor" if unavailable.
std::string processor_name();

/// How many cores' time the container of this process has, rounded up; more than any machine has
/// where none limits it.
int usable_cores();

}  // namespace raio::core
