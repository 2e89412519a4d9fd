#include "io/atoms/pdb_records.h"

#include <algorithm>
#include <charconv>

#include "io/atoms/element_names.h"
#include "io/atoms/rows.h"

namespace raio::core {
namespace {

std::string_view columns(std::string_view line, size_t from, size_t count) {
  return from < line.size() ? line.substr(from, count) : std::string_view();
}

template <size_t count>
std::optional<std::array<double, count>> numbers_in(std::string_view line,
                                                    const std::array<size_t, count + 1>& ends) {
  std::array<double, count> out{};
  for (size_t i = 0; i < count; ++i) {
    const auto number = number_in(columns(line, ends[i], ends[i + 1] - ends[i]));
    if (!number) return std::nullopt;
    out[i] = *number;
  }
  return out;
}

// Splits a run of digits without blanks into serial numbers: the first is as wide as necessary, the
// others have five or six columns.
bool split_run(std::string_view run, const Serials& serials, bool is_first,
               std::vector<uint64_t>& out) {
  if (run.empty()) return true;
  for (const size_t width : {5, 6, 4, 3, 2, 1}) {
    if (width > run.size() || (!is_first && width < 5)) continue;
    const auto serial = serial_in(run.substr(0, width));
    if (!serial || !serials.contains(*serial)) continue;
    out.push_back(*serial);
    if (split_run(run.substr(width), serials, false, out)) return true;
    out.pop_back();
  }
  return false;
}

std::vector<uint64_t> serials_of(std::string_view line, const Serials& serials) {
  constexpr size_t kRecord = 6, kWidth = 5, kMost = 5;
  std::vector<uint64_t> out;
  bool fits = true;
  for (size_t k = 0; k < kMost && fits; ++k) {
    const std::string_view field = without_blanks(columns(line, kRecord + k * kWidth, kWidth));
    if (field.empty()) continue;
    const auto serial = serial_in(field);
    fits = serial && serials.contains(*serial);
    if (fits) out.push_back(*serial);
  }
  const std::string_view all = columns(line, kRecord, line.size());
  if (fits && all.find_first_not_of(' ', kMost * kWidth) == std::string_view::npos) return out;
  std::vector<uint64_t> by_words;
  for (const std::string_view word : words_of(columns(line, kRecord, 6 * kMost))) {
    if (split_run(word, serials, true, by_words)) continue;
    // A missing atom still takes its place in the list.
    by_words.push_back(UINT64_MAX);
  }
  return fits && out.size() >= by_words.size() ? out : by_words;
}

}  // namespace

std::optional<double> number_in(std::string_view field) {
  field = without_blanks(field);
  std::array<char, 40> word{};
  if (field.empty() || field.size() + 8 >= word.size()) return std::nullopt;
  std::ranges::copy(field, word.begin());
  double value = 0;
  if (parse_number(word.data(), value) != word.data() + field.size()) return std::nullopt;
  return value;
}

cif::CellRecords cell_records(std::string_view cryst1, const std::array<std::string_view, 3>& scale,
                              Notices& notices) {
  cif::CellRecords out;
  auto cell = numbers_in<6>(cryst1, {6, 15, 24, 33, 40, 47, 54});
  if (!cell) {
    const auto words = words_of(cryst1.substr(6));
    cell.emplace();
    for (size_t i = 0; i < 6 && cell; ++i) {
      const auto number = i < words.size() ? number_in(words[i]) : std::nullopt;
      if (number)
        (*cell)[i] = *number;
      else
        cell.reset();
    }
  }
  if (!cell) {
    notices.add_whole(Severity::left_out, "the cell, since CRYST1 does not have six numbers");
    return out;
  }
  out.lengths_and_angles = *cell;
  out.group = without_blanks(columns(cryst1, 55, 11));
  for (size_t row = 0; row < 3; ++row) {
    const auto turned = numbers_in<3>(scale[row], {10, 20, 30, 40});
    const auto shift = numbers_in<1>(scale[row], {45, 55});
    if (!turned || !shift) return out;
    if (row == 0) out.scale.emplace();
    std::ranges::copy(*turned, out.scale->begin() + ptrdiff_t(4 * row));
    (*out.scale)[4 * row + 3] = (*shift)[0];
  }
  return out;
}

std::vector<Assembly> assemblies_of(const std::vector<PdbLine>& remarks, Names& chains) {
  std::vector<Assembly> out;
  std::array<float, 12> matrix{};
  for (const PdbLine& remark : remarks) {
    const std::string_view line = remark.text.substr(10);
    const auto has = [&](std::string_view words) {
      return line.find(words) != std::string_view::npos;
    };
    if (has("BIOMOLECULE:")) out.emplace_back();
    if (out.empty()) continue;
    auto& copies = out.back().copies;
    if (has("APPLY THE FOLLOWING TO CHAINS:")) copies.emplace_back();
    if (copies.empty()) continue;
    if (has("CHAINS:")) {
      std::string_view list = line.substr(line.find(':') + 1);
      while (!list.empty()) {
        const size_t end = std::min(list.find(','), list.size());
        if (const auto name = without_blanks(list.substr(0, end)); !name.empty())
          copies.back().parts.push_back(chains.number(name));
        list.remove_prefix(std::min(end + 1, list.size()));
      }
    }
    const size_t row = line.find("BIOMT");
    if (row == std::string_view::npos || row + 5 >= line.size()) continue;
    const auto number = size_t(line[row + 5] - '1');
    if (number > 2) continue;
    // As words, since columns shift beyond 999 matrices.
    const auto words = words_of(line.substr(row + 6));
    bool all = words.size() > 4;
    for (size_t k = 0; k < 4 && all; ++k) {
      const auto value = number_in(words[k + 1]);
      all = value.has_value();
      if (all) matrix[number * 4 + k] = float(*value);
    }
    if (all && number == 2) copies.back().matrices.push_back(matrix);
  }
  return out;
}

std::optional<uint64_t> serial_in(std::string_view field) {
  field = without_blanks(field);
  if (field.empty()) return std::nullopt;
  const auto value_in = [&](int base) -> std::optional<uint64_t> {
    uint64_t value = 0;
    const char* const end = field.data() + field.size();
    const auto [stop, error] = std::from_chars(field.data(), end, value, base);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
  };
  if (const auto decimal = value_in(10)) return decimal;
  // Hybrid-36 continues with letters after five digits (http://cci.lbl.gov/hybrid_36).
  constexpr uint64_t kFirst = 10ull * 36 * 36 * 36 * 36, kDecimals = 100'000;
  if (field.size() == 5 && (field[0] & ~32) >= 'A' && (field[0] & ~32) <= 'Z')
    if (const auto value = value_in(36)) {
      const uint64_t upper = *value - kFirst + kDecimals;
      return field[0] >= 'a' ? upper + 26ull * 36 * 36 * 36 * 36 : upper;
    }
  return value_in(16);
}

void add_bonds(const std::vector<PdbLine>& conect, const Serials& serials, Atoms& out) {
  Cases twice, missing;
  for (const PdbLine& line : conect) {
    const std::vector<uint64_t> list = serials_of(line.text, serials);
    const auto atom = [&](uint64_t serial) {
      const auto at = serials.find(serial);
      if (at == serials.end())
        missing.add({}, line.number);
      else if (at->second == kTwice)
        twice.add(std::to_string(serial), line.number);
      return at == serials.end() ? kLeftOut : at->second;
    };
    const uint32_t from = list.empty() ? kLeftOut : atom(list[0]);
    for (size_t k = 1; k < std::min<size_t>(list.size(), 5) && from < kLeftOut; ++k)
      if (const uint32_t to = atom(list[k]); to < kLeftOut && to != from)
        out.bonds.push_back({std::min(from, to), std::max(from, to)});
  }
  twice.tell(out.notices, Severity::left_out, "CONECT bonds with serials that several atoms have");
  missing.tell(out.notices, Severity::left_out, "CONECT bonds to atoms that do not exist");
}

}  // namespace raio::core
