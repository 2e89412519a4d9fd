// Eye rays. camera-inl.h computes them for many points of the picture at once, and the thin lens.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "base/exact_math.h"
#include "base/ray.h"
#include "scene/scene.h"

namespace raio::core {

/// The angle is vertical, from edge to edge or between the centres of the outermost pixels: then a
/// picture of n + 1 by n + 1 pixels has its rays at the corners of one of n by n from edge to edge.
/// Pixels are square; right is view x up.
///
/// An omnidirectional picture is equirectangular: x is the azimuth about the up direction, 360
/// degrees from behind over the left, the middle and the right; y the altitude, from 90 degrees to
/// -90.
struct EyeRays {
  bool parallel, omnidirectional;
  Vec3f from;
  Vec3f right, up, forward;  // unit
  // corner + per_x * x + per_y * y leads from the eye to the point at distance 1 along the view on
  // the ray through (x, y); for parallel rays, to its origin; for all directions, near the middle.
  Vec3f corner, per_x, per_y;
  float columns, rows;  // of the picture

  EyeRays(const Camera& camera, int width, int height, bool angle_to_centers = false)
      : parallel(camera.is_parallel()),
        omnidirectional(camera.is_omnidirectional()),
        from(camera.from),
        columns(float(width)),
        rows(float(height)) {
    const Vec3d view = Vec3d(camera.at) - Vec3d(camera.from), ahead = normalize(view);
    const Vec3d to_right = normalize(cross(ahead, Vec3d(camera.up)));
    const Vec3d to_up = cross(to_right, ahead);
    float half_height = float(exact_tan(double(camera.fov_deg) * std::numbers::pi / 360));
    if (angle_to_centers && height > 1) half_height *= float(height) / float(height - 1);
    double half_width = double(half_height) * width / height;
    if (omnidirectional)
      half_height = float(std::numbers::pi / 2), half_width = std::numbers::pi;  // radians
    right = Vec3f(to_right), up = Vec3f(to_up), forward = Vec3f(ahead);
    const double distance = parallel ? length(view) : 1;  // where the picture has this size
    corner = Vec3f((parallel ? Vec3d() : ahead) - to_right * (half_width * distance) +
                   to_up * (double(half_height) * distance));
    per_x = Vec3f(to_right * (2 * half_width * distance / width));
    per_y = Vec3f(to_up * (-2.0 * half_height * distance / height));
    if (const auto& m = camera.movement) {
      const Vec3d view_end = Vec3d(m->at) - Vec3d(m->from);
      movement = Movement{.from_by = Vec3f(Vec3d(m->from) - Vec3d(camera.from)),
                          .view = Vec3f(view),
                          .view_by = Vec3f(view_end - view),
                          .up = camera.up,
                          .begin = m->begin,
                          .end = m->end,
                          .half_width = float(half_width),
                          .half_height = half_height,
                          .pixel = float(2.0 * half_height / height)};
    }
  }

  /// For a moving camera: the values from which the above are computed, in float, for any time. The
  /// above are those at the beginning.
  struct Movement {
    Vec3f from_by, view, view_by;  // at = from + view
    Vec3f up;
    float begin, end;
    float half_width, half_height, pixel;  // of the picture at distance 1
  };
  std::optional<Movement> movement;

  /// The ray without a lens through (x, y), in pixels from the upper left corner of the picture.
  Ray pinhole(float x, float y, float time = 0) const {
    const Vec3f towards = corner + per_x * x + per_y * y;
    if (parallel) return {.origin = from + towards, .dir = forward, .time = time};
    if (omnidirectional) {
      const double azimuth = double(x / columns - 0.5f) * 2 * std::numbers::pi;
      const double altitude = double(0.5f - y / rows) * std::numbers::pi;
      const Vec3d level = Vec3d(forward) * exact_cos(azimuth) + Vec3d(right) * exact_sin(azimuth);
      const Vec3d dir = level * exact_cos(altitude) + Vec3d(up) * exact_sin(altitude);
      return {.origin = from, .dir = normalize(Vec3f(dir)), .time = time};
    }
    return {.origin = from, .dir = normalize(towards), .time = time};
  }
};

/// The eye of the camera at the beginning, for a point that it sees.
inline Vec3d eye_of(const Camera& camera, const Vec3d& point) {
  const Vec3d from(camera.from), forward = normalize(Vec3d(camera.at) - from);
  return camera.is_parallel() ? point - forward * dot(point - from, forward) : from;
}

}  // namespace raio::core
