// A ray's walk through its structure, and the shading of what it hits, told step by step as on a
// blackboard: what happens, the variables and the formula. Without a window.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "integrate/explain.h"

namespace raio::view {

/// A step of the algorithm, as the inspector shows it. Words are in the language of the screen.
struct TraversalStep {
  std::string words, formula;
  std::vector<std::pair<std::string, std::string>> variables;  // name and value
  int log_step = -1;  // into TraceLog::steps: the cell, node or leaf that the ray is in
  int test = -1;      // into TraceLog::tests
  double t = 0;       // along the ray, that is reached
};

/// The walk that `log` has of the ray: through the cells of a grid (Amanatides and Woo 1987, "A
/// Fast Voxel Traversal Algorithm for Ray Tracing"), the boxes of a tree, or past all primitives.
/// Every listed test is a step; the last step tells how the walk ends and what is hit. In a grid
/// `t` never decreases.
std::vector<TraversalStep> traversal_words(const ExplainedRay& ray, const TraceLog& log,
                                           const Geometry& geometry, AccelKind kind);

/// What ray `ray` of the sample brings, term by term as in docs/shading.md; of a shadow ray, the
/// terms of its light. The variables "ambient", "diffuse" and "highlight" of the steps add up to
/// "C" of the sum, but for rounding.
std::vector<TraversalStep> shading_words(const Explanation& sample, const Scene& scene,
                                         const RenderSettings& settings, size_t ray);

}  // namespace raio::view
