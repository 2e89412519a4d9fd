#include "io/raio/mapped_file.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/file.h"

namespace raio {

std::expected<MappedFile, std::string> MappedFile::open(const std::filesystem::path& path) {
  const auto failed = [](int error) {
    return std::unexpected(
        fmt::format("cannot read the file: {}", std::generic_category().message(error)));
  };
  const int file = open_for_reading(path);
  if (file < 0) return failed(errno);
  struct stat status{};
  const bool known = ::fstat(file, &status) == 0;
  const int why = errno;
  void* map = nullptr;
  if (known && S_ISREG(status.st_mode) && status.st_size > 0)
    map = ::mmap(nullptr, size_t(status.st_size), PROT_READ, MAP_SHARED, file, 0);
  const int map_error = errno;
  ::close(file);
  if (!known) return failed(why);
  if (!S_ISREG(status.st_mode)) return std::unexpected("expected a regular file");
  if (map == MAP_FAILED) return failed(map_error);
  return MappedFile(static_cast<const char*>(map), size_t(status.st_size));
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(const_cast<char*>(data_), size_);
}

}  // namespace raio
