#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

#include "base/platform/files_parts.h"

namespace raio::core {

namespace fs = std::filesystem;

std::string system_reason(int error) { return std::generic_category().message(error); }

std::expected<fs::path, std::string> resolve_links(fs::path path) {
  std::error_code error;
  for (int links = 0; fs::is_symlink(path, error); ++links) {
    if (links == 40) return std::unexpected(system_reason(ELOOP));
    const fs::path next = fs::read_symlink(path, error);
    if (error) return std::unexpected(error.message());
    path = path.parent_path() / next;
  }
  return path;
}

std::expected<fs::path, std::string> folder_of(const fs::path& path) {
  fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return std::unexpected("the folder " + folder.string() + " does not exist or is not a folder");
  return folder;
}

std::string cannot_create(const fs::path& folder, int error) {
  return "cannot create a file in the folder " + folder.string() + ": " + system_reason(error);
}

UnfinishedFiles& unfinished_files() {
  static UnfinishedFiles files;
  return files;
}

void remove_unfinished_files() {
  const std::lock_guard lock(unfinished_files().mutex);
  std::error_code ignored;
  for (const fs::path& path : unfinished_files().paths) fs::remove(path, ignored);
}

std::expected<Column<std::byte>, std::string> read_bytes(const fs::path& path) try {
  auto file = InputFile::open(path);
  if (!file) return std::unexpected("cannot open the file: " + file.error());
  if (file->kind() == InputFile::Kind::folder)
    return std::unexpected("found a folder, expected a file");
  if (file->kind() == InputFile::Kind::device)
    return std::unexpected("found a device, expected a file");
  // If the size is unknown, a growing buffer needs twice the memory.
  const size_t available = available_memory_bytes();
  const size_t most = file->rest() > 0 ? available / 10 * 9 : available / 2;
  Column<std::byte> bytes(std::max<size_t>(std::min(file->rest(), most) + 1, 4096));
  for (size_t size = 0;;) {
    const auto got = file->read(reinterpret_cast<char*>(bytes.data()) + size, bytes.size() - size);
    if (!got) return std::unexpected("cannot read the file: " + got.error());
    size += *got;
    if (size > most) throw std::bad_alloc();
    if (*got == 0) {
      bytes.resize(size);
      return bytes;
    }
    if (size == bytes.size()) bytes.resize(2 * size);
  }
} catch (const std::bad_alloc&) {
  return std::unexpected("not enough memory for the file");
}

}  // namespace raio::core
