// A window with OpenGL and Dear ImGui, and its events.
#pragma once

#include <array>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "view/events.h"
#include "view/theme.h"

struct GLFWwindow;

namespace raio::core::view {

class Window {
 public:
  /// With room for a picture of this size, and for the panel and the bars around it; 0: of the size
  /// in window units, or most of the screen if that is 0, too. The error is one line that says what
  /// to do instead.
  static std::expected<std::unique_ptr<Window>, std::string> open(std::array<int, 2> picture,
                                                                  std::array<int, 2> size,
                                                                  const Theme& look);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Turns input into events. A key typed into a field only gives a Refresh, except Escape and
  /// function keys.
  void listen(std::function<void(const Event&)> listener) { listener_ = std::move(listener); }

  /// Handles events; waits for them up to this many seconds.
  static void wait_events(double seconds);
  /// Ends a wait. Called from any thread that ends before the window; does nothing without a
  /// window.
  static void wake();

  bool should_close() const;
  void close();
  bool is_hidden() const;  // minimised, or without area
  bool is_held(int key) const;
  static bool is_typing();         // into a field, after the last frame
  static bool is_over_controls();  // the cursor, in the last frame
  static bool is_busy();           // a control is held

  double width() const;
  double height() const;
  float pixels_per_unit() const;  // of window coordinates

  void set_look(const Theme& look);  // from the next frame
  const Theme& look() const { return look_; }
  bool is_full_screen() const;
  void set_full_screen(bool on);

  void set_title(const std::string& title);
  void set_clipboard(const std::string& text);

  void begin_frame();
  void end_frame();

  static double seconds();  // since the program started

 private:
  explicit Window(GLFWwindow* window);
  void set_callbacks();
  static Window& of(GLFWwindow* window);
  static void tell(GLFWwindow* window, const Event& event);

  GLFWwindow* window_;
  std::function<void(const Event&)> listener_;
  float text_scale_ = 1;
  Theme look_;
  bool has_new_look_ = false;
  std::vector<int> typed_;    // keys pressed since the last frame
  std::vector<int> clicked_;  // buttons, likewise
  // After a click until the next frame, which shows whether it was into a field: keys wait.
  bool has_clicked_ = false;
  std::vector<event::KeyPressed> waiting_;
  int left_ = 0, top_ = 0;  // position before full screen, and the size
  int last_width_ = 0, last_height_ = 0;
  std::string title_;
};

}  // namespace raio::core::view
