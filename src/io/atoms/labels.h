// The element, residue and chain of each atom of a scene, shown when a user picks one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/atoms/atoms.h"

namespace raio::core {

struct AtomLabels {
  // Of each atom; empty: the file does not say.
  std::vector<uint8_t> elements;
  std::vector<uint32_t> residues, chains;
  std::vector<Residue> residue_names;
  std::vector<std::string> chain_names;
  /// By prototype: the atoms of its spheres. Of the scene itself, spheres and atoms have the same
  /// numbers.
  std::vector<std::vector<uint32_t>> of_prototype;

  /// "C, ALA 12, chain A"; empty if nothing is known, or the sphere is no atom.
  std::string label(std::optional<uint32_t> prototype, uint32_t sphere) const;
};

}  // namespace raio::core
