#include "base/error.h"

#include <algorithm>

namespace raio::core {
namespace {

bool is_setting(std::string_view name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
}

}  // namespace

std::string with_settings(std::string_view message, std::string_view before) {
  std::string out;
  while (!message.empty()) {
    const size_t open = message.find('`');
    out += message.substr(0, open);
    if (open == std::string_view::npos) break;
    message.remove_prefix(open + 1);
    const size_t close = message.find('`');
    // Other backquotes belong to the message.
    if (close == std::string_view::npos || !is_setting(message.substr(0, close))) {
      out += '`';
      continue;
    }
    out.append(before).append(message.substr(0, close));
    message.remove_prefix(close + 1);
  }
  return out;
}

std::string Error::text(std::string_view before_settings) const {
  std::string out;
  if (kind == ErrorKind::cannot_read) out += "cannot read ";
  if (kind == ErrorKind::cannot_write) out += "cannot write ";
  if (kind == ErrorKind::bad_option && !subject.empty()) out += before_settings;
  out += subject;
  if (place.line > 0) out += ":" + std::to_string(place.line);
  if (place.column > 0) out += ":" + std::to_string(place.column);
  if (!subject.empty() && !message.empty()) out += ": ";
  out += with_settings(message, before_settings);
  std::ranges::replace_if(out, [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return out;
}

}  // namespace raio::core
