// Diagnostics of readers. The library never prints; callers do.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/notices.h"

namespace raio::core {

/// One finding, with its location.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string file;
  int line = 0, column = 0;  // from 1; 0: about the file as a whole
  std::string message;       // what was found, what was expected, what to do; as in Error
  std::string excerpt;       // the line, shortened around the column; empty for the whole file
  size_t count = 0;          // cases of a Notice; 0: one case, or about the file as a whole
  std::vector<std::string> names{};  // of the first few; NOLINT(readability-redundant-member-init)

  bool is_error() const { return severity == Severity::error; }
  /// The message with count and names: "element from the name of the atom (214: CA, CB, ...)".
  std::string sentence() const;

  /// One line: "scene.nff:3:7: error: expected a number for the radius, found \"abc\"  | s 0 0 0
  /// abc". `before_settings` as in Error::text().
  std::string text(std::string_view before_settings = {}) const;
};

/// The same as one Error: bad_input, or no_resource for kNoMemory, or stopped for kStopped.
Error error_of(const Diagnostic& diagnostic);

using Diagnostics = std::vector<Diagnostic>;

/// "warning", "guessed", ...
std::string_view severity_name(Severity severity);

/// Appends the notices of a reader, about its file.
void append(Diagnostics& out, const Notices& notices, std::string_view file);

/// One error about a line of the file or, without `line`, about the file as a whole.
std::unexpected<Diagnostics> failed(std::string_view file, std::string message, size_t line = 0);

/// The messages about the machine and the caller, not the input.
inline constexpr std::string_view kNoMemory = "not enough memory for the scene";
inline constexpr std::string_view kStopped = "reading it was stopped";

}  // namespace raio::core
