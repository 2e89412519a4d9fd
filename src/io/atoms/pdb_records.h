// Records of a PDB file other than atoms.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/gemmi.h"
#include "io/atoms/lines.h"
#include "io/atoms/names.h"

namespace raio::core {

/// The number in a field with optional blanks around it.
std::optional<double> number_in(std::string_view field);

/// A line of a PDB file.
struct PdbLine {
  std::string_view text;
  size_t number = 0;  // from 1
};

/// Parses CRYST1 and the SCALE rows.
cif::CellRecords cell_records(std::string_view cryst1, const std::array<std::string_view, 3>& scale,
                              Notices& notices);

/// Parses REMARK 350.
std::vector<Assembly> assemblies_of(const std::vector<PdbLine>& remarks, Names& chains);

/// The serial number in a field: decimal, hybrid-36 (from A0000 on) or, as VMD writes it,
/// hexadecimal.
std::optional<uint64_t> serial_in(std::string_view field);

/// Indices of atoms by their serial numbers.
using Serials = std::unordered_map<uint64_t, uint32_t>;
inline constexpr uint32_t kTwice = 0xffffffff;    // several atoms have this serial
inline constexpr uint32_t kLeftOut = 0xfffffffe;  // the atom with this serial was left out

/// Reads CONECT: an atom and up to four atoms bonded to it, in columns of five, or wider if serials
/// have six digits.
void add_bonds(const std::vector<PdbLine>& conect, const Serials& serials, Atoms& out);

}  // namespace raio::core
