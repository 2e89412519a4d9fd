// Biological assemblies of mmCIF.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/gemmi.h"
#include "io/atoms/names.h"

namespace raio::core::cif {

/// _pdbx_struct_assembly_gen of mmCIF: an operation is the product of one from each list, as in
/// "(1-60)(61-88)".
class Assemblies {
 public:
  /// Rows of a matrix, each with its shift.
  using Transform = std::array<std::array<double, 4>, 3>;
  /// Removes the lists from the block, since gemmi ignores products and expands any range of
  /// numbers.
  explicit Assemblies(Block& block);

  /// The parts by name, with their transformations. Throws if there are more than a million.
  std::vector<Assembly> take(Names& parts) const;

 private:
  struct Generator {
    std::string assembly, expression, parts;
  };

  std::vector<Transform> operations_of(const std::string& expression) const;
  std::vector<Transform> named(const std::string& word) const;

  std::vector<Generator> generators_;
  std::map<std::string, Transform> operations_;
};

}  // namespace raio::core::cif
