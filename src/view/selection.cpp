#include "view/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

// Of the vector (x, y), in degrees from -180 to 180. From both components, which is precise at any
// angle.
double direction_deg(double y, double x) {
  if (x == 0 && y == 0) return 0;  // of points at one place
  if (std::abs(y) <= std::abs(x)) {
    const double acute = exact_atan(y / x) * 180 / std::numbers::pi;
    return x > 0 ? acute : y < 0 ? acute - 180 : acute + 180;
  }
  const double rest = exact_atan(x / y) * 180 / std::numbers::pi;
  return y > 0 ? 90 - rest : -90 - rest;
}

}  // namespace

double distance(Vec3d a, Vec3d b) { return length(b - a); }

double angle_deg(Vec3d a, Vec3d b, Vec3d c) {
  return direction_deg(length(cross(a - b, c - b)), dot(a - b, c - b));
}

double dihedral_deg(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  const Vec3d first = b - a, middle = c - b, last = d - c;
  const Vec3d left = cross(first, middle), right = cross(middle, last);
  return direction_deg(length(middle) * dot(first, right), dot(left, right));
}

void Selection::pick(const Pick& pick, bool more) {
  if (!more || picks_.size() == kMost) picks_.clear();
  picks_.push_back(pick);
}

std::string Selection::measure(const std::string& unit) const {
  const auto at = [&](size_t i) { return picks_[i].place; };
  switch (picks_.size()) {
    case 2:
      return trf("distance {:.4g}", distance(at(0), at(1))) + (unit.empty() ? "" : " " + unit);
    case 3:
      return trf("angle {:.2f} degrees", angle_deg(at(0), at(1), at(2)));
    case 4:
      return trf("dihedral {:.2f} degrees", dihedral_deg(at(0), at(1), at(2), at(3)));
    default:
      return {};
  }
}

std::vector<std::string> Selection::lines(const Scene& scene) const {
  if (empty()) return {};
  const Pick& pick = picks_.back();
  std::vector<std::string> lines = {pick.what};
  if (!pick.object.empty()) lines.push_back(pick.object);
  lines.push_back(trf("material {}", pick.material));
  const Vec3d place = scene.origin + pick.place;
  lines.push_back(trf("at {:.6g}, {:.6g}, {:.6g}", place.x, place.y, place.z));
  return lines;
}

}  // namespace raio::core::view
