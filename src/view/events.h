// The events of the window and the requests to its surroundings, as plain data. An event changes
// the state, which answers with requests (app_state.h).
#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/session.h"
#include "view/compared.h"
#include "view/controls.h"
#include "view/edit.h"
#include "view/files.h"
#include "view/inspector.h"
#include "view/keys.h"
#include "view/measure.h"
#include "view/state.h"

namespace raio::core::view {

namespace event {

/// The window must be drawn again; its controls may need several drawings to settle.
struct Refresh {
  int drawings = 3;
};
struct KeyPressed {
  int key = 0;  // GLFW's code
  Modifiers held;
};
struct MouseButton {
  int number = 0;  // GLFW's: left, right, middle
  bool down = false, shift = false, ctrl = false;
};
/// In window units, as all positions.
struct CursorMoved {
  double x = 0, y = 0;
};
struct Scrolled {
  double steps = 0;
  bool ctrl = false;
};
struct FileDropped {
  std::string path;
};
/// The window's size, in its units, and that of its text.
struct Resized {
  float width = 1, height = 1;
  float pixels_per_unit = 1, em = 1;
};
/// The result of drawing the panel and the bars, and the state with the changes made there.
struct ControlsUsed {
  ViewState view;
  ControlResult did;
};
struct InspectorUsed {
  InspectorResult did;
  std::string command;  // of the inspected pixel
};
struct PictureTaken {
  std::shared_ptr<const SessionPicture> picture;
  bool is_main = true;  // not the one compared with
};
/// A line for the log.
struct Inspected {
  std::expected<std::string, Error> found;
};
struct Measured {
  std::string said;  // empty after costs
  EffectCosts costs;
};
/// The end of request::PrintPicture.
struct Printed {
  PictureWriter::Written written;
};
/// Time has passed.
struct Tick {};

}  // namespace event

using Event =
    std::variant<event::Refresh, event::KeyPressed, event::MouseButton, event::CursorMoved,
                 event::Scrolled, event::FileDropped, event::Resized, event::ControlsUsed,
                 event::InspectorUsed, event::PictureTaken, event::Inspected, event::Measured,
                 event::Printed, event::Tick, SceneFile::Read, ComparedFile::Read,
                 SceneWriter::Written, PictureWriter::Written>;

namespace request {

struct Log {
  std::string line;
};
struct Render {
  SessionRequest what;
};
/// The picture to compare with; nothing: its session rests.
struct RenderOther {
  std::optional<SessionRequest> what;
  bool is_new = false;  // of another kind than the last
};
struct Pause {
  bool on = false;
};
struct Measure {
  Measuring::Work work = Measuring::Work::none;  // none: cancels
};
struct ForgetMeasurements {};
/// The pixels between two positions of the picture, 0 to 1.
struct Inspect {
  ImVec2 from, to;
};
struct FollowInspection {};
struct PickPixel {
  bool on = false;
};
struct WalkRay {
  Inspector::Walk where = Inspector::Walk::on;
};
struct CloseInspector {};
struct OpenFile {
  std::string path;
  ReadOptions options = kForWindow;
};
/// A page of the course; empty: the last one, or the first.
struct OpenLesson {
  std::string page;
};
/// A picture of another program.
struct CompareWith {
  std::string path;
};
struct StopComparing {};
/// Of the scene's file, with these options.
struct Reread {
  ReadOptions options;
};
/// A file was opened (`saved`: written) and is the scene's from now on.
struct FollowFile {
  std::string path;
  bool saved = false;
};
struct SaveScene {
  std::string path;
};
struct WritePicture {
  std::shared_ptr<const SessionPicture> picture;
  std::string suffix;
};
/// Renders a picture of its own; of this scene, or else of the file.
struct PrintPicture {
  SharedScene scene;
  RenderOptions options;
};
struct StopPrinting {};
/// Of the inspected rays.
struct WriteDrawing {
  std::string suffix;
};
struct WriteCurve {};
struct AskForFile {
  FileDialog::Purpose purpose = FileDialog::Purpose::open;
};
struct CopyText {
  std::string text;
};
struct SetLook {
  Theme look;
};
struct SetFullScreen {
  bool on = false;
};
struct SwitchHelp {};
struct CloseDialogs {};
struct CloseWindow {};
struct Draw {};

}  // namespace request

using Request =
    std::variant<request::Log, request::Render, request::RenderOther, request::Pause,
                 request::Measure, request::ForgetMeasurements, request::Inspect,
                 request::FollowInspection, request::PickPixel, request::WalkRay,
                 request::CloseInspector, request::OpenFile, request::OpenLesson,
                 request::CompareWith, request::StopComparing, request::Reread, request::FollowFile,
                 request::SaveScene, request::WritePicture, request::PrintPicture,
                 request::StopPrinting, request::WriteDrawing, request::WriteCurve,
                 request::AskForFile, request::CopyText, request::SetLook, request::SetFullScreen,
                 request::SwitchHelp, request::CloseDialogs, request::CloseWindow, request::Draw>;
using Requests = std::vector<Request>;

}  // namespace raio::core::view
