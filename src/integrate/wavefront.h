// A scene made ready for rendering, and what renders its tiles. The wavefront itself, which all
// ways of shading share, is wavefront-inl.h.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "integrate/camera.h"
#include "integrate/control.h"
#include "integrate/film.h"
#include "integrate/sampler.h"
#include "integrate/settings.h"

namespace raio {

/// What all tiles share. Immutable.
struct PreparedScene {
  /// A light with its intensity, and the square or rectangle that it is for soft shadows.
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
  // Of all that has bounds, along it: where the depth cue of figures begins and how far it goes.
  float nearest = 0, extent = 0;
  // The floor that catches shadows: points whose dot product with the normal is the height; rays
  // meet it up to a distance.
  Vec3f floor_normal;
  float floor_height = 0, floor_distance = 0;
  Sampler sampler;
  std::vector<Emitter> emitters;

  PreparedScene(const Scene&, const Accel&, const RenderSettings&);

 private:
  void measure_depth();
  void lay_floor();
};

/// Renders tiles, one after another; one per thread, whose buffers it keeps.
class TileRenderer {
 public:
  virtual ~TileRenderer() = default;

  /// Adds samples that a tile of the film lacks, which no one else adds to meanwhile; nothing when
  /// told to stop.
  virtual void render(size_t tile, SampleSpan samples, Film& film) = 0;
};

}  // namespace raio
