// What is likely to disappoint in a picture that could be rendered as it was asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio {

struct SceneWarning {
  enum Kind {
    no_light,  // the scene has no light
    blurred,   // with a lens: hardly anything is sharp
    no_lens,   // the scene's has no effect on parallel rays
    no_tree,   // the file asks for brute force, of many primitives
  };
  Kind kind = no_light;
  std::string sentence;  // what was found, without what to do about it

  /// Of `blurred`, in scene units: a lens that blurs little with the same focus, and a focus with
  /// which the same lens does; 0 where there is none.
  float aperture = 0, focus = 0;
};

/// A file may ask for brute force, as many do that have few primitives; of more it is a mistake.
inline constexpr size_t kManyPrimitives = 10'000;

/// What a picture with these settings would suffer from. A lens is judged by a few hundred eye
/// rays: it blurs too much when it spreads half of what they hit over more than 2 % of the
/// picture's height and leaves less than a fortieth of it sharp (to half a per cent of the height,
/// or a pixel). That takes an acceleration structure; without one a lens is not judged.
std::vector<SceneWarning> scene_warnings(const Scene& scene, const RenderSettings& settings,
                                         const Accel* accel);

/// How long the picture would take with a tree in place of brute force, by a trial: to build one,
/// and for each sample of each pixel as long as for the first ones of some tiles. 0: it cannot be
/// tried.
double seconds_with_tree(const Scene& scene, RenderSettings settings);

/// Why the finished picture may show nothing, where all its pixels are those of the background.
std::optional<std::string> blank_warning(const Film& film, const RenderSettings& settings,
                                         const Accel& accel);

/// How many samples of the film were not a number, and which pixel is the first that has one, by
/// its place in the picture of which the film is a part. Nothing where there are none.
std::optional<std::string> nan_warning(const Film& film, const std::optional<Crop>& crop);

}  // namespace raio
