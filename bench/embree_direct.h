// Expert use of Embree, without Raio around it: its fastest build, not its robust mode, and each of
// its interfaces for rays. The yardstick of bare tracing and building.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <atomic>
#include <string_view>

#include "accel/accel.h"

namespace raio::core::bench {

/// How rays are passed: one by one, in packets of eight, or a whole batch as a stream.
struct EmbreeWay {
  std::string_view name;
  enum Shape { single, packet, stream } shape;
  bool coherent;
};
inline constexpr std::array kEmbreeWays = {
    EmbreeWay{"1", EmbreeWay::single, false},
    EmbreeWay{"8 coherent", EmbreeWay::packet, true},
    EmbreeWay{"8 incoherent", EmbreeWay::packet, false},
    EmbreeWay{"stream coherent", EmbreeWay::stream, true},
    EmbreeWay{"stream incoherent", EmbreeWay::stream, false},
};

class EmbreeScene {
 public:
  /// Whether Embree has all shapes: it has neither open cones nor planes, and callbacks for them
  /// would be unfair.
  static bool can_hold(const Geometry& geometry) {
    return geometry.count(PrimitiveKind::cone) + geometry.count(PrimitiveKind::plane) == 0;
  }

  explicit EmbreeScene(const Geometry& geometry);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Traces all rays, to the nearest hit or (`shadow`) to any, and returns the number of hits. The
  /// results stay in Embree's own records.
  size_t trace(const RayBatch& rays, const EmbreeWay& way, bool shadow) const;

  /// Including the buffers of the geometry.
  size_t bytes() const { return size_t(bytes_.load()); }

 private:
  void add_spheres(const Geometry& geometry);
  void add_triangles(const Geometry& geometry);

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::atomic<ssize_t> bytes_{0};
};

}  // namespace raio::core::bench
