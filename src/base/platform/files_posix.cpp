#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/platform/files_parts.h"

namespace raio::core {

namespace {

namespace fs = std::filesystem;

std::unexpected<std::string> failed(int error) { return std::unexpected(system_reason(error)); }

/// While it lives, a write to a pipe without a reader, or beyond the limit of file sizes, fails
/// instead of ending the program by a signal. These signals go to the writing thread.
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
    take_pending();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  QuietSignals(const QuietSignals&) = delete;
  QuietSignals& operator=(const QuietSignals&) = delete;

 private:
  void take_pending() const {
#ifdef __APPLE__  // without sigtimedwait, and nobody else waits for the signals
    sigset_t pending;
    for (const int signal : {SIGPIPE, SIGXFSZ})
      if (int taken = 0; sigpending(&pending) == 0 && sigismember(&quiet_, signal) &&
                         sigismember(&pending, signal))
        sigwait(&quiet_, &taken);
#else
    const timespec at_once{};
    while (sigtimedwait(&quiet_, nullptr, &at_once) > 0 || errno == EINTR) {
    }
#endif
  }

  sigset_t quiet_, before_;
};

FileOutcome write_all(int file, std::string_view bytes) {
  const QuietSignals quiet;
  // Linux writes at most 2 GiB per call.
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

}  // namespace

/// An open file. close() reports late errors, for instance of file servers and quotas.
class OpenFile {
 public:
  explicit OpenFile(int id) : id_(id) {}
  ~OpenFile() { (void)close(); }
  OpenFile(OpenFile&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  OpenFile& operator=(OpenFile&&) = delete;

  int id() const { return id_; }
  FileOutcome close() {
    const int id = std::exchange(id_, -1);
    // Linux closes the file even if the call is interrupted.
    return id < 0 || ::close(id) == 0 || errno == EINTR ? FileOutcome() : failed(errno);
  }

 private:
  int id_;
};

namespace {

/// A new temporary file, removed with this object unless it was moved into place.
class TemporaryFile {
 public:
  using Created = std::expected<std::unique_ptr<TemporaryFile>, std::string>;

  /// `mode`: the permissions before the umask.
  static Created create(const fs::path& folder, mode_t mode) {
    // Short, so that it is valid wherever the target's name is.
    static std::atomic<unsigned> counter = 0;
    for (int attempt = 0; attempt < 1000; ++attempt) {
      fs::path path = folder / (".raio-" + std::to_string(::getpid()) + "-" +
                                std::to_string(counter++) + ".tmp");
      const std::lock_guard lock(unfinished_files().mutex);
      const int id = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
      if (id >= 0) return std::unique_ptr<TemporaryFile>(new TemporaryFile(std::move(path), id));
      if (errno != EEXIST) break;
    }
    return std::unexpected(cannot_create(folder, errno));
  }
  ~TemporaryFile() {
    const std::lock_guard lock(unfinished_files().mutex);
    unfinished_files().paths.erase(path_);
    if (!path_.empty()) ::unlink(path_.c_str());
  }

  OpenFile& file() { return file_; }
  FileOutcome move_to(const fs::path& target) {
    const std::lock_guard lock(unfinished_files().mutex);
    if (::rename(path_.c_str(), target.c_str()) != 0) return failed(errno);
    unfinished_files().paths.erase(path_);
    path_.clear();
    return {};
  }

 private:
  TemporaryFile(fs::path path, int id) : path_(std::move(path)), file_(id) {
    unfinished_files().paths.insert(path_);
  }

