// Standard C++ cannot query the memory of the machine.
#include <cstring>
#include <limits>
#include <new>

#include "base/platform/memory.h"

namespace raio::core {

constexpr std::align_val_t kLine{64};

void* allocate_lines(size_t bytes) { return ::operator new(bytes, kLine); }

void free_lines(void* p, size_t) { ::operator delete(p, kLine); }

void* map_zeroes(size_t bytes, bool) { return std::memset(allocate_lines(bytes), 0, bytes); }

void unmap_zeroes(void* p, size_t bytes) { free_lines(p, bytes); }

AvailableMemory available_memory() { return {std::numeric_limits<size_t>::max(), ""}; }

std::expected<void, std::string> limit_memory(size_t) {
  return std::unexpected("this build cannot limit its memory");
}

void use_large_pages(void*, size_t) {}

size_t peak_memory_bytes() { return 0; }

}  // namespace raio::core
