// The scene's lights, prepared for sampling (lights-inl.h). docs/ambient.md has the formulas.
#pragma once

#include <vector>

#include "integrate/camera.h"
#include "integrate/figure.h"
#include "scene/scene.h"

namespace raio::core {

/// A light of any kind. Its samples are at position + edge_u u + edge_v v, (u, v) in the unit
/// square or, if it is round, in the unit disc; or, if it is distant, in that direction.
struct SampledLight {
  Rgb emission;  // irradiance; or intensity, which is that of the whole area
  bool is_distant = false, is_round = true;
  bool decreases = true;  // with the square of the distance
  bool has_area = false;  // and so emits less to the side
  bool is_two_sided = false;
  Vec3f position;        // of a distant light: the direction to its centre
  Vec3f edge_u, edge_v;  // zero for a point
  float hole = 0;        // the square of a ring's inner radius, relative to the outer one
  Vec3f axis;            // in which it shines
  float least_cosine = -2, steepness = 1;  // of the cone, and 1 / the width of its border
  float nearest_squared = 0;               // see sampled_lights()

  /// The largest irradiance of a surface.
  double brightest() const;
};

/// NFF's lights, which do not decrease with distance, and the physical ones. Closer to a light than
/// a thousandth of the scene's size, its light does not increase any more, so that it has a bound.
/// The size is the diagonal of the box around everything bounded, the lights and the camera.
std::vector<SampledLight> sampled_lights(const Scene& scene, const Camera& camera);

/// The key light of figures, over the viewer's left shoulder: a disc that spans about eleven
/// degrees. A white surface facing it has the radiance StyleParams::key.
SampledLight key_light(const EyeRays& eye, Vec3f forward, const StyleParams& look);

/// The largest component of the environment's texels.
double brightest_texel(const Scene& scene);

/// The intensity of an NFF light without a colour.
Rgb uncolored_intensity(const Scene& scene);

}  // namespace raio::core
