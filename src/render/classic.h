// The classic shading (docs/shading.md): Phong's light, hard or soft shadows, mirror reflection and
// refraction, as NFF tracers have had it since Whitted 1980, "An Improved Illumination Model for
// Shaded Display", CACM 23(6).
#pragma once

#include "accel/accel.h"
#include "render/camera.h"
#include "render/film.h"
#include "render/options.h"
#include "render/render.h"
#include "render/sampler.h"

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

  ClassicScene(const Scene& scene, const Accel& accel, const RenderOptions& options);
};

/// A rectangle of pixels.
struct Tile {
  int x0, y0, x1, y1;
};

/// Renders tiles, one after another; one per thread, whose buffers it keeps.
///
/// Rays go in batches, a level of the ray tree at a time: the eye rays of a tile, then the shadow
/// rays of their hits light by light, then their reflections and refractions as the next level. A
/// ray carries what it will bring to its pixel (a shadow ray its light, any other its weight), so
/// none waits for another.
class ClassicTracer {
 public:
  explicit ClassicTracer(const ClassicScene& scene, const RenderControl& control);

  /// Adds sample number `sample` of each pixel of the tile to the film, whose pixels no one else
  /// touches meanwhile. Returns early when told to stop.
  void add_sample(const Tile& tile, uint32_t sample, Film& film);

  const RayCounts& counts() const { return counts_; }

 private:
  struct PathRays {
    RayBatch rays;
    std::vector<uint32_t> pixel, branch;  // branch: the place in the ray tree (render/sampler.h)
    std::vector<float> weight;

    void push(const Ray& ray, uint32_t p, uint32_t b, float w) {
      const size_t i = rays.size();
      rays.push(ray);
      if (i >= pixel.size())
        pixel.resize(rays.capacity()), branch.resize(rays.capacity()),
            weight.resize(rays.capacity());
      pixel[i] = p, branch[i] = b, weight[i] = w;
    }
    /// Moves the last rays of `from`, at most `count`, here in place of what was here.
    void take_last(size_t count, PathRays& from);
  };
  struct ShadowRays {
    RayBatch rays;
    std::vector<uint32_t> pixel;
    std::vector<Rgb> light;  // what arrives if nothing is in the way

    void push(const Ray& ray, uint32_t p, Rgb l) {
      const size_t i = rays.size();
      rays.push(ray);
      if (i >= pixel.size()) pixel.resize(rays.capacity()), light.resize(rays.capacity());
      pixel[i] = p, light[i] = l;
    }
  };

  void trace_level(int level, Film& film);
  void shade(int level, size_t i, Film& film);
  void spawn(int level, const Ray& ray, uint32_t pixel, uint32_t branch, float weight, Film& film);
  void trace_shadows(Film& film);

  const ClassicScene& scene_;
  TraceContext context_;
  RayCounts counts_;
  uint32_t sample_ = 0;
  std::vector<PathRays> waiting_;  // by level
  PathRays current_;               // being traced, with their hits
  HitBatch hits_;
  std::vector<ShadowRays> shadows_;  // by light
  std::vector<uint8_t> hidden_;
};

}  // namespace raio
