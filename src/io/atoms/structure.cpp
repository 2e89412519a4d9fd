// CIF and mmCIF, and cells, by gemmi. In C++17: with its headers clang refuses the containers of
// incomplete types that later versions evaluate at compile time.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <gemmi/smcif.hpp>
#include <limits>
#include <locale>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "io/atoms/atoms.h"
#include "io/atoms/element_names.h"
#include "io/atoms/names.h"

namespace raio {
namespace {

using Kept = std::unordered_map<const gemmi::Atom*, uint32_t>;  // their indices

uint8_t number_of(gemmi::Element element) {
  return element.elem == gemmi::El::D ? 1 : uint8_t(element.atomic_number());
}

// Of atoms and residues that stand in others' places the first choice. Other atoms may share a
// name: some programs name them by their elements.
class FirstChoice {
 public:
  bool takes(const gemmi::Residue& residue) {
    if (residue.atoms.empty()) return false;
    const char altloc = residue.atoms[0].altloc;
    if (before_ && before_->seqid == residue.seqid && altloc && before_->atoms[0].altloc &&
        before_->atoms[0].altloc != altloc)
      return false;
    before_ = &residue;
    chosen_.clear();
    return true;
  }
  bool takes(const gemmi::Atom& atom) {
    const char chosen = chosen_.emplace(atom.name, atom.altloc).first->second;
    return !atom.altloc || atom.altloc == chosen;
  }

 private:
  const gemmi::Residue* before_ = nullptr;
  std::map<std::string, char> chosen_;  // by names of atoms
};

void add_model(const gemmi::Model& model, Names& chains, Names& parts, Atoms& out, Kept& kept) {
  Cases conformers, second_residues;
  for (const gemmi::Chain& chain : model.chains) {
    FirstChoice first;
    for (const gemmi::Residue& residue : chain.residues) {
      const std::string name = residue.name + ' ' + chain.name + residue.seqid.str();
      if (!first.takes(residue)) {
        second_residues.add(name);
        continue;
      }
      const uint32_t number = chains.number(chain.name), part = parts.number(residue.subchain);
      for (const gemmi::Atom& atom : residue.atoms) {
        if (!first.takes(atom)) {
          conformers.add(name);
          continue;
        }
        Atom a;
        a.place = out.local({atom.pos.x, atom.pos.y, atom.pos.z});
        a.element = number_of(atom.element);
        a.chain = number, a.part = part, a.residue = uint32_t(out.residues.size());
        a.occupancy = atom.occ, a.b_factor = atom.b_iso;
        kept.emplace(&atom, uint32_t(out.atoms.size()));
        out.atoms.push_back(a);
      }
      out.residues.push_back(residue_of(residue.name, residue.seqid.str()));
    }
  }
  conformers.tell(out.notices, Severity::left_out, "atoms of alternate conformers");
  second_residues.tell(out.notices, Severity::left_out,
                       "residues that share the number and place of another");
}

Cell cell_of(const gemmi::UnitCell& from) {
  Cell cell;
  for (size_t side = 0; side < 3; ++side)
    for (size_t i = 0; i < 3; ++i) cell.sides[side][i] = from.orth.mat[i][side];
  return cell;
}

// Those between molecules and within them, of SSBOND, LINK and struct_conn: no hydrogen bonds, and
// none that leads to a copy of the crystal.
void add_links(const gemmi::Structure& s, const gemmi::Model& model, const Kept& kept, Atoms& out) {
  for (const gemmi::Connection& link : s.connections) {
    if (link.asu == gemmi::Asu::Different || link.type == gemmi::Connection::Hydrog) continue;
    const gemmi::Atom* const from = model.find_cra(link.partner1).atom;
    const gemmi::Atom* const to = model.find_cra(link.partner2).atom;
    if (!from || !to) continue;
    // Where it is not said which copy is meant, it is another one if that is nearer.
    if (link.asu == gemmi::Asu::Any && s.cell.is_crystal() &&
        !s.cell.find_nearest_image(from->pos, to->pos, gemmi::Asu::Any).same_asu())
      continue;
    const auto a = kept.find(from), b = kept.find(to);
    if (a == kept.end() || b == kept.end() || a->second == b->second) continue;
    out.bonds.push_back({std::min(a->second, b->second), std::max(a->second, b->second)});
  }
}

// The first of these that the file gives, or nothing.
std::string value_of(gemmi::cif::Block& block, std::initializer_list<const char*> tags) {
  for (const char* tag : tags)
    if (const std::string* value = block.find_value(tag); value && !gemmi::cif::is_null(*value))
      return gemmi::cif::as_string(*value);
  return {};
}

// An operation such as 'x,y,z+1/2', or with decimals, as in '0.5-x,y,.6667+z', of which every
// lattice has multiples of 1/24.
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
      const long parts = std::lround(value * kParts);
      if (std::abs(value * kParts - double(parts)) > kRounded) throw std::runtime_error(number);
      in_parts += std::to_string(parts) + '/' + std::to_string(kParts);
    }
    i = std::max(end, i + 1);
  }
  const gemmi::Op out = gemmi::parse_triplet(in_parts);
  if (std::abs(out.det_rot()) != kParts * kParts * kParts) throw std::runtime_error(in_parts);
  return out;
} catch (const std::runtime_error&) {
  throw std::runtime_error("expected operations of symmetry such as 'x,y,z+1/2', found '" + text +
                           "'");
}

