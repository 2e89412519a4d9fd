#include "app/statistics.h"

#include <fmt/core.h>

#include <algorithm>

#include "app/terminal.h"
#include "base/platform/memory.h"
#include "io/file.h"

namespace raio::core::app {
namespace {

double rays_per_s(const RenderFigures& made) {
  return double(made.rays.total() - made.rays_before) / std::max(made.times.render, 1e-9);
}

}  // namespace

namespace {

Json json_of(const CountedSamples& some) {
  return {{"count", some.count},
          {"first_pixel", some.count > 0 ? Json{some.x, some.y} : Json(nullptr)}};
}

}  // namespace

Json statistics(const RenderFigures& made) {
  const auto& [scene, o, accel, times, rays, rays_before, samples, mean_samples, share_at_most,
               faults] = made;
  Json primitives;
  const auto counts = count_primitives(*scene);
  for (size_t i = 0; i < counts.size(); ++i)
    primitives[std::string(kShapeKindNames[i])] = counts[i];
  Json json = {
      {"version", RAIO_VERSION},
      {"scene", scene->name},
      {"resolution", {o.width, o.height}},
      {"crop", o.crop ? Json{o.crop->x0, o.crop->y0, o.crop->x1, o.crop->y1} : Json(nullptr)},
      {"samples_per_pixel", samples},
      {"noise", o.noise > 0 ? Json{{"bound", o.noise},
                                   {"mean_samples", mean_samples},
                                   {"share_at_max_samples", share_at_most}}
                            : Json(nullptr)},
      {"seed", o.seed},
      {"threads", o.threads},
      {"depth", o.depth},
      {"shading", shading_name(o.shading)},
      {"fresnel", fresnel_name(o.fresnel)},
      {"effects", {{"aa", o.aa}, {"soft_shadows", o.soft_shadows}, {"dof", o.dof}}},
      {"primitives", primitives},
      {"lights", scene->lights.size()},
      {"materials", scene->materials.size()},
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
      {"rays_per_s", rays_per_s(made)},
      {"nan_samples", json_of(faults.nans)},
      {"clamped_samples", json_of(faults.clamped)},
  };
  if (o.accel.counters) {
    const double total = double(std::max<uint64_t>(1, rays.total()));
    json["per_ray"] = {{"tests", double(rays.tests) / total},
                       {"steps", double(rays.steps) / total}};
  }
  return json;
}

std::string summary(const std::string& output, const RenderFigures& made) {
  const RenderSettings& o = made.settings;
  const RenderFigures::Times& times = made.times;
  const auto wanted = uint32_t(o.samples_per_pixel());
  std::string samples = fmt::format("{}{} {} per pixel", made.samples,
                                    made.samples == wanted ? "" : fmt::format(" of {}", wanted),
                                    wanted == 1 ? "sample" : "samples");
  if (o.noise > 0)
    samples = fmt::format("{:.1f} samples per pixel on average, {:.1f} % with the maximum of {}",
                          made.mean_samples, 100 * made.share_at_most, wanted);
  const bool as_hinted =
      made.scene->requests.structure != AccelHint::any && o.accel.kind == hinted_accel(*made.scene);
  const std::string wish = as_hinted ? " as the scene requests" : "";
  const Crop frame = o.frame();
  const std::string whole = o.crop ? fmt::format(" of {}x{}", o.width, o.height) : "";
  return fmt::format("{}: {}x{}{}, {}, {}: load {}, build {}, render {} ({}), write {}",
                     is_standard_output(output) ? "picture" : output, frame.width(), frame.height(),
                     whole, samples, made.accel.name + wish, human_seconds(times.load),
                     human_seconds(times.build), human_seconds(times.render),
                     human_quantity(rays_per_s(made), "rays/s"), human_seconds(times.write));
}

}  // namespace raio::core::app
