// Memory from the system, and how much of it there is to take. Everyone may use it; the latter
// before large allocations, since systems that promise more than they have end the process later
// instead of refusing now. What memory is laid out for is in base/memory.h.
#pragma once

#include <cstddef>
#include <expected>
#include <string>

namespace raio {

/// Memory for `bytes`, at a cache line; large ones in huge pages where the system has them, which
/// it hands out faster and finds faster at random places.
void* allocate_lines(size_t bytes);
void free_lines(void* p, size_t bytes);

/// Zeroes, of which those who use them first pay for the parts that they use, where the system has
/// such; large ones in huge pages, too. Throws std::bad_alloc.
void* map_zeroes(size_t bytes);
void unmap_zeroes(void* p, size_t bytes);

/// Bytes that can be taken without pushing anything else out, by the system's own estimate, and
/// within the limits that this process has. More than any machine has where the system does not
/// tell.
size_t available_memory_bytes();

/// The process gets no more memory than this from now on: what would take it beyond fails with
/// std::bad_alloc. Counted is what it asked for, also where it was never used, without the program
/// itself and its libraries. The error is one line.
std::expected<void, std::string> limit_memory(size_t bytes);

/// To be called for much memory that is about to be filled: asks the system for large pages there
/// (Linux: 2 MB, not 4 kB), which come several times faster than small ones.
void use_large_pages(void* begin, size_t bytes);

/// The largest resident size of this process so far; 0 where the system does not tell.
size_t peak_memory_bytes();

}  // namespace raio
