#include "io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <memory>
#include <mutex>
#include <new>
#include <set>
#include <system_error>
#include <utility>

namespace raio {

namespace {

namespace fs = std::filesystem;

/// Why it failed, in words; FileError adds the path.
using Outcome = std::expected<void, std::string>;

std::string reason(int error) { return std::generic_category().message(error); }
std::unexpected<std::string> failed(int error) { return std::unexpected(reason(error)); }

std::string one_line(std::string text) {
  std::ranges::replace_if(text, [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return text;
}

/// While it lives, a write to a pipe that nobody reads or beyond the limit of file sizes does not
/// end the program by a signal but fails like any other. The signals concerned come to the thread
/// that writes.
class QuietSignals {
 public:
  QuietSignals() {
    sigset_t pending;
    sigpending(&pending);
    sigemptyset(&quiet_);
    for (const int signal : {SIGPIPE, SIGXFSZ})
      if (!sigismember(&pending, signal)) sigaddset(&quiet_, signal);
    pthread_sigmask(SIG_BLOCK, &quiet_, &before_);
  }
  ~QuietSignals() {
    const timespec at_once{};
    while (sigtimedwait(&quiet_, nullptr, &at_once) > 0 || errno == EINTR) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  QuietSignals(const QuietSignals&) = delete;
  QuietSignals& operator=(const QuietSignals&) = delete;

 private:
  sigset_t quiet_, before_;
};

Outcome write_all(int file, std::string_view bytes) {
  const QuietSignals quiet;
  // Linux writes at most 2 GiB at once; what is left comes in the next round.
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count > 0) {
      bytes.remove_prefix(size_t(count));
    } else if (count < 0 && errno == EAGAIN) {
      pollfd room{file, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (count == 0 || errno != EINTR) {
      return failed(count == 0 ? EIO : errno);
    }
  }
  return {};
}

/// An open file. close() tells of errors that come late, as those of file servers and quotas may.
class OpenFile {
 public:
  explicit OpenFile(int id) : id_(id) {}
  ~OpenFile() { (void)close(); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int id() const { return id_; }
  Outcome close() {
    const int id = std::exchange(id_, -1);
    // On Linux the file is closed even when the call was interrupted.
    return id < 0 || ::close(id) == 0 || errno == EINTR ? Outcome() : failed(errno);
  }

 private:
  int id_;
};

/// The temporary files there are, for remove_unfinished_files().
struct Unfinished {
  std::mutex mutex;
  std::set<fs::path> paths;
};

Unfinished& unfinished() {
  static Unfinished files;
  return files;
}

/// A new file under a name of its own, gone with this object unless it was moved.
class TemporaryFile {
 public:
  using Created = std::expected<std::unique_ptr<TemporaryFile>, std::string>;

  /// `mode`: its permissions before the umask.
  static Created create(const fs::path& folder, mode_t mode) {
    // The name is short, so that it is allowed wherever the target's is.
    static std::atomic<unsigned> counter = 0;
    for (int attempt = 0; attempt < 1000; ++attempt) {
      fs::path path = folder / fmt::format(".raio-{}-{}.tmp", ::getpid(), counter++);
      const std::lock_guard lock(unfinished().mutex);
      const int id = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
      if (id >= 0) return std::unique_ptr<TemporaryFile>(new TemporaryFile(std::move(path), id));
      if (errno != EEXIST) break;
    }
    return std::unexpected(
        fmt::format("cannot make a file in the folder {}: {}", folder.string(), reason(errno)));
  }
  ~TemporaryFile() {
    const std::lock_guard lock(unfinished().mutex);
    unfinished().paths.erase(path_);
    if (!path_.empty()) ::unlink(path_.c_str());
  }

  OpenFile& file() { return file_; }
  Outcome move_to(const fs::path& target) {
    const std::lock_guard lock(unfinished().mutex);
    if (::rename(path_.c_str(), target.c_str()) != 0) return failed(errno);
    unfinished().paths.erase(path_);
    path_.clear();
    return {};
  }

 private:
  TemporaryFile(fs::path path, int id) : path_(std::move(path)), file_(id) {
    unfinished().paths.insert(path_);
  }

  fs::path path_;
  OpenFile file_;
};

struct Target {
  fs::path path;    // with links resolved, unless written directly
  fs::path folder;  // of `path`
  bool exists = false;
  bool direct = false;   // no regular file, or one without a name: to be written where it is
  struct stat status{};  // when it exists
};

/// What `path` leads to. The error is why nothing can be written there.
std::expected<Target, std::string> find_target(const fs::path& path) {
  if (path.empty()) return failed(ENOENT);
  Target target;
  target.path = path;
  target.exists = ::stat(path.c_str(), &target.status) == 0;
  if (!target.exists && errno != ENOENT) return failed(errno);
  if (target.exists && S_ISDIR(target.status.st_mode)) return failed(EISDIR);
  target.direct = target.exists && !S_ISREG(target.status.st_mode);
  if (target.direct) return target;

  std::error_code error;
  for (int links = 0; fs::is_symlink(target.path, error); ++links) {
    if (links == 40) return failed(ELOOP);
    const fs::path next = fs::read_symlink(target.path, error);
    if (error) return failed(error.value());
    target.path = target.path.parent_path() / next;
  }
  struct stat found{};
  const bool found_same = ::lstat(target.path.c_str(), &found) == 0 &&
                          found.st_dev == target.status.st_dev &&
                          found.st_ino == target.status.st_ino;
  if (target.exists && !found_same) {
    // A link of /proc to an open file that was removed or never had a name.
    target.path = path;
    target.direct = true;
    return target;
  }
  if (target.exists && ::faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) != 0)
    return failed(errno);
  target.folder = target.path.has_parent_path() ? target.path.parent_path() : fs::path(".");
  if (!fs::is_directory(target.folder, error))
    return std::unexpected(
        fmt::format("the folder {} does not exist or is no folder", target.folder.string()));
  return target;
}

Outcome write_directly(const Target& target, std::string_view bytes) {
  OpenFile file(::open(target.path.c_str(), O_WRONLY | O_TRUNC | O_NOCTTY | O_CLOEXEC));
  if (file.id() < 0) return failed(errno);
  if (const auto written = write_all(file.id(), bytes); !written) return written;
  return file.close();
}

Outcome replace(const Target& target, std::string_view bytes, Until until) {
  // What others may not read of the old file they must not read of the new one at any time.
  const auto temporary = TemporaryFile::create(target.folder, target.exists ? 0600 : 0666);
  if (!temporary) return std::unexpected(temporary.error());
  OpenFile& file = (*temporary)->file();
  if (target.exists && ::fchmod(file.id(), target.status.st_mode & 0777) != 0) return failed(errno);
  if (const auto written = write_all(file.id(), bytes); !written) return written;
  if (until == Until::on_disk && ::fsync(file.id()) != 0) return failed(errno);
  if (const auto closed = file.close(); !closed) return closed;
  return (*temporary)->move_to(target.path);
}

Outcome check(const Target& target) {
  if (!target.direct) {
    const auto temporary = TemporaryFile::create(target.folder, 0600);
    return temporary ? Outcome() : std::unexpected(temporary.error());
  }
  // Who reads a pipe would take an opening and closing for the end.
  if (S_ISFIFO(target.status.st_mode)) {
    const bool allowed = ::faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) == 0;
    return allowed ? Outcome() : failed(errno);
  }
  OpenFile file(::open(target.path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  return file.id() >= 0 ? file.close() : failed(errno);
}

Outcome check_standard_output() {
  const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
  if (flags < 0) return failed(errno);
  return (flags & O_ACCMODE) != O_RDONLY ? Outcome() : failed(EBADF);
}

fs::path shown(const fs::path& path) { return path == "-" ? "standard output" : path; }

}  // namespace

FileError read_error(const fs::path& path, std::string_view why) {
  return {FileError::bad_input, one_line(fmt::format("cannot read {}: {}", path.string(), why))};
}

FileError write_error(const fs::path& path, std::string_view why) {
  return {FileError::cannot_write,
          one_line(fmt::format("cannot write {}: {}", shown(path).string(), why))};
}

std::string lower_suffix(const fs::path& path) {
  std::string suffix = path.extension().string();
  for (char& c : suffix)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return suffix;
}

bool is_standard_output(const fs::path& path) { return path == "-" || path == "/dev/stdout"; }

std::expected<void, FileError> write_file(const fs::path& path, std::string_view bytes,
                                          Until until) {
  Outcome outcome;
  if (is_standard_output(path)) {
    outcome = write_all(STDOUT_FILENO, bytes);
  } else if (const auto target = find_target(path); target) {
    outcome = target->direct ? write_directly(*target, bytes) : replace(*target, bytes, until);
  } else {
    outcome = std::unexpected(target.error());
  }
  if (!outcome) return std::unexpected(write_error(path, outcome.error()));
  return {};
}

std::expected<void, FileError> check_writable(const fs::path& path) {
  Outcome outcome;
  if (is_standard_output(path)) {
    outcome = check_standard_output();
  } else if (const auto target = find_target(path); target) {
    outcome = check(*target);
  } else {
    outcome = std::unexpected(target.error());
  }
  if (!outcome) return std::unexpected(write_error(path, outcome.error()));
  return {};
}

void remove_unfinished_files() {
  const std::lock_guard lock(unfinished().mutex);
  for (const fs::path& path : unfinished().paths) ::unlink(path.c_str());
}

int open_for_reading(const fs::path& path) {
  if (path == "/dev/stdin") return ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
  return ::open(path.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC);
}

std::expected<std::string, FileError> read_file(const fs::path& path, size_t max_bytes) try {
  const auto error = [&](std::string_view why) { return std::unexpected(read_error(path, why)); };
  const OpenFile file(open_for_reading(path));
  struct stat status{};
  if (file.id() < 0 || ::fstat(file.id(), &status) != 0) return error(reason(errno));
  if (S_ISDIR(status.st_mode)) return error(reason(EISDIR));
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) return error("it is a device, no file");

  // Pipes and the files of /proc do not tell their size.
  std::string bytes(std::min(size_t(status.st_size), max_bytes) + 1, '\0');
  size_t size = 0;
  for (;;) {
    const ssize_t count = ::read(file.id(), bytes.data() + size, bytes.size() - size);
    if (count == 0) break;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return error(reason(errno));
    size += size_t(count);
    if (size > max_bytes) return error(fmt::format("it is larger than {} bytes", max_bytes));
    if (size == bytes.size()) bytes.resize(std::max<size_t>(2 * size, 65536));
  }
  bytes.resize(size);
  return bytes;
} catch (const std::bad_alloc&) {
  return std::unexpected(read_error(path, "not enough memory"));
}

}  // namespace raio
