#include "base/memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace raio {

size_t available_memory_bytes() {
  std::ifstream info("/proc/meminfo");
  for (std::string key; info >> key;
       info.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    size_t kilobytes = 0;
    if (key == "MemAvailable:" && info >> kilobytes) return kilobytes * 1024;
  }
  return size_t(sysconf(_SC_PHYS_PAGES)) * size_t(sysconf(_SC_PAGESIZE));
}

void use_large_pages(void* begin, size_t bytes) {
  constexpr size_t kLarge = size_t(1) << 21;
  const size_t skip = -reinterpret_cast<uintptr_t>(begin) % kLarge;  // to whole pages
  if (bytes < skip + kLarge) return;
  // Where it is refused, the memory works as before.
  ::madvise(static_cast<char*>(begin) + skip, (bytes - skip) / kLarge * kLarge, MADV_HUGEPAGE);
}

}  // namespace raio
