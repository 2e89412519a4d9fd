// Converts glTF cameras.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "io/mesh/gltf_nodes.h"
#include "io/mesh/gltf_primitive.h"
#include "io/points.h"

namespace raio::core::gltf {

std::optional<Camera> camera_through(const Lens& lens, const Transform& place, const Scene& scene) {
  Camera camera;
  const Vec3d from = place.point({0, 0, 0});
  const Vec3d forward = place.vector({0, 0, -1}), up = place.vector({0, 1, 0});
  const Box3f box = bounds(scene);
  const Vec3d eye = from - scene.origin;
  const Vec3d ahead = forward * (1 / length(forward));
  // The distance to the middle of the visible part, where depth of field focuses.
  const double middle = dot((Vec3d(box.lo) + Vec3d(box.hi)) * 0.5 - eye, ahead);
  const double least = std::max(1e-3 * std::max(1.0, length(from)), lens.half_height);
  camera.from = Vec3f(eye), camera.at = Vec3f(eye + ahead * std::max(middle, least));
  camera.up = unit(up);
  constexpr double kDegrees = 180 / std::numbers::pi;
  double tangent = exact_tan(lens.fov / 2);
  camera.fov_deg = float(lens.fov * kDegrees);
  if (lens.half_height > 0) {
    camera.projection = Projection::orthographic;
    tangent = lens.half_height / length(Vec3d(camera.at) - Vec3d(camera.from));
    camera.fov_deg = float(2 * kDegrees * exact_atan(tangent));
  }
  camera.width = 1200, camera.height = 900;
  if (lens.aspect >= 0.1 && lens.aspect <= 10) {
    // Keeps the horizontal field of view in narrower pictures.
    camera.horizontal_fov_deg = float(2 * kDegrees * exact_atan(tangent * lens.aspect));
    if (lens.aspect > 4.0 / 3)
      camera.height = int(std::lround(1200 / lens.aspect));
    else
      camera.width = int(std::lround(900 * lens.aspect));
  }
  if (!is_place(camera.from) || !is_place(camera.at) || !camera_problem(camera).empty() ||
      !(camera.fov_deg > 0 && camera.fov_deg < 180))
    return std::nullopt;
  return camera;
}

}  // namespace raio::core::gltf
