// Collects what a reader finds in a text. The reader knows offsets; lines and columns are counted
// here, and only for what is kept.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/diagnostics.h"

namespace raio {

class TextReport {
 public:
  /// `text` must live as long as the report. Of errors and of warnings at most `most` are kept
  /// each.
  TextReport(std::string_view text, std::string_view file, size_t most)
      : text_(text), file_(file), most_(most) {}

  void error(size_t offset, std::string message) { add(errors_, offset, std::move(message)); }
  void warning(size_t offset, std::string message) { add(warnings_, offset, std::move(message)); }

  /// About the text as a whole.
  void error(std::string message) { add(errors_, kWholeFile, std::move(message)); }
  void warning(std::string message) { add(warnings_, kWholeFile, std::move(message)); }

  bool failed() const { return errors_.count > 0; }

  /// An empty report of the same text, for a later part of it that is read on another thread, and
  /// the taking of what it found in the end, as if it had been reported here.
  TextReport of_part() const { return {text_, file_, most_}; }
  void append(TextReport part);

  /// The line of an offset, from 1. Ascending offsets cost one pass over the text in all.
  int line_of(size_t offset);

  /// In the order of the text, what concerns the whole file last; a closing line says how many more
  /// there were.
  Diagnostics errors() { return placed(errors_, Severity::error); }
  Diagnostics warnings() { return placed(warnings_, Severity::warning); }

 private:
  static constexpr size_t kWholeFile = size_t(-1);

  struct Finding {
    size_t offset;
    std::string message;
  };
  struct Findings {
    std::vector<Finding> kept;  // by offset
    size_t count = 0;
  };

  void add(Findings& findings, size_t offset, std::string message) const;
  Diagnostics placed(Findings& findings, Severity severity);

  std::string_view text_;
  std::string file_;
  size_t most_;
  Findings errors_, warnings_;
  size_t counted_ = 0;  // line_ is the line of this offset
  int line_ = 1;
};

}  // namespace raio
