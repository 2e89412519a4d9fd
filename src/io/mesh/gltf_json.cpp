#include "io/mesh/gltf_json.h"

#include <algorithm>

namespace raio::core::gltf {

std::string text_of(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_array()) return "an array";
  if (json.is_string()) return core::quoted(json.get_ref<const std::string&>());
  return json.dump();
}

std::string label(const Value& value) {
  const auto name = value.find("name");
  return name && name->is_string() && !name->string().empty() ? core::quoted(name->string())
                                                              : value.pointer();
}

uint32_t index_of(const Value& value, const char* array, size_t count) {
  if (count == 0) value.fail(fmt::format("it refers to \"{}\", but the file has none", array));
  return uint32_t(value.whole(0, std::min(count, size_t(0xfffffffe)) - 1));
}

float number_or(float usual, const Value& object, const char* key, double most) {
  const auto value = object.find(key);
  return value ? float(value->number(0, most)) : usual;
}

Rgb color_or(Rgb usual, const Value& object, const char* key, double most) {
  const auto value = object.find(key);
  if (!value) return usual;
  if (value->size() != 3) value->fail_expected("3 numbers");
  const auto part = [&](size_t i) { return float((*value)[i].number(0, most)); };
  return {part(0), part(1), part(2)};
}

Json parse_json(std::string_view text) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::string_view before = text.substr(0, std::min(error.byte, text.size()));
    const auto line = int(std::ranges::count(before, '\n')) + 1;
    const size_t start = before.rfind('\n') + 1;  // 0 in the first line
    std::string_view why = error.what();
    // Drop the library's own prefix with its location.
    if (const size_t colon = why.find(": "); colon != std::string_view::npos)
      why.remove_prefix(colon + 2);
    std::string plain(why);
    for (char& c : plain)
      if (uint8_t(c) < 32 || uint8_t(c) >= 127) c = '?';
    throw ReadFailure{"broken JSON: " + plain, line, std::max(1, int(before.size() - start))};
  } catch (const Json::out_of_range&) {
    throw ReadFailure{"broken JSON: a number is too large"};
  }
}

}  // namespace raio::core::gltf
