// Data far from 0, such as UTM maps, exceeds the digits of a float: a reader subtracts a nearby
// origin, in double, before it rounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "base/exact_math.h"
#include "scene/scene.h"

namespace raio::core {

/// The origin of a scene's coordinates while its file is read. The first position proposes it, and
/// all others must be near; if one is not, reading restarts without (read_about()).
class FileOrigin {
 public:
  /// Thrown if data is not far from 0 after all.
  struct NotFar {};

  FileOrigin() = default;
  static FileOrigin zero() {
    FileOrigin origin;
    origin.is_chosen_ = true;
    return origin;
  }

  /// A position of the file, relative to the origin; NaN stays NaN.
  Vec3f local(Vec3d place) {
    if (!is_chosen_) choose(place);
    const Vec3d near = place - value_;
    if (is_far()) check(near);
    return Vec3f(near);
  }
  /// Proposes it, once, from the first position.
  void choose(Vec3d place) {
    const double largest = max_component(abs(place));
    if (is_chosen_ || !std::isfinite(place.x + place.y + place.z)) return;
    is_chosen_ = true;
    if (!(largest >= kFar && largest <= kFarthest)) return;
    // A round number, exact in doubles and readable.
    const double unit = exact_pow(10, std::floor(exact_log10(largest / kFar)));
    for (int a = 0; a < 3; ++a) value_[a] = std::round(place[a] / unit) * unit;
    farthest_ = largest / kTimesExtent;
  }
  /// Checks a position relative to the origin.
  void check(Vec3d near) const {
    if (max_component(abs(near)) > farthest_) throw NotFar{};
  }

  bool is_far() const { return value_ != Vec3d(); }
  Vec3d value() const { return value_; }

 private:
  // A float has seven digits: below kFar, 0.001 is exact enough. Beyond kFarthest, a double is no
  // better than a float.
  static constexpr double kFar = 4096, kFarthest = 1e12;
  // Data with an extent above a hundredth of its distance keeps five digits.
  static constexpr double kTimesExtent = 100;

  bool is_chosen_ = false;
  Vec3d value_;
  double farthest_ = 0;
};

/// The spacing of floats at this size; coordinates of that size are multiples of it.
inline double float_step(double size) {
  return double(std::nextafter(float(size), std::numeric_limits<float>::infinity()) - float(size));
}

/// The result of read(FileOrigin&), with an origin if data is far from 0.
template <class Read>
auto read_about(const Read& read) {
  try {
    FileOrigin origin;
    return read(origin);
  } catch (const FileOrigin::NotFar&) {
    FileOrigin origin = FileOrigin::zero();
    return read(origin);
  }
}

}  // namespace raio::core
