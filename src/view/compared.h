// A picture of another program, such as a student's, beside the window's own: A is Raio's, B the
// other one.
#pragma once

#include <atomic>
#include <expected>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/executor.h"
#include "io/image/image.h"
#include "render/regions.h"
#include "render/session.h"
#include "view/files.h"
#include "view/state.h"

namespace raio::core::view {

/// Reads the picture whenever its file changes.
class ComparedFile {
 public:
  struct Read {
    std::string path;
    std::expected<std::shared_ptr<const ComparedPicture>, Error> picture;
  };

  /// Reads a picture, and follows its file from then on.
  void open(std::string path);
  /// Follows a file that was just read.
  void follow(std::string path) { watch_.emplace(std::move(path)); }
  void close() { watch_.reset(), is_new_ = false; }
  /// The result of reading, once.
  std::optional<Read> poll();

 private:
  std::optional<FileWatch> watch_;
  bool is_new_ = false;  // not read yet
  std::future<Read> reading_;
};

/// How B differs from A.
struct Difference {
  std::shared_ptr<const SessionPicture> of;  // A
  ImageDifference whole;
  RegionDifferences regions;
  Image image;  // difference_image() of `io/image/image.h`
};

/// Compares pictures of equal size in the background, one pair at a time.
class Comparer {
 public:
  /// `on_end` is called from another thread.
  explicit Comparer(std::function<void()> on_end) : on_end_(std::move(on_end)) {}
  ~Comparer() { control_.stop = true; }  // the future waits

  /// Does nothing while an earlier comparison runs, or if this one has been made or makes no sense.
  void start(std::shared_ptr<const SessionPicture> a, std::shared_ptr<const ComparedPicture> b);
  std::optional<Difference> poll();

 private:
  std::function<void()> on_end_;
  WorkControl control_;
  std::shared_ptr<const SessionPicture> a_;  // compared last
  std::shared_ptr<const ComparedPicture> b_;
  // The regions of a request are the same for all of its samples.
  uint64_t request_ = 0;
  std::shared_ptr<const std::vector<Region>> regions_;
  std::future<std::pair<Difference, std::shared_ptr<const std::vector<Region>>>> running_;
};

}  // namespace raio::core::view
