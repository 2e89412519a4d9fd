#include "view/texts.h"

#include <algorithm>
#include <cstdlib>

#include "app/terminal.h"

namespace raio::core::view {
namespace {

Language g_language = Language::english;

}  // namespace

void set_language(Language language) { g_language = language; }
Language language() { return g_language; }

Language language_of(std::string_view locale) {
  return locale.starts_with("pt") ? Language::portuguese : Language::english;
}

Language language_of_system() {
  for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANG"})
    if (const char* value = std::getenv(name); value && *value)  // NOLINT(concurrency-mt-unsafe)
      return language_of(value);
  return Language::english;
}

const char* tr(const char* english) {
  if (g_language == Language::english) return english;
  const auto lines = text_table();
  const auto found = std::ranges::find_if(
      lines, [&](const auto& line) { return std::string_view(line.first) == english; });
  return found == lines.end() ? english : found->second;
}

std::string number_of(size_t count, const char* one, const char* many) {
  const std::string number =
      count < 100000 ? fmt::format("{}", count) : app::human_count(double(count));
  return number + " " + tr(count == 1 ? one : many);
}

}  // namespace raio::core::view
