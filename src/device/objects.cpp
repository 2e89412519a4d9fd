#include "device/objects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "device/frame.h"
#include "device/world.h"

namespace raio::device {

namespace {

uint64_t combined(uint64_t a, uint64_t b) {
  // SplitMix64 (Steele, Lea and Flood 2014).
  uint64_t x = a * 0x9e3779b97f4a7c15u + b;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

// The system zeroes pages when they are used, so large arrays cost nothing before.
std::shared_ptr<Memory> new_memory(uint64_t bytes) {
  auto memory = std::make_shared<Memory>();
  memory->data = static_cast<const std::byte*>(std::calloc(bytes ? bytes : 1, 1));
  memory->own = true;
  return memory->data ? memory : nullptr;
}

// OVITO, which names the device in a variable of its own, shows the numbers that it gets.
bool means_display_colors() {
  // NOLINTBEGIN(concurrency-mt-unsafe): as in all programs that set no variables
  const char* const asked = std::getenv("RAIO_COLORS");
  return asked ? asked == std::string_view("display")
               : std::getenv("OVITO_ANARI_DEVICE") != nullptr;
  // NOLINTEND(concurrency-mt-unsafe)
}

std::string names_of(const std::vector<DataType>& types) {
  std::string names;
  for (const DataType type : types)
    if (type != DataType::unknown) names += (names.empty() ? "" : ", ") + name_of(type);
  return names;
}

std::string title(const Object& object) {
  return object.subtype.empty() ? name_of(object.type) : object.subtype;
}

}  // namespace

Object::Object(Device& owner, DataType object_type, std::string_view object_subtype)
    : device(owner),
      type(object_type),
      subtype(object_subtype),
      info(object_info(object_type, object_subtype)),
      number_(owner.next_change()) {}

const Value* Object::find(std::string_view name) const {
  const auto found = committed_.find(name);
  return found == committed_.end() ? nullptr : &found->second;
}

core::Vec3d Object::vec3(std::string_view name, const core::Vec3d& otherwise) const {
  const auto v = get(name, std::array{float(otherwise.x), float(otherwise.y), float(otherwise.z)});
  return {double(v[0]), double(v[1]), double(v[2])};
}

bool Object::is_on(std::string_view name, bool otherwise) const {
  const Value* const value = find(name);
  return value ? value->bytes[0] != std::byte() : otherwise;
}

std::string_view Object::word(std::string_view name) const {
  if (const Value* const value = find(name); value && value->type == DataType::string)
    return value->text;
  return info->find(name)->words.front();
}

uint64_t Object::stamp() const {
  uint64_t sum = combined(number_, changed_);
  for (const auto& [name, value] : committed_)
    if (value.object) sum = combined(sum, value.object->stamp());
  return sum;
}

void Object::warn(const std::string& message) const {
  device.report_once(this, Severity::warning, message);
}

Memory::~Memory() {
  if (own)
    std::free(const_cast<std::byte*>(data));
  else if (deleter)
    deleter(user, data);
}

uint64_t Array::bytes() const { return size[0] * size[1] * size[2] * size_of(element); }

Array::Array(Device& owner, DataType array_type, DataType element_type,
             std::array<uint64_t, 3> counts)
    : Object(owner, array_type, ""),
      element(element_type),
      size(counts),
      layout(layout_of(element_type).value_or(Layout{Scalar::uint8, 0})) {}

uint64_t Array::first() const {
  const auto region = get("region", std::array<uint64_t, 2>{0, size[0]});
  return std::min(region[0], size[0]);
}

uint64_t Array::count() const {
  if (type != DataType::array1d) return size[0] * size[1] * size[2];
  const auto region = get("region", std::array<uint64_t, 2>{0, size[0]});
  return std::clamp(region[1], first(), size[0]) - first();
}

std::array<double, 4> Array::vector(uint64_t i) const {
  std::array<double, 4> out = {0, 0, 0, 1};
  const std::byte* const data = at(i);
  for (int k = 0; k < std::min(layout.count, 4); ++k) out[size_t(k)] = number_at(data, layout, k);
  return out;
}

uint64_t Array::stamp() const {
  uint64_t sum = Object::stamp();
  for (const auto& object : objects_)
    if (object) sum = combined(sum, object->stamp());
  return sum;
}

Device::Device(std::function<void(const Message&)> on_message)
    : display_colors(means_display_colors()), on_message_(std::move(on_message)) {}

Device::~Device() {
  // Frames first: they may still render.
  std::erase_if(objects_, [](const auto& entry) { return entry.second->type == DataType::frame; });
}

void Device::report(const Object* source, Severity severity, Status status,
                    const std::string& text) {
  on_message_({source, source ? source->type : DataType::device, severity, status,
               source ? fmt::format("{}: {}", title(*source), text) : text});
}

void Device::report_once(const Object* source, Severity severity, const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    if (!reported_.insert(fmt::format("{}: {}", source ? title(*source) : "", text)).second) return;
  }
  report(source, severity, Status::no_error, text);
}

std::shared_ptr<Object> Device::find_object(const void* handle) {
  const std::lock_guard lock(mutex_);
  const auto found = objects_.find(handle);
  return found == objects_.end() ? nullptr : found->second;
}

Object* Device::create(DataType type, std::string_view subtype) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Object> object;
  if (type == DataType::frame)
    object = std::make_shared<Frame>(*this);
  else if (type == DataType::world)
    object = std::make_shared<World>(*this);
  else
    object = std::make_shared<Object>(*this, type, subtype);
  if (type == DataType::frame || type == DataType::world) readers_.push_back(object);
  if (!object->info)
    report_once(nullptr, Severity::warning,
                fmt::format("{} '{}' is not supported and left out", name_of(type), subtype));
  objects_.emplace(object.get(), object);
  return object.get();
}

