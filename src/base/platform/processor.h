// What the machine computes with. Which instructions it has is Highway's to ask
// (base/platform/instruction_sets.cpp).
#pragma once

#include <string>

namespace raio {

/// The model name of the first processor; "unknown processor" where the system does not tell.
std::string processor_name();

}  // namespace raio
