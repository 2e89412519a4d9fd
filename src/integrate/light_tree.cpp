#include "integrate/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace raio::core {

// Bounds of some lights, during the build.
struct LightGroup {
  Box3f box;
  Vec3f axis;
  float cos_normals = 1, sin_normals = 0, cos_emission = 1;
  bool two_sided = false;
  uint32_t light = 0;
  double power = 0;  // 0: of no light
};

namespace {

// The trail of a light that is never chosen. No path has as many levels.
constexpr uint64_t kNoTrail = ~uint64_t(0);
constexpr int kMostLevels = 63;

// Limits that keep an importance within the normal floats: relative to its sibling, a node has at
// least this power; distances are relative to the root's radius.
constexpr double kLeastPower = 1e-9;
constexpr float kNearestNode = 1e-6f, kFarthestNodeSquared = 1e13f;
// The error of a cosine, mostly that of sqrt(1 - c^2) near c = 1, where floats have gaps of 2^-24.
constexpr float kCosineSlack = 5e-4f;
// The importance of a cosine is at least this. Those near zero are mostly rounding.
constexpr float kLeastCosine = 1e-3f;
// Of a child that the light may come from: the resolution of samples.
constexpr double kLeastShare = 0x1p-24;

float sine_of(float cosine) { return std::sqrt(std::max(0.0f, (1 - cosine) * (1 + cosine))); }

// Widens the cone of normals to include those of `other`, whose axis is `to`. The cone of two sides
// has a free sign. Cones wider than a right angle on each side become whole spheres: they exclude
// next to nothing.
void widen(LightGroup& group, const LightGroup& other) {
  // Several rounding errors. A cone that grows by less would exclude some of its lights.
  constexpr float kRounding = 1e-6f;
  const float sign = group.two_sided && dot(group.axis, other.axis) < 0 ? -1.0f : 1.0f;
  const Vec3f to = other.axis * sign;
  const float cos_a = group.cos_normals, sin_a = group.sin_normals;
  const float cos_b = other.cos_normals, sin_b = other.sin_normals;
  if (cos_a == -1 || (group.axis == to && cos_b >= cos_a)) return;
  const auto set = [&](Vec3f axis, float cosine) {
    group.axis = axis, group.cos_normals = cosine, group.sin_normals = sine_of(cosine);
  };
  const float cosine = dot(group.axis, to), between = cos_a * cos_b + sin_a * sin_b;
  if (cosine - kRounding > between || group.axis == to) {  // one cone contains the other
    if (cos_b < cos_a) set(to, cos_b);
    return;
  }
  const Vec3f aside = to - group.axis * cosine;
  const float sine = length(aside);
  if (sine < kRounding && cosine > 0) return set(group.axis, std::min(cos_a, cos_b) - kRounding);
  // In the plane of both axes: the new cone extends from the one's far edge to the other's.
  const float x = cosine * cos_b - sine * sin_b, y = sine * cos_b + cosine * sin_b;
  const float cos_all = cos_a * x - sin_a * y, sin_all = cos_a * y + sin_a * x;
  if (!(y > 0 && sin_all > 0 && cos_all > -0.999f)) return set(group.axis, -1);
  const Vec3f axis = group.axis * (cos_a + x) + aside * ((y - sin_a) / sine);
  set(normalize(axis), std::sqrt((1 + cos_all) / 2) - kRounding);
}

void add(LightGroup& group, const LightGroup& other) {
  if (group.power == 0) {
    group = other;
    return;
  }
  group.box.extend(other.box);
  group.two_sided |= other.two_sided;
  widen(group, other);
  group.cos_emission = std::min(group.cos_emission, other.cos_emission);
  group.power += other.power;
}

// The solid angle into which the group shines, weighted by its cosine falloff, over 2 pi: M_Omega
// in the paper.
double spread(const LightGroup& g) {
  const float c = g.cos_normals, s = g.sin_normals;
  const float cos_more = std::max(g.cos_emission, -c), sin_more = sine_of(cos_more);
  double all = 0;
  if (g.cos_emission < 0) {
    all = double(1 - (c * cos_more - s * sin_more));
  } else {
    // The arccosine to 7e-5: Abramowitz and Stegun 1964, 4.4.45.
    const float angle =
        std::sqrt(1 - cos_more) *
        (1.5707288f + cos_more * (-0.2121144f + cos_more * (0.074261f - cos_more * 0.0187293f)));
    const float cos_twice = 2 * cos_more * cos_more - 1, sin_twice = 2 * cos_more * sin_more;
    all = double(1 - c + 0.25f * (c - (c * cos_twice - s * sin_twice)) + 0.5f * s * angle);
  }
  return g.two_sided ? std::min(2 * all, 2.0) : all;
}

// The surface area orientation heuristic. The area is that of the sphere around the box, up to a
// factor: importance() uses the sphere, and boxes of lights in a row have no area.
double cost(const LightGroup& g) {
  const Vec3d size = Vec3d(g.box.hi) - Vec3d(g.box.lo);
  return g.power * dot(size, size) * spread(g);
}

constexpr int kLightBins = 12;

// Into which of some equal slices, at most kLightBins, the centre of a group falls.
struct Slices {
  int axis = 0, count = 0;
  float low = 0, per_length = 0;

