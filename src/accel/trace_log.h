// The steps of one ray in a structure, for inspection.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/box.h"
#include "base/ray.h"

namespace raio::core {

class Geometry;

struct TraceLog {
  /// A test of the ray with a primitive.
  struct Test {
    PrimitiveId primitive = kNoPrimitive;
    bool repeated = false;                             // not tested: it was, in an earlier cell
    float t = std::numeric_limits<float>::infinity();  // of the hit; infinite for a miss
    bool nearest = false;                              // nearer than all earlier hits
  };
  /// A cell of a grid, or a node or leaf of a tree.
  struct Step {
    std::array<int, 3> cell{};
    Vec3d t_max{};      // where the ray leaves the cell along each axis
    uint32_t node = 0;  // for a leaf, the index of its block within its kind
    bool leaf = false;
    int depth = 0;
    Box3f box{};
    size_t first_test = 0;  // its tests are from here to those of the next step
  };
  std::vector<Step> steps;
  std::vector<Test> tests;      // those before steps[0].first_test belong to no cell or node
  Vec3d t_delta;                // for a grid: from one plane to the next
  std::optional<double> enter;  // for a grid: where the ray enters it; nothing if it does not
  uint64_t unlisted = 0;        // tests without a structure, where only hits are listed

  void add_test(PrimitiveId id, bool repeated = false) { tests.push_back({id, repeated}); }

  /// The counted steps: without a tree's leaves, and without repetitions.
  uint64_t count_steps() const;
  uint64_t count_tests() const;
};

/// Sets `t` and `nearest` of all tests, as the structure found them.
void judge_tests(TraceLog& log, const Geometry& geometry, const Ray& ray);

}  // namespace raio::core
