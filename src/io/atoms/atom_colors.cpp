#include "io/atoms/atom_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "base/spelling.h"
#include "io/atoms/colors.h"
#include "io/atoms/lines.h"
#include "io/colormaps.h"

namespace raio::core {
namespace {

// Assemblies of this many atoms are coloured by chain if they have large chains.
constexpr size_t kManyAtoms = 5000, kLargeChain = 500;

// Whether the atoms have several large chains, seen from outside, which element colours would hide.
bool is_assembly(const Atoms& atoms, AtomStyle style) {
  if (style != AtomStyle::space_filling || atoms.chains.size() < 2 ||
      atoms.atoms.size() < kManyAtoms)
    return false;
  struct Size {
    size_t atoms = 0, residues = 0;
  };
  std::vector<Size> sizes(atoms.chains.size());
  for (size_t i = 0; i < atoms.atoms.size(); ++i) {
    Size& size = sizes[atoms.atoms[i].chain];
    ++size.atoms;
    size.residues += i == 0 || atoms.atoms[i - 1].residue != atoms.atoms[i].residue;
  }
  // Residues of water and ions have fewer atoms than those of polymers.
  return std::ranges::count_if(sizes, [](const Size& s) {
           return s.atoms >= kLargeChain && s.atoms >= 4 * s.residues;
         }) > 1;
}

// The values that `color_by` may take.
std::vector<std::string> what_there_is(const Atoms& atoms, bool has_types) {
  std::vector<std::string> out = {"element", "index"};
  if (!atoms.chains.empty()) out.push_back("chain");
  if (atoms.has_residues) out.push_back("residue");
  if (has_types) out.push_back("type");
  if (atoms.has_b_factors) out.push_back("bfactor");
  if (atoms.has_occupancies) out.push_back("occupancy");
  for (const std::string& column : atoms.columns)
    if (std::ranges::find(out, column) == out.end()) out.push_back(column);
  return out;
}

// The numbers that a colour map shows; empty if there are none of this name.
std::vector<float> numbers_of(const Atoms& atoms, std::string_view by) {
  const bool known = by == "index" || (by == "bfactor" && atoms.has_b_factors) ||
                     (by == "occupancy" && atoms.has_occupancies);
  if (!known || !atoms.values.empty()) return atoms.values;
  std::vector<float> out(atoms.atoms.size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = by == "index"     ? float(i)
             : by == "bfactor" ? atoms.atoms[i].b_factor
                               : atoms.atoms[i].occupancy;
  return out;
}

std::string name_of_type(const Atoms& atoms, size_t number) {
  for (const auto& [name, of_name] : atoms.types)
    if (of_name == number) return name;
  return fmt::format("type {}", number);
}

// The legend: each name in use, in order, with its colour. There are too many residues for one.
std::vector<LegendEntry> legend_of(const Atoms& atoms, std::string_view by, Rgb (*color)(uint8_t)) {
  std::vector<LegendEntry> out;
  if (by == "residue") return out;
  std::vector<bool> known;
  for (const Atom& a : atoms.atoms) {
    if (a.own_color > 0) continue;
    const size_t n = by == "element" ? a.element : by == "chain" ? a.chain : a.part;
    if (n >= known.size()) known.resize(n + 1);
    known[n] = true;
  }
  for (size_t n = 0; n < known.size(); ++n) {
    if (!known[n]) continue;
    if (by == "element")
      out.push_back({std::string(n == 0 ? "unknown" : element_symbol(int(n))), color(uint8_t(n))});
    else if (by == "chain")
      out.push_back({"chain " + atoms.chains[n], color(uint8_t(n % kDistinctColors))});
    else
      out.push_back({name_of_type(atoms, n), color(uint8_t((n - 1) % kDistinctColors))});
  }
  return out;
}

class Materials {
 public:
  explicit Materials(Scene& scene) : scene_(scene) {}

  MaterialId of(Rgb color) {
    const auto [at, is_new] = known_.emplace(std::array{color.x, color.y, color.z}, 0);
    if (is_new) at->second = scene_.add_material({.color = color, .kd = 1});
    return at->second;
  }

 private:
  Scene& scene_;
  std::map<std::array<float, 3>, MaterialId> known_;
};

// Gives materials to the atoms with colours of their own, and lists these in the legend.
void color_selections(const Atoms& atoms, const std::vector<AtomColor>& colors,
                      Materials& materials, std::vector<MaterialId>& out, ReadScene& to) {
  constexpr size_t kLongestName = 40;  // that a legend has room for
  std::vector<std::optional<MaterialId>> known(colors.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const size_t own = atoms.atoms[i].own_color;
    if (own == 0) continue;
    if (!known[own - 1]) known[own - 1] = materials.of(colors[own - 1].color);
    out[i] = *known[own - 1];
  }
  for (size_t c = 0; c < colors.size(); ++c)
    if (known[c]) to.legend.push_back({cut_text(colors[c].atoms, kLongestName), colors[c].color});
}

}  // namespace

std::expected<std::vector<MaterialId>, std::string> color_atoms(const Atoms& atoms,
                                                                const ReadOptions& options,
                                                                AtomStyle style, ReadScene& to) {
  const bool has_types = atoms.atoms[0].part > 0 && atoms.chains.empty();
  const std::string by = !options.color_by.empty()          ? options.color_by
                         : has_types && !any_element(atoms) ? "type"
                         : is_assembly(atoms, style)        ? "chain"
                                                            : "element";
  to.choices.columns = what_there_is(atoms, has_types), to.choices.color_by = by;
  // Picks one of the few colours of the table below.
  uint8_t (*which)(const Atom&) = nullptr;
  Rgb (*color)(uint8_t) = [](uint8_t n) { return distinct_color(n); };
  if (by == "element") {
    which = [](const Atom& a) { return a.element; };
    color = [](uint8_t n) { return element_color(n); };
  }
  if (by == "chain" && !atoms.chains.empty())
    which = [](const Atom& a) { return uint8_t(a.chain % kDistinctColors); };
  if (by == "residue" && atoms.has_residues)
    which = [](const Atom& a) { return uint8_t(a.residue % kDistinctColors); };
  if (by == "type" && has_types)
    which = [](const Atom& a) { return uint8_t((a.part - 1) % kDistinctColors); };
  const auto numbers = which ? std::vector<float>() : numbers_of(atoms, by);
  if (!which && numbers.empty())
    return std::unexpected(
        fmt::format("cannot colour by '{}'; the file has {}", printable(by),
                    printable(fmt::format("{}", fmt::join(to.choices.columns, ", ")))));
  if (which && (!options.colormap.empty() || options.color_range))
    return std::unexpected(
        fmt::format("a colour map or range has no effect on atoms coloured by {}; colour them by "
                    "index, bfactor, occupancy or a column of numbers",
                    by));
  Materials materials(to.scene);
  std::vector<MaterialId> out(atoms.atoms.size());
  const bool any_own = !options.color_atoms.empty();
  const auto has_own = [&](const Atom& a) { return any_own && a.own_color > 0; };
  if (which) {
    std::array<std::optional<MaterialId>, 256> known;
    for (size_t i = 0; i < out.size(); ++i) {
      if (has_own(atoms.atoms[i])) continue;
      const uint8_t n = which(atoms.atoms[i]);
      if (!known[n]) known[n] = materials.of(color(n));
      out[i] = *known[n];
    }
    to.legend = legend_of(atoms, by, color);
  } else if (const auto mapped = map_colors(numbers, options.colormap, options.color_range)) {
    // Maps have 256 colours, so 256 materials suffice.
    bool any = false;
    for (size_t i = 0; i < out.size(); ++i) {
      if (has_own(atoms.atoms[i])) continue;
      out[i] = materials.of(mapped->colors[i]), any = true;
    }
    if (any) to.colors = mapped->scale, to.colors->name = by;
  } else {
    return std::unexpected(mapped.error());
  }
  if (any_own) color_selections(atoms, options.color_atoms, materials, out, to);
  return out;
}

}  // namespace raio::core
