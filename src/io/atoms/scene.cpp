// Converts atoms to a scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "base/platform/memory.h"
#include "io/atoms/atom_colors.h"
#include "io/atoms/cells.h"
#include "io/atoms/colors.h"
#include "io/atoms/labels.h"
#include "io/atoms/lines.h"
#include "io/atoms/read.h"
#include "io/atoms/select.h"
#include "io/fit_camera.h"
#include "io/points.h"
#include "scene/enclosing.h"

namespace raio::core {
namespace {

// Up to this many atoms are easily seen individually.
constexpr size_t kFew = 300;
// The same for pure carbon, such as cages and tubes, where few atoms hide each other.
constexpr size_t kFewCarbons = 1000;
constexpr float kLargest =
    1e9f;  // largest element of a matrix, so that transformed positions stay in range
constexpr float kStick = 0.15f, kBond = 0.12f, kBallPart = 0.27f, kPoint = 0.25f;
constexpr double kEdgePart = 0.005;  // radius of the cell's edges, relative to its mean side
const Rgb kEdgeColor(0.05f);
constexpr size_t kMaxCells = 10'000'000;
constexpr double kFlat = 0.1;           // height over width below which the view is from above
constexpr size_t kMaxCompleted = 3000;  // over all images of a cell

Vec3f place_of(const Atom& atom) { return {atom.place[0], atom.place[1], atom.place[2]}; }

size_t images_of(const ReadOptions& options) {
  return size_t(options.images[0]) * size_t(options.images[1]) * size_t(options.images[2]);
}

AtomStyle style_of(const Atoms& atoms, const ReadOptions& options) {
  const bool is_carbon =
      std::ranges::all_of(atoms.atoms, [](const Atom& a) { return a.element == 6; });
  const bool few = atoms.atoms.size() <= (is_carbon ? kFewCarbons : kFew) / images_of(options) &&
                   (any_element(atoms) || !atoms.bonds.empty());
  return options.style.value_or(few ? AtomStyle::ball_and_stick : AtomStyle::space_filling);
}

bool has_bonds(AtomStyle style) {
  return style == AtomStyle::ball_and_stick || style == AtomStyle::sticks;
}

bool is_sound(const Cell& cell) {
  const auto is_near = [](const std::array<double, 3>& v) {
    return std::ranges::all_of(v, [](double x) { return std::abs(x) <= double(kLargest); });
  };
  return is_near(cell.origin) && std::ranges::all_of(cell.sides, is_near);
}

// Whether this is a crystal or a simulation, not a molecule with chains, nor a droplet, tube or
// protein in a large box.
bool is_of_cell(const Atoms& atoms) {
  return atoms.cell && atoms.chains.empty() && is_sound(*atoms.cell) && !atoms.atoms.empty() &&
         fill_cell(atoms);
}

// Whether to draw the edges of the cell.
bool draws_cell(const Atoms& atoms, const ReadOptions& options) {
  return options.cell ? *options.cell : is_of_cell(atoms);
}

// Whether atoms on the faces of the cell are repeated on all its sides, as is usual for crystals.
// Not if the file lists bonds, which do not lead to the images, or has frames, in which images
// would come and go.
bool completes_cell(const Atoms& atoms, const ReadOptions& options) {
  return atoms.finds_bonds && atoms.frames <= 1 && atoms.atoms.size() <= kFew &&
         atoms.atoms.size() * images_of(options) <= kMaxCompleted && any_element(atoms) &&
         draws_cell(atoms, options);
}

class AtomScene {
 public:
  // `shifts` are the translations to the images.
  AtomScene(const Atoms& atoms, std::string_view file, const ReadOptions& options, AtomStyle style,
            std::vector<Vec3d> shifts)
      : atoms_(atoms),
        file_(file),
        options_(options),
        style_(style),
        shifts_(std::move(shifts)),
        origin_(atoms.origin[0], atoms.origin[1], atoms.origin[2]) {}

