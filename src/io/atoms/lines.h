// Texts with one atom per line, read in parallel.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/parallel.h"
#include "io/diagnostics.h"
#include "io/nff/text_cursor.h"

namespace raio::core {

/// Index of line starts, built in parallel.
class LineIndex {
 public:
  explicit LineIndex(std::string_view text);
  std::string_view text() const { return text_; }
  size_t size() const { return before_.back() + (!text_.empty() && text_.back() != '\n'); }
  /// The start of a line, counted from 0; the end of the text after the last one.
  const char* begin_of(size_t line) const;

 private:
  std::string_view text_;
  std::vector<size_t> before_;  // number of lines that end before each chunk, and the total
};

/// The line at `p`, without its end; `p` moves to the next line.
inline std::string_view take_line(const char*& p, const char* end) {
  const char* const from = p;
  const void* const found = std::memchr(p, '\n', size_t(end - p));
  const char* to = found ? static_cast<const char*>(found) : end;
  p = found ? to + 1 : end;
  if (to > from && to[-1] == '\r') --to;
  return {from, size_t(to - from)};
}

/// Reads lines in sequence.
class LineReader {
 public:
  explicit LineReader(const LineIndex& index) : index_(&index), p_(index.text().data()) {}

  std::optional<std::string_view> next() {
    if (p_ == end()) return std::nullopt;
    ++number_;
    look_();
    return take_line(p_, end());
  }
  /// The next line that is not blank.
  std::optional<std::string_view> next_filled();
  /// Whether only blanks remain.
  bool at_end() const {
    return std::all_of(p_, end(), [](char c) { return is_char(c, kBlank); });
  }
  void skip(size_t lines) {
    number_ += lines;
    p_ = index_->begin_of(number_);
  }
  /// The number of lines read, which is the number of the last one, from 1.
  size_t number() const { return number_; }

 private:
  const char* end() const { return index_->text().data() + index_->text().size(); }

  const LineIndex* index_;
  StopCheck look_;
  const char* p_;
  size_t number_ = 0;
};

/// Text from a file on one printable line, for messages.
std::string printable(std::string_view text);

/// An error in a line, and its position.
struct LineFault {
  const char* at;
  std::string expected;
};

/// An error at a position in a line: what was expected and found there.
std::unexpected<Diagnostics> wrong_line(std::string_view file, size_t number, std::string_view line,
                                        const LineFault& fault);

/// Calls read(i, line) for lines first ... first + count - 1 (from 0, with i from 0), in parallel.
/// It returns an optional LineFault; the first fault in the file is returned.
template <class Read>
std::expected<void, Diagnostics> for_lines(const LineIndex& index, std::string_view file,
                                           size_t first, size_t count, const Read& read) {
  std::atomic<size_t> wrong = count;
  const char* const end = index.text().data() + index.text().size();
  for_chunks(count, [&](size_t, size_t from, size_t to) {
    const char* p = index.begin_of(first + from);
    for (size_t i = from; i < to; ++i) {
      const std::string_view line = take_line(p, end);
      if (!read(i, line)) continue;
      for (size_t known = wrong; i < known && !wrong.compare_exchange_weak(known, i);) {
      }
      return;
    }
  });
  if (wrong == count) return {};
  const char* p = index.begin_of(first + wrong);
  const std::string_view line = take_line(p, end);
  return wrong_line(file, first + wrong + 1, line, *read(wrong, line));
}

}  // namespace raio::core
