// Functions of C libraries that few runs need. The library is loaded at the first call, so the
// program starts faster. Code still compiles against its headers.
#pragma once

#include <source_location>
#include <string>
#include <string_view>

#include "base/platform/library.h"

namespace raio::core {

/// The name of a C function, from the compiler's spelling of the template arguments.
template <auto* function>
constexpr std::string_view function_name() {
  std::string_view text = std::source_location::current().function_name();
  text.remove_prefix(text.find("function = ") + 11);
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.find_last_of("&: ") + 1);  // clang has an &, GCC the namespace
}

/// Calls a function of a loaded library.
template <const char* file, auto* function>
decltype(auto) call(auto... arguments) {
  static auto* const found = reinterpret_cast<decltype(function)>(
      library_function(file, std::string(function_name<function>())));
  return found(arguments...);
}

}  // namespace raio::core
