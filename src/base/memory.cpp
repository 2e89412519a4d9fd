#include "base/memory.h"

#include <unistd.h>

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

}  // namespace raio
