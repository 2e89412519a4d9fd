// A ray's traversal of its structure, and the shading of its hit, explained step by step as on a
// blackboard: what happens, the variables and the formula. Without a window.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "integrate/explain.h"

namespace raio::core::view {

/// A step of the algorithm for the inspector, in the window's language.
struct TraversalStep {
  std::string words, formula;
  std::vector<std::pair<std::string, std::string>> variables;  // name and value
  int log_step = -1;  // index in TraceLog::steps: the current cell, node or leaf
  int test = -1;      // index in TraceLog::tests
  double t = 0;       // reached along the ray
};

/// The traversal in the ray's `log`: through the cells of a grid (Amanatides and Woo 1987, "A Fast
/// Voxel Traversal Algorithm for Ray Tracing"), the boxes of a tree, or past all primitives. Every
/// listed test is a step; the last step tells how the traversal ends and what is hit. In a grid `t`
/// never decreases.
std::vector<TraversalStep> traversal_words(const ExplainedRay& ray, const TraceLog& log,
                                           const Geometry& geometry, AccelKind kind);

/// The contribution of ray `ray` of the sample, term by term as in docs/shading.md; for a shadow
/// ray, the terms of its light. The variables "ambient", "diffuse" and "highlight" of the steps add
/// up to "C" of the sum, except for rounding.
std::vector<TraversalStep> shading_words(const Explanation& sample, const Scene& scene,
                                         const RenderSettings& settings, size_t ray);

}  // namespace raio::core::view
