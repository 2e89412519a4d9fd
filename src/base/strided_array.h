// Arrays of structs with their members in separate columns, as in numpy: centres here, radii there,
// and one material for all.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/array.h"

namespace raio::core {

/// The offsets of a struct's separable members, in ascending order; each member extends to the next
/// one. A type without a specialization is one member.
template <class T>
inline constexpr std::array<size_t, 1> kMemberOffsets = {0};

/// An Array, or columns in a caller's memory, read in place: member m of element i is `stride`
/// bytes after that of element i - 1. With stride 0 all elements have one value. Elements are read
/// by value. The first write copies the columns into an Array.
template <class T>
class StridedArray {
  static constexpr size_t kMembers = kMemberOffsets<T>.size();

 public:
  using value_type = T;

  /// The address of the first element's member, and the bytes from one element to the next. It need
  /// not be aligned.
  struct Member {
    const void* first = nullptr;
    ptrdiff_t stride = 0;
  };

  class Iterator {
   public:
    using value_type = T;
    using difference_type = ptrdiff_t;
    using reference = T;
    using iterator_category = std::input_iterator_tag;  // elements are returned by value
    using iterator_concept = std::random_access_iterator_tag;

    Iterator() = default;
    Iterator(const StridedArray& array, size_t i) : array_(&array), i_(i) {}
    T operator*() const { return (*array_)[i_]; }
    T operator[](ptrdiff_t n) const { return *(*this + n); }
    Iterator& operator+=(ptrdiff_t n) {
      i_ += size_t(n);
      return *this;
    }
    Iterator& operator-=(ptrdiff_t n) { return *this += -n; }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this += -1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator operator--(int) { return std::exchange(*this, *this - 1); }
    friend Iterator operator+(Iterator it, ptrdiff_t n) { return it += n; }
    friend Iterator operator+(ptrdiff_t n, Iterator it) { return it += n; }
    friend Iterator operator-(Iterator it, ptrdiff_t n) { return it -= n; }
    friend ptrdiff_t operator-(Iterator a, Iterator b) { return ptrdiff_t(a.i_ - b.i_); }
    friend bool operator==(Iterator a, Iterator b) { return a.i_ == b.i_; }
    friend auto operator<=>(Iterator a, Iterator b) { return a.i_ <=> b.i_; }

   private:
    const StridedArray* array_ = nullptr;
    size_t i_ = 0;
  };
  using const_iterator = Iterator;
  using iterator = T*;

  StridedArray() = default;
  StridedArray(std::initializer_list<T> items) : packed_(items) {}
  StridedArray(std::vector<T> items) : packed_(std::move(items)) {}
  StridedArray(Array<T> items) : packed_(std::move(items)) {}
  StridedArray& operator=(std::initializer_list<T> items) { return *this = StridedArray(items); }

  /// `count` elements, read in place while the array holds `keep`; as an Array if their layout is
  /// that of one.
  static StridedArray borrow(const std::array<Member, kMembers>& members, size_t count,
                             std::shared_ptr<const void> keep) {
    const auto* const first = static_cast<const char*>(members[0].first);
    bool is_array = reinterpret_cast<uintptr_t>(first) % alignof(T) == 0;
    for (size_t m = 0; m < kMembers; ++m)
      is_array &= members[m].first == first + kMemberOffsets<T>[m] &&
                  members[m].stride == ptrdiff_t(sizeof(T));
    if (is_array) return Array<T>::borrow(first, count, std::move(keep));
    StridedArray array;
    array.columns_ = std::make_shared<const Columns>(Columns{members, count, std::move(keep)});
    return array;
  }
  /// One value for all elements, stored once.
  static StridedArray uniform(size_t count, const T& value) {
    auto keep = std::make_shared<const T>(value);
    std::array<Member, kMembers> members{};
    for (size_t m = 0; m < kMembers; ++m)
      members[m].first = reinterpret_cast<const char*>(keep.get()) + kMemberOffsets<T>[m];
    return borrow(members, count, std::move(keep));
  }

