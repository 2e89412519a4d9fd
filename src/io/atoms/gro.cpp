// GRO of GROMACS: lines of fixed columns that may touch.
#include <algorithm>
#include <array>

#include "io/atoms/colors.h"
#include "io/atoms/element_names.h"
#include "io/atoms/trajectory.h"

namespace raio::core {
namespace {

// Columns of a line: residue number and name, atom name and number, five each, then the position in
// nanometres (https://manual.gromacs.org/current/reference-manual/file-formats.html#gro).
constexpr size_t kGroName = 5, kGroPlace = 20;

// The element of an atom by its name, such as "CA" in "ALA" and in "CA".
uint8_t element_of_name(std::string_view residue, std::string_view atom) {
  const auto letters = [](std::string_view word) {
    while (!word.empty() && (word[0] == ' ' || (word[0] >= '0' && word[0] <= '9')))
      word.remove_prefix(1);
    size_t size = 0;
    while (size < word.size() && ((word[size] & ~32) >= 'A' && (word[size] & ~32) <= 'Z')) ++size;
    return word.substr(0, size);
  };
  const auto same = [](std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) { return (x & ~32) == (y & ~32); });
  };
  const std::string_view name = letters(atom), group = letters(residue);
  // Ions have the name of their residue, or CHARMM's own names.
  constexpr std::pair<std::string_view, std::string_view> kIons[] = {
      {"SOD", "Na"}, {"POT", "K"}, {"CLA", "Cl"}, {"CAL", "Ca"}, {"CES", "Cs"}, {"LIT", "Li"}};
  if (same(name, group))
    for (const auto& [ion, element] : kIons)
      if (same(name, ion)) return uint8_t(element_number(element));
  // Unambiguous names.
  constexpr std::string_view kPlain[] = {"CL", "BR", "MG", "ZN", "FE", "MN", "CU", "SI", "LI"};
  const bool is_ion = same(name, group.substr(0, 2));
  const bool is_plain = std::ranges::any_of(kPlain, [&](auto word) { return same(word, name); });
  if (name.size() == 2 && (is_ion || is_plain))
    if (const int number = element_number(name)) return uint8_t(number);
  return uint8_t(element_number(name.substr(0, 1)));
}

FrameRowsOr next_gro(Trajectory& t) {
  FrameRows out;
  (void)t.lines.next();  // the title
  const std::string_view line = t.lines.next().value_or("");
  const auto count = t.count(line);
  if (!count) return std::unexpected(count.error());
  if (auto done = t.expect_rows(*count, 1); !done) return std::unexpected(done.error());
  out.count = *count;
  return out;
}

// The numbers of a line. In a huge box they touch; then the distance between decimal points is the
// width of each.
std::vector<std::string_view> numbers_of_box(std::string_view line) {
  line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
  auto words = words_of(line);
  const size_t points = size_t(std::ranges::count(line, '.'));
  if (points <= words.size()) return words;
  const size_t point = line.find('.'), width = line.find('.', point + 1) - point;
  std::vector<std::string_view> out;
  for (size_t i = points; i-- > 0;) {
    const size_t end = line.size() - std::min(line.size(), i * width);
    out.push_back(line.substr(end - std::min(end, width), std::min(end, width)));
  }
  return out;
}

// The line after the atoms, in nanometres: the lengths of a box, or the nine numbers of a triclinic
// one, the diagonal first.
std::optional<Cell> cell_of_gro(std::string_view line) {
  const auto words = numbers_of_box(line);
  std::array<double, 9> number{};
  if (words.size() != 3 && words.size() != 9) return std::nullopt;
  for (size_t i = 0; i < words.size(); ++i) {
    std::array<char, 64> word{};
    words[i].copy(word.data(), word.size() - 1);
    if (!parse_number(skip_blanks_in_line(word.data()), number[i])) return std::nullopt;
  }
  Cell cell;
  cell.sides = {{{number[0], number[3], number[4]},
                 {number[5], number[1], number[6]},
                 {number[7], number[8], number[2]}}};
  for (auto& side : cell.sides)
    for (double& x : side) x *= 10;
  return cell;
}

// How many columns wider the numbers of atoms and residues beyond 99,999 are, found by the first
// decimal point.
size_t digits_more(std::string_view line, size_t usual_point) {
  const size_t point = line.find('.', kGroPlace);
  constexpr size_t kMost = 4;
  return point != std::string_view::npos && point > usual_point && point - usual_point <= kMost
             ? point - usual_point
             : 0;
}

struct GroNames {
  std::string_view group;  // the residue's number and name
  std::string_view residue_number, residue, atom, number;
};

