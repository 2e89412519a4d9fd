#include "view/gestures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/exact_math.h"
#include "view/camera_control.h"

namespace raio::core::view {
namespace {

constexpr double kClickTravel = 4;   // window units that a click may move
constexpr double kBarReach = 6;      // distance at which the bar can be grabbed
constexpr double kHalfTurn = 400;    // least distance of a drag that turns by 180 degrees
constexpr double kWheelStep = 0.88;  // factor of the remaining distance
constexpr double kReach = 1.5;       // of dragging, relative to the distance of the point looked at
constexpr double kWalkPerSecond = 0.7;  // relative to the distance of the point looked at

double view_distance(const Camera& camera) { return length(Vec3d(camera.at) - Vec3d(camera.from)); }

}  // namespace

void Gestures::press(Button button, bool shift, bool selects) {
  if (drag_ != Drag::none || !stage_.contains(x_, y_)) return;
  button_ = button, travelled_ = 0;
  from_x_ = x_, from_y_ = y_;
  const double bar = stage_.lo.x + split_at * (stage_.hi.x - stage_.lo.x);
  if (button == Button::left && state_.has_bar() && std::abs(x_ - bar) <= kBarReach) {
    drag_ = Drag::bar;
    return;
  }
  if (button == Button::left && shift && selects) {
    drag_ = Drag::select;
    return;
  }
  const double distance = view_distance(state_.camera);
  if (const auto point = state_.turning_point()) {
    const double depth = dot(*point - Vec3d(state_.camera.from), CameraAxes(state_.camera).forward);
    pivot_ = *point, depth_ = depth > 0 ? depth : distance;
    return begin(shift);
  }
  const Pick under = pick_(x_, y_);
  // Points far behind the point looked at, such as ground at the horizon, would fling the scene
  // away: then dragging uses the point looked at.
  const bool is_near = under.hit.found() && under.depth <= kReach * distance;
  pivot_ = is_near ? under.point : Vec3d(state_.camera.at);
  depth_ = is_near ? under.depth : distance;
  begin(shift);
}

void Gestures::begin(bool shift) {
  drag_ = button_ == Button::right             ? Drag::look
          : button_ == Button::middle || shift ? Drag::pan
                                               : Drag::orbit;
}

Gestures::Done Gestures::release(Button button) {
  if (drag_ == Drag::none || button != button_) return Done::nothing;
  const Drag drag = std::exchange(drag_, Drag::none);
  if (travelled_ > kClickTravel) return drag == Drag::select ? Done::region : Done::nothing;
  if (drag == Drag::orbit) return Done::click;
  const bool with_shift = drag == Drag::select || (drag == Drag::pan && button == Button::left);
  return with_shift ? Done::shift_click : Done::nothing;
}

bool Gestures::move(double x, double y) {
  const double height = std::max(1.0f, stage_.hi.y - stage_.lo.y);
  const double dx = (x - x_) / height, dy = (y - y_) / height;
  travelled_ += exact_hypot(x - x_, y - y_);
  x_ = x, y_ = y;
  if (drag_ == Drag::none || travelled_ <= kClickTravel) return false;
  Camera& camera = state_.camera;
  const double view_rad = double(shown_camera().fov_deg) * std::numbers::pi / 180;
  // Over the height of the picture, unless that is small.
  const double half_turn = std::numbers::pi * std::min(1.0, height / kHalfTurn);
  switch (drag_) {
    case Drag::orbit:
      camera = orbited(camera, pivot_, -dx * half_turn, dy * half_turn);
      state_.follow_focus();
      return true;
    case Drag::pan:
      pan(dx, -dy);
      return true;
    case Drag::look:
      camera = looked(camera, dx * view_rad, -dy * view_rad);
      state_.follow_focus();
      return true;
    case Drag::bar:
      split_at = std::clamp(stage_.across(x), 0.0, 1.0);
      return false;
    case Drag::select:
    case Drag::none:
      break;
  }
  return false;
}

Camera Gestures::shown_camera() const {
  return state_.edge_to_edge(stage_.picture_width, stage_.picture_height);
}

void Gestures::pan(double right, double up) {
  const Camera moved = panned(shown_camera(), depth_, right, up);
  state_.camera.from = moved.from, state_.camera.at = moved.at;
  state_.follow_focus();
}

bool Gestures::dolly(double steps) {
  if (!stage_.contains(x_, y_) || steps == 0) return false;
  const Pick under = pick_(x_, y_);
  const Camera& camera = state_.camera;
  // If nothing is hit: towards a point at the distance of the point looked at.
  const CameraAxes axes(camera);
  const double distance = view_distance(camera);
  const double tangent = exact_tan(double(shown_camera().fov_deg) * std::numbers::pi / 360);
  const Vec3d direction = axes.forward +
                          axes.right * ((2 * stage_.across(x_) - 1) * tangent * stage_.aspect()) +
                          axes.up * ((1 - 2 * stage_.down(y_)) * tangent);
  const Vec3d target = under.hit.found() ? under.point : Vec3d(camera.from) + direction * distance;
  state_.camera = dollied(camera, target, exact_pow(kWheelStep, steps));
  state_.follow_focus();
  return true;
}

bool Gestures::walk(const Steps& steps, double seconds) {
  if (!steps.any()) return false;
  const double far = view_distance(state_.camera) * kWalkPerSecond * std::min(seconds, 0.1);
  state_.camera = walked(state_.camera, steps.right * far, steps.up * far, steps.forward * far);
  state_.follow_focus();
  return true;
}

}  // namespace raio::core::view