// Whether these turn and mirror as the group does, whatever the origin.
bool are_of_group(const std::vector<gemmi::Op>& operations, const gemmi::SpaceGroup& group) {
  std::vector<gemmi::Op::Rot> listed, known;
  for (const gemmi::Op& op : operations) listed.push_back(op.rot);
  for (const gemmi::Op op : group.operations()) known.push_back(op.rot);
  std::sort(listed.begin(), listed.end());
  std::sort(known.begin(), known.end());
  return listed == known;
}

// The operations of a crystal's symmetry, as the file lists them, or else those of its group, by
// whatever the file calls it.
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
                          "the operations of symmetry that it lists are not those of its space "
                          "group '" +
                              name + "'; they count");
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
    notices.add_whole(Severity::guessed, "no symmetry (P 1), as the file tells none");
    out.push_back(gemmi::Op::identity());
  } else {
    throw std::runtime_error("its space group '" + (name.empty() ? number : name) +
                             "' is not known, and it lists no symmetry operations");
  }
  return out;
}

// Into the cell, 0 to below 1. What is written with few digits is 0 where it is nearly 1.
double wrapped(double x) {
  x -= std::floor(x);
  return x > 1 - 1e-4 ? 0 : x;
}

// The element of a site whose symbol is none: labels of minerals, such as Oa1 and Hw, begin with
// one.
uint8_t element_of_label(const std::string& label) {
  if (const uint8_t element = element_of_symbol(label)) return element;
  std::string_view letters = label;
  letters = letters.substr(0, letters.find_first_of("0123456789+-()'_ "));
  if (letters.substr(0, 2) == "Wa") return element_of_symbol("O");  // water, such as Wat1
  if (letters.size() > 2 && letters[1] >= 'a')
    if (const uint8_t element = element_of_symbol(letters.substr(0, 2))) return element;
  return element_of_symbol(letters.substr(0, 1));
}

// Places in a cell that repeats, in bins, of which only neighbours can be near.
class Places {
 public:
  static constexpr double kSame = 0.1;  // angstroms

  explicit Places(const gemmi::UnitCell& cell) : cell_(cell) {
    const double reciprocal[3] = {cell.ar, cell.br, cell.cr};
    for (size_t k = 0; k < 3; ++k) {
      const double most = 1 / (kSame * reciprocal[k]);
      bins_[k] = most > 1 ? long(std::min(most, 1000.0)) : 1;
    }
  }

  void add(const gemmi::Fractional& place) {
    const auto [i, j, k] = bin_of(place);
    places_[key(i, j, k)].push_back(place);
  }
  bool has_near(const gemmi::Fractional& place) const {
    const auto [i, j, k] = bin_of(place);
    for (long a = -1; a <= 1; ++a)
      for (long b = -1; b <= 1; ++b)
        for (long c = -1; c <= 1; ++c)
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
  std::array<long, 3> bin_of(const gemmi::Fractional& p) const {
    return {long(p.x * double(bins_[0])), long(p.y * double(bins_[1])),
            long(p.z * double(bins_[2]))};
  }
  long key(long i, long j, long k) const {
    const auto wrap = [](long at, long count) { return ((at % count) + count) % count; };
    return (wrap(i, bins_[0]) * bins_[1] + wrap(j, bins_[1])) * bins_[2] + wrap(k, bins_[2]);
  }

  const gemmi::UnitCell& cell_;
  std::array<long, 3> bins_{};
  std::unordered_map<long, std::vector<gemmi::Fractional>> places_;
};

// A site, and where the symmetry puts it.
struct Site {
  std::vector<gemmi::Fractional> places;
  uint8_t element = 0;
  const gemmi::SmallStructure::Site* from = nullptr;
};

// Those that are drawn.
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
      disordered.add(site.label);  // of a disordered part the first choice
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
  disordered.tell(notices, Severity::left_out, "sites of other groups of a disorder");
  placeless.tell(notices, Severity::left_out, "sites without coordinates");
  return out;
}

