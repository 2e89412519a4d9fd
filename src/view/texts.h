// The texts of the window in the user's language. The code has the English texts, portuguese.cpp
// the others.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace raio::core::view {

enum class Language : uint8_t { english, portuguese };

/// The language of everything drawn from now on.
void set_language(Language language);
Language language();

/// From a locale's name, as in LC_ALL or LANG: "pt_BR.UTF-8" is Portuguese, unknown ones are
/// English.
Language language_of(std::string_view locale);

/// From LC_ALL, LC_MESSAGES or LANG, whichever is set first.
Language language_of_system();

/// The text in the window's language; English if the table has no entry. Has the lifetime of
/// `english`.
const char* tr(const char* english);

/// A format of the table with its arguments.
template <class... T>
std::string trf(const char* english, T&&... values) {
  return fmt::vformat(tr(english), fmt::make_format_args(values...));
}

/// "1 light", "12.5 k lights".
std::string number_of(size_t count, const char* one, const char* many);

/// English and Portuguese, for tests: there is a line for every text.
std::span<const std::pair<const char*, const char*>> text_table();

}  // namespace raio::core::view
