#include "io/atoms/labels.h"

#include <fmt/format.h>

#include <string_view>

#include "io/atoms/colors.h"

namespace raio::core {

std::string AtomLabels::label(std::optional<uint32_t> prototype, uint32_t sphere) const {
  uint32_t atom = sphere;
  if (prototype && *prototype < of_prototype.size() && !of_prototype[*prototype].empty()) {
    const auto& atoms = of_prototype[*prototype];
    if (sphere >= atoms.size()) return {};
    atom = atoms[sphere];
  }
  std::string text;
  const auto add = [&](std::string_view part) {
    if (part.empty()) return;
    if (!text.empty()) text += ", ";
    text += part;
  };
  if (atom < elements.size()) add(element_symbol(elements[atom]));
  if (atom < residues.size() && residues[atom] < residue_names.size()) {
    const Residue& residue = residue_names[residues[atom]];
    add(fmt::format("{} {}", residue.view(), residue.number));
  }
  if (atom < chains.size() && chains[atom] < chain_names.size() &&
      !chain_names[chains[atom]].empty())
    add("chain " + chain_names[chains[atom]]);
  return text;
}

}  // namespace raio::core
