#include "view/edit.h"

#include <filesystem>
#include <type_traits>
#include <vector>

#include "io/scene_file.h"
#include "scene/columns.h"
#include "view/files.h"

namespace raio::view {

SharedScene edited(const SharedScene& scene, const std::function<void(Scene&)>& change) {
  auto next = std::make_shared<Scene>(*scene);
  std::vector<const void*> shared;
  for_each_column(*scene, [&](ColumnName, const auto& column) { shared.push_back(column.data()); });
  // In the same order. What is borrowed already stays so, from whoever keeps it.
  size_t i = 0;
  for_each_column(*next, [&](ColumnName, auto& column) {
    using Column = std::remove_cvref_t<decltype(column)>;
    const void* const first = shared[i++];
    if (!column.is_borrowed() && !column.empty())
      column = Column::borrow(first, column.size(), scene);
  });
  change(*next);
  return next;
}

Scene as_seen(const Scene& scene, const Camera& camera, const Rgb& background) {
  Scene seen = scene;
  seen.camera.from = camera.from, seen.camera.at = camera.at;
  seen.camera.up = camera.up, seen.camera.fov_deg = camera.fov_deg;
  seen.background = background;
  return seen;
}

std::expected<std::string, Error> save_as_seen(ViewState& state, const std::string& path) {
  const auto format = scene_format(path);
  if (!format) return std::unexpected(format.error());
  const Rgb background = resolve_options(state.options, *state.scene).background;
  const Scene seen = as_seen(*state.scene, state.camera, background);
  const auto written = write_scene(seen, path, seen.name + ", written by raio view");
  if (!written) return std::unexpected(written.error());
  state.path = short_path(path);
  state.scene = edited(state.scene, [&](Scene& s) {
    s.camera = seen.camera, s.background = background;
    s.name = std::filesystem::path(path).stem().string();
  });
  state.options.background.reset();
  return not_kept(seen, *format);
}

}  // namespace raio::view
