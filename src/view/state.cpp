#include "view/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/exact_math.h"
#include "draw/annotations.h"
#include "integrate/camera.h"
#include "integrate/classic.h"
#include "io/atoms/labels.h"
#include "io/fit_camera.h"
#include "measure/effects.h"
#include "render/read_options.h"
#include "view/measure.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr std::array kStructures = {AccelKind::bvh, AccelKind::grid, AccelKind::embree,
                                    AccelKind::none};

// Options that switch an effect on, with its command.
constexpr auto kOptionsOfEffects =
    std::to_array<std::pair<std::string_view, Command>>({{"aa", Command::antialiasing},
                                                         {"soft-shadows", Command::soft_shadows},
                                                         {"dof", Command::depth_of_field},
                                                         {"gloss", Command::gloss},
                                                         {"translucency", Command::translucency},
                                                         {"shutter", Command::motion}});

bool same_camera(const Camera& a, const Camera& b) {
  return a.from == b.from && a.at == b.at && a.up == b.up && a.fov_deg == b.fov_deg &&
         a.projection == b.projection;
}

// Windows have any shape: the camera shows the data in a square and in anything wider.
Camera first_camera(RenderOptions o, const Scene& scene) {
  if (o.width == 0 || o.height == 0) o.width = o.height = 512;
  // The overlays of the window support no omnidirectional projection.
  if (camera_of(scene, o).is_omnidirectional()) o.projection = core::Projection::perspective;
  return resolve_options(o, scene).camera;
}

// The width over the height of the frame that a window must show.
double frame_aspect(const RenderOptions& o, const Scene& scene) {
  const bool fits_square = scene.dialect == Dialect::data || scene.camera.horizontal_fov_deg > 0;
  if (fits_square && (o.width == 0 || o.height == 0)) return 1;
  const RenderSettings settings = resolve_options(o, scene);
  return double(settings.width) / settings.height;
}

const char* effect_name(Command effect) { return key_of(effect).help; }

}  // namespace

ViewState::ViewState(std::string p, std::shared_ptr<const Scene> s, const RenderOptions& o)
    : path(std::move(p)), scene(std::move(s)), options(o) {
  box = bounds(*scene);
  camera = first_camera(o, *scene);
  frame_aspect_ = frame_aspect(o, *scene);
  reset_camera(options);
  // Defaults for what the command line leaves open and the keys change.
  const RenderSettings plain = resolve_options(o, *scene);
  options.accel.kind = plain.accel.kind == AccelKind::automatic ? AccelKind::bvh : plain.accel.kind;
  if (o.aa == 0 && o.samples == 0 && o.sampler != SamplerKind::jitter && plain.aa == 1)
    options.aa = 1;
  for (const auto& [name, effect] : kOptionsOfEffects)
    if (option_of(name).is_given(o) && is_on(effect)) split_effect = effect;
}

void ViewState::open(std::string new_path, std::shared_ptr<const Scene> new_scene,
                     const ReadOptions& options_read, std::shared_ptr<const ReadScene> new_file) {
  const bool same_file = new_path == path;
  const bool own = options_read.frame == read_options.frame && same_camera(camera, own_camera());
  const Vec3d moved = scene->origin - new_scene->origin;
  path = std::move(new_path), scene = std::move(new_scene);
  read_options = options_read, file = std::move(new_file);
  if (moved != Vec3d()) {  // the camera's place in the file stays
    camera.from = Vec3f(Vec3d(camera.from) + moved), camera.at = Vec3f(Vec3d(camera.at) + moved);
    if (focus_point) *focus_point = *focus_point + moved;
    if (pivot) *pivot = *pivot + moved;
  }
  if (!same_file) camera.projection = scene->camera.projection;
  if (!same_file || own) camera = own_camera();
  box = bounds(*scene);
  frame_aspect_ = frame_aspect(options, *scene);
  if (same_file) return follow_focus();
  pivot.reset();
  if (focus_point && options.focus == followed_focus_) options.focus = 0;
  focus_point.reset();
}

void ViewState::keep_habits(const ViewState& other) {
  program = other.program, costs_of = other.costs_of;
  paused = other.paused, panel = other.panel, boxes = other.boxes;
  form = other.form, form.plays = false;
  compared = other.compared, shows_difference = other.shows_difference;
}

Camera ViewState::own_camera() const {
  RenderOptions o;
  o.projection = camera.projection;
  return first_camera(o, *scene);
}

std::optional<Vec3d> ViewState::turning_point() const {
  if (pivot || scene->dialect != Dialect::data) return pivot;
  if (box.empty()) return std::nullopt;
  return Vec3d(box.lo) * 0.5 + Vec3d(box.hi) * 0.5;
}

