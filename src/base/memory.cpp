#include "base/memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <new>
#include <string>

namespace raio {
namespace {

constexpr std::align_val_t kLine{64}, kHugePage{size_t(1) << 21};

std::align_val_t alignment(size_t bytes) {
  return bytes < 2 * size_t(kHugePage) ? kLine : kHugePage;
}

}  // namespace

void* allocate_lines(size_t bytes) {
  void* p = ::operator new(bytes, alignment(bytes));
#ifdef MADV_HUGEPAGE
  // Advice, and as well if it is not taken.
  if (alignment(bytes) == kHugePage) madvise(p, bytes, MADV_HUGEPAGE);
#endif
  return p;
}

void free_lines(void* p, size_t bytes) { ::operator delete(p, alignment(bytes)); }

size_t available_memory_bytes() {
  std::ifstream info("/proc/meminfo");
  for (std::string key; info >> key;
       info.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    size_t kilobytes = 0;
    if (key == "MemAvailable:" && info >> kilobytes) return kilobytes * 1024;
  }
  return size_t(sysconf(_SC_PHYS_PAGES)) * size_t(sysconf(_SC_PAGESIZE));
}

}  // namespace raio
