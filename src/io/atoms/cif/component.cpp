#include <cmath>
#include <gemmi/numb.hpp>
#include <limits>
#include <map>

#include "io/atoms/cif/cif.h"
#include "io/atoms/element_names.h"

namespace raio::core {

void add_component(gemmi::cif::Block& block, Atoms& out) {
  const std::string prefix = "_chem_comp_atom.";
  constexpr const char* kPlaces[] = {"pdbx_model_Cartn_x_ideal", "model_Cartn_x", "x"};
  std::array<std::string, 3> chosen;
  int64_t fewest = std::numeric_limits<int64_t>::max();
  for (const std::string x : kPlaces) {
    std::array<std::string, 3> tags = {x, x, x};
    const size_t at = x.find('x', x.find("Cartn_") == std::string::npos ? 0 : x.find("Cartn_"));
    tags[1][at] = 'y', tags[2][at] = 'z';
    int64_t missing = 0;
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

}  // namespace raio::core