  /// The elements as an Array, shared with this array if they are contiguous.
  Array<T> packed() const {
    if (!columns_) return packed_;
    return std::vector<T>(begin(), end());
  }
  /// Whether both read the same memory.
  bool shares(const StridedArray& other) const {
    return columns_ == other.columns_ && packed_.shares(other.packed_);
  }
  bool is_borrowed() const { return columns_ || packed_.is_borrowed(); }
  /// The size of the elements in memory.
  size_t bytes() const {
    if (!columns_) return packed_.size() * sizeof(T);
    size_t sum = 0;
    for (size_t m = 0; m < kMembers; ++m)
      sum += bytes_of(m) * (columns_->members[m].stride == 0 ? 1 : columns_->count);
    return sum;
  }

  size_t size() const { return columns_ ? columns_->count : packed_.size(); }
  bool empty() const { return size() == 0; }
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }
  T operator[](size_t i) const {
    if (!columns_) [[likely]]
      return packed_[i];
    return columns_->at(i, std::make_index_sequence<kMembers>());
  }
  T front() const { return (*this)[0]; }
  T back() const { return (*this)[size() - 1]; }
  /// The address of an element's first member.
  const void* address(size_t i) const {
    if (columns_) return columns_->address(0, i);
    return std::as_const(packed_).data() + i;
  }

  /// The elements as a writable Array.
  Array<T>& writable() {
    if (columns_) {
      packed_ = packed();
      columns_ = nullptr;
    }
    return packed_;
  }
  T* data() { return writable().data(); }
  T* begin() { return writable().begin(); }
  T* end() { return writable().end(); }
  T& operator[](size_t i) { return writable()[i]; }
  T& front() { return writable().front(); }
  T& back() { return writable().back(); }

  void clear() { *this = StridedArray(); }
  void reserve(size_t count) { writable().reserve(count); }
  void resize(size_t count) { writable().resize(count); }
  /// A uniform array stays uniform if `value` is its value, bit by bit.
  void resize(size_t count, const T& value) {
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
    if (empty() || (is_uniform() && std::memcmp(address(0), &value, sizeof(T)) == 0))
      *this = uniform(count, value);
    else
      writable().resize(count, value);
  }
  void assign(size_t count, const T& value) { *this = uniform(count, value); }
  template <std::input_iterator It>
  void assign(It first, It last) {
    *this = Array<T>(std::vector<T>(first, last));
  }
  void push_back(T value) { writable().push_back(value); }
  template <class... Args>
  T& emplace_back(Args&&... args) {
    return writable().emplace_back(std::forward<Args>(args)...);
  }
  void pop_back() { writable().pop_back(); }
  /// Appends the elements of `more`. An empty array shares them.
  void append(const StridedArray& more) {
    if (empty())
      *this = more;
    else
      writable().append(more.packed());
  }

  friend bool operator==(const StridedArray& a, const StridedArray& b)
    requires requires(const T& x) { x == x; }
  {
    return std::ranges::equal(a, b);
  }

 private:
  static constexpr size_t bytes_of(size_t member) {
    const size_t next = member + 1;
    return (next < kMembers ? kMemberOffsets<T>[next] : sizeof(T)) - kMemberOffsets<T>[member];
  }

  struct Columns {
    std::array<Member, kMembers> members;
    size_t count;
    std::shared_ptr<const void> keep;

    const char* address(size_t member, size_t i) const {
      return static_cast<const char*>(members[member].first) +
             ptrdiff_t(i) * members[member].stride;
    }
    template <size_t... m>
    T at(size_t i, std::index_sequence<m...>) const {
      T element;
      (std::memcpy(reinterpret_cast<char*>(&element) + kMemberOffsets<T>[m], address(m, i),
                   bytes_of(m)),
       ...);
      return element;
    }
  };

  bool is_uniform() const { return kMembers == 1 && columns_ && columns_->members[0].stride == 0; }
  Array<T> packed_;  // empty if there are columns
  std::shared_ptr<const Columns> columns_;
};

/// The contiguous elements of either kind of array.
template <class T>
Array<T> packed(const Array<T>& array) {
  return array;
}
template <class T>
Array<T> packed(const StridedArray<T>& array) {
  return array.packed();
}

}  // namespace raio::core