  std::expected<ReadScene, Diagnostics> make() {
    if (atoms_.atoms.empty()) {
      const auto frames = int64_t(atoms_.frames);
      const bool is_there = options_.frame >= -frames && options_.frame < frames;
      return failed(file_,
                    fmt::format("{} {}{}; the file has {} frame{}",
                                is_there ? "frame" : "there is no frame", options_.frame,
                                is_there ? " has no atoms" : "", frames, frames == 1 ? "" : "s"));
    }
    has_elements_ = any_element(atoms_);
    if (!has_elements_ && (atoms_.radii.empty() || std::ranges::count(atoms_.radii, 0.f) > 0)) {
      Box3f box;
      for (const Atom& atom : atoms_.atoms) box.extend(place_of(atom));
      particle_radius_ = mean_spacing(box, atoms_.atoms.size()) / 2;
    }
    Scene& scene = read_.scene;
    scene.dialect = Dialect::data;
    scene.origin = origin_;
    read_.frames = atoms_.frames;
    if (has_elements_) read_.unit = "Å";  // from the radii
    auto materials = color_atoms(atoms_, options_, style_, read_);
    if (!materials) return failed(file_, materials.error());
    material_ = *std::move(materials);
    if (has_bonds(style_) && !collect_bonds())
      return failed(file_,
                    "too many atoms are at one position to find bonds; choose the `style` "
                    "space-filling or points");
    // If most atoms have no bonds, the small balls would be all there is to see.
    if (!options_.style && has_bonds(style_) && 2 * bonded_atoms() < atoms_.atoms.size()) {
      style_ = AtomStyle::space_filling;
      bonds_.clear();
    }
    if (auto wrong = add_copies(); !wrong.empty()) return failed(file_, wrong);
    const Box3f box = bounds(scene);
    ReadChoices& choices = read_.choices;
    choices.style = style_, choices.has_cell = atoms_.cell && is_sound(*atoms_.cell);
    choices.assemblies = int(atoms_.assemblies.size());
    choices.cell = draws_cell(atoms_, options_);
    if (choices.cell) add_edges();
    fit(box);
    for (size_t i = 0; i < 3 && atoms_.cell; ++i)
      if (options_.images[i] > 1 && !atoms_.cell->repeats[i])
        tell(Severity::warning, fmt::format("the file is not periodic along {}, but `images` "
                                            "repeats it",
                                            "abc"[i]));
    if (atoms_.frames > 1 && options_.frame == 0 && !options_.cache)
      tell(Severity::left_out,
           fmt::format("frames or models after the first ({}); `frame` selects one",
                       atoms_.frames - 1));
    append(read_.notices, atoms_.notices, file_);
    if (options_.labels) keep_labels();
    return std::move(read_);
  }

 private:
  // Fits the camera; `box` bounds the atoms.
  void fit(const Box3f& box) {
    Scene& scene = read_.scene;
    if (!is_of_cell(atoms_)) return fit_camera(scene, FitView::principal);
    std::array<Vec3d, 3> sides;
    for (size_t i = 0; i < 3; ++i) {
      const auto& s = atoms_.cell->sides[i];
      sides[i] = Vec3d(s[0], s[1], s[2]) * options_.images[i];
    }
    const auto reach = [&](const Vec3d& side) {
      return dot(abs(normalize(side)), Vec3d(box.hi) - Vec3d(box.lo));
    };
    const bool is_flat = reach(sides[2]) < kFlat * std::min(reach(sides[0]), reach(sides[1]));
    fit_camera_to_cell(scene, sides, is_flat);
  }

