// A world as a raio::Scene.
#pragma once

#include <raio/raio.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "device/objects.h"
#include "device/surface.h"

namespace raio::device {

inline Triple triple(const core::Vec3d& v) { return {v.x, v.y, v.z}; }

/// The scene of a world at one time.
struct ShownWorld {
  uint64_t stamp = 0;  ///< of the world
  Scene scene;
  Part own;  ///< what is not in instances
  struct Placed {
    uint32_t part, instance_id;
  };
  std::vector<Part> parts;  ///< by prototype
  std::vector<Placed> instances;
  bool has_lights = false, has_environment = false, environment_visible = false;

  /// The structure, built by the first caller; shares what it can with that of `before`.
  const Accel& accel(const Settings& settings);
  /// The number of the surface, the primitive and the instance of a hit; 2^32 - 1: none.
  std::array<uint32_t, 3> numbers_of(Kind kind, int64_t index, int64_t instance) const;

  std::shared_ptr<ShownWorld> before;

 private:
  std::mutex mutex_;
  std::optional<Accel> accel_;
};

class World final : public Object {
 public:
  explicit World(Device& owner) : Object(owner, DataType::world, "") {}

  /// Of what is committed now.
  std::shared_ptr<ShownWorld> shown();
  void forget() override { shown_ = nullptr; }

 private:
  std::shared_ptr<ShownWorld> shown_;
};

/// The lowest and highest corner of a world, an instance or a group, as committed.
std::optional<std::array<float, 6>> bounds_of(const Object& object);

}  // namespace raio::device
