// Formats whose frames follow one another, an atom a line: XYZ, LAMMPS dumps and GRO.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>

#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/atoms/rows.h"

namespace raio {
namespace {

// A frame of a file: how many atoms, the first of them on which line, from 0.
struct FrameRows {
  size_t first = 0, count = 0;
  RowLayout layout;
  std::vector<std::string> columns;  // of numbers
  std::optional<Cell> cell;
};
using FrameRowsOr = std::expected<FrameRows, Diagnostics>;

// What is found once, for all frames that are read: where lines begin, and the frames.
struct Found {
  LineIndex lines;
  std::vector<FrameRows> frames;
  std::string value;  // as Trajectory has it
};

// A text of frames, whatever the format.
class Trajectory {
 public:
  // `found`: of the same text.
  Trajectory(std::shared_ptr<Found> found, std::string_view name, const ReadOptions& options)
      : found_(std::move(found)),
        index(found_->lines),
        lines(index),
        file(name),
        value(options.color_by) {}

 private:
  std::shared_ptr<Found> found_;

 public:
  const LineIndex& index;
  LineReader lines;
  const std::string_view file;
  const std::string_view value;  // the column that colours are asked of

  std::unexpected<Diagnostics> wrong(std::string_view line, const char* at, std::string expected) {
    return wrong_line(file, lines.number(), line, {at, std::move(expected)});
  }
  // A number of atoms, at least so many, that fill the lines behind `header` ones.
  std::expected<size_t, Diagnostics> count(std::string_view line, size_t header, size_t least = 1) {
    const auto words = words_of(line);
    size_t number = 0;
    const char* const at = words.empty() ? line.data() : words[0].data();
    const char* const end = words.empty() ? at : at + words[0].size();
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc() || stop != end || number < least)
      return wrong(line, at, "the number of atoms");
    const size_t left = index.size() - std::min(index.size(), lines.number() + header);
    if (number > left)
      return failed(file, fmt::format("expected {} atoms, found {}", number, left), lines.number());
    return number;
  }

