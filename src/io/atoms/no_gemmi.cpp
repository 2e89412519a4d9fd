// Replaces gemmi.cpp in builds with RAIO_GEMMI=OFF.
#include <stdexcept>

#include "io/atoms/gemmi.h"

namespace raio::core::cif {
namespace {

[[noreturn]] void refuse() {
  throw std::runtime_error("this build has no gemmi; use one with RAIO_GEMMI=ON");
}

}  // namespace

Document parse(const char*, size_t, const std::function<void()>&) { refuse(); }
UnitCell unit_cell(const CellRecords&) { refuse(); }
Operation parse_operation(const std::string&) { refuse(); }
std::vector<Operation> operations_of_hall(const std::string&) { refuse(); }
std::vector<Operation> operations_of_group(const std::string&, const UnitCell&) { refuse(); }
std::vector<Operation> operations_of_group(int) { refuse(); }
// NOLINTBEGIN(performance-unnecessary-value-param): the other build moves from them
Crystal crystal_of(Block) { refuse(); }
Molecule molecule_of(Block) { refuse(); }
// NOLINTEND(performance-unnecessary-value-param)

}  // namespace raio::core::cif
