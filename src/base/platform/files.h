// Files as the system has them: replaced whole or not at all, read to their end, mapped into
// memory. For io/ (io/file.h says what files are for) and for readers of large files. Errors are
// the system's reasons, one line without the path.
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/memory.h"

namespace raio {

using FileOutcome = std::expected<void, std::string>;

/// When a file is written: with the bytes in the system's hands, which end on the disk in time, or
/// on the disk, so that the machine itself may fail (where the system can be asked for that).
enum class Until { written, on_disk };

/// `bytes` under `path`: into a file beside it, which is then moved into place, so that nobody ever
/// sees half a file and a failure keeps what was there; on failure the other file is removed. Links
/// stay links and files keep their permissions. Targets that are not regular files (devices, pipes)
/// are written directly.
FileOutcome replace_file(const std::filesystem::path& path, std::string_view bytes, Until until);

/// Could replace_file succeed, as far as can be told now? Leaves nothing behind.
FileOutcome check_replaceable(const std::filesystem::path& path);

/// A pipe that nobody reads is an error like any other.
FileOutcome write_standard_output(std::string_view bytes);
FileOutcome check_standard_output();

/// Removes the files that replace_file is busy with in other threads, for a program that is about
/// to end without waiting for them. What they were to replace stays.
void remove_unfinished_files();

/// A file, pipe or device that is read from where it stands to its end.
class InputFile {
 public:
  enum class Kind { regular, pipe, folder, terminal, device };

  /// "/dev/stdin" is what the program was given as standard input, which opened by its name would
  /// wait (a named pipe whose writer is done) or fail (a socket).
  static std::expected<InputFile, std::string> open(const std::filesystem::path& path);
  InputFile(InputFile&&) noexcept;
  InputFile& operator=(InputFile&&) noexcept;
  ~InputFile();

  Kind kind() const { return kind_; }
  /// How much was left of a regular file when it was opened; 0 if that is not known, as of pipes
  /// and the files of /proc.
  size_t rest() const { return rest_; }

  /// The next bytes, at most so many; how many there were, 0 only at the end. Much of a regular
  /// file is read on all threads.
  std::expected<size_t, std::string> read(char* to, size_t bytes);

  /// All of a regular file of `size` bytes, as unmap_file() takes it back, or nullptr where it
  /// cannot be mapped or stands elsewhere than at its beginning.
  const std::byte* map(size_t size) const;

 private:
  struct Handle;  // what the system calls an open file
  InputFile(Handle handle, Kind kind, size_t rest);

  std::unique_ptr<Handle> handle_;
  Kind kind_;
  size_t rest_;
};

void unmap_file(const std::byte* data, size_t size);

/// The bytes of a file, read only. A regular file is mapped where the system can: its parts are
/// read when they are first touched, and memory is given back to the system without writing. Who
/// cuts such a file meanwhile ends the program (SIGBUS); to replace it as replace_file does is
/// safe. Anything else (pipes, standard input) is read into memory.
class MappedFile {
 public:
  /// An error for folders, devices and what memory does not suffice for.
  static std::expected<MappedFile, std::string> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  /// At a multiple of 64 bytes; without meaning when size() is 0.
  const std::byte* data() const { return mapped_ ? mapped_ : read_.data(); }
  size_t size() const { return mapped_ ? mapped_size_ : read_.size(); }
  std::string_view view() const { return {reinterpret_cast<const char*>(data()), size()}; }

 private:
  MappedFile() = default;

  const std::byte* mapped_ = nullptr;
  size_t mapped_size_ = 0;
  Column<std::byte> read_;  // when it is not mapped
};

}  // namespace raio
