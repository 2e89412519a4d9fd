#include "gemmi_measures.h"

#include <gemmi/calculate.hpp>
#include <gemmi/pdb.hpp>

namespace raio::core::tests {
namespace {

gemmi::Position position(const GemmiPlace& at) { return {at[0], at[1], at[2]}; }

}  // namespace

std::vector<GemmiAtom> atoms_by_gemmi(const std::string& pdb) {
  const gemmi::Structure structure = gemmi::read_pdb_string(pdb, "");
  std::vector<GemmiAtom> out;
  for (const gemmi::Chain& chain : structure.models.at(0).chains)
    for (const gemmi::Residue& residue : chain.residues)
      for (const gemmi::Atom& atom : residue.atoms)
        out.push_back({atom.name,
                       residue.name,
                       chain.name,
                       residue.seqid.num.value,
                       atom.serial,
                       {atom.pos.x, atom.pos.y, atom.pos.z}});
  return out;
}

double distance_by_gemmi(const GemmiPlace& a, const GemmiPlace& b) {
  return position(a).dist(position(b));
}

double angle_by_gemmi(const GemmiPlace& a, const GemmiPlace& b, const GemmiPlace& c) {
  return gemmi::deg(gemmi::calculate_angle(position(a), position(b), position(c)));
}

double dihedral_by_gemmi(const GemmiPlace& a, const GemmiPlace& b, const GemmiPlace& c,
                         const GemmiPlace& d) {
  return gemmi::deg(gemmi::calculate_dihedral(position(a), position(b), position(c), position(d)));
}

}  // namespace raio::core::tests
