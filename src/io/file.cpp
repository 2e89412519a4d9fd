#include "io/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>

#include "base/executor.h"

namespace raio::core {

namespace {

namespace fs = std::filesystem;

fs::path shown(const fs::path& path) { return path == "-" ? "standard output" : path; }

}  // namespace

Error read_error(const fs::path& path, std::string_view why) {
  return {ErrorKind::cannot_read, path.string(), std::string(why)};
}

Error write_error(const fs::path& path, std::string_view why) {
  return {ErrorKind::cannot_write, shown(path).string(), std::string(why)};
}

Error memory_error(const fs::path& path) {
  return {ErrorKind::no_resource, shown(path).string(), "not enough memory"};
}

std::string lower_suffix(const fs::path& path) {
  std::string suffix = path.extension().string();
  for (char& c : suffix)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return suffix;
}

bool is_standard_output(const fs::path& path) { return path == "-" || path == "/dev/stdout"; }

std::expected<void, Error> write_file(const fs::path& path, std::string_view bytes, Until until) {
  const auto written =
      is_standard_output(path) ? write_standard_output(bytes) : replace_file(path, bytes, until);
  if (!written) return std::unexpected(write_error(path, written.error()));
  return {};
}

std::expected<void, Error> check_writable(const fs::path& path) {
  const auto found = is_standard_output(path) ? check_standard_output() : check_replaceable(path);
  if (!found) return std::unexpected(write_error(path, found.error()));
  return {};
}

std::expected<std::string, Error> read_file(const fs::path& path, uint64_t max_bytes) try {
  using Kind = InputFile::Kind;
  const auto error = [&](std::string_view why) { return std::unexpected(read_error(path, why)); };
  auto file = InputFile::open(path);
  if (!file) return error(file.error());
  if (file->kind() == Kind::folder) return error(std::generic_category().message(EISDIR));
  if (file->kind() == Kind::device || file->kind() == Kind::terminal)
    return error("found a device, expected a file");

  const auto most = size_t(std::min<uint64_t>(max_bytes, std::string().max_size() / 2));
  std::string bytes(std::min(file->rest(), most) + 1, '\0');
  size_t size = 0;
  for (;;) {
    check_stop();
    const auto count = file->read(bytes.data() + size, bytes.size() - size);
    if (!count) return error(count.error());
    if (*count == 0) break;
    size += *count;
    if (size > most) return error(fmt::format("it is larger than {} bytes", most));
    if (size == bytes.size()) bytes.resize(std::max<size_t>(2 * size, 65536));
  }
  bytes.resize(size);
  return bytes;
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

}  // namespace raio::core
