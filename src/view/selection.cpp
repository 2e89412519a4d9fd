#include "view/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "base/exact_math.h"
#include "io/far_origin.h"
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

Vec3d rounded_place(Vec3d place, double largest) {
  constexpr double kSteps = 4;  // the rounding errors of a hit point
  if (!(largest > 0 && largest < double(std::numeric_limits<float>::max()))) return place;
  const double unit = exact_pow(10, std::ceil(exact_log10(kSteps * float_step(largest))));
  for (int i = 0; i < 3; ++i) place[i] = std::round(place[i] / unit) * unit + 0.0;  // no -0
  return place;
}

std::string either(const std::string& selection, const std::string& other) {
  if (selection.empty()) return other;
  // Numbers join a list of numbers at the end.
  constexpr std::string_view kIndex = "index ", kOr = " or ";
  const size_t or_at = selection.rfind(kOr);
  const std::string_view last =
      std::string_view(selection).substr(or_at == std::string::npos ? 0 : or_at + kOr.size());
  if (other.starts_with(kIndex) && last.starts_with(kIndex) &&
      last.find_first_not_of("0123456789-,", kIndex.size()) == std::string_view::npos)
    return selection + "," + other.substr(kIndex.size());
  return selection + std::string(kOr) + other;
}

std::string but_not(const std::string& selection, const std::string& other) {
  int depth = 0;
  bool has_or = false;  // which binds less tightly than `and`; perhaps only in a name
  for (size_t i = 0; i < selection.size(); ++i) {
    depth += (selection[i] == '(') - (selection[i] == ')');
    has_or |= depth == 0 && (selection[i] == ',' || selection.compare(i, 2, "or") == 0);
  }
  return (has_or ? "(" + selection + ")" : selection) + " and not (" + other + ")";
}

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

std::vector<std::string> Selection::lines(const Scene& scene, const Box3f& box) const {
  if (empty()) return {};
  const Pick& pick = picks_.back();
  std::vector<std::string> lines = {pick.what};
  // Atoms have one for each colour.
  if (!pick.atom) lines[0] += ", " + trf("material {}", pick.material);
  if (!pick.object.empty()) lines.push_back(pick.object);
  if (!pick.in_file.empty()) lines.push_back(pick.in_file);
  const Vec3d place = rounded_place(scene.origin + pick.place, largest_in(box));
  lines.push_back(trf("at {:.12g}, {:.12g}, {:.12g}", place.x, place.y, place.z));
  return lines;
}

}  // namespace raio::core::view