  fs::path path_;
  OpenFile file_;
};

struct Target {
  fs::path path;    // with links resolved, unless written directly
  fs::path folder;  // that contains `path`
  bool exists = false;
  bool direct = false;   // not a regular file, or one without a name: written in place
  struct stat status{};  // if it exists
};

/// Resolves `path`. The error says why it cannot be written.
std::expected<Target, std::string> find_target(const fs::path& path) {
  if (path.empty()) return failed(ENOENT);
  Target target;
  target.path = path;
  target.exists = ::stat(path.c_str(), &target.status) == 0;
  if (!target.exists && errno != ENOENT) return failed(errno);
  if (target.exists && S_ISDIR(target.status.st_mode)) return failed(EISDIR);
  target.direct = target.exists && !S_ISREG(target.status.st_mode);
  if (target.direct) return target;

  auto end = resolve_links(path);
  if (!end) return std::unexpected(std::move(end.error()));
  target.path = std::move(*end);
  struct stat found{};
  const bool found_same = ::lstat(target.path.c_str(), &found) == 0 &&
                          found.st_dev == target.status.st_dev &&
                          found.st_ino == target.status.st_ino;
  if (target.exists && !found_same) {
    // A link in /proc to an open file that was deleted or never had a name.
    target.path = path;
    target.direct = true;
    return target;
  }
  if (target.exists && ::faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) != 0)
    return failed(errno);
  auto folder = folder_of(target.path);
  if (!folder) return std::unexpected(std::move(folder.error()));
  target.folder = std::move(*folder);
  return target;
}

FileOutcome write_directly(const Target& target, std::string_view bytes) {
  OpenFile file(::open(target.path.c_str(), O_WRONLY | O_TRUNC | O_NOCTTY | O_CLOEXEC));
  if (file.id() < 0) return failed(errno);
  if (const auto written = write_all(file.id(), bytes); !written) return written;
  return file.close();
}

FileOutcome replace(const Target& target, std::string_view bytes, Until until) {
  // The new file is never readable by anyone who may not read the old one.
  const auto temporary = TemporaryFile::create(target.folder, target.exists ? 0600 : 0666);
  if (!temporary) return std::unexpected(temporary.error());
  OpenFile& file = (*temporary)->file();
  if (target.exists && ::fchmod(file.id(), target.status.st_mode & 0777) != 0) return failed(errno);
  if (const auto written = write_all(file.id(), bytes); !written) return written;
  if (until == Until::on_disk && ::fsync(file.id()) != 0) return failed(errno);
  if (const auto closed = file.close(); !closed) return closed;
  return (*temporary)->move_to(target.path);
}

FileOutcome check(const Target& target) {
  if (!target.direct) {
    const auto temporary = TemporaryFile::create(target.folder, 0600);
    return temporary ? FileOutcome() : std::unexpected(temporary.error());
  }
  // The reader of a pipe would take opening and closing as the end of the data.
  if (S_ISFIFO(target.status.st_mode)) {
    const bool allowed = ::faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) == 0;
    return allowed ? FileOutcome() : failed(errno);
  }
  OpenFile file(::open(target.path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  return file.id() >= 0 ? file.close() : failed(errno);
}

InputFile::Kind kind_of(int file, mode_t mode) {
  if (S_ISREG(mode)) return InputFile::Kind::regular;
  if (S_ISDIR(mode)) return InputFile::Kind::folder;
  if (S_ISBLK(mode)) return InputFile::Kind::device;
  if (!S_ISCHR(mode)) return InputFile::Kind::pipe;
  return ::isatty(file) ? InputFile::Kind::terminal : InputFile::Kind::device;
}

/// Reads from `start` on all threads; returns the length of the contiguous part read. If a read
/// fails or ends early (the file was truncated meanwhile), it stops without an error: the next read
/// reports it.
size_t read_chunks(int file, size_t start, char* to, size_t chunks, size_t chunk_size) {
  std::vector<size_t> read(chunks, 0);
  parallel_for(chunks, [&](size_t i) {
    while (read[i] < chunk_size) {
      const size_t at = i * chunk_size + read[i];
      const ssize_t got = ::pread(file, to + at, chunk_size - read[i], off_t(start + at));
      if (got <= 0) break;
      read[i] += size_t(got);
    }
  });
  const auto cut = std::ranges::find_if(read, [&](size_t got) { return got < chunk_size; });
  return std::accumulate(read.begin(), cut == read.end() ? cut : cut + 1, size_t(0));
}

}  // namespace

FileOutcome replace_file(const fs::path& path, std::string_view bytes, Until until) {
  const auto target = find_target(path);
  if (!target) return std::unexpected(target.error());
  return target->direct ? write_directly(*target, bytes) : replace(*target, bytes, until);
}

FileOutcome check_replaceable(const fs::path& path) {
  const auto target = find_target(path);
  return target ? check(*target) : std::unexpected(target.error());
}

FileOutcome write_standard_output(std::string_view bytes) {
  return write_all(STDOUT_FILENO, bytes);
}

FileOutcome check_standard_output() {
  const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
  if (flags < 0) return failed(errno);
  return (flags & O_ACCMODE) != O_RDONLY ? FileOutcome() : failed(EBADF);
}

struct InputFile::Handle {
  OpenFile file;
  size_t at, left;  // position in a regular file, and bytes to read on all threads
};

InputFile::InputFile(Handle handle, Kind kind, size_t rest)
    : handle_(std::make_unique<Handle>(std::move(handle))), kind_(kind), rest_(rest) {}
InputFile::InputFile(InputFile&&) noexcept = default;
InputFile& InputFile::operator=(InputFile&&) noexcept = default;
InputFile::~InputFile() = default;

std::expected<InputFile, std::string> InputFile::open(const fs::path& path) {
  OpenFile file(path == "/dev/stdin" ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                                     : ::open(path.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC));
  struct stat status{};
  if (file.id() < 0 || ::fstat(file.id(), &status) != 0) return failed(errno);
  const Kind kind = kind_of(file.id(), status.st_mode);
  size_t at = 0, rest = 0;
  if (kind == Kind::regular) {
    at = size_t(std::max<off_t>(0, ::lseek(file.id(), 0, SEEK_CUR)));
    rest = size_t(status.st_size) - std::min(at, size_t(status.st_size));
  }
  return InputFile({std::move(file), at, rest}, kind, rest);
}

std::expected<size_t, std::string> InputFile::read(char* to, size_t bytes) {
  constexpr size_t kChunk = size_t(1) << 21;
  const int file = handle_->file.id();
  if (const size_t chunks = std::min(bytes, handle_->left) / kChunk; chunks > 0) {
    const size_t got = read_chunks(file, handle_->at, to, chunks, kChunk);
    handle_->at += got;
    handle_->left = 0;  // read the rest in order: it is small, or the file has changed
    if (got > 0 && ::lseek(file, off_t(handle_->at), SEEK_SET) >= 0) return got;
  }
  for (;;) {
    const ssize_t got = ::read(file, to, bytes);
    if (got >= 0) return size_t(got);
    if (errno != EINTR) return failed(errno);
  }
}

}  // namespace raio::core