  float radius_of(size_t atom) const {
    if (style_ == AtomStyle::sticks) return kStick;
    if (style_ == AtomStyle::points) return options_.radius > 0 ? options_.radius : kPoint;
    const bool has_own =
        !atoms_.radii.empty() && atoms_.radii[atom] > 0;  // a PQR atom may have radius 0
    const float whole = has_own               ? atoms_.radii[atom]
                        : options_.radius > 0 ? options_.radius
                        : has_elements_       ? van_der_waals_radius(atoms_.atoms[atom].element)
                                              : particle_radius_;
    return style_ == AtomStyle::ball_and_stick ? kBallPart * whole : whole;
  }

  void tell(Severity severity, std::string what) {
    read_.notices.push_back({severity, std::string(file_), 0, 0, std::move(what), ""});
  }

  // Adds the instances of the file, an assembly or the cell; returns the error.
  std::string add_copies() {
    const bool copied = images_of(options_) > 1, has = !atoms_.assemblies.empty() && !copied;
    const int wanted =
        options_.assembly.value_or(has && style_ == AtomStyle::space_filling ? 1 : 0);
    read_.choices.assembly = wanted;
    if (wanted < 0 || size_t(wanted) > atoms_.assemblies.size())
      return atoms_.assemblies.empty() ? "the file has no assemblies; leave out `assembly`"
                                       : fmt::format("assembly {} does not exist; the file has {}",
                                                     wanted, atoms_.assemblies.size());
    if (wanted > 0 && copied)
      return "an assembly cannot be repeated with the cell; leave out `assembly` or `images`";
    if (wanted == 0 && shifts_.size() == 1) {
      (void)add_atoms(read_.scene, nullptr);
      return {};
    }
    if (wanted == 0) {
      std::vector<Matrix> matrices;
      matrices.reserve(shifts_.size());
      for (const Vec3d& s : shifts_)
        matrices.push_back({1, 0, 0, float(s.x), 0, 1, 0, float(s.y), 0, 0, 1, float(s.z)});
      add_object(nullptr, matrices);
      return {};
    }
    for (const Assembly::Copies& copies : atoms_.assemblies[size_t(wanted) - 1].copies) {
      std::vector<bool> chosen;
      for (const uint32_t part : copies.parts) {
        if (part >= chosen.size()) chosen.resize(size_t(part) + 1);
        chosen[part] = true;
      }
      add_object(&chosen, about_origin(copies.matrices));
    }
    name_copies();
    if (!options_.assembly && !read_.scene.instances.empty()) tell_assembly();
    if (!read_.scene.instances.empty()) return {};
    if (options_.assembly) return "the assembly has no atoms";
    // A part of a file keeps the header of the whole.
    (void)add_atoms(read_.scene, nullptr);
    return {};
  }

  // The same transformations for positions relative to the origin.
  std::vector<Matrix> about_origin(std::vector<Matrix> matrices) const {
    if (origin_ == Vec3d()) return matrices;
    for (Matrix& m : matrices) {
      const Vec3d shift = Placement(m).point(origin_) - origin_;
      for (int axis = 0; axis < 3; ++axis) m[size_t(4 * axis) + 3] = float(shift[axis]);
    }
    return matrices;
  }

  // Adds a notice, unless the assembly equals the contents of the file.
  void tell_assembly() {
    Scene& scene = read_.scene;
    size_t drawn = 0;
    for (const Instance& copy : scene.instances)
      drawn += scene.prototypes[copy.prototype].spheres.size();
    if (drawn == atoms_.atoms.size() && scene.instances.size() == 1) return;
    const size_t count = atoms_.assemblies.size();
    tell(Severity::guessed,
         fmt::format("the biological assembly{} of {} atoms is drawn; the file lists {}; "
                     "`assembly` none draws those",
                     count > 1 ? fmt::format(" 1 of {}", count) : "", drawn, atoms_.atoms.size()));
  }

  // Gives instances names, so that the channel of objects and outlines distinguish them.
  void name_copies() {
    Scene& scene = read_.scene;
    const size_t count = scene.instances.size();
    for (uint32_t i = 0; count > 1 && i < count; ++i) {
      scene.object_names.push_back(fmt::format("copy {}", i + 1));
      scene.object_ranges.push_back({PoolKind::instance, i, 1, i + 1});
    }
  }