Object* Device::create_array(DataType type, const void* memory, Deleter deleter, const void* user,
                             DataType element, std::array<uint64_t, 3> size) {
  const std::lock_guard lock(mutex_);
  const uint64_t bytes = size_of(element);
  constexpr uint64_t kMost = uint64_t(1) << 40;  // bytes; above, a size is taken for a mistake
  uint64_t total = bytes;
  for (const uint64_t n : size) total = n != 0 && total > kMost / n ? kMost : total * n;
  if (bytes == 0 || total >= kMost) {
    report(nullptr, Severity::error, Status::invalid_argument,
           fmt::format("an array of {} x {} x {} elements of {} cannot exist", size[0], size[1],
                       size[2], name_of(element)));
    return nullptr;
  }
  const auto array = std::make_shared<Array>(*this, type, element, size);
  if (memory) {
    array->memory_ = std::make_shared<Memory>();
    array->memory_->data = static_cast<const std::byte*>(memory);
    array->memory_->deleter = deleter, array->memory_->user = user;
    resolve_objects(*array);
  } else {
    array->memory_ = new_memory(total);
    if (!array->memory_) {
      report(nullptr, Severity::error, Status::out_of_memory,
             fmt::format("no memory for an array of {} bytes", total));
      return nullptr;
    }
  }
  array->objects_.resize(is_object(element) ? size[0] * size[1] * size[2] : 0);
  objects_.emplace(array.get(), array);
  return array.get();
}

void Device::resolve_objects(Array& array) {
  if (!is_object(array.element)) return;
  array.objects_.assign(array.size[0] * array.size[1] * array.size[2], nullptr);
  size_t wrong = 0;
  for (size_t i = 0; i < array.objects_.size(); ++i) {
    const void* handle = nullptr;
    std::memcpy(static_cast<void*>(&handle), array.memory_->data + i * sizeof handle,
                sizeof handle);
    const auto object = handle ? find_object(handle) : nullptr;
    // Arrays in arrays mean nothing, and could contain themselves.
    if (object && fits(object->type, array.element) && !is_array(object->type))
      array.objects_[i] = object;
    else if (handle)
      ++wrong;
  }
  if (wrong > 0)
    report(&array, Severity::error, Status::invalid_argument,
           fmt::format("{} of {} elements are no objects of type {}", wrong, array.objects_.size(),
                       name_of(array.element)));
}

void Device::retain(const void* handle) {
  const std::lock_guard lock(mutex_);
  if (const auto object = find(handle, "an object to retain")) ++object->references_;
}

void Device::release(const void* handle) {
  std::shared_ptr<Object> last;  // destroyed without the lock, since a frame waits for its thread
  const std::lock_guard lock(mutex_);
  auto object = find(handle, "an object to release");
  if (!object || --object->references_ > 0) return;
  objects_.erase(handle);
  // Without a deleter, the application may free its memory after the release.
  if (auto* const array = dynamic_cast<Array*>(object.get());
      array && !array->memory_->own && !array->memory_->deleter) {
    if (array->memory_.use_count() > 1) forget_scenes();
    copy_memory(*array);
  }
  last = std::move(object);
}

void Device::forget_scenes() {
  std::erase_if(readers_, [](const auto& reader) { return reader.expired(); });
  for (const auto& reader : readers_)
    if (const auto object = reader.lock()) object->forget();
}

// Whoever reads the old memory keeps it.
void Device::copy_memory(Array& array) {
  auto copy = new_memory(array.bytes());
  if (!copy) throw std::bad_alloc();
  std::memcpy(const_cast<std::byte*>(copy->data), array.memory_->data, array.bytes());
  array.memory_ = std::move(copy);
}

