// A camera for data that comes without one.
#pragma once

#include <array>
#include <optional>

#include "scene/scene.h"

namespace raio {

/// From where data is looked at: at an angle from above, or along the axis in which it extends the
/// least, with that in which it extends the most across the picture; at an angle where there is no
/// such axis.
enum class FitView : uint8_t { three_quarter, principal };

/// Gives the scene a camera that shows all of it but infinite planes, as large as it fits into a
/// picture of any shape (Camera::horizontal_fov_deg). Pictures are 1200 x 900 unless the scene says
/// otherwise. `up` is what the data calls so; the principal view does not ask.
void fit_camera(Scene& scene, FitView view, Vec3f up = {0, 0, 1});

/// The same for what lies in a cell with these sides: the third one is upright, the longer of the
/// others goes across the picture, and it is seen from the front, a little from the right and from
/// above, or, if it `is_flat`, from the third side.
void fit_camera_to_cell(Scene& scene, const std::array<Vec3d, 3>& sides, bool is_flat);

/// A side of the scene; `iso` is the corner between front, right and top.
enum class Side : uint8_t { front, back, left, right, top, bottom, iso };

/// Whether a camera is fitted to all of the scene, or to most of it, without distant parts such as
/// ground planes and stray atoms.
enum class Fit : uint8_t { all, most };

/// The part of a scene that Fit::most shows: what lies in a sphere. Its centre is the median of the
/// places along each axis, its radius kFarAway times the distance within which three quarters lie.
/// Places are the centres of spheres, the corners of triangles and polygons, and those of the boxes
/// of all else, each with the radius that belongs to it; of many they are a sample.
struct MostOfScene {
  Vec3f center;
  double radius = 0;
  double shrinks = 1;  // the size of all of the scene over that of this part

  bool has(Vec3f place, float its_radius) const {
    return length(Vec3d(place) - Vec3d(center)) + double(its_radius) <= radius;
  }
};
inline constexpr double kFarAway = 3;  // a cube, evenly filled, reaches 1.9 times as far
MostOfScene most_of(const Scene& scene);

/// The part of the places that are outside, 0 to 1.
double part_outside(const Scene& scene, const MostOfScene& most);

/// The camera moved so that it shows the scene as large as it fits, from one of its sides, or,
/// without one, at an angle from above. With the z axis up the front faces -y, with the y axis up
/// +z; in both the right side faces +x. In the pictures from above and from below, the right side
/// is on the right. Its vertical angle is the one that is given, or less where the width decides.
Camera fitted_from(const Scene& scene, const Camera& camera, std::optional<Side> side, Vec3f up,
                   Fit fit, float fov_deg = 0);

/// Likewise, without another direction.
Camera fitted_along(const Scene& scene, const Camera& camera, Fit fit, float fov_deg = 0);

/// The axis, x, y or z in either direction, nearest to a direction.
Vec3f nearest_axis(Vec3f direction);

/// The camera, which looks at the scene from some direction, moved across it and with other angles,
/// so that its parallel rays show all of the scene as large as it fits.
Camera fitted_in_parallel(const Scene& scene, const Camera& camera);

/// The vertical angle, in degrees, at which the camera sees what it must in a picture so wide and
/// high.
float fitted_fov_deg(const Camera& camera, int width, int height);
/// In a picture of the camera's own size, where it has one.
float fitted_fov_deg(const Camera& camera);

}  // namespace raio
