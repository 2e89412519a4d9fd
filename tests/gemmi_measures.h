// Distances and angles as gemmi computes them, and its atoms of a PDB text. Like io/atoms/gemmi.h,
// plain data: gemmi_measures.cpp is C++17.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace raio::core::tests {

using GemmiPlace = std::array<double, 3>;

struct GemmiAtom {
  std::string name, residue, chain;
  int residue_number = 0, serial = 0;
  GemmiPlace place{};
};
std::vector<GemmiAtom> atoms_by_gemmi(const std::string& pdb);

double distance_by_gemmi(const GemmiPlace& a, const GemmiPlace& b);
/// In degrees.
double angle_by_gemmi(const GemmiPlace& a, const GemmiPlace& b, const GemmiPlace& c);
double dihedral_by_gemmi(const GemmiPlace& a, const GemmiPlace& b, const GemmiPlace& c,
                         const GemmiPlace& d);

}  // namespace raio::core::tests
