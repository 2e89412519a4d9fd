// Standard C++: C streams, which report reasons of failures, and std::filesystem.
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <utility>
#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#endif

#include "base/platform/files_parts.h"

namespace raio::core {

struct CloseFile {
  void operator()(std::FILE* file) const {
    if (file != stdin) std::fclose(file);
  }
};
using Stream = std::unique_ptr<std::FILE, CloseFile>;

namespace {

namespace fs = std::filesystem;

std::unexpected<std::string> failed(int error) {
  return std::unexpected(system_reason(error != 0 ? error : EIO));
}

Stream open_stream(const fs::path& path, const char* mode) {
  errno = 0;
  return Stream(std::fopen(path.string().c_str(), mode));
}

/// Keeps Windows from translating the ends of lines.
std::FILE* binary(std::FILE* stream) {
#ifdef _WIN32
  ::_setmode(::_fileno(stream), _O_BINARY);
#endif
  return stream;
}

FileOutcome write_all(std::FILE* file, std::string_view bytes) {
  errno = 0;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  return written && std::fflush(file) == 0 ? FileOutcome() : failed(errno);
}

FileOutcome close(Stream stream) {
  errno = 0;
  return std::fclose(stream.release()) == 0 ? FileOutcome() : failed(errno);
}

/// A new temporary file, removed with this object unless it was moved into place.
class TemporaryFile {
 public:
  using Created = std::expected<std::unique_ptr<TemporaryFile>, std::string>;

  static Created create(const fs::path& folder) {
    // The time distinguishes files of concurrent programs.
    static std::atomic<unsigned> counter = 0;
    static const auto start = std::chrono::system_clock::now().time_since_epoch().count();
    for (int attempt = 0; attempt < 1000; ++attempt) {
      fs::path path =
          folder / (".raio-" + std::to_string(start) + "-" + std::to_string(counter++) + ".tmp");
      const std::lock_guard lock(unfinished_files().mutex);
      if (Stream stream = open_stream(path, "wbx"))
        return std::unique_ptr<TemporaryFile>(
            new TemporaryFile(std::move(path), std::move(stream)));
      if (errno != EEXIST) break;
    }
    return std::unexpected(cannot_create(folder, errno));
  }
  ~TemporaryFile() {
    stream_.reset();  // first, for systems that cannot remove open files
    const std::lock_guard lock(unfinished_files().mutex);
    unfinished_files().paths.erase(path_);
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
  }

  FileOutcome write(std::string_view bytes) {
    if (const auto written = write_all(stream_.get(), bytes); !written) return written;
    return close(std::move(stream_));
  }
  FileOutcome move_to(const fs::path& target, fs::perms permissions) {
    const std::lock_guard lock(unfinished_files().mutex);
    std::error_code error;
    if (permissions != fs::perms::unknown) fs::permissions(path_, permissions, error);
    if (!error) fs::rename(path_, target, error);
    if (error) return std::unexpected(error.message());
    unfinished_files().paths.erase(path_);
    path_.clear();
    return {};
  }

 private:
  TemporaryFile(fs::path path, Stream stream) : path_(std::move(path)), stream_(std::move(stream)) {
    unfinished_files().paths.insert(path_);
  }

  fs::path path_;
  Stream stream_;
};

struct Target {
  fs::path path, folder;  // with links resolved, unless written directly; its folder
  fs::perms permissions = fs::perms::unknown;  // if it exists
  bool direct = false;                         // not a regular file: written in place
};

/// Resolves `path`. The error says why it cannot be written.
std::expected<Target, std::string> find_target(const fs::path& path) {
  if (path.empty()) return failed(ENOENT);
  Target target{path, {}};
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::status_known(status)) return std::unexpected(error.message());
  if (fs::is_directory(status)) return failed(EISDIR);
  target.direct = fs::exists(status) && !fs::is_regular_file(status);
  if (target.direct) return target;

  auto end = resolve_links(path);
  if (!end) return std::unexpected(std::move(end.error()));
  target.path = std::move(*end);
  if (fs::exists(status)) {
    target.permissions = status.permissions();
    if (!open_stream(target.path, "r+b")) return failed(errno);
  }
  auto folder = folder_of(target.path);
  if (!folder) return std::unexpected(std::move(folder.error()));
  target.folder = std::move(*folder);
  return target;
}

FileOutcome write_directly(const Target& target, std::string_view bytes) {
  Stream file = open_stream(target.path, "wb");
  if (!file) return failed(errno);
  if (const auto written = write_all(file.get(), bytes); !written) return written;
  return close(std::move(file));
}

InputFile::Kind kind_of(fs::file_type type) {
  switch (type) {
    case fs::file_type::regular:
      return InputFile::Kind::regular;
    case fs::file_type::directory:
      return InputFile::Kind::folder;
    case fs::file_type::block:
    case fs::file_type::character:
      return InputFile::Kind::device;
    default:
      return InputFile::Kind::pipe;
  }
}

}  // namespace

FileOutcome replace_file(const fs::path& path, std::string_view bytes, Until) {
  const auto target = find_target(path);
  if (!target) return std::unexpected(target.error());
  if (target->direct) return write_directly(*target, bytes);
  const auto temporary = TemporaryFile::create(target->folder);
  if (!temporary) return std::unexpected(temporary.error());
  if (const auto written = (*temporary)->write(bytes); !written) return written;
  return (*temporary)->move_to(target->path, target->permissions);
}

FileOutcome check_replaceable(const fs::path& path) {
  const auto target = find_target(path);
  if (!target) return std::unexpected(target.error());
  if (target->direct) return {};  // opening it may block or have an effect
  const auto temporary = TemporaryFile::create(target->folder);
  return temporary ? FileOutcome() : std::unexpected(temporary.error());
}

FileOutcome write_standard_output(std::string_view bytes) {
  return write_all(binary(stdout), bytes);
}

FileOutcome check_standard_output() { return {}; }

struct InputFile::Handle {
  Stream stream;
};

InputFile::InputFile(Handle handle, Kind kind, size_t rest)
    : handle_(std::make_unique<Handle>(std::move(handle))), kind_(kind), rest_(rest) {}
InputFile::InputFile(InputFile&&) noexcept = default;
InputFile& InputFile::operator=(InputFile&&) noexcept = default;
InputFile::~InputFile() = default;

std::expected<InputFile, std::string> InputFile::open(const fs::path& path) {
  if (path == "/dev/stdin") return InputFile({Stream(binary(stdin))}, Kind::pipe, 0);
  Stream stream = open_stream(path, "rb");
  if (!stream) return failed(errno);
  std::error_code error;
  const Kind kind = kind_of(fs::status(path, error).type());
  const auto size = kind == Kind::regular ? fs::file_size(path, error) : 0;
  return InputFile({std::move(stream)}, kind, error ? 0 : size_t(size));
}

std::expected<size_t, std::string> InputFile::read(char* to, size_t bytes) {
  errno = 0;
  std::FILE* const file = handle_->stream.get();
  const size_t got = std::fread(to, 1, bytes, file);
  if (got == 0 && std::ferror(file)) return failed(errno);
  return got;
}

}  // namespace raio::core
