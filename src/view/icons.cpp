#include "view/icons.h"

#include <algorithm>
#include <initializer_list>
#include <numbers>
#include <utility>

namespace raio::core::view {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

// Draws in a square from (-1, -1) at the upper left to (1, 1).
struct Pen {
  ImDrawList& draw;
  ImVec2 center;
  float half;
  ImU32 color;
  float width;

  using Point = std::pair<float, float>;
  ImVec2 at(Point p) const { return {center.x + p.first * half, center.y + p.second * half}; }

  void line(std::initializer_list<Point> points, bool closed = false) const {
    draw.PathClear();
    for (const Point& p : points) draw.PathLineTo(at(p));
    draw.PathStroke(color, closed ? ImDrawFlags_Closed : 0, width);
  }
  void area(std::initializer_list<Point> points) const {
    draw.PathClear();
    for (const Point& p : points) draw.PathLineTo(at(p));
    draw.PathFillConvex(color);
  }
  void circle(Point p, float radius) const {
    draw.AddCircle(at(p), radius * half, color, 0, width);
  }
  void disc(Point p, float radius) const { draw.AddCircleFilled(at(p), radius * half, color); }
  // From angle a to b, in turns, clockwise from the right.
  void arc(Point p, float radius, float a, float b) const {
    draw.PathClear();
    draw.PathArcTo(at(p), radius * half, a * kTurn, b * kTurn);
    draw.PathStroke(color, 0, width);
  }
  void box(Point lo, Point hi) const {
    draw.AddRect(at(lo), at(hi), color, 0.15f * half, 0, width);
  }
  void full_box(Point lo, Point hi) const {
    draw.AddRectFilled(at(lo), at(hi), color, 0.1f * half);
  }
};

void draw_effect(const Pen& pen, Icon icon) {
  switch (icon) {
    case Icon::antialiasing:  // a staircase and the edge that it approximates
      pen.line({{-0.9f, 0.8f},
                {-0.3f, 0.8f},
                {-0.3f, 0.25f},
                {0.3f, 0.25f},
                {0.3f, -0.3f},
                {0.9f, -0.3f}});
      return pen.line({{-0.9f, 0.25f}, {0.35f, -0.9f}});
    case Icon::soft_shadows:  // a ball over a fading shadow
      pen.disc({0, -0.3f}, 0.5f);
      pen.line({{-0.85f, 0.85f}, {0.85f, 0.85f}});
      return pen.line({{-0.5f, 0.5f}, {0.5f, 0.5f}});
    case Icon::depth_of_field:  // a lens and converging rays
      pen.arc({1.15f, 0}, 1.45f, 0.39f, 0.61f);
      pen.arc({-0.85f, 0}, 1.45f, -0.11f, 0.11f);
      pen.line({{-0.95f, -0.4f}, {0.15f, -0.4f}, {0.95f, 0}});
      return pen.line({{-0.95f, 0.4f}, {0.15f, 0.4f}, {0.95f, 0}});
    case Icon::reflection:  // a ray off a mirror
      pen.line({{-0.95f, 0.75f}, {0.95f, 0.75f}});
      pen.line({{-0.8f, -0.7f}, {0, 0.7f}, {0.75f, -0.6f}});
      return pen.line({{0.25f, -0.5f}, {0.8f, -0.75f}, {0.95f, -0.15f}});
    case Icon::refraction:  // a ray bent by glass
      pen.box({-0.9f, -0.05f}, {0.9f, 0.9f});
      return pen.line({{-0.7f, -0.95f}, {0, -0.05f}, {0.3f, 0.9f}});
    case Icon::gloss:  // a ray spread by a rough mirror
      pen.line({{-0.95f, 0.75f}, {0.95f, 0.75f}});
      pen.line({{-0.8f, -0.7f}, {0, 0.7f}});
      for (const float x : {0.3f, 0.65f, 0.95f}) pen.line({{0, 0.7f}, {x, x - 1.2f}});
      return;
    case Icon::translucency:  // a ray spread by rough glass
      pen.box({-0.9f, -0.05f}, {0.9f, 0.9f});
      pen.line({{-0.7f, -0.95f}, {0, -0.05f}});
      for (const float x : {0.05f, 0.3f, 0.55f}) pen.line({{0, -0.05f}, {x, 0.7f}});
      return;
    case Icon::motion:  // a ball and its previous positions
      pen.disc({0.45f, 0}, 0.45f);
      pen.line({{-0.95f, 0}, {-0.2f, 0}});
      pen.line({{-0.7f, -0.4f}, {-0.1f, -0.4f}});
      return pen.line({{-0.7f, 0.4f}, {-0.1f, 0.4f}});
    default:
      return;
  }
}

void draw_file(const Pen& pen, Icon icon) {
  switch (icon) {
    case Icon::open:
      return pen.line({{-0.9f, 0.75f},
                       {-0.9f, -0.7f},
                       {-0.3f, -0.7f},
                       {-0.05f, -0.4f},
                       {0.9f, -0.4f},
                       {0.9f, 0.75f}},
                      true);
    case Icon::save_scene:  // into a tray
      pen.line({{-0.85f, 0.3f}, {-0.85f, 0.85f}, {0.85f, 0.85f}, {0.85f, 0.3f}});
      pen.line({{0, -0.9f}, {0, 0.35f}});
      return pen.line({{-0.45f, -0.1f}, {0, 0.35f}, {0.45f, -0.1f}});
    case Icon::picture:
      pen.box({-0.9f, -0.75f}, {0.9f, 0.75f});
      pen.disc({0.4f, -0.3f}, 0.17f);
      return pen.line(
          {{-0.85f, 0.55f}, {-0.3f, -0.1f}, {0.1f, 0.35f}, {0.35f, 0.1f}, {0.85f, 0.55f}});
    case Icon::copy:
      pen.box({-0.85f, -0.9f}, {0.35f, 0.4f});
      return pen.line(
          {{0.55f, -0.4f}, {0.85f, -0.4f}, {0.85f, 0.9f}, {-0.35f, 0.9f}, {-0.35f, 0.6f}});
    default:
      return;
  }
}

void draw_scene(const Pen& pen, Icon icon) {
  switch (icon) {
    case Icon::undo:
    case Icon::redo: {
      const float s = icon == Icon::undo ? 1.0f : -1.0f;
      pen.line({{-0.35f * s, -0.85f}, {-0.8f * s, -0.35f}, {-0.35f * s, 0.15f}});
      pen.line({{-0.8f * s, -0.35f},
                {0.3f * s, -0.35f},
                {0.7f * s, -0.1f},
                {0.85f * s, 0.25f},
                {0.7f * s, 0.6f},
                {0.3f * s, 0.8f},
                {-0.3f * s, 0.8f}});
      return;
    }
    case Icon::structure:  // a tree
      pen.line({{0, -0.6f}, {-0.6f, 0.6f}});
      pen.line({{0, -0.6f}, {0.6f, 0.6f}});
      pen.disc({0, -0.65f}, 0.28f), pen.disc({-0.6f, 0.6f}, 0.28f), pen.disc({0.6f, 0.6f}, 0.28f);
      return;
    case Icon::fit:
      for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f})
          pen.line({{0.4f * x, 0.85f * y}, {0.85f * x, 0.85f * y}, {0.85f * x, 0.4f * y}});
      return pen.disc({0, 0}, 0.3f);
    case Icon::home:
      pen.line({{-0.95f, 0}, {0, -0.85f}, {0.95f, 0}});
      return pen.line({{-0.65f, -0.1f}, {-0.65f, 0.85f}, {0.65f, 0.85f}, {0.65f, -0.1f}});
    default:
      return;
  }
}