std::array<int, 2> ViewState::wanted_size() const {
  if (options.width == 0 && options.height == 0 && !options.print) return {0, 0};
  const RenderSettings settings = resolve_options(options, *scene);
  return {settings.width, settings.height};
}

std::array<int, 2> ViewState::picture_size() const {
  return compared ? std::array{compared->image.width, compared->image.height} : wanted_size();
}

bool ViewState::is_figure() const {
  RenderOptions picture = options;
  picture.view = View::picture;
  return lights_from_all_sides(integrator_of(picture, *scene));
}

int ViewState::frame() const {
  const int frame = read_options.frame;
  return std::clamp(frame < 0 ? frames() + frame : frame, 0, frames() - 1);
}

app::Annotations ViewState::annotations_of(const RenderOptions& picture) const {
  app::Annotations some = annotations;
  const bool has_own_colors = file && picture.view == View::picture;
  some.color_bar &= has_own_colors && file->colors;
  some.legend &= has_own_colors && !file->legend.empty();
  some.scale_bar &= file != nullptr;
  if (!some.legend) return some;
  const RenderSettings s = resolve_options(picture, *scene);
  some.legend = has_room_for_legend(s.width, s.height, s.dpi);
  return some;
}

Overlay ViewState::overlay(const RenderSettings& picture) const {
  if (!file) return {};
  RenderOptions size;
  size.width = picture.width, size.height = picture.height, size.dpi = picture.dpi;
  size.view = picture.view;
  return app::overlay_of(annotations_of(size), *file, picture);
}

RenderOptions ViewState::print_request(int width, int height) const {
  RenderOptions o = request(width, height, form.samples);
  // The height has two decimals, a hundredth of a pixel at 300 dpi.
  const float tall = std::round(form.width_mm * float(height) / float(width) * 100) / 100;
  o.width = o.height = 0;
  o.print = PrintSize{form.width_mm, tall}, o.dpi = float(form.dpi);
  if (!form.transparent) return o;
  o.background.emplace().transparent = true;
  drop_ignored_options(o, *scene);  // the depth cue
  return o;
}

void ViewState::set_projection(core::Projection projection) {
  const bool own = same_camera(camera, own_camera());
  camera.projection = projection;
  if (own) camera = own_camera();
}

RenderSettings ViewState::resolved() const {
  RenderOptions o = options;
  set_camera(o, camera, *scene);
  return resolve_options(o, *scene);
}

bool ViewState::endless() const {
  return options.sampler != SamplerKind::jitter && options.aa <= 1 && options.lens_samples <= 1;
}

bool ViewState::has(Command effect) const {
  constexpr Command kOfSurfaces[] = {Command::soft_shadows, Command::reflection,
                                     Command::refraction, Command::gloss, Command::translucency};
  if (is_figure() && std::ranges::count(kOfSurfaces, effect) > 0) return false;
  return is_in_scene(effect_of(effect), *scene, resolved().fresnel);
}

bool ViewState::is_on(Command effect) const {
  switch (effect) {
    case Command::antialiasing:
      return options.aa != 1;
    case Command::soft_shadows:
      return options.soft_shadows;
    case Command::depth_of_field:
      return resolved().dof;
    case Command::structure:
      return options.accel.kind != AccelKind::none;
    case Command::reflection:
      return !options.no_reflection;
    case Command::refraction:
      return !options.no_refraction;
    case Command::gloss:
      return spreads(*scene, options.gloss);
    case Command::translucency:
      return spreads(*scene, options.translucency);
    case Command::motion:
      return core::is_on(Effect::motion, options, *scene);
    default:
      return false;
  }
}

void ViewState::switch_roughness(Command effect, bool on) {
  auto& waiting = effect == Command::gloss ? waiting_gloss : waiting_translucency;
  const std::optional<float> before = roughness(effect);
  options = with_effect(options, effect == Command::gloss ? Effect::gloss : Effect::translucency,
                        on, *scene);
  if (on && waiting) roughness(effect) = waiting;
  waiting = on ? std::nullopt : before;
}

void ViewState::switch_motion(bool on) {
  const auto before = options.shutter;
  options = with_effect(options, Effect::motion, on, *scene);
  if (on && waiting_shutter) options.shutter = waiting_shutter;
  waiting_shutter = on ? std::nullopt : before;
}

