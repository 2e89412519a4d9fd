// The layout of the window. Plain geometry in window units, tested without a window.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace raio::core::view {

struct Rect {
  float left = 0, top = 0, right = 0, bottom = 0;

  float width() const { return right - left; }
  float height() const { return bottom - top; }
  bool contains(double x, double y) const {
    return x >= left && x < right && y >= top && y < bottom;
  }
  friend bool operator==(const Rect&, const Rect&) = default;
};

inline constexpr float kToolBarEms = 2.8f, kStatusEms = 1.9f, kPanelEms = 21, kLessonEms = 27;
/// Of a window with the panel beside the picture: 700 units with the usual type.
inline constexpr float kLeastWidthEms = 140.0f / 3;

/// The tool bar at the top and the status line at the bottom span the window; a lesson is at the
/// left between them, the panel at the right; the picture has the rest. In a narrow window, lesson
/// and panel cover the sides of the picture. Their sizes depend only on the text height, so their
/// contents never move the picture. In a window that is too small, the picture keeps one unit.
struct Layout {
  Rect tool_bar, lesson, panel, status, picture;

  Layout() = default;
  Layout(float width, float height, float em, bool has_panel, bool has_lesson = false) {
    const float top = std::min(kToolBarEms * em, height / 2);
    const float bottom = std::max(height - kStatusEms * em, top + 1);
    const float left = std::max(width - kPanelEms * em, 1.0f);
    const float right = has_panel && is_panel_beside(width, em, has_lesson) ? left : width;
    const float text = has_lesson ? std::min(kLessonEms * em, width - 1) : 0;
    tool_bar = {0, 0, width, float(int(top))};
    status = {0, float(int(bottom)), width, height};
    const float begin = is_lesson_beside(width, em) ? text : 0;
    picture = {float(int(begin)), tool_bar.bottom, float(int(right)), status.top};
    lesson = {0, picture.top, float(int(text)), picture.bottom};
    panel = {has_panel ? float(int(left)) : width, picture.top, width, picture.bottom};
  }

  static bool is_lesson_beside(float width, float em) { return width >= kLeastWidthEms * em; }
  /// Of the same window; there need not be a panel.
  static bool is_panel_beside(float width, float em, bool has_lesson) {
    return width - (has_lesson ? kLessonEms * em : 0) >= kLeastWidthEms * em;
  }
};

/// The number of tools of these widths, from the first, that fit in a bar. If not all fit, leaves
/// room for one more tool, which offers the others.
inline size_t tools_that_fit(std::span<const float> widths, float available, float more) {
  float used = 0;
  size_t fit = 0, with_more = 0;
  for (const float width : widths) {
    used += width;
    if (used > available) return with_more;
    ++fit;
    if (used + more <= available) with_more = fit;
  }
  return fit;
}

}  // namespace raio::core::view