// Angles of the cell are right ones where a file does not give them, by the dictionary of CIF.
void complete_angles(gemmi::cif::Block& block, Notices& notices) {
  for (const char* angle : {"alpha", "beta", "gamma"}) {
    const std::string tag = std::string("_cell_angle_") + angle;
    auto values = block.find_values(tag);
    if (values.length() > 0 && !gemmi::cif::is_null(values[0])) continue;
    block.set_pair(tag, "90");
    notices.add(Severity::guessed, "angles of the cell that the file does not give: 90 degrees",
                angle);
  }
}

// A crystal by the parts of its cell, as the CIF of chemistry has it.
void add_crystal(gemmi::cif::Block& block, Atoms& out) {
  complete_angles(block, out.notices);
  const gemmi::SmallStructure small = gemmi::make_small_structure_from_block(block);
  if (!small.cell.is_crystal())
    throw std::runtime_error("it gives parts of a cell, but not the lengths of the cell's sides");
  const std::vector<gemmi::Op> symmetry = symmetry_of(block, small, out.notices);
  out.frames = 1;
  out.cell = cell_of(small.cell);
  out.has_residues = out.has_b_factors = true;
  std::vector<Site> sites = sites_of(block, small, out.notices);
  // Where elements share a site, the most frequent one is drawn.
  std::vector<Site*> by_occupancy;
  for (Site& site : sites) by_occupancy.push_back(&site);
  std::stable_sort(by_occupancy.begin(), by_occupancy.end(),
                   [](const Site* a, const Site* b) { return a->from->occ > b->from->occ; });
  Places taken(small.cell);
  Cases shared;
  for (Site* site : by_occupancy) {
    const gemmi::Fractional& at = site->from->fract;
    Places own(small.cell);  // an operation may leave an atom where it is
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
              "sites at the place of another that is occupied as much or more");
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

// A ligand of the PDB's dictionary, by its ideal coordinates, else by those of a model or, of a
// library of restraints, without a prefix: the first of these that no atom lacks.
void add_component(gemmi::cif::Block& block, Atoms& out) {
  const std::string prefix = "_chem_comp_atom.";
  constexpr const char* kPlaces[] = {"pdbx_model_Cartn_x_ideal", "model_Cartn_x", "x"};
  std::array<std::string, 3> chosen;
  long fewest = std::numeric_limits<long>::max();
  for (const std::string x : kPlaces) {
    std::array<std::string, 3> tags = {x, x, x};
    const size_t at = x.find('x', x.find("Cartn_") == std::string::npos ? 0 : x.find("Cartn_"));
    tags[1][at] = 'y', tags[2][at] = 'z';
    long missing = 0;
    gemmi::cif::Table table = block.find(prefix, {tags[0], tags[1], tags[2]});
    for (const auto row : table)
      for (int k = 0; k < 3; ++k) missing += !std::isfinite(gemmi::cif::as_number(row[size_t(k)]));
    if (table.ok() && missing < fewest) fewest = missing, chosen = tags;
  }
  std::map<std::string, uint32_t> indices;
  std::vector<std::string> names;
  ElementCases elements;
  Cases placeless;
  for (const auto row : block.find(
           prefix, {"atom_id", chosen[0], chosen[1], chosen[2], "?type_symbol", "?comp_id"})) {
    const std::string name = row.str(0);
    Atom atom;
    std::array<double, 3> place{};
    for (size_t k = 0; k < 3; ++k) place[k] = gemmi::cif::as_number(row[k + 1]);
    atom.place = out.local(place);
    if (!std::isfinite(atom.place[0] + atom.place[1] + atom.place[2])) {
      placeless.add(name);
      continue;
    }
    if (row.has2(4)) atom.element = element_of_symbol(row.str(4));
    if (atom.element == 0) {
      atom.element = element_of_names(row.has2(5) ? row.str(5) : "", name);
      elements.add(atom.element, name);
    }
    indices.emplace(name, uint32_t(out.atoms.size()));
    names.push_back(name);
    out.atoms.push_back(atom);
  }
  for (const auto row : block.find("_chem_comp_bond.", {"atom_id_1", "atom_id_2"})) {
    const auto a = indices.find(row.str(0)), b = indices.find(row.str(1));
    out.finds_bonds = false;
    if (a == indices.end() || b == indices.end() || a->second == b->second) continue;
    out.bonds.push_back({std::min(a->second, b->second), std::max(a->second, b->second)});
  }
  elements.tell(out.notices);
  placeless.tell(out.notices, Severity::left_out, "atoms without coordinates");
  note_coincident(out, [&](uint32_t i) { return names[i]; });
}

// The symbols of atoms that have none, by their names.
void complete_elements(gemmi::cif::Loop& loop, Notices& notices) {
  const int symbol = loop.find_tag("_atom_site.type_symbol");
  const auto either = [&](const char* first, const char* second) {
    const int at = loop.find_tag(first);
    return at < 0 ? loop.find_tag(second) : at;
  };
  const int name = either("_atom_site.label_atom_id", "_atom_site.auth_atom_id");
  const int residue = either("_atom_site.label_comp_id", "_atom_site.auth_comp_id");
  ElementCases elements;
  for (size_t row = 0; name >= 0 && row < loop.length(); ++row) {
    std::string& of_row = loop.values[row * loop.width() + size_t(symbol)];
    const auto at = [&](int column) {
      return column < 0 ? std::string()
                        : gemmi::cif::as_string(loop.values[row * loop.width() + size_t(column)]);
    };
    if (!gemmi::cif::is_null(of_row) && of_row != "X") continue;
    const uint8_t element = element_of_names(at(residue), at(name));
    elements.add(element, at(name));
    of_row = gemmi::Element(static_cast<gemmi::El>(element)).name();
  }
  elements.tell(notices);
}

// Whole numbers that no int holds, which gemmi would read, become unknown.
void drop_large_numbers(gemmi::cif::Loop& loop, Notices& notices) {
  const auto is_too_large = [](std::string_view value) {
    if (value.size() <= std::numeric_limits<int>::digits10) return false;
    if (value.front() == '+') value.remove_prefix(1);
    int number;
    return std::from_chars(value.data(), value.data() + value.size(), number).ec ==
           std::errc::result_out_of_range;
  };
  Cases dropped;
  for (const char* tag : {"_atom_site.id", "_atom_site.label_seq_id", "_atom_site.auth_seq_id",
                          "_atom_site.pdbx_formal_charge"}) {
    const int column = loop.find_tag(tag);
    for (size_t row = 0; column >= 0 && row < loop.length(); ++row) {
      std::string& value = loop.values[row * loop.width() + size_t(column)];
      if (!is_too_large(value)) continue;
      dropped.add(value);
      value = "?";
    }
  }
  dropped.tell(notices, Severity::left_out, "serials, residue numbers and charges beyond 32 bits");
}

// The columns that gemmi wants of a table of atoms and that files may leave out.
void complete_atoms(gemmi::cif::Block& block, Notices& notices) {
  gemmi::cif::Loop* const loop = block.find_loop("_atom_site.Cartn_x").get_loop();
  if (!loop) return;
  struct Column {
    const char *tag, *value, *copied_from, *instead;
  };
  static constexpr Column kColumns[] = {
      {"_atom_site.id", "1", "", ""},
      {"_atom_site.type_symbol", "?", "", ""},
      {"_atom_site.label_atom_id", "X", "_atom_site.type_symbol", "_atom_site.auth_atom_id"},
      {"_atom_site.label_alt_id", ".", "", ""},
      {"_atom_site.label_comp_id", "UNL", "", "_atom_site.auth_comp_id"},
      {"_atom_site.label_asym_id", "A", "_atom_site.auth_asym_id", ""},
      {"_atom_site.occupancy", "1", "", ""},
      {"_atom_site.B_iso_or_equiv", "?", "", ""},
      {"_atom_site.auth_seq_id", "1", "_atom_site.label_seq_id", ""}};
  const size_t width = loop->tags.size();
  std::vector<std::pair<std::string, int>> missing;  // a value, or the column that has it, or -1
  for (const Column& c : kColumns) {
    if (loop->has_tag(c.tag) || loop->has_tag(c.instead)) continue;
    const int source = loop->find_tag(c.copied_from);
    missing.emplace_back(c.value,
                         source < int(width) ? source : -1);  // the source itself may be missing
    loop->tags.emplace_back(c.tag);
  }
  if (!missing.empty()) {
    std::vector<std::string> values;
    for (auto row = loop->values.begin(); row != loop->values.end(); row += long(width)) {
      values.insert(values.end(), row, row + long(width));
      for (const auto& [value, column] : missing)
        values.push_back(column < 0 ? value : row[column]);
    }
    loop->values = std::move(values);
  }
  complete_elements(*loop, notices);
  drop_large_numbers(*loop, notices);
}

// _pdbx_struct_assembly_gen of mmCIF: an operation is the product of one of each list, as in
// "(1-60)(61-88)". Taken out of the file, since gemmi leaves out products, and lists all numbers of
// whatever range.
class Assemblies {
 public:
  explicit Assemblies(gemmi::cif::Block& block) {
    gemmi::cif::Table table = block.find("_pdbx_struct_assembly_gen.",
                                         {"assembly_id", "oper_expression", "asym_id_list"});
    for (const auto row : table) generators_.push_back({row.str(0), row.str(1), row.str(2)});
    if (table.ok()) table.erase();
    std::vector<std::string> tags = {"id"};
    for (const char* row : {"1", "2", "3"}) {
      for (const char* column : {"1", "2", "3"})
        tags.push_back(std::string("matrix[") + row + "][" + column + "]");
      tags.push_back(std::string("vector[") + row + "]");
    }
    for (const auto row : block.find("_pdbx_struct_oper_list.", tags)) {
      gemmi::Transform t;
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) t.mat[i][k] = gemmi::cif::as_number(row[size_t(1 + 4 * i + k)]);
        t.vec.at(i) = gemmi::cif::as_number(row[size_t(4 + 4 * i)]);
      }
      operations_.emplace(row.str(0), t);
    }
  }

  std::vector<Assembly> take(Names& parts) const {
    std::vector<Assembly> out;
    std::map<std::string, size_t> places;
    for (const Generator& from : generators_) {
      const auto [at, is_new] = places.emplace(from.assembly, out.size());
      if (is_new) out.emplace_back();
      Assembly::Copies copies;
      for (const std::string& name : split(from.parts, ','))
        copies.parts.push_back(parts.number(name));
      for (const gemmi::Transform& t : operations_of(from.expression)) {
        std::array<float, 12> matrix{};
        for (int row = 0; row < 3; ++row) {
          for (int column = 0; column < 3; ++column)
            matrix[size_t(row * 4 + column)] = float(t.mat[row][column]);
          matrix[size_t(row * 4 + 3)] = float(t.vec.at(row));
        }
        copies.matrices.push_back(matrix);
      }
      out[at->second].copies.push_back(copies);
    }
    return out;
  }

 private:
  static constexpr size_t kMostCopies = 1000000;

  struct Generator {
    std::string assembly, expression, parts;
  };

  static std::vector<std::string> split(const std::string& list, char by) {
    std::vector<std::string> out;
    std::istringstream words(list);
    for (std::string word; std::getline(words, word, by);) {
      word.erase(std::remove_if(word.begin(), word.end(), [](char c) { return c <= ' '; }),
                 word.end());
      if (!word.empty()) out.push_back(word);
    }
    return out;
  }

  std::vector<gemmi::Transform> operations_of(const std::string& expression) const {
    std::vector<gemmi::Transform> all = {gemmi::Transform()};
    bool any = false;
    for (std::string list : split(expression, ')')) {
      list.erase(std::remove(list.begin(), list.end(), '('), list.end());
      std::vector<gemmi::Transform> next;
      for (const std::string& word : split(list, ','))
        for (const gemmi::Transform& last : named(word))
          for (const gemmi::Transform& first : all) {
            if (next.size() == kMostCopies)
              throw std::runtime_error("its assembly has more than a million copies");
            next.push_back(first.combine(last));
          }
      all = std::move(next), any = true;
    }
    return any ? all : std::vector<gemmi::Transform>();
  }

  // One, or those of a range of numbers.
  std::vector<gemmi::Transform> named(const std::string& word) const {
    std::vector<gemmi::Transform> out;
    const auto at = operations_.find(word);
    if (at != operations_.end()) return {at->second};
    const size_t dash = word.find('-', 1);
    if (dash == std::string::npos) return out;
    const long low = std::atol(word.c_str()), high = std::atol(word.c_str() + dash + 1);
    std::map<long, gemmi::Transform> found;
    for (const auto& [name, t] : operations_)
      if (const long number = std::atol(name.c_str());
          number >= low && number <= high && std::to_string(number) == name)
        found.emplace(number, t);
    for (const auto& [number, t] : found) out.push_back(t);
    return out;
  }

  std::vector<Generator> generators_;
  std::map<std::string, gemmi::Transform> operations_;
};

