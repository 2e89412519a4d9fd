// How commands hand over what they made: bytes into files or to standard output, failures as one
// line on standard error and an exit status.
#pragma once

#include <string>
#include <string_view>

#include "app/commands.h"
#include "app/terminal.h"
#include "io/image/image.h"

namespace raio::app {

/// Prints the error; the exit status for it.
inline int fail(const FileError& error) {
  print_error(error.message);
  return error.kind == FileError::bad_input ? kBadInput : kNoResource;
}

/// Prints what the user has to change; the exit status for it.
inline int bad_input(std::string_view message) {
  print_error(message);
  return kBadInput;
}

/// Prints what ran out; the exit status for it.
inline int no_resource(std::string_view message) {
  print_error(message);
  return kNoResource;
}

/// write_file, and the exit status. "-" is standard output.
inline int deliver(const std::string& path, std::string_view bytes) {
  const auto written = write_file(path, bytes);
  return written ? int(kDone) : fail(written.error());
}

}  // namespace raio::app
