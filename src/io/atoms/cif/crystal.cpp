#include <algorithm>
#include <charconv>
#include <cmath>
#include <compare>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <unordered_map>

#include "io/atoms/cells.h"
#include "io/atoms/cif/block.h"
#include "io/atoms/cif/cif.h"
#include "io/atoms/element_names.h"
#include "io/atoms/site_values.h"

namespace raio::core::cif {
namespace {

// The value of the first of these tags that the file has, or nothing.
std::string value_of(const Block& block, std::initializer_list<const char*> tags) {
  for (const char* tag : tags)
    if (const Column column = find_values(block, tag);
        column && !column.item()->is_loop && !is_null(column[0]))
      return std::string(text_of(column[0]));
  return {};
}

using Rotation = std::array<std::array<int, 3>, 3>;

int determinant(const Rotation& r) {
  return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
         r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
         r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
}

// A symmetry operation such as 'x,y,z+1/2', or with decimals, as in '0.5-x,y,.6667+z'. Translations
// of every lattice are multiples of 1/24.
Operation operation(const std::string& text) try {
  std::string in_parts;
  for (size_t i = 0; i < text.size();) {
    const size_t end = std::min(text.find_first_not_of("0123456789.", i), text.size());
    const std::string number = text.substr(i, end - i);
    double value = 0;
    if (number.find('.') == std::string::npos) {
      in_parts += number.empty() ? text.substr(i, 1) : number;
    } else {
      std::from_chars(number.data(), number.data() + number.size(), value);
      constexpr double kRounded = 0.1;  // 0.33 is a third
      const int64_t parts = std::llround(value * kParts);
      if (std::abs(value * kParts - double(parts)) > kRounded) throw std::runtime_error(number);
      in_parts += std::to_string(parts) + '/' + std::to_string(kParts);
    }
    i = std::max(end, i + 1);
  }
  const Operation out = parse_operation(in_parts);
  if (std::abs(determinant(out.rotation)) != kParts * kParts * kParts)
    throw std::runtime_error(in_parts);
  return out;
} catch (const std::runtime_error&) {
  throw std::runtime_error("expected symmetry operations such as 'x,y,z+1/2', found '" + text +
                           "'");
}

// Whether the rotations and reflections are those of the group, whatever the origin.
bool are_of_group(const std::vector<Operation>& operations, const std::vector<Operation>& group) {
  std::vector<Rotation> listed, known;
  for (const Operation& op : operations) listed.push_back(op.rotation);
  for (const Operation& op : group) known.push_back(op.rotation);
  std::sort(listed.begin(), listed.end());
  std::sort(known.begin(), known.end());
  return listed == known;
}

// The symmetry operations that the file lists, or those of its space group, by any of its names.
std::vector<Operation> symmetry_of(const Block& block, const Crystal& crystal, Notices& notices) {
  std::vector<Operation> out;
  const std::string& name = crystal.group;
  std::vector<Operation> known = operations_of_group(name, crystal.cell);
  for (const char* tag : {"_space_group_symop_operation_xyz", "_symmetry_equiv_pos_as_xyz"})
    if (const Column column = find_values(block, tag)) {
      for (size_t row = 0; row < column.size(); ++row)
        out.push_back(operation(std::string(text_of(column[row]))));
      if (!known.empty() && !are_of_group(out, known))
        notices.add_whole(Severity::warning,
                          "the listed symmetry operations differ from those of its space "
                          "group '" +
                              name + "'; the listed ones are used");
      return out;
    }
  const std::string hall =
      value_of(block, {"_space_group_name_Hall", "_symmetry_space_group_name_Hall"});
  const std::string number =
      value_of(block, {"_space_group_IT_number", "_symmetry_Int_Tables_number"});
  const int known_number = std::atoi(number.c_str());
  if (known.empty() && hall.empty() && known_number > 0) known = operations_of_group(known_number);
  if (!known.empty()) return known;
  if (!hall.empty()) return operations_of_hall(hall);
  if (!name.empty() || !number.empty())
    throw std::runtime_error("unknown space group '" + (name.empty() ? number : name) +
                             "', and the file lists no symmetry operations");
  notices.add_whole(Severity::guessed, "no symmetry (P 1), since the file gives none");
  return {parse_operation("x,y,z")};
}

// Maps into the cell, 0 to below 1. Values just below 1, written with few digits, become 0.
double wrapped(double x) {
  x -= std::floor(x);
  return x > 1 - 1e-4 ? 0 : x;
}

// The element of a site without a symbol: labels of minerals, such as Oa1 and Hw, begin with one.
uint8_t element_of_label(const std::string& label) {
  if (const uint8_t element = element_of_symbol(label)) return element;
  std::string_view letters = label;
  letters = letters.substr(0, letters.find_first_of("0123456789+-()'_ "));
  if (letters.substr(0, 2) == "Wa") return element_of_symbol("O");  // water, such as Wat1
  if (letters.size() > 2 && letters[1] >= 'a')
    if (const uint8_t element = element_of_symbol(letters.substr(0, 2))) return element;
  return element_of_symbol(letters.substr(0, 1));
}

// In fractions of the cell's sides.
using Place = std::array<double, 3>;

Place moved(const Operation& op, const Place& p) {
  Place out;
  for (size_t i = 0; i < 3; ++i)
    out[i] = wrapped((op.rotation[i][0] * p[0] + op.rotation[i][1] * p[1] +
                      op.rotation[i][2] * p[2] + op.translation[i]) /
                     kParts);
  return out;
}

// In angstroms, without the shift of the cell.
Place turned(const UnitCell& cell, const Place& p) {
  Place out;
  for (size_t i = 0; i < 3; ++i)
    out[i] = cell.matrix[i][0] * p[0] + cell.matrix[i][1] * p[1] + cell.matrix[i][2] * p[2];
  return out;
}

// Positions in a periodic cell, binned so that a search visits neighbouring bins only.
class Places {
 public:
  static constexpr double kSame = 0.1;  // angstroms

