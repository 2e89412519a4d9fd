// Allocators and arrays for SIMD loads.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/platform/memory.h"

namespace raio::core {

/// An allocator for std::vector: the data starts at a cache line, and new elements are
/// uninitialized, even of types with initial values.
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

/// An array of one component of many elements, for SIMD loads.
template <class T>
using Column = std::vector<T, CacheLineAllocator<T>>;

}  // namespace raio::core
