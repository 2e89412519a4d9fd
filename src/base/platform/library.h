// Shared libraries that are loaded when they are wanted. For base/lazy_library.h.
#pragma once

#include <expected>
#include <string>

namespace raio {

/// Loads a shared library for good, by its name as the linker has it ("libcairo.so.2"). The error
/// is one line.
std::expected<void, std::string> load_library(const char* file);

/// The address of a function of a library that has been loaded. Throws std::runtime_error if there
/// is none: then it is not the version that was compiled against.
void* library_function(const char* file, const std::string& name);

}  // namespace raio
