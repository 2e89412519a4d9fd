// A scene prepared for rendering, and the renderer of its tiles (wavefront-inl.h).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "base/executor.h"
#include "integrate/camera.h"
#include "integrate/film.h"
#include "integrate/lights.h"
#include "integrate/sampler.h"
#include "integrate/settings.h"

namespace raio::core {

struct PathScene;  // path_scene.h

/// Shared by all tiles. Immutable.
struct PreparedScene {
  /// A light with its intensity, and its square or rectangle for soft shadows.
  struct Emitter {
    Vec3f position;
    Rgb intensity;
    Vec3f edge_u, edge_v;  // zero for a point
  };

  const Scene& scene;
  const Accel& accel;
  RenderSettings settings;
  EyeRays eye;
  Vec3f forward;  // the unit vector along the line of sight
  // The extent of all finite primitives along it: where depth cueing of figures begins and how far
  // it goes.
  float nearest = 0, extent = 0;
  // The floor that catches shadows: points with normal . p = height; rays hit it up to a distance.
  Vec3f floor_normal;
  float floor_height = 0, floor_distance = 0;
  Sampler sampler;
  const float* filter_places = nullptr;  // null: the box
  std::vector<Emitter> emitters;
  std::vector<SampledLight> lights;       // of figures with KeyLight::scene
  std::unique_ptr<const PathScene> path;  // of the integrator `path`

  PreparedScene(const Scene&, const Accel&, const RenderSettings&);
  ~PreparedScene();

 private:
  void measure_depth();
  void lay_floor();
  void prepare_path();
};

/// Renders tiles, one after another; one per thread, with its own buffers.
class TileRenderer {
 public:
  virtual ~TileRenderer() = default;

  /// Adds samples that the tile of the film does not have; no other thread may add to the tile
  /// meanwhile. Does nothing if stopped.
  virtual void render(size_t tile, SampleSpan samples, Film& film) = 0;
};

/// For the settings' integrator, with the machine's best instruction set.
std::unique_ptr<TileRenderer> make_tile_renderer(const PreparedScene& scene, WorkControl& control);

}  // namespace raio::core
