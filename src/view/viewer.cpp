#include "view/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/output.h"
#include "render/provenance.h"
#include "render/render.h"
#include "view/panel_parts.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr double kIdleSeconds = 0.1;  // between checks of the disk

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

Viewer::Viewer(Window& window, ViewState state, Memory memory, std::vector<std::string> warnings,
               bool logs, std::unique_ptr<Session> session, const RenderOptions& first_request)
    : window_(window),
      logs_(logs),
      app_(std::move(state), first_request, memory.look, std::move(warnings)),
      pictures_(std::move(session)),
      keeper_(std::move(memory)),
      file_(app_.view.path) {
  window_.listen([this](const Event& event) { handle(event); });
  log("request: 1");
  if (const auto& compared = app_.view.compared) {
    compared_file_.follow(compared->path);
    pictures_.compared.set(compared->image);
    handle(event::Refresh{});
  }
  handle(size());
  log(fmt::format("place: {},{}", app_.stage.lo.x, app_.stage.lo.y));
  if (!app_.view.path.empty()) {
    keeper_.opened(app_.view.path);
    return;
  }
  std::vector<std::string> paths = keeper_.memory().recent;
  for (const auto& more : {samples_.course, samples_.others})
    for (const std::string& path : more)
      if (std::ranges::count(paths, path) == 0) paths.push_back(path);
  thumbnails_.emplace(std::move(paths), Window::wake);
}

void Viewer::run() {
  while (!window_.should_close()) {
    const bool soon =
        app_.drawings > 0 || inspector_.is_playing() || app_.is_reading() || app_.view.form.plays;
    Window::wait_events(soon ? 0.004 : kIdleSeconds);
    step();
  }
  Memory now = keeper_.memory();
  // A size chosen for a picture is no habit.
  if (app_.view.wanted_size()[0] == 0 && !window_.is_full_screen())
    now.width = int(window_.width()), now.height = int(window_.height());
  now.panel = app_.view.panel, now.sections = switched_sections();
  now.costs_as_reported = app_.view.costs_of == CostOf::report;
  keeper_.closed(now);
  log("closed");
}

void Viewer::log(std::string_view line) const {
  if (logs_) app::print_line(fmt::format("{:.1f} {}", Window::seconds() * 1e3, line));
}

event::Resized Viewer::size() const {
  return {float(window_.width()), float(window_.height()), window_.pixels_per_unit(), em()};
}

Facts Viewer::facts() const {
  Facts facts;
  facts.now = Window::seconds();
  facts.has_dialog = controls_.has_dialog();
  facts.types = Window::is_typing();
  if (!facts.types && !facts.has_dialog)
    facts.walking =
        walking_steps([this](int key) { return window_.is_held(key); }, app_.gestures.is_looking());
  facts.control_held = Window::is_busy();
  facts.over_controls = Window::is_over_controls();
  facts.inspects = inspector_.is_open(), facts.picks = inspector_.is_picking();
  facts.full_screen = window_.is_full_screen(), facts.hidden = window_.is_hidden();
  return facts;
}

void Viewer::handle(const Event& event) {
  for (const Request& request : app_.update(event, facts())) carry_out(request);
}

void Viewer::carry_out(const Request& request) {
  using namespace request;
  std::visit(Overloaded{
                 [&](const Log& r) { log(r.line); },
                 [&](const Render& r) { pictures_.main.session->request(r.what); },
                 [&](const RenderOther& r) { pictures_.request_other(r.what, r.is_new); },
                 [&](const Pause& r) { pictures_.pause(r.on); },
                 [&](const Measure& r) { measure(r.work); },
                 [&](const ForgetMeasurements&) { measuring_.forget(); },
                 [&](const Inspect& r) {
                   log(inspector_.look(app_.view, app_.stage, app_.baked(), r.from, r.to));
                 },
                 [&](const FollowInspection&) { inspector_.follow(app_.view); },
                 [&](const PickPixel& r) { inspector_.pick(r.on); },
                 [&](const WalkRay& r) {
                   if (const std::string at = inspector_.walk(r.where, Window::seconds());
                       !at.empty())
                     log(at);
                 },
                 [&](const CloseInspector&) { inspector_.close(); },
                 [&](const OpenFile& r) { file_.open(r.path, r.options); },
                 [&](const OpenLesson& r) { open_lesson(r.page); },
                 [&](const CompareWith& r) { compared_file_.open(r.path); },
                 [&](const StopComparing&) { compared_file_.close(); },
                 [&](const Reread& r) { file_.reread(r.options); },
                 [&](const FollowFile& r) {
                   if (r.saved) file_.follow(app_.view.path);
                   keeper_.opened(r.path);
                 },
                 [&](const SaveScene& r) { scene_writer_.write(app_.view, r.path); },
                 [&](const WritePicture& r) { write_picture(*r.picture, r.suffix); },
                 [&](const PrintPicture& r) { print_picture(r); },
                 [&](const StopPrinting&) { print_job_.stop(); },
                 [&](const WriteDrawing& r) {
                   const Camera camera = app_.shown_camera();
                   writer_.write(inspector_.drawing(r.suffix, camera),
                                 free_name(inspector_.file_name(), r.suffix),
                                 inspector_.command_line(app_.view));
                 },
                 [&](const WriteCurve&) {
                   writer_.write([csv = grid_curve_csv(measuring_.curve())] { return csv; },
                                 free_name(app_.view.scene->name + "-grid", ".csv"), "");
                 },
                 [&](const AskForFile& r) { ask_for_file(r.purpose); },
                 [&](const CopyText& r) { window_.set_clipboard(r.text); },
                 [&](const SetLook& r) { window_.set_look(r.look); },
                 [&](const SetFullScreen& r) { window_.set_full_screen(r.on); },
                 [&](const SwitchHelp&) { controls_.switch_help(); },
                 [&](const CloseDialogs&) { controls_.close(); },
                 [&](const CloseWindow&) { window_.close(); },
                 [&](const Draw&) { draw(); },
             },
             request);
}

