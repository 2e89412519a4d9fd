#include "app/version.h"

#include <fmt/format.h>

namespace raio::core::app {

std::string version_text() {
  const Commit built = commit();
  if (built.hash.empty()) return "raio " RAIO_VERSION " (unknown commit)";
  return fmt::format("raio {} ({}{}, {})", RAIO_VERSION, built.hash,
                     built.modified ? " with changes" : "", built.date);
}

}  // namespace raio::core::app
