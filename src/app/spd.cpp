#include "app/spd.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "base/executor.h"
#include "io/generate/generate.h"

namespace raio::core::app {
namespace {

std::string known_names() {
  std::string names;
  for (const PublishedScene& scene : kPublished)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", scene.name);
  return names;
}

// In the databases, transparent surfaces send reflected rays whatever their Ks; this adds a Ks too
// small to be visible.
void mirror_what_is_transparent(Scene& scene) {
  for (Material& m : scene.materials)
    if (m.transmission > 0 && m.ks == 0) m.ks = 1e-20f;
}

// Settings as the databases' author prescribes for counting.
RenderSettings prescribed(const SpdVerifyCommand& command, const Scene& scene) {
  RenderOptions o;
  o.width = o.height = 513, o.angle_to_centers = true;
  o.aa = 1, o.dof = false, o.depth = 5;
  o.threads = command.options.threads;
  return resolve_options(o, scene);
}

struct Counted {
  RayCounts rays;
  AccelInfo accel;
};

// The error is the exit status; messages have been printed.
std::expected<Counted, int> count(const Scene& scene, const RenderSettings& options,
                                  WorkControl& control, const SpdVerifyCommand& command,
                                  const std::string& label) {
  const auto accel =
      Executor(options.threads, &control).run([&] { return build_accel(scene, options.accel); });
  if (!accel) return std::unexpected(fail(accel.error()));
  const auto film = make_film(scene, options);
  if (!film) return std::unexpected(fail(film.error()));
  control.rays_done = control.work_done = control.work_total = 0;
  const ProgressLine progress(control, command.progress, label);
  if (!render(scene, **accel, options, **film, control).finished)
    return std::unexpected(int(kInterrupted));
  return Counted{(*film)->rays(), (*accel)->info()};
}

std::expected<SpdScene, int> verify(const PublishedScene& published, const Scene& scene,
                                    WorkControl& control, const SpdVerifyCommand& command) {
  RenderSettings options = prescribed(command, scene);
  const std::string name(published.name);
  const auto counted = count(scene, options, control, command, name);
  if (!counted) return std::unexpected(counted.error());
  std::vector<SpdGridCounts> grids;
  options.accel = {.kind = AccelKind::grid, .grid_plain = true, .counters = true};
  for (const HavranGrid& grid : published.grids) {
    options.accel.grid_resolution = grid.resolution;
    const auto [x, y, z] = grid.resolution;
    const auto walked =
        count(scene, options, control, command, fmt::format("{}, {}x{}x{} cells", name, x, y, z));
    if (!walked) return std::unexpected(walked.error());
    const double rays = double(walked->rays.total());
    grids.push_back({walked->accel.references, double(walked->rays.tests) / rays,
                     double(walked->rays.steps) / rays});
  }
  return beside_published(published, counted->rays, grids);
}

}  // namespace

int run(const SpdVerifyCommand& command) {
  WorkControl control;
  const StopOnSignal stop(&control);
  std::vector<std::string> wanted = command.scenes;
  if (wanted.empty())
    for (const PublishedScene& scene : kPublished) wanted.emplace_back(scene.name);
  // Checks everything before the work begins.
  for (const std::string& path : wanted)
    if (!find_published(std::filesystem::path(path).stem().string()))
      return bad_input(
          fmt::format("'{}' has no published counts; expected {}, or a file with one of "
                      "these names",
                      path, known_names()));
  std::vector<SpdScene> scenes;
  for (const std::string& path : wanted) {
    const PublishedScene& published = *find_published(std::filesystem::path(path).stem().string());
    std::expected<Scene, int> scene;
    if (path == published.name)
      scene = *generate_scene(published.name);
    else
      scene = Executor(0, &control).run([&] { return load_scene(path); });
    if (!scene) return scene.error();
    mirror_what_is_transparent(*scene);
    auto verified = verify(published, *scene, control, command);
    if (!verified) return verified.error() == kInterrupted ? interrupted() : verified.error();
    scenes.push_back(std::move(*verified));
  }
  const int status = deliver("-", command.json ? spd_json(scenes) : spd_text(scenes));
  return status == kDone && any_off(scenes) ? int(kCheckFailed) : status;
}

}  // namespace raio::core::app
