#include "app/warnings.h"

#include <fmt/format.h>

#include "render/warnings.h"

namespace raio::app {

std::vector<std::string> warning_lines(const Scene& scene, const RenderSettings& settings,
                                       const Accel* accel) {
  std::vector<std::string> lines;
  for (const SceneWarning& warning : scene_warnings(scene, settings, accel)) {
    std::string& line = lines.emplace_back(warning.sentence);
    if (warning.aperture > 0) line += fmt::format("; try --aperture {:g}", warning.aperture);
    if (warning.focus > 0)
      line += fmt::format("{} --focus {:g}", warning.aperture > 0 ? " or" : "; try", warning.focus);
  }
  return lines;
}

}  // namespace raio::app
