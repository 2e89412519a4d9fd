// Standard C++ cannot load libraries.
#include <stdexcept>

#include "base/platform/library.h"

namespace raio::core {

std::expected<void, std::string> load_library(const char* file) {
  return std::unexpected("cannot load a library, " + std::string(file) +
                         ": this build cannot load libraries; use one with RAIO_POSIX=ON");
}

void* library_function(const char* file, const std::string& name) {
  throw std::runtime_error("no function " + name + ": the library " + file + " is not loaded");
}

}  // namespace raio::core
