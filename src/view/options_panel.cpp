#include "view/options_panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "accel/grid/grid.h"
#include "integrate/classic.h"
#include "render/figure_options.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

// "0.1", or "0.1 to 0.5".
std::string range_text(const std::vector<float>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  const auto text = [](float value) { return fmt::format("{:.5g}", value); };
  return least == most ? text(least) : trf("{} to {}", text(least), text(most));
}

std::string roughness_text(const Scene& scene) {
  const auto& all = scene.material_roughness;
  return all.empty() ? "0" : range_text({all.begin(), all.end()});
}

std::string light_sizes(const ViewState& state) {
  std::vector<float> sizes;
  for (const Light& light : state.scene->lights) {
    if (light.extent)
      sizes.insert(sizes.end(), {light.extent->width, light.extent->depth});
    else
      sizes.push_back(usual_light_size(light, state.camera.at));
  }
  return sizes.empty() ? tr("no lights") : range_text(sizes);
}

// In the coordinates of the file.
std::string point_text(Vec3f v, Vec3d origin) {
  if (origin == Vec3d()) return fmt::format("{},{},{}", v.x, v.y, v.z);
  const Vec3d p = origin + Vec3d(v);
  return fmt::format("{},{},{}", p.x, p.y, p.z);
}

// The cells of the grid in the picture; another structure has none.
std::string cells_text(const CostFacts& facts) {
  const auto baked = facts.picture ? facts.picture->baked : nullptr;
  if (!baked || baked->info.resolution[0] == 0) return tr("no grid");
  const auto& n = baked->info.resolution;
  return fmt::format("{}x{}x{}", n[0], n[1], n[2]);
}

// Resolved, also those of disabled effects: no field shows 0 for a default.
RenderOptions options_in_use(const ViewState& state, const CostFacts& facts) {
  const Scene& scene = *state.scene;
  const RenderSettings refined =
      resolve_options(state.request(facts.picture_width, facts.picture_height), scene);
  RenderOptions used = state.options;
  set_camera(used, state.camera, scene);
  used.soft_shadows = true, used.dof = true, used.accel.kind = AccelKind::grid;
  if (used.view == View::samples) used.view = View::picture;
  const RenderSettings s = resolve_options(used, scene);
  static_cast<PlainOptions&>(used) = static_cast<const PlainOptions&>(s);
  used.soft_shadows = state.options.soft_shadows, used.dof = refined.dof;
  used.accel.kind = state.options.accel.kind, used.view = state.options.view;
  used.width = facts.picture_width, used.height = facts.picture_height;
  used.samples = refined.samples_per_pixel(), used.sampler = refined.sampler;
  used.fov_deg = s.camera.fov_deg, used.projection = s.camera.projection;
  used.integrator = s.integrator;
  used.background = WrittenColor{.color = s.background, .sky = s.sky};
  used.tone = s.tone, used.shading = s.shading, used.fresnel = s.fresnel;
  used.shutter = {s.shutter_open, s.shutter_close};
  used.opacity = s.accel.opacity;
  const FigureSettings figure = figure_settings(state.options, scene);
  used.look = figure.look, used.sky_light = figure.sky_light, used.key_light = figure.key_light;
  used.occlusion_rays = figure.occlusion_rays;
  used.outline = figure.outline, used.depth_cue = figure.depth_cue;
  return used;
}

// The values in use that are no single number or not an option's.
std::string words_in_use(const OptionSpec& spec, const ViewState& state, const CostFacts& facts) {
  const bool has_cells = state.options.accel.grid_resolution[0] > 0;
  if (spec.name == "from") return point_text(state.camera.from, state.scene->origin);
  if (spec.name == "at") return point_text(state.camera.at, state.scene->origin);
  if (spec.name == "up") return point_text(state.camera.up, {});
  if (spec.name == "light-size") return light_sizes(state);
  if (spec.name == "gloss" || spec.name == "translucency") return roughness_text(*state.scene);
  if (spec.name == "occlusion-distance") return tr("any distance");
  if (spec.name == "fit") return tr("as it is");
  if (spec.name == "channels") return tr("none");
  if (spec.name == "grid-resolution") return cells_text(facts);
  if (spec.name == "grid-factor") {
    const double factor = usual_grid_factor(state.scene->primitive_count());
    return has_cells ? "grid-resolution" : factor > 0 ? fmt::format("{}", factor) : tr("one cell");
  }
  // Refinement takes samples one by one instead.
  const bool refines = state.endless() && state.request(1, 1).samples > 0;
  const bool is_cell = spec.name == "lens-samples" || (spec.name == "aa" && state.options.aa != 1);
  return refines && is_cell ? "samples" : "";
}

