#include "view/open_window.h"

#include <expected>

#include "app/output.h"
#include "app/terminal.h"
#include "app/warnings.h"
#include "base/executor.h"
#include "render/render.h"
#include "view/texts.h"
#include "view/viewer.h"

namespace raio::core::view {

namespace {

int run(const app::ViewCommand& command) {
  std::expected<Scene, int> scene;
  Diagnostics said;
  if (command.scene.empty()) {
    scene->materials = {Material()};  // empty until a scene is opened
  } else {
    scene = app::load_scene(command.scene, false, &said, command.read);
    if (!scene) return scene.error();
  }
  if (const auto why = option_conflict(command.options, &*scene)) return app::fail(*why);
  const RenderSettings resolved = resolve_options(command.options, *scene);
  ViewState state(command.scene, std::make_shared<const Scene>(std::move(*scene)), command.options);
  const RenderOptions first_request = state.request(resolved.width, resolved.height);
  state.program = command.program;
  state.read_options = command.read;
  std::vector<std::string> warnings;
  for (const Diagnostic& d : said) warnings.push_back(d.text());
  for (auto& line : app::camera_warnings(command.options, *state.scene)) warnings.push_back(line);
  auto session = std::make_unique<Session>(Window::wake);
  session->request({state.scene, first_request});

  Memory memory = recall(memory_file());
  set_language(!command.language.empty() ? language_of(command.language)
               : memory.language         ? *memory.language
                                         : language_of_system());
  const auto window = Window::open(resolved.width, resolved.height, memory.look);
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