  int of(const LightGroup& g) const {
    const float at = (g.box.center()[axis] - low) * per_length;
    return std::min(int(at), count - 1);
  }
};

// The cosine of the angle a - b, but of no less than 0. Angles are 0 to pi.
float cosine_beyond(float cos_a, float cos_b, float sin_b) {
  return cos_a >= cos_b ? 1.0f : cos_a * cos_b + sine_of(cos_a) * sin_b;
}

}  // namespace

class LightTree::Builder {
 public:
  Builder(LightTree& tree, std::span<const LightBounds> lights) : tree_(tree) {
    Box3f around;
    for (const LightBounds& l : lights) {
      const auto number = uint32_t(&l - lights.data());
      if (!(l.power > 0)) continue;
      groups_.push_back({l.box, l.axis, l.cos_normals, sine_of(l.cos_normals), l.cos_emission,
                         l.two_sided, number, double(l.power)});
      around.extend(l.box);
    }
    tree.trails_.assign(lights.size(), kNoTrail);
    if (groups_.empty()) return;
    moved_.resize(groups_.size());
    tree.nodes_.resize(2 * groups_.size() - 1);
    const float unit = std::max(float(length(Vec3d(around.hi) - Vec3d(around.lo)) / 2), 1e-12f);
    nearest_ = kNearestNode * unit;
    tree.per_unit2_ = 1 / (unit * unit);
    const LightGroup all = build(0, groups_.size(), 0, 1, 0, 0);
    place(all, all.power, tree.nodes_[0]);
  }

 private:
  // Builds the subtree of a range of groups, and returns its bounds. Its nodes are `number` and
  // those from `next` on, two for each split.
  LightGroup build(size_t begin, size_t end, size_t number, size_t next, uint64_t trail,
                   int depth) {
    Node& node = tree_.nodes_[number];
    if (end - begin == 1) {
      node.is_leaf = 1, node.link = groups_[begin].light & kLinks;
      tree_.trails_[groups_[begin].light] = trail;
      return groups_[begin];
    }
    node.link = uint32_t(next) & kLinks;
    const size_t middle = split(begin, end, depth);
    LightGroup first, second;
    const auto build_first = [&] {
      first = build(begin, middle, next, next + 2, trail, depth + 1);
    };
    const auto build_second = [&] {
      second = build(middle, end, next + 1, next + 2 * (middle - begin),
                     trail | uint64_t(1) << depth, depth + 1);
    };
    if (end - begin > kLoopChunk)
      check_stop(), parallel_invoke(build_first, build_second);
    else
      build_first(), build_second();
    const double most = std::max(first.power, second.power);
    place(first, most, tree_.nodes_[next]), place(second, most, tree_.nodes_[next + 1]);
    add(first, second);
    return first;
  }

  // Sorts the groups into two parts, and returns where the second begins.
  size_t split(size_t begin, size_t end, int depth) {
    const size_t count = end - begin, half = begin + count / 2;
    // In halves, so that the trails suffice.
    if (count == 2 || depth + std::bit_width(count - 1) >= kMostLevels) return half;
    Box3f centers;
    for (size_t i = begin; i < end; ++i) centers.extend(groups_[i].box.center());
    const auto bins_used = int(std::min(count, size_t(kLightBins)));
    double least = std::numeric_limits<double>::infinity();
    Slices best;
    int first_of_second = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float per_length = float(bins_used) / centers.size()[axis];
      const Slices slices{axis, bins_used, centers.lo[axis], per_length};
      if (!std::isfinite(slices.per_length) || !(slices.per_length > 0)) continue;
      std::array<LightGroup, kLightBins> bins;
      for (size_t i = begin; i < end; ++i) add(bins[slices.of(groups_[i])], groups_[i]);
      std::array<double, kLightBins> costs{};  // of the bins from here on
      LightGroup sum;
      for (int b = bins_used - 1; b > 0; --b) {
        if (bins[b].power > 0) add(sum, bins[b]);
        costs[b] = cost(sum);
      }
      sum = {};
      for (int b = 1; b < bins_used; ++b) {
        if (!(bins[b - 1].power > 0)) continue;  // as the split before
        add(sum, bins[b - 1]);
        if (const double both = cost(sum) + costs[b]; both < least)
          least = both, best = slices, first_of_second = b;
      }
    }
    if (first_of_second == 0) return half;  // all centres are equal
    // Stable, unlike std::partition, whose order depends on the library.
    size_t first = begin, second = begin;
    for (size_t i = begin; i < end; ++i) {
      if (best.of(groups_[i]) < first_of_second)
        groups_[first++] = groups_[i];
      else
        moved_[second++] = groups_[i];
    }
    std::copy(&moved_[begin], &moved_[begin] + (second - begin), &groups_[first]);
    return first;
  }

  void place(const LightGroup& group, double most, Node& node) const {
    node.center = group.box.center();
    const Vec3d c(node.center), reach = max(Vec3d(group.box.hi) - c, c - Vec3d(group.box.lo));
    node.radius = std::max(float(length(reach)) * (1 + 1e-6f), nearest_);
    node.axis = group.axis, node.two_sided = group.two_sided;
    node.cos_normals = group.cos_normals, node.sin_normals = group.sin_normals;
    node.cos_emission = group.cos_emission;
    node.power = float(std::max(group.power / most, kLeastPower));
  }

  static constexpr uint32_t kLinks = (uint32_t(1) << 30) - 1;

  LightTree& tree_;
  std::vector<LightGroup> groups_, moved_;
  float nearest_ = 0;
};

