#include "io/atoms/element_names.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include "io/atoms/atoms.h"
#include "io/atoms/colors.h"

namespace raio::core {
namespace {

// Amino acids with their protonation states, caps and variants.
constexpr auto kAmino = std::to_array<std::string_view>(
    {"ACE", "ALA", "AMN", "ARG", "ASH", "ASN", "ASP", "ASX", "CSO", "CYM", "CYS", "CYX",
     "GLH", "GLN", "GLU", "GLX", "GLY", "HID", "HIE", "HIP", "HIS", "HSD", "HSE", "HSP",
     "ILE", "LEU", "LYN", "LYS", "MET", "MSE", "NH2", "NMA", "NME", "PHE", "PRO", "PTR",
     "PYL", "SEC", "SEP", "SER", "THR", "TPO", "TRP", "TYR", "UNK", "VAL"});
static_assert(std::ranges::is_sorted(kAmino));
constexpr auto kNucleotides = std::to_array<std::string_view>(
    {"A",   "A3",  "A5",  "ADE", "C",  "C3", "C5",  "CYT", "DA", "DA3", "DA5", "DC", "DC3",
     "DC5", "DG",  "DG3", "DG5", "DI", "DT", "DT3", "DT5", "DU", "G",   "G3",  "G5", "GUA",
     "I",   "PSU", "RA",  "RC",  "RG", "RU", "T",   "THY", "U",  "U3",  "U5",  "URA"});
static_assert(std::ranges::is_sorted(kNucleotides));
constexpr auto kWater =
    std::to_array<std::string_view>({"D2O", "DOD", "H2O", "HOH", "SOL", "SPC", "T3P", "T4P", "TIP",
                                     "TIP2", "TIP3", "TIP4", "TIP5", "TP3", "TP4", "WAT"});
static_assert(std::ranges::is_sorted(kWater));
// Lipids and sugars of common force fields.
constexpr auto kLipids = std::to_array<std::string_view>(
    {"BMA", "CHL1", "CHOL", "DLPC", "DMPC", "DOPC", "DOPE", "DPPC", "DSPC", "FUC", "GAL", "GLC",
     "MAN", "NAG", "POPC", "POPE", "POPG", "POPS", "SIA"});
static_assert(std::ranges::is_sorted(kLipids));
// Modified residues of the PDB, as gemmi 0.5.7 lists them. Their atoms may have any names.
constexpr auto kModifiedAmino = std::to_array<std::string_view>(
    {"0AF", "0TD", "3FG", "ABA", "AGM", "AIB", "ALC", "ALY", "B3E", "BFD", "BMT", "CAF", "CAS",
     "CGU", "CIR", "CME", "CR2", "CR8", "CRF", "CRO", "CRQ", "CSD", "CSH", "CSS", "CSX", "CXM",
     "DAB", "DAL", "DAR", "DAS", "DCY", "DGL", "DGN", "DHA", "DHI", "DIL", "DLE", "DLY", "DPN",
     "DPR", "DSG", "DSN", "DTH", "DTR", "DTY", "DVA", "FGA", "FME", "FVA", "GHP", "GL3", "GYS",
     "HIC", "HYP", "IAS", "KCX", "KPI", "LLP", "M3L", "MAA", "MDO", "MEA", "MED", "MEN", "MEQ",
     "MHO", "MHS", "MK8", "MLE", "MLU", "MLY", "MLZ", "MVA", "NEP", "NLE", "NRQ", "OAS", "OCS",
     "OMY", "OMZ", "ORN", "PCA", "PHD", "PHI", "PHL", "SAC", "SAR", "SCH", "SCY", "SMC", "SME",
     "SNC", "SNN", "TOX", "TPQ", "TRQ", "TRY", "TYS", "YCM"});
static_assert(std::ranges::is_sorted(kModifiedAmino));
constexpr auto kModifiedNucleotides = std::to_array<std::string_view>(
    {"+A",  "+C",  "+G",  "+I",  "+T",  "+U",  "1MA", "1MG", "2MA", "2MG", "3DR",
     "4OC", "4SU", "5BU", "5CM", "5MU", "6MZ", "7MG", "8OG", "BRU", "CBR", "CCC",
     "DOC", "H2U", "M2G", "MA6", "MIA", "OMC", "OMG", "OMU", "UR3"});
static_assert(std::ranges::is_sorted(kModifiedNucleotides));

template <size_t N>
bool is_in(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::ranges::binary_search(names, name);
}

ResidueKind usual_kind(std::string_view residue) {
  // Terminal amino acids have names such as NALA and CALA.
  const bool is_end = residue.size() == 4 && (residue[0] == 'N' || residue[0] == 'C');
  if (is_in(kAmino, residue) || (is_end && is_in(kAmino, residue.substr(1))))
    return ResidueKind::protein;
  if (is_in(kNucleotides, residue)) return ResidueKind::nucleic;
  return is_in(kWater, residue) ? ResidueKind::water : ResidueKind::other;
}

bool is_letter(char c) { return (c & ~32) >= 'A' && (c & ~32) <= 'Z'; }

std::string_view letters_of(std::string_view word) {
  while (!word.empty() && !is_letter(word[0])) word.remove_prefix(1);
  size_t size = 0;
  while (size < word.size() && is_letter(word[size])) ++size;
  return word.substr(0, size);
}

bool same(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return (x & ~32) == (y & ~32); });
}

