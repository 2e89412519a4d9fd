#include "view/comparison.h"

#include <fmt/format.h>

#include <utility>

#include "app/terminal.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

bool has_time(const SessionPicture& picture, uint64_t request) {
  return picture.request == request && picture.samples > 0 && picture.sample_s.median > 0;
}

}  // namespace

std::string text_of_spread(const MedianInterval& interval) {
  const double percent = 100 * interval.half_width();
  return percent < 0.5 ? "" : fmt::format(" ±{:.0f}%", percent);
}

std::string text_of_seconds(const MedianInterval& seconds) {
  // A single run has no known spread.
  const char* const about = seconds.low == seconds.high ? "~" : "";
  return about + app::human_seconds(seconds.median) + text_of_spread(seconds);
}

std::string Comparison::begin(std::string what, const SessionPicture* before, uint64_t request) {
  what_ = std::move(what);
  before_s_.reset();
  if (before && has_time(*before, request)) {
    before_s_ = before->sample_s;
    width_ = before->settings.width, height_ = before->settings.height;
  }
  return trf("{}: waiting for a whole sample", what_);
}

std::optional<std::string> Comparison::take(const SessionPicture& picture, uint64_t request) {
  if (what_.empty() || !has_time(picture, request)) return std::nullopt;
  const bool same_size = picture.settings.width == width_ && picture.settings.height == height_;
  const std::string before = !before_s_   ? tr("no whole sample before")
                             : !same_size ? tr("different size before")
                                          : trf("before {}", text_of_seconds(*before_s_));
  return trf("{}: {} per sample, {}", std::exchange(what_, {}), text_of_seconds(picture.sample_s),
             before);
}

}  // namespace raio::core::view
