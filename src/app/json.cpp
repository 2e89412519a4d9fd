#include "app/json.h"

#include <string_view>

namespace raio::core::app {
namespace {

// The position after the array that starts at `begin`, if it contains only numbers; else `begin`.
size_t end_of_numbers(std::string_view text, size_t begin) {
  const size_t end = text.find_first_not_of("+-.0123456789eE, \n", begin + 1);
  return end < text.size() && text[end] == ']' ? end + 1 : begin;
}

// The same on one line: removes line ends with their indentation between numbers.
std::string on_one_line(std::string_view array) {
  std::string line;
  for (const char c : array)
    if (c != ' ' && c != '\n') line += c == ',' ? std::string(", ") : std::string(1, c);
  return line;
}

}  // namespace

std::string json_text(const Json& json) {
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace);
  std::string out;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted && text[i] == '\\') out += text[i++];  // and the escaped character
    const size_t end = !quoted && text[i] == '[' ? end_of_numbers(text, i) : i;
    if (end > i) {
      out += on_one_line(std::string_view(text).substr(i, end - i));
      i = end - 1;
    } else {
      out += text[i];
    }
  }
  return out + "\n";
}

}  // namespace raio::core::app
