// A file as memory, to be read only.
#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <string>
#include <utility>

namespace raio {

/// Mapped as long as it lives, also when the file is replaced or removed meanwhile. Reading what
/// somebody cuts off it meanwhile ends the program (SIGBUS).
class MappedFile {
 public:
  /// Of a regular file; else one line that says why not.
  static std::expected<MappedFile, std::string> open(const std::filesystem::path& path);

  MappedFile(MappedFile&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  const char* data() const { return data_; }
  size_t size() const { return size_; }

 private:
  MappedFile(const char* data, size_t size) : data_(data), size_(size) {}

  const char* data_;  // null for an empty file
  size_t size_;
};

}  // namespace raio
