// What a key changed in the time that a sample takes: whole samples of the same size are compared,
// and before there are any it says that it waits.
#pragma once

#include <optional>
#include <string>

#include "render/session.h"

namespace raio::view {

class Comparison {
 public:
  /// A key has done `what` ("soft shadows on"). `before` is the picture at that moment, of the
  /// newest request `request` or older; may be null. Returns a line to be said.
  std::string begin(std::string what, const SessionPicture* before, uint64_t request);

  /// The line with the times, once, when there is a picture of `request` with them.
  std::optional<std::string> take(const SessionPicture& picture, uint64_t request);

  /// Something else has changed, too.
  void end() { what_.clear(); }

 private:
  std::string what_;  // empty: nothing is waited for
  std::optional<MedianInterval> before_s_;
  int width_ = 0, height_ = 0;
};

/// "28.6 ms", with the half width of the interval: "28.6 ms ±5%".
std::string text_of_seconds(const MedianInterval& seconds);

/// " ±5%", or nothing below half a per cent.
std::string text_of_spread(const MedianInterval& interval);

}  // namespace raio::view
