// Instances of objects: a tree over their boxes with the objects' structures as leaves. A ray
// continues in the object's space, so an instance costs only its matrix.
#pragma once

#include <expected>
#include <memory>
#include <span>
#include <vector>

#include "accel/accel.h"
#include "base/placement.h"

namespace raio::core {

class Instances {
 public:
  /// For the instances of the scene of `around`, which must outlive the result. Objects have
  /// structures with the same options; with kind `none`, all rays try all instances. `like` and
  /// errors as in build_accel().
  static std::expected<std::unique_ptr<const Instances>, Error> build(const Accel& around,
                                                                      const AccelOptions& options,
                                                                      bool one_sided,
                                                                      bool with_sources,
                                                                      const Accel* like);

  // As in Accel, starting from the hits on the scene's own primitives.
  void closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const;
  void occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const;
  void next_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                        TraceContext& context, const uint32_t* keys) const;
  void transparent_depths(const RayBatch& rays, DepthBatch& depths, TraceContext& context) const;

  std::vector<const Geometry*> objects() const;
  /// Null if there are fewer.
  const Accel* object(size_t number) const {
    return number < objects_.size() ? objects_[number].get() : nullptr;
  }
  void add_to(AccelInfo& info) const;

 private:
  // A node has two adjacent children, or is a leaf with one instance.
  struct Node {
    Box3f box;
    uint32_t first = 0;  // child, or instance
    uint8_t axis = kLeaf;
  };
  static constexpr uint8_t kLeaf = 3;
  class Traversal;

  explicit Instances(const Accel& around)
      : geometry_(around.geometry()), instances_(geometry_.object().instances) {}
  void build_tree();
  void split(uint32_t node, std::span<uint32_t> instances, const std::vector<Box3f>& boxes);

  const Geometry& geometry_;
  const ShapeArray<Instance>& instances_;
  std::vector<std::unique_ptr<const Accel>> objects_;
  Column<Node> nodes_;  // the root first; empty: no instances
  double slack_ = 0;    // of boxes, relative to coordinates
};

}  // namespace raio::core
