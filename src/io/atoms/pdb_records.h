// What a PDB text says beside its atoms.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/lines.h"
#include "io/atoms/names.h"

namespace raio {

/// The number that fills a field but for blanks around it.
std::optional<double> number_in(std::string_view field);

/// Where a line of a PDB text is.
struct PdbLine {
  std::string_view text;
  size_t number = 0;  // from 1
};

/// CRYST1 with the rows of SCALE behind it.
PdbCrystal crystal_of(std::string_view cryst1, const std::array<std::string_view, 3>& scale,
                      Notices& notices);

/// REMARK 350.
std::vector<Assembly> assemblies_of(const std::vector<PdbLine>& remarks, Names& chains);

/// The serial number of a field: decimal, hybrid-36 (from A0000 on) or, as VMD has it, hexadecimal.
std::optional<uint64_t> serial_in(std::string_view field);

/// Indices of atoms by their serial numbers.
using Serials = std::unordered_map<uint64_t, uint32_t>;
inline constexpr uint32_t kTwice = 0xffffffff;    // several atoms have it
inline constexpr uint32_t kLeftOut = 0xfffffffe;  // its atom was left out

/// CONECT: the number of an atom and of up to four that it is bonded to, in columns of five, or
/// wider where numbers have six digits.
void add_bonds(const std::vector<PdbLine>& conect, const Serials& serials, Atoms& out);

}  // namespace raio
