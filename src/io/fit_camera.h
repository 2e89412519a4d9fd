// A camera for data that comes without one.
#pragma once

#include "scene/scene.h"

namespace raio {

/// From where data is looked at: at an angle from above, or along the axis in which it extends the
/// least, with that in which it extends the most across the picture; at an angle where there is no
/// such axis.
enum class FitView : uint8_t { three_quarter, principal };

/// Gives the scene a camera that shows all of it but infinite planes, as large as it fits into a
/// picture of any shape (Camera::across_deg). Pictures are 1200 x 900 unless the scene says
/// otherwise. `up` is what the data calls so; the principal view does not ask.
void fit_camera(Scene& scene, FitView view, Vec3f up = {0, 0, 1});

/// The camera, which looks at the scene from some direction, moved across it and with other angles,
/// so that its parallel rays show all of the scene as large as it fits.
Camera fitted_in_parallel(const Scene& scene, const Camera& camera);

/// The vertical angle, in degrees, at which the camera sees what it must in a picture so wide and
/// high.
float fitted_fov_deg(const Camera& camera, int width, int height);
/// In a picture of the camera's own size, where it has one.
float fitted_fov_deg(const Camera& camera);

}  // namespace raio