  // Adds an object of the chosen parts, with an instance per matrix.
  void add_object(const std::vector<bool>* chosen, const std::vector<Matrix>& matrices) {
    Scene& scene = read_.scene;
    Object object;
    std::vector<uint32_t> atoms = add_atoms(object, chosen);
    if (object.spheres.empty()) return;
    labels_.of_prototype.push_back(std::move(atoms));
    for (const Matrix& matrix : matrices)
      scene.instances.push_back({uint32_t(scene.prototypes.size()), matrix});
    scene.prototypes.push_back(std::move(object));
  }

  // The atoms of the chosen parts with the bonds between them; null: all. Returns the chosen atoms.
  std::vector<uint32_t> add_atoms(Object& scene, const std::vector<bool>* chosen) const {
    const auto is_chosen = [&](uint32_t i) {
      const uint32_t part = atoms_.atoms[i].part;
      return !chosen || (part < chosen->size() && (*chosen)[part]);
    };
    std::vector<uint32_t> some;
    for (uint32_t i = 0; chosen && i < atoms_.atoms.size(); ++i)
      if (is_chosen(i)) some.push_back(i);
    const size_t count = chosen ? some.size() : atoms_.atoms.size();
    // The corners of the cell come after the atoms, which then keep their indices.
    size_t ends = 1;
    for (const int n : options_.images) ends *= size_t(n) + 1;
    scene.spheres.reserve(count + ends), scene.spheres.resize(count);
    scene.sphere_materials.reserve(count + ends), scene.sphere_materials.resize(count);
    Sphere* const spheres = scene.spheres.data();
    MaterialId* const materials = scene.sphere_materials.data();
    for_each_index(count, [&](size_t i) {
      const size_t atom = chosen ? some[i] : i;
      spheres[i] = {place_of(atoms_.atoms[atom]), radius_of(atom)};
      materials[i] = material_[atom];
    });
    for (const auto& [a, b] : bonds_)
      if (is_chosen(a) && is_chosen(b)) add_bond(scene, a, b);
    return some;
  }

  void keep_labels() {
    const auto column = [&](bool is_known, auto Atom::* of) {
      std::vector<std::remove_cvref_t<decltype(Atom().*of)>> values;
      if (!is_known) return values;
      values.reserve(atoms_.atoms.size());
      for (const Atom& atom : atoms_.atoms) values.push_back(atom.*of);
      return values;
    };
    labels_.elements = column(has_elements_, &Atom::element);
    labels_.residues = column(atoms_.has_residues, &Atom::residue);
    labels_.atoms = uint32_t(atoms_.atoms.size());
    labels_.indices = atoms_.indices;
    if (atoms_.marks) labels_.marks = *atoms_.marks;
    labels_.residue_names = atoms_.residues, labels_.chain_names = atoms_.chains;
    if (!atoms_.chains.empty()) labels_.chains.resize(atoms_.residues.size(), AtomLabels::kNone);
    for (const Atom& atom : atoms_.atoms)
      if (atom.residue < labels_.chains.size()) labels_.chains[atom.residue] = atom.chain;
    read_.atoms = std::make_shared<const AtomLabels>(std::move(labels_));
  }

  // False if too many atoms are at one position.
  bool collect_bonds() {
    bonds_ = atoms_.bonds;
    if (!atoms_.finds_bonds) return true;
    const auto found = find_bonds(atoms_.atoms);
    if (!found) return false;
    bonds_.insert(bonds_.end(), found->begin(), found->end());
    std::ranges::sort(bonds_);
    bonds_.erase(std::ranges::unique(bonds_).begin(), bonds_.end());
    if (const size_t traced = add_traces(atoms_.atoms, bonds_); traced > 0)
      tell(Severity::guessed, fmt::format("bonds along the chains ({})", traced));
    return true;
  }

