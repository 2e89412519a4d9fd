// Explains one sample of a pixel, ray by ray: its hit, its contribution, and the reasons.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <vector>

#include "base/error.h"
#include "integrate/prepared_scene.h"

namespace raio::core {

struct ExplainedRay {
  enum class Kind : uint8_t { eye, reflection, refraction, shadow };
  struct Surface {
    Vec3f point, normal, geometric;  // normals towards the ray
    MaterialId material = 0;
    Rgb color;
    float kd = 0, ks = 0, shine = 0, transmission = 0, eta = 1;
    Rgb specular{1};  // times ks
    float roughness = 0;
  };

  Kind kind = Kind::eye;
  int parent = -1;  // the ray that spawned it, as an index in Explanation::rays
  int level = 1;
  int light = -1;  // for a shadow ray
  Ray ray{};
  bool traced = true;     // else beyond the last level: it gets the background
  bool occluded = false;  // for a shadow ray
  Hit hit{};              // for other rays
  Rgb weight{};           // in the pixel
  std::optional<Surface> surface{};

  // Radiance. That of a surface is float(float(ambient + light 0) + light 1) ..., where a light is
  // float(diffuse + highlight) of its shadow ray, if unoccluded.
  Rgb ambient{}, background{};
  Vec3d diffuse{}, highlight{};
  // For all except shadow rays, which are part of the surface's sum: the exact contribution to the
  // pixel, weight * radiance as rounded by the film.
  Vec3d brings{};
};

struct Explanation {
  std::vector<ExplainedRay> rays;  // parents before their children
  Vec3d rgb;                       // the sum of the rays' contributions
  RayCounts counts;
};

/// The maximum number of rays recorded.
inline constexpr size_t kMaxExplainedRays = 100000;

/// Renders sample `sample` of the pixel at (x, y) of the whole picture with the classic shading.
/// The error (no_resource): more rays.
std::expected<Explanation, Error> explain_sample(const Scene& scene, const Accel& accel,
                                                 const RenderSettings& settings, int x, int y,
                                                 uint32_t sample);

}  // namespace raio::core