  // All frames are walked over once, by next(), which reads what stands before the atoms of one;
  // then the wanted one is read.
  template <class Next, class Read>
  std::expected<Atoms, Diagnostics> read(int frame, size_t lines_behind, const Next& next,
                                         const Read& read_atoms) {
    std::vector<FrameRows>& frames = found_->frames;
    if (frames.empty() || found_->value != value) {
      frames.clear(), found_->value = value;
      while (!lines.at_end()) {
        FrameRowsOr found = next(*this);
        if (!found) {
          frames.clear();
          return std::unexpected(found.error());
        }
        found->first = lines.number();
        lines.skip(found->count + lines_behind);
        frames.push_back(std::move(*found));
      }
    }
    if (frames.empty()) return failed(file, "the file has no frames");
    Atoms out;
    out.frames = frames.size();
    const long wanted = frame < 0 ? long(frames.size()) + frame : frame;
    if (wanted < 0 || wanted >= long(frames.size())) return out;
    const FrameRows& chosen = frames[size_t(wanted)];
    out.columns = chosen.columns;
    out.cell = chosen.cell;
    if (auto done = read_atoms(chosen, out); !done) return std::unexpected(done.error());
    return out;
  }
};

// The trajectory that a text is, or what else it is; what is found in it is kept in options.cache.
std::expected<Trajectory, Diagnostics> open(const TextBuffer& text, std::string_view file,
                                            const ReadOptions& options) {
  std::shared_ptr<Found> found;
  if (options.cache) found = std::static_pointer_cast<Found>(options.cache->found);
  if (!found) {
    if (std::string wrong = not_text(text.view()); !wrong.empty()) return failed(file, wrong);
    found = std::make_shared<Found>(Found{LineIndex(text.view()), {}, {}});
    if (options.cache) options.cache->found = found;
  }
  return Trajectory(std::move(found), file, options);
}

std::expected<ReadScene, Diagnostics> scene_of(const std::expected<Atoms, Diagnostics>& atoms,
                                               std::string_view file, const ReadOptions& options) {
  if (!atoms) return std::unexpected(atoms.error());
  return scene_of_atoms(*atoms, file, options);
}

// --- XYZ and extended XYZ
constexpr std::string_view kProperties = "Properties=";

// "Properties=species:S:1:pos:R:3:..." of rows of at most `most` words; false: it says nothing that
// atoms could be read by.
bool read_properties(std::string_view list, std::string_view value, size_t most, FrameRows& out) {
  if (list.starts_with('"')) list.remove_prefix(1);
  list = list.substr(0, list.find_first_of(" \t\""));
  auto& words = out.layout.words;
  while (!list.empty()) {
    std::array<std::string_view, 3> field;
    for (std::string_view& f : field) {
      const size_t end = std::min(list.find(':'), list.size());
      f = list.substr(0, end);
      list.remove_prefix(std::min(end + 1, list.size()));
    }
    const auto& [name, type, times] = field;
    size_t count = 0;
    const auto [stop, error] = std::from_chars(times.data(), times.data() + times.size(), count);
    if (error != std::errc() || stop != times.data() + times.size() || count == 0 ||
        count > most - words.size())
      return false;
    const size_t first = words.size();
    words.resize(first + count, Word::skipped);
    if (name == "species" && count == 1) words[first] = Word::species;
    if (name == "radius" && count == 1) words[first] = Word::radius;
    if (name == "pos" && count == 3)
      words[first] = Word::x, words[first + 1] = Word::y, words[first + 2] = Word::z;
    if (type != "R" && type != "I") continue;
    for (size_t k = 0; k < count; ++k) {
      out.columns.push_back(count == 1 ? std::string(name) : fmt::format("{}.{}", name, k + 1));
      if (out.columns.back() == value) out.layout.value = first + k;
    }
  }
  return out.layout.has(Word::x);
}

// The numbers of a word such as Lattice="4 0 0 0 4 0 0 0 4"; nothing: there are not so many.
template <size_t count>
std::optional<std::array<double, count>> numbers_in(std::string_view comment,
                                                    std::string_view word) {
  const size_t at = comment.find(word);
  if (at == std::string_view::npos) return std::nullopt;
  std::string list(comment.substr(at + word.size()));
  if (list.starts_with('"')) list = list.substr(1, list.find('"', 1) - 1);
  list.append(TextBuffer::kPadding, ' ');  // as numbers are read
  std::array<double, count> out{};
  const auto words = words_of(list);
  if (words.size() < count) return std::nullopt;
  for (size_t i = 0; i < count; ++i)
    if (!parse_number(words[i].data(), out[i])) return std::nullopt;
  return out;
}

std::optional<Cell> cell_of_xyz(std::string_view comment) {
  const auto sides = numbers_in<9>(comment, "Lattice=");
  if (!sides) return std::nullopt;
  Cell cell;
  cell.origin = numbers_in<3>(comment, "Origin=").value_or(cell.origin);
  for (size_t i = 0; i < 9; ++i) cell.sides[i / 3][i % 3] = (*sides)[i];
  return cell;
}

FrameRowsOr next_xyz(Trajectory& t) {
  FrameRows out;
  const auto count = t.count(*t.lines.next_filled(), 1);
  if (!count) return std::unexpected(count.error());
  out.count = *count;
  const std::string_view comment = t.lines.next().value_or("");
  out.cell = cell_of_xyz(comment);
  const size_t at = comment.find(kProperties);
  LineReader ahead = t.lines;
  const size_t most_words = (ahead.next().value_or("").size() + 1) / 2;
  if (at == std::string_view::npos) {
    out.layout.words = {Word::species, Word::x, Word::y, Word::z};
  } else if (!read_properties(comment.substr(at + kProperties.size()), t.value, most_words, out)) {
    return t.wrong(comment, comment.data() + at,
                   "Properties= with pos:R:3 and as many columns as the rows have");
  }
  return out;
}

// --- LAMMPS dumps
// The words behind "ITEM: ATOMS".
constexpr std::pair<std::string_view, Word> kDumpWords[] = {{"x", Word::x},
                                                            {"y", Word::y},
                                                            {"z", Word::z},
                                                            {"xu", Word::x},
                                                            {"yu", Word::y},
                                                            {"zu", Word::z},
                                                            {"xs", Word::x},
                                                            {"ys", Word::y},
                                                            {"zs", Word::z},
                                                            {"xsu", Word::x},
                                                            {"ysu", Word::y},
                                                            {"zsu", Word::z},
                                                            {"element", Word::species},
                                                            {"type", Word::type},
                                                            {"mol", Word::residue},
                                                            {"radius", Word::radius},
                                                            {"diameter", Word::diameter}};

class DumpReader {
 public:
  explicit DumpReader(Trajectory& t) : t_(t) {}

