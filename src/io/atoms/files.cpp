// The formats: PDB and mmCIF by gemmi, XYZ by ourselves.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/nff/text_cursor.h"

namespace raio {
namespace {

// Of what a file holds, so that a message is one line of text.
std::string printable(std::string_view text) {
  std::string out(text.substr(0, 80));
  std::ranges::replace_if(out, [](unsigned char c) { return c < 32 || c > 126; }, '?');
  return out;
}

std::unexpected<Diagnostics> failed(std::string_view file, std::string message, int line = 0,
                                    int column = 0, std::string_view excerpt = {}) {
  return std::unexpected(Diagnostics{
      {Severity::error, std::string(file), line, column, std::move(message), printable(excerpt)}});
}

std::expected<ReadScene, Diagnostics> read_by_gemmi(const TextBuffer& text, std::string_view file,
                                                    bool cif, const ReadOptions& options) {
  Atoms atoms;
  const std::string_view bytes = text.view();
  if (std::string wrong = read_structure(bytes.data(), bytes.size(), cif, options.frame, atoms);
      !wrong.empty()) {
    // Of several lines the first says what it is; the name of the file is ours to say.
    wrong = wrong.substr(0, wrong.find('\n'));
    while (wrong.starts_with(':')) wrong.erase(0, 1);
    return failed(file, printable(wrong));
  }
  if (atoms.frames == 0)
    return failed(file, cif ? "there are no atoms with Cartesian coordinates (_atom_site.Cartn_x), "
                              "which mmCIF has"
                            : "there are no atoms in this PDB file");
  return scene_of_atoms(atoms, file, options);
}

// Where words of a line are.
struct XyzColumns {
  size_t species = 0, place = 1;
};

// A line of text, and where it is.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number;
    return line;
  }
  size_t bytes_left() const { return rest_.size(); }
  int number = 0;

 private:
  std::string_view rest_;
};

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t") == std::string_view::npos;
}

// The n-th word from the beginning of the line; at its end where there is none.
const char* word_number(const char* line, size_t n) {
  const char* p = skip_blanks_in_line(line);
  for (; n > 0 && !is_char(*p, kWordEnd); --n) {
    while (!is_char(*p, kWordEnd)) ++p;
    p = skip_blanks_in_line(p);
  }
  return p;
}

// "Properties=species:S:1:pos:R:3:..."
std::optional<XyzColumns> columns_of(std::string_view comment) {
  constexpr std::string_view kKey = "Properties=";
  const size_t at = comment.find(kKey);
  if (at == std::string_view::npos) return XyzColumns{};
  std::string_view list = comment.substr(at + kKey.size());
  if (list.starts_with('"')) list.remove_prefix(1);
  list = list.substr(0, list.find_first_of(" \t\""));
  size_t column = 0;
  std::optional<size_t> species, place;
  while (!list.empty()) {
    std::string_view field[3];
    for (std::string_view& f : field) {
      const size_t end = std::min(list.find(':'), list.size());
      f = list.substr(0, end);
      list.remove_prefix(std::min(end + 1, list.size()));
    }
    if (field[2].empty() || field[2].find_first_not_of("0123456789") != std::string_view::npos ||
        field[2].size() > 4)
      return std::nullopt;
    const size_t count = std::stoul(std::string(field[2]));
    if (field[0] == "species" && count == 1) species = column;
    if (field[0] == "pos" && count == 3) place = column;
    column += count;
  }
  if (!place || !species) return std::nullopt;
  return XyzColumns{*species, *place};
}

class XyzReader {
 public:
  XyzReader(const TextBuffer& text, std::string_view file) : lines_(text.view()), file_(file) {}

