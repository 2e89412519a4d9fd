// JSON output of all commands.
#pragma once

#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string>

#include "base/vec.h"

namespace raio::core::app {

using Json = nlohmann::ordered_json;

/// Indented, with a final line end; an array of numbers is one line. Invalid UTF-8, as file names
/// and excerpts may contain, is replaced rather than refused.
std::string json_text(const Json& json);

/// The double with the float's shortest digits, so that 0.1f appears as 0.1.
inline double plain(float value) {
  std::array<char, 32> text;
  double result = value;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  std::from_chars(text.data(), end, result);
  return result;
}
inline double plain(double value) { return value; }

inline Vec3d plain(Vec3f v) { return {plain(v.x), plain(v.y), plain(v.z)}; }

}  // namespace raio::core::app
