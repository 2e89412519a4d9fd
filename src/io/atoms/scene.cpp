// From atoms to a scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "base/parallel.h"
#include "io/atoms/colors.h"
#include "io/atoms/lines.h"
#include "io/atoms/read.h"
#include "io/colormaps.h"
#include "io/fit_camera.h"
#include "io/points.h"

namespace raio {
namespace {

// So many atoms are still seen one by one.
constexpr size_t kFew = 300;
constexpr float kLargest = 1e9f;  // number of a matrix, so that what it moves stays near
constexpr float kStick = 0.15f, kBond = 0.12f, kBallPart = 0.27f, kPoint = 0.25f;

std::unexpected<Diagnostics> failed(std::string_view file, std::string message) {
  return std::unexpected(
      Diagnostics{{Severity::error, std::string(file), 0, 0, std::move(message), ""}});
}

Vec3f place_of(const Atom& atom) { return {atom.place[0], atom.place[1], atom.place[2]}; }

class SceneMaker {
 public:
  SceneMaker(const Atoms& atoms, std::string_view file, const ReadOptions& options)
      : atoms_(atoms), file_(file), options_(options) {}

  std::expected<ReadScene, Diagnostics> make() {
    if (atoms_.atoms.empty())
      return failed(file_, fmt::format("there is no frame {}; the file has {}", options_.frame,
                                       atoms_.frames));
    has_elements_ = std::ranges::any_of(atoms_.atoms, [](const Atom& a) { return a.element > 0; });
    const bool few = atoms_.atoms.size() <= kFew && (has_elements_ || !atoms_.bonds.empty());
    style_ = options_.style.value_or(few ? AtomStyle::ball_and_stick : AtomStyle::space_filling);
    if (!has_elements_ && atoms_.radii.empty()) {
      std::vector<Vec3f> places;
      for (const Atom& atom : atoms_.atoms) places.push_back(place_of(atom));
      particle_radius_ = mean_spacing(places) / 2;
    }
    Scene& scene = read_.scene;
    scene.dialect = Dialect::data;
    read_.frames = atoms_.frames;
    if (auto wrong = color_atoms(); !wrong.empty()) return failed(file_, wrong);
    if (auto wrong = add_spheres(); !wrong.empty()) return failed(file_, wrong);
    if (style_ == AtomStyle::ball_and_stick || style_ == AtomStyle::sticks)
      if (!add_bonds())
        return failed(file_,
                      "too many atoms are at one place for bonds between them; choose the "
                      "`style` space-filling or points");
    fit_camera(scene, FitView::principal);
    return std::move(read_);
  }

 private:
  float radius_of(size_t atom) const {
    if (style_ == AtomStyle::sticks) return kStick;
    if (style_ == AtomStyle::points) return options_.radius > 0 ? options_.radius : kPoint;
    const float whole = !atoms_.radii.empty() ? atoms_.radii[atom]
                        : options_.radius > 0 ? options_.radius
                        : has_elements_       ? van_der_waals_radius(atoms_.atoms[atom].element)
                                              : particle_radius_;
    return style_ == AtomStyle::ball_and_stick ? kBallPart * whole : whole;
  }

  MaterialId material(Rgb color) {
    const auto [at, is_new] = materials_.emplace(std::array{color.x, color.y, color.z}, 0);
    if (is_new) at->second = read_.scene.add_material({.color = color, .kd = 1});
    return at->second;
  }

  // A material for each atom; the error.
  std::string color_atoms() {
    const bool has_types = atoms_.atoms[0].part > 0 && atoms_.chains.empty();
    const std::string by = !options_.color_by.empty()    ? options_.color_by
                           : has_types && !has_elements_ ? "type"
                                                         : "element";
    // One of a few colours, as the table below has room for.
    uint8_t (*which)(const Atom&) = nullptr;
    Rgb (*color)(uint8_t) = [](uint8_t n) { return distinct_color(n); };
    if (by == "element") {
      which = [](const Atom& a) { return a.element; };
      color = [](uint8_t n) { return element_color(n); };
    }
    if (by == "chain") which = [](const Atom& a) { return uint8_t(a.chain % kDistinctColors); };
    if (by == "residue") which = [](const Atom& a) { return uint8_t(a.residue % kDistinctColors); };
    if (by == "type" && has_types)
      which = [](const Atom& a) { return uint8_t((a.part - 1) % kDistinctColors); };
    const auto numbers = which ? std::vector<float>() : numbers_of(by);
    if (!which && numbers.empty())
      return fmt::format(
          "cannot colour by '{}'; expected element, chain, residue, index, bfactor "
          "or occupancy{}{}",
          printable(by), atoms_.columns.empty() ? "" : ", or a column of the file: ",
          printable(fmt::format("{}", fmt::join(atoms_.columns, ", "))));
    if (which && !options_.colormap.empty())
      return fmt::format(
          "a colour map has no effect on atoms coloured by {}; colour them by "
          "index, bfactor, occupancy or a column of numbers",
          by);
    material_.resize(atoms_.atoms.size());
    if (which) {
      std::array<std::optional<MaterialId>, 256> known;
      for (size_t i = 0; i < material_.size(); ++i) {
        const uint8_t n = which(atoms_.atoms[i]);
        if (!known[n]) known[n] = material(color(n));
        material_[i] = *known[n];
      }
      return {};
    }
    // Maps have 256 colours, so as many materials do.
    const auto colors = map_colors(numbers, options_.colormap);
    if (!colors) return colors.error();
    for (size_t i = 0; i < material_.size(); ++i) material_[i] = material((*colors)[i]);
    return {};
  }

