// A viewpoint at the side of a sample's rays.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "app/explain.h"
#include "base/exact_math.h"
#include "integrate/camera.h"

namespace raio::core::app {
namespace {

using Kind = ExplainedRay::Kind;

// The points to show: the surfaces hit, and the eye, or a point halfway to it if that would make
// the others too small.
std::vector<Vec3d> points_to_see(const Explanation& sample, const RenderSettings& settings) {
  Box3d hits;
  for (const ExplainedRay& r : sample.rays)
    if (r.hit.found()) hits.extend(Vec3d(r.ray.at(r.hit.t)));
  const ExplainedRay& eye = sample.rays[0];
  const Vec3d from(eye.ray.origin);
  const double way = eye.hit.found() ? double(eye.hit.t) : length(Vec3d(settings.camera.at) - from);
  const Vec3d end = from + Vec3d(eye.ray.dir) * way;
  const bool near = hits.empty() || length(hits.size()) > way / 8;
  std::vector<Vec3d> points = {near ? from : (from + end) * 0.5, end};
  for (int k = 0; k < 8 && !hits.empty(); ++k)
    points.push_back({k & 1 ? hits.hi.x : hits.lo.x, k & 2 ? hits.hi.y : hits.lo.y,
                      k & 4 ? hits.hi.z : hits.lo.z});
  return points;
}

}  // namespace

// The direction of the eye ray, rotated about the vertical, from above; as near as all points
// permit.
SideView side_view(const Explanation& sample, const RenderSettings& settings,
                   double width_per_height) {
  SideView out{.camera = settings.camera};
  const std::vector<Vec3d> points = points_to_see(sample, settings);
  Box3d box;
  for (const Vec3d& p : points) box.extend(p);
  out.extent = length(box.size());
  Camera& camera = out.camera;
  const Vec3d up = normalize(Vec3d(camera.up)), in(sample.rays[0].ray.dir);
  Vec3d flat = in - up * dot(in, up);
  if (length(flat) < 1e-3) flat = Vec3d(EyeRays(camera, 1, 1).right);
  flat = normalize(flat);
  const Vec3d away = normalize(normalize(cross(flat, up)) * 0.85 - flat * 0.5 + up * 0.45);
  const Vec3d forward = away * -1.0, right = normalize(cross(forward, up)),
              above = cross(right, forward);
  camera.at = Vec3f(box.center());
  camera.fov_deg = 40;
  camera.projection = Projection::perspective;
  const double tangent = exact_tan(double(camera.fov_deg) * std::numbers::pi / 360), margin = 0.86;
  double distance = 0;
  for (const Vec3d& p : points) {
    const Vec3d v = p - box.center();
    const double x = std::abs(dot(v, right)) / width_per_height, y = std::abs(dot(v, above));
    distance = std::max(distance, std::max(x, y) / (margin * tangent) - dot(v, forward));
  }
  camera.from = Vec3f(box.center() + away * distance);
  if (!camera_problem(camera).empty()) camera = settings.camera;
  return out;
}

Vec3d drawn_end(const ExplainedRay& r, const std::optional<TraceLog>& log, double extent) {
  const TraceLog::Test* const by = r.kind == Kind::shadow ? stopper(log) : nullptr;
  double t = 0.4 * extent;
  if (r.hit.found()) t = double(r.hit.t);
  if (r.kind == Kind::shadow) t = std::min(double(by ? by->t : r.ray.tmax), 4.0 * extent);
  return Vec3d(r.ray.origin) + Vec3d(r.ray.dir) * t;
}

}  // namespace raio::core::app
