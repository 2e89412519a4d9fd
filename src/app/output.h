// Output of commands: bytes into files or to standard output, failures as one line on standard
// error and an exit status.
#pragma once

#include <string>
#include <string_view>

#include "app/commands.h"
#include "app/terminal.h"
#include "io/image/image.h"

namespace raio::core::app {

/// The error in terms of the command line, where settings are options.
inline std::string text_of(const Error& error) { return error.text("--"); }

inline int status_of(const Error& error) {
  if (error.kind == ErrorKind::stopped) return kInterrupted;
  const bool ran_out =
      error.kind == ErrorKind::cannot_write || error.kind == ErrorKind::no_resource;
  return ran_out ? kNoResource : kBadInput;
}

/// Prints the error; returns its exit status.
inline int fail(const Error& error) {
  if (error.kind == ErrorKind::stopped)
    print_line("raio: " + text_of(error));
  else
    print_error(text_of(error));
  return status_of(error);
}

/// Prints the change that the user has to make; returns the exit status.
inline int bad_input(std::string_view message) {
  print_error(message);
  return kBadInput;
}

/// Prints the resource that ran out; returns the exit status.
inline int no_resource(std::string_view message) {
  print_error(message);
  return kNoResource;
}

/// write_file, and the exit status. "-" is standard output.
inline int deliver(const std::string& path, std::string_view bytes) {
  const auto written = write_file(path, bytes);
  return written ? int(kDone) : fail(written.error());
}

}  // namespace raio::core::app
