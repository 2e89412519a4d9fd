// Memory of the operating system, and how much is available. Ask before large allocations: systems
// that overcommit kill the process later instead of refusing at once. Memory layouts are in
// base/memory.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>

namespace raio::core {

/// Allocates `bytes`, aligned to a cache line. Large blocks use huge pages where available, which
/// are allocated faster and cause fewer TLB misses.
void* allocate_lines(size_t bytes);
void free_lines(void* p, size_t bytes);

/// Zeroed memory; where the system supports it, pages cost nothing until they are used. Large
/// blocks use huge pages, too, unless they stay mostly unused. Throws std::bad_alloc.
void* map_zeroes(size_t bytes, bool is_sparse = false);
void unmap_zeroes(void* p, size_t bytes);

struct AvailableMemory {
  /// Memory available without swapping, by the system's estimate, within the limits of this process
  /// and its container. The largest size_t if unknown.
  size_t bytes = 0;
  std::string within;  // the tightest limit: "the limit of FILE"; empty: the machine's memory

  /// For messages: "1.5 GB of memory are free", with the limit.
  std::string text() const {
    const uint64_t tenths = (uint64_t(bytes) + 50'000'000) / 100'000'000;
    return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10) +
           " GB of memory are free" + (within.empty() ? "" : " within " + within);
  }
};
AvailableMemory available_memory();
inline size_t available_memory_bytes() { return available_memory().bytes; }

/// Limits the memory of this process: allocations beyond it fail with std::bad_alloc. Counts
/// requested memory, used or not, but not the program itself and its libraries. The error is one
/// line.
std::expected<void, std::string> limit_memory(size_t bytes);

/// Call before filling much memory: asks the system for large pages (Linux: 2 MB instead of 4 kB),
/// which are several times faster to obtain.
void use_large_pages(void* begin, size_t bytes);

/// The peak resident size of this process; 0 if unknown.
size_t peak_memory_bytes();

}  // namespace raio::core
