#include "app/warnings.h"

#include <fmt/format.h>

#include <cmath>

#include "render/warnings.h"

namespace raio::core::app {
namespace {

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

// Whether the camera fits the whole scene as large as possible. A file's camera does not.
bool shows_all(const Camera& camera, const Scene& scene) {
  if (camera.horizontal_fov_deg <= 0) return false;
  const Camera fitted = fitted_along(scene, camera, Fit::all);
  return length(fitted.from - camera.from) < 0.01f * length(fitted.at - fitted.from);
}

std::optional<std::string> fit_warning(const RenderOptions& options, const Scene& scene) {
  if (options.from || options.at || options.fit == Fit::all) return std::nullopt;
  const bool leaves_out = options.fit == Fit::most;
  if (!leaves_out && !options.side && scene.camera.horizontal_fov_deg <= 0) return std::nullopt;
  const MostOfScene most = most_of(scene);
  constexpr double kMuchSmaller = 3;
  if (!leaves_out && most.shrinks < kMuchSmaller) return std::nullopt;
  const double part = part_outside(scene, most);
  if (part == 0) return std::nullopt;
  const Vec3d center = Vec3d(most.center) + scene.origin;
  const std::string outside =
      fmt::format("{:.2g} % of the scene, farther than {:.3g} from {:.4g},{:.4g},{:.4g}",
                  100 * part, most.radius, center.x, center.y, center.z);
  if (leaves_out) return fmt::format("the camera fit ignores {}", outside);
  if (!options.side && !shows_all(scene.camera, scene)) return std::nullopt;
  return fmt::format(
      "the camera shows everything, including {}, which makes the rest {:.2g} times smaller; --fit "
      "most shows only the rest",
      outside, most.shrinks);
}

}  // namespace

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
            ", which takes about {:.2g} s for this picture, estimated from some tiles", seconds);
    }
    if (warning.focus > 0)
      line += fmt::format("{} --focus {:g}", warning.aperture > 0 ? " or" : "; try", warning.focus);
  }
  return lines;
}

std::vector<std::string> camera_warnings(const RenderOptions& options, const Scene& scene) {
  std::vector<std::string> lines;
  for (const auto& warning : {up_warning(options, scene), fit_warning(options, scene)})
    if (warning) lines.push_back(*warning);
  return lines;
}

}  // namespace raio::core::app
