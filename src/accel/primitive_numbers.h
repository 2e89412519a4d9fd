// The numbers in the channel `id`: 1, 2, ... over all primitives, kind by kind; within a kind, the
// scene's own come first, then those of the instances, one instance after another.
#pragma once

#include <array>

#include "accel/geometry.h"

namespace raio::core {

class PrimitiveNumbers {
 public:
  explicit PrimitiveNumbers(const Geometry& geometry) : geometry_(geometry) {
    for (size_t k = 0; k < kPrimitiveKinds; ++k)
      begin_[k + 1] = begin_[k] + geometry.count_all(PrimitiveKind(k));
    if (!geometry.has_instances()) return;
    std::array<uint64_t, kPrimitiveKinds> next{};
    for (size_t k = 0; k < kPrimitiveKinds; ++k)
      next[k] = begin_[k] + geometry.count(PrimitiveKind(k));
    instances_.resize(geometry.count_instances());
    list(geometry, next, 0);
  }

  /// The number of primitives, which is the highest number.
  uint64_t count() const { return begin_.back(); }
  uint64_t number(PrimitiveId id, InstanceId instance) const {
    const Geometry& object = geometry_.object_at(instance);
    const PrimitiveKind kind = object.kind_of(id);
    const uint64_t begin = instance ? instances_[instance - 1][size_t(kind)] : begin_[size_t(kind)];
    return begin + object.index_of(kind, id) + 1;
  }

 private:
  // Numbers the instances of `geometry` after `around`.
  void list(const Geometry& geometry, std::array<uint64_t, kPrimitiveKinds>& next,
            InstanceId around) {
    const auto& instances = geometry.object().instances;
    for (uint32_t i = 0; geometry.has_instances() && i < instances.size(); ++i) {
      const InstanceId number = around + geometry.instance_id(i);
      const Geometry& object = geometry.placed(geometry.instance_id(i)).object;
      instances_[number - 1] = next;
      for (size_t k = 0; k < kPrimitiveKinds; ++k) next[k] += object.count(PrimitiveKind(k));
      list(object, next, number);
    }
  }

  const Geometry& geometry_;
  std::array<uint64_t, kPrimitiveKinds + 1> begin_{};
  Column<std::array<uint64_t, kPrimitiveKinds>> instances_;  // the number before their first
};

}  // namespace raio::core
