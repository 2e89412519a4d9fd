// Standard C++ loads no libraries.
#include <stdexcept>

#include "base/platform/library.h"

namespace raio {

std::expected<void, std::string> load_library(const char* file) {
  return std::unexpected("cannot load a library, " + std::string(file) +
                         ": this build loads none; use one with RAIO_POSIX=ON");
}

void* library_function(const char* file, const std::string& name) {
  throw std::runtime_error("no " + name + ": the library " + file + " is not loaded");
}

}  // namespace raio
