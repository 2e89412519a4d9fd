// Whole files in and out. A file is replaced whole or not at all, whatever goes wrong on the way,
// and every failure is told in one line. For everyone who keeps results.
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/platform/files.h"

namespace raio {

/// "cannot read PATH: WHY", "cannot write PATH: WHY", and that there was no memory to do it.
Error read_error(const std::filesystem::path& path, std::string_view why);
Error write_error(const std::filesystem::path& path, std::string_view why);
Error memory_error(const std::filesystem::path& path);

/// A name's ending, ".png", in small letters.
std::string lower_suffix(const std::filesystem::path& path);

/// "-" and "/dev/stdout".
bool is_standard_output(const std::filesystem::path& path);

/// `bytes` under `path`, whole or not at all, as replace_file() says; "-" is standard output.
/// Errors are cannot_write; a pipe that nobody reads is one, too.
std::expected<void, Error> write_file(const std::filesystem::path& path, std::string_view bytes,
                                      Until until = Until::written);

/// Could write_file succeed, as far as can be told now? Asked before long work. Leaves nothing
/// behind.
std::expected<void, Error> check_writable(const std::filesystem::path& path);

/// All bytes of a file or pipe. An error (cannot_read) for folders, devices and more than
/// `max_bytes`.
std::expected<std::string, Error> read_file(const std::filesystem::path& path, uint64_t max_bytes);

}  // namespace raio