std::string ViewState::toggle(Command effect) {
  const bool on = !is_on(effect);
  if (is_figure() && effect != Command::motion && !has(effect))
    return trf("a figure has no {}", tr(effect_name(effect)));
  switch (effect) {
    case Command::antialiasing:
      options.aa = on ? 0 : 1;
      break;
    case Command::soft_shadows:
      options.soft_shadows = on;
      break;
    case Command::depth_of_field:
      if (camera.is_parallel()) return tr("parallel rays have no lens");
      options.dof = on;
      break;
    case Command::structure: {
      const auto now = std::ranges::find(kStructures, options.accel.kind);
      const size_t next = now == kStructures.end() ? 0 : size_t(now - kStructures.begin()) + 1;
      options.accel.kind = kStructures[next % kStructures.size()];
      return trf("structure {}", accel_name(options.accel.kind));
    }
    case Command::reflection:
      options.no_reflection = !on;
      break;
    case Command::refraction:
      options.no_refraction = !on;
      break;
    case Command::gloss:
    case Command::translucency:
      switch_roughness(effect, on);
      break;
    case Command::motion:
      if (!scene->moves()) return tr("nothing moves in this scene");
      switch_motion(on);
      break;
    default:
      return {};
  }
  split_effect = effect;
  return on ? trf("{} on", tr(effect_name(effect))) : trf("{} off", tr(effect_name(effect)));
}

std::pair<std::string, std::string> ViewState::split_labels() const {
  if (compared)
    return {"A: Raio", "B: " + std::filesystem::path(compared->path).filename().string()};
  const std::string with = trf("with {}", tr(effect_name(split_effect)));
  const std::string without = trf("without {}", tr(effect_name(split_effect)));
  return is_on(split_effect) ? std::pair(with, without) : std::pair(without, with);
}

std::string ViewState::title() const {
  std::string title = fmt::format("{} - {}", scene->name, accel_name(options.accel.kind));
  for (const KeySpec& key : key_table()) {
    if (key.command >= Command::structure) continue;
    if (is_on(key.command)) title += fmt::format(", {}", key.help);
  }
  if (options.view != View::picture) title += fmt::format(" - {}", view_name(options.view));
  return title + " - Raio";
}

RenderOptions ViewState::request(int width, int height, int samples) const {
  RenderOptions o = options;
  set_camera(o, shown_camera(width, height), *scene);
  o.width = width, o.height = height;
  // Options that would be refused as having no effect.
  const bool dof = resolved().dof;
  if (!dof) o.aperture = o.focus = 0;
  if (camera.is_parallel()) o.dof.reset();
  if (!o.soft_shadows) o.light_size = 0;
  if (!scene->moves()) o.shutter = std::nullopt;
  drop_ignored_options(o, *scene);
  if (o.accel.kind != AccelKind::grid) o.accel.grid_factor = 0, o.accel.grid_resolution = {0, 0, 0};
  if (o.accel.grid_resolution[0] > 0) o.accel.grid_factor = 0;
  if (o.accel.kind == AccelKind::embree) o.accel.counters = false;
  // Embree does not count; the inspector uses the tree, too.
  if (o.accel.kind == AccelKind::embree && (o.view == View::steps || o.view == View::tests))
    o.accel.kind = AccelKind::bvh;
  if (o.view != View::picture || o.integrator == IntegratorKind::views)
    o.background = {}, o.tone = {}, o.exposure = {};

  const bool varies = dof || o.soft_shadows || o.aa != 1 ||
                      is_rough(*scene, resolve_options(o, *scene)) || is_on(Command::motion);
  if (!endless() || !varies) {
    o.samples = 0;
    if (!varies) o.lens_samples = 0, o.sampler = std::nullopt;
    return o;
  }
  const int most = o.samples > 0 ? o.samples : kRefineSamples;
  o.samples = samples > 0 ? samples : most;
  o.lens_samples = 0, o.sampler = std::nullopt;
  return o;
}

RenderOptions ViewState::other_request(int width, int height) const {
  ViewState other = *this;
  (void)other.toggle(split_effect);
  return other.request(width, height);
}

std::string ViewState::command_line(const RenderOptions& picture, const std::string& output) const {
  return fmt::format("{} render {}{}{}{} -o {}", shell_word(program), shell_word(path),
                     option_arguments(read_options), option_arguments(picture),
                     app::arguments_of(annotations_of(picture)), shell_word(output));
}

void ViewState::focus_at(float depth) {
  options.dof = true;
  options.focus = std::clamp(depth, 1e-30f, 1e30f);
}

void ViewState::focus_on(Vec3d point) {
  focus_point = point;
  const Vec3d forward = normalize(Vec3d(camera.at) - Vec3d(camera.from));
  focus_at(float(dot(point - Vec3d(camera.from), forward)));
  followed_focus_ = options.focus;
}

