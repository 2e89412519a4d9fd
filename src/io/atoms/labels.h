// Names, numbers, residues and chains of the atoms of a scene, shown when a user picks one.
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
  std::vector<uint32_t> residues;
  std::vector<uint32_t> indices;  // among the atoms read; empty: its own
  AtomMarks marks;                // by index
  std::vector<Residue> residue_names;
  std::vector<uint32_t> chains;  // of each residue; kNone: none of its atoms is in the scene
  std::vector<std::string> chain_names;
  /// By prototype: the atoms of its spheres. Of the scene itself, spheres and atoms have the same
  /// numbers.
  std::vector<std::vector<uint32_t>> of_prototype;
  uint32_t atoms = 0;
  static constexpr uint32_t kNone = UINT32_MAX;

  /// The atom of a sphere; nothing if it is none.
  std::optional<uint32_t> atom(std::optional<uint32_t> prototype, uint32_t sphere) const;
  /// "C, ALA 12 CA, chain A"; `chain` is that word. Empty if nothing is known.
  std::string label(uint32_t atom, std::string_view chain = "chain") const;
  /// Its index in selections, from 0, and its number in the file.
  uint32_t index(uint32_t atom) const { return indices.empty() ? atom : indices[atom]; }
  std::optional<uint32_t> number(uint32_t atom) const { return marks.number(index(atom)); }

  // Selections (io/atoms/select.h) of all these atoms; empty if the file does not say.
  std::string select(const std::vector<uint32_t>& chosen) const;
  std::string select_residue(uint32_t atom) const;
  std::string select_chain(uint32_t atom) const;

  // Null: not known.
  const Residue* residue(uint32_t atom) const;
  const std::string* chain(uint32_t atom) const;

 private:
  template <class Is>
  std::string select_where(const Is& is) const;
};

}  // namespace raio::core