  size_t bonded_atoms() const {
    std::vector<bool> is_bonded(atoms_.atoms.size());
    for (const auto& [a, b] : bonds_) is_bonded[a] = is_bonded[b] = true;
    return size_t(std::ranges::count(is_bonded, true));
  }

  // Half of the bond in the colour of its first atom.
  void add_bond(Object& scene, uint32_t a, uint32_t b) const {
    const float radius = style_ == AtomStyle::sticks ? kStick : kBond;
    const Vec3f from = place_of(atoms_.atoms[a]), to = place_of(atoms_.atoms[b]);
    const Vec3f middle = (from + to) * 0.5f;
    if (material_[a] == material_[b]) {
      add_cylinder(scene, from, to, radius, material_[a]);
    } else {
      add_cylinder(scene, from, middle, radius, material_[a]);
      add_cylinder(scene, middle, to, radius, material_[b]);
    }
  }

  static void add_cylinder(Object& scene, Vec3f from, Vec3f to, float radius, MaterialId id) {
    if (from == to) return;  // atoms at the same position
    scene.cones.push_back({from, radius, to, radius});
    scene.cone_materials.push_back(id);
  }

  // The edges of all images of the cell, as lines along each side, with round ends.
  void add_edges() {
    Scene& scene = read_.scene;
    const auto& n = options_.images;
    std::array<Vec3d, 3> side;
    double mean = 0;
    for (size_t i = 0; i < 3; ++i) {
      const auto& s = atoms_.cell->sides[i];
      side[i] = Vec3d(s[0], s[1], s[2]);
      mean += length(side[i]) / 3;
    }
    const auto& o = atoms_.cell->origin;
    const Vec3d origin = Vec3d(o[0], o[1], o[2]) - origin_;
    const auto radius = float(kEdgePart * mean);
    const MaterialId id = scene.add_material({.color = kEdgeColor, .kd = 1});
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t other = (axis + 1) % 3, third = (axis + 2) % 3;
      for (int j = 0; j <= n[other]; ++j)
        for (int k = 0; k <= n[third]; ++k) {
          const Vec3d from = origin + side[other] * j + side[third] * k;
          const Vec3d to = from + side[axis] * n[axis];
          add_cylinder(scene, Vec3f(from), Vec3f(to), radius, id);
          // Where lines of several axes end, one of them adds the ball.
          const auto ends = [&](size_t a, int at) { return a < axis && (at == 0 || at == n[a]); };
          if (ends(other, j) || ends(third, k)) continue;
          for (const Vec3d& end : {from, to}) {
            scene.spheres.push_back({Vec3f(end), radius});
            scene.sphere_materials.push_back(id);
          }
        }
    }
  }

  const Atoms& atoms_;
  std::string_view file_;
  const ReadOptions& options_;
  AtomStyle style_;
  const std::vector<Vec3d> shifts_;
  const Vec3d origin_;
  bool has_elements_ = false;
  float particle_radius_ = 1;  // for atoms of unknown element
  ReadScene read_;
  AtomLabels labels_;
  std::vector<MaterialId> material_;  // by atom
  Bonds bonds_;
};

// The reason why the cell cannot be drawn or repeated; empty if it can.
std::string cell_problem(const Atoms& atoms, const ReadOptions& options) {
  const size_t images = images_of(options);
  const std::string_view asked = options.cell.value_or(false) ? "cell" : images > 1 ? "images" : "";
  if (asked.empty()) return {};
  if (!atoms.cell) return fmt::format("`{}` needs a cell, but the file has none", asked);
  if (!is_sound(*atoms.cell)) return "the cell has a number that is not finite";
  if (images > kMaxCells)
    return fmt::format("{} images of the cell are too many; expected at most {}", images,
                       kMaxCells);
  // Bytes per atom with its bonds, or per instance.
  const double bytes = has_bonds(style_of(atoms, options)) ? 300.0 * double(atoms.atoms.size())
                       : options.instances                 ? 200.0
                                                           : 60.0 * double(atoms.atoms.size());
  if (images > 1 && bytes * double(images) > 0.5 * double(available_memory_bytes()))
    return fmt::format(
        "{} images of {} atoms need more memory than is available; give fewer `images`", images,
        atoms.atoms.size());
  return {};
}

}  // namespace

