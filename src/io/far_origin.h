// Data far from 0, such as maps in UTM, whose digits a float does not hold: a reader subtracts a
// place near all of it, in double, before it rounds.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/box.h"
#include "base/exact_math.h"
#include "scene/scene.h"

namespace raio {

/// What a scene's coordinates are relative to while its file is read. The first place proposes it,
/// and all others must be near; where one is not, reading begins again without (read_about()).
class FileOrigin {
 public:
  /// Thrown where data is not far from 0 after all.
  struct NotFar {};

  FileOrigin() = default;
  static FileOrigin zero() {
    FileOrigin origin;
    origin.is_chosen_ = true;
    return origin;
  }

  /// A place of the file, relative to the origin; NaN stays what it is.
  Vec3f local(Vec3d place) {
    if (!is_chosen_) choose(place);
    const Vec3d near = place - value_;
    if (is_far()) check(near);
    return Vec3f(near);
  }
  /// Proposes it, once, by the first place.
  void choose(Vec3d place) {
    const double largest = max_component(abs(place));
    if (is_chosen_ || !std::isfinite(place.x + place.y + place.z)) return;
    is_chosen_ = true;
    if (!(largest >= kFar && largest <= kFarthest)) return;
    // A round number, which doubles hold and people read.
    const double unit = exact_pow(10, std::floor(exact_log10(largest / kFar)));
    for (int a = 0; a < 3; ++a) value_[a] = std::round(place[a] / unit) * unit;
    farthest_ = largest / kTimesExtent;
  }
  /// Of a place relative to the origin.
  void check(Vec3d near) const {
    if (max_component(abs(near)) > farthest_) throw NotFar{};
  }

  bool is_far() const { return value_ != Vec3d(); }
  Vec3d value() const { return value_; }

 private:
  // A float has seven digits: below, 0.001 is kept. Beyond, a double has no more than a float has.
  static constexpr double kFar = 4096, kFarthest = 1e12;
  // What is as wide as a hundredth of its distance keeps five digits of its own.
  static constexpr double kTimesExtent = 100;

  bool is_chosen_ = false;
  Vec3d value_;
  double farthest_ = 0;
};

/// How far the next float is from a number so large: coordinates of that size are multiples of it.
inline double float_step(double size) {
  return double(std::nextafter(float(size), std::numeric_limits<float>::infinity()) - float(size));
}

/// What read(FileOrigin&) gives, with an origin where data is far from 0.
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

}  // namespace raio
