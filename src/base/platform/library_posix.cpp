#include <dlfcn.h>

#include <stdexcept>

#include "base/platform/library.h"

namespace raio::core {

std::expected<void, std::string> load_library(const char* file) {
  if (::dlopen(file, RTLD_NOW)) return {};
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the error is per thread
  return std::unexpected("cannot load a library, " + std::string(::dlerror()) +
                         "; install its package (on Debian: libembree3-3, libcairo2, librsvg2-2)");
}

void* library_function(const char* file, const std::string& name) {
  void* const library = ::dlopen(file, RTLD_NOW | RTLD_NOLOAD);
  void* const function = library ? ::dlsym(library, name.c_str()) : nullptr;
  if (!function) throw std::runtime_error("no function " + name + " in the library " + file);
  return function;
}

}  // namespace raio::core
