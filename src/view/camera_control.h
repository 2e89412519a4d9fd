// Camera movements by mouse and keys. Plain geometry: no window, no state.
#pragma once

#include <optional>

#include "base/box.h"
#include "scene/scene.h"

namespace raio::core::view {

/// The camera's own axes, unit vectors.
struct CameraAxes {
  Vec3d right, up, forward;

  explicit CameraAxes(const Camera& camera);
};

/// Orbits about `pivot`: by `right_rad` about the camera's `up`, by `up_rad` about its right axis,
/// stopping just short of the poles. Positive angles move the camera to the right and upwards. The
/// distance to the pivot, its depth in the picture, and `up` do not change.
Camera orbited(const Camera& camera, Vec3d pivot, double right_rad, double up_rad);

/// Half of the picture's height at `depth` along the line of sight.
double half_height(const Camera& camera, double depth);

/// Moves the camera perpendicular to its line of sight, so that a point at `depth` moves by (right,
/// up) in picture heights.
Camera panned(const Camera& camera, double depth, double right, double up);

/// Moves the camera towards `target` (away for factors above 1), so that its distance is multiplied
/// by `factor`; the direction of view is unchanged, so `target` stays under the cursor. With
/// parallel rays, where distance has no effect, the picture shows `factor` times as much.
Camera dollied(const Camera& camera, Vec3d target, double factor);

/// Moves the camera along its own axes, scene units.
Camera walked(const Camera& camera, double right, double up, double forward);

/// Rotates the camera in place.
Camera looked(const Camera& camera, double right_rad, double up_rad);

/// Moves the camera so that all of `box` is visible, in the same direction, whatever the picture's
/// shape. An empty box changes nothing.
Camera fitted(const Camera& camera, const Box3f& box, double width_per_height);

}  // namespace raio::core::view
