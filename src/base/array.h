// The arrays that a scene is made of: a std::vector, or somebody else's memory read in place (a
// mapped file, an array of numpy), which looks the same to those who read it. Everyone may use it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/platform/memory.h"

namespace raio {

/// Elements one after another. Reading costs what it costs of a std::vector; whatever may change a
/// borrowed array copies it first, and that includes the non-const begin(), data() and operator[].
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  using iterator = T*;
  using const_iterator = const T*;

  Array() = default;
  Array(std::initializer_list<T> items) : own_(items) { see_own(); }
  Array(std::vector<T> items) : own_(std::move(items)) { see_own(); }
  Array(const Array& other) : own_(other.own_), seen_(other.seen_), keep_(other.keep_) {
    if (!other.is_borrowed()) see_own();
  }
  Array(Array&& other) noexcept
      : own_(std::move(other.own_)), seen_(other.seen_), keep_(std::move(other.keep_)) {
    other.clear();
  }
  Array& operator=(const Array& other) {
    if (this != &other) *this = Array(other);
    return *this;
  }
  Array& operator=(Array&& other) noexcept {
    own_ = std::move(other.own_), seen_ = other.seen_, keep_ = std::move(other.keep_);
    other.clear();
    return *this;
  }
  Array& operator=(std::initializer_list<T> items) { return *this = Array(items); }
  ~Array() = default;

  /// `count` elements, each `stride` bytes after the one before, read in place for as long as
  /// `keep` lives. Elements that do not lie one after another, or not where a T may lie, are
  /// gathered into memory of the array's own, once and here: all that reads an array may take it as
  /// contiguous.
  static Array borrow(const void* first, size_t count, std::shared_ptr<const void> keep,
                      ptrdiff_t stride = sizeof(T)) {
    Array array;
    if (stride == ptrdiff_t(sizeof(T)) && reinterpret_cast<uintptr_t>(first) % alignof(T) == 0) {
      array.seen_ = {static_cast<const T*>(first), count};
      array.keep_ = std::move(keep);
      return array;
    }
    array.own_.resize(count);
    const char* const bytes = static_cast<const char*>(first);
    for (size_t i = 0; i < count; ++i)
      std::memcpy(&array.own_[i], bytes + ptrdiff_t(i) * stride, sizeof(T));
    array.see_own();
    return array;
  }
  /// Elements whose bytes are all zero, which take no memory until something changes them, where
  /// the system has such zeroes.
  static Array zeroes(size_t count) {
    if (count == 0) return {};
    const size_t bytes = count * sizeof(T);
    const std::shared_ptr<const void> keep(map_zeroes(bytes),
                                           [bytes](void* zeroes) { unmap_zeroes(zeroes, bytes); });
    return borrow(keep.get(), count, keep);
  }
  /// Does it read memory that is not its own?
  bool is_borrowed() const { return seen_.data() != own_.data(); }

  size_t size() const { return seen_.size(); }
  bool empty() const { return seen_.empty(); }
  const T* data() const { return seen_.data(); }
  const T* begin() const { return seen_.data(); }
  const T* end() const { return seen_.data() + seen_.size(); }
  const T& operator[](size_t i) const { return seen_.data()[i]; }
  /// With std::out_of_range beyond the end.
  const T& at(size_t i) const {
    if (i >= size()) throw std::out_of_range("Array::at");
    return seen_.data()[i];
  }
  const T& front() const { return seen_.front(); }
  const T& back() const { return seen_.back(); }

  T* data() { return own().data(); }
  T* begin() { return own().data(); }
  T* end() { return own().data() + size(); }
  T& operator[](size_t i) { return own().data()[i]; }
  T& front() { return own().front(); }
  T& back() { return own().back(); }

  size_t capacity() const { return own_.capacity(); }
  void reserve(size_t count) {
    change([&] { own_.reserve(count); });
  }
  void resize(size_t count) {
    change([&] { own_.resize(count); });
  }
  void resize(size_t count, T value) {
    change([&] { own_.resize(count, value); });
  }
  void assign(size_t count, T value) { *this = Array(std::vector<T>(count, value)); }
  template <std::input_iterator It>
  void assign(It first, It last) {
    *this = Array(std::vector<T>(first, last));
  }
  void clear() {
    keep_.reset();
    own_.clear();
    see_own();
  }
  // By value: it may be an element of what is borrowed, which a change lets go.
  void push_back(T value) {
    change([&] { own_.push_back(value); });
  }
  template <class... Args>
  T& emplace_back(Args&&... args) {
    change([&] { own_.emplace_back(std::forward<Args>(args)...); });
    return own_.back();
  }
  void pop_back() {
    change([&] { own_.pop_back(); });
  }
  /// As std::vector's, before `where`: elements of elsewhere, or `count` times one.
  template <std::input_iterator It>
  void insert(const T* where, It first, It last) {
    const ptrdiff_t at = where - seen_.data();
    change([&] { own_.insert(own_.begin() + at, first, last); });
  }
  void insert(const T* where, size_t count, T value) {
    const ptrdiff_t at = where - seen_.data();
    change([&] { own_.insert(own_.begin() + at, count, value); });
  }
  void insert(const T* where, std::initializer_list<T> items) {
    insert(where, items.begin(), items.end());
  }

  friend bool operator==(const Array& a, const Array& b)
    requires requires(const T& x) { x == x; }
  {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i)
      if (!(a[i] == b[i])) return false;
    return true;
  }

 private:
  void see_own() { seen_ = {own_.data(), own_.size()}; }
  std::vector<T>& own() {
    if (is_borrowed()) [[unlikely]] {
      own_.assign(seen_.begin(), seen_.end());
      keep_.reset();
      see_own();
    }
    return own_;
  }
  template <class Change>
  void change(const Change& how) {
    own();
    how();
    see_own();
  }

  std::vector<T> own_;  // empty while it borrows
  std::span<const T> seen_;
  std::shared_ptr<const void> keep_;
};

}  // namespace raio
