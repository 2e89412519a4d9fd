// From atoms to a scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/fit_camera.h"

namespace raio {
namespace {

// So many atoms are still seen one by one.
constexpr size_t kFew = 300;
// So that all that is computed of them stays finite.
constexpr float kFarthest = 1e25f, kLargest = 1e9f;
constexpr float kStick = 0.15f, kBond = 0.12f, kBallPart = 0.27f, kPoint = 0.25f;

std::unexpected<Diagnostics> failed(std::string_view file, std::string message) {
  return std::unexpected(
      Diagnostics{{Severity::error, std::string(file), 0, 0, std::move(message), ""}});
}

Vec3f place_of(const Atom& atom) { return {atom.place[0], atom.place[1], atom.place[2]}; }

Vec3f moved(const std::array<float, 12>& m, Vec3f p) {
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

class SceneMaker {
 public:
  SceneMaker(const Atoms& atoms, std::string_view file, const ReadOptions& options)
      : atoms_(atoms), file_(file), options_(options) {}

  std::expected<ReadScene, Diagnostics> make() {
    if (atoms_.atoms.empty())
      return failed(file_, fmt::format("there is no frame {}; the file has {}", options_.frame,
                                       atoms_.frames));
    style_ = options_.style.value_or(atoms_.atoms.size() > kFew ? AtomStyle::space_filling
                                                                : AtomStyle::ball_and_stick);
    Scene& scene = read_.scene;
    scene.dialect = Dialect::data;
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
  float radius_of(const Atom& atom) const {
    if (style_ == AtomStyle::sticks) return kStick;
    if (style_ == AtomStyle::points) return options_.radius > 0 ? options_.radius : kPoint;
    const float whole = options_.radius > 0 ? options_.radius : van_der_waals_radius(atom.element);
    return style_ == AtomStyle::ball_and_stick ? kBallPart * whole : whole;
  }

  MaterialId material(Rgb color) {
    const auto [at, is_new] = materials_.emplace(std::array{color.x, color.y, color.z}, 0);
    if (is_new) at->second = read_.scene.add_material({.color = color, .kd = 1});
    return at->second;
  }

  // A material for each atom; the error.
  std::string color_atoms() {
    const std::string by = options_.color_by.empty() ? "element" : options_.color_by;
    const bool of_numbers = by == "index" || by == "bfactor" || by == "occupancy";
    if (!options_.colormap.empty()) {
      if (!map_color(options_.colormap, 0))
        return fmt::format("there is no colour map '{}'; expected {}", options_.colormap,
                           fmt::join(kColormaps, ", "));
      if (!of_numbers)
        return fmt::format(
            "a colour map has no effect on atoms coloured by {}; colour them by "
            "index, bfactor or occupancy",
            by);
    }
    material_.resize(atoms_.atoms.size());
    if (of_numbers) return color_by_number(by), std::string();
    Rgb (*color)(const Atom&) = nullptr;
    if (by == "element") color = [](const Atom& a) { return element_color(a.element); };
    if (by == "chain") color = [](const Atom& a) { return distinct_color(a.chain); };
    if (by == "residue") color = [](const Atom& a) { return distinct_color(a.residue); };
    if (!color)
      return fmt::format(
          "cannot colour by '{}'; expected element, chain, residue, index, bfactor "
          "or occupancy",
          by);
    for (size_t i = 0; i < material_.size(); ++i) material_[i] = material(color(atoms_.atoms[i]));
    return {};
  }

  // Maps have 256 colours, so as many materials do.
  void color_by_number(std::string_view by) {
    const auto& atoms = atoms_.atoms;
    const auto number = [&](size_t i) {
      return by == "index" ? float(i) : by == "bfactor" ? atoms[i].b_factor : atoms[i].occupancy;
    };
    float least = number(0), most = least;
    for (size_t i = 0; i < atoms.size(); ++i)
      least = std::min(least, number(i)), most = std::max(most, number(i));
    const std::string_view map =
        options_.colormap.empty() ? kColormaps[0] : std::string_view(options_.colormap);
    for (size_t i = 0; i < atoms.size(); ++i)
      material_[i] =
          material(*map_color(map, most > least ? (number(i) - least) / (most - least) : 0));
  }

  // Of the file, or of the copies of an assembly; the error.
  std::string add_spheres() {
    const bool has = !atoms_.assemblies.empty();
    const int wanted =
        options_.assembly.value_or(has && style_ == AtomStyle::space_filling ? 1 : 0);
    if (wanted == 0) {
      add_copies(nullptr, nullptr);
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
      add_copies(&copies, &chosen);
    }
    return read_.scene.spheres.empty() ? "the assembly has no atoms" : "";
  }

  void add_copies(const Assembly::Copies* copies, const std::vector<bool>* chosen) {
    std::vector<uint32_t> some;
    for (uint32_t i = 0; i < atoms_.atoms.size(); ++i) {
      const uint32_t part = atoms_.atoms[i].part;
      if (!chosen || (part < chosen->size() && (*chosen)[part])) some.push_back(i);
    }
    Scene& scene = read_.scene;
    const size_t first = scene.spheres.size(), times = copies ? copies->matrices.size() : 1;
    scene.spheres.resize(first + times * some.size());
    scene.sphere_materials.resize(scene.spheres.size());
    Sphere* const spheres = scene.spheres.data() + first;
    MaterialId* const materials = scene.sphere_materials.data() + first;
    for_each_index(times * some.size(), [&](size_t i) {
      const size_t atom = some[i % some.size()];
      const Vec3f at = place_of(atoms_.atoms[atom]);
      spheres[i] = {copies ? moved(copies->matrices[i / some.size()], at) : at,
                    radius_of(atoms_.atoms[atom])};
      materials[i] = material_[atom];
    });
  }

  // Cylinders, half of each in the colour of the atom at its end.
  bool add_bonds() {
    Scene& scene = read_.scene;
    const float radius = style_ == AtomStyle::sticks ? kStick : kBond;
    const auto bonds = find_bonds(atoms_.atoms);
    if (!bonds) return false;
    for (const auto& [a, b] : *bonds) {
      const Vec3f from = place_of(atoms_.atoms[a]), to = place_of(atoms_.atoms[b]);
      const Vec3f middle = (from + to) * 0.5f;
      const auto add = [&](Vec3f base, Vec3f apex, MaterialId id) {
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
  ReadScene read_;
  std::map<std::array<float, 3>, MaterialId> materials_;
  std::vector<MaterialId> material_;  // of each atom
};

}  // namespace

std::expected<ReadScene, Diagnostics> scene_of_atoms(const Atoms& atoms, std::string_view file,
                                                     const ReadOptions& options) {
  for (size_t i = 0; i < atoms.atoms.size(); ++i)
    if (!(max_component(abs(place_of(atoms.atoms[i]))) <= kFarthest))
      return failed(file, fmt::format("atom {} has no finite place", i + 1));
  for (const Assembly& assembly : atoms.assemblies)
    for (const Assembly::Copies& copies : assembly.copies)
      for (const auto& matrix : copies.matrices)
        for (const float number : matrix)
          if (!(std::abs(number) <= kLargest))
            return failed(file, "a matrix of an assembly has a number that is not finite");
  return SceneMaker(atoms, file, options).make();
}

}  // namespace raio
