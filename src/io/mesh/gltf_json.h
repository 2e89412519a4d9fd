// Values of the JSON of a glTF file. Failures are ReadFailure with the JSON pointer (RFC 6901).
// Internal to the reader.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "io/mesh/builder.h"

namespace raio::core::gltf {

using Json = nlohmann::json;

inline constexpr auto kMaxBytes =
    size_t(std::min<uint64_t>(uint64_t(1) << 50, std::numeric_limits<size_t>::max()));

/// Parses JSON; fails with the line and column of a syntax error.
Json parse_json(std::string_view text);

/// Describes a value in messages: "an object", a quoted string, a number.
std::string text_of(const Json& json);

/// A value with its JSON pointer.
class Value {
 public:
  Value(const Json& json, std::string pointer) : json_(&json), pointer_(std::move(pointer)) {}

  const std::string& pointer() const { return pointer_; }
  [[noreturn]] void fail(std::string_view message) const {
    throw ReadFailure{fmt::format("{}: {}", pointer_.empty() ? "/" : pointer_, message)};
  }
  [[noreturn]] void fail_expected(std::string_view what) const {
    fail(fmt::format("expected {}, found {}", what, text_of(*json_)));
  }

  bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
  bool is_object() const { return json_->is_object(); }
  bool is_string() const { return json_->is_string(); }
  Value at(const char* key) const {
    if (!json_->is_object()) fail_expected("an object");
    const auto found = json_->find(key);
    if (found == json_->end()) fail(fmt::format("\"{}\" is missing", key));
    return {*found, pointer_ + "/" + key};
  }
  std::optional<Value> find(const char* key) const {
    if (!json_->is_object()) fail_expected("an object");
    if (!json_->contains(key)) return std::nullopt;
    return at(key);
  }
  std::optional<Value> extension(const char* name) const {
    const auto all = find("extensions");
    return all ? all->find(name) : std::nullopt;
  }

  size_t size() const {
    if (!json_->is_array()) fail_expected("an array");
    return json_->size();
  }
  Value operator[](size_t i) const { return {(*json_)[i], pointer_ + "/" + std::to_string(i)}; }
  template <class F>  // f(key, value)
  void each(const F& f) const {
    if (!json_->is_object()) fail_expected("an object");
    for (const auto& [key, value] : json_->items()) f(key, Value(value, pointer_ + "/" + key));
  }

  size_t whole(size_t least, size_t most) const {
    const double number = json_->is_number() ? json_->get<double>() : -1;
    if (number >= double(least) && number <= double(most) && number == std::floor(number))
      return size_t(number);
    fail_expected(most >= kMaxBytes ? fmt::format("a whole number of at least {}", least)
                                    : fmt::format("a whole number from {} to {}", least, most));
  }
  double number() const {
    if (!json_->is_number()) fail_expected("a number");
    const double number = json_->get<double>();
    if (!std::isfinite(number) || std::abs(number) > 1e30)
      fail_expected("a number between -1e30 and 1e30");
    return number;
  }
  double number(double least, double most) const {
    const double found = number();
    if (found < least || found > most)
      fail_expected(fmt::format("a number from {:g} to {:g}", least, most));
    return found;
  }
  const std::string& string() const {
    if (!json_->is_string()) fail_expected("a string");
    return json_->get_ref<const std::string&>();
  }
  bool truth() const {
    if (!json_->is_boolean()) fail_expected("true or false");
    return json_->get<bool>();
  }
  template <size_t n>
  std::array<double, n> numbers() const {
    if (!json_->is_array() || json_->size() != n) fail_expected(fmt::format("{} numbers", n));
    std::array<double, n> out;
    for (size_t i = 0; i < n; ++i) out[i] = (*this)[i].number();
    return out;
  }

 private:
  const Json* json_;
  std::string pointer_;
};

/// The author's name of an object, else its JSON pointer.
std::string label(const Value& value);

/// An index into an array of `count` elements, named in the message.
uint32_t index_of(const Value& value, const char* array, size_t count);

/// The greatest factor of a light; products of two remain finite.
inline constexpr double kBrightest = 1e15;

/// A number of the object from 0 to `most`, or `usual` if it is missing.
float number_or(float usual, const Value& object, const char* key, double most = 1);
/// A colour, whose components are from 0 to `most`.
Rgb color_or(Rgb usual, const Value& object, const char* key, double most = 1);

/// A byte count of the object, or `usual` if it is missing.
inline size_t bytes_or(const Value& object, const char* key, size_t usual) {
  const auto value = object.find(key);
  return value ? value->whole(0, kMaxBytes) : usual;
}

}  // namespace raio::core::gltf