  explicit Places(const UnitCell& cell) : cell_(cell) {
    for (size_t k = 0; k < 3; ++k) {
      const double most = 1 / (kSame * cell.reciprocal[k]);
      bins_[k] = most > 1 ? int64_t(std::min(most, 1000.0)) : 1;
    }
  }

  void add(const Place& place) {
    const auto [i, j, k] = bin_of(place);
    places_[key(i, j, k)].push_back(place);
  }
  bool has_near(const Place& place) const {
    const auto [i, j, k] = bin_of(place);
    for (int64_t a = -1; a <= 1; ++a)
      for (int64_t b = -1; b <= 1; ++b)
        for (int64_t c = -1; c <= 1; ++c)
          if (const auto at = places_.find(key(i + a, j + b, k + c)); at != places_.end())
            for (const Place& other : at->second)
              if (are_near(place, other)) return true;
    return false;
  }

 private:
  bool are_near(const Place& a, const Place& b) const {
    Place apart;
    for (size_t k = 0; k < 3; ++k) {
      apart[k] = a[k] - b[k];
      apart[k] -= std::round(apart[k]);
    }
    const auto [x, y, z] = turned(cell_, apart);
    return std::sqrt(x * x + y * y + z * z) < kSame;
  }
  std::array<int64_t, 3> bin_of(const Place& p) const {
    return {int64_t(p[0] * double(bins_[0])), int64_t(p[1] * double(bins_[1])),
            int64_t(p[2] * double(bins_[2]))};
  }
  int64_t key(int64_t i, int64_t j, int64_t k) const {
    const auto wrap = [](int64_t at, int64_t count) { return ((at % count) + count) % count; };
    return (wrap(i, bins_[0]) * bins_[1] + wrap(j, bins_[1])) * bins_[2] + wrap(k, bins_[2]);
  }

