// PDB and mmCIF, by gemmi. In C++17: with its headers clang refuses the containers of incomplete
// types that later versions evaluate at compile time.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <gemmi/pdb.hpp>
#include <gemmi/smcif.hpp>
#include <locale>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "io/atoms/atoms.h"

namespace raio {
namespace {

class Names {
 public:
  explicit Names(std::vector<std::string>& list) : list_(list) {}
  uint32_t number(const std::string& name) {
    const auto [at, is_new] = numbers_.emplace(name, uint32_t(list_.size()));
    if (is_new) list_.push_back(name);
    return at->second;
  }

 private:
  std::vector<std::string>& list_;
  std::map<std::string, uint32_t> numbers_;
};

// Indices of the atoms that are kept, by gemmi's atom and by serial number; kTwice where several
// atoms share a number.
struct Kept {
  static constexpr uint32_t kTwice = 0xffffffff;
  std::unordered_map<const gemmi::Atom*, uint32_t> atoms;
  std::unordered_map<int, uint32_t> serials;
};

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

void add_model(const gemmi::Model& model, bool cif, Names& chains, Names& parts, Atoms& out,
               Kept& kept) {
  uint32_t residues = 0;
  for (const gemmi::Chain& chain : model.chains) {
    FirstChoice first;
    for (const gemmi::Residue& residue : chain.residues) {
      if (!first.takes(residue)) continue;
      const uint32_t number = chains.number(chain.name);
      const uint32_t part = cif ? parts.number(residue.subchain) : number;
      for (const gemmi::Atom& atom : residue.atoms) {
        if (!first.takes(atom)) continue;
        Atom a;
        a.place = {float(atom.pos.x), float(atom.pos.y), float(atom.pos.z)};
        const gemmi::Element element = atom.element;
        a.element = element.elem == gemmi::El::D ? 1 : uint8_t(element.atomic_number());
        a.chain = number, a.part = part, a.residue = residues;
        a.occupancy = atom.occ, a.b_factor = atom.b_iso;
        const auto index = uint32_t(out.atoms.size());
        kept.atoms.emplace(&atom, index);
        const auto [at, is_new] = kept.serials.emplace(atom.serial, index);
        if (!is_new) at->second = Kept::kTwice;
        out.atoms.push_back(a);
      }
      ++residues;
    }
  }
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
    const auto a = kept.atoms.find(from), b = kept.atoms.find(to);
    if (a == kept.atoms.end() || b == kept.atoms.end() || a->second == b->second) continue;
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

// The operations of a crystal's symmetry, as the file lists them, or else those of its group, by
// whatever the file calls it.
std::vector<gemmi::Op> symmetry_of(gemmi::cif::Block& block, const gemmi::SmallStructure& small) {
  std::vector<gemmi::Op> out;
  for (const char* tag : {"_space_group_symop_operation_xyz", "_symmetry_equiv_pos_as_xyz"})
    if (const auto column = block.find_values(tag)) {
      for (const std::string& text : column)
        out.push_back(gemmi::parse_triplet(gemmi::cif::as_string(text)));
      return out;
    }
  const std::string& name = small.spacegroup_hm;
  const std::string hall =
      value_of(block, {"_space_group_name_Hall", "_symmetry_space_group_name_Hall"});
  const std::string number =
      value_of(block, {"_space_group_IT_number", "_symmetry_Int_Tables_number"});
  const gemmi::SpaceGroup* known =
      gemmi::find_spacegroup_by_name(name, small.cell.alpha, small.cell.gamma);
  const int known_number = std::atoi(number.c_str());
  if (!known && hall.empty() && known_number > 0)
    known = gemmi::find_spacegroup_by_number(known_number);
  if (known || !hall.empty()) {
    for (const gemmi::Op op : known ? known->operations() : gemmi::symops_from_hall(hall.c_str()))
      out.push_back(op);
  } else if (name.empty() && number.empty()) {
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

// A crystal by the parts of its cell, as the CIF of chemistry has it.
void add_crystal(gemmi::cif::Block& block, Atoms& out) {
  const gemmi::SmallStructure small = gemmi::make_small_structure_from_block(block);
  if (!small.cell.is_crystal())
    throw std::runtime_error("it gives parts of a cell, but not the lengths of the cell's sides");
  const std::vector<gemmi::Op> symmetry = symmetry_of(block, small);
  constexpr double kSame = 0.1;  // angstroms, of an atom that an operation leaves where it is
  out.frames = 1;
  out.cell = cell_of(small.cell);
  out.has_residues = out.has_b_factors = true;
  for (size_t i = 0; i < small.sites.size(); ++i) {
    const gemmi::SmallStructure::Site& site = small.sites[i];
    // Of a disordered part the first choice.
    if (site.disorder_group > 1 || !std::isfinite(site.fract.x + site.fract.y + site.fract.z))
      continue;
    std::vector<gemmi::Fractional> places;
    for (const gemmi::Op& op : symmetry) {
      const auto at = op.apply_to_xyz({site.fract.x, site.fract.y, site.fract.z});
      const gemmi::Fractional place(wrapped(at[0]), wrapped(at[1]), wrapped(at[2]));
      const auto is_near = [&](const gemmi::Fractional& other) {
        gemmi::Fractional apart = place - other;
        apart.x -= std::round(apart.x), apart.y -= std::round(apart.y);
        apart.z -= std::round(apart.z);
        return small.cell.orthogonalize_difference(apart).length() < kSame;
      };
      if (std::any_of(places.begin(), places.end(), is_near)) continue;
      places.push_back(place);
      const gemmi::Position pos = small.cell.orthogonalize(place);
      Atom atom;
      atom.place = {float(pos.x), float(pos.y), float(pos.z)};
      const gemmi::Element element = site.element;
      atom.element = element.elem == gemmi::El::D ? 1 : uint8_t(element.atomic_number());
      atom.residue = uint32_t(i);
      atom.occupancy = float(site.occ), atom.b_factor = float(site.u_iso * gemmi::u_to_b());
      out.atoms.push_back(atom);
    }
  }
}

// CONECT records: the number of an atom and of up to four that it is bonded to, five columns each.
std::vector<std::array<uint32_t, 2>> bonds_of_pdb(std::string_view text, const Kept& kept) {
  const auto& serials = kept.serials;
  std::vector<std::array<uint32_t, 2>> out;
  const std::string_view record = "CONECT";
  for (size_t end = 0; !text.empty(); text.remove_prefix(std::min(end + 1, text.size()))) {
    end = std::min(text.find('\n'), text.size());
    if (text.substr(0, record.size()) != record) continue;
    const std::string line(text.substr(0, end));
    const auto atom = [&](size_t k) {
      const size_t column = record.size() + 5 * k;
      if (column >= line.size()) return Kept::kTwice;
      std::string word = line.substr(column, 5);
      word.resize(5, ' ');
      const auto at = serials.find(gemmi::pdb_impl::read_serial(word.c_str()));
      return at == serials.end() ? Kept::kTwice : at->second;
    };
    const uint32_t from = atom(0);
    for (size_t k = 1; k < 5 && from != Kept::kTwice; ++k)
      if (const uint32_t to = atom(k); to != Kept::kTwice && to != from)
        out.push_back({std::min(from, to), std::max(from, to)});
  }
  return out;
}

// Of a PDB text, REMARK 350. Read here since gemmi 0.5 takes matrices by columns, which shift where
// there are a thousand of them.
std::vector<Assembly> assemblies_of_pdb(std::string_view text, Names& chains) {
  std::vector<Assembly> out;
  std::array<float, 12> matrix{};
  constexpr std::string_view kRemark = "REMARK 350";
  for (size_t end = 0; !text.empty(); text.remove_prefix(std::min(end + 1, text.size()))) {
    end = std::min(text.find('\n'), text.size());
    if (text.substr(0, 6) == "ATOM  " || text.substr(0, 6) == "HETATM") break;
    if (text.substr(0, kRemark.size()) != kRemark) continue;
    const std::string line(text.substr(kRemark.size(), end - kRemark.size()));
    const size_t colon = line.find(':');
    if (line.find("BIOMOLECULE:") != std::string::npos) out.emplace_back();
    if (out.empty()) continue;
    auto& copies = out.back().copies;
    if (line.find("APPLY THE FOLLOWING TO CHAINS:") != std::string::npos) copies.emplace_back();
    if (copies.empty()) continue;
    if (colon != std::string::npos && line.find("CHAINS:") != std::string::npos) {
      std::istringstream names(line.substr(colon + 1));
      for (std::string name; std::getline(names, name, ',');) {
        name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c <= ' '; }),
                   name.end());
        if (!name.empty()) copies.back().parts.push_back(chains.number(name));
      }
    }
    const size_t row = line.find("BIOMT");
    if (row == std::string::npos || row + 5 >= line.size()) continue;
    const int number = line[row + 5] - '1';
    if (number < 0 || number > 2) continue;
    std::istringstream numbers(line.substr(row + 6));
    numbers.imbue(std::locale::classic());
    std::string serial;
    numbers >> serial;
    for (size_t k = 0; k < 4; ++k) numbers >> matrix[size_t(number) * 4 + k];
    if (numbers && number == 2) copies.back().matrices.push_back(matrix);
  }
  return out;
}

// The columns that gemmi wants of a table of atoms and that files may leave out.
void complete_atoms(gemmi::cif::Block& block) {
  gemmi::cif::Loop* const loop = block.find_loop("_atom_site.Cartn_x").get_loop();
  if (!loop) return;
  struct Column {
    const char *tag, *value, *copied_from, *instead;
  };
  constexpr Column kColumns[] = {
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
    missing.emplace_back(c.value, loop->find_tag(c.copied_from));
    loop->tags.emplace_back(c.tag);
  }
  if (missing.empty()) return;
  std::vector<std::string> values;
  for (auto row = loop->values.begin(); row != loop->values.end(); row += long(width)) {
    values.insert(values.end(), row, row + long(width));
    for (const auto& [value, column] : missing) values.push_back(column < 0 ? value : row[column]);
  }
  loop->values = std::move(values);
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

}  // namespace

std::string read_structure(const char* text, size_t size, bool cif, int frame, Atoms& out) try {
  gemmi::Structure s;
  std::optional<Assemblies> assemblies;
  if (cif) {
    gemmi::cif::Document document = gemmi::cif::read_memory(text, size, "");
    for (gemmi::cif::Block& block : document.blocks)
      if (block.find_values("_atom_site_fract_x")) {
        if (frame == 0 || frame == -1)
          add_crystal(block, out);
        else
          out.frames = 1;
        return {};
      }
    if (document.blocks.empty()) return {};
    complete_atoms(document.blocks[0]);
    assemblies.emplace(document.blocks[0]);
    s = gemmi::make_structure(std::move(document));
  } else {
    s = gemmi::read_pdb_from_memory(text, size, "");
  }
  out.frames = s.models.size();
  const long at = frame < 0 ? long(s.models.size()) + frame : frame;
  if (at < 0 || at >= long(s.models.size())) return {};
  std::vector<std::string> part_names;
  Names chains(out.chains), parts(part_names);
  Kept kept;
  const gemmi::Model& model = s.models[size_t(at)];
  add_model(model, cif, chains, parts, out, kept);
  out.has_residues = out.has_b_factors = true;
  if (s.cell.is_crystal()) out.cell = cell_of(s.cell);
  if (!cif) out.bonds = bonds_of_pdb({text, size}, kept);
  add_links(s, model, kept, out);
  out.assemblies = cif ? assemblies->take(parts) : assemblies_of_pdb({text, size}, chains);
  return {};
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  return error.what();
}

}  // namespace raio
