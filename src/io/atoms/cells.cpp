#include "io/atoms/cells.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace raio::core {
namespace {

constexpr double kOnBorder = 0.02;  // angstroms
constexpr double kRoom = 100;       // volume per atom, cubic angstroms

Vec3d vec_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

// The parallelepiped of all images of a cell.
class Parallelepiped {
 public:
  Parallelepiped(const Cell& cell, const std::array<int, 3>& images)
      : origin_(vec_of(cell.origin)) {
    for (size_t i = 0; i < 3; ++i) side_[i] = vec_of(cell.sides[i]) * images[i];
    for (size_t i = 0; i < 3; ++i) face_[i] = cross(side_[(i + 1) % 3], side_[(i + 2) % 3]);
    volume_ = dot(side_[0], face_[0]);
  }
  bool is_flat() const { return !(volume() > 0); }
  double volume() const { return std::abs(volume_); }
  Vec3d side(int axis) const { return side_[size_t(axis)]; }
  // The distance between the two faces that the side connects.
  double height(int axis) const { return volume() / length(face_[size_t(axis)]); }
  // The fractional coordinate of a position along a side: 0 to 1 inside.
  double part(const Vec3d& place, int axis) const {
    return dot(place - origin_, face_[size_t(axis)]) / volume_;
  }

 private:
  Vec3d origin_;
  std::array<Vec3d, 3> side_, face_;  // a face normal is perpendicular to the other two sides
  double volume_;
};

Vec3d place_of(const Atoms& atoms, size_t i) { return vec_of(atoms.place_of(atoms.atoms[i])); }

}  // namespace

Cell cell_of(const cif::UnitCell& from) {
  Cell cell;
  for (size_t side = 0; side < 3; ++side)
    for (size_t i = 0; i < 3; ++i) cell.sides[side][i] = from.matrix[i][side];
  return cell;
}

std::vector<Vec3d> shifts_of(const Atoms& atoms, const std::array<int, 3>& images) {
  std::vector<Vec3d> out;
  if (!atoms.cell) return {Vec3d()};
  const auto side = [&](size_t i) {
    const auto& s = atoms.cell->sides[i];
    return Vec3d(s[0], s[1], s[2]);
  };
  for (int k = 0; k < images[2]; ++k)
    for (int j = 0; j < images[1]; ++j)
      for (int i = 0; i < images[0]; ++i) out.push_back(side(0) * i + side(1) * j + side(2) * k);
  return out;
}

Atoms repeated(const Atoms& atoms, const std::vector<Vec3d>& shifts,
               const std::array<int, 3>& images) {
  Atoms out = atoms;
  out.atoms.clear(), out.radii.clear(), out.values.clear(), out.bonds.clear();
  out.indices.clear();
  for (const Vec3d& shift : shifts) {
    const auto first = uint32_t(out.atoms.size());
    for (Atom atom : atoms.atoms) {
      for (size_t i = 0; i < 3; ++i) atom.place[i] += float(shift[int(i)]);
      out.atoms.push_back(atom);
    }
    for (uint32_t i = 0; atoms.marks && i < atoms.atoms.size(); ++i)
      out.indices.push_back(atoms.index_of(i));
    out.radii.insert(out.radii.end(), atoms.radii.begin(), atoms.radii.end());
    out.values.insert(out.values.end(), atoms.values.begin(), atoms.values.end());
    for (const auto& [a, b] : atoms.bonds) out.bonds.push_back({first + a, first + b});
  }
  const auto count = uint32_t(atoms.atoms.size());
  for (uint32_t copy = 0; copy < shifts.size(); ++copy)
    for (const auto& [bond, cells] : atoms.bonds_across) {
      uint32_t other = 0, rest = copy;
      bool inside = true;
      for (uint32_t k = 0, stride = 1; k < 3; stride *= uint32_t(images[k++])) {
        const int at = int(rest % uint32_t(images[k])) + cells[k];
        rest /= uint32_t(images[k]);
        inside &= at >= 0 && at < images[k];
        other += uint32_t(at) * stride;
      }
      if (inside) out.bonds.push_back({copy * count + bond[0], other * count + bond[1]});
    }
  return out;
}

bool fill_cell(const Atoms& atoms) {
  const Parallelepiped cell(*atoms.cell, {1, 1, 1});
  if (cell.is_flat()) return false;
  if (atoms.atoms[0].element > 0 && cell.volume() < kRoom * double(atoms.atoms.size())) return true;
  Vec3d low(1e300), high(-1e300);
  for (size_t i = 0; i < atoms.atoms.size(); ++i) {
    int filled = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double part = cell.part(place_of(atoms, i), axis);
      low[axis] = std::min(low[axis], part), high[axis] = std::max(high[axis], part);
      filled += high[axis] - low[axis] > 0.5;
    }
    if (filled >= 2) return true;
  }
  return false;
}

void complete_border(Atoms& atoms, const std::array<int, 3>& images) {
  const Parallelepiped cell(*atoms.cell, images);
  if (cell.is_flat()) return;
  const auto is_taken = [&](const Vec3d& place) {
    for (size_t i = 0; i < atoms.atoms.size(); ++i)
      if (length(place_of(atoms, i) - place) < kOnBorder) return true;
    return false;
  };
  const size_t before = atoms.atoms.size();
  // One axis at a time, so that an atom on an edge gets three images.
  for (int axis = 0; axis < 3; ++axis) {
    if (!atoms.cell->repeats[size_t(axis)]) continue;
    const Vec3d side = cell.side(axis);
    const double height = cell.height(axis);
    for (size_t i = 0, n = atoms.atoms.size(); i < n; ++i) {
      const double part = cell.part(place_of(atoms, i), axis);
      const bool is_low = std::abs(part) * height < kOnBorder;
      if (!is_low && std::abs(part - 1) * height >= kOnBorder) continue;
      const Vec3d moved = place_of(atoms, i) + (is_low ? side : -side);
      if (is_taken(moved)) continue;
      Atom copy = atoms.atoms[i];
      copy.place = atoms.local({moved.x, moved.y, moved.z});
      atoms.atoms.push_back(copy);
      if (!atoms.radii.empty()) atoms.radii.push_back(atoms.radii[i]);
      if (!atoms.values.empty()) atoms.values.push_back(atoms.values[i]);
      if (!atoms.indices.empty()) atoms.indices.push_back(atoms.indices[i]);
    }
  }
  if (const size_t added = atoms.atoms.size() - before; added > 0)
    atoms.notices.add(Severity::guessed, "images of atoms on the faces of the cell", {}, 0, added);
}

}  // namespace raio::core
