// Texts with consecutive frames, one line per atom.
#pragma once

#include <charconv>
#include <memory>

#include "io/atoms/read.h"
#include "io/atoms/rows.h"

namespace raio::core {

/// A frame of a file: its number of atoms and the line of the first one, from 0.
struct FrameRows {
  size_t first = 0, count = 0;
  RowLayout layout;
  std::vector<std::string> columns;  // names of numeric columns
  std::optional<Cell> cell;
};
using FrameRowsOr = std::expected<FrameRows, Diagnostics>;

/// A text of frames, in any format.
class Trajectory {
 public:
  /// Opens a trajectory, or says what else the text is; findings are stored in options.cache.
  static std::expected<Trajectory, Diagnostics> open(const TextBuffer& text, std::string_view file,
                                                     const ReadOptions& options);

 private:
  // Found once and reused for all frames: line starts and frames.
  struct Found {
    LineIndex lines;
    std::vector<FrameRows> frames;
    std::string value;  // Trajectory::value
    std::string cut;    // why the last frame was left out; or empty
    size_t cut_line = 0;
  };

  Trajectory(std::shared_ptr<Found> found, std::string_view name, const ReadOptions& options)
      : found_(std::move(found)),
        index(found_->lines),
        lines(index),
        file(name),
        value(options.color_by),
        marks(options.labels) {}

  std::shared_ptr<Found> found_;

 public:
  const LineIndex& index;
  LineReader lines;
  const std::string_view file;
  const std::string_view value;  // the column that `color_by` names
  const bool marks;              // whether Atoms::marks are wanted

  bool is_first_frame() const { return found_->frames.empty(); }
  std::unexpected<Diagnostics> wrong(std::string_view line, const char* at, std::string expected) {
    return wrong_line(file, lines.number(), line, {at, std::move(expected)});
  }
  /// Parses a number of atoms, at least `least`.
  std::expected<size_t, Diagnostics> count(std::string_view line, size_t least = 1);
  /// An error unless the file has this many lines after the next `header` ones.
  std::expected<void, Diagnostics> expect_rows(size_t count, size_t header);
  /// Records that the file ends within the frame where next() fails.
  void ends_in_frame(size_t found, size_t count) { cut_ = {found, count}; }

  /// Scans all frames once with next(), which reads the lines before a frame's atoms; then reads
  /// the requested frame, relative to the origin. An incomplete last frame, written while the
  /// simulation runs, is left out.
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
    if (frames.empty()) return failed(file, "the file has no complete frame");
    Atoms out;
    out.origin = origin, out.frames = frames.size();
    if (marks) out.marks.emplace();
    if (!found_->cut.empty()) out.notices.add(Severity::cut, found_->cut, {}, found_->cut_line, 0);
    const int64_t wanted = frame < 0 ? int64_t(frames.size()) + frame : frame;
    if (wanted < 0 || wanted >= int64_t(frames.size())) return out;
    const FrameRows& chosen = frames[size_t(wanted)];
    out.columns = chosen.columns;
    out.cell = chosen.cell;
    if (auto done = read_atoms(chosen, out); !done) return std::unexpected(done.error());
    constexpr size_t kFew = 100'000;  // larger frames would be slowed by the search
    if (out.atoms.size() <= kFew)
      note_coincident(out, [](uint32_t i) { return std::to_string(i + 1); });
    return out;
  }

 private:
  void leave_out_last(size_t line);
  // A file may also end within the last row.
  void check_last_row();
  size_t filled_lines() const;

  std::optional<std::array<size_t, 2>> cut_;  // atoms found and expected
                                              // should be
};

}  // namespace raio::core
