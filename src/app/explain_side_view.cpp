// A viewpoint at the side of a sample's rays, and the camera and lights as objects.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "app/explain.h"
#include "base/exact_math.h"
#include "integrate/camera.h"
#include "shape/movement.h"

namespace raio::core::app {
namespace {

using Kind = ExplainedRay::Kind;

// In extents of eye and hits: lights further away would make these too small, and are drawn at the
// end of a ray of the other length.
constexpr double kNearLights = 1.5, kFarLight = 0.5;
// Of the way from the eye to the hit: where the image plane is drawn.
constexpr double kImagePlane = 0.25;

Camera at_rest(Camera camera, float time) {
  if (!camera.movement) return camera;
  const CameraMovement m = *camera.movement;
  const double part = part_moved(m.begin, m.end, time);
  camera.from = Vec3f(between(camera.from, m.from, part));
  camera.at = Vec3f(between(camera.at, m.at, part));
  camera.movement.reset();
  return camera;
}

// The eye and the surfaces hit; for a ray that hits nothing, a point ahead.
Box3d box_of(const Explanation& sample, const Camera& camera) {
  const ExplainedRay& eye = sample.rays[0];
  Box3d box;
  box.extend(Vec3d(eye.ray.origin));
  for (const ExplainedRay& r : sample.rays)
    if (r.hit.found()) box.extend(Vec3d(r.ray.at(r.hit.t)));
  if (!eye.hit.found())
    box.extend(Vec3d(eye.ray.origin) +
               Vec3d(eye.ray.dir) * length(Vec3d(camera.at) - Vec3d(camera.from)));
  return box;
}

void place_camera(SideView& out, const Explanation& sample, const RenderSettings& settings,
                  const Camera& camera, std::array<int, 2> pixel) {
  const ExplainedRay& eye = sample.rays[0];
  const EyeRays rays(camera, settings.width, settings.height, settings.angle_to_centers);
  const double way = eye.hit.found() ? double(eye.hit.t) : out.extent;
  const double distance = rays.parallel ? 1 : kImagePlane * way;
  const Vec3d from(rays.from);
  const auto at = [&](double x, double y) {
    if (rays.omnidirectional) return from + Vec3d(rays.pinhole(float(x), float(y)).dir) * distance;
    return from + (Vec3d(rays.corner) + Vec3d(rays.per_x) * x + Vec3d(rays.per_y) * y) * distance;
  };
  const double w = settings.width, h = settings.height;
  out.image = {at(0, 0), at(w, 0), at(w, h), at(0, h)};
  const double x = pixel[0] + 0.5, y = pixel[1] + 0.5, half = std::max(0.5, h / 30);
  out.pixel = {at(x - half, y - half), at(x + half, y - half), at(x + half, y + half),
               at(x - half, y + half)};
  out.eye = rays.parallel ? Vec3d(eye.ray.origin) : from;
  out.is_parallel = rays.parallel;
}

void place_lights(SideView& out, const Explanation& sample, const RenderSettings& settings,
                  const Vec3d& center) {
  for (size_t l = 0; l < sample.lights.size(); ++l) {
    const auto ray = std::ranges::find(sample.rays, int(l), &ExplainedRay::light);
    if (ray == sample.rays.end()) continue;
    const PreparedScene::Emitter& emitter = sample.lights[l];
    const Vec3d at(emitter.position);
    SideView::Light light{.number = int(l), .at = at};
    if (length(at - center) > kNearLights * out.extent) {
      light.at = Vec3d(ray->ray.origin) + Vec3d(ray->ray.dir) * (kFarLight * out.extent);
      light.towards = normalize(at - light.at);
    } else if (settings.soft_shadows) {
      const Vec3d u = Vec3d(emitter.edge_u) * 0.5, v = Vec3d(emitter.edge_v) * 0.5;
      light.corners = {at - u - v, at + u - v, at + u + v, at - u + v};
    }
    out.lights.push_back(std::move(light));
  }
}

std::vector<Vec3d> points_to_see(const SideView& view, const Box3d& box,
                                 const Explanation& sample) {
  std::vector<Vec3d> points = {view.eye};
  for (const ExplainedRay& r : sample.rays)
    if (r.hit.found()) points.emplace_back(r.ray.at(r.hit.t));
  for (const Vec3d& corner : {box.lo, box.hi}) points.push_back(corner);
  std::ranges::copy(view.image, std::back_inserter(points));
  for (const SideView::Light& light : view.lights) {
    points.push_back(light.at);
    std::ranges::copy(light.corners, std::back_inserter(points));
  }
  points.emplace_back(sample.rays[0].ray.origin);
  return points;
}

// Moves the camera, which looks along `forward`, to the nearest place from which it sees all of
// the points, with a margin. The left and right planes of the view give the least distance and the
// sideways position, the upper and lower planes another least distance and the height.
void move_to_see(Camera& camera, const std::vector<Vec3d>& points, const Vec3d& forward,
                 double extent, double width_per_height) {
  const Vec3d right = normalize(cross(forward, Vec3d(camera.up))), above = cross(right, forward);
  constexpr double kMargin = 0.84;
  const double tangent = kMargin * exact_tan(double(camera.fov_deg) * std::numbers::pi / 360);
  const auto least = [&](const Vec3d& axis, double sign, double slope) {
    double most = -1e300;
    for (const Vec3d& p : points)
      most = std::max(most, sign * dot(p, axis) - slope * dot(p, forward));
    return most;
  };
  const double across = tangent * width_per_height;
  const double a = least(right, 1, across), b = least(right, -1, across);
  const double c = least(above, 1, tangent), d = least(above, -1, tangent);
  double nearest = 1e300, farthest = -1e300;
  for (const Vec3d& p : points) {
    nearest = std::min(nearest, dot(p, forward));
    farthest = std::max(farthest, dot(p, forward));
  }
  const double back =
      std::min({-(a + b) / (2 * across), -(c + d) / (2 * tangent), nearest - 0.1 * extent});
  const Vec3d from = right * ((a - b) / 2) + above * ((c - d) / 2) + forward * back;
  camera.from = Vec3f(from);
  camera.at = Vec3f(from + forward * ((nearest + farthest) / 2 - back));
}

}  // namespace

// The direction of the eye ray, rotated about the vertical, from above.
SideView side_view(const Explanation& sample, const RenderSettings& settings,
                   std::array<int, 2> pixel, double width_per_height) {
  SideView out;
  const Camera eye = at_rest(settings.camera, sample.rays[0].ray.time);
  const Box3d box = box_of(sample, eye);
  out.extent = length(box.size());
  place_camera(out, sample, settings, eye, pixel);
  place_lights(out, sample, settings, box.center());

  Camera& camera = out.camera;
  camera.up = eye.up;
  const Vec3d up = normalize(Vec3d(eye.up)), in(sample.rays[0].ray.dir);
  Vec3d flat = in - up * dot(in, up);
  if (length(flat) < 1e-3) flat = Vec3d(EyeRays(eye, 1, 1).right);
  flat = normalize(flat);
  const Vec3d away = normalize(normalize(cross(flat, up)) * 0.85 - flat * 0.5 + up * 0.45);
  camera.fov_deg = 40;
  move_to_see(camera, points_to_see(out, box, sample), -away, out.extent, width_per_height);
  if (!camera_problem(camera).empty()) camera = eye;
  return out;
}

Vec3d drawn_end(const ExplainedRay& r, const std::optional<TraceLog>& log, const SideView& view) {
  const Vec3d from(r.ray.origin), dir(r.ray.dir);
  double t = 0.4 * view.extent;
  if (r.hit.found()) t = double(r.hit.t);
  if (r.kind == Kind::shadow) {
    const TraceLog::Test* const by = stopper(log);
    t = double(by ? by->t : r.ray.tmax);
    for (const SideView::Light& light : view.lights)
      if (light.number == r.light && light.towards) t = std::min(t, kFarLight * view.extent);
    t = std::min(t, 4 * view.extent);
  }
  return from + dir * t;
}

}  // namespace raio::core::app