bool Device::check_value(const Object& object, std::string_view name, Value& value,
                         const void* data) {
  const auto refuse = [&](const std::string& text) {
    report(&object, Severity::error, Status::invalid_argument, fmt::format("'{}' {}", name, text));
    return false;
  };
  const size_t bytes = size_of(value.type);
  if (bytes == 0 || bytes > sizeof value.bytes)
    return refuse(fmt::format("has an unknown type, {}", int(value.type)));
  // Of pointers, `data` is the value itself.
  if (value.type == DataType::void_pointer)
    std::memcpy(value.bytes.data(), static_cast<const void*>(&data), sizeof data);
  else if (!data)
    return refuse("has no value");
  else if (value.type == DataType::string)
    value.text = static_cast<const char*>(data);
  else
    std::memcpy(value.bytes.data(), data, bytes);
  if (is_object(value.type)) {
    const void* const handle = value.as<const void*>();
    value.object = handle ? find_object(handle) : nullptr;
    if (!handle) return refuse("is a null object");
    if (!value.object || !fits(value.object->type, value.type))
      return refuse(fmt::format("is no {}, or was released", name_of(value.type)));
    value.type = value.object->type;
  }
  if (!object.info) return false;  // reported at its creation
  const ParameterInfo* const info = object.info->find(name);
  if (!info) {
    report_once(&object, Severity::warning, fmt::format("'{}' is not supported and ignored", name));
    return false;
  }
  const auto expected =
      std::ranges::find_if(info->types, [&](DataType t) { return fits(value.type, t); });
  if (expected == info->types.end()) {
    const std::string names = names_of(info->types);
    return refuse(fmt::format("has type {}, expected {}", name_of(value.type), names));
  }
  if (const auto* const array = dynamic_cast<const Array*>(value.object.get());
      array && !info->elements.empty() &&
      std::ranges::find(info->elements, array->element) == info->elements.end()) {
    const std::string names = names_of(info->elements);
    return refuse(
        fmt::format("has elements of type {}, expected {}", name_of(array->element), names));
  }
  if (value.type == DataType::string && !info->words.empty() && name != "inAttribute" &&
      std::ranges::none_of(info->words,
                           [&](const char* word) { return word && value.text == word; })) {
    std::vector<std::string_view> words;
    for (const char* word : info->words)
      if (word) words.emplace_back(word);
    return refuse(fmt::format("is '{}', expected {}", value.text, fmt::join(words, ", ")));
  }
  if (const auto layout = layout_of(value.type); layout && layout->scalar == Scalar::float32)
    for (int i = 0; i < layout->count; ++i)
      if (const double x = number_at(value.bytes.data(), *layout, i); std::isnan(x))
        return refuse("is not a number");
  return true;
}

void Device::set(const void* handle, std::string_view name, DataType type, const void* value) {
  const std::lock_guard lock(mutex_);
  const auto object = find(handle, fmt::format("an object with the parameter '{}'", name));
  if (!object) return;
  Value checked;
  checked.type = type;
  if (check_value(*object, name, checked, value))
    object->set_.insert_or_assign(std::string(name), std::move(checked));
  else
    object->set_.erase(std::string(name));
}

void Device::unset(const void* handle, std::string_view name) {
  const std::lock_guard lock(mutex_);
  if (const auto object = find(handle, "an object")) object->set_.erase(std::string(name));
}

void Device::unset_all(const void* handle) {
  const std::lock_guard lock(mutex_);
  if (const auto object = find(handle, "an object")) object->set_.clear();
}

void Device::commit(const void* handle) {
  const std::lock_guard lock(mutex_);
  const auto object = find(handle, "an object to commit");
  if (!object) return;
  object->committed_ = object->set_;
  object->changed_ = next_change();
}

void* Device::map(const void* handle) {
  const std::lock_guard lock(mutex_);
  const auto array = find<Array>(handle, "an array to map");
  if (!array) return nullptr;
  if (array->mapped_++ == 0 && array->memory_.use_count() > 1) {
    if (array->memory_->own)
      copy_memory(*array);
    else
      forget_scenes();
  }
  return const_cast<std::byte*>(array->memory_->data);
}

void Device::unmap(const void* handle) {
  const std::lock_guard lock(mutex_);
  const auto array = find<Array>(handle, "an array to unmap");
  if (!array) return;
  if (array->mapped_ == 0)
    return report(array.get(), Severity::error, Status::invalid_operation, "is not mapped");
  if (--array->mapped_ > 0) return;
  array->changed_ = next_change();
  resolve_objects(*array);
}

void* Device::map_parameter(const void* handle, std::string_view name, DataType type,
                            DataType element, std::array<uint64_t, 3> size, uint64_t* stride) {
  const std::lock_guard lock(mutex_);
  const Object* const array = create_array(type, nullptr, nullptr, nullptr, element, size);
  if (!array) return nullptr;
  void* const memory = map(array);
  set(handle, name, type, static_cast<const void*>(&array));
  if (stride) *stride = size_of(element);
  // The parameter holds it; unmap_parameter() finds it there.
  const auto object = find_object(handle);
  const bool held = object && object->set_.contains(name) &&
                    object->set_.find(name)->second.object.get() == array;
  if (!held)
    report(object.get(), Severity::error, Status::invalid_operation,
           fmt::format("'{}' cannot be mapped", name));
  if (!held) release(array);
  return held ? memory : nullptr;
}

void Device::unmap_parameter(const void* handle, std::string_view name) {
  const std::lock_guard lock(mutex_);
  const auto object = find(handle, "an object");
  if (!object) return;
  const auto found = object->set_.find(name);
  const auto array = found == object->set_.end() ? nullptr : found->second.object;
  if (!array || !find_object(array.get()))
    return report(object.get(), Severity::error, Status::invalid_operation,
                  fmt::format("'{}' is not mapped", name));
  unmap(array.get());
  release(array.get());
}

}  // namespace raio::device