  FrameRowsOr next() {
    bounds_.clear();
    FrameRows out;
    bool has_count = false;
    while (true) {
      const auto line = t_.lines.next_filled();
      if (!line) return failed(t_.file, "the file ends before the atoms of a frame");
      constexpr std::string_view kItem = "ITEM: ";
      if (!line->starts_with(kItem)) return t_.wrong(*line, line->data(), "ITEM:");
      const std::string_view item = line->substr(kItem.size());
      if (item.starts_with("NUMBER OF ATOMS")) {
        const auto count = t_.count(t_.lines.next().value_or(""), 0, 0);
        if (!count) return std::unexpected(count.error());
        out.count = *count, has_count = true;
      } else if (item.starts_with("BOX BOUNDS")) {
        if (auto done = read_bounds(); !done) return std::unexpected(done.error());
      } else if (item.starts_with("ATOMS")) {
        if (!has_count)
          return failed(t_.file, "there is no ITEM: NUMBER OF ATOMS before the atoms",
                        t_.lines.number());
        out.cell = box();
        if (auto done = read_words(*line, item, out); !done) return std::unexpected(done.error());
        return out;
      } else {
        (void)t_.lines.next();  // of TIMESTEP, UNITS and TIME
      }
    }
  }

 private:
  std::expected<void, Diagnostics> read_bounds() {
    for (size_t row = 0; row < 3; ++row) {
      const std::string_view line = t_.lines.next().value_or("");
      for (const std::string_view word : words_of(line)) {
        double value = 0;
        if (!parse_number(word.data(), value)) return t_.wrong(line, word.data(), "a number");
        bounds_.push_back(value);
      }
      const size_t each = bounds_.size() / (row + 1);
      if (bounds_.size() != each * (row + 1) || each < 2 || each > 4)
        return t_.wrong(line, line.data() + line.size(), "as many numbers in each line, 2 to 4");
    }
    return {};
  }

  std::expected<void, Diagnostics> read_words(std::string_view line, std::string_view item,
                                              FrameRows& out) {
    bool scaled = false;
    auto words = words_of(item);
    words.erase(words.begin());
    for (const std::string_view word : words) {
      const auto at =
          std::ranges::find(kDumpWords, word, &std::pair<std::string_view, Word>::first);
      const Word is = at == std::end(kDumpWords) ? Word::skipped : at->second;
      // Of "x" and "xu" the first counts.
      const bool again = is != Word::skipped && out.layout.has(is);
      out.layout.words.push_back(again ? Word::skipped : is);
      if (is == Word::x && !again) scaled = word.starts_with("xs");
      if (is != Word::species) {
        if (word == t_.value) out.layout.value = out.layout.words.size() - 1;
        out.columns.emplace_back(word);
      }
    }
    for (const Word word : {Word::x, Word::y, Word::z})
      if (!out.layout.has(word))
        return t_.wrong(line, line.data() + line.size(),
                        "columns of places such as x y z or xs ys zs");
    if (!scaled) return {};
    if (!out.cell)
      return failed(t_.file, "scaled places need ITEM: BOX BOUNDS before them", t_.lines.number());
    // They are parts of the box.
    for (size_t i = 0; i < 3; ++i) {
      for (size_t side = 0; side < 3; ++side)
        out.layout.to_place[4 * i + side] = out.cell->sides[side][i];
      out.layout.to_place[4 * i + 3] = out.cell->origin[i];
    }
    return {};
  }

  // Bounds with a tilt are those of the tilted box (https://docs.lammps.org/Howto_triclinic.html);
  // with four numbers a line they are its sides and its origin.
  std::optional<Cell> box() const {
    const auto& b = bounds_;
    if (b.empty()) return std::nullopt;
    const size_t each = b.size() / 3;
    Cell cell;
    if (each == 4) {
      for (size_t row = 0; row < 3; ++row) {
        std::copy_n(&b[4 * row], 3, cell.sides[row].begin());
        cell.origin[row] = b[4 * row + 3];
      }
      return cell;
    }
    const double xy = each == 3 ? b[2] : 0, xz = each == 3 ? b[5] : 0, yz = each == 3 ? b[8] : 0;
    const double x0 = b[0] - std::min({0.0, xy, xz, xy + xz});
    const double x1 = b[1] - std::max({0.0, xy, xz, xy + xz});
    const double y0 = b[each] - std::min(0.0, yz), y1 = b[each + 1] - std::max(0.0, yz);
    const double z0 = b[2 * each], z1 = b[2 * each + 1];
    cell.origin = {x0, y0, z0};
    cell.sides = {{{x1 - x0, 0, 0}, {xy, y1 - y0, 0}, {xz, yz, z1 - z0}}};
    return cell;
  }

  Trajectory& t_;
  std::vector<double> bounds_;  // three rows
};

// --- GRO
// Columns of a line: residue's number and name, atom's name and number, five each, then the place
// in nanometres (https://manual.gromacs.org/current/reference-manual/file-formats.html#gro).
constexpr size_t kGroName = 5, kGroPlace = 20;

// The element of an atom that has only a name, such as "CA" in "ALA" and in "CA".
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
  // Ions are called as their group is, in the force fields of CHARMM by names of their own.
  constexpr std::pair<std::string_view, std::string_view> kIons[] = {
      {"SOD", "Na"}, {"POT", "K"}, {"CLA", "Cl"}, {"CAL", "Ca"}, {"CES", "Cs"}, {"LIT", "Li"}};
  if (same(name, group))
    for (const auto& [ion, element] : kIons)
      if (same(name, ion)) return uint8_t(element_number(element));
  // These names stand for nothing else.
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
  const auto count = t.count(line, 1);
  if (!count) return std::unexpected(count.error());
  out.count = *count;
  return out;
}

