// Collects the findings of a reader. The reader passes offsets; lines and columns are computed
// here, and only for findings that are kept.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/diagnostics.h"

namespace raio::core {

class TextReport {
 public:
  /// `text` must outlive the report. Keeps at most `most` errors and `most` warnings.
  TextReport(std::string_view text, std::string_view file, size_t most)
      : text_(text), file_(file), most_(most) {}

  void error(size_t offset, std::string message) { add(errors_, offset, std::move(message)); }
  void warning(size_t offset, std::string message) { add(warnings_, offset, std::move(message)); }

  /// A finding about the whole text.
  void error(std::string message) { add(errors_, kWholeFile, std::move(message)); }
  void warning(std::string message) { add(warnings_, kWholeFile, std::move(message)); }

  bool failed() const { return errors_.count > 0; }

  /// An empty report for a later part of the text that another thread reads, and a function that
  /// appends its findings afterwards, as if they had been reported here.
  TextReport of_part() const { return {text_, file_, most_}; }
  void append(TextReport part);

  /// The line of an offset, from 1. Ascending offsets cost one pass over the text in total.
  int line_of(size_t offset);

  /// Findings in the order of the text, those about the whole file last, then a line with the
  /// number of further ones.
  Diagnostics errors() { return placed(errors_, Severity::error); }
  Diagnostics warnings() { return placed(warnings_, Severity::warning); }

 private:
  static constexpr size_t kWholeFile = size_t(-1);

  struct Finding {
    size_t offset;
    std::string message;
  };
  struct Findings {
    std::vector<Finding> kept;  // sorted by offset
    size_t count = 0;
  };

  void add(Findings& findings, size_t offset, std::string message) const;
  Diagnostics placed(Findings& findings, Severity severity);

  std::string_view text_;
  std::string file_;
  size_t most_;
  Findings errors_, warnings_;
  size_t counted_ = 0;  // the offset that line_ belongs to
  int line_ = 1;
};

}  // namespace raio::core
