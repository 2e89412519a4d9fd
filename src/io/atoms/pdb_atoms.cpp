#include "io/atoms/pdb_atoms.h"

#include <fmt/format.h>

#include <atomic>
#include <cmath>

#include "io/atoms/rows.h"

namespace raio::core {
namespace {

constexpr size_t kPlace = 30, kPlaceEnd = 54, kWidth = 8;

bool is_decimal(char c) { return c >= '0' && c <= '9'; }
bool is_letter_of_name(char c) { return (c & ~32) >= 'A' && (c & ~32) <= 'Z'; }

std::string_view field_of(std::string_view line, size_t from, size_t count) {
  return from < line.size() ? line.substr(from, count) : std::string_view();
}

// The field without blanks around it.
Span span_of(std::string_view line, size_t from, size_t count) {
  const std::string_view text = without_blanks(field_of(line, from, count));
  return text.empty() ? Span{uint8_t(from), 0}
                      : Span{uint8_t(text.data() - line.data()), uint8_t(text.size())};
}

// Placeholders that programs write for missing or too long numbers.
bool is_no_number(std::string_view field) {
  field = without_blanks(field);
  if (field.empty()) return false;
  if (field.find_first_not_of('*') == std::string_view::npos) return true;
  if (field[0] == '-' || field[0] == '+') field.remove_prefix(1);
  return field.size() == 3 && (field[0] | 32) == 'n' && (field[1] | 32) == 'a';
}

// Whether a number continues in the next field, which a separate number would fill.
bool goes_on(std::string_view field, std::string_view next) {
  if (next.empty() || (!is_decimal(field.back()) && field.back() != '.')) return false;
  return next[0] == '.' || (is_decimal(next[0]) && (next.find(' ') != std::string_view::npos));
}

struct Numbers {
  std::array<double, 3> place{};
  bool has_place = true;
};

std::optional<LineFault> read_place(std::string_view line, Numbers& out) {
  if (line.size() < kPlaceEnd)
    return LineFault{line.data() + line.size(), "three coordinates in columns 31 to 54"};
  for (size_t k = 0; k < 3; ++k) {
    const size_t from = kPlace + k * kWidth;
    const std::string_view field = line.substr(from, kWidth);
    const auto value = number_in(field);
    if (!value && is_no_number(field)) {
      out.has_place = false;
      continue;
    }
    if (!value || goes_on(field, field_of(line, from + kWidth, k < 2 ? kWidth : 6))) {
      const size_t blanks = std::min(field.find_first_not_of(' '), kWidth - 1);
      return LineFault{field.data() + blanks,
                       fmt::format("a coordinate within columns {} to {} (these columns are "
                                   "shifted; if blanks separate the fields, name the file .pqr)",
                                   from + 1, from + kWidth)};
    }
    out.place[k] = *value;
  }
  return std::nullopt;
}

NameField field_of_name(std::string_view field) {
  if (field.size() < 4 || !is_letter_of_name(field[0]))
    return field.size() < 4 ? NameField::free : NameField::one_letter;
  if (!is_letter_of_name(field[1])) return NameField::one_letter;
  return field[3] == ' ' ? NameField::two_letters : NameField::free;
}

// The fields of a PQR line; negative numbers may touch the number before.
struct PqrFields {
  std::vector<std::string_view> head;  // serial, name, residue, chain or not, number
  std::array<std::string_view, 5> numbers;
  std::string_view element;
};

std::optional<PqrFields> pqr_fields(std::string_view line) {
  PqrFields out;
  const size_t record = line.starts_with("HETATM") || line.starts_with("hetatm") ? 6 : 4;
  auto words = words_of(field_of(line, record, line.size()));
  if (!words.empty() && element_of_symbol(words.back()) > 0 && is_letter_of_name(words.back()[0]))
    out.element = words.back(), words.pop_back();
  size_t missing = out.numbers.size();
  while (missing > 0 && !words.empty()) {
    std::string_view& word = words.back();
    size_t from = word.size();
    do {
      from = word.substr(0, from).find_last_of('-');
    } while (from != std::string_view::npos && from > 0 && !is_decimal(word[from - 1]) &&
             word[from - 1] != '.');
    const size_t cut = from == std::string_view::npos ? 0 : from;
    out.numbers[--missing] = word.substr(cut);
    if (!number_in(out.numbers[missing])) return std::nullopt;
    if (cut == 0)
      words.pop_back();
    else
      word = word.substr(0, cut);
  }
  if (missing > 0 || words.size() < 4 || words.size() > 5) return std::nullopt;
  // The residue number may have an insertion code after it, and a chain before it.
  if (std::ranges::none_of(words.back(), is_decimal)) return std::nullopt;
  out.head = std::move(words);
  return out;
}

}  // namespace

std::optional<LineFault> read_pdb_row(std::string_view line, const Atoms& out, PdbRow& row) {
  Numbers numbers;
  if (auto fault = read_place(line, numbers)) return fault;
  row.text = line.data();
  row.has_place = numbers.has_place;
  row.place = out.local(numbers.place);
  for (const auto& [from, to, has] : {std::tuple(54uz, &row.occupancy, &row.has_occupancy),
                                      std::tuple(60uz, &row.b_factor, &row.has_b_factor)}) {
    const std::string_view field = field_of(line, from, 6);
    if (without_blanks(field).empty()) continue;
    const auto value = number_in(field);
    if (value) *to = float(*value), *has = true;
    row.has_numbers &= value.has_value();
  }
  // The serial has six digits if the column after the fifth is a digit.
  row.serial = span_of(line, 6, is_decimal(line[11]) ? 6 : 5);
  row.name = span_of(line, 12, 4);
  row.conformer = line[16];
  // Residue names have four letters in some force fields.
  const bool is_wide = line[20] != ' ' && is_organic_residue(line.substr(17, 4));
  row.residue = span_of(line, 17, is_wide ? 4 : 3);
  row.chain = span_of(line, is_wide ? 21 : 20, is_wide ? 1 : 2);
  row.sequence = {22, 5};
  row.element = element_of_symbol(field_of(line, 76, 2));
  row.needs_guess = row.element == 0;
  row.field = field_of_name(line.substr(12, 4));
  return std::nullopt;
}

std::optional<LineFault> read_pqr_row(std::string_view line, const Atoms& out, PdbRow& row) {
  const auto fields = pqr_fields(line);
  LineFault fault{line.data(),
                  "a PQR line of the words record, number, atom, residue, chain (or "
                  "none), number, x, y, z, charge and radius"};
  if (!fields) return fault;
  const auto& head = fields->head;
  const auto span = [&](std::string_view part) {
    return Span{uint8_t(part.data() - line.data()), uint8_t(part.size())};
  };
  if (head.back().data() + head.back().size() > line.data() + 255) return fault;
  row.text = line.data();
  const auto& numbers = fields->numbers;
  row.place = out.local({*number_in(numbers[0]), *number_in(numbers[1]), *number_in(numbers[2])});
  row.occupancy = float(*number_in(fields->numbers[3]));
  row.b_factor = float(*number_in(fields->numbers[4]));
  if (row.b_factor < 0) return LineFault{fields->numbers[4].data(), "a radius of 0 or more"};
  row.serial = span(head[0]), row.name = span(head[1]), row.residue = span(head[2]);
  row.sequence = span(head.back());
  row.chain = head.size() > 4 ? span(head[3]) : Span{};
  row.element = element_of_symbol(fields->element);
  row.needs_guess = row.element == 0;
  return std::nullopt;
}

bool is_pqr_line(std::string_view line) {
  if (!line.starts_with("ATOM") && !line.starts_with("HETATM")) return false;
  Numbers numbers;
  const auto fits = [&](size_t from) {
    const std::string_view field = field_of(line, from, 6);
    return without_blanks(field).empty() || number_in(field);
  };
  if (!read_place(line, numbers) && fits(54) && fits(60)) return false;
  // Occupancy and B factor have two decimals; charge and radius do not.
  const auto has_two = [](std::string_view number) {
    const size_t point = number.find('.');
    return point != std::string_view::npos && number.size() - point == 3;
  };
  const auto fields = pqr_fields(line);
  return fields && fields->element.empty() &&
         !(has_two(fields->numbers[3]) && has_two(fields->numbers[4]));
}

void guess_elements(std::vector<PdbRow>& rows) {
  const auto residue = [](const PdbRow& row) { return row.part(row.residue); };
  // The writing program does not align symbols.
  std::atomic<bool> left_aligned = false;
  for_each_index(rows.size(), [&](size_t i) {
    const PdbRow& row = rows[i];
    if (row.text && row.needs_guess && row.field == NameField::two_letters && !left_aligned &&
        is_organic_residue(residue(row)) && row.part(row.name) != "SE")
      left_aligned = true;
  });
  for_each_index(rows.size(), [&](size_t i) {
    PdbRow& row = rows[i];
    if (row.text && row.needs_guess)
      row.element = element_of_names(residue(row), row.part(row.name),
                                     left_aligned ? NameField::free : row.field);
  });
}

std::optional<PdbLink> link_of(std::string_view line, bool is_ssbond) {
  constexpr size_t kSymmetry = 72;
  if (line.size() < (is_ssbond ? 35u : 56u)) return std::nullopt;
  const auto part = [&](size_t from, size_t count) {
    return without_blanks(field_of(line, from, count));
  };
  PdbLink out;
  for (size_t k = 0; k < 2; ++k) {
    auto& end = out.ends[k];
    if (is_ssbond) {
      const size_t at = k == 0 ? 11 : 25, number = k == 0 ? 17 : 31;
      end = {part(at, 3), part(at + 3, 2), part(number, 5), {}, ' '};
    } else {
      const size_t at = 30 * k;
      end = {part(17 + at, 3), part(20 + at, 2), part(22 + at, 5), part(12 + at, 4), line[16 + at]};
    }
  }
  out.says_copy = line.size() >= kSymmetry;
  out.leads_elsewhere = out.says_copy && part(59, 6) != part(66, 6);
  return out;
}

// Keeps the first of alternate conformers and residues.
bool PdbAssembler::takes(const PdbRow& row, size_t line) {
  if (!takes_residue(row, line)) return false;
  if (row.conformer == ' ') return true;
  find_chosen();
  const auto at = chosen_.find(row.part(row.name));
  if (at == chosen_.end() || at->second.conformer == row.conformer) return true;
  conformers_.add(fmt::format("{} {}{}", row.part(row.residue), row.part(row.chain),
                              without_blanks(row.part(row.sequence))),
                  line);
  return false;
}

// Whether a residue is the first with its number, or is not at the position of that one.
bool PdbAssembler::takes_residue(const PdbRow& row, size_t line) {
  const std::string_view name = row.part(row.residue);
  if (name == position_->part(position_->residue)) return true;
  if (name == left_out_) return false;
  bool in_place =
      row.conformer != ' ' && position_->conformer != ' ' && row.conformer != position_->conformer;
  if (!in_place) {
    find_chosen();
    const auto at = chosen_.find(row.part(row.name));
    if (at == chosen_.end()) return true;
    constexpr float kNear = 0.8f;  // angstroms; less than any interatomic distance
    float squares = 0;
    for (size_t k = 0; k < 3; ++k) {
      const float apart = row.place[k] - out_.atoms[at->second.atom].place[k];
      squares += apart * apart;
    }
    in_place = squares < kNear * kNear;
  }
  if (!in_place) return true;
  left_out_ = name;
  residues_.add(
      fmt::format("{} {}{}", name, row.part(row.chain), without_blanks(row.part(row.sequence))),
      line);
  return false;
}

void PdbAssembler::begin_position(const PdbRow& row) {
  position_ = &row;
  left_out_ = {};
  taken_.clear(), chosen_.clear();
  is_searched_ = false;
}

void PdbAssembler::find_chosen() {
  is_searched_ = true;
  for (const auto& [name, chosen] : taken_) chosen_.emplace(name, chosen);
  taken_.clear();
}

// Finds the ends of links in the row's residue.
void PdbAssembler::find_ends(const PdbRow& row, std::vector<PdbLink>& links) {
  const auto key = [](std::string_view residue, std::string_view chain, std::string_view number) {
    return fmt::format("{}|{}|{}", residue, chain, without_blanks(number));
  };
  if (ends_.empty())
    for (PdbLink& link : links)
      for (PdbLink::End& end : link.ends)
        ends_[key(end.residue, end.chain, end.sequence)].push_back(&end);
  const auto at =
      ends_.find(key(row.part(row.residue), row.part(row.chain), row.part(row.sequence)));
  ends_here_ = at == ends_.end() ? nullptr : &at->second;
}

void PdbAssembler::add(const std::vector<PdbRow>& rows, bool is_pqr, bool with_serials,
                       std::vector<PdbLink>& links) {
  ElementCases elements;
  std::string_view chain_name;
  uint32_t chain = 0;
  const auto same = [](const PdbRow& a, const PdbRow& b) {
    return a.part(a.sequence) == b.part(b.sequence) && a.part(a.chain) == b.part(b.chain);
  };
  out_.atoms.reserve(rows.size()), row_of.reserve(rows.size());
  out_.has_residues = true;
  for (size_t i = 0; i < rows.size(); ++i) {
    const PdbRow& row = rows[i];
    if (!row.text) continue;
    const size_t line = first_line_ + i;
    if (!position_ || !same(*position_, row)) begin_position(row);
    if (!row.has_place) placeless_.add(row.part(row.name), line);
    const bool taken = row.has_place && takes(row, line);
    if (with_serials)
      if (const auto serial = serial_in(row.part(row.serial))) {
        const auto [at, is_new] =
            serials.emplace(*serial, taken ? uint32_t(out_.atoms.size()) : kLeftOut);
        if (!is_new) at->second = kTwice;
      }
    if (!taken) continue;
    const bool is_new = !residue_ || !same(*residue_, row) ||
                        residue_->part(residue_->residue) != row.part(row.residue);
    if (is_new) out_.residues.push_back(residue_of(row.part(row.residue), row.part(row.sequence)));
    residue_ = &row;
    if (is_new && !links.empty()) find_ends(row, links);
    if (out_.atoms.empty() || row.part(row.chain) != chain_name)
      chain_name = row.part(row.chain), chain = chains_.number(chain_name);
    const Chosen chosen{row.conformer, uint32_t(out_.atoms.size())};
    if (is_searched_)
      chosen_.emplace(row.part(row.name), chosen);
    else
      taken_.emplace_back(row.part(row.name), chosen);
    constexpr uint8_t kSulphur = 16;
    for (size_t k = 0; ends_here_ && k < ends_here_->size(); ++k)
      if (PdbLink::End& end = *(*ends_here_)[k];
          end.atom == kLeftOut &&
          (end.name.empty() ? row.element == kSulphur
                            : end.name == row.part(row.name) && end.conformer == row.conformer))
        end.atom = uint32_t(out_.atoms.size());
    if (row.needs_guess) elements.add(row.element, row.part(row.name), line);
    if (!row.has_numbers) numberless_.add(row.part(row.name), line);
    Atom atom{.place = row.place,
              .element = row.element,
              .chain = chain,
              .part = chain,
              .residue = uint32_t(out_.residues.size() - 1)};
    if (is_pqr) {
      charges.push_back(row.occupancy), out_.radii.push_back(row.b_factor);
      if (row.b_factor == 0) radiusless_.add(row.part(row.name), line);
    } else {
      atom.occupancy = row.occupancy, atom.b_factor = row.b_factor;
      out_.has_occupancies |= row.has_occupancy, out_.has_b_factors |= row.has_b_factor;
    }
    out_.atoms.push_back(atom);
    row_of.push_back(uint32_t(i));
  }
  Notices& n = out_.notices;
  elements.tell(n);
  conformers_.tell(n, Severity::left_out, "atoms of alternate conformers");
  residues_.tell(n, Severity::left_out, "residues with the number and position of another");
  placeless_.tell(n, Severity::left_out, "atoms with coordinates that are not numbers");
  numberless_.tell(n, Severity::left_out, "occupancies or B factors that are not numbers");
  radiusless_.tell(n, Severity::guessed, "van der Waals radii of atoms with a radius of 0");
}

}  // namespace raio::core
