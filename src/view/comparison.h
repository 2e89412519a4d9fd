// The effect of a key on the time per sample. Compares whole samples of the same size; until there
// are some, reports that it waits.
#pragma once

#include <optional>
#include <string>

#include "render/session.h"

namespace raio::core::view {

class Comparison {
 public:
  /// Starts after a key has done `what` ("soft shadows on"). `before` is the current picture, of
  /// the newest request `request` or older; may be null. Returns a line to display.
  std::string begin(std::string what, const SessionPicture* before, uint64_t request);

  /// The line with the times, once, when a picture of `request` has them.
  std::optional<std::string> take(const SessionPicture& picture, uint64_t request);

  /// Another change makes the times incomparable.
  void end() { what_.clear(); }

 private:
  std::string what_;  // empty: waiting for nothing
  std::optional<MedianInterval> before_s_;
  int width_ = 0, height_ = 0;
};

/// "28.6 ms", with the half width of the interval: "28.6 ms ±5%".
std::string text_of_seconds(const MedianInterval& seconds);

/// " ±5%", or nothing below half a per cent.
std::string text_of_spread(const MedianInterval& interval);

}  // namespace raio::core::view
