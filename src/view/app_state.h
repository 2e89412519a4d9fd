// The window's rules: an event changes the state, and requests to the world outside follow. No
// window, no thread, no clock: time and everything else from outside are arguments.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "view/comparison.h"
#include "view/events.h"
#include "view/gestures.h"
#include "view/history.h"
#include "view/layout.h"
#include "view/legend.h"
#include "view/pictures.h"
#include "view/selection.h"

namespace raio::core::view {

/// The world outside at the moment of an event.
struct Facts {
  double now = 0;                                  // seconds
  Steps walking;                                   // by held keys
  bool control_held = false;                       // of the panel or the bars
  bool has_dialog = false, over_controls = false;  // the cursor
  bool types = false;                              // into a field
  bool inspects = false, picks = false;            // the inspector is open; waits for a click
  bool full_screen = false, hidden = false;
};

class AppState {
 public:
  /// `first` has been requested already, as request 1.
  AppState(ViewState first_view, const RenderOptions& first, const Theme& first_look,
           std::vector<std::string> warnings_of_file);
  AppState(const AppState&) = delete;  // the gestures refer to it
  AppState& operator=(const AppState&) = delete;

  Requests update(const Event& event, const Facts& facts);

  // For reading; they change by events only.
  ViewState view;
  History<ViewState> history;
  SharedScene saved_scene;  // as in the file
  Theme look;
  Layout layout;
  Stage stage;
  Gestures gestures;
  std::shared_ptr<const SessionPicture> picture;  // the newest; null before the first
  uint64_t request = 1;                           // the newest, counted as the session does
  double requested_at = 0;
  Other other = Other::none;
  Message message;
  bool says_error = false;
  Diagnostics errors;  // of the file on the disk
  Warnings warnings;
  Selection selection;
  bool shows_lesson = false;
  bool focuses = false;                               // the focus tool is on
  Measuring::Work measuring = Measuring::Work::none;  // until its end was reported
  bool costs_are_old = true;
  int drawings = 3;  // remaining, even without a new picture

  bool is_moving() const { return facts_.now < moving_until_; }
  bool shows_focus() const { return focuses || facts_.now < focus_until_; }
  /// For the first sample of the request.
  bool is_waiting() const;
  bool has_panel() const { return layout.panel.width() > 0; }
  /// Of the picture, from edge to edge.
  Camera shown_camera() const {
    return view.edge_to_edge(stage.picture_width, stage.picture_height);
  }
  /// The newest picture's; null before the first.
  std::shared_ptr<const BakedScene> baked() const { return picture ? picture->baked : nullptr; }
  /// The picture, at the cursor.
  bool is_covered() const;
  /// The primitive and its point at a position of the window.
  Pick pick_at(double x, double y) const;
  /// A description of the picture at the cursor; empty during movements.
  ReadOut under_cursor() const;
  /// What the selected points measure: a distance or an angle; or nothing.
  std::string measured() const;
  SelectionFacts selection_facts() const;
  std::string command_line(const std::string& output) const;
  /// How the file is to be read, now or soon.
  const ReadOptions& read_options() const {
    return wanted_read_ ? *wanted_read_ : view.read_options;
  }
  bool is_reading() const { return wanted_read_.has_value(); }
  /// Reading takes so long that the user wonders.
  bool waits_for_file() const;
  bool is_printing() const { return is_printing_; }

 private:
  // Events.
  void on(const event::Refresh& e) { drawings = std::max(drawings, e.drawings); }
  void on(const event::KeyPressed& e);
  void on(const event::MouseButton& e);
  void on(const event::CursorMoved& e);
  void on(const event::Scrolled& e);
  void on(const event::FileDropped& e) { open(e.path); }
  void on(const event::Resized& e);
  void on(const event::ControlsUsed& e);
  void on(const event::InspectorUsed& e);
  void on(const event::PictureTaken& e);
  void on(const event::Inspected& e);
  void on(const event::Measured& e);
  void on(const event::Printed& e);
  void on(const event::Tick& e);
  void on(const SceneFile::Read& read);
  void on(const ComparedFile::Read& read);
  void on(const SceneWriter::Written& written);
  void on(const PictureWriter::Written& written);