// gemmi's message, which begins with a place, or with the name of the file, which is empty.
CifFault fault_of(std::string message) {
  CifFault out;
  message = message.substr(0, message.find('\n'));
  const auto number = [&](size_t& to) {
    const size_t from = message.find_first_not_of(':');
    const size_t end = std::min(message.find_first_not_of("0123456789", from), message.size());
    if (from == std::string::npos || end == from) return;
    to = size_t(std::atol(message.c_str() + from));
    message.erase(0, end);
  };
  number(out.line);
  if (out.line > 0) number(out.column);
  message.erase(0, std::min(message.find_first_not_of(": "), message.size()));
  out.message = message;
  return out;
}

// Reads on where a strict reader would not, and says so.
gemmi::cif::Document document_of(const char* text, size_t size, Notices& notices) {
  namespace cif = gemmi::cif;
  const auto parse = [](const char* from, size_t count) {
    cif::Document out;
    cif::parse_input(out, tao::pegtl::memory_input<>(from, count, ""));
    return out;
  };
  const auto is_plain = [](char c) { return static_cast<unsigned char>(c) < 128; };
  cif::Document out;
  try {
    out = parse(text, size);
  } catch (const tao::pegtl::parse_error&) {
    if (std::all_of(text, text + size, is_plain)) throw;
    std::string plain(text, size);
    std::replace_if(plain.begin(), plain.end(), [&](char c) { return !is_plain(c); }, '?');
    out = parse(plain.data(), size);
    const size_t first = size_t(std::find_if_not(text, text + size, is_plain) - text);
    notices.add(Severity::warning, "letters beyond ASCII without quotes, which CIF does not allow",
                {}, 1 + size_t(std::count(text, text + first, '\n')),
                size_t(std::count_if(text, text + size, [](char c) {
                  return (static_cast<unsigned char>(c) & 0xc0) == 0xc0;
                })));
  }
  try {
    cif::check_for_duplicates(out);
  } catch (const std::exception& error) {
    const CifFault fault = fault_of(error.what());
    const std::string tag = "duplicate tag ";
    const size_t at = fault.message.find(tag);
    notices.add(Severity::warning, "tags or names of blocks given twice, of which the first counts",
                at == std::string::npos ? "" : fault.message.substr(at + tag.size()), fault.line);
  }
  return out;
}

