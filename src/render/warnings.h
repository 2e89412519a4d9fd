// Likely problems of a picture with valid options.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio::core {

struct SceneWarning {
  enum Kind {
    no_light,  // the scene has no light
    blurred,   // with a lens: hardly anything is sharp
    no_lens,   // the scene's has no effect on parallel rays
    no_tree,   // the file requests brute force for many primitives
    unseen,    // the integrator does not show some of the surfaces' parameters
  };
  Kind kind = no_light;
  std::string sentence;  // what was found, without advice

  /// For `blurred`, in scene units: a lens that blurs little at the same focus, and a focus for
  /// which the same lens does; 0 if there is none.
  float aperture = 0, focus = 0;
};

/// Many files with few primitives request brute force; with more it is a mistake.
inline constexpr size_t kManyPrimitives = 10'000;

/// The problems of a picture with these settings. A lens is judged by a few hundred eye rays: it
/// blurs too much if it spreads half of the hits over more than 2 % of the picture's height and
/// leaves less than a fortieth sharp (to half a per cent of the height, or a pixel). That needs an
/// acceleration structure; without one, lenses are not judged.
std::vector<SceneWarning> scene_warnings(const Scene& scene, const RenderSettings& settings,
                                         const Accel* accel);

/// Estimates the picture's time with a tree instead of brute force by a trial: building one, and
/// rendering the first samples of some tiles. 0: impossible.
double seconds_with_tree(const Scene& scene, RenderSettings settings);

/// Why the finished picture may be empty, if all its pixels are those of the background.
std::optional<std::string> blank_warning(const Film& film, const RenderSettings& settings,
                                         const Accel& accel);

/// The numbers of NaN and of clamped samples in the film, and the first pixel with one, in
/// coordinates of the whole picture. Nothing if there are none.
std::vector<std::string> fault_warnings(const Film& film, const std::optional<Crop>& crop);

}  // namespace raio::core
