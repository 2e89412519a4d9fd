// The window's program: passes events to the state, and carries out its requests with the sessions,
// the files, the measurements and the window itself. It decides nothing (app_state.h).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/app_state.h"
#include "view/compared.h"
#include "view/controls.h"
#include "view/memory.h"
#include "view/pictures.h"
#include "view/structure_overlay.h"
#include "view/thumbnails.h"
#include "view/window.h"

namespace raio::core::view {

class Viewer {
 public:
  /// `session` already has `first_request`, which can be traced before the window opens.
  Viewer(Window& window, ViewState state, Memory memory, std::vector<std::string> warnings,
         bool logs, std::unique_ptr<Session> session, const RenderOptions& first_request);
  ~Viewer() { window_.listen(nullptr); }

  void run();

 private:
  void handle(const Event& event);
  void carry_out(const Request& request);
  Facts facts() const;
  event::Resized size() const;
  void log(std::string_view line) const;

  void step();
  void take_results();
  void take_picture(Side& side);
  void take_thumbnails();
  void take_difference();
  void open_lesson(const std::string& page);
  void measure(Measuring::Work work);
  void ask_for_file(FileDialog::Purpose purpose);
  void write_picture(const SessionPicture& picture, const std::string& suffix);
  void print_picture(const request::PrintPicture& what);

  // The screen, in viewer_drawing.cpp.
  void draw();
  void draw_inspector();
  void draw_selection() const;
  // For a picture that takes long.
  std::optional<SessionProgress> progress() const;
  CostFacts cost_facts() const;
  ControlFacts control_facts(const std::string& under);

  Window& window_;
  const bool logs_;
  AppState app_;
  Pictures pictures_;
  Controls controls_;
  StructureOverlay overlay_;
  Inspector inspector_{[] { Window::wake(); }};
  Measuring measuring_{
      {[this](bool on) { pictures_.hold(on); }, [this] { return pictures_.are_idle(); }},
      [] { Window::wake(); }};
  MemoryKeeper keeper_;
  const SampleScenes samples_ = sample_scenes();
  const std::vector<LessonEntry> lessons_ = lessons_in(root_folder());
  PagePictures lesson_pictures_;
  std::map<std::string, SceneCard> cards_;  // of the start page
  std::optional<Thumbnails> thumbnails_;    // while it is open
  SceneFile file_;
  ComparedFile compared_file_;
  Comparer comparer_{[] { Window::wake(); }};
  std::optional<Difference> difference_;  // the newest
  PictureWriter writer_;
  SceneWriter scene_writer_;
  PrintJob print_job_{[] { Window::wake(); }};
  std::string button_places_;  // as logged last
  bool typing_ = false;        // into a field
};

}  // namespace raio::core::view
