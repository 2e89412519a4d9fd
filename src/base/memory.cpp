#include "base/memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>

namespace raio {
namespace {

constexpr std::align_val_t kLine{64}, kLargePage{size_t(1) << 21};

std::align_val_t alignment(size_t bytes) {
  return bytes < 2 * size_t(kLargePage) ? kLine : kLargePage;
}

}  // namespace

void* allocate_lines(size_t bytes) {
  void* p = ::operator new(bytes, alignment(bytes));
  if (alignment(bytes) == kLargePage) use_large_pages(p, bytes);
  return p;
}

void free_lines(void* p, size_t bytes) { ::operator delete(p, alignment(bytes)); }

size_t available_memory_bytes() {
  // A stream's first use would cost 0.1 ms, more than reading a small scene.
  char text[512] = {};  // the third line tells
  if (const int info = ::open("/proc/meminfo", O_RDONLY | O_CLOEXEC); info >= 0) {
    const bool is_read = ::read(info, text, sizeof text - 1) > 0;
    ::close(info);
    constexpr std::string_view kKey = "MemAvailable:";
    if (const char* line = is_read ? std::strstr(text, kKey.data()) : nullptr)
      return std::strtoull(line + kKey.size(), nullptr, 10) * 1024;
  }
  return size_t(sysconf(_SC_PHYS_PAGES)) * size_t(sysconf(_SC_PAGESIZE));
}

void use_large_pages(void* begin, size_t bytes) {
  constexpr size_t kLarge = size_t(kLargePage);
  const size_t skip = -reinterpret_cast<uintptr_t>(begin) % kLarge;  // to whole pages
  if (bytes < skip + kLarge) return;
  // Where it is refused, the memory works as before.
  ::madvise(static_cast<char*>(begin) + skip, (bytes - skip) / kLarge * kLarge, MADV_HUGEPAGE);
}

}  // namespace raio
