// The window's program: what hands do becomes a state, the state becomes requests, and the pictures
// that sessions make of them are shown.
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

namespace raio::view {

class Viewer final : public WindowEvents {
 public:
  /// `session` has got `first_request` already, whose rays need no window.
  Viewer(Window& window, ViewState state, Memory memory, std::vector<std::string> warnings,
         bool logs, std::unique_ptr<Session> session, const RenderOptions& first_request);
  ~Viewer() override { window_.listen(nullptr); }

  void run();

  void key_pressed(int key, Modifiers held) override;
  void button(int number, bool down, bool shift) override;
  void cursor_moved(double x, double y) override;
  void scrolled(double steps, bool ctrl) override;
  void file_dropped(const std::string& path) override { file_.open(path); }
  void needs_drawing() override { drawings_ = 3; }  // the panel takes some to settle

 private:
  static double now() { return Window::seconds(); }

  void log(std::string_view event) const;
  // What was done, in the language of the screen.
  void say(std::string message, bool is_error = false);
  void complain(std::string message) { say(std::move(message), true); }

  // That of the newest picture; null before the first.
  std::shared_ptr<const BakedScene> baked() const;
  bool is_moving() const { return now() < moving_until_; }
  bool shows_focus() const { return now() < focus_until_; }
  // For a while.
  void show_focus();
  // For the first sample of what was requested.
  bool is_waiting() const;
  Steps steps_held() const;

  // Tells the sessions what is wanted now. Whether it can be had.
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
  // Whoever measures wants the machine for themselves: sessions rest, and the window draws in
  // pauses that are left for it.
  void measure();
  // At rest, and after the picture itself.
  bool may_measure_costs() const;
  // What is saved is a picture that `raio render` makes: of the newest request, at rest, with as
  // many samples in every pixel.
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
  // The costs, which are measured unasked, make way for what is asked for.
  void switch_work(Measuring::Work work, const char* what);
  void move_camera(const Camera& camera, const char* what);
  void focus_on(const Pick& pick);
  void step_ray(Inspector::Walk where);
  void close_inspector();
  void copy_command();
  void ask_where_to_save();
  void save_scene(const std::string& path);
  void go_back(bool back);
  // What Escape ends before it ends the program.
  bool leave();
  std::string command_line(const std::string& output) const;

  // What is on the screen, in viewer_drawing.cpp.
  // Where things are in the window. The picture has the size that it was opened with while the
  // window is as it was opened, panel and all; else it fills the room that there is.
  void lay_out();
  // The picture, at the cursor.
  bool is_covered() const;
  Pick pick_at(double x, double y) const;
  // What the picture shows where the cursor is; nothing while something moves.
  ReadOut under_cursor() const;
  void draw();
  void draw_inspector();
  void take_inspector(const InspectorResult& did);
  void take_controls(const ControlResult& result);
  // Of a picture that keeps its viewer waiting.
  std::optional<SessionProgress> progress() const;
  CostFacts cost_facts() const;
  ControlFacts control_facts(const std::string& under) const;
  void log_picture(Side& side, std::string_view name);

  Window& window_;
  const bool logs_;
  const Rect opened_;                     // the window's size
  const int first_width_, first_height_;  // the picture's
  Layout layout_;
  Stage stage_;
  ViewState state_;
  History<ViewState> history_;
  Controls controls_{sample_scenes()};
  SharedScene saved_scene_;  // as the file has it
  MemoryKeeper keeper_;
  SceneFile file_;
  PictureWriter writer_;
  SceneWriter scene_writer_;
  Pictures pictures_;
  Warnings warnings_;
  Gestures gestures_;
  StructureOverlay overlay_;
  Inspector inspector_{[] { Window::wake(); }};
  std::string button_places_;  // as they were logged
  Measuring measuring_{[] { Window::wake(); }};
  bool costs_are_old_ = true, wants_costs_ = false;
  Measuring::Work wanted_ = Measuring::Work::none;  // to be begun
  bool is_holding_ = false;                         // the sessions, for a measurement
  Diagnostics errors_;

  int drawings_ = 3;  // still to do, even if no new picture comes
  double last_step_ = 0, last_draw_ = 0, moving_until_ = 0, focus_until_ = 0;
  bool moved_ = false;          // the newest request is one of a movement
  std::string waiting_option_;  // that has no effect in this scene, as was told
  double requested_at_ = 0;
  Message message_;
  bool says_error_ = false, typing_ = false;  // into a field
  Comparison comparison_;
  std::string to_save_;
};

}  // namespace raio::view
