// XYZ and LAMMPS dumps.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "io/atoms/trajectory.h"

namespace raio::core {
namespace {

// --- XYZ and extended XYZ
constexpr std::string_view kProperties = "properties=";

// Parses "Properties=species:S:1:pos:R:3:..." of rows of at most `most` words; false if it has no
// usable position.
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
    const bool has_symbols =
        list.find("species:") != std::string_view::npos || out.layout.has(Word::species);
    if (name == "Z" && type == "I" && count == 1 && !has_symbols)  // numbers of elements
      words[first] = Word::species;
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

// The end of a key such as "lattice=", in any case, in a comment; npos if it is missing.
size_t behind(std::string_view comment, std::string_view word) {
  const auto found = std::ranges::search(comment, word, [](char c, char w) {
    return c == w || (c >= 'A' && c <= 'Z' && char(c | 32) == w);
  });
  return found.empty() ? std::string_view::npos : size_t(found.end() - comment.begin());
}

// The numbers of an entry such as Lattice="4 0 0 0 4 0 0 0 4" or Lattice=[[4,0,0],[0,4,0],[0,0,4]];
// nothing if their number differs.
template <size_t count>
std::optional<std::array<double, count>> numbers_in(std::string_view comment,
                                                    std::string_view word) {
  const size_t at = behind(comment, word);
  if (at == std::string_view::npos) return std::nullopt;
  std::string list(comment.substr(at));
  if (list.starts_with('"')) list = list.substr(1, list.find('"', 1) - 1);
  if (list.starts_with('['))
    std::ranges::replace_if(list, [](char c) { return c == '[' || c == ']' || c == ','; }, ' ');
  list.append(TextBuffer::kPadding, ' ');  // padding for the number parser
  std::array<double, count> out{};
  const auto words = words_of(list);
  if (words.size() < count) return std::nullopt;
  for (size_t i = 0; i < count; ++i)
    if (!parse_number(words[i].data(), out[i])) return std::nullopt;
  return out;
}

std::optional<Cell> cell_of_xyz(std::string_view comment) {
  const auto sides = numbers_in<9>(comment, "lattice=");
  if (!sides) return std::nullopt;
  Cell cell;
  cell.origin = numbers_in<3>(comment, "origin=").value_or(cell.origin);
  for (size_t i = 0; i < 9; ++i) cell.sides[i / 3][i % 3] = (*sides)[i];
  // pbc="T T F" or pbc=[true, true, false].
  if (const size_t at = behind(comment, "pbc="); at != std::string_view::npos) {
    size_t axis = 0;
    for (const char* p = comment.data() + at + 1; p < comment.data() + comment.size() && axis < 3;
         ++p) {
      const char before = p[-1];
      if (before != '"' && before != '[' && before != ' ' && before != ',') continue;
      const char first = char(*p | 32);
      if (first == 't' || first == 'f' || *p == '0' || *p == '1')
        cell.repeats[axis++] = first == 't' || *p == '1';
    }
  }
  return cell;
}

// Recognises other formats with the suffix of XYZ by their first lines; empty if it may be XYZ.
std::string_view other_than_xyz(LineReader lines) {
  constexpr std::string_view kPoints =
      "these lines are points, x y z each, not atoms; XYZ begins with the number of atoms and "
      "a comment and has an element before each x y z; write points as PLY";
  constexpr std::string_view kTinker =
      "this looks like a Tinker XYZ file, which has a number before each name and the bonds after "
      "the coordinates; convert it to plain XYZ: element x y z in each line";
  const auto has_place = [](std::span<const std::string_view> words) {
    return words.size() >= 3 && std::ranges::all_of(words.first(3), looks_like_number);
  };
  const auto is_whole = [](std::string_view word) {
    return std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
  };
  const auto first = words_of(lines.next_filled().value_or(""));
  if (has_place(first)) return kPoints;
  // A line with the box may precede the atoms.
  for (int i = 0; i < 2; ++i) {
    const auto words = words_of(lines.next().value_or(""));
    if (words.size() >= 6 && words[0] == "1" && !looks_like_number(words[1]) &&
        has_place(std::span(words).subspan(2)) && is_whole(words[5]))
      return kTinker;
  }
  return {};
}

FrameRowsOr next_xyz(Trajectory& t) {
  if (t.is_first_frame())
    if (const auto other = other_than_xyz(t.lines); !other.empty())
      return failed(t.file, std::string(other), 1);
  FrameRows out;
  const auto count = t.count(*t.lines.next_filled());
  if (!count) return std::unexpected(count.error());
  if (auto done = t.expect_rows(*count, 1); !done) return std::unexpected(done.error());
  out.count = *count;
  const std::string_view comment = t.lines.next().value_or("");
  out.cell = cell_of_xyz(comment);
  const size_t at = behind(comment, kProperties);
  LineReader ahead = t.lines;
  const size_t most_words = (ahead.next().value_or("").size() + 1) / 2;
  if (at == std::string_view::npos) {
    out.layout.words = {Word::species, Word::x, Word::y, Word::z};
  } else if (!read_properties(comment.substr(at), t.value, most_words, out)) {
    return t.wrong(comment, comment.data() + at - kProperties.size(),
                   "Properties= with pos:R:3 and as many columns as the rows have");
  }
  return out;
}

// --- LAMMPS dumps
// The words after "ITEM: ATOMS".
constexpr std::pair<std::string_view, Word> kDumpWords[] = {{"element", Word::species},
                                                            {"type", Word::type},
                                                            {"mol", Word::residue},
                                                            {"radius", Word::radius},
                                                            {"diameter", Word::diameter}};

// The suffix of x, y and z in the column names: none, "u" for unwrapped, "s" for scaled, or "su".
// The first kind that all three axes have is used.
std::optional<std::string_view> kind_of_places(std::span<const std::string_view> words) {
  const auto has = [&](char axis, std::string_view kind) {
    return std::ranges::any_of(words, [&](std::string_view word) {
      return word.starts_with(axis) && word.substr(1) == kind;
    });
  };
  for (const std::string_view word : words)
    if (const auto kind = word.substr(1);
        word.starts_with('x') && (kind.empty() || kind == "u" || kind == "s" || kind == "su") &&
        has('y', kind) && has('z', kind))
      return kind;
  return std::nullopt;
}

Word dump_word(std::string_view word, std::string_view kind_of_places) {
  if (word.substr(1) == kind_of_places)
    for (const auto& [axis, is] : {std::pair{'x', Word::x}, {'y', Word::y}, {'z', Word::z}})
      if (word[0] == axis) return is;
  const auto at = std::ranges::find(kDumpWords, word, &std::pair<std::string_view, Word>::first);
  return at == std::end(kDumpWords) ? Word::skipped : at->second;
}

class DumpReader {
 public:
  explicit DumpReader(Trajectory& t) : t_(t) {}