uint8_t in_organic_residue(std::string_view name) {
  switch (name[0] & ~32) {
    case 'C':
    case 'D':
    case 'H':
    case 'N':
    case 'O':
    case 'P':
      return uint8_t(element_number(name.substr(0, 1)));
    case 'S':
      // Coarse-grained models have beads called SC1.
      if (same(name, "SE")) return uint8_t(element_number("Se"));
      return same(name, "SC") ? 0 : uint8_t(element_number("S"));
    default:
      return 0;  // ambiguous, or no atom at all
  }
}

}  // namespace

Residue residue_of(std::string_view name, std::string_view number) {
  Residue out;
  name = without_blanks(name), number = without_blanks(number);
  std::ranges::copy(name.substr(0, out.name.size()), out.name.begin());
  const char* const end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, out.number);
  if (error == std::errc() && stop != end) out.insertion = *stop;
  return out;
}

std::string_view without_blanks(std::string_view text) {
  const auto is_blank = [](char c) { return uint8_t(c) <= ' '; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

ResidueKind residue_kind(std::string_view residue) {
  if (const ResidueKind kind = usual_kind(residue); kind != ResidueKind::other) return kind;
  if (is_in(kModifiedAmino, residue)) return ResidueKind::protein;
  return is_in(kModifiedNucleotides, residue) ? ResidueKind::nucleic : ResidueKind::other;
}

bool is_organic_residue(std::string_view residue) {
  return usual_kind(residue) != ResidueKind::other || is_in(kLipids, residue);
}

uint8_t element_of_symbol(std::string_view symbol) {
  symbol = without_blanks(symbol);
  if (symbol.empty() || !is_letter(symbol[0])) return 0;
  const std::string_view letters = letters_of(symbol);
  return uint8_t(element_number(letters));
}

uint8_t element_of_names(std::string_view residue, std::string_view atom, NameField field) {
  const std::string_view name = letters_of(atom), group = letters_of(residue);
  if (name.empty()) return 0;
  if (is_organic_residue(residue)) return in_organic_residue(name);
  if (same(name, group) && !same(name, "W")) {  // W is coarse-grained water
    // CHARMM force fields have their own names of ions.
    constexpr std::pair<std::string_view, std::string_view> kIons[] = {
        {"SOD", "Na"}, {"POT", "K"},  {"CLA", "Cl"}, {"CAL", "Ca"}, {"CES", "Cs"},
        {"LIT", "Li"}, {"RUB", "Rb"}, {"BAR", "Ba"}, {"CAD", "Cd"}};
    for (const auto& [ion, element] : kIons)
      if (same(name, ion)) return uint8_t(element_number(element));
    if (const int number = element_number(name)) return uint8_t(number);
  }
  if (same(name, "X") || same(name, "UNK") || same(name, "DUM")) return 0;
  // Unambiguous names.
  constexpr std::string_view kPlain[] = {"CL", "BR", "MG", "ZN", "FE", "MN", "CU", "SI", "LI"};
  const std::string_view pair = name.substr(0, 2);
  const bool is_plain = std::ranges::any_of(kPlain, [&](auto word) { return same(word, name); });
  const bool is_written_so =
      pair.size() == 2 && pair[0] <= 'Z' && pair[1] >= 'a' && name.size() == 2;  // "Fe"
  if (is_plain || is_written_so || field == NameField::two_letters)
    if (const int number = element_number(pair)) return uint8_t(number);
  if (const int number = element_number(name.substr(0, 1))) return uint8_t(number);
  return uint8_t(element_number(pair));
}

void Cases::add(std::string_view name, size_t line) {
  if (count_++ == 0) line_ = line;
  if (name.empty() || names_.size() == Notices::kNames) return;
  if (std::ranges::find(names_, name) == names_.end()) names_.emplace_back(name);
}

void Cases::tell(Notices& notices, Severity severity, std::string_view message) const {
  if (count_ == 0) return;
  notices.add(severity, message, {}, line_, count_);
  for (const std::string& name : names_) notices.add(severity, message, name, line_, 0);
}

void ElementCases::tell(Notices& notices) const {
  guessed.tell(notices, Severity::guessed, "elements from names of atoms");
  unknown.tell(notices, Severity::warning, "atoms with names that do not determine an element");
}

}  // namespace raio::core
