// How much memory there is to take. Everyone may use it, before large allocations: systems that
// promise more than they have end the process later instead of refusing now.
#pragma once

#include <cstddef>

namespace raio {

/// Bytes that can be taken without pushing anything else out, by the system's own estimate.
size_t available_memory_bytes();

/// To be called for much memory that is about to be filled: asks the system for large pages there
/// (Linux: 2 MB, not 4 kB), which come several times faster than small ones.
void use_large_pages(void* begin, size_t bytes);

}  // namespace raio