std::string shown_value(const OptionSpec& spec, const ViewState& state, const CostFacts& facts,
                        const RenderOptions& used) {
  const bool is_switch = spec.type() == OptionType::toggle && !spec.value.is_optional;
  if (is_switch) return spec.is_given(state.options) ? "true" : "false";
  if (spec.is_given(state.options)) return spec.text(state.options);
  if (std::string words = words_in_use(spec, state, facts); !words.empty()) return words;
  const std::string text = spec.text(used);
  return text.empty() ? std::string(spec.usual) : text;  // a default has no text
}

// One row. Returns the text of a new value, or nothing.
std::optional<std::string> draw_option(const OptionSpec& spec, std::string value) {
  const std::string name(spec.name);
  const char* const label = name.c_str();
  switch (spec.type()) {
    case OptionType::toggle: {
      bool on = value == "true";
      if (!ImGui::Checkbox(label, &on)) return std::nullopt;
      return on ? "true" : "false";
    }
    case OptionType::words: {
      std::optional<std::string> chosen;
      if (!ImGui::BeginCombo(label, value.c_str())) return chosen;
      for (const std::string_view word : spec.words)
        if (ImGui::Selectable(std::string(word).c_str(), word == value)) chosen = word;
      ImGui::EndCombo();
      return chosen;
    }
    case OptionType::integer:
      if (auto number = parse_number<int64_t>(value)) {
        constexpr int64_t kStep = 1, kLargeStep = 10;
        if (!ImGui::InputScalar(label, ImGuiDataType_S64, &*number, &kStep, &kLargeStep))
          return std::nullopt;
        return fmt::format("{}", std::clamp(*number, int64_t(spec.least), int64_t(spec.most)));
      }
      break;
    case OptionType::number:
      if (!spec.value.is_optional) {
        // Words stay until they are dragged or replaced; a range starts at its lower end.
        const auto exact = parse_number<float>(value);
        float number =
            exact ? *exact : parse_number<float>(value.substr(0, value.find(' '))).value_or(0);
        // If the range includes negative values, in even steps from zero.
        const float speed = spec.least < 0 ? 0.01f : std::max(0.005f * std::abs(number), 1e-6f);
        const auto [least, most] = std::pair(float(spec.least), float(spec.most));
        const char* const format = exact ? "%.6g" : value.c_str();
        if (!ImGui::DragFloat(label, &number, speed, least, most, format)) return std::nullopt;
        return fmt::format("{}", std::clamp(number, least, most));
      }
      break;
    default:
      break;
  }
  if (!ImGui::InputText(label, &value, ImGuiInputTextFlags_EnterReturnsTrue)) return std::nullopt;
  return value;
}

// Sets it from text. The error is one line.
std::expected<void, std::string> enter(ViewState& state, const OptionSpec& spec,
                                       std::string_view text, const CostFacts& facts) {
  RenderOptions options = state.options;
  set_camera(options, state.camera, *state.scene);
  if (const auto set = set_option(options, spec, text); !set)
    return std::unexpected(set.error().text("--"));
  if (const auto why = window_conflict(options)) return std::unexpected(why->text("--"));
  ViewState next = state;
  next.options = options;
  if (const auto why = option_conflict(next.request(facts.picture_width, facts.picture_height),
                                       state.scene.get()))
    return std::unexpected(why->text("--"));
  // It fits the window's camera, which the options store as a position.
  const Camera camera = options.fit ? fitted_along(*state.scene, state.camera, *options.fit)
                                    : camera_of(*state.scene, options);
  if (auto why = camera_problem(camera); !why.empty()) return std::unexpected(std::move(why));
  if (camera.projection != state.camera.projection)
    state.set_projection(camera.projection);
  else
    state.camera = camera;
  reset_camera(options);
  state.options = options;
  state.follow_focus();
  return {};
}

}  // namespace

std::string shown_value(const OptionSpec& spec, const ViewState& state, const CostFacts& facts) {
  return shown_value(spec, state, facts, options_in_use(state, facts));
}

void draw_options(ViewState& state, const CostFacts& facts, PanelResult& result) {
  const RenderOptions used = options_in_use(state, facts);
  ImGui::PushItemWidth(9 * em());
  for (const OptionSpec& spec : render_option_table()) {
    if (!spec.of_window) continue;
    const auto entered = draw_option(spec, shown_value(spec, state, facts, used));
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", fmt::format("--{} {}\n{}", spec.name, spec.value_name,
                                          with_settings(option_help(spec), "--"))
                                  .c_str());
    if (!entered) continue;
    if (const auto set = enter(state, spec, *entered, facts); set)
      result.changed = true;
    else
      result.problem = set.error();
  }
  ImGui::PopItemWidth();
}

}  // namespace raio::core::view
