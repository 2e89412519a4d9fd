// How much memory there is to take. Everyone may use it, before large allocations: systems that
// promise more than they have end the process later instead of refusing now.
#pragma once

#include <cstddef>

namespace raio {

/// Bytes that can be taken without pushing anything else out, by the system's own estimate.
size_t available_memory_bytes();

}  // namespace raio