void draw_window_icon(const Pen& pen, Icon icon) {
  switch (icon) {
    case Icon::view:
      pen.line({{-0.95f, 0},
                {-0.5f, -0.45f},
                {0, -0.6f},
                {0.5f, -0.45f},
                {0.95f, 0},
                {0.5f, 0.45f},
                {0, 0.6f},
                {-0.5f, 0.45f}},
               true);
      return pen.disc({0, 0}, 0.28f);
    case Icon::split:
      pen.box({-0.9f, -0.75f}, {0.9f, 0.75f});
      return pen.full_box({0, -0.75f}, {0.9f, 0.75f});
    case Icon::boxes:  // nested
      pen.box({-0.85f, -0.85f}, {0.85f, 0.85f});
      pen.box({-0.55f, -0.1f}, {0.1f, 0.55f});
      return pen.box({0.25f, -0.6f}, {0.6f, -0.25f});
    case Icon::inspect:  // a ray under a magnifying glass
      pen.circle({-0.2f, -0.2f}, 0.65f);
      pen.line({{0.28f, 0.28f}, {0.9f, 0.9f}});
      return pen.line({{-0.55f, -0.45f}, {-0.2f, 0.1f}, {0.15f, -0.45f}});
    case Icon::pause:
      pen.full_box({-0.6f, -0.75f}, {-0.2f, 0.75f});
      return pen.full_box({0.2f, -0.75f}, {0.6f, 0.75f});
    case Icon::play:
      return pen.area({{-0.5f, -0.8f}, {0.8f, 0}, {-0.5f, 0.8f}});
    case Icon::theme:
      pen.circle({0, 0}, 0.8f);
      pen.draw.PathClear();
      pen.draw.PathArcTo(pen.center, 0.8f * pen.half, -kTurn / 4, kTurn / 4);
      return pen.draw.PathFillConvex(pen.color);
    case Icon::full_screen:
      pen.line({{0.2f, -0.85f}, {0.85f, -0.85f}, {0.85f, -0.2f}});
      pen.line({{-0.2f, 0.85f}, {-0.85f, 0.85f}, {-0.85f, 0.2f}});
      pen.line({{0.2f, -0.2f}, {0.85f, -0.85f}});
      return pen.line({{-0.2f, 0.2f}, {-0.85f, 0.85f}});
    case Icon::panel:
      pen.box({-0.9f, -0.75f}, {0.9f, 0.75f});
      return pen.line({{0.25f, -0.75f}, {0.25f, 0.75f}});
    case Icon::help:
      pen.circle({0, 0}, 0.9f);
      pen.arc({0, -0.2f}, 0.32f, -0.5f, 0.1f);
      pen.line({{0.25f, -0.02f}, {0, 0.2f}, {0, 0.32f}});
      return pen.disc({0, 0.58f}, 0.11f);
    case Icon::more:
      for (const float x : {-0.65f, 0.0f, 0.65f}) pen.disc({x, 0}, 0.17f);
      return;
    default:
      return;
  }
}

}  // namespace

void draw_icon(ImDrawList& draw, Icon icon, ImVec2 center, float size, ImU32 color) {
  const Pen pen{draw, center, size / 2, color, std::max(1.0f, size / 11)};
  draw_effect(pen, icon);
  draw_file(pen, icon);
  draw_scene(pen, icon);
  draw_window_icon(pen, icon);
}

}  // namespace raio::core::view