// Whether a block has anything in a category, by the beginning of its tags.
bool has_category(const gemmi::cif::Block& block, const std::string& category) {
  for (const gemmi::cif::Item& item : block.items) {
    if (item.type == gemmi::cif::ItemType::Pair && item.pair[0].rfind(category, 0) == 0)
      return true;
    if (item.type == gemmi::cif::ItemType::Loop && !item.loop.tags.empty() &&
        item.loop.tags[0].rfind(category, 0) == 0)
      return true;
  }
  return false;
}

std::string name_in(const gemmi::Model& model, const Kept& kept, uint32_t index) {
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      for (const gemmi::Atom& atom : residue.atoms)
        if (const auto at = kept.find(&atom); at != kept.end() && at->second == index)
          return atom.name + ' ' + residue.name + ' ' + chain.name + residue.seqid.str();
  return {};
}

void add_molecule(gemmi::cif::Block& block, int frame, Atoms& out) {
  complete_atoms(block, out.notices);
  const Assemblies assemblies(block);
  gemmi::Structure s = gemmi::make_structure_from_block(block);
  out.frames = s.models.size();
  const long at = frame < 0 ? long(s.models.size()) + frame : frame;
  if (at < 0 || at >= long(s.models.size())) return;
  std::vector<std::string> part_names;
  Names chains(out.chains), parts(part_names);
  Kept kept;
  const gemmi::Model& model = s.models[size_t(at)];
  add_model(model, chains, parts, out, kept);
  out.has_residues = out.has_b_factors = true;
  if (s.cell.is_crystal()) out.cell = cell_of(s.cell);
  if (s.cell.explicit_matrices)
    out.notices.add_whole(Severity::warning,
                          "the matrix _atom_sites.fract_transf_matrix disagrees with _cell; the "
                          "cell is that of the matrix");
  add_links(s, model, kept, out);
  note_coincident(out, [&](uint32_t i) { return name_in(model, kept, i); });
  out.assemblies = assemblies.take(parts);
}

