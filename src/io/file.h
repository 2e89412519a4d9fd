// Reads and writes whole files. A file is replaced whole or not at all, whatever goes wrong, and
// every failure is one line. For all code that stores results.
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/platform/files.h"

namespace raio::core {

/// "cannot read PATH: WHY", "cannot write PATH: WHY", or out of memory.
Error read_error(const std::filesystem::path& path, std::string_view why);
Error write_error(const std::filesystem::path& path, std::string_view why);
Error memory_error(const std::filesystem::path& path);

/// A name's suffix, ".png", in lower case.
std::string lower_suffix(const std::filesystem::path& path);

/// "-" and "/dev/stdout".
bool is_standard_output(const std::filesystem::path& path);

/// Writes `bytes` to `path`, whole or not at all, with replace_file(); "-" is standard output.
/// Errors are cannot_write, also for a pipe without a reader.
std::expected<void, Error> write_file(const std::filesystem::path& path, std::string_view bytes,
                                      Until until = Until::written);

/// Whether write_file would succeed, as far as can be known in advance. Call it before long work.
/// Leaves nothing behind.
std::expected<void, Error> check_writable(const std::filesystem::path& path);

/// All bytes of a file or pipe. An error (cannot_read) for folders, devices and more than
/// `max_bytes`.
std::expected<std::string, Error> read_file(const std::filesystem::path& path, uint64_t max_bytes);

}  // namespace raio::core