  // What a colour map makes colours of; nothing: there is no such thing.
  std::vector<float> numbers_of(std::string_view by) const {
    if (by != "index" && by != "bfactor" && by != "occupancy") return atoms_.values;
    std::vector<float> out(atoms_.atoms.size());
    for (size_t i = 0; i < out.size(); ++i)
      out[i] = by == "index"     ? float(i)
               : by == "bfactor" ? atoms_.atoms[i].b_factor
                                 : atoms_.atoms[i].occupancy;
    return out;
  }

  // Of the file, or of the copies of an assembly; the error.
  std::string add_spheres() {
    const bool has = !atoms_.assemblies.empty();
    const int wanted =
        options_.assembly.value_or(has && style_ == AtomStyle::space_filling ? 1 : 0);
    if (wanted == 0) {
      add_atoms(read_.scene, nullptr);
      return {};
    }
    if (wanted < 0 || size_t(wanted) > atoms_.assemblies.size())
      return fmt::format("there is no assembly {}; the file has {}", wanted,
                         atoms_.assemblies.size());
    if (style_ == AtomStyle::ball_and_stick || style_ == AtomStyle::sticks)
      return "assemblies are drawn without bonds; choose the style space-filling or points";
    for (const Assembly::Copies& copies : atoms_.assemblies[size_t(wanted) - 1].copies) {
      std::vector<bool> chosen;
      for (const uint32_t part : copies.parts) {
        if (part >= chosen.size()) chosen.resize(size_t(part) + 1);
        chosen[part] = true;
      }
      Scene& scene = read_.scene;
      Scene object;
      add_atoms(object, &chosen);
      if (object.spheres.empty()) continue;
      object.materials = scene.materials;
      for (const Matrix& matrix : copies.matrices)
        scene.instances.push_back({uint32_t(scene.prototypes.size()), matrix});
      scene.prototypes.push_back(std::move(object));
    }
    return read_.scene.instances.empty() ? "the assembly has no atoms" : "";
  }

  // Those whose parts are chosen; null: all.
  void add_atoms(Scene& scene, const std::vector<bool>* chosen) const {
    std::vector<uint32_t> some;
    for (uint32_t i = 0; i < atoms_.atoms.size(); ++i) {
      const uint32_t part = atoms_.atoms[i].part;
      if (!chosen || (part < chosen->size() && (*chosen)[part])) some.push_back(i);
    }
    scene.spheres.resize(some.size());
    scene.sphere_materials.resize(some.size());
    Sphere* const spheres = scene.spheres.data();
    MaterialId* const materials = scene.sphere_materials.data();
    for_each_index(some.size(), [&](size_t i) {
      spheres[i] = {place_of(atoms_.atoms[some[i]]), radius_of(some[i])};
      materials[i] = material_[some[i]];
    });
  }

  // Cylinders, half of each in the colour of the atom at its end.
  bool add_bonds() {
    Scene& scene = read_.scene;
    const float radius = style_ == AtomStyle::sticks ? kStick : kBond;
    Bonds bonds = atoms_.bonds;
    if (atoms_.finds_bonds) {
      const auto found = find_bonds(atoms_.atoms);
      if (!found) return false;
      bonds.insert(bonds.end(), found->begin(), found->end());
      std::ranges::sort(bonds);
      bonds.erase(std::ranges::unique(bonds).begin(), bonds.end());
    }
    for (const auto& [a, b] : bonds) {
      const Vec3f from = place_of(atoms_.atoms[a]), to = place_of(atoms_.atoms[b]);
      const Vec3f middle = (from + to) * 0.5f;
      const auto add = [&](Vec3f base, Vec3f apex, MaterialId id) {
        if (base == apex) return;  // atoms at one place
        scene.cones.push_back({base, radius, apex, radius});
        scene.cone_materials.push_back(id);
      };
      if (material_[a] == material_[b]) {
        add(from, to, material_[a]);
      } else {
        add(from, middle, material_[a]);
        add(middle, to, material_[b]);
      }
    }
    return true;
  }

  const Atoms& atoms_;
  std::string_view file_;
  const ReadOptions& options_;
  AtomStyle style_ = AtomStyle::space_filling;
  bool has_elements_ = false;
  float particle_radius_ = 1;  // of atoms without elements
  ReadScene read_;
  std::map<std::array<float, 3>, MaterialId> materials_;
  std::vector<MaterialId> material_;  // of each atom
};

}  // namespace

std::expected<ReadScene, Diagnostics> scene_of_atoms(const Atoms& atoms, std::string_view file,
                                                     const ReadOptions& options) {
  for (size_t i = 0; i < atoms.atoms.size(); ++i)
    if (!is_place(place_of(atoms.atoms[i])))
      return failed(file, fmt::format("atom {} has no finite place", i + 1));
  for (const Assembly& assembly : atoms.assemblies)
    for (const Assembly::Copies& copies : assembly.copies)
      for (const auto& matrix : copies.matrices)
        for (const float number : matrix)
          if (!(std::abs(number) <= kLargest))
            return failed(file, "a matrix of an assembly has a number that is not finite");
  for (const Assembly& assembly : atoms.assemblies)
    for (const Assembly::Copies& copies : assembly.copies)
      for (const auto& matrix : copies.matrices)
        if (!Placement(matrix).is_sound())
          return failed(file, "a matrix of an assembly has no inverse");
  for (size_t i = 0; i < atoms.radii.size(); ++i)
    if (!(atoms.radii[i] <= kFarthestPlace))
      return failed(file, fmt::format("atom {} has a radius that is too large", i + 1));
  return SceneMaker(atoms, file, options).make();
}

}  // namespace raio
