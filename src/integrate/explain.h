// Explains one sample of a pixel, ray by ray: its hit, its contribution, and the reasons.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
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
    float kd = 0, ks = 0, shine = 0, transmission = 0, ior = 1;
    Rgb specular{1};                    // times ks
    float gloss = 0, translucency = 0;  // the roughness that spreads mirrored and refracted rays
    Rgb radiance;                       // the sum of its terms

    // For its children. The normals are those used: where a smooth one would send the ray to the
    // wrong side, the geometric one.
    Vec3f mirror_normal{}, refraction_normal{};
    // The index on the ray's side, divided by that on the other.
    float eta = 1;
    // At refraction_normal: the ray's cosine, and the square of that behind the surface,
    // 1 - eta^2 (1 - cosine^2); negative at total internal reflection.
    float cosine = 0, cosine2_behind = 0;
    std::optional<float> reflectance{};  // Kr, if Fresnel's equations split the light

    bool is_inside() const { return ior != 1 && eta == ior; }
    float index_before() const { return is_inside() ? ior : 1; }
    float index_behind() const { return is_inside() ? 1 : ior; }
  };
  // Of a shadow ray: the numbers of its light's terms.
  struct Light {
    float n_dot_l = 0;
    Vec3f direction;   // R, or H with ShadingModel::blinn_phong
    float cosine = 0;  // R.V or N.H
    float power = 0;   // max(0, cosine)^shine
  };

  // Of a surface on a path. Densities are per solid angle, 0 for directions without one; weights of
  // light are those of multiple importance sampling.
  struct Bounce {
    Rgb diffuse, mirror, coat;  // albedo, reflectances of metal and of a dielectric
    float glass = 0;            // the part that reflects and refracts like glass
    float roughness = 0;
    float clearcoat = 0;
    Rgb sheen{};
    Rgb transmittance{1};  // of the medium that the ray has crossed
    Rgb emission{};
    float emission_weight = 0;
    float emission_density = 0;  // with which the sampling of lights finds this point; 0: it cannot

    // The sampled light: "0", "distant 0", "triangle 12", "environment". Empty: none.
    std::string light{};
    float light_probability = 0;  // of choosing it
    float light_density = 0;      // of the direction, times this probability; 0: only this finds it
    Rgb light_radiance{};         // divided by the density; without one, by the probability
    Rgb light_bsdf{};             // BSDF times cosine
    float light_bsdf_density = 0;  // with which the surface chooses the direction
    float light_weight = 0;
    Rgb direct{};  // added to the surface's radiance unless the light is occluded

    // The next ray: its weight is divided by the chance that the path goes on.
    float density = 0;
    Rgb weight{};
    float chance = 1;
  };
  // Of the light that surrounds the scene, seen by a path's ray.
  struct Escape {
    float light_density = 0;  // with which the sampling of lights finds it
    float weight = 1;
  };

  Kind kind = Kind::eye;
  int parent = -1;  // the ray that spawned it, as an index in Explanation::rays
  int level = 1;
  int light = -1;  // for a shadow ray, but not on a path
  Ray ray{};
  bool traced = true;     // else beyond the last level: it gets the background
  bool occluded = false;  // for a shadow ray
  Hit hit{};              // for other rays
  Rgb weight{};           // in the pixel
  std::optional<Surface> surface{};
  std::optional<Light> lit{};
  std::optional<Bounce> bounce{};
  std::optional<Escape> escape{};

  // Radiance. That of a surface is float(float(ambient + light 0) + light 1) ..., where a light is
  // float(diffuse + highlight) of its shadow ray, if unoccluded. On a path it is transmittance
  // (emission emission_weight) + direct, and `background` is multiplied by Escape::weight.
  Rgb ambient{}, background{};
  Vec3d diffuse{}, highlight{};
  // For all except shadow rays, which are part of the surface's sum: what the ray adds to the
  // pixel, exactly: float(weight * radiance), rounded to a multiple of Explanation::unit.
  Vec3d adds{};
};

struct Explanation {
  std::vector<ExplainedRay> rays;  // parents before their children
  Vec3d rgb;                       // the sum of what the rays add
  float ambient = 0;               // A, times the colour of a surface
  double unit = 1;                 // of the film's sums
  std::vector<PreparedScene::Emitter> lights;
  RayCounts counts;
};

/// The maximum number of rays recorded.
inline constexpr size_t kMaxExplainedRays = 100000;

/// Renders sample `sample` of the pixel at (x, y) of the whole picture with the integrators
/// `classic` and `path`. Errors: others, transparent primitives and cutouts (bad_option); more rays
/// (no_resource).
std::expected<Explanation, Error> explain_sample(const Scene& scene, const Accel& accel,
                                                 const RenderSettings& settings, int x, int y,
                                                 uint32_t sample);

}  // namespace raio::core