void ViewState::follow_focus() {
  if (!focus_point || options.focus != followed_focus_) return focus_point.reset();
  const Vec3d forward = normalize(Vec3d(camera.at) - Vec3d(camera.from));
  const double depth = dot(*focus_point - Vec3d(camera.from), forward);
  if (depth <= 0) return;
  options.focus = followed_focus_ = std::clamp(float(depth), 1e-30f, 1e30f);
}

void ViewState::scale_aperture(float factor) {
  options.aperture = std::clamp(resolved().aperture * factor, 1e-30f, 1e30f);
}

Camera ViewState::shown_camera(int width, int height) const {
  Camera out = camera;
  const double tangent = exact_tan(double(camera.fov_deg) * std::numbers::pi / 360) * frame_aspect_;
  out.horizontal_fov_deg = float(exact_atan(tangent) * 360 / std::numbers::pi);
  if (width < frame_aspect_ * height) out.fov_deg = fitted_fov_deg(out, width, height);
  out.horizontal_fov_deg = camera.horizontal_fov_deg;
  return out;
}

Camera ViewState::edge_to_edge(int width, int height) const {
  Camera out = shown_camera(width, height);
  if (!options.angle_to_centers || height < 2) return out;
  const double tangent = exact_tan(double(out.fov_deg) * std::numbers::pi / 360);
  out.fov_deg = float(exact_atan(tangent * height / (height - 1)) * 360 / std::numbers::pi);
  return out;
}

namespace {

// A point of an instance's object in the scene's coordinates.
Vec3d placed(const Geometry& geometry, InstanceId instance, Vec3d point) {
  if (instance == 0) return point;
  const Geometry::Placed in = geometry.placed(instance);
  return geometry.placement(in.index).point(placed(in.object, in.inner, point));
}

void name_atom(Pick& out, const AtomLabels& atoms, std::optional<uint32_t> prototype,
               uint32_t sphere) {
  out.atom = atoms.atom(prototype, sphere);
  if (!out.atom) return;
  out.object = atoms.label(*out.atom, tr("chain"));
  const auto number = atoms.number(*out.atom);
  const uint32_t index = atoms.index(*out.atom);
  out.in_file =
      number ? trf("atom {} of the file, index {}", *number, index) : trf("index {}", index);
}

}  // namespace

Pick pick(const Accel& accel, const Camera& camera, double x, double y, double width_per_height,
          const ReadScene* file) {
  // As if the picture had unit height.
  constexpr int kHeight = 1 << 16;
  const int width = std::max(1, int(std::lround(kHeight * width_per_height)));
  const EyeRays eye(camera, width, kHeight);
  const Ray ray = eye.pinhole(float(x * width), float(y * kHeight));
  RayBatch rays;
  HitBatch hits;
  rays.push(ray);
  hits.reset(1);
  TraceContext context;
  accel.closest_of_all(rays, hits, context);
  Pick out;
  out.hit = hits[0];
  if (!out.hit.found()) return out;
  out.point = Vec3d(ray.origin) + Vec3d(ray.dir) * double(out.hit.t);
  out.depth =
      double(out.hit.t) * dot(Vec3d(ray.dir), normalize(Vec3d(camera.at) - Vec3d(camera.from)));
  const Geometry& scene = accel.geometry();
  const Geometry& geometry = scene.object_at(out.hit.instance);
  out.place = out.point;
  if (const PrimitiveKind kind = geometry.kind_of(out.hit.primitive);
      kind == PrimitiveKind::sphere) {
    const Box3f box = geometry.bounds(out.hit.primitive);
    const Vec3d center = Vec3d(box.lo) * 0.5 + Vec3d(box.hi) * 0.5;
    out.place = placed(scene, out.hit.instance, center);
    if (file && file->atoms) {
      const Scene& all = scene.scene();
      std::optional<uint32_t> prototype;
      if (out.hit.instance > 0)
        prototype = all.instances[scene.placed(out.hit.instance).index].prototype;
      name_atom(out, *file->atoms, prototype, geometry.index_of(out.hit.primitive));
    }
  }
  out.material = scene.material_of(out.hit.primitive, out.hit.instance);
  if (const uint32_t object = scene.object_of(out.hit.primitive, out.hit.instance); object > 0)
    out.object += (out.object.empty() ? "" : ", ") + scene.scene().object_names[object - 1];
  out.what = fmt::format(
      "{} {}", tr(kPrimitiveKindNames[size_t(geometry.kind_of(out.hit.primitive))].data()),
      geometry.index_of(out.hit.primitive));
  return out;
}

}  // namespace raio::core::view