// What a block says of atoms.
enum class Holds { nothing, crystal, molecule, component };

Holds holds(gemmi::cif::Block& block) {
  if (block.find_values("_atom_site_fract_x")) return Holds::crystal;
  if (block.find_values("_atom_site.Cartn_x")) return Holds::molecule;
  for (const char* x : {"pdbx_model_Cartn_x_ideal", "model_Cartn_x", "x"})
    if (block.find_values(std::string("_chem_comp_atom.") + x)) return Holds::component;
  return Holds::nothing;
}

gemmi::UnitCell unit_cell(const PdbCrystal& crystal, bool* disagrees = nullptr) {
  gemmi::UnitCell cell;
  const auto& n = crystal.lengths_and_angles;
  cell.set(n[0], n[1], n[2], n[3], n[4], n[5]);
  if (crystal.scale) {
    gemmi::Transform fraction;
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) fraction.mat[row][k] = (*crystal.scale)[size_t(4 * row + k)];
      fraction.vec.at(row) = (*crystal.scale)[size_t(4 * row + 3)];
    }
    cell.set_matrices_from_fract(fraction);
    if (disagrees) *disagrees = cell.explicit_matrices;
  }
  return cell;
}

}  // namespace

std::optional<Cell> cell_of(const PdbCrystal& crystal, Notices& notices) try {
  bool disagrees = false;
  const gemmi::UnitCell cell = unit_cell(crystal, &disagrees);
  if (!cell.is_crystal()) return std::nullopt;
  if (disagrees)
    notices.add_whole(Severity::warning,
                      "the records SCALE disagree with CRYST1; the cell is that of SCALE");
  return cell_of(cell);
} catch (const std::runtime_error&) {
  notices.add_whole(Severity::left_out, "the cell, as CRYST1 has angles that no cell has");
  return std::nullopt;
}

