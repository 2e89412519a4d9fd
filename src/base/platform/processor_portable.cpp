#include "base/platform/processor.h"

namespace raio {

std::string processor_name() { return "unknown processor"; }

}  // namespace raio