std::array<double, 3> origin_for(const std::vector<Atom>& atoms) try {
  FileOrigin origin;
  for (const Atom& atom : atoms) {
    (void)origin.local(Vec3d(place_of(atom)));
    if (!origin.is_far()) return {};
  }
  const Vec3d at = origin.value();
  return {at.x, at.y, at.z};
} catch (const FileOrigin::NotFar&) {
  return {};
}

std::expected<ReadScene, Diagnostics> scene_of_atoms(Atoms atoms, std::string_view file,
                                                     const ReadOptions& options) {
  float farthest = 0;
  for (size_t i = 0; i < atoms.atoms.size(); ++i) {
    const Vec3f place = place_of(atoms.atoms[i]);
    if (!is_place(place))
      return failed(file,
                    fmt::format("atom {} has a coordinate that is too large or not finite", i + 1));
    farthest = std::max(farthest, max_component(abs(place)));
  }
  for (const Assembly& assembly : atoms.assemblies)
    for (const Assembly::Copies& copies : assembly.copies)
      for (const auto& matrix : copies.matrices)
        for (const float number : matrix)
          if (!(std::abs(number) <= kLargest))
            return failed(file,
                          "a matrix of an assembly has a number that is too large or not finite");
  for (const Assembly& assembly : atoms.assemblies)
    for (const Assembly::Copies& copies : assembly.copies)
      for (const auto& matrix : copies.matrices)
        if (!Placement(matrix).is_sound())
          return failed(file, "a matrix of an assembly has no inverse");
  for (size_t i = 0; i < atoms.radii.size(); ++i)
    if (!(atoms.radii[i] <= kFarthestPlace))
      return failed(file, fmt::format("atom {} has a radius that is too large", i + 1));
  if (std::string wrong = cell_problem(atoms, options); !wrong.empty()) return failed(file, wrong);
  const bool fills = style_of(atoms, options) == AtomStyle::space_filling;
  if (auto done = select_atoms(atoms, options, fills); !done) return failed(file, done.error());
  const AtomStyle style = style_of(atoms, options);
  const std::vector<Vec3d> shifts = shifts_of(atoms, options.images);
  const bool completes = completes_cell(atoms, options);
  const bool repeats = completes || (has_bonds(style) && shifts.size() > 1);
  if (repeats) atoms = repeated(atoms, shifts, options.images);
  if (completes) complete_border(atoms, options.images);
  auto read =
      AtomScene(atoms, file, options, style, repeats ? std::vector{Vec3d()} : shifts).make();
  // A bond between two colours is two cylinders, which would change the fitted camera. So the
  // camera is fitted with the default colours.
  const bool has_colors = !options.color_by.empty() || !options.color_atoms.empty();
  if (read && has_colors && has_bonds(read->choices.style)) {
    ReadOptions usual = options;
    usual.color_by.clear(), usual.colormap.clear(), usual.color_range.reset();
    usual.color_atoms.clear(), usual.labels = false;
    const auto plain =
        AtomScene(atoms, file, usual, style, repeats ? std::vector{Vec3d()} : shifts).make();
    if (plain) read->scene.camera = plain->scene.camera;
  }
  constexpr double kFine = 0.01;  // much shorter than a bond
  if (const double step = float_step(double(farthest)); read && step > kFine)
    read->notices.push_back({Severity::cut, std::string(file), 0, 0,
                             fmt::format("the atoms are so far apart that their coordinates are "
                                         "rounded to multiples of {:g}",
                                         step),
                             ""});
  return read;
}

}  // namespace raio::core
