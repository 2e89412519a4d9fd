// What went wrong: the one type in which every room says so. Where a list with places is wanted, as
// for scene files, there are Diagnostics (io/diagnostics.h), each of which can become an Error.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace raio {

/// Whose fault it is, and so what may be done about it.
enum class ErrorKind : uint8_t {
  bad_input,     // what was read is not what it should be, or not for this
  bad_option,    // a setting that cannot be, or does not go with the others
  cannot_read,   // a file
  cannot_write,  // a file
  no_resource,   // memory, time or a library that is not there
  stopped,       // someone said so
};

struct Error {
  struct Place {
    int line = 0, column = 0;  // from 1; 0: the subject as a whole

    friend bool operator==(const Place&, const Place&) = default;
  };

  ErrorKind kind = ErrorKind::bad_input;

  /// What it is about, where that is not said in `message`: a file as the caller named it or, of
  /// bad_option, a setting ("grid-factor").
  std::string subject;

  /// What was found, what was expected, what to do. Settings stand in backquotes, by the names that
  /// the table in render/options.h and the fields of JobRequest (render/job.h) give them:
  /// "cannot be combined with `grid-resolution`; leave one of them out".
  std::string message;
  Place place = {};

  /// All of it in one line without control characters. `before_settings` goes before the names of
  /// settings, as they are given: "--" on a command line.
  std::string text(std::string_view before_settings = {}) const;

  friend bool operator==(const Error&, const Error&) = default;
};

/// That about a setting (bad_option), which the message does not name again.
inline Error bad_option(std::string_view setting, std::string message) {
  return {ErrorKind::bad_option, std::string(setting), std::move(message)};
}

/// A message with what is before the settings in it instead of their backquotes.
std::string with_settings(std::string_view message, std::string_view before);

}  // namespace raio
