// Texts whose frames follow one another, an atom a line.
#pragma once

#include <charconv>
#include <memory>

#include "io/atoms/read.h"
#include "io/atoms/rows.h"

namespace raio {

/// A frame of a file: how many atoms, the first of them on which line, from 0.
struct FrameRows {
  size_t first = 0, count = 0;
  RowLayout layout;
  std::vector<std::string> columns;  // of numbers
  std::optional<Cell> cell;
};
using FrameRowsOr = std::expected<FrameRows, Diagnostics>;

/// A text of frames, whatever the format.
class Trajectory {
 public:
  /// The trajectory that a text is, or what else it is; what is found in it is kept in
  /// options.cache.
  static std::expected<Trajectory, Diagnostics> open(const TextBuffer& text, std::string_view file,
                                                     const ReadOptions& options);

 private:
  // What is found once, for all frames that are read: where lines begin, and the frames.
  struct Found {
    LineIndex lines;
    std::vector<FrameRows> frames;
    std::string value;  // as Trajectory has it
    std::string cut;    // of the last frame, which is not among the frames; or empty
    size_t cut_line = 0;
  };

  Trajectory(std::shared_ptr<Found> found, std::string_view name, const ReadOptions& options)
      : found_(std::move(found)),
        index(found_->lines),
        lines(index),
        file(name),
        value(options.color_by) {}

  std::shared_ptr<Found> found_;

 public:
  const LineIndex& index;
  LineReader lines;
  const std::string_view file;
  const std::string_view value;  // the column that colours are asked of

  bool is_first_frame() const { return found_->frames.empty(); }
  std::unexpected<Diagnostics> wrong(std::string_view line, const char* at, std::string expected) {
    return wrong_line(file, lines.number(), line, {at, std::move(expected)});
  }
  /// A number of atoms, at least so many.
  std::expected<size_t, Diagnostics> count(std::string_view line, size_t least = 1);
  /// An error unless the file has so many lines behind the next `header` ones.
  std::expected<void, Diagnostics> expect_rows(size_t count, size_t header);
  /// The frame that next() fails at is the last one, and the file ends in it.
  void ends_in_frame(size_t found, size_t count) { cut_ = {found, count}; }

  /// All frames are walked over once, by next(), which reads what stands before the atoms of one;
  /// then the wanted one is read, relative to the origin. A last frame that is cut, as the
  /// simulation still runs, is left out.
  template <class Next, class Read>
  std::expected<Atoms, Diagnostics> read(int frame, size_t lines_behind, const Next& next,
                                         const std::array<double, 3>& origin,
                                         const Read& read_atoms) {
    std::vector<FrameRows>& frames = found_->frames;
    if (frames.empty() || found_->value != value) {
      frames.clear(), found_->value = value, found_->cut.clear();
      while (!lines.at_end()) {
        const size_t line = lines.number() + 1;
        FrameRowsOr found = next(*this);
        if (!found && cut_ && !frames.empty()) {
          leave_out_last(line);
          break;
        }
        if (!found) {
          frames.clear();
          return std::unexpected(found.error());
        }
        found->first = lines.number();
        lines.skip(found->count + lines_behind);
        frames.push_back(std::move(*found));
      }
      if (lines_behind == 0) check_last_row();
    }
    if (frames.empty()) return failed(file, "the file has no frames");
    Atoms out;
    out.origin = origin, out.frames = frames.size();
    if (!found_->cut.empty()) out.notices.add(Severity::cut, found_->cut, {}, found_->cut_line, 0);
    const long wanted = frame < 0 ? long(frames.size()) + frame : frame;
    if (wanted < 0 || wanted >= long(frames.size())) return out;
    const FrameRows& chosen = frames[size_t(wanted)];
    out.columns = chosen.columns;
    out.cell = chosen.cell;
    if (auto done = read_atoms(chosen, out); !done) return std::unexpected(done.error());
    constexpr size_t kFew = 100'000;  // the search would slow the reading of larger frames
    if (out.atoms.size() <= kFew)
      note_coincident(out, [](uint32_t i) { return std::to_string(i + 1); });
    return out;
  }

 private:
  void leave_out_last(size_t line);
  // A file may also end within the last row.
  void check_last_row();
  size_t filled_lines() const;

  std::optional<std::array<size_t, 2>> cut_;  // how many atoms there are, and how many there
                                              // should be
};

}  // namespace raio
