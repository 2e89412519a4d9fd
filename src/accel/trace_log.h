// What one ray does in a structure, step by step, for those who look into it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/box.h"
#include "base/ray.h"

namespace raio {

class Geometry;

struct TraceLog {
  /// Of the ray and a primitive.
  struct Test {
    PrimitiveId primitive = kNoPrimitive;
    bool repeated = false;                             // not tested: it was, in a cell before
    float t = std::numeric_limits<float>::infinity();  // of the hit; infinite where it is missed
    bool nearest = false;                              // nearer than all hits before
  };
  /// A cell of a grid, or a node or leaf of a tree.
  struct Step {
    std::array<int, 3> cell{};
    Vec3d t_max{};      // where the ray leaves the cell along each axis
    uint32_t node = 0;  // a leaf's number is that of its block among those of its kind
    bool leaf = false;
    int depth = 0;
    Box3f box{};
    size_t first_test = 0;  // its tests are from here to those of the next step
  };
  std::vector<Step> steps;
  std::vector<Test> tests;      // those before steps[0].first_test: what belongs to no cell or node
  Vec3d t_delta;                // of a grid: from one plane to the next
  std::optional<double> enter;  // of a grid: where the ray enters it; nothing where it does not
  uint64_t unlisted = 0;        // tests without a structure, of which only the hits are listed

  void add_test(PrimitiveId id, bool repeated = false) { tests.push_back({id, repeated}); }

  /// As they are counted: of a tree without its leaves, and without repetitions.
  uint64_t count_steps() const;
  uint64_t count_tests() const;
};

/// Sets `t` and `nearest` of all tests, as the structure came by them.
void judge_tests(TraceLog& log, const Geometry& geometry, const Ray& ray);

}  // namespace raio
