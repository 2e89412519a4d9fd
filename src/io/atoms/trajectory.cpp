#include "io/atoms/trajectory.h"

namespace raio::core {

std::expected<Trajectory, Diagnostics> Trajectory::open(const TextBuffer& text,
                                                        std::string_view file,
                                                        const ReadOptions& options) {
  std::shared_ptr<Found> found;
  if (options.cache) found = std::static_pointer_cast<Found>(options.cache->found);
  if (!found) {
    if (std::string wrong = not_text(text.view()); !wrong.empty()) return failed(file, wrong);
    found = std::make_shared<Found>(Found{LineIndex(text.view()), {}, {}, {}});
    if (options.cache) options.cache->found = found;
  }
  return Trajectory(std::move(found), file, options);
}

std::expected<size_t, Diagnostics> Trajectory::count(std::string_view line, size_t least) {
  const auto words = words_of(line);
  size_t number = 0;
  const char* const at = words.empty() ? line.data() : words[0].data();
  const char* const end = words.empty() ? at : at + words[0].size();
  const auto [stop, error] = std::from_chars(at, end, number);
  if (error != std::errc() || stop != end || number < least)
    return wrong(line, at, "the number of atoms");
  return number;
}

// Without blank lines at the end.
size_t Trajectory::filled_lines() const {
  const std::string_view text = index.text();
  const size_t last = text.find_last_not_of(" \t\r\n");
  if (last == std::string_view::npos) return 0;
  const std::string_view behind = text.substr(last + 1);
  const auto ends = size_t(std::ranges::count(behind, '\n'));
  return ends == 0 ? index.size() : index.size() - (ends - 1) - (text.back() != '\n');
}

std::expected<void, Diagnostics> Trajectory::expect_rows(size_t count, size_t header) {
  const size_t filled = filled_lines();
  if (count <= filled - std::min(filled, lines.number() + header)) return {};
  const size_t number = lines.number();
  LineReader ahead = lines;
  for (size_t i = 0; i < header; ++i) (void)ahead.next();
  size_t rows = 0;
  for (auto line = ahead.next_filled(); line && !line->starts_with("ITEM:");
       line = ahead.next_filled())
    ++rows;
  if (ahead.at_end()) ends_in_frame(rows, count);
  return failed(file, fmt::format("expected {} atoms, found {}", count, rows), number);
}

void Trajectory::leave_out_last(size_t line) {
  found_->cut = fmt::format("the last frame is left out: the file ends after {} of its {} atoms",
                            (*cut_)[0], (*cut_)[1]);
  found_->cut_line = line;
}

void Trajectory::check_last_row() {
  std::vector<FrameRows>& frames = found_->frames;
  if (frames.size() < 2 || frames.back().count < 2) return;
  const FrameRows& last = frames.back();
  const auto words_in = [&](size_t line) {
    const char* p = index.begin_of(line);
    return words_of(take_line(p, index.text().data() + index.text().size())).size();
  };
  if (last.first + last.count < filled_lines() ||
      words_in(last.first + last.count - 1) >= words_in(last.first))
    return;
  ends_in_frame(last.count - 1, last.count);
  leave_out_last(last.first);
  frames.pop_back();
}

}  // namespace raio::core
