// PDB and PQR. Both have the same records: PDB in fixed columns, PQR separated by blanks.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "io/atoms/cells.h"
#include "io/atoms/element_names.h"
#include "io/atoms/pdb_atoms.h"
#include "io/atoms/pdb_records.h"
#include "io/atoms/read.h"
#include "io/nff/text_cursor.h"

namespace raio::core {
namespace {

enum class Record : uint8_t {
  other,
  atom,
  model,
  end_of_model,
  end,
  cryst1,
  scale,
  remark_350,
  conect,
  ssbond,
  link
};

// Programs also write records in lower case, and without trailing blanks.
Record record_of(std::string_view line) {
  std::array<char, 6> upper{};
  for (size_t i = 0; i < upper.size(); ++i) {
    const char c = i < line.size() ? line[i] : ' ';
    upper[i] = c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c == '\t' ? ' ' : c;
  }
  const std::string_view six(upper.data(), 6), four = six.substr(0, 4);
  if (four == "ATOM" || six == "HETATM") return Record::atom;
  if (six == "ANISOU" || six == "SIGUIJ" || six == "SIGATM") return Record::other;
  if (six == "CONECT") return Record::conect;
  if (six == "REMARK")
    return line.substr(0, 10).ends_with(" 350") ? Record::remark_350 : Record::other;
  if (six == "CRYST1") return Record::cryst1;
  if (six.starts_with("SCALE") && six[5] >= '1' && six[5] <= '3') return Record::scale;
  if (six == "SSBOND") return Record::ssbond;
  if (four == "LINK") return Record::link;
  if (six == "ENDMDL") return Record::end_of_model;
  if (four == "END ") return Record::end;
  if (six == "MODEL " || (six.starts_with("MODEL") && line.size() > 5)) return Record::model;
  return Record::other;
}

// A record, or consecutive atom lines.
struct Mark {
  Record record = Record::other;
  size_t line = 0, end = 0;  // from 0
};

struct FrameLines {
  size_t first = 0, end = 0;
  bool has_atoms = false;
  std::optional<size_t> cryst1;
  std::array<size_t, 3> scale{};  // 0: missing
};

struct FoundPdb {
  LineIndex lines;
  std::vector<Mark> marks;
  std::vector<FrameLines> frames;
};

std::vector<Mark> marks_of(const LineIndex& index) {
  std::vector<std::vector<Mark>> parts(chunks_of(index.size()));
  const char* const text_end = index.text().data() + index.text().size();
  for_chunks(index.size(), [&](size_t chunk, size_t from, size_t to) {
    auto& out = parts[chunk];
    const char* p = index.begin_of(from);
    for (size_t i = from; i < to; ++i) {
      const Record record = record_of(take_line(p, text_end));
      if (record == Record::other) continue;
      if (record == Record::atom && !out.empty() && out.back().record == Record::atom)
        out.back().end = i + 1;
      else
        out.push_back({record, i, i + 1});
    }
  });
  std::vector<Mark> out;
  for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

// Frames are separated by MODEL and ENDMDL, whatever their numbers, and by END if atoms follow.
std::vector<FrameLines> frames_of(const std::vector<Mark>& marks) {
  std::vector<FrameLines> out;
  FrameLines now;
  bool is_named = false;
  std::optional<size_t> cryst1, first_cryst1;
  std::array<size_t, 3> scale{};
  const auto close = [&] {
    if (now.has_atoms || is_named) out.push_back(now);
    now = {}, is_named = false;
  };
  for (const Mark& mark : marks) switch (mark.record) {
      case Record::atom:
        if (!now.has_atoms) now.first = mark.line;
        now.has_atoms = true, now.end = mark.end;
        now.cryst1 = cryst1, now.scale = scale;
        break;
      case Record::model:
        close();
        is_named = true;
        break;
      case Record::end_of_model:
      case Record::end:
        close();
        break;
      case Record::cryst1:
        cryst1 = mark.line, scale = {};
        if (!first_cryst1) first_cryst1 = cryst1;
        break;
      case Record::scale:
        // The row's number is parsed later.
        for (size_t& row : scale)
          if (row == 0) {
            row = mark.line;
            break;
          }
        break;
      default:
        break;
    }
  close();
  // A record after the atoms.
  for (FrameLines& frame : out)
    if (!frame.cryst1) frame.cryst1 = first_cryst1;
  return out;
}

class PdbReader {
 public:
  PdbReader(const TextBuffer& text, std::string_view file, bool is_pqr, const ReadOptions& options)
      : file_(file), is_pqr_(is_pqr), options_(options) {
    if (options.cache) found_ = std::static_pointer_cast<FoundPdb>(options.cache->found);
    if (found_) return;
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    std::string_view all = text.view();
    if (all.starts_with(kByteOrderMark)) all.remove_prefix(kByteOrderMark.size());
    found_ = std::make_shared<FoundPdb>(FoundPdb{LineIndex(all), {}, {}});
    found_->marks = marks_of(found_->lines);
    found_->frames = frames_of(found_->marks);
    if (options.cache) options.cache->found = found_;
  }

  std::expected<Atoms, Diagnostics> read(const std::array<double, 3>& origin) {
    const std::vector<FrameLines>& frames = found_->frames;
    if (std::ranges::none_of(frames, &FrameLines::has_atoms))
      return failed(file_,
                    "the file has no atoms; expected lines that begin with ATOM "
                    "or HETATM");
    Atoms out;
    out.origin = origin, out.frames = frames.size();
    if (options_.labels) out.marks.emplace();
    out.columns =
        is_pqr_ ? std::vector<std::string>{"charge", "radius"} : std::vector<std::string>();
    const int64_t at =
        options_.frame < 0 ? int64_t(frames.size()) + options_.frame : options_.frame;
    if (at < 0 || at >= int64_t(frames.size()) || !frames[size_t(at)].has_atoms) return out;
    const FrameLines& frame = frames[size_t(at)];
    std::vector<PdbRow> rows(frame.end - frame.first);
    auto done = for_lines(found_->lines, file_, frame.first, rows.size(),
                          [&](size_t i, std::string_view line) -> std::optional<LineFault> {
                            if (record_of(line) != Record::atom) return std::nullopt;
                            return is_pqr_ ? read_pqr_row(line, out, rows[i])
                                           : read_pdb_row(line, out, rows[i]);
                          });
    if (!done) return std::unexpected(done.error());
    guess_elements(rows);
    if (is_pqr_ && file_.find(".pqr") == std::string_view::npos)
      out.notices.add_whole(Severity::guessed,
                            "the format PQR, since the lines do not fit the columns of PDB");
    Names chains(out.chains);
    if (!is_pqr_) out.assemblies = assemblies_of(lines_of(Record::remark_350), chains);
    const std::optional<cif::UnitCell> cell = cell_at(frame, out.notices);
    if (cell && cell->is_crystal) out.cell = cell_of(*cell);
    PdbAssembler assembler(out, chains, frame.first + 1);
    const auto conect = lines_of(Record::conect);
    std::vector<PdbLink> links = links_of();
    assembler.add(rows, is_pqr_, !conect.empty(), links);
    for (size_t i = 0; out.marks && i < out.atoms.size(); ++i) {
      const PdbRow& row = rows[assembler.row_of[i]];
      out.marks->add(row.part(row.name), serial_in(row.part(row.serial)));
    }
    if (is_pqr_ && options_.color_by == "charge") out.values = std::move(assembler.charges);
    if (is_pqr_ && options_.color_by == "radius") out.values = out.radii;
    add_bonds(conect, assembler.serials, out);
    add_links(links, cell, out);
    note_coincident(out, [&](uint32_t atom) {
      const PdbRow& row = rows[assembler.row_of[atom]];
      const auto part = [&](Span span) { return without_blanks(row.part(span)); };
      return fmt::format("{} {} {}{}", part(row.name), part(row.residue), part(row.chain),
                         part(row.sequence));
    });
    return out;
  }

 private:
  PdbLine line_at(size_t line) const {
    const char* p = found_->lines.begin_of(line);
    const std::string_view text = found_->lines.text();
    return {take_line(p, text.data() + text.size()), line + 1};
  }

  std::vector<PdbLine> lines_of(Record record) const {
    std::vector<PdbLine> out;
    for (const Mark& mark : found_->marks)
      if (mark.record == record) out.push_back(line_at(mark.line));
    return out;
  }

  std::optional<cif::UnitCell> cell_at(const FrameLines& frame, Notices& notices) const try {
    if (!frame.cryst1) return std::nullopt;
    std::array<std::string_view, 3> scale;
    for (const size_t line : frame.scale)
      if (line > 0) {
        const std::string_view text = line_at(line).text;
        scale[size_t(text[5] - '1')] = text;
      }
    cif::UnitCell cell = unit_cell(cell_records(line_at(*frame.cryst1).text, scale, notices));
    if (cell.is_crystal && cell.matrix_disagrees)
      notices.add_whole(Severity::warning,
                        "the SCALE records disagree with CRYST1; SCALE is used for the cell");
    return cell;
  } catch (const std::runtime_error& error) {
    notices.add_whole(Severity::left_out, fmt::format("the cell, since {}", error.what()));
    return std::nullopt;
  }

  std::vector<PdbLink> links_of() const {
    std::vector<PdbLink> out;
    for (const Mark& mark : found_->marks) {
      if (mark.record != Record::ssbond && mark.record != Record::link) continue;
      if (auto link = link_of(line_at(mark.line).text, mark.record == Record::ssbond))
        out.push_back(*link);
    }
    return out;
  }

  static void add_links(const std::vector<PdbLink>& links, const std::optional<cif::UnitCell>& cell,
                        Atoms& out) {
    for (const PdbLink& link : links) {
      const uint32_t a = link.ends[0].atom, b = link.ends[1].atom;
      if (a == kLeftOut || b == kLeftOut || a == b || link.leads_elsewhere) continue;
      // If the record does not say which symmetry mate is meant, the nearest one is.
      if (!link.says_copy && cell &&
          !cell->is_nearest(out.place_of(out.atoms[a]), out.place_of(out.atoms[b])))
        continue;
      out.bonds.push_back({std::min(a, b), std::max(a, b)});
    }
  }

  std::shared_ptr<FoundPdb> found_;
  const std::string_view file_;
  const bool is_pqr_;
  const ReadOptions& options_;
};

std::expected<ReadScene, Diagnostics> read_rows_of(const TextBuffer& text, std::string_view file,
                                                   bool is_pqr, const ReadOptions& options) {
  if (std::string wrong = not_text(text.view()); !wrong.empty()) return failed(file, wrong);
  PdbReader reader(text, file, is_pqr, options);
  return scene_about([&](const auto& origin) { return reader.read(origin); }, file, options);
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_pdb(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  return read_rows_of(text, file, false, options);
}

std::expected<ReadScene, Diagnostics> read_pqr(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  return read_rows_of(text, file, true, options);
}

}  // namespace raio::core
