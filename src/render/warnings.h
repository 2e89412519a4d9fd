// What is likely to disappoint in a picture that could be rendered as it was asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "integrate/settings.h"
#include "io/image/image.h"
#include "scene/scene.h"

namespace raio {

struct SceneWarning {
  enum Kind {
    no_light,  // the scene has no light
    blurred,   // with a lens: hardly anything is sharp
    no_lens,   // the scene's has no effect on parallel rays
  };
  Kind kind = no_light;
  std::string sentence;  // what was found, without what to do about it

  /// Of `blurred`, in scene units: a lens that blurs little with the same focus, and a focus with
  /// which the same lens does; 0 where there is none.
  float aperture = 0, focus = 0;
};

/// What a picture with these settings would suffer from. A lens is judged by a few hundred eye
/// rays: it blurs too much when it spreads half of what they hit over more than 2 % of the
/// picture's height and leaves less than a fortieth of it sharp (to half a per cent of the height,
/// or a pixel). That takes an acceleration structure; without one a lens is not judged.
std::vector<SceneWarning> scene_warnings(const Scene& scene, const RenderSettings& settings,
                                         const Accel* accel);

/// Why the finished picture may show nothing, where all its pixels are those of the background.
std::optional<std::string> blank_warning(const Image& picture, const RenderSettings& settings,
                                         const Accel& accel);

}  // namespace raio
