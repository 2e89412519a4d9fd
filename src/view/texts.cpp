#include "view/texts.h"

#include <algorithm>
#include <array>

#include "app/terminal.h"

namespace raio::view {
namespace {

Language g_language = Language::english;

constexpr auto kTexts = std::to_array<std::pair<const char*, const char*>>({
    {"antialiasing", "antialiasing"},
});

}  // namespace

void set_language(Language language) { g_language = language; }
Language language() { return g_language; }

Language language_of(std::string_view locale) {
  return locale.starts_with("pt") ? Language::portuguese : Language::english;
}

const char* tr(const char* english) {
  if (g_language == Language::english) return english;
  const auto found = std::ranges::find_if(
      kTexts, [&](const auto& line) { return std::string_view(line.first) == english; });
  return found == kTexts.end() ? english : found->second;
}

std::string number_of(size_t count, const char* one, const char* many) {
  const std::string number =
      count < 100000 ? fmt::format("{}", count) : app::human_count(double(count));
  return number + " " + tr(count == 1 ? one : many);
}

std::span<const std::pair<const char*, const char*>> text_table() { return kTexts; }

}  // namespace raio::view
