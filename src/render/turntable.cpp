#include "render/turntable.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace raio::core {
namespace {

// Taylor series of sine and cosine on -pi/4..pi/4.
std::pair<double, double> sine_and_cosine(double angle) {
  const double square = angle * angle;
  double sine = 1, cosine = 1;
  for (int n = 17; n >= 3; n -= 2) sine = 1 - sine * square / (n * (n - 1));
  for (int n = 18; n >= 2; n -= 2) cosine = 1 - cosine * square / (n * (n - 1));
  return {sine * angle, cosine};
}

// For index / count of a full turn.
std::pair<double, double> turn(int index, int count) {
  // The nearest quarter turn, and the rest in eighths, at most `count`.
  const int64_t part = ((int64_t(index) % count) + count) % count;
  const int64_t quarter = (8 * part + count) / (2 * int64_t(count));
  const double left = double(4 * part - quarter * count) / (4.0 * count);
  const auto [s, c] = sine_and_cosine(2 * std::numbers::pi * left);
  switch (quarter % 4) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace

Camera turntable_camera(const Camera& camera, int index, int count) {
  if (index % count == 0) return camera;
  const auto [sine, cosine] = turn(index, count);
  // Rodrigues' formula.
  const Vec3d axis = normalize(Vec3d(camera.up)), arm = Vec3d(camera.from) - Vec3d(camera.at);
  const Vec3d turned =
      arm * cosine + cross(axis, arm) * sine + axis * (dot(axis, arm) * (1 - cosine));
  Camera out = camera;
  out.from = Vec3f(Vec3d(camera.at) + turned);
  return out;
}

std::filesystem::path numbered_path(const std::filesystem::path& path, int index, int count) {
  const size_t digits = std::max<size_t>(4, fmt::formatted_size("{}", count));
  std::filesystem::path name = path.stem();
  name += fmt::format("-{:0{}}", index + 1, digits);
  name += path.extension();
  return path.parent_path() / name;
}

}  // namespace raio::core
