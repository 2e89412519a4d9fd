#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "app/commands.h"
#include "app/json.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/image.h"

namespace raio::app {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Times {
  double load = 0, build = 0, render = 0, write = 0, total = 0;
};

std::string picture_path(const RenderCommand& command) {
  if (!command.output.empty()) return command.output;
  return std::filesystem::path(command.scene).stem().string() + ".png";
}

// What another run needs to make the same picture.
Metadata settings(const Scene& scene, const RenderOptions& o, const AccelInfo& accel) {
  Metadata m = {{"version", RAIO_VERSION},
                {"scene", scene.name},
                {"accel", accel.name},
                {"samples_per_pixel", fmt::format("{}", o.samples_per_pixel())},
                {"sampler", std::string(sampler_name(*o.sampler))},
                {"aa", fmt::format("{}", o.aa)},
                {"lens_samples", fmt::format("{}", o.lens_samples)},
                {"soft_shadows", o.soft_shadows ? "true" : "false"},
                {"dof", *o.dof ? "true" : "false"},
                {"depth", fmt::format("{}", o.depth)},
                {"one_sided", o.one_sided ? "true" : "false"},
                {"seed", fmt::format("{}", o.seed)}};
  if (o.angle_to_centers) m.emplace_back("angle_to_centers", "true");
  if (o.soft_shadows && o.light_size > 0)
    m.emplace_back("light_size", fmt::format("{}", o.light_size));
  if (*o.dof) {
    m.emplace_back("aperture", fmt::format("{}", o.aperture));
    m.emplace_back("focus", fmt::format("{}", o.focus));
  }
  return m;
}

double rays_per_s(const RayCounts& rays, const Times& times) {
  return double(rays.total()) / std::max(times.render, 1e-9);
}

// docs/statistics.md describes it.
Json statistics(const Scene& scene, const RenderOptions& o, const AccelInfo& accel,
                const Times& times, const RayCounts& rays) {
  Json primitives;
  const auto counts = count_primitives(scene);
  for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::triangle, ShapeKind::polygon,
                               ShapeKind::cone, ShapeKind::cylinder, ShapeKind::plane})
    primitives[std::string(kShapeKindNames[size_t(kind)])] = counts[size_t(kind)];
  Json json = {
      {"version", RAIO_VERSION},
      {"scene", scene.name},
      {"resolution", {o.width, o.height}},
      {"samples_per_pixel", o.samples_per_pixel()},
      {"seed", o.seed},
      {"threads", o.threads},
      {"depth", o.depth},
      {"effects", {{"aa", o.aa}, {"soft_shadows", o.soft_shadows}, {"dof", *o.dof}}},
      {"primitives", primitives},
      {"lights", scene.lights.size()},
      {"materials", scene.materials.size()},
      {"accelerator",
       {{"name", accel.name},
        {"bytes", accel.bytes},
        {"cells", accel.cells},
        {"references", accel.references}}},
      {"time_s",
       {{"load", times.load},
        {"build", times.build},
        {"render", times.render},
        {"write", times.write},
        {"total", times.total}}},
      {"peak_memory_bytes", peak_memory_bytes()},
      {"rays",
       {{"eye", rays.eye},
        {"eye_hits", rays.eye_hits},
        {"reflection", rays.reflection},
        {"refraction", rays.refraction},
        {"shadow", rays.shadow},
        {"shadow_hits", rays.shadow_hits},
        {"total", rays.total()}}},
      {"rays_per_s", rays_per_s(rays, times)},
  };
  if (o.accel.counters) {
    const double total = double(std::max<uint64_t>(1, rays.total()));
    json["per_ray"] = {{"tests", double(rays.tests) / total},
                       {"steps", double(rays.steps) / total}};
  }
  return json;
}

// What cannot be written is better known before the work than after it; the exit status.
int check_targets(const std::string& output, const std::string& stats) {
  if (const auto format = image_format(output); !format) return fail(format.error());
  if (const auto writable = check_writable(output); !writable) return fail(writable.error());
  if (stats.empty()) return kDone;
  if (const auto writable = check_writable(stats); !writable) return fail(writable.error());
  if (stats == output || (is_standard_output(stats) && is_standard_output(output)))
    return bad_input("the picture and --stats cannot both go to " +
                     (is_standard_output(output) ? "standard output" : output) +
                     "; give one of them another name");
  return kDone;
}

std::string summary(const std::string& output, const RenderOptions& o, const AccelInfo& accel,
                    const Times& times, const RayCounts& rays) {
  const int samples = o.samples_per_pixel();
  return fmt::format(
      "{}: {}x{}, {} {} a pixel, {}: load {}, build {}, render {} ({}rays/s), write {}",
      is_standard_output(output) ? "picture" : output, o.width, o.height, samples,
      samples == 1 ? "sample" : "samples", accel.name, human_seconds(times.load),
      human_seconds(times.build), human_seconds(times.render), human_count(rays_per_s(rays, times)),
      human_seconds(times.write));
}

}  // namespace

int run(const RenderCommand& command) {
  const auto start = std::chrono::steady_clock::now();
  Times times;
  RenderControl control;
  const StopOnSignal stop(&control);
  const std::string output = picture_path(command);
  if (const int status = check_targets(output, command.stats)) return status;

  const auto scene = load_scene(command.scene, command.quiet);
  if (!scene) return scene.error();
  times.load = seconds_since(start);
  if (control.stop) return interrupted();

  if (const auto why = option_conflict(command.options, &*scene); !why.empty())
    return bad_input(why);
  const RenderOptions options = resolve_options(command.options, *scene);
  if (const auto why = picture_problem(options.width, options.height); !why.empty())
    return no_resource(why);
  const auto build_start = std::chrono::steady_clock::now();
  std::expected<std::unique_ptr<Accel>, std::string> accel;
  on_threads(options.threads,
             [&] { accel = build_accel(*scene, options.accel, options.one_sided); });
  if (!accel) return no_resource(accel.error());
  times.build = seconds_since(build_start);
  if (control.stop) return interrupted();

  const auto film = make_film(*scene, options);
  if (!film) return no_resource(film.error());
  RenderResult done;
  {
    const ProgressLine progress(control, command.quiet ? "off" : command.progress);
    done = render(*scene, **accel, options, **film, control);
  }
  if (!done.finished) return interrupted();
  times.render = done.seconds;

  const AccelInfo info = (*accel)->info();
  const auto write_start = std::chrono::steady_clock::now();
  const Image image = (*film)->resolve();
  if (auto written = write_image(image, output, settings(*scene, options, info)); !written)
    return fail(written.error());
  times.write = seconds_since(write_start);
  times.total = seconds_since(start);

  if (!command.stats.empty()) {
    const Json json = statistics(*scene, options, info, times, (*film)->rays());
    if (const int status = deliver(command.stats, json_text(json))) return status;
  }
  if (!command.quiet) print_line(summary(output, options, info, times, (*film)->rays()));
  return kDone;
}

}  // namespace raio::app
