// The arrays of a scene. They are shared, copied on write, and can read memory of a file or a
// caller in place.
#pragma once

#include <algorithm>
#include <atomic>
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

namespace raio::core {

/// Contiguous elements. Copies share them. A write to a copy, or a call of its non-const begin(),
/// data() or operator[], copies the elements first. Reading is as fast as from a std::vector. As
/// with a std::vector, only one thread may change an array; different threads may change arrays
/// that share elements.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  using iterator = T*;
  using const_iterator = const T*;

  Array() = default;
  Array(std::initializer_list<T> items) : Array(items.begin(), items.end()) {}
  Array(std::vector<T> items) {
    if (!items.empty()) own_ = std::make_shared<std::vector<T>>(std::move(items)), see_own();
  }
  template <std::input_iterator It>
  Array(It first, It last) {
    if (first != last) own_ = std::make_shared<std::vector<T>>(first, last), see_own();
  }
  Array(const Array&) = default;
  Array(Array&& other) noexcept
      : own_(std::move(other.own_)),
        seen_(std::exchange(other.seen_, {})),
        keep_(std::move(other.keep_)) {}
  Array& operator=(const Array&) = default;
  Array& operator=(Array&& other) noexcept {
    own_ = std::move(other.own_), seen_ = std::exchange(other.seen_, {});
    keep_ = std::move(other.keep_);
    return *this;
  }
  Array& operator=(std::initializer_list<T> items) { return *this = Array(items); }
  ~Array() = default;

  /// `count` elements, read in place while the array holds `keep`, or copied if they are not
  /// aligned for T.
  static Array borrow(const void* first, size_t count, std::shared_ptr<const void> keep) {
    if (reinterpret_cast<uintptr_t>(first) % alignof(T) != 0) {
      std::vector<T> items(count);
      std::memcpy(items.data(), first, count * sizeof(T));
      return items;
    }
    Array array;
    array.seen_ = {static_cast<const T*>(first), count};
    array.keep_ = std::move(keep);
    return array;
  }
  /// Whether both read the same memory.
  bool shares(const Array& other) const {
    return size() == other.size() && (empty() || data() == other.data());
  }
  /// Whether it reads memory of the caller of borrow().
  bool is_borrowed() const { return !own_ && seen_.data(); }

  size_t size() const { return seen_.size(); }
  size_t bytes() const { return seen_.size_bytes(); }
  bool empty() const { return seen_.empty(); }
  const T* data() const { return seen_.data(); }
  const T* begin() const { return seen_.data(); }
  const T* end() const { return seen_.data() + seen_.size(); }
  const T& operator[](size_t i) const { return seen_.data()[i]; }
  /// Throws std::out_of_range beyond the end.
  const T& at(size_t i) const {
    if (i >= size()) throw std::out_of_range("Array::at");
    return seen_.data()[i];
  }
  const T& front() const { return seen_.front(); }
  const T& back() const { return seen_.back(); }

  const void* address(size_t i) const { return seen_.data() + i; }

  T* data() { return own().data(); }
  T* begin() { return own().data(); }
  T* end() { return own().data() + size(); }
  T& operator[](size_t i) { return own().data()[i]; }
  T& front() { return own().front(); }
  T& back() { return own().back(); }

  size_t capacity() const { return own_ ? own_->capacity() : 0; }
  void reserve(size_t count) {
    change([&](auto& items) { items.reserve(count); });
  }
  void resize(size_t count) {
    change([&](auto& items) { items.resize(count); });
  }
  void resize(size_t count, T value) {
    change([&](auto& items) { items.resize(count, value); });
  }
  void assign(size_t count, T value) { *this = Array(std::vector<T>(count, value)); }
  template <std::input_iterator It>
  void assign(It first, It last) {
    *this = Array(first, last);
  }
  void clear() { *this = Array(); }
  // By value: `value` may be an element of borrowed memory, which a change releases.
  void push_back(T value) {
    change([&](auto& items) { items.push_back(value); });
  }
  template <class... Args>
  T& emplace_back(Args&&... args) {
    change([&](auto& items) { items.emplace_back(std::forward<Args>(args)...); });
    return own_->back();
  }
  /// Appends the elements of `more`. An empty array shares them.
  void append(const Array& more) {
    if (empty())
      *this = more;
    else
      insert(std::as_const(*this).end(), more.begin(), more.end());
  }
  void pop_back() {
    change([](auto& items) { items.pop_back(); });
  }
  /// As std::vector's, before `where`. The range must lie outside this array.
  template <std::input_iterator It>
  void insert(const T* where, It first, It last) {
    const ptrdiff_t at = where - seen_.data();
    change([&](auto& items) { items.insert(items.begin() + at, first, last); });
  }
  void insert(const T* where, size_t count, T value) {
    const ptrdiff_t at = where - seen_.data();
    change([&](auto& items) { items.insert(items.begin() + at, count, value); });
  }
  void insert(const T* where, std::initializer_list<T> items) {
    insert(where, items.begin(), items.end());
  }

  friend bool operator==(const Array& a, const Array& b)
    requires requires(const T& x) { x == x; }
  {
    return std::ranges::equal(a, b);
  }

 private:
  void see_own() { seen_ = *own_; }
  std::vector<T>& own() {
    if (!own_ || own_.use_count() > 1) {
      own_ = std::make_shared<std::vector<T>>(seen_.begin(), seen_.end());
      keep_.reset();
      see_own();
    }
#ifndef __SANITIZE_THREAD__  // which has no fences
    // use_count() is relaxed. Reads of a destroyed copy by other threads must happen before our
    // writes.
    std::atomic_thread_fence(std::memory_order_acquire);
#endif
    return *own_;
  }
  template <class Change>
  void change(const Change& how) {
    how(own());
    see_own();
  }

  std::shared_ptr<std::vector<T>> own_;  // null while it borrows or is empty
  std::span<const T> seen_;
  std::shared_ptr<const void> keep_;
};

}  // namespace raio::core
