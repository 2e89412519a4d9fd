#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "app/commands.h"
#include "app/json.h"
#include "app/output.h"
#include "app/terminal.h"
#include "app/warnings.h"
#include "base/exact_math.h"
#include "draw/annotations.h"
#include "io/fit_camera.h"
#include "io/plain_scene.h"
#include "io/scene_file.h"
#include "render/figure_options.h"
#include "render/options.h"
#include "scene/cube_map.h"

namespace raio::core::app {

namespace {

constexpr std::string_view kDialectNames[] = {"nff", "p3f", "data"};

Json json_of(Vec3d v) { return Json::array({v.x, v.y, v.z}); }

// Six digits are enough for people; --json gives all.
std::string text_of(Vec3d v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z); }

// A position in a scene of that size, or of unknown size if 0: six digits relative to the size,
// however far the position is from 0.
std::string text_of(Vec3d v, double size) {
  const auto digits = [&](double x) {
    const double more = size > 0 ? std::ceil(exact_log10(std::abs(x) / size)) : 0;
    return 6 + (more > 0 ? int(std::min(more, 9.0)) : 0);
  };
  return fmt::format("{:.{}g} {:.{}g} {:.{}g}", v.x, digits(v.x), v.y, digits(v.y), v.z,
                     digits(v.z));
}

struct MaterialCounts {
  size_t reflecting = 0, refracting = 0, standard = 0, emitting = 0;
};

MaterialCounts count_materials(const Scene& scene) {
  return {
      size_t(std::ranges::count_if(scene.materials, [](auto& m) { return m.ks > 0; })),
      size_t(std::ranges::count_if(scene.materials, [](auto& m) { return m.transmission > 0; })),
      count_standard_surfaces(scene),
      size_t(std::ranges::count_if(scene.standard_surfaces, [](const StandardSurface& s) {
        return s.is_standard && s.emission != Rgb();
      }))};
}

std::string info_json(const ReadScene& read) {
  const Scene& scene = read.scene;
  const Camera& camera = scene.camera;
  const auto optional = [](std::optional<float> v) { return v ? Json(plain(*v)) : Json(nullptr); };

  Json json{{"version", RAIO_VERSION}, {"scene", scene.name}};
  json["dialect"] = kDialectNames[size_t(scene.dialect)];
  json["resolution"] = camera.width > 0 ? Json{camera.width, camera.height} : Json(nullptr);
  json["samples_per_pixel"] =
      scene.requests.samples_per_pixel > 0 ? Json(scene.requests.samples_per_pixel) : Json(nullptr);
  json["accel"] = scene.requests.structure == AccelHint::any
                      ? Json(nullptr)
                      : Json(accel_name(hinted_accel(scene)));
  const auto counts = count_primitives(scene);
  for (size_t i = 0; i < counts.size(); ++i) json["primitives"][kShapeKindNames[i]] = counts[i];
  json["instances"] = scene.instances.size();
  json["prototypes"] = scene.prototypes.size();
  json["primitive_count"] = scene.primitive_count();

  const Box3f box = bounds(scene);
  json["bounds"] = nullptr;
  if (!box.empty()) {
    json["bounds"] = {{"lo", json_of(scene.origin + plain(box.lo))},
                      {"hi", json_of(scene.origin + plain(box.hi))}};
  }
  json["camera"] = {{"from", json_of(scene.origin + plain(camera.from))},
                    {"at", json_of(scene.origin + plain(camera.at))},
                    {"up", json_of(plain(camera.up))},
                    {"fov_deg", plain(fitted_fov_deg(camera))},
                    {"projection", projection_name(camera.projection)},
                    {"lens_radius", optional(camera.lens_radius)},
                    {"focus_distance", optional(camera.focus_distance)}};
  json["camera"]["movement"] = nullptr;
  if (const auto& m = camera.movement)
    json["camera"]["movement"] = {{"from", json_of(scene.origin + plain(m->from))},
                                  {"at", json_of(scene.origin + plain(m->at))},
                                  {"begin", plain(m->begin)},
                                  {"end", plain(m->end)}};
  json["background"] = json_of(plain(scene.background));
  json["sky"] = nullptr;
  if (!scene.requests.sky_folder.empty())
    json["sky"] = {{"folder", scene.requests.sky_folder},
                   {"side", scene.sky ? Json(scene.sky->side) : Json(nullptr)}};

  json["lights"] = Json::array();
  for (const Light& light : scene.lights) {
    json["lights"].push_back(
        {{"position", json_of(scene.origin + plain(light.position))},
         {"color", light.color ? json_of(plain(*light.color)) : Json(nullptr)}});
    if (light.extent)
      json["lights"].back()["extent"] = {plain(light.extent->width), plain(light.extent->depth)};
  }
  json["physical_lights"] = Json::array();
  for (const PhysicalLight& light : scene.physical_lights)
    json["physical_lights"].push_back(
        {{"kind", kLightKindNames[size_t(light.kind)]}, {"color", json_of(plain(light.color))}});
  json["environment"] = nullptr;
  for (const Environment& e : scene.environment)
    json["environment"] = {{"width", e.width}, {"height", e.height}, {"visible", e.visible != 0}};
  const MaterialCounts materials = count_materials(scene);
  json["materials"] = {{"count", scene.materials.size()},
                       {"reflecting", materials.reflecting},
                       {"refracting", materials.refracting},
                       {"standard", materials.standard},
                       {"emitting", materials.emitting}};
  json["textures"] = {{"count", scene.textures.size()}, {"texels", scene.texels.size()}};
  json["memory_bytes"] = memory_bytes(scene);
  json["frames"] = read.frames > 0 ? Json(read.frames) : Json(nullptr);
  json["colors"] = nullptr;
  if (const auto& c = read.colors)
    json["colors"] = {{"by", c->name}, {"colormap", c->map}, {"range", {c->least, c->most}}};

  json["warnings"] = Json::array();
  for (const Diagnostic& d : read.notices) {
    json["warnings"].push_back({{"kind", severity_name(d.severity)},
                                {"file", d.file},
                                {"line", d.line},
                                {"column", d.column},
                                {"message", d.sentence()},
                                {"count", d.count},
                                {"names", d.names}});
  }
  return json_text(json);
}

// "2 point, 1 quad"; empty if there are none.
std::string physical_lights_text(const Scene& scene) {
  std::array<size_t, kLightKindNames.size()> counts{};
  for (const PhysicalLight& light : scene.physical_lights) ++counts[size_t(light.kind)];
  std::string text;
  for (size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[i], kLightKindNames[i]);
  return text;
}

std::string info_text(const ReadScene& read) {
  const Scene& scene = read.scene;
  const Camera& camera = scene.camera;
  std::string out;
  const auto line = [&](std::string_view name, const std::string& value) {
    out += fmt::format("{:<12}{}\n", name, value);
  };

  const Box3f box = bounds(scene);
  const double box_size = box.empty() ? 0 : double(max_component(box.size()));
  const bool is_far = scene.origin != Vec3d();
  const auto place_text = [&](Vec3f local) {
    return text_of(scene.origin + plain(local), is_far ? box_size : 0);
  };

  line("scene", scene.name);
  if (scene.dialect == Dialect::p3f)
    line("dialect", "P3F: shaded by blinn-phong, with Fresnel's reflection after Schlick");
  line("primitives", fmt::format("{}", scene.primitive_count()));
  const auto counts = count_primitives(scene);
  for (size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) line("", fmt::format("{:<9} {:>10}", kShapeKindNames[i], counts[i]));
  if (!scene.instances.empty())
    line("instances",
         fmt::format("{}, prototypes {}", scene.instances.size(), scene.prototypes.size()));

  if (box.empty()) {
    line("bounds", "none: nothing in it is bounded");
  } else {
    line("bounds", fmt::format("{}  to  {}", place_text(box.lo), place_text(box.hi)));
  }
  line("camera", fmt::format("from {}  at {}  up {}", place_text(camera.from),
                             place_text(camera.at), text_of(plain(camera.up))));
  if (const auto& m = camera.movement)
    line("", fmt::format("moves to  from {}  at {}  between the times {:g} and {:g}",
                         place_text(m->from), place_text(m->at), m->begin, m->end));
  std::string view = fmt::format("angle {:g} degrees", fitted_fov_deg(camera));
  if (camera.projection != Projection())
    view += fmt::format(", {}", projection_name(camera.projection));
  if (camera.lens_radius) view += fmt::format(", lens radius {:g}", *camera.lens_radius);
  if (camera.focus_distance) view += fmt::format(", in focus at {:g}", *camera.focus_distance);
  line("", view);
  line("resolution", camera.width > 0 ? fmt::format("{}x{}", camera.width, camera.height)
                                      : std::string("not given"));
  if (scene.requests.samples_per_pixel > 0)
    line("samples", fmt::format("{} per pixel", scene.requests.samples_per_pixel));
  if (scene.requests.structure != AccelHint::any)
    line("structure", fmt::format("{}, requested by the file", accel_name(hinted_accel(scene))));
  const bool is_lit = has_own_light(scene);
  const bool has_background =
      scene.dialect != Dialect::data ||
      (is_lit && integrator_of(RenderOptions(), scene) == IntegratorKind::path);
  line("background", has_background ? text_of(plain(scene.background))
                                    : "none; that of the look, white by default");
  if (!scene.requests.sky_folder.empty())
    line("sky", scene.requests.sky_folder +
                    (scene.sky ? fmt::format(", six faces of {0} x {0}", scene.sky->side)
                               : ", which could not be read"));

  const size_t lights = scene.lights.size() + scene.physical_lights.size();
  line("lights", !is_lit                      ? "none; a sky and a key light are added"
                 : has_bright_surfaces(scene) ? fmt::format("{}, and surfaces that emit", lights)
                                              : fmt::format("{}", lights));
  constexpr size_t kShown = 10;
  for (const Light& light : scene.lights | std::views::take(kShown)) {
    std::string text = fmt::format("at {}", place_text(light.position));
    if (light.color) text += "  colour " + text_of(plain(*light.color));
    if (light.extent)
      text += fmt::format("  {:g} x {:g} along x and z", light.extent->width, light.extent->depth);
    line("", text);
  }
  if (scene.lights.size() > kShown)
    line("", fmt::format("and {} more", scene.lights.size() - kShown));

  if (const std::string physical = physical_lights_text(scene); !physical.empty())
    line("", physical + ", in physical units");
  for (const Environment& e : scene.environment)
    line("environment",
         fmt::format("{}x{}{}", e.width, e.height, e.visible ? "" : ", not visible"));

  const MaterialCounts materials = count_materials(scene);
  line("materials", fmt::format("{}, of which {} reflect and {} refract", scene.materials.size(),
                                materials.reflecting, materials.refracting));
  if (materials.standard > 0)
    line("", fmt::format("{} with the parameters of glTF, of which {} emit light",
                         materials.standard, materials.emitting));
  if (!scene.textures.empty())
    line("textures", fmt::format("{}, {} texels", scene.textures.size(), scene.texels.size()));
  if (const auto& c = read.colors)
    line("colours", fmt::format("{} from {} to {}, {}", c->name, scale_text(*c, c->least),
                                scale_text(*c, c->most), c->map));
  if (read.frames > 1) line("frames", fmt::format("{}", read.frames));
  line("memory", human_bytes(double(memory_bytes(scene))));
  line("warnings", read.notices.empty() ? "none" : fmt::format("{}", read.notices.size()));
  return out;
}

// Warnings about a picture without options. Few scenes have a lens, and only those need a structure
// to judge it.
void add_warnings(const InfoCommand& command, ReadScene& read) {
  const RenderSettings settings = resolve_options({}, read.scene);
  std::unique_ptr<Accel> accel;
  if (settings.dof)
    if (auto built = build_accel(read.scene, settings.accel)) accel = std::move(*built);
  check_stop();
  for (const std::string& line : warning_lines(read.scene, settings, accel.get()))
    read.notices.push_back({Severity::warning, command.scene, 0, 0, line, ""});
}

}  // namespace

int run(const InfoCommand& command) {
  if (!command.color_bar.empty()) {
    if (const auto format = plot_format(command.color_bar); !format)
      return bad_input(format.error());
    if (const auto writable = check_writable(command.color_bar); !writable)
      return fail(writable.error());
  }
  // Not load_scene: the warnings are part of the output.
  ReadOptions options = command.read;
  options.instances = true;
  auto read = read_scene(command.scene, options);
  if (!read) return refuse(read.error());
  add_warnings(command, *read);
  for (const Diagnostic& d : read->notices) print_line(d.text("--"));
  if (!command.color_bar.empty()) {
    if (!read->colors)
      return bad_input(
          "--color-bar has no scale, since nothing is coloured by numbers; give --color-by with "
          "index, bfactor, occupancy or a column of numbers");
    const auto bar = draw_color_bar(*read->colors, *plot_format(command.color_bar));
    if (!bar) return no_resource(bar.error());
    if (const int status = deliver(command.color_bar, *bar)) return status;
  }
  return deliver("-", command.json ? info_json(*read) : info_text(*read));
}

}  // namespace raio::core::app