  FrameRowsOr next() {
    FrameRows out;
    auto done = read_header(out);
    if (!done && t_.lines.at_end()) t_.ends_in_frame(0, out.count);
    if (!done) return std::unexpected(std::move(done.error()));
    return out;
  }

 private:
  // Reads all lines before the atoms.
  std::expected<void, Diagnostics> read_header(FrameRows& out) {
    bounds_.clear();
    bool has_count = false;
    while (true) {
      const auto line = t_.lines.next_filled();
      if (!line) return failed(t_.file, "the file ends before the atoms of a frame");
      constexpr std::string_view kItem = "ITEM: ";
      if (!line->starts_with(kItem)) return t_.wrong(*line, line->data(), "ITEM:");
      const std::string_view item = line->substr(kItem.size());
      if (item.starts_with("NUMBER OF ATOMS")) {
        const auto count = t_.count(t_.lines.next().value_or(""), 0);
        if (!count) return std::unexpected(count.error());
        out.count = *count, has_count = true;
      } else if (item.starts_with("BOX BOUNDS")) {
        // "pp pp ff", after other words if the box is triclinic.
        const auto words = words_of(item);
        for (size_t i = 0; i < 3; ++i)
          repeats_[i] = words.size() < 5 || !is_wall(words[words.size() - 3 + i]);
        if (auto done = read_bounds(); !done) return done;
      } else if (item.starts_with("ATOMS")) {
        if (!has_count)
          return failed(t_.file, "there is no ITEM: NUMBER OF ATOMS before the atoms",
                        t_.lines.number());
        if (auto done = t_.expect_rows(out.count, 0); !done) return done;
        out.cell = box();
        return read_words(*line, item, out);
      } else {
        (void)t_.lines.next();  // the value of TIMESTEP, UNITS or TIME
      }
    }
  }

