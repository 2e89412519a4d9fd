// The classic shading (docs/shading.md): Phong's light, hard or soft shadows, mirror reflection and
// refraction, as NFF tracers have had it since Whitted 1980, "An Improved Illumination Model for
// Shaded Display", CACM 23(6).
#pragma once

#include <memory>

#include "accel/accel.h"
#include "integrate/camera.h"
#include "integrate/control.h"
#include "integrate/film.h"
#include "integrate/options.h"
#include "integrate/sampler.h"

namespace raio {

/// No sample of the scene brings more than this to a pixel, with rays of `depth` levels.
double radiance_bound(const Scene& scene, int depth);

/// What all tiles share: the scene made ready for shading. Immutable.
struct ClassicScene {
  /// A light with its intensity, and the square that it is for soft shadows.
  struct Emitter {
    Vec3f position;
    Rgb intensity;
    Vec3f edge_u, edge_v;  // zero for a point
  };

  const Scene& scene;
  const Accel& accel;
  RenderOptions options;  // resolved
  EyeRays eye;
  Sampler sampler;
  Rgb ambient;  // times the material's colour
  std::vector<Emitter> emitters;
  bool any_mirror = false, any_transparent = false;  // among the materials

  ClassicScene(const Scene& scene, const Accel& accel, const RenderOptions& options);
};

/// Renders tiles, one after another; one per thread, whose buffers it keeps.
class ClassicTracer {
 public:
  virtual ~ClassicTracer() = default;

  /// Adds what a tile of the film, which no one else adds to meanwhile, lacks of `samples` samples;
  /// nothing when told to stop.
  virtual void render(size_t tile, uint32_t samples, Film& film) = 0;
};

/// For the best instruction set that this machine has.
std::unique_ptr<ClassicTracer> make_classic_tracer(const ClassicScene& scene,
                                                   RenderControl& control);

}  // namespace raio
