// Files of the operating system: replaced whole or not at all, and read to their end. Used by io/
// (see io/file.h) and readers of large files. An error is the system's reason, one line without the
// path.
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/memory.h"

namespace raio::core {

using FileOutcome = std::expected<void, std::string>;

/// When a write is complete: once the system has the bytes, or once they are on the disk and
/// survive a crash of the machine (where the system can guarantee that).
enum class Until { written, on_disk };

/// Writes `bytes` to a temporary file in the same folder, then renames it to `path`. Nobody ever
/// sees a partial file, and a failure keeps the old file and removes the temporary one. Links stay
/// links and files keep their permissions. Targets other than regular files (devices, pipes) are
/// written directly.
FileOutcome replace_file(const std::filesystem::path& path, std::string_view bytes, Until until);

/// Whether replace_file would succeed, as far as can be known in advance. Leaves nothing behind.
FileOutcome check_replaceable(const std::filesystem::path& path);

/// Writes to standard output. A pipe without a reader is an ordinary error.
FileOutcome write_standard_output(std::string_view bytes);
FileOutcome check_standard_output();

/// Removes the temporary files of replace_file in other threads, for a program about to exit
/// without waiting for them. The old files stay.
void remove_unfinished_files();

/// A file, pipe or device, read from its current position to its end.
class InputFile {
 public:
  enum class Kind { regular, pipe, folder, terminal, device };

  /// "/dev/stdin" means the program's standard input. Opening it by name would wait (a named pipe
  /// without a writer) or fail (a socket).
  static std::expected<InputFile, std::string> open(const std::filesystem::path& path);
  InputFile(InputFile&&) noexcept;
  InputFile& operator=(InputFile&&) noexcept;
  ~InputFile();

  Kind kind() const { return kind_; }
  /// The number of bytes left in a regular file when it was opened; 0 if unknown, as for pipes and
  /// files of /proc.
  size_t rest() const { return rest_; }

  /// Reads at most `bytes` and returns their number, 0 only at the end. Large reads from regular
  /// files use all threads.
  std::expected<size_t, std::string> read(char* to, size_t bytes);

 private:
  struct Handle;  // the system's handle
  InputFile(Handle handle, Kind kind, size_t rest);

  std::unique_ptr<Handle> handle_;
  Kind kind_;
  size_t rest_;
};

/// All bytes of a file or pipe, at an address that is a multiple of 64. They are read, not mapped:
/// another program may truncate the file at any time, and access to a lost page of a mapping ends
/// the process (SIGBUS). Fails for folders and devices, and if there is too little memory.
std::expected<Column<std::byte>, std::string> read_bytes(const std::filesystem::path& path);

}  // namespace raio::core
