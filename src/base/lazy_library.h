// Functions of C libraries that few runs of the program want. The library is loaded when it is
// first asked for and not with the program, of whose start it would take a part in every run.
// Everyone may use it; headers of the library are compiled against as ever.
#pragma once

#include <source_location>
#include <string>
#include <string_view>

#include "base/platform/library.h"

namespace raio {

/// The name of a C function: compilers write it where they name the template's arguments.
template <auto* function>
constexpr std::string_view function_name() {
  std::string_view text = std::source_location::current().function_name();
  text.remove_prefix(text.find("function = ") + 11);
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.find_last_of("&: ") + 1);  // clang has an &, GCC the namespace
}

/// Calls a function of a library that has been loaded.
template <const char* file, auto* function>
decltype(auto) call(auto... arguments) {
  static auto* const found = reinterpret_cast<decltype(function)>(
      library_function(file, std::string(function_name<function>())));
  return found(arguments...);
}

}  // namespace raio
