// Memory laid out for wide loads, and how much of it there is to take. Everyone may use it; the
// latter before large allocations, since systems that promise more than they have end the process
// later instead of refusing now.
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace raio {

/// For std::vector: elements start at a cache line, and new ones are left unset.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, size_t) { ::operator delete(p, kAlignment); }
  template <class U>
  void construct(U* p) {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};

/// One number of many things, as SIMD instructions want it.
template <class T>
using Column = std::vector<T, CacheLineAllocator<T>>;

/// Bytes that can be taken without pushing anything else out, by the system's own estimate.
size_t available_memory_bytes();

/// To be called for much memory that is about to be filled: asks the system for large pages there
/// (Linux: 2 MB, not 4 kB), which come several times faster than small ones.
void use_large_pages(void* begin, size_t bytes);

}  // namespace raio
