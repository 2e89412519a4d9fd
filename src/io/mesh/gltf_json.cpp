#include "io/mesh/gltf_json.h"

#include <algorithm>

namespace raio::core::gltf {

std::string text_of(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_array()) return "an array";
  if (json.is_string()) return core::quoted(json.get_ref<const std::string&>());
  return json.dump();
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