bool is_nearest_copy(const PdbCrystal& crystal, const std::array<double, 3>& from,
                     const std::array<double, 3>& to) try {
  gemmi::UnitCell cell = unit_cell(crystal);
  if (!cell.is_crystal()) return true;
  cell.set_cell_images_from_spacegroup(
      gemmi::find_spacegroup_by_name(crystal.group, cell.alpha, cell.gamma));
  return cell
      .find_nearest_image({from[0], from[1], from[2]}, {to[0], to[1], to[2]}, gemmi::Asu::Any)
      .same_asu();
} catch (const std::runtime_error&) {
  return true;
}

std::optional<CifFault> read_structure(const char* text, size_t size, int frame, Atoms& out) try {
  gemmi::cif::Document document = document_of(text, size, out.notices);
  gemmi::cif::Block* chosen = nullptr;
  Cases others;
  bool has_reflections = false;
  for (gemmi::cif::Block& block : document.blocks) {
    has_reflections |= has_category(block, "_refln.") || has_category(block, "_refln_");
    if (holds(block) == Holds::nothing) continue;
    if (chosen)
      others.add(block.name);
    else
      chosen = &block;
  }
  if (!chosen && has_reflections)
    return CifFault{
        "this CIF file holds reflections, but no atoms; give the file of the structure"};
  if (!chosen)
    return CifFault{
        "this CIF file holds no atoms; expected coordinates, as _atom_site.Cartn_x, "
        "_atom_site_fract_x or _chem_comp_atom.model_Cartn_x"};
  others.tell(out.notices, Severity::left_out, "blocks with atoms behind the first such block");
  const bool is_only_frame = frame == 0 || frame == -1;
  switch (holds(*chosen)) {
    case Holds::molecule:
      add_molecule(*chosen, frame, out);
      break;
    case Holds::crystal:
      if (is_only_frame) add_crystal(*chosen, out);
      break;
    default:
      if (is_only_frame) add_component(*chosen, out);
  }
  return std::nullopt;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  return fault_of(error.what());
}

}  // namespace raio
