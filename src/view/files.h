// Reads scene files and writes pictures in the background.
#pragma once

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
#include "render/session.h"
#include "scene/scene.h"

namespace raio::core::view {

/// Rereads a scene's file when it changes or returns, reports once that it is gone, and reads other
/// files on request.
class SceneFile {
 public:
  struct Read {
    std::string path;
    std::expected<std::shared_ptr<const Scene>, Diagnostics> scene;
    std::vector<std::string> warnings;  // of a scene, one line each
  };

  /// `path` has just been read; it is reread with these options.
  SceneFile(std::string path, ReadOptions options);
  ~SceneFile() { control_.stop = true; }

  /// Reads another file, and follows it from then on if it is a scene.
  void open(std::string path);

  /// The file's folder: where dialogs start.
  std::filesystem::path folder() const {
    const auto parent = std::filesystem::path(path_).parent_path();
    return parent.empty() ? "." : parent;
  }
  /// Follows a file that was just written.
  void follow(std::string path);

  /// The result of reading, once. Checks the disk a few times per second, however often it is
  /// called; reads with this many threads (0: all).
  std::optional<Read> poll(int threads);

 private:
  using Stamp = std::pair<std::filesystem::file_time_type, uintmax_t>;
  static Stamp stamp(const std::string& path);
  void start(std::string path, int threads);

  std::string path_;
  ReadOptions options_;  // of `path_`
  Stamp read_, seen_;
  Clock::time_point next_look_;
  std::optional<std::string> waiting_;
  WorkControl control_;
  std::future<Read> reading_;
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
             std::string command);
  /// Any other file, with bytes from `make`; its error is one line.
  void write(std::function<std::expected<std::string, std::string>()> make, std::string path,
             std::string command);
  std::optional<Written> poll();

 private:
  std::vector<std::future<Written>> writing_;
};

/// The reader's warnings about the scene's file, and those about the current picture
/// (render/warnings.h).
class Warnings {
 public:
  Warnings() = default;
  explicit Warnings(std::vector<std::string> of_file) : of_file_(std::move(of_file)) {}

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
