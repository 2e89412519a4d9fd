// Whole files in and out. A file is replaced whole or not at all, whatever goes wrong on the way,
// and every failure is told in one line. For everyone who keeps results.
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

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

/// When write_file is done: with the bytes in the system's hands, which end on the disk in time, or
/// on the disk, so that the machine itself may fail.
enum class Until { written, on_disk };

/// `bytes` under `path`: into a file beside it, which is then moved into place, so that nobody ever
/// sees half a file and a failure keeps what was there; on failure the other file is removed. Links
/// stay links and files keep their permissions. Targets that are not regular files (devices, pipes)
/// are written directly. "-" is standard output. Errors are cannot_write; a pipe that nobody reads
/// is one, too.
std::expected<void, FileError> write_file(const std::filesystem::path& path, std::string_view bytes,
                                          Until until = Until::written);

/// Could write_file succeed, as far as can be told now? Asked before long work. Leaves nothing
/// behind.
std::expected<void, FileError> check_writable(const std::filesystem::path& path);

/// Removes the files that write_file is busy with in other threads, for a program that is about to
/// end without waiting for them. What they were to replace stays.
void remove_unfinished_files();

/// A descriptor to read the file from, or -1 and errno. "/dev/stdin" is what the program was given
/// as standard input, which opened by its name would wait (a named pipe whose writer is done) or
/// fail (a socket).
int open_for_reading(const std::filesystem::path& path);

/// All bytes of a file or pipe. An error (bad_input) for folders, devices and more than
/// `max_bytes`.
std::expected<std::string, FileError> read_file(const std::filesystem::path& path,
                                                size_t max_bytes);

}  // namespace raio