LightTree::LightTree(std::span<const LightBounds> lights) { Builder(*this, lights); }

// A bound of the light that arrives: the power over the squared distance, times the largest cosines
// between the directions from the node's sphere and its normals, and between those to the sphere
// and the surface's normal.
float LightTree::importance(const Node& node, Vec3f point, Vec3f normal) const {
  const Vec3f to = node.center - point;
  const float squared = dot(to, to), radius2 = node.radius * node.radius;
  const float distance2 = std::min(std::max(squared, radius2) * per_unit2_, kFarthestNodeSquared);
  float result = node.power / distance2;
  if (squared <= radius2) return result;
  const float inverse = 1 / std::sqrt(squared);
  const Vec3f dir = to * inverse;
  const float sin_size = node.radius * inverse, cos_size = sine_of(sin_size);
  const float sin_both = node.sin_normals * cos_size + node.cos_normals * sin_size;
  if (sin_both > 0) {  // the spread of normals and the sphere are less than all directions
    const float cos_both = node.cos_normals * cos_size - node.sin_normals * sin_size;
    const float along = -dot(node.axis, dir);
    const float cosine =
        cosine_beyond(node.two_sided ? std::abs(along) : along, cos_both, sin_both);
    if (cosine < node.cos_emission - kCosineSlack) return 0;
    if (node.cos_emission >= 0) result *= std::max(cosine, kLeastCosine);
  }
  if (normal != Vec3f()) {
    const float cosine = cosine_beyond(dot(normal, dir), cos_size, sin_size);
    if (cosine < -kCosineSlack) return 0;
    result *= std::max(cosine, kLeastCosine);
  }
  return result;
}

// Whether the tree is empty, or its only light does not reach the point. In larger trees,
// share_of_first() of the root finds out.
bool LightTree::is_dark(Vec3f point, Vec3f normal) const {
  return nodes_.empty() || (nodes_[0].is_leaf && importance(nodes_[0], point, normal) == 0);
}

// The probability of the first child; negative if neither reaches the point.
double LightTree::share_of_first(const Node& parent, Vec3f point, Vec3f normal) const {
  const Node* const children = &nodes_[parent.link];
  const auto first = double(importance(children[0], point, normal));
  const auto second = double(importance(children[1], point, normal));
  if (first == 0 || second == 0) return first > 0 ? 1 : second > 0 ? 0 : -1;
  return std::clamp(first / (first + second), kLeastShare, 1 - kLeastShare);
}

LightChoice LightTree::choose(Vec3f point, Vec3f normal, float u) const {
  if (is_dark(point, normal)) return {};
  // In the middle between this number of 24 bits and the next one, neither 0 nor 1: a child of
  // probability 0 or 1 needs no special case. Doubles keep the bits of `u` down the tree.
  double rest = double(u) + 0x1p-25, probability = 1;
  const Node* node = nodes_.data();
  while (!node->is_leaf) {
    const double share = share_of_first(*node, point, normal);
    if (share < 0) return {};
    const bool is_second = !(rest < share);
    const double part = is_second ? 1 - share : share;
    rest = std::min((is_second ? rest - share : rest) / part, 1 - 0x1p-53);
    probability *= part;
    node = &nodes_[node->link + is_second];
  }
  return {node->link, float(probability)};
}

float LightTree::probability(Vec3f point, Vec3f normal, uint32_t light) const {
  uint64_t trail = trails_[light];
  if (trail == kNoTrail || is_dark(point, normal)) return 0;
  double probability = 1;
  for (const Node* node = nodes_.data(); !node->is_leaf; trail >>= 1) {
    const double share = share_of_first(*node, point, normal);
    const bool is_second = trail & 1;
    probability *= share < 0 ? 0 : is_second ? 1 - share : share;
    node = &nodes_[node->link + is_second];
  }
  return float(probability);
}

}  // namespace raio::core