  void ask(Request what) { requests_.push_back(std::move(what)); }
  void log(std::string line) { ask(request::Log{std::move(line)}); }
  // Reports an action, in the window's language.
  void say(std::string text, bool is_error = false);
  void complain(std::string text) { say(std::move(text), true); }
  void refresh() { on(event::Refresh{}); }

  // Requests new pictures of the sessions. Returns whether the options are valid.
  bool renew();
  void renew_other(double frame_s);
  void camera_moved();
  void settle();
  void show_focus();
  // A scene, or a picture to compare with.
  void open(const std::string& path);
  void measure();
  // At rest, and after the picture itself.
  bool may_measure_costs() const;
  void cancel_measuring();
  // Saves a picture identical to that of `raio render`: of the newest request, at rest, with
  // equally many samples in every pixel.
  void save_when_whole();
  void draw();
  // Too narrow for a panel beside the picture.
  bool is_narrow() const { return !Layout::is_panel_beside(size_.width, size_.em, shows_lesson); }

  // Lessons, in app_lesson.cpp.
  void switch_lesson();
  void use_lesson(const LessonResult& did);
  void show(const app::ShownScene& what);
  // Its options, once its file has been read.
  void take_shown(const app::ShownScene& what);

  // Figures, in app_figure.cpp: how the file is read, frames in time, pictures for print.
  void use_figure_panel(const FigureResult& did);
  void change_read_option(const ReadChange& change);
  void change_read_option(std::string_view option, const std::string& text);
  // The selected atoms, their residues or chains, as a selection for options; empty: none.
  std::string selected(SelectionUse use) const;
  void hide_selected(SelectionUse use);
  void color_selected(SelectionUse use);
  void read_again(const ReadOptions& options);
  // Whether the result of reading is still wanted.
  bool is_wanted(const SceneFile::Read& read) const;
  void refuse_reading(const SceneFile::Read& read);
  void play();
  void print_picture(bool only_copies);
  // Scenes that were read differently share no memory.
  void limit_history();
  // Whether `raio render` of the file gives the scene.
  bool is_scene_of_file() const;

  // Commands, in app_commands.cpp.
  void obey(const KeySpec& key);
  void finish(Gestures::Done gesture, bool ctrl);
  void select(const Pick& pick, bool more);
  void choose_pivot(const Pick& pick);
  void use_selection(SelectionUse use);
  // The rays of the pixel that shows it.
  void inspect(const Vec3d& point);
  void switch_focusing();
  void switch_split();
  void switch_comparing();
  void stop_comparing();
  void switch_effect(Command effect);
  void switch_panel();
  void switch_pause();
  void switch_picking();
  void switch_look(bool Theme::* what);
  // Measurements of costs, which start by themselves, give way to requested work.
  void switch_work(Measuring::Work work, const char* what);
  void move_camera(const Camera& camera);
  // The camera moved until everything is visible.
  Camera fit() const;
  void focus_on(const Pick& pick);
  void close_inspector();
  void copy_command(const std::string& command);
  void save_scene(const std::string& path);
  void go_back(bool back);
  // What Escape closes before it ends the program.
  bool leave();

  Facts facts_;                                 // of the event
  Requests requests_;                           // its answer so far
  event::Resized size_;                         // of the window
  bool covers_ = false;                         // a narrow window shows the panel over the picture
  std::optional<app::ShownScene> wanted_show_;  // its file is being read
  std::optional<Vec3d> wanted_rays_;            // of the pixel that shows this point
  Comparison comparison_;
  std::optional<ReadOptions> wanted_read_;  // requested, not yet there
  uint32_t file_version_ = 0;               // of the file on the disk
  double reading_since_ = 0;
  double next_frame_at_ = 0;  // while frames play
  bool is_printing_ = false;
  std::string to_save_;                             // suffix of the picture to be saved
  bool is_saving_ = false;                          // a scene
  bool wants_costs_ = false;                        // they are visible
  Measuring::Work wanted_ = Measuring::Work::none;  // to be started
  bool has_new_picture_ = false;
  bool moved_ = false;          // the newest request is part of a movement
  std::string waiting_option_;  // has no effect in this scene, as reported
  double last_click_ = -1;      // when
  double last_tick_ = 0, last_draw_ = 0, moving_until_ = 0, focus_until_ = 0;
};

}  // namespace raio::core::view
