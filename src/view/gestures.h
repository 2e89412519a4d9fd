// What the mouse and held keys do to the camera. No window in it: it is told where the cursor is.
#pragma once

#include <functional>

#include "view/stage.h"
#include "view/state.h"

namespace raio::view {

class Gestures {
 public:
  enum class Button { left, right, middle };  // in GLFW's order
  /// What is in the picture at a place of the window.
  using PickAt = std::function<Pick(double x, double y)>;

  Gestures(ViewState& state, const Stage& stage, PickAt pick)
      : state_(state), stage_(stage), pick_(std::move(pick)) {}

  double split_at = 0.5;  // where the bar between two pictures is, 0 to 1

  double x() const { return x_; }
  double y() const { return y_; }
  bool is_looking() const { return drag_ == Drag::look; }
  bool is_busy() const { return drag_ != Drag::none; }

  void press(Button button, bool shift);
  /// Whether it was a click: pressed and released at one place.
  bool release(Button button);
  /// Whether the camera has changed.
  bool move(double x, double y);
  /// The wheel: towards what is under the cursor, or away from it. Whether the camera has changed.
  bool dolly(double steps);
  bool walk(const Steps& steps, double seconds);

 private:
  enum class Drag { none, orbit, pan, look, bar };

  ViewState& state_;
  const Stage& stage_;
  PickAt pick_;
  Drag drag_ = Drag::none;
  Button button_ = Button::left;
  double x_ = 0, y_ = 0, travelled_ = 0;
  Vec3d pivot_;
  double depth_ = 1;
};

}  // namespace raio::view
