// One sample of a pixel, told ray by ray: what each ray meets, what it brings, and why.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <vector>

#include "base/error.h"
#include "integrate/wavefront.h"

namespace raio {

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
  int parent = -1;  // of whose hit point it starts, by its place in Explanation::rays
  int level = 1;
  int light = -1;  // of a shadow ray
  Ray ray{};
  bool traced = true;     // else beyond the last level: it brings the background
  bool occluded = false;  // of a shadow ray
  Hit hit{};              // of any other
  Rgb weight{};           // in the pixel
  std::optional<Surface> surface{};

  // Radiance. That of a surface is float(float(ambient + light 0) + light 1) ..., where a light is
  // float(diffuse + highlight) of its shadow ray, if that is not occluded.
  Rgb ambient{}, background{};
  Vec3d diffuse{}, highlight{};
  // Of all but shadow rays, whose terms the surface sums up: exactly what they add to the pixel,
  // weight * radiance as the film rounds it.
  Vec3d brings{};
};

struct Explanation {
  std::vector<ExplainedRay> rays;  // a parent before its children
  Vec3d rgb;                       // the sum of what the rays bring
  RayCounts counts;
};

/// More are not kept.
inline constexpr size_t kMaxExplainedRays = 100000;

/// Renders sample `sample` of the pixel at (x, y) of the whole picture by the classic shading. The
/// error (no_resource): more rays.
std::expected<Explanation, Error> explain_sample(const Scene& scene, const Accel& accel,
                                                 const RenderSettings& settings, int x, int y,
                                                 uint32_t sample);

}  // namespace raio
