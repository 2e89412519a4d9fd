// Shared libraries loaded on demand. For base/lazy_library.h.
#pragma once

#include <expected>
#include <string>

namespace raio::core {

/// Loads a shared library permanently, by its linker name ("libcairo.so.2"). The error is one line.
std::expected<void, std::string> load_library(const char* file);

/// The address of a function in a loaded library. Throws std::runtime_error if it is missing: the
/// library then has another version than its headers.
void* library_function(const char* file, const std::string& name);

}  // namespace raio::core
