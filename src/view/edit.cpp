#include "view/edit.h"

#include <chrono>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

#include "base/executor.h"
#include "io/scene_file.h"
#include "scene/columns.h"
#include "view/files.h"

namespace raio::core::view {

SharedScene edited(const SharedScene& scene, const std::function<void(Scene&)>& change) {
  auto next = std::make_shared<Scene>(*scene);  // shares all arrays
  change(*next);
  return next;
}

Scene as_seen(const Scene& scene, const Camera& camera, const Rgb& background,
              const std::shared_ptr<const CubeMap>& sky) {
  Scene seen = scene;
  if (camera.from != seen.camera.from || camera.at != seen.camera.at) seen.camera.movement.reset();
  seen.camera.from = camera.from, seen.camera.at = camera.at;
  seen.camera.up = camera.up, seen.camera.fov_deg = camera.fov_deg;
  seen.camera.projection = camera.projection;
  seen.background = background;
  if (sky == scene.sky) return seen;
  seen.sky = sky;
  std::error_code ignored;
  seen.requests.sky_folder = sky ? std::filesystem::absolute(sky->folder, ignored).string() : "";
  return seen;
}

void SceneWriter::write(const ViewState& state, const std::string& path) {
  RenderOptions options = state.options;  // of the picture, whatever view is shown
  options.view = View::picture, options.integrator = std::nullopt;
  const RenderSettings settings = resolve_options(options, *state.scene);
  writing_ = std::async(
      std::launch::async,
      [source = state.scene, camera = state.camera, background = settings.background,
       sky = settings.sky, path, executor = Executor(max_concurrency())]() -> Written {
        try {
          const auto format = scene_format(path);
          if (!format) return {path, source, source, std::unexpected(format.error())};
          auto scene = edited(source, [&](Scene& s) { s = as_seen(s, camera, background, sky); });
          const auto written = executor.run(
              [&] { return write_scene(*scene, path, scene->name + ", written by raio view"); });
          if (!written) return {path, source, source, std::unexpected(written.error())};
          const std::string lost = lost_features(*scene, *format);
          scene = edited(scene,
                         [&](Scene& s) { s.name = std::filesystem::path(path).stem().string(); });
          return {path, source, scene, lost};
        } catch (const std::bad_alloc&) {
          return {path, source, source,
                  std::unexpected(Error{ErrorKind::no_resource, path, "out of memory"})};
        }
      });
}

std::optional<SceneWriter::Written> SceneWriter::poll() {
  if (!is_busy() || writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  return writing_.get();
}

void take_saved(ViewState& state, const SceneWriter::Written& written) {
  state.path = short_path(written.path);
  state.read_options = kForWindow, state.file = nullptr;
  if (state.scene == written.source) {
    state.scene = written.scene;
    // Now part of the scene; for data it belongs to the style.
    if (state.scene->dialect != Dialect::data) state.options.background.reset();
    return;
  }
  state.scene = edited(state.scene, [&](Scene& s) {
    s.camera = written.scene->camera, s.name = written.scene->name;
  });
}

}  // namespace raio::core::view
