// Scene files that are read and pictures that are written while the window goes on.
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
#include "io/diagnostics.h"
#include "io/image/image.h"
#include "io/read_scene.h"
#include "render/session.h"
#include "scene/scene.h"

namespace raio::view {

/// Reads a scene's file again whenever it has changed, and other files when told to.
class SceneFile {
 public:
  struct Read {
    std::string path;
    std::expected<std::shared_ptr<const Scene>, Diagnostics> scene;
    std::vector<std::string> warnings;  // of a scene, one line each
  };

  /// `path` has just been read, and is read with these options again.
  SceneFile(std::string path, ReadOptions options);

  /// Reads another file, and follows it from then on if it is a scene.
  void open(std::string path);

  /// Of the file: where dialogs begin.
  std::filesystem::path folder() const {
    const auto parent = std::filesystem::path(path_).parent_path();
    return parent.empty() ? "." : parent;
  }
  /// Follows a file that was just written.
  void follow(std::string path);

  /// What was read meanwhile, once. Looks at the disk a few times a second, however often called;
  /// what is there to be read is read on so many threads (0: as many as there are).
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

  /// `command`: what `raio render` would be told for it.
  void write(std::shared_ptr<const Image> image, std::string path, Metadata metadata,
             std::string command);
  /// Any other file, whose bytes `make` gives; its error is one line.
  void write(std::function<std::expected<std::string, std::string>()> make, std::string path,
             std::string command);
  std::optional<Written> poll();

 private:
  std::vector<std::future<Written>> writing_;
};

/// What the reader said of the scene's file, and what would disappoint in the picture as it is now
/// (render/warnings.h).
class Warnings {
 public:
  Warnings() = default;
  explicit Warnings(std::vector<std::string> of_file) : of_file_(std::move(of_file)) {}

  /// Looks at the first whole picture of each request. Whether it did.
  bool find(const Scene& scene, const SessionPicture& picture);
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> of_file_, lines_;
  uint64_t request_ = 0;
};

/// As short as it can be written here: relative to where the program was started, if below that.
std::string short_path(const std::string& path);

/// "NAME.png", or "NAME-2.png" and so on: the first that there is not.
std::string free_name(const std::string& name, const std::string& suffix);

}  // namespace raio::view
