#include <cmath>
#include <limits>
#include <map>

#include "io/atoms/cif/block.h"
#include "io/atoms/cif/cif.h"
#include "io/atoms/element_names.h"
#include "io/atoms/site_values.h"

namespace raio::core::cif {

void add_component(const Block& block, Atoms& out) {
  const std::string prefix = "_chem_comp_atom.";
  constexpr const char* kPlaces[] = {"pdbx_model_Cartn_x_ideal", "model_Cartn_x", "x"};
  std::array<std::string, 3> chosen;
  int64_t fewest = std::numeric_limits<int64_t>::max();
  for (const std::string x : kPlaces) {
    std::array<std::string, 3> tags = {x, x, x};
    const size_t at = x.find('x', x.find("Cartn_") == std::string::npos ? 0 : x.find("Cartn_"));
    tags[1][at] = 'y', tags[2][at] = 'z';
    int64_t missing = 0;
    const Table table(block, prefix, {tags[0], tags[1], tags[2]});
    for (size_t row = 0; row < table.rows(); ++row)
      for (size_t k = 0; k < 3; ++k) missing += !std::isfinite(number_of(table.at(row, k)));
    if (table.is_complete() && missing < fewest) fewest = missing, chosen = tags;
  }
  std::map<std::string, uint32_t, std::less<>> indices;
  std::vector<std::string> names;
  ElementCases elements;
  Cases placeless;
  const Table table(block, prefix,
                    {"atom_id", chosen[0], chosen[1], chosen[2], "?type_symbol", "?comp_id"});
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string name(table.text(row, 0));
    Atom atom;
    std::array<double, 3> place{};
    for (size_t k = 0; k < 3; ++k) place[k] = number_of(table.at(row, k + 1));
    atom.place = out.local(place);
    if (!std::isfinite(atom.place[0] + atom.place[1] + atom.place[2])) {
      placeless.add(name);
      continue;
    }
    atom.element = element_of_symbol(table.text(row, 4));
    if (atom.element == 0) {
      atom.element = element_of_names(table.text(row, 5), name);
      elements.add(atom.element, name);
    }
    indices.emplace(name, uint32_t(out.atoms.size()));
    names.push_back(name);
    out.atoms.push_back(atom);
    if (out.marks) out.marks->add(name, std::nullopt);
  }
  const Table bonds(block, "_chem_comp_bond.", {"atom_id_1", "atom_id_2"});
  for (size_t row = 0; row < bonds.rows(); ++row) {
    const auto a = indices.find(bonds.text(row, 0)), b = indices.find(bonds.text(row, 1));
    out.finds_bonds = false;
    if (a == indices.end() || b == indices.end() || a->second == b->second) continue;
    out.bonds.push_back({std::min(a->second, b->second), std::max(a->second, b->second)});
  }
  elements.tell(out.notices);
  placeless.tell(out.notices, Severity::left_out, "atoms without coordinates");
  note_coincident(out, [&](uint32_t i) { return names[i]; });
}

}  // namespace raio::core::cif
