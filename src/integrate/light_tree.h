// Chooses one of many lights for a point, with a probability that follows its share of the light
// there. Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
// Splitting", PACMCGIT 1(2): a bounding volume hierarchy over the lights, in which each node bounds
// positions and directions; from the root down, a child is chosen in proportion to the light that
// it may send to the point. Here one light is chosen; nodes are not split adaptively.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"

namespace raio::core {

/// Bounds of a light. It emits from points of `box`; its normals are within an angle of `axis`, and
/// it emits within another angle of a normal, most along it. Angles are stored as cosines.
struct LightBounds {
  Box3f box;               // not empty; coordinates of at most 1e18
  Vec3f axis{0, 0, 1};     // of length 1
  float cos_normals = -1;  // -1: normals of all directions
  float cos_emission = 0;  // 0: Lambert's law; below: as much in all directions that it allows
  bool two_sided = false;  // shines along -axis, too
  float power = 0;         // in any unit, at least 0
};

/// `probability` 0: none, since no light reaches the point, or none of the branch that was chosen.
/// The second happens because the bounds of a node are wider than those of its lights.
struct LightChoice {
  uint32_t light = 0;
  float probability = 0;
};

class LightTree {
 public:
  /// At most 2^29 lights. Those without power are never chosen. The tree does not depend on the
  /// number of threads.
  explicit LightTree(std::span<const LightBounds> lights);

  /// The light for a point on a surface with this unit normal, on whose side lights count; zero: on
  /// both sides, or in a volume. `u` is in [0, 1), with 24 bits, as samplers return it. Any light
  /// that reaches the point has a positive probability.
  LightChoice choose(Vec3f point, Vec3f normal, float u) const;

  /// The probability that choose() returns this light, for multiple importance sampling. The sum
  /// over all lights is 1 less the probability of none.
  float probability(Vec3f point, Vec3f normal, uint32_t light) const;

 private:
  struct Node {
    Vec3f center;
    float radius = 0;  // of the sphere around the box
    Vec3f axis;
    float cos_normals = -1, sin_normals = 0, cos_emission = 0;
    float power = 0;         // relative to its sibling's, if that is larger
    uint32_t link : 30 = 0;  // the light, or the first of two children
    uint32_t is_leaf : 1 = 0;
    uint32_t two_sided : 1 = 0;
  };
  static_assert(sizeof(Node) == 48);
  class Builder;

  float importance(const Node& node, Vec3f point, Vec3f normal) const;
  bool is_dark(Vec3f point, Vec3f normal) const;
  double share_of_first(const Node& parent, Vec3f point, Vec3f normal) const;

  std::vector<Node> nodes_;       // from the root; none: no light has power
  std::vector<uint64_t> trails_;  // of each light: the children on its path, from the lowest bit
  float per_unit2_ = 1;           // 1 / the square of the root's radius
};

}  // namespace raio::core
