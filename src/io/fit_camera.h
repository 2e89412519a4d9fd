// Fits a camera to data that has none.
#pragma once

#include <array>
#include <optional>

#include "scene/scene.h"

namespace raio::core {

/// The view of data: at an angle from above; or along the axis of least extent, with that of
/// largest extent across the picture, and at an angle if there are no such axes.
enum class FitView : uint8_t { three_quarter, principal };

/// Sets a camera that shows all of the scene except infinite planes, as large as fits in a picture
/// of any shape (Camera::horizontal_fov_deg). Pictures are 1200 x 900 unless the scene says
/// otherwise. `up` is the data's up direction; the principal view ignores it.
void fit_camera(Scene& scene, FitView view, Vec3f up = {0, 0, 1});

/// The same for data in a cell with these sides: the third one is vertical, the longer of the
/// others is horizontal in the picture, seen from the front, slightly from the right and above, or,
/// if it `is_flat`, along the third side.
void fit_camera_to_cell(Scene& scene, const std::array<Vec3d, 3>& sides, bool is_flat);

/// A side of the scene; `iso` is the corner between front, right and top.
enum class Side : uint8_t { front, back, left, right, top, bottom, iso };

/// Whether a camera is fitted to all of the scene, or to most of it, ignoring distant parts such as
/// ground planes and stray atoms.
enum class Fit : uint8_t { all, most };

/// The part of a scene shown by Fit::most: a sphere. Its centre is the median of the positions
/// along each axis, its radius kFarAway times the distance that contains three quarters of them.
/// Positions are centres of spheres, vertices of triangles and polygons, and centres of the boxes
/// of all else, each with its radius; large scenes are sampled.
struct MostOfScene {
  Vec3f center;
  double radius = 0;
  double shrinks = 1;  // the size of the scene relative to this part

  bool has(Vec3f place, float its_radius) const {
    return length(Vec3d(place) - Vec3d(center)) + double(its_radius) <= radius;
  }
};
inline constexpr double kFarAway = 3;  // a uniformly filled cube extends 1.9 times
MostOfScene most_of(const Scene& scene);

/// The fraction of the positions outside, 0 to 1.
double part_outside(const Scene& scene, const MostOfScene& most);

/// The camera moved so that it shows the scene as large as fits, from one of its sides or, without
/// one, at an angle from above. With z up the front faces -y, with y up +z; in both, the right side
/// faces +x. In views from above and below, the right side is on the right. Its vertical angle is
/// the given one, or less if the width decides.
Camera fitted_from(const Scene& scene, const Camera& camera, std::optional<Side> side, Vec3f up,
                   Fit fit, float fov_deg = 0);

/// Likewise, with the camera's own direction.
Camera fitted_along(const Scene& scene, const Camera& camera, Fit fit, float fov_deg = 0);

/// The axis, x, y or z in either direction, nearest to a direction.
Vec3f nearest_axis(Vec3f direction);

/// The camera moved sideways and with other angles, so that its parallel rays show the whole scene
/// as large as fits, from the same direction.
Camera fitted_in_parallel(const Scene& scene, const Camera& camera);

/// The vertical angle, in degrees, of a picture of this width and height that contains everything
/// that the camera must show.
float fitted_fov_deg(const Camera& camera, int width, int height);
/// In a picture of the camera's own size, if it has one.
float fitted_fov_deg(const Camera& camera);

}  // namespace raio::core
