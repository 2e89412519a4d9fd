// Picked primitives: what they are, and distances and angles between them. No window.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/state.h"

namespace raio::core::view {

/// A place of the file, rounded to what floats tell apart in a scene with coordinates up to
/// `largest`, relative to its origin.
Vec3d rounded_place(Vec3d place, double largest);
/// The largest coordinate of a box.
inline double largest_in(const Box3f& box) {
  return double(max_component(max(abs(box.lo), abs(box.hi))));
}

/// A selection of atoms (io/atoms/select.h) joined with another by `or`.
std::string either(const std::string& selection, const std::string& other);
/// The selection without the atoms of the other.
std::string but_not(const std::string& selection, const std::string& other);

/// The distance between two points; the angle at the second of three, and the dihedral angle of
/// four about the line through the middle ones, in degrees. The dihedral is positive if, seen along
/// that line, the far end is clockwise of the near one (IUPAC 1974).
double distance(Vec3d a, Vec3d b);
double angle_deg(Vec3d a, Vec3d b, Vec3d c);
double dihedral_deg(Vec3d a, Vec3d b, Vec3d c, Vec3d d);

/// Up to four picks, the oldest first.
class Selection {
 public:
  static constexpr size_t kMost = 4;

  /// Replaces all, or with `more` adds; a fifth pick starts anew.
  void pick(const Pick& pick, bool more);
  void clear() { picks_.clear(); }
  bool empty() const { return picks_.empty(); }
  const std::vector<Pick>& picks() const { return picks_; }

  bool is_of_atoms() const {
    return std::ranges::all_of(picks_, [](const Pick& pick) { return pick.atom.has_value(); });
  }

  /// "distance 3.81 Å", or the angle or the dihedral; empty for less than two picks.
  std::string measure(const std::string& unit = {}) const;
  /// The last pick, a fact per line: what it is, its place in the file's coordinates. `box`: of the
  /// scene's primitives.
  std::vector<std::string> lines(const Scene& scene, const Box3f& box) const;

 private:
  std::vector<Pick> picks_;
};

/// What the panel shows of it, and offers to do with it.
struct SelectionFacts {
  std::vector<std::string> lines;  // empty: nothing is selected
  std::optional<MaterialId> material;
  bool can_focus = false;
  bool is_atom = false, has_residue = false, has_chain = false;  // to hide or colour
};

}  // namespace raio::core::view