// The line behind the atoms: the lengths of a box, or all nine numbers of a leaning one, those on
// the diagonal first; in nanometres.
std::optional<Cell> cell_of_gro(std::string_view line) {
  const auto words = words_of(line);
  std::array<double, 9> number{};
  if (words.size() != 3 && words.size() != 9) return std::nullopt;
  for (size_t i = 0; i < words.size(); ++i)
    if (!parse_number(words[i].data(), number[i])) return std::nullopt;
  Cell cell;
  cell.sides = {{{number[0], number[3], number[4]},
                 {number[5], number[1], number[6]},
                 {number[7], number[8], number[2]}}};
  for (auto& side : cell.sides)
    for (double& x : side) x *= 10;
  return cell;
}

std::expected<void, Diagnostics> read_gro_atoms(const Trajectory& t, const FrameRows& frame,
                                                Atoms& out) {
  out.atoms.resize(frame.count);
  out.has_residues = true;
  const char* p = t.index.begin_of(frame.first);
  const std::string_view first = take_line(p, t.index.text().data() + t.index.text().size());
  // As wide as it is from one point to the next.
  const size_t point = first.find('.', kGroPlace),
               second = point == std::string_view::npos ? point : first.find('.', point + 1);
  const size_t width = second == std::string_view::npos ? 0 : second - point;
  if (width < 2 || width > 40)
    return wrong_line(t.file, frame.first + 1, first,
                      {first.data() + std::min(first.size(), kGroPlace),
                       "three coordinates with decimal points"});
  std::string_view group;
  auto done = for_lines(
      t.index, t.file, frame.first, frame.count,
      [&](size_t i, std::string_view line) -> std::optional<LineFault> {
        Atom& atom = out.atoms[i];
        for (size_t k = 0; k < 3; ++k) {
          // Columns may touch.
          std::array<char, 64> word{};
          const size_t at = kGroPlace + k * width;
          const std::string_view column = at < line.size() ? line.substr(at, width) : "";
          std::ranges::copy(column, word.begin());
          double value = 0;
          if (!parse_number(skip_blanks_in_line(word.data()), value))
            return LineFault{skip_blanks_in_line(line.data() + std::min(at, line.size())),
                             "a coordinate"};
          atom.place[k] = float(10 * value);
        }
        atom.element = element_of_name(line.substr(kGroName, 5), line.substr(2 * kGroName, 5));
        return std::nullopt;
      });
  if (!done) return done;
  // Numbers of residues begin again at 100,000, so they are counted.
  p = t.index.begin_of(frame.first);
  uint32_t residues = 0;
  for (Atom& atom : out.atoms) {
    const std::string_view line = take_line(p, t.index.text().data() + t.index.text().size());
    const std::string_view now = line.substr(0, 2 * kGroName);
    if (!group.empty() && now != group) ++residues;
    group = now;
    atom.residue = residues;
  }
  out.cell = cell_of_gro(take_line(p, t.index.text().data() + t.index.text().size()));
  return {};
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_xyz(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  auto opened = open(text, file, options);
  if (!opened) return std::unexpected(opened.error());
  Trajectory& t = *opened;
  return scene_of(t.read(options.frame, 0, next_xyz,
                         [&](const FrameRows& frame, Atoms& out) {
                           return read_rows(t.index, file, frame.first, frame.count, frame.layout,
                                            out);
                         }),
                  file, options);
}

std::expected<ReadScene, Diagnostics> read_lammps_dump(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options) {
  auto opened = open(text, file, options);
  if (!opened) return std::unexpected(opened.error());
  Trajectory& t = *opened;
  DumpReader dump(t);
  return scene_of(t.read(
                      options.frame, 0, [&](Trajectory&) { return dump.next(); },
                      [&](const FrameRows& frame, Atoms& out) {
                        return read_rows(t.index, file, frame.first, frame.count, frame.layout,
                                         out);
                      }),
                  file, options);
}

std::expected<ReadScene, Diagnostics> read_gro(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  auto opened = open(text, file, options);
  if (!opened) return std::unexpected(opened.error());
  Trajectory& t = *opened;
  return scene_of(
      t.read(options.frame, 1, next_gro,
             [&](const FrameRows& frame, Atoms& out) { return read_gro_atoms(t, frame, out); }),
      file, options);
}

}  // namespace raio
