// Whole files in and out. A file is replaced whole or not at all, whatever goes wrong on the way,
// and every failure is told in one line. For everyone who keeps results.
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/platform/files.h"

namespace raio {

/// What went wrong with a file, and whose fault it is: the caller's input or the machine.
struct FileError {
  enum Kind { bad_input, cannot_write } kind;
  std::string message;  // one line, with the path and the system's reason
};

/// "cannot read PATH: WHY" as bad_input, "cannot write PATH: WHY" as cannot_write.
FileError read_error(const std::filesystem::path& path, std::string_view why);
FileError write_error(const std::filesystem::path& path, std::string_view why);

/// A name's ending, ".png", in small letters.
std::string lower_suffix(const std::filesystem::path& path);

/// "-" and "/dev/stdout".
bool is_standard_output(const std::filesystem::path& path);

/// `bytes` under `path`, whole or not at all, as replace_file() says; "-" is standard output.
/// Errors are cannot_write; a pipe that nobody reads is one, too.
std::expected<void, FileError> write_file(const std::filesystem::path& path, std::string_view bytes,
                                          Until until = Until::written);

/// Could write_file succeed, as far as can be told now? Asked before long work. Leaves nothing
/// behind.
std::expected<void, FileError> check_writable(const std::filesystem::path& path);

/// All bytes of a file or pipe. An error (bad_input) for folders, devices and more than
/// `max_bytes`.
std::expected<std::string, FileError> read_file(const std::filesystem::path& path,
                                                size_t max_bytes);

}  // namespace raio
