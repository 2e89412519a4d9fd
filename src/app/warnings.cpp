#include "app/warnings.h"

#include <fmt/format.h>

#include <cmath>

#include "render/warnings.h"

namespace raio::app {

std::vector<std::string> warning_lines(const Scene& scene, const RenderSettings& settings,
                                       const Accel* accel, bool tries_tree) {
  std::vector<std::string> lines;
  for (const SceneWarning& warning : scene_warnings(scene, settings, accel)) {
    std::string& line = lines.emplace_back(warning.sentence);
    if (warning.aperture > 0) line += fmt::format("; try --aperture {:g}", warning.aperture);
    if (warning.kind == SceneWarning::no_tree) {
      line += "; try --accel bvh";
      const double seconds = tries_tree ? seconds_with_tree(scene, settings) : 0;
      if (seconds > 0)
        line += fmt::format(
            ", which takes about {:.2g} s for this picture, by a trial of some tiles", seconds);
    }
    if (warning.focus > 0)
      line += fmt::format("{} --focus {:g}", warning.aperture > 0 ? " or" : "; try", warning.focus);
  }
  return lines;
}

std::optional<std::string> up_warning(const RenderOptions& options, const Scene& scene) {
  if (!options.side || options.up) return std::nullopt;
  const Camera& camera = scene.camera;
  const Vec3f up = nearest_axis(camera.up);
  constexpr float kUpright = 1e-3f;  // sine of the angle between the horizon and the picture's rows
  if (std::abs(dot(normalize(cross(camera.at - camera.from, camera.up)), up)) < kUpright)
    return std::nullopt;
  const int axis = up.x != 0 ? 0 : up.y != 0 ? 1 : 2;
  return fmt::format(
      "up is guessed as {}{}, the axis nearest to the up direction of the scene's camera; --up "
      "gives another",
      up[axis] < 0 ? "-" : "", "xyz"[axis]);
}

}  // namespace raio::app
