// Camera movements by mouse and held keys. No window: it is told where the cursor is.
#pragma once

#include <functional>

#include "view/stage.h"
#include "view/state.h"

namespace raio::core::view {

class Gestures {
 public:
  enum class Button { left, right, middle };  // in GLFW's order
  /// What the picture shows at a window position.
  using PickAt = std::function<Pick(double x, double y)>;

  Gestures(ViewState& state, const Stage& stage, PickAt pick)
      : state_(state), stage_(stage), pick_(std::move(pick)) {}

  double split_at = 0.5;  // position of the bar between two pictures, 0 to 1

  double x() const { return x_; }
  double y() const { return y_; }
  bool is_looking() const { return drag_ == Drag::look; }
  bool is_busy() const { return drag_ != Drag::none; }

  /// `selects`: with Shift, the left button selects a region instead of dragging the scene.
  void press(Button button, bool shift, bool selects = false);
  /// A click is pressed and released at one position.
  enum class Done { nothing, click, shift_click, region };
  Done release(Button button);
  bool is_selecting() const { return drag_ == Drag::select && travelled_ > 0; }
  /// Where the button was pressed.
  double from_x() const { return from_x_; }
  double from_y() const { return from_y_; }
  /// Returns whether the camera has changed.
  bool move(double x, double y);
  /// The wheel: towards the point under the cursor, or away. Returns whether the camera has
  /// changed.
  bool dolly(double steps);
  bool walk(const Steps& steps, double seconds);

 private:
  enum class Drag { none, orbit, pan, look, bar, select };

  void begin(bool shift);
  void pan(double right, double up);  // in picture heights
  Camera shown_camera() const;

  ViewState& state_;
  const Stage& stage_;
  PickAt pick_;
  Drag drag_ = Drag::none;
  Button button_ = Button::left;
  double x_ = 0, y_ = 0, from_x_ = 0, from_y_ = 0, travelled_ = 0;
  Vec3d pivot_;
  double depth_ = 1;
};

}  // namespace raio::core::view
