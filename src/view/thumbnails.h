// Small pictures of scene files, for the start page: rendered in the background, kept in memory.
#pragma once

#include <expected>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <vector>

#include "base/executor.h"
#include "io/image/image.h"

namespace raio::core::view {

struct Thumbnail {
  Image image;            // as shown, 240 x 160 pixels
  size_t primitives = 0;  // of the scene
  std::string about;      // the comment at the head of the file; may be empty
};

/// Reads a scene and renders it with few samples. The error is one line; a file of more than 16 MB
/// gets no picture, since reading it takes long.
std::expected<Thumbnail, std::string> make_thumbnail(const std::string& path);

class Thumbnails {
 public:
  struct Made {
    std::string path;
    std::expected<Thumbnail, std::string> thumbnail;
  };

  /// Makes them one after the other, on half of the cores. `on_made` is called from another thread.
  Thumbnails(std::vector<std::string> paths, std::function<void()> on_made);
  ~Thumbnails() { control_.stop = true; }  // the future waits

  /// Those made since the last call.
  std::vector<Made> take();

 private:
  WorkControl control_;
  std::mutex mutex_;
  std::vector<Made> made_;  // guarded by it
  std::future<void> work_;
};

}  // namespace raio::core::view