void Viewer::step() {
  take_results();
  handle(size());
  handle(event::Tick{});
}

void Viewer::take_results() {
  if (const auto written = scene_writer_.poll()) handle(*written);
  // A file being saved is no change on the disk.
  if (!scene_writer_.is_busy())
    if (const auto read = file_.poll(app_.view.options.threads, app_.read_options())) handle(*read);
  if (const auto read = compared_file_.poll()) {
    handle(*read);
    if (read->picture) pictures_.compared.set((*read->picture)->image);
  }
  while (const auto written = writer_.poll()) handle(*written);
  if (const auto printed = print_job_.poll()) handle(event::Printed{*printed});
  if (const auto found = inspector_.poll()) handle(event::Inspected{*found});
  if (const auto said = measuring_.poll()) handle(event::Measured{*said, measuring_.costs()});
  take_picture(pictures_.main);
  take_picture(pictures_.other);
  take_thumbnails();
  take_difference();
  // Both are asked: each forgets its news.
  const bool advanced = inspector_.advance(Window::seconds());
  if (measuring_.has_news() || advanced) handle(event::Refresh{1});
}

void Viewer::take_picture(Side& side) {
  if (side.take(app_.view)) handle(event::PictureTaken{side.picture, &side == &pictures_.main});
}

void Viewer::take_thumbnails() {
  if (!thumbnails_) return;
  if (!app_.view.path.empty()) return thumbnails_.reset(), cards_.clear();
  for (Thumbnails::Made& made : thumbnails_->take()) {
    SceneCard& card = cards_[made.path];
    log((made.thumbnail ? "pictured: " : "not pictured: ") + made.path);
    if (made.thumbnail) {
      card.texture.set(made.thumbnail->image);
      card.size = number_of(made.thumbnail->primitives, "primitive", "primitives");
      card.about = made.thumbnail->about;
    } else {
      card.about = made.thumbnail.error();
    }
    handle(event::Refresh{1});
  }
}

void Viewer::open_lesson(const std::string& page) {
  LessonPanel& panel = controls_.lesson;
  if (!page.empty()) return panel.open(page);
  if (!panel.is_open()) panel.open(lessons_.empty() ? "docs/course" : lessons_.front().page);
}

void Viewer::take_difference() {
  if (auto found = comparer_.poll()) {
    pictures_.difference.set(found->image);
    log(fmt::format("compared: samples {} rmse {:.6g} largest {} above 8 {:.6g}",
                    found->of->samples, found->whole.rmse, found->whole.largest,
                    found->whole.above_8));
    difference_ = std::move(found);
    handle(event::Refresh{1});
  }
  comparer_.start(app_.picture, app_.view.compared);
}

void Viewer::measure(Measuring::Work work) {
  const int width = app_.stage.picture_width, height = app_.stage.picture_height;
  switch (work) {
    case Measuring::Work::none:
      return measuring_.cancel();
    case Measuring::Work::costs:
      return measuring_.start_costs(app_.view, app_.baked(), width, height);
    case Measuring::Work::table:
      return measuring_.start_table(app_.view, width, height);
    case Measuring::Work::curve:
      return measuring_.start_curve(app_.view, width, height);
  }
}

void Viewer::ask_for_file(FileDialog::Purpose purpose) {
  std::string name;
  if (purpose == FileDialog::Purpose::save)
    name = free_name((file_.folder() / app_.view.scene->name).string(), ".nff");
  controls_.files.ask(purpose, file_.folder(), std::filesystem::path(name).filename().string());
}

void Viewer::write_picture(const SessionPicture& picture, const std::string& suffix) {
  const ViewState& view = app_.view;
  const std::string path = free_name(view.scene->name, suffix);
  const RenderSettings settings = resolve_options(
      view.request(app_.stage.picture_width, app_.stage.picture_height, picture.samples),
      *view.scene);
  writer_.write(picture.image, path, settings_of(*view.scene, settings, view.read_options),
                app_.command_line(path), view.overlay(settings));
}

void Viewer::print_picture(const request::PrintPicture& what) {
  const ViewState& view = app_.view;
  JobRequest job;
  job.scene = view.path, job.read = view.read_options, job.loaded = what.scene;
  job.options = what.options;
  job.output = free_name(view.scene->name, ".png");
  job.overlay = view.overlay(resolve_options(what.options, *view.scene));
  std::string command = view.command_line(what.options, job.output);
  print_job_.start(std::move(job), std::move(command));
}

}  // namespace raio::core::view
