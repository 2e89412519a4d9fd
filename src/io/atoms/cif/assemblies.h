// Assemblies of mmCIF.
#pragma once

#include <gemmi/cifdoc.hpp>
#include <gemmi/math.hpp>
#include <map>
#include <string>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/names.h"

namespace raio {

/// _pdbx_struct_assembly_gen of mmCIF: an operation is the product of one of each list, as in
/// "(1-60)(61-88)".
class Assemblies {
 public:
  /// Takes the lists out of the block, since gemmi leaves out products, and lists all numbers of
  /// whatever range.
  explicit Assemblies(gemmi::cif::Block& block);

  /// Copies of the parts by their names. Throws where there are more than a million.
  std::vector<Assembly> take(Names& parts) const;

 private:
  struct Generator {
    std::string assembly, expression, parts;
  };

  std::vector<gemmi::Transform> operations_of(const std::string& expression) const;
  std::vector<gemmi::Transform> named(const std::string& word) const;

  std::vector<Generator> generators_;
  std::map<std::string, gemmi::Transform> operations_;
};

}  // namespace raio
