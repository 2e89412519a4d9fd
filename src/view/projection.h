// Projects points of the world into the window.
#pragma once

#include <imgui.h>

#include <array>
#include <optional>

#include "view/camera_control.h"
#include "view/stage.h"

namespace raio::core::view {

class Projection {
 public:
  Projection(const Camera& camera, const Stage& stage)
      : axes_(camera),
        from_(camera.from),
        near_(1e-3 * length(Vec3d(camera.at) - from_)),
        center_((stage.lo.x + stage.hi.x) / 2, (stage.lo.y + stage.hi.y) / 2),
        scale_(double(stage.hi.y - stage.lo.y) / 2 / half_height(camera, 1)),
        parallel_(camera.is_parallel()) {}

  /// Nothing for a point behind the camera.
  std::optional<ImVec2> point(const Vec3d& p) const {
    const Vec3d v = p - from_;
    const double depth = dot(v, axes_.forward);
    if (depth < near_) return std::nullopt;
    const double scale = parallel_ ? scale_ : scale_ / depth;
    return ImVec2(center_.x + float(scale * dot(v, axes_.right)),
                  center_.y - float(scale * dot(v, axes_.up)));
  }
  /// The part in front of the camera.
  std::optional<std::array<ImVec2, 2>> segment(Vec3d a, Vec3d b) const {
    const double da = dot(a - from_, axes_.forward), db = dot(b - from_, axes_.forward);
    const double near = near_ * (1 + 1e-9);
    if (da < near && db < near) return std::nullopt;
    if (da < near) a = a + (b - a) * ((near - da) / (db - da));
    if (db < near) b = b + (a - b) * ((near - db) / (da - db));
    const auto pa = point(a), pb = point(b);
    if (!pa || !pb) return std::nullopt;
    return std::array{*pa, *pb};
  }

 private:
  CameraAxes axes_;
  Vec3d from_;
  double near_;
  ImVec2 center_;
  double scale_;  // window units per scene unit, at distance 1 or at any distance
  bool parallel_;
};

}  // namespace raio::core::view
