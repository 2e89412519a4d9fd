// Options of the camera: applies them to the scene's camera, and derives them from a camera.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <string>

#include "render/options.h"

namespace raio::core {
namespace {

// The shortest decimals that read back as the same floats.
Vec3d plain(Vec3f value) {
  Vec3d out(value);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string text = fmt::format("{}", value[axis]);
    double shorter = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), shorter);
    if (read.ec == std::errc() && float(shorter) == value[axis]) out[axis] = shorter;
  }
  return out;
}

// Whether a camera fitted to data must be fitted again for parallel rays.
bool is_refitted(const Camera& camera, const Camera& own) {
  return camera.is_parallel() && !own.is_parallel() && own.horizontal_fov_deg > 0;
}

// Whether the options fit the camera to the scene from another direction.
bool asks_to_turn(const RenderOptions& o, const Camera& own) {
  if (o.from || o.at) return false;
  return o.side || (o.up && *o.up != Vec3d() && (own.horizontal_fov_deg > 0 || o.fit));
}

}  // namespace

Camera camera_of(const Scene& scene, const RenderOptions& options) {
  const Camera& own = scene.camera;
  const bool turns = asks_to_turn(options, own);
  const Fit fit = options.fit.value_or(Fit::all);
  Camera camera = own;
  camera.projection = options.projection.value_or(own.projection);
  if (turns)
    camera =
        fitted_from(scene, camera, options.side,
                    options.up ? Vec3f(*options.up) : nearest_axis(own.up), fit, options.fov_deg);
  else if (options.fit)
    camera = fitted_along(scene, camera, fit, options.fov_deg);
  else if (is_refitted(camera, own) && !options.from && !options.at)
    camera = fitted_in_parallel(scene, camera);
  if (options.from || options.at) camera.movement.reset();
  if (options.from) camera.from = Vec3f(*options.from - scene.origin);
  if (options.at) camera.at = Vec3f(*options.at - scene.origin);
  if (options.up && !turns) camera.up = Vec3f(*options.up);
  // A fitted camera may need a larger angle, for example with parallel rays.
  if (options.fov_deg > 0)
    camera.fov_deg =
        turns || options.fit ? std::max(camera.fov_deg, options.fov_deg) : options.fov_deg;
  return camera;
}

void set_camera(RenderOptions& options, const Camera& camera, const Scene& scene) {
  const Camera& own = scene.camera;
  const auto given = [](bool differs, Vec3f value, Vec3d origin) -> std::optional<Vec3d> {
    if (!differs) return std::nullopt;
    if (origin == Vec3d()) return plain(value);
    return origin + Vec3d(value);
  };
  // A moving scene camera stands still only if a position is given.
  const bool stops = own.movement && !camera.movement;
  // Without both positions, camera_of() would fit the camera again.
  const bool refits =
      is_refitted(camera, own) || (camera.up != own.up && own.horizontal_fov_deg > 0);
  options.side.reset(), options.fit.reset();
  options.from = given(camera.from != own.from || stops || refits, camera.from, scene.origin);
  options.at = given(camera.at != own.at || refits, camera.at, scene.origin);
  options.up = given(camera.up != own.up, camera.up, {});
  // An angle that fits the width depends on the picture's aspect ratio.
  const bool has_own_angle = camera.fov_deg == own.fov_deg && own.horizontal_fov_deg == 0;
  options.fov_deg = has_own_angle || camera.is_omnidirectional() ? 0 : camera.fov_deg;
  options.projection.reset();
  if (camera.projection != own.projection) options.projection = camera.projection;
}

void reset_camera(RenderOptions& options) {
  options.from = options.at = options.up = std::nullopt;
  options.side.reset(), options.fit.reset(), options.projection.reset(), options.fov_deg = 0;
}

}  // namespace raio::core
