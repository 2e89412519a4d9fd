// The numbers of a ray's test with a primitive, for explanations.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "accel/geometry.h"

namespace raio::core::app {

struct TestNumbers {
  const char* formula = "";  // in plain letters, a line per equation
  /// The formula's variables in the order of computation, with one number or three. Those that the
  /// test computes in float are printed with a float's digits.
  std::vector<std::pair<const char*, std::vector<double>>> values;
  /// The condition that lets the ray pass, in the formula's variables: "h^2 < 0". Empty: the ray
  /// hits the surface, although perhaps on a side that is not visible.
  const char* miss = "";
};

/// Computes the test as shape/ does, with the same precision. Positions are in the coordinates of
/// the scene's file.
TestNumbers test_numbers(const Geometry& geometry, PrimitiveId primitive, const Ray& ray);

}  // namespace raio::core::app
