#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>

#include "base/platform/cgroup.h"
#include "base/platform/memory.h"

namespace raio::core {
namespace {

constexpr std::align_val_t kLine{64}, kLargePage{size_t(1) << 21};

std::align_val_t alignment(size_t bytes) { return bytes < size_t(kLargePage) ? kLine : kLargePage; }

size_t mapped_size(size_t bytes) {
  const size_t page =
      bytes < size_t(kLargePage) ? size_t(sysconf(_SC_PAGESIZE)) : size_t(kLargePage);
  return (bytes + page - 1) / page * page;
}

// The beginning of a file in /proc. The first use of a stream would cost 0.1 ms, more than reading
// a small scene.
std::array<char, 512> read_start(const char* path) {
  std::array<char, 512> text{};
  if (const int file = ::open(path, O_RDONLY | O_CLOEXEC); file >= 0) {
    if (::read(file, text.data(), text.size() - 1) < 0) text[0] = 0;
    ::close(file);
  }
  return text;
}

size_t free_memory_bytes() {
  const auto text = read_start("/proc/meminfo");  // MemAvailable is the third line
  constexpr std::string_view kKey = "MemAvailable:";
  if (const char* line = std::strstr(text.data(), kKey.data()))
    return std::strtoull(line + kKey.size(), nullptr, 10) * 1024;
  return size_t(sysconf(_SC_PHYS_PAGES)) * size_t(sysconf(_SC_PAGESIZE));
}

// The memory that RLIMIT_DATA counts.
size_t data_bytes() {
  auto text = read_start("/proc/self/statm");
  char* at = text.data();
  unsigned long long pages = 0;
  for (int field = 0; field < 6; ++field) pages = std::strtoull(at, &at, 10);
  return size_t(pages) * size_t(sysconf(_SC_PAGESIZE));
}

}  // namespace

void* allocate_lines(size_t bytes) {
  void* p = ::operator new(bytes, alignment(bytes));
  if (alignment(bytes) == kLargePage) use_large_pages(p, bytes);
  return p;
}

void free_lines(void* p, size_t bytes) { ::operator delete(p, alignment(bytes)); }

void* map_zeroes(size_t bytes, bool is_sparse) {
  const size_t size = mapped_size(bytes), large = size_t(kLargePage);
  const size_t spare = size < large || is_sparse ? 0 : large;  // to align to a large page
  void* const map =
      ::mmap(nullptr, size + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (map == MAP_FAILED) throw std::bad_alloc();
  if (spare == 0) return map;
  char* const before = static_cast<char*>(map);
  char* const begin = before + -reinterpret_cast<uintptr_t>(map) % large;
  if (begin > before) ::munmap(before, size_t(begin - before));
  ::munmap(begin + size, spare - size_t(begin - before));
  use_large_pages(begin, size);
  return begin;
}

void unmap_zeroes(void* p, size_t bytes) { ::munmap(p, mapped_size(bytes)); }

AvailableMemory available_memory() {
  AvailableMemory available{free_memory_bytes(), ""};
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    const size_t used = data_bytes(), whole = size_t(limit.rlim_cur);
    if (const size_t left = whole > used ? whole - used : 0; left < available.bytes)
      available = {left, "the limit of this process (RLIMIT_DATA)"};
  }
  static const ControlGroups groups;  // to which a process belongs as long as it runs
  if (const auto left = groups.memory(); left && left->available < available.bytes)
    available = {left->available, "the limit of " + left->file};
  return available;
}

std::expected<void, std::string> limit_memory(size_t bytes) {
  rlimit limit{};
  bool done = ::getrlimit(RLIMIT_DATA, &limit) == 0;
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  done = done && ::setrlimit(RLIMIT_DATA, &limit) == 0;
  if (done) return {};
  return std::unexpected("the system does not limit memory: " +
                         std::generic_category().message(errno));
}

void use_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] size_t bytes) {
#ifdef MADV_HUGEPAGE  // Linux's
  constexpr size_t kLarge = size_t(kLargePage);
  const size_t skip = -reinterpret_cast<uintptr_t>(begin) % kLarge;  // to whole pages
  if (bytes < skip + kLarge) return;
  // If refused, the memory still works.
  ::madvise(static_cast<char*>(begin) + skip, (bytes - skip) / kLarge * kLarge, MADV_HUGEPAGE);
#endif
}

size_t peak_memory_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__  // in bytes, not in KiB
  return size_t(usage.ru_maxrss);
#else
  return size_t(usage.ru_maxrss) * 1024;
#endif
}

}  // namespace raio::core
