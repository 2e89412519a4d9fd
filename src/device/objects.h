// Objects with parameters, and their lifetimes: what an application creates, sets, commits and
// releases. Nothing here knows what they mean.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/vec.h"
#include "device/parameters.h"
#include "device/types.h"

namespace raio::device {

/// ANARI's numbers.
enum class Severity { fatal_error = 1, error, warning, performance_warning, info, debug };
enum class Status { no_error, unknown_error, invalid_argument, invalid_operation, out_of_memory };

class Device;

/// Anything but the device itself. `set` values count from their commit on.
class Object : public std::enable_shared_from_this<Object> {
 public:
  Object(Device& owner, DataType object_type, std::string_view object_subtype);
  virtual ~Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  /// A committed value; null if there is none.
  const Value* find(std::string_view name) const;
  /// A committed number, vector or matrix of floats, or integers; `otherwise` if there is none.
  template <class T>
  T get(std::string_view name, T otherwise) const {
    const Value* const value = find(name);
    return value && size_of(value->type) == sizeof(T) && layout_of(value->type) ? value->as<T>()
                                                                                : otherwise;
  }
  core::Vec3d vec3(std::string_view name, const core::Vec3d& otherwise) const;
  bool is_on(std::string_view name, bool otherwise) const;
  /// A committed word; the first of the accepted ones if there is none.
  std::string_view word(std::string_view name) const;
  /// A committed object of this class; null if there is none.
  template <class T = Object>
  std::shared_ptr<T> object(std::string_view name) const {
    const Value* const value = find(name);
    return value ? std::dynamic_pointer_cast<T>(value->object) : nullptr;
  }
  /// A number that changes if anything changes that this object refers to.
  virtual uint64_t stamp() const;
  /// Stops reading the memory of arrays.
  virtual void forget() {}

  void warn(const std::string& message) const;  ///< once per subtype

  Device& device;
  const DataType type;
  const std::string subtype;
  const ObjectInfo* const info;  ///< null: unknown

 private:
  friend class Device;
  std::map<std::string, Value, std::less<>> set_, committed_;
  uint64_t changed_ = 0;  // the device's count of changes at the last commit
  const uint64_t number_;
  int references_ = 1;  // of the application
};

using Deleter = void (*)(const void* user, const void* memory);

/// Memory of an application, or the device's own.
struct Memory {
  const std::byte* data = nullptr;
  Deleter deleter = nullptr;
  const void* user = nullptr;
  bool own = false;

  ~Memory();
};

/// Elements in one, two or three dimensions, row by row.
class Array final : public Object {
 public:
  Array(Device& owner, DataType array_type, DataType element_type, std::array<uint64_t, 3> counts);

  const DataType element;
  const std::array<uint64_t, 3> size;
  const Layout layout;  ///< of numbers

  /// The elements that count: all, or the region of an ARRAY1D.
  uint64_t first() const;
  uint64_t count() const;
  uint64_t bytes() const;
  const std::byte* at(uint64_t i) const { return memory_->data + (first() + i) * size_of(element); }
  /// Components of an element; missing ones are 0, 0, 0, 1.
  std::array<double, 4> vector(uint64_t i) const;
  /// Whoever holds it may read the elements.
  std::shared_ptr<const Memory> memory() const { return memory_; }
  /// Elements that are objects; null where they are not.
  const std::vector<std::shared_ptr<Object>>& objects() const { return objects_; }

  uint64_t stamp() const override;

 private:
  friend class Device;
  std::shared_ptr<Memory> memory_;
  std::vector<std::shared_ptr<Object>> objects_;
  int mapped_ = 0;
};

/// The objects of one device. Any thread may call it.
class Device {
 public:
  struct Message {
    const Object* source;  ///< null: the device
    DataType source_type;
    Severity severity;
    Status status;
    std::string text;
  };
  explicit Device(std::function<void(const Message&)> on_message);
  ~Device();

  // Handles are addresses of objects. Wrong ones are reported, and the call does nothing else.

  Object* create(DataType type, std::string_view subtype);
  /// Without `memory` the device has its own, which mapping fills. Null if the array is refused.
  Object* create_array(DataType type, const void* memory, Deleter deleter, const void* user,
                       DataType element, std::array<uint64_t, 3> size);
  void retain(const void* handle);
  void release(const void* handle);

  void set(const void* handle, std::string_view name, DataType type, const void* value);
  void unset(const void* handle, std::string_view name);
  void unset_all(const void* handle);
  void commit(const void* handle);
  void* map(const void* handle);
  void unmap(const void* handle);
  /// Creates an array, sets it and maps it.
  void* map_parameter(const void* handle, std::string_view name, DataType type, DataType element,
                      std::array<uint64_t, 3> size, uint64_t* stride);
  void unmap_parameter(const void* handle, std::string_view name);

  /// The object, if it is of the class; an error is reported otherwise.
  template <class T = Object>
  std::shared_ptr<T> find(const void* handle, std::string_view expected) {
    auto found = std::dynamic_pointer_cast<T>(find_object(handle));
    if (!found)
      report(
          nullptr, Severity::error, Status::invalid_argument,
          "expected " + std::string(expected) + ", found another object, or one that was released");
    return found;
  }

  /// Whether applications mean display values (sRGB) by the numbers of colours, not light.
  const bool display_colors;

  void report(const Object* source, Severity severity, Status status, const std::string& text);
  /// The same text about the same subtype only once.
  void report_once(const Object* source, Severity severity, const std::string& text);
  uint64_t next_change() { return ++changes_; }
  std::recursive_mutex& mutex() { return mutex_; }

 private:
  std::shared_ptr<Object> find_object(const void* handle);
  bool check_value(const Object& object, std::string_view name, Value& value, const void* data);
  void forget_scenes();
  static void copy_memory(Array& array);
  void resolve_objects(Array& array);

  std::recursive_mutex mutex_;
  std::function<void(const Message&)> on_message_;
  std::unordered_map<const void*, std::shared_ptr<Object>> objects_;  // that the application holds
  std::vector<std::weak_ptr<Object>> readers_;  // worlds and frames, which read arrays
  std::set<std::string> reported_;
  uint64_t changes_ = 0;
};

}  // namespace raio::device
