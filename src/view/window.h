// A window with OpenGL and Dear ImGui, and its events.
#pragma once

#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "view/keys.h"
#include "view/theme.h"

struct GLFWwindow;

namespace raio::core::view {

/// Receives input events. Positions are in window coordinates.
class WindowEvents {
 public:
  virtual ~WindowEvents() = default;
  virtual void key_pressed(int key, Modifiers held) = 0;
  virtual void button(int button, bool down, bool shift) = 0;
  virtual void cursor_moved(double x, double y) = 0;
  virtual void scrolled(double steps, bool ctrl) = 0;
  virtual void file_dropped(const std::string& path) = 0;
  virtual void needs_drawing() = 0;
};

class Window {
 public:
  /// With room for a picture of this size, and for the panel and the bars around it. The error is
  /// one line that says what to do instead.
  static std::expected<std::unique_ptr<Window>, std::string> open(int picture_width,
                                                                  int picture_height,
                                                                  const Theme& look);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void listen(WindowEvents* events) { events_ = events; }

  /// Handles events; waits for them up to this many seconds.
  static void wait_events(double seconds);
  /// Ends a wait. Called from any thread that ends before the window; does nothing without a
  /// window.
  static void wake();

  bool should_close() const;
  void close();
  bool is_hidden() const;  // minimised, or without area
  bool is_held(int key) const;
  static bool is_typing();         // into a field
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

  GLFWwindow* window_;
  WindowEvents* events_ = nullptr;
  float text_scale_ = 1;
  Theme look_;
  bool has_new_look_ = false;
  std::vector<int> typed_;  // keys pressed since the last frame
  int left_ = 0, top_ = 0;  // position before full screen, and the size
  int last_width_ = 0, last_height_ = 0;
  std::string title_;
};

}  // namespace raio::core::view
