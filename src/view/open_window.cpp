#include "view/open_window.h"

#include <expected>

#include "app/output.h"
#include "app/terminal.h"
#include "app/warnings.h"
#include "base/executor.h"
#include "io/scene_file.h"
#include "render/provenance.h"
#include "render/render.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/viewer.h"

namespace raio::core::view {

namespace {

int run(const app::ViewCommand& command) {
  ReadOptions read_options = command.read;
  read_options.instances = kForWindow.instances, read_options.labels = kForWindow.labels;
  std::expected<ReadScene, Diagnostics> read;
  if (command.scene.empty()) {
    read->scene.materials = {Material()};  // empty until a scene is opened
  } else {
    read = read_scene(command.scene, read_options);
    if (!read) return app::refuse(read.error());
    app::print_diagnostics(read->notices);
  }
  const auto file = std::make_shared<const ReadScene>(*std::move(read));
  const std::shared_ptr<const Scene> scene(file, &file->scene);
  if (const auto why = option_conflict(command.options, scene.get())) return app::fail(*why);
  const RenderSettings resolved = resolve_options(command.options, *scene);
  ViewState state(command.scene, scene, command.options);
  state.file = file;
  if (!command.compare.empty()) {
    auto picture = read_displayed(command.compare);
    if (!picture) return app::fail(picture.error());
    state.compared = std::make_shared<const ComparedPicture>(command.compare, *std::move(picture));
  }
  const auto [width, height] = state.picture_size();
  const RenderOptions first_request =
      state.request(width > 0 ? width : resolved.width, height > 0 ? height : resolved.height);
  state.program = command.program;
  state.read_options = read_options;
  std::vector<std::string> warnings;
  for (const Diagnostic& d : file->notices) warnings.push_back(d.text());
  for (auto& line : app::camera_warnings(command.options, *state.scene)) warnings.push_back(line);
  auto session = std::make_unique<Session>(Window::wake);
  session->request({state.scene, first_request});

  Memory memory = recall(memory_file());
  state.panel = memory.panel;
  state.costs_of = memory.costs_as_reported ? CostOf::report : CostOf::sample;
  switched_sections() = memory.sections;
  set_language(!command.language.empty() ? language_of(command.language)
               : memory.language         ? *memory.language
                                         : language_of_system());
  const auto window = Window::open(state.wanted_size(), {memory.width, memory.height}, memory.look);
  if (!window) return app::no_resource(window.error());
  Viewer viewer(**window, std::move(state), std::move(memory), std::move(warnings), command.log,
                std::move(session), first_request);
  viewer.run();
  return app::kDone;
}

}  // namespace

int open_window(const app::ViewCommand& command) {
  return Executor(command.options.threads).run([&] { return run(command); });
}

}  // namespace raio::core::view