  // Whether the lower boundary is fixed or shrink-wrapped, with or without a minimum.
  static bool is_wall(std::string_view word) {
    return word.size() == 2 && (word[0] == 'f' || word[0] == 's' || word[0] == 'm');
  }

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
    auto words = words_of(item);
    words.erase(words.begin());
    const auto kind = kind_of_places(words);
    if (!kind)
      return t_.wrong(line, line.data() + line.size(),
                      "position columns such as x y z or xs ys zs");
    for (const std::string_view word : words) {
      const Word is = dump_word(word, *kind);
      out.layout.words.push_back(is != Word::skipped && out.layout.has(is) ? Word::skipped : is);
      if (word == "id") out.layout.number = out.layout.words.size() - 1;
      if (is != Word::species) {
        if (word == t_.value) out.layout.value = out.layout.words.size() - 1;
        out.columns.emplace_back(word);
      }
    }
    if (!kind->starts_with('s')) return {};
    if (!out.cell)
      return failed(t_.file, "scaled positions need ITEM: BOX BOUNDS before the atoms",
                    t_.lines.number());
    // Scaled positions are fractions of the box.
    for (size_t i = 0; i < 3; ++i) {
      for (size_t side = 0; side < 3; ++side)
        out.layout.to_place[4 * i + side] = out.cell->sides[side][i];
      out.layout.to_place[4 * i + 3] = out.cell->origin[i];
    }
    return {};
  }

  // With tilt factors the bounds enclose the triclinic box
  // (https://docs.lammps.org/Howto_triclinic.html); four numbers per line are its sides and its
  // origin.
  std::optional<Cell> box() const {
    const auto& b = bounds_;
    if (b.empty()) return std::nullopt;
    const size_t each = b.size() / 3;
    Cell cell;
    cell.repeats = repeats_;
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
  std::array<bool, 3> repeats_{true, true, true};
};

template <class Next>
std::expected<ReadScene, Diagnostics> scene_of_rows(Trajectory& t, const Next& next,
                                                    const ReadOptions& options) {
  const auto read_frame = [&](const FrameRows& frame, Atoms& out) {
    return read_rows(t.index, t.file, frame.first, frame.count, frame.layout, out);
  };
  return scene_about(
      [&](const auto& origin) { return t.read(options.frame, 0, next, origin, read_frame); },
      t.file, options);
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_xyz(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  auto opened = Trajectory::open(text, file, options);
  if (!opened) return std::unexpected(opened.error());
  Trajectory& t = *opened;
  return scene_of_rows(t, next_xyz, options);
}

std::expected<ReadScene, Diagnostics> read_lammps_dump(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options) {
  auto opened = Trajectory::open(text, file, options);
  if (!opened) return std::unexpected(opened.error());
  Trajectory& t = *opened;
  DumpReader dump(t);
  return scene_of_rows(t, [&](Trajectory&) { return dump.next(); }, options);
}

}  // namespace raio::core