  std::expected<Atoms, Diagnostics> read(int frame) {
    // Frames are told apart by their counts, so all before the wanted one are walked over; from the
    // end, all have to be counted first.
    const auto frames = count_frames();
    if (!frames) return std::unexpected(frames.error());
    Atoms out;
    out.frames = *frames;
    const long wanted = frame < 0 ? long(*frames) + frame : frame;
    if (wanted < 0 || wanted >= long(*frames)) return out;
    lines_ = start_;
    for (long i = 0; i < wanted; ++i) (void)frame_of(nullptr);
    if (auto done = frame_of(&out); !done) return std::unexpected(done.error());
    return out;
  }

 private:
  std::expected<size_t, Diagnostics> count_frames() {
    size_t frames = 0;
    while (true) {
      Lines ahead = lines_;
      auto line = ahead.next();
      while (line && is_blank(*line)) lines_ = ahead, line = ahead.next();
      if (!line) break;
      if (auto done = frame_of(nullptr); !done) return std::unexpected(done.error());
      ++frames;
    }
    return frames;
  }

  // The next frame, into `out` if there is one.
  std::expected<void, Diagnostics> frame_of(Atoms* out) {
    auto line = lines_.next();
    while (line && is_blank(*line)) line = lines_.next();
    if (!line) return failed(file_, "the file has no frames");
    double count = -1;
    const char* const first = skip_blanks_in_line(line->data());
    const char* const end = parse_number(first, count);
    // An atom takes eight bytes at least.
    if (!end || !(count >= 1 && count <= double(lines_.bytes_left()) / 4) ||
        count != double(size_t(count)))
      return failed(file_,
                    fmt::format("expected the number of atoms, found {}", quoted(word_at(first))),
                    lines_.number, int(first - line->data()) + 1, *line);
    const auto comment = lines_.next();
    const auto columns = columns_of(comment.value_or(""));
    if (!columns)
      return failed(file_, "expected Properties= with species:S:1 and pos:R:3", lines_.number, 1,
                    comment.value_or(""));
    for (size_t i = 0; i < size_t(count); ++i) {
      const auto atom = lines_.next();
      if (!atom)
        return failed(file_, fmt::format("expected {} atoms, found {}", size_t(count), i),
                      lines_.number);
      if (!out) continue;
      if (auto done = add_atom(*atom, *columns, *out); !done) return done;
    }
    return {};
  }

  std::expected<void, Diagnostics> add_atom(std::string_view line, const XyzColumns& columns,
                                            Atoms& out) {
    const auto wrong = [&](const char* p, std::string_view expected) {
      return failed(file_,
                    fmt::format("expected {}, found {}", expected,
                                is_char(*p, kLineEnd) || *p == '\0' ? "the end of the line"
                                                                    : quoted(word_at(p))),
                    lines_.number, int(p - line.data()) + 1, line);
    };
    Atom atom;
    const char* p = word_number(line.data(), columns.species);
    const std::string_view species = word_at(p);
    double number = 0;
    atom.element = uint8_t(element_number(species));
    // Some programs number elements.
    if (const char* const all = parse_number(p, number); all && number >= 1 && number < kElements)
      atom.element = uint8_t(number);
    if (species.empty()) return wrong(p, "the symbol of an element");
    p = word_number(line.data(), columns.place);
    for (float& x : atom.place) {
      double value = 0;
      const char* const end = parse_number(p, value);
      if (!end) return wrong(p, "a coordinate");
      x = float(value);
      p = skip_blanks_in_line(end);
    }
    out.atoms.push_back(atom);
    return {};
  }

  Lines lines_;
  const Lines start_ = lines_;
  std::string_view file_;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_pdb(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  return read_by_gemmi(text, file, false, options);
}

std::expected<ReadScene, Diagnostics> read_mmcif(const TextBuffer& text, std::string_view file,
                                                 const ReadOptions& options) {
  return read_by_gemmi(text, file, true, options);
}

std::expected<ReadScene, Diagnostics> read_xyz(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  if (const std::string wrong = not_text(text.view()); !wrong.empty()) return failed(file, wrong);
  const auto atoms = XyzReader(text, file).read(options.frame);
  if (!atoms) return std::unexpected(atoms.error());
  return scene_of_atoms(*atoms, file, options);
}

}  // namespace raio
