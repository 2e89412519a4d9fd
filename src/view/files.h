// Reads scene files and writes pictures in the background.
#pragma once

#include <chrono>
#include <expected>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/executor.h"
#include "io/diagnostics.h"
#include "io/image/image.h"
#include "io/read_scene.h"
#include "io/scene_file.h"
#include "render/job.h"
#include "render/picture.h"
#include "render/session.h"
#include "scene/scene.h"
#include "view/state.h"

namespace raio::core::view {

/// Whether it has a result that was not taken yet.
template <class T>
bool is_ready(const std::future<T>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// Notices changes of a file; looks a few times per second, however often it is asked.
class FileWatch {
 public:
  /// The file has just been read, or is about to be.
  explicit FileWatch(std::string path);

  enum class Seen { nothing, changed, gone };
  /// A change once it is complete; a file that is gone, once.
  Seen look();
  const std::string& path() const { return path_; }

 private:
  using Stamp = std::pair<std::filesystem::file_time_type, uintmax_t>;
  static Stamp stamp(const std::string& path);

  std::string path_;
  Stamp read_, seen_;
  Clock::time_point next_look_;
};

/// Rereads a scene's file when it changes or returns, reports once that it is gone, and reads it
/// with other options and other files on request.
class SceneFile {
 public:
  struct Read {
    std::string path;
    std::expected<std::shared_ptr<const Scene>, Diagnostics> scene;  // that of `file`
    std::vector<std::string> warnings;                               // of a scene, one line each
    // NOLINTBEGIN(readability-redundant-member-init): so that some can be omitted
    ReadOptions options = kForWindow;
    std::shared_ptr<const ReadScene> file = {};
    // NOLINTEND(readability-redundant-member-init)
    bool is_reread = false;  // by reread()
  };

  /// `path` has just been read.
  explicit SceneFile(std::string path) : watch_(std::move(path)) {}
  ~SceneFile() { control_.stop = true; }

  /// Reads another file, and follows it from then on if it is a scene.
  void open(std::string path, const ReadOptions& options = kForWindow) {
    waiting_ = {std::move(path), options};
  }
  /// Reads the same file with other options, instead of those requested before.
  void reread(const ReadOptions& options) { waiting_ = {watch_.path(), options, true}; }

  /// The file's folder: where dialogs start.
  std::filesystem::path folder() const {
    const auto parent = std::filesystem::path(watch_.path()).parent_path();
    return parent.empty() ? "." : parent;
  }
  /// Follows a file that was just written.
  void follow(std::string path);

  /// The result of reading, once. Checks the disk a few times per second, however often it is
  /// called; reads with this many threads (0: all), and a file that has changed with these options.
  std::optional<Read> poll(int threads, const ReadOptions& options);

 private:
  struct Work {
    std::string path;
    ReadOptions options;
    bool is_reread = false;
  };
  void start(Work work, int threads);

  FileWatch watch_;
  std::optional<Work> waiting_;
  std::shared_ptr<SceneFrames> frames_;  // of the watched file, if it has several
  WorkControl control_;
  std::future<std::pair<Read, std::shared_ptr<SceneFrames>>> reading_;
};

/// Writes pictures.
class PictureWriter {
 public:
  struct Written {
    std::string path, command;
    std::expected<void, Error> result;
  };

  ~PictureWriter();

  /// `command`: the equivalent arguments of `raio render`.
  void write(std::shared_ptr<const Image> image, std::string path, Metadata metadata,
             std::string command, Overlay overlay = {});
  /// Any other file, with bytes from `make`; its error is one line.
  void write(std::function<std::expected<std::string, std::string>()> make, std::string path,
             std::string command);
  std::optional<Written> poll();

 private:
  std::vector<std::future<Written>> writing_;
};

/// Renders a picture of its own and writes it, as `raio render` does.
class PrintJob {
 public:
  /// `on_end` is called from the job's thread.
  explicit PrintJob(std::function<void()> on_end) : on_end_(std::move(on_end)) {}
  ~PrintJob() { stop(); }

  /// Only if not is_busy(). `command`: the equivalent arguments of `raio render`.
  void start(JobRequest request, std::string command);
  void stop() { control_.stop = true; }
  bool is_busy() const { return running_.valid(); }
  /// The share of the work done, 0 to 1.
  double share() const;
  std::optional<PictureWriter::Written> poll();

 private:
  std::function<void()> on_end_;
  WorkControl control_;
  std::future<PictureWriter::Written> running_;  // awaited at destruction
};

/// The reader's warnings about the scene's file, and those about the current picture
/// (render/warnings.h).
class Warnings {
 public:
  Warnings() = default;
  explicit Warnings(std::vector<std::string> of_file)
      : of_file_(std::move(of_file)), lines_(of_file_) {}

  /// Checks the first whole picture of each request; returns whether it did.
  bool find(const Scene& scene, const SessionPicture& picture);
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> of_file_, lines_;
  uint64_t request_ = 0;
};

/// The shortest form: relative to the working folder if below it.
std::string short_path(const std::string& path);

/// "NAME.png", or "NAME-2.png" and so on: the first that does not exist.
std::string free_name(const std::string& name, const std::string& suffix);

}  // namespace raio::core::view
