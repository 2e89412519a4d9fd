// The error type of all rooms. Readers of scene files return lists of Diagnostic, with locations,
// instead (io/diagnostics.h); each can become an Error.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace raio::core {

/// The cause of an error, and so who can fix it.
enum class ErrorKind : uint8_t {
  bad_input,     // the input is malformed or unsuitable
  bad_option,    // a setting is invalid or contradicts others
  cannot_read,   // a file
  cannot_write,  // a file
  no_resource,   // too little memory or time, or a missing library
  stopped,       // cancelled by the caller
};

struct Error {
  struct Place {
    int line = 0, column = 0;  // from 1; 0: the subject as a whole

    friend bool operator==(const Place&, const Place&) = default;
  };

  ErrorKind kind = ErrorKind::bad_input;

  /// The file as the caller named it or, for bad_option, a setting ("grid-factor"); empty if
  /// `message` names it.
  std::string subject;

  /// What was found, what was expected, what to do. Settings stand in backquotes, named as in the
  /// table of render/options.h or the fields of JobRequest (render/job.h): "cannot be combined with
  /// `grid-resolution`; leave one of them out".
  std::string message;
  Place place = {};

  /// The whole error as one line without control characters. `before_settings` precedes the names
  /// of settings: "--" on a command line.
  std::string text(std::string_view before_settings = {}) const;

  friend bool operator==(const Error&, const Error&) = default;
};

/// An error about a setting (bad_option); the message need not repeat its name.
inline Error bad_option(std::string_view setting, std::string message) {
  return {ErrorKind::bad_option, std::string(setting), std::move(message)};
}

/// The error of work that was stopped before it had a result.
inline Error stopped_error() {
  return {ErrorKind::stopped, "", "interrupted; nothing was written"};
}

/// The message with the prefix `before_settings` instead of backquotes around settings.
std::string with_settings(std::string_view message, std::string_view before);

}  // namespace raio::core
