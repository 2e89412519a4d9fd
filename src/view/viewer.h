// The window's program: user input changes a state, the state becomes requests, and the sessions'
// pictures are shown.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands.h"
#include "render/session.h"
#include "view/camera_control.h"
#include "view/comparison.h"
#include "view/controls.h"
#include "view/edit.h"
#include "view/files.h"
#include "view/gestures.h"
#include "view/history.h"
#include "view/inspector.h"
#include "view/layout.h"
#include "view/legend.h"
#include "view/measure.h"
#include "view/memory.h"
#include "view/pictures.h"
#include "view/structure_overlay.h"
#include "view/window.h"

namespace raio::core::view {

class Viewer final : public WindowEvents {
 public:
  /// `session` already has `first_request`, which can be traced before the window opens.
  Viewer(Window& window, ViewState state, Memory memory, std::vector<std::string> warnings,
         bool logs, std::unique_ptr<Session> session, const RenderOptions& first_request);
  ~Viewer() override { window_.listen(nullptr); }

  void run();

  void key_pressed(int key, Modifiers held) override;
  void button(int number, bool down, bool shift) override;
  void cursor_moved(double x, double y) override;
  void scrolled(double steps, bool ctrl) override;
  void file_dropped(const std::string& path) override { file_.open(path); }
  void needs_drawing() override { drawings_ = 3; }  // the panel takes several to settle

 private:
  static double now() { return Window::seconds(); }

  void log(std::string_view event) const;
  // Reports an action, in the window's language.
  void say(std::string message, bool is_error = false);
  void complain(std::string message) { say(std::move(message), true); }

  // The newest picture's; null before the first.
  std::shared_ptr<const BakedScene> baked() const;
  bool is_moving() const { return now() < moving_until_; }
  bool shows_focus() const { return now() < focus_until_; }
  // For a while.
  void show_focus();
  // For the first sample of the request.
  bool is_waiting() const;
  Steps steps_held() const;

  // Updates the sessions' requests. Returns whether they are valid.
  bool renew();
  void renew_other(double frame_s);
  void camera_moved();

  void step();
  void take_results();
  void log_costs() const;
  bool take_picture(Side& side);
  void take_scene(const SceneFile::Read& read);
  void take_saved_scene(const SceneWriter::Written& written);
  void find_warnings();
  // Measurements need the whole machine: sessions rest, and the window draws in pauses made for it.
  void measure();
  // At rest, and after the picture itself.
  bool may_measure_costs() const;
  // Saves a picture identical to that of `raio render`: of the newest request, at rest, with
  // equally many samples in every pixel.
  void save_when_whole();

  // Commands, in viewer_commands.cpp.
  void obey(const KeySpec& key);
  void finish(Gestures::Done gesture);
  void switch_effect(Command effect);
  void switch_split();
  void switch_pause();
  void switch_panel();
  void switch_boxes();
  void switch_picking();
  void switch_look(bool Theme::* what);
  void switch_full_screen();
  // Measurements of costs, which start by themselves, give way to requested work.
  void switch_work(Measuring::Work work, const char* what);
  void move_camera(const Camera& camera, const char* what);
  void focus_on(const Pick& pick);
  void step_ray(Inspector::Walk where);
  void close_inspector();
  void copy_command();
  void ask_where_to_save();
  void save_scene(const std::string& path);
  void go_back(bool back);
  // What Escape closes before it ends the program.
  bool leave();
  std::string command_line(const std::string& output) const;

  // The screen, in viewer_drawing.cpp. In the layout, the picture has its initial size while the
  // window has its own, including the panel; otherwise it fills the available room.
  void lay_out();
  // The picture, at the cursor.
  bool is_covered() const;
  Pick pick_at(double x, double y) const;
  // What the picture shows at the cursor; nothing during movements.
  ReadOut under_cursor() const;
  void draw();
  void draw_inspector();
  void take_inspector(const InspectorResult& did);
  void take_controls(const ControlResult& result);
  // For a picture that takes long.
  std::optional<SessionProgress> progress() const;
  CostFacts cost_facts() const;
  ControlFacts control_facts(const std::string& under) const;
  void log_picture(Side& side, std::string_view name);

  Window& window_;
  const bool logs_;
  const Rect opened_;                     // the window's initial size
  const int first_width_, first_height_;  // the picture's
  Layout layout_;
  Stage stage_;
  ViewState state_;
  History<ViewState> history_;
  Controls controls_{sample_scenes()};
  SharedScene saved_scene_;  // as in the file
  MemoryKeeper keeper_;
  SceneFile file_;
  PictureWriter writer_;
  SceneWriter scene_writer_;
  Pictures pictures_;
  Warnings warnings_;
  Gestures gestures_;
  StructureOverlay overlay_;
  Inspector inspector_{[] { Window::wake(); }};
  std::string button_places_;  // as logged last
  Measuring measuring_{[] { Window::wake(); }};
  bool costs_are_old_ = true, wants_costs_ = false;
  Measuring::Work wanted_ = Measuring::Work::none;  // to be started
  bool is_holding_ = false;                         // the sessions, for a measurement
  Diagnostics errors_;

  int drawings_ = 3;  // remaining, even without a new picture
  double last_step_ = 0, last_draw_ = 0, moving_until_ = 0, focus_until_ = 0;
  bool moved_ = false;          // the newest request is part of a movement
  std::string waiting_option_;  // has no effect in this scene, as reported
  double requested_at_ = 0;
  Message message_;
  bool says_error_ = false, typing_ = false;  // into a field
  Comparison comparison_;
  std::string to_save_;
};

}  // namespace raio::core::view
