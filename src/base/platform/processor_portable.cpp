#include <limits>

#include "base/platform/processor.h"

namespace raio::core {

std::string processor_name() { return "unknown processor"; }

int usable_cores() { return std::numeric_limits<int>::max(); }

}  // namespace raio::core
