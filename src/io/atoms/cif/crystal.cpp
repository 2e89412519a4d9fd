#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <gemmi/smcif.hpp>
#include <unordered_map>

#include "io/atoms/cif/cif.h"
#include "io/atoms/element_names.h"

namespace raio::core {
namespace {

// The value of the first of these tags that the file has, or nothing.
std::string value_of(gemmi::cif::Block& block, std::initializer_list<const char*> tags) {
  for (const char* tag : tags)
    if (const std::string* value = block.find_value(tag); value && !gemmi::cif::is_null(*value))
      return gemmi::cif::as_string(*value);
  return {};
}

// A symmetry operation such as 'x,y,z+1/2', or with decimals, as in '0.5-x,y,.6667+z'. Translations
// of every lattice are multiples of 1/24.
gemmi::Op operation(const std::string& text) try {
  constexpr int kParts = gemmi::Op::DEN;
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
  const gemmi::Op out = gemmi::parse_triplet(in_parts);
  if (std::abs(out.det_rot()) != kParts * kParts * kParts) throw std::runtime_error(in_parts);
  return out;
} catch (const std::runtime_error&) {
  throw std::runtime_error("expected symmetry operations such as 'x,y,z+1/2', found '" + text +
                           "'");
}

// Whether the rotations and reflections are those of the group, whatever the origin.
bool are_of_group(const std::vector<gemmi::Op>& operations, const gemmi::SpaceGroup& group) {
  std::vector<gemmi::Op::Rot> listed, known;
  for (const gemmi::Op& op : operations) listed.push_back(op.rot);
  for (const gemmi::Op op : group.operations()) known.push_back(op.rot);
  std::sort(listed.begin(), listed.end());
  std::sort(known.begin(), known.end());
  return listed == known;
}

// The symmetry operations that the file lists, or those of its space group, by any of its names.
std::vector<gemmi::Op> symmetry_of(gemmi::cif::Block& block, const gemmi::SmallStructure& small,
                                   Notices& notices) {
  std::vector<gemmi::Op> out;
  const std::string& name = small.spacegroup_hm;
  const gemmi::SpaceGroup* known =
      gemmi::find_spacegroup_by_name(name, small.cell.alpha, small.cell.gamma);
  for (const char* tag : {"_space_group_symop_operation_xyz", "_symmetry_equiv_pos_as_xyz"})
    if (const auto column = block.find_values(tag)) {
      for (const std::string& text : column) out.push_back(operation(gemmi::cif::as_string(text)));
      if (known && !are_of_group(out, *known))
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
  if (!known && hall.empty() && known_number > 0)
    known = gemmi::find_spacegroup_by_number(known_number);
  if (known || !hall.empty()) {
    for (const gemmi::Op op : known ? known->operations() : gemmi::symops_from_hall(hall.c_str()))
      out.push_back(op);
  } else if (name.empty() && number.empty()) {
    notices.add_whole(Severity::guessed, "no symmetry (P 1), since the file gives none");
    out.push_back(gemmi::Op::identity());
  } else {
    throw std::runtime_error("unknown space group '" + (name.empty() ? number : name) +
                             "', and the file lists no symmetry operations");
  }
  return out;
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

// Positions in a periodic cell, binned so that a search visits neighbouring bins only.
class Places {
 public:
  static constexpr double kSame = 0.1;  // angstroms

  explicit Places(const gemmi::UnitCell& cell) : cell_(cell) {
    const double reciprocal[3] = {cell.ar, cell.br, cell.cr};
    for (size_t k = 0; k < 3; ++k) {
      const double most = 1 / (kSame * reciprocal[k]);
      bins_[k] = most > 1 ? int64_t(std::min(most, 1000.0)) : 1;
    }
  }

  void add(const gemmi::Fractional& place) {
    const auto [i, j, k] = bin_of(place);
    places_[key(i, j, k)].push_back(place);
  }
  bool has_near(const gemmi::Fractional& place) const {
    const auto [i, j, k] = bin_of(place);
    for (int64_t a = -1; a <= 1; ++a)
      for (int64_t b = -1; b <= 1; ++b)
        for (int64_t c = -1; c <= 1; ++c)
          if (const auto at = places_.find(key(i + a, j + b, k + c)); at != places_.end())
            for (const gemmi::Fractional& other : at->second)
              if (are_near(place, other)) return true;
    return false;
  }

 private:
  bool are_near(const gemmi::Fractional& a, const gemmi::Fractional& b) const {
    gemmi::Fractional apart = a - b;
    apart.x -= std::round(apart.x), apart.y -= std::round(apart.y);
    apart.z -= std::round(apart.z);
    return cell_.orthogonalize_difference(apart).length() < kSame;
  }
  std::array<int64_t, 3> bin_of(const gemmi::Fractional& p) const {
    return {int64_t(p.x * double(bins_[0])), int64_t(p.y * double(bins_[1])),
            int64_t(p.z * double(bins_[2]))};
  }
  int64_t key(int64_t i, int64_t j, int64_t k) const {
    const auto wrap = [](int64_t at, int64_t count) { return ((at % count) + count) % count; };
    return (wrap(i, bins_[0]) * bins_[1] + wrap(j, bins_[1])) * bins_[2] + wrap(k, bins_[2]);
  }

  const gemmi::UnitCell& cell_;
  std::array<int64_t, 3> bins_{};
  std::unordered_map<int64_t, std::vector<gemmi::Fractional>> places_;
};

// A site and its symmetry mates.
struct Site {
  std::vector<gemmi::Fractional> places;
  uint8_t element = 0;
  const gemmi::SmallStructure::Site* from = nullptr;
};

// The sites that are drawn.
std::vector<Site> sites_of(gemmi::cif::Block& block, const gemmi::SmallStructure& small,
                           Notices& notices) {
  std::vector<Site> out;
  gemmi::cif::Table flags = block.find("_atom_site_", {"label", "?calc_flag"});
  ElementCases elements;
  Cases dummies, disordered, placeless;
  for (size_t i = 0; i < small.sites.size(); ++i) {
    const gemmi::SmallStructure::Site& site = small.sites[i];
    const auto flag = flags[i];
    if (flag.has2(1) && flag.str(1) == "dum") {
      dummies.add(site.label);
    } else if (site.disorder_group > 1) {
      disordered.add(site.label);  // of a disordered part the first group is kept
    } else if (!std::isfinite(site.fract.x + site.fract.y + site.fract.z)) {
      placeless.add(site.label);
    } else {
      Site one;
      one.from = &site;
      one.element = number_of(site.element);
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

// By the CIF dictionary, missing cell angles are 90 degrees.
void complete_angles(gemmi::cif::Block& block, Notices& notices) {
  for (const char* angle : {"alpha", "beta", "gamma"}) {
    const std::string tag = std::string("_cell_angle_") + angle;
    auto values = block.find_values(tag);
    if (values.length() > 0 && !gemmi::cif::is_null(values[0])) continue;
    block.set_pair(tag, "90");
    notices.add(Severity::guessed, "missing angles of the cell, taken as 90 degrees", angle);
  }
}

}  // namespace

void add_crystal(gemmi::cif::Block& block, Atoms& out) {
  complete_angles(block, out.notices);
  gemmi::SmallStructure small = gemmi::make_small_structure_from_block(block);
  // gemmi takes a side of exactly 1 for a missing cell.
  const auto is_given = [&](const char* side) { return !value_of(block, {side}).empty(); };
  if (gemmi::UnitCell& cell = small.cell; cell.a == 1 && is_given("_cell_length_a") &&
                                          is_given("_cell_length_b") && is_given("_cell_length_c"))
    cell.set(std::nextafter(1.0, 2.0), cell.b, cell.c, cell.alpha, cell.beta, cell.gamma);
  if (!small.cell.is_crystal())
    throw std::runtime_error(
        "fractional coordinates without cell lengths; expected _cell_length_a, _b and _c");
  const std::vector<gemmi::Op> symmetry = symmetry_of(block, small, out.notices);
  out.frames = 1;
  out.cell = cell_of(small.cell);
  out.has_residues = true;
  out.has_occupancies = block.has_tag("_atom_site_occupancy");
  out.has_b_factors =
      block.has_tag("_atom_site_U_iso_or_equiv") || block.has_tag("_atom_site_B_iso_or_equiv");
  std::vector<Site> sites = sites_of(block, small, out.notices);
  if (sites.empty() && !small.sites.empty())
    throw std::runtime_error(
        "none of its atom sites has coordinates, apart from dummy and disordered ones");
  // The most frequent element of a shared site is drawn.
  std::vector<Site*> by_occupancy;
  by_occupancy.reserve(sites.size());
  for (Site& site : sites) by_occupancy.push_back(&site);
  std::stable_sort(by_occupancy.begin(), by_occupancy.end(),
                   [](const Site* a, const Site* b) { return a->from->occ > b->from->occ; });
  Places taken(small.cell);
  Cases shared;
  for (Site* site : by_occupancy) {
    const gemmi::Fractional& at = site->from->fract;
    Places own(small.cell);  // an operation may map an atom onto itself
    bool is_first = true;
    for (const gemmi::Op& op : symmetry) {
      const auto moved = op.apply_to_xyz({at.x, at.y, at.z});
      const gemmi::Fractional place(wrapped(moved[0]), wrapped(moved[1]), wrapped(moved[2]));
      if (is_first && taken.has_near(place)) break;
      is_first = false;
      if (own.has_near(place)) continue;
      own.add(place);
      site->places.push_back(place);
    }
    for (const gemmi::Fractional& place : site->places) taken.add(place);
    if (site->places.empty()) shared.add(site->from->label);
  }
  shared.tell(out.notices, Severity::left_out,
              "sites at the position of another with the same or a higher occupancy");
  for (const Site& site : sites)
    for (const gemmi::Fractional& place : site.places) {
      const gemmi::Position pos = small.cell.orthogonalize(place);
      Atom atom;
      atom.place = out.local({pos.x, pos.y, pos.z});
      atom.element = site.element;
      atom.residue = uint32_t(site.from - small.sites.data());
      atom.occupancy = float(site.from->occ);
      atom.b_factor = float(site.from->u_iso * gemmi::u_to_b());
      out.atoms.push_back(atom);
    }
  note_coincident(out, [&](uint32_t i) { return small.sites[out.atoms[i].residue].label; });
}

}  // namespace raio::core
