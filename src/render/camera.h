// Eye rays: a pinhole or a thin lens.
#pragma once

#include "base/math.h"
#include "base/ray.h"
#include "scene/scene.h"

namespace raio {

/// Makes the ray through a place on the picture. The angle is vertical, from edge to edge; pixels
/// are square; right is view x up.
class EyeRays {
 public:
  EyeRays(const Camera& camera, int width, int height) : from_(camera.from) {
    const Vec3d forward = normalize(Vec3d(camera.at) - Vec3d(camera.from));
    const Vec3d right = normalize(cross(forward, Vec3d(camera.up)));
    const Vec3d up = cross(right, forward);
    // Rounded to float, so that the last bit of the system's tangent does not matter.
    const float half_height = float(std::tan(double(camera.fov_deg) * kPi / 360));
    const double half_width = double(half_height) * width / height;
    forward_ = Vec3f(forward);
    right_ = Vec3f(right), up_ = Vec3f(up);
    corner_ = Vec3f(forward - right * half_width + up * double(half_height));
    per_x_ = Vec3f(right * (2 * half_width / width));
    per_y_ = Vec3f(up * (-2.0 * half_height / height));
  }

  /// The ray from the eye through (x, y): pixels from the upper left corner of the picture.
  Ray pinhole(float x, float y) const { return {from_, normalize(towards(x, y))}; }

  /// The ray from `lens` (a point of the unit disc, times `radius`) to the point of the plane in
  /// focus that the pinhole would see at (x, y). Cook, Porter and Carpenter 1984, "Distributed Ray
  /// Tracing".
  Ray thin_lens(float x, float y, Point2 lens, float radius, float focus) const {
    const Vec3f offset = right_ * (lens.x * radius) + up_ * (lens.y * radius);
    return {from_ + offset, normalize(towards(x, y) * focus - offset)};
  }

 private:
  // Of length 1 along the view direction.
  Vec3f towards(float x, float y) const { return corner_ + per_x_ * x + per_y_ * y; }

  Vec3f from_, forward_, right_, up_, corner_, per_x_, per_y_;
};

}  // namespace raio
