// JSON as all commands write it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace raio::app {

using Json = nlohmann::ordered_json;

/// Indented, with a line end. A file's name or an excerpt may be no valid UTF-8; what is not is
/// replaced rather than refused.
inline std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace raio::app
