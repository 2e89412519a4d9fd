#include "view/camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"

namespace raio::core::view {
namespace {

constexpr double kPoleMargin = 0.01;  // minimum angle between the line of sight and `up`, radians

// Rodrigues' formula.
Vec3d rotated(Vec3d v, Vec3d axis, double angle) {
  const double c = exact_cos(angle), s = exact_sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

// Limits an upward angle so that the line of sight stays short of the poles.
double short_of_poles(const Camera& camera, const CameraAxes& axes, double up_rad) {
  const double pole =
      exact_acos(std::clamp(dot(axes.forward, normalize(Vec3d(camera.up))), -1.0, 1.0));
  return std::clamp(up_rad, std::min(0.0, pole - (std::numbers::pi - kPoleMargin)),
                    std::max(0.0, pole - kPoleMargin));
}

// Rotates a vector as the camera turns.
Vec3d turned(const Camera& camera, const CameraAxes& axes, Vec3d v, double right_rad,
             double up_rad) {
  v = rotated(v, axes.right, short_of_poles(camera, axes, up_rad));
  return rotated(v, normalize(Vec3d(camera.up)), -right_rad);
}

// Unchanged if beyond the range of floats.
Camera placed(const Camera& before, Vec3d from, Vec3d at) {
  Camera camera = before;
  camera.from = Vec3f(from), camera.at = Vec3f(at);
  const bool sound =
      is_finite(camera.from) && is_finite(camera.at) && camera_problem(camera).empty();
  return sound ? camera : before;
}

}  // namespace

CameraAxes::CameraAxes(const Camera& camera)
    : forward(normalize(Vec3d(camera.at) - Vec3d(camera.from))) {
  right = normalize(cross(forward, Vec3d(camera.up)));
  up = cross(right, forward);
}

Camera orbited(const Camera& camera, Vec3d pivot, double right_rad, double up_rad) {
  const CameraAxes axes(camera);
  const auto turn = [&](Vec3f p) {
    return pivot + turned(camera, axes, Vec3d(p) - pivot, -right_rad, -up_rad);
  };
  return placed(camera, turn(camera.from), turn(camera.at));
}

double half_height(const Camera& camera, double depth) {
  if (camera.is_parallel()) depth = length(Vec3d(camera.at) - Vec3d(camera.from));
  return depth * exact_tan(double(camera.fov_deg) * std::numbers::pi / 360);
}

Camera panned(const Camera& camera, double depth, double right, double up) {
  const double height = 2 * half_height(camera, depth);
  return walked(camera, -right * height, -up * height, 0);
}

namespace {

Camera zoomed(Camera camera, Vec3d target, double factor) {
  constexpr double kLeast = 0.001, kMost = 170;  // degrees
  const double before = double(camera.fov_deg) * std::numbers::pi / 360;
  const double after = exact_atan(exact_tan(before) * factor) * 360 / std::numbers::pi;
  camera.fov_deg = float(std::clamp(after, kLeast, kMost));
  factor = exact_tan(double(camera.fov_deg) * std::numbers::pi / 360) / exact_tan(before);
  const CameraAxes axes(camera);
  const Vec3d aside = (target - Vec3d(camera.from)) * (1 - factor);
  return walked(camera, dot(aside, axes.right), dot(aside, axes.up), 0);
}

}  // namespace

Camera dollied(const Camera& camera, Vec3d target, double factor) {
  if (camera.is_parallel()) return zoomed(camera, target, factor);
  const Vec3d move = (target - Vec3d(camera.from)) * (1 - factor);
  const CameraAxes axes(camera);
  // The point looked at moves sideways, too, and keeps its depth while it is in front.
  const double distance = length(Vec3d(camera.at) - Vec3d(camera.from));
  const double ahead = std::max(distance - dot(move, axes.forward), 0.05 * distance);
  const Vec3d from = Vec3d(camera.from) + move;
  return placed(camera, from, from + axes.forward * ahead);
}

Camera walked(const Camera& camera, double right, double up, double forward) {
  const CameraAxes axes(camera);
  const Vec3d move = axes.right * right + axes.up * up + axes.forward * forward;
  return placed(camera, Vec3d(camera.from) + move, Vec3d(camera.at) + move);
}

Camera looked(const Camera& camera, double right_rad, double up_rad) {
  const CameraAxes axes(camera);
  const Vec3d from(camera.from);
  return placed(camera, from,
                from + turned(camera, axes, Vec3d(camera.at) - from, right_rad, up_rad));
}

Camera fitted(const Camera& camera, const Box3f& box, double width_per_height) {
  if (box.empty()) return camera;
  const Vec3d center = Vec3d(box.lo) * 0.5 + Vec3d(box.hi) * 0.5;
  const double radius = std::max(length(Vec3d(box.hi) - center), 1e-6 * length(center) + 1e-12);
  const double half = exact_tan(double(camera.fov_deg) * std::numbers::pi / 360);
  const double least = half * std::min(1.0, width_per_height);
  // Nearer than the radius, parallel rays would start within the scene.
  const double distance = radius * (camera.is_parallel() ? std::max(1 / least, 1.01)
                                                         : 1 / exact_sin(exact_atan(least)));
  return placed(camera, center - CameraAxes(camera).forward * distance, center);
}

}  // namespace raio::core::view
