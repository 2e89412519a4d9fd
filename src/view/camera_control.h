// How hands move a camera. Plain geometry: no window, no state.
#pragma once

#include <optional>

#include "base/box.h"
#include "scene/scene.h"

namespace raio::view {

/// The camera's own axes, unit vectors.
struct CameraAxes {
  Vec3d right, up, forward;

  explicit CameraAxes(const Camera& camera);
};

/// Turns the camera about `pivot`: by `right_rad` about `up` of the camera, by `up_rad` about its
/// right side, as far as a little short of the poles. Positive angles move the camera to the right
/// and upwards. The distance to the pivot stays, and the pivot stays where it is in the picture's
/// depth; `up` stays, too.
Camera orbited(const Camera& camera, Vec3d pivot, double right_rad, double up_rad);

/// Half of the picture's height where something is at `depth` along the line of sight.
double half_height(const Camera& camera, double depth);

/// Moves the camera across its line of sight, so that what is at `depth` along it moves by (right,
/// up) in heights of the picture.
Camera panned(const Camera& camera, double depth, double right, double up);

/// Moves the camera towards `target` (away from it for factors above 1), so that its distance is
/// `factor` times what it was; the direction of view stays, so `target` stays under the cursor.
/// With parallel rays, which distance does not change, the picture shows `factor` times as much.
Camera dollied(const Camera& camera, Vec3d target, double factor);

/// Moves the camera along its own axes, scene units.
Camera walked(const Camera& camera, double right, double up, double forward);

/// Turns the camera where it stands.
Camera looked(const Camera& camera, double right_rad, double up_rad);

/// Sees all of `box` from where it looks now, whatever the picture's shape. An empty box changes
/// nothing.
Camera fitted(const Camera& camera, const Box3f& box, double width_per_height);

}  // namespace raio::view