// Either number may be the wider one.
GroNames names_of(std::string_view line, size_t wider) {
  size_t more = 0;
  while (more < wider && kGroName + more < line.size() && line[0] != ' ' &&
         line[kGroName + more] >= '0' && line[kGroName + more] <= '9')
    ++more;
  const auto column = [&](size_t at, size_t size) {
    return line.substr(std::min(at, line.size()), size);
  };
  const size_t wide = kGroName + more;
  return {column(0, wide + kGroName), column(0, wide), column(wide, kGroName),
          column(wide + kGroName, kGroName), column(wide + 2 * kGroName, kGroName + wider - more)};
}

// A number that fills its column apart from blanks around it; columns may touch.
std::optional<LineFault> read_column(std::string_view column, double& value) {
  std::array<char, 64> word{};
  std::ranges::copy(column, word.begin());
  const char* const from = skip_blanks_in_line(word.data());
  const size_t at = size_t(from - word.data());
  const char* const stop = parse_number(from, value);
  if (!stop) return LineFault{column.data() + at, "a coordinate"};
  const char* const behind = skip_blanks_in_line(stop);
  if (behind < word.data() + column.size())
    return LineFault{column.data() + (behind - word.data()),
                     "a coordinate without a blank inside its column"};
  return std::nullopt;
}

std::expected<void, Diagnostics> read_gro_atoms(const Trajectory& t, const FrameRows& frame,
                                                Atoms& out) {
  out.atoms.resize(frame.count);
  out.has_residues = true;
  const char* p = t.index.begin_of(frame.first);
  const std::string_view first = take_line(p, t.index.text().data() + t.index.text().size());
  // The distance between decimal points is the width of a column.
  const size_t point = first.find('.', kGroPlace),
               second = point == std::string_view::npos ? point : first.find('.', point + 1);
  const size_t width = second == std::string_view::npos ? 0 : second - point;
  if (width < 2 || width > 40)
    return wrong_line(t.file, frame.first + 1, first,
                      {first.data() + std::min(first.size(), kGroPlace),
                       "three coordinates with decimal points"});
  auto done = for_lines(t.index, t.file, frame.first, frame.count,
                        [&](size_t i, std::string_view line) -> std::optional<LineFault> {
                          Atom& atom = out.atoms[i];
                          const size_t wider = digits_more(line, point);
                          std::array<double, 3> place{};
                          for (size_t k = 0; k < 3; ++k) {
                            const size_t at = std::min(kGroPlace + wider + k * width, line.size());
                            if (auto wrong = read_column(line.substr(at, width), place[k]))
                              return wrong;
                            place[k] *= 10;
                          }
                          atom.place = out.local(place);
                          const GroNames names = names_of(line, wider);
                          atom.element = element_of_name(names.residue, names.atom);
                          return std::nullopt;
                        });
  if (!done) return done;
  // Residue numbers wrap at 100,000, so residues are counted.
  const char* const end = t.index.text().data() + t.index.text().size();
  p = t.index.begin_of(frame.first);
  std::string_view group;
  out.residues.clear();
  for (size_t i = 0; i < out.atoms.size(); ++i) {
    Atom& atom = out.atoms[i];
    const std::string_view line = take_line(p, end);
    const GroNames now = names_of(line, digits_more(line, point));
    const std::string_view name = without_blanks(now.atom);
    if (out.marks) out.marks->add(name, whole_number(now.number));
    if (i == 0 || now.group != group)
      out.residues.push_back(residue_of(now.residue, now.residue_number));
    group = now.group;
    atom.residue = uint32_t(out.residues.size() - 1);
    out.notices.add(
        atom.element ? Severity::guessed : Severity::warning,
        atom.element ? "elements from the names of atoms" : "atom names that are not elements",
        name, frame.first + i + 1);
  }
  const std::string_view box = take_line(p, end);
  out.cell = cell_of_gro(box);
  if (!out.cell && !words_of(box).empty())
    out.notices.add(Severity::left_out, "a box with neither three nor nine numbers", {},
                    frame.first + out.atoms.size() + 1);
  return {};
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_gro(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  auto opened = Trajectory::open(text, file, options);
  if (!opened) return std::unexpected(opened.error());
  Trajectory& t = *opened;
  const auto read_frame = [&](const FrameRows& frame, Atoms& out) {
    return read_gro_atoms(t, frame, out);
  };
  return scene_about(
      [&](const auto& origin) { return t.read(options.frame, 1, next_gro, origin, read_frame); },
      file, options);
}

}  // namespace raio::core