  const UnitCell& cell_;
  std::array<int64_t, 3> bins_{};
  std::unordered_map<int64_t, std::vector<Place>> places_;
};

// A site that is drawn, with its symmetry mates.
struct Drawn {
  std::vector<Place> places;
  uint8_t element = 0;
  const Site* from = nullptr;
};

std::vector<Drawn> drawn_of(const Block& block, const Crystal& crystal, Notices& notices) {
  std::vector<Drawn> out;
  const Table flags(block, "_atom_site_", {"label", "?calc_flag"});
  ElementCases elements;
  Cases dummies, disordered, placeless;
  for (size_t i = 0; i < crystal.sites.size(); ++i) {
    const Site& site = crystal.sites[i];
    if (flags.text(i, 1) == "dum") {
      dummies.add(site.label);
    } else if (site.disorder_group > 1) {
      disordered.add(site.label);  // of a disordered part the first group is kept
    } else if (!std::isfinite(site.place[0] + site.place[1] + site.place[2])) {
      placeless.add(site.label);
    } else {
      Drawn one;
      one.from = &site;
      one.element = uint8_t(site.element);
      if (one.element == 0) {
        one.element = element_of_label(site.label);
        elements.add(one.element, site.label);
      }
      out.push_back(one);
    }
  }
  elements.tell(notices);
  dummies.tell(notices, Severity::left_out, "sites of dummy atoms");
  disordered.tell(notices, Severity::left_out, "sites of alternative disorder groups");
  placeless.tell(notices, Severity::left_out, "sites without coordinates");
  return out;
}

void set(Block& block, const std::string& tag, const std::string& value) {
  const size_t at = index_of(block, tag);
  if (at == block.items.size()) block.items.emplace_back();
  block.items[at] = Item{{tag}, {value}};
}

// By the CIF dictionary, missing cell angles are 90 degrees.
void complete_angles(Block& block, Notices& notices) {
  for (const char* angle : {"alpha", "beta", "gamma"}) {
    const std::string tag = std::string("_cell_angle_") + angle;
    const Column values = find_values(block, tag);
    if (values.size() > 0 && !is_null(values[0])) continue;
    set(block, tag, "90");
    notices.add(Severity::guessed, "missing angles of the cell, taken as 90 degrees", angle);
  }
}

// gemmi takes a side of exactly 1 for a missing cell.
void mark_unit_side(Block& block) {
  const auto side = [&](const char* tag) { return value_of(block, {tag}); };
  if (number_of(side("_cell_length_a")) == 1 && !side("_cell_length_b").empty() &&
      !side("_cell_length_c").empty())
    set(block, "_cell_length_a", "1.0000000000000002");
}

}  // namespace

void add_crystal(Block block, Atoms& out) {
  complete_angles(block, out.notices);
  mark_unit_side(block);
  const Crystal crystal = crystal_of(block);
  if (!crystal.cell.is_crystal)
    throw std::runtime_error(
        "fractional coordinates without cell lengths; expected _cell_length_a, _b and _c");
  const std::vector<Operation> symmetry = symmetry_of(block, crystal, out.notices);
  out.frames = 1;
  out.cell = cell_of(crystal.cell);
  out.has_residues = true;
  out.has_occupancies = has_tag(block, "_atom_site_occupancy");
  out.has_b_factors =
      has_tag(block, "_atom_site_U_iso_or_equiv") || has_tag(block, "_atom_site_B_iso_or_equiv");
  std::vector<Drawn> sites = drawn_of(block, crystal, out.notices);
  if (sites.empty() && !crystal.sites.empty())
    throw std::runtime_error(
        "none of its atom sites has coordinates, apart from dummy and disordered ones");
  // The most frequent element of a shared site is drawn.
  std::vector<Drawn*> by_occupancy;
  by_occupancy.reserve(sites.size());
  for (Drawn& site : sites) by_occupancy.push_back(&site);
  std::ranges::sort(by_occupancy, [](const Drawn* a, const Drawn* b) {
    const auto order = std::strong_order(b->from->occupancy, a->from->occupancy);
    return order == 0 ? a < b : order < 0;
  });
  Places taken(crystal.cell);
  Cases shared;
  for (Drawn* site : by_occupancy) {
    Places own(crystal.cell);  // an operation may map an atom onto itself
    bool is_first = true;
    for (const Operation& op : symmetry) {
      const Place place = moved(op, site->from->place);
      if (is_first && taken.has_near(place)) break;
      is_first = false;
      if (own.has_near(place)) continue;
      own.add(place);
      site->places.push_back(place);
    }
    for (const Place& place : site->places) taken.add(place);
    if (site->places.empty()) shared.add(site->from->label);
  }
  shared.tell(out.notices, Severity::left_out,
              "sites at the position of another with the same or a higher occupancy");
  for (const Drawn& site : sites)
    for (const Place& place : site.places) {
      Place at = turned(crystal.cell, place);
      for (size_t k = 0; k < 3; ++k) at[k] += crystal.cell.shift[k];
      Atom atom;
      atom.place = out.local(at);
      atom.element = site.element;
      atom.residue = uint32_t(site.from - crystal.sites.data());
      atom.occupancy = float(site.from->occupancy);
      atom.b_factor = float(site.from->b_factor);
      out.atoms.push_back(atom);
      if (out.marks) out.marks->add(site.from->label, std::nullopt);
    }
  note_coincident(out, [&](uint32_t i) { return crystal.sites[out.atoms[i].residue].label; });
}

}  // namespace raio::core::cif
