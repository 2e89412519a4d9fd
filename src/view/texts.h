// The words on the screen, in the language of whoever looks at it. The English ones stand where
// they are used; one table (texts.cpp) has them in Portuguese.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace raio::view {

enum class Language : uint8_t { english, portuguese };

/// Of everything that is drawn from now on.
void set_language(Language language);
Language language();

/// By a locale's name, as in LC_ALL or LANG: "pt_BR.UTF-8" is Portuguese, all that is unknown
/// English.
Language language_of(std::string_view locale);

/// That of LC_ALL, LC_MESSAGES or LANG, whichever is set first.
Language language_of_system();

/// The text in the language of the screen; English where the table lacks it. Lives for ever if
/// `english` does.
const char* tr(const char* english);

/// A format of the table with its arguments.
template <class... T>
std::string trf(const char* english, T&&... values) {
  return fmt::vformat(tr(english), fmt::make_format_args(values...));
}

/// "1 light", "12.5 k lights".
std::string number_of(size_t count, const char* one, const char* many);

/// English and Portuguese, for tests: every text that is drawn has a line.
std::span<const std::pair<const char*, const char*>> text_table();

}  // namespace raio::view
