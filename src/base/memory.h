// Memory laid out for wide loads, and how much of it there is to take. Everyone may use it; the
// latter before large allocations, since systems that promise more than they have end the process
// later instead of refusing now.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace raio {

/// Memory for `bytes`, at a cache line; large ones in huge pages where the system has them, which
/// it hands out faster and finds faster at random places.
void* allocate_lines(size_t bytes);
void free_lines(void* p, size_t bytes);

/// Zeroes, of which those who use them first pay for the parts that they use; large ones in huge
/// pages, too. Throws std::bad_alloc.
void* map_zeroes(size_t bytes);
void unmap_zeroes(void* p, size_t bytes);

/// For std::vector: elements start at a cache line, and new ones are left unset, also those of
/// types with initial values.
template <class T>
struct CacheLineAllocator {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  using value_type = T;

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(size_t n) { return static_cast<T*>(allocate_lines(n * sizeof(T))); }
  void deallocate(T* p, size_t n) { free_lines(p, n * sizeof(T)); }
  template <class U>
  void construct(U*) {}
  template <class U, class... Args>
    requires(sizeof...(Args) > 0)
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};

/// One number of many things, as SIMD instructions want it.
template <class T>
using Column = std::vector<T, CacheLineAllocator<T>>;

/// Bytes that can be taken without pushing anything else out, by the system's own estimate, and
/// within the limits that this process has.
size_t available_memory_bytes();

/// The process gets no more memory than this from now on: what would take it beyond fails with
/// std::bad_alloc. Counted is what it asked for, also where it was never used, without the program
/// itself and its libraries.
void limit_memory(size_t bytes);

/// To be called for much memory that is about to be filled: asks the system for large pages there
/// (Linux: 2 MB, not 4 kB), which come several times faster than small ones.
void use_large_pages(void* begin, size_t bytes);

}  // namespace raio
