#include "view/scene_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "view/edit.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr int kColorFlags = ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR;

// Proportional to the distance of the point looked at.
float speed_of(const Camera& camera) {
  return float(length(Vec3d(camera.at) - Vec3d(camera.from))) / 300;
}

bool vector_field(const char* label, Vec3f& v, float speed) {
  return ImGui::DragScalarN(label, ImGuiDataType_Float, &v.x, 3, speed, nullptr, nullptr, "%.4g");
}

bool number_field(const char* label, float& value, float least, float most) {
  const float before = value;
  (void)ImGui::DragFloat(label, &value, (most - least) / 400, least, most, "%.4g",
                         ImGuiSliderFlags_AlwaysClamp);
  return value != before;
}

bool draw_camera(ViewState& state) {
  Camera camera = state.camera;
  // In the coordinates of the file.
  const auto field = [&](const char* label, Vec3f& v) {
    Vec3d plain = state.scene->origin + Vec3d(v);
    const double speed = double(speed_of(camera));
    if (!ImGui::DragScalarN(label, ImGuiDataType_Double, &plain.x, 3, float(speed), nullptr,
                            nullptr, "%.4g"))
      return false;
    v = Vec3f(plain - state.scene->origin);
    return true;
  };
  bool changed = field(tr("from"), camera.from);
  changed |= field(tr("at"), camera.at);
  changed |= vector_field(tr("up"), camera.up, 0.01f);
  changed |= number_field(tr("angle"), camera.fov_deg, 1, 170);
  bool parallel = camera.is_parallel();
  if (ImGui::Checkbox(tr("parallel rays"), &parallel)) {
    state.set_projection(parallel ? core::Projection::orthographic : core::Projection::perspective);
    return true;
  }
  if (!changed || !is_finite(camera.from) || !is_finite(camera.at) || !is_finite(camera.up) ||
      !camera_problem(camera).empty())
    return false;
  state.camera = camera;
  state.follow_focus();
  return true;
}

// Light has no upper limit, so the widget has none.
bool color_field(const char* label, Rgb& color) {
  if (!ImGui::ColorEdit3(label, &color.x, kColorFlags)) return false;
  for (int i = 0; i < 3; ++i) color[i] = std::max(color[i], 0.0f);
  return true;
}

bool draw_background(ViewState& state) {
  const RenderSettings settings = resolve_options(state.options, *state.scene);
  Rgb color = settings.background;
  if (settings.sky) {
    faint_text(trf("background: the sky {}", settings.sky->folder));
    if (!ImGui::Button(tr("use a colour instead"))) return false;
  } else if (!color_field(tr("background"), color)) {
    return false;
  }
  if (state.scene->dialect == Dialect::data) {  // its own is not shown
    state.options.background = WrittenColor{.color = color};
    return true;
  }
  state.options.background.reset();
  state.scene = edited(state.scene, [&](Scene& s) {
    s.background = color;
    s.sky = nullptr, s.requests.sky_folder.clear();
  });
  return true;
}

// Selects one of `count` items: "2 of 3", with arrows.
void choose(const char* label, int& chosen, size_t count) {
  chosen = std::clamp(chosen, 0, std::max(0, int(count) - 1));
  int number = chosen + 1;
  if (ImGui::InputInt(label, &number, 1, 10)) chosen = std::clamp(number, 1, int(count)) - 1;
}

bool draw_lights(ViewState& state) {
  const auto& lights = state.scene->lights;
  bool changed = false;
  if (state.is_figure()) faint_text(tr("Figures are lit by a sky instead."));
  ImGui::BeginDisabled(state.is_figure());
  if (!lights.empty()) {
    choose(trf("light of {}###light", lights.size()).c_str(), state.chosen_light, lights.size());
    Light light = lights[size_t(state.chosen_light)];
    light.position = light.position + Vec3f(state.scene->origin);
    changed = vector_field(tr("position"), light.position, speed_of(state.camera));
    bool has_color = light.color.has_value();
    if (ImGui::Checkbox(tr("own colour"), &has_color)) {
      changed = true;
      light.color = has_color ? std::optional(Rgb(1)) : std::nullopt;
    }
    Rgb color = light.color.value_or(Rgb(1 / std::sqrt(float(lights.size()))));
    ImGui::BeginDisabled(!has_color);
    if (color_field(tr("its light"), color)) {
      changed = true;
      light.color = color;
    }
    ImGui::EndDisabled();
    light.position = light.position - Vec3f(state.scene->origin);
    if (changed && is_finite(light.position))
      state.scene =
          edited(state.scene, [&](Scene& s) { s.lights[size_t(state.chosen_light)] = light; });
  }
  if (ImGui::Button(tr("add a light"))) {
    // Above the camera's left shoulder, where it lights the visible side.
    const Camera& c = state.camera;
    Light light{c.from + (c.from - c.at) * 0.2f + normalize(c.up) * length(c.from - c.at) * 0.5f,
                lights.empty() ? std::nullopt : lights.front().color};
    state.scene = edited(state.scene, [&](Scene& s) { s.lights.push_back(light); });
    state.chosen_light = int(state.scene->lights.size()) - 1;
    changed = true;
  }
  ImGui::SameLine();
  ImGui::BeginDisabled(state.scene->lights.empty());
  if (ImGui::Button(tr("remove"))) {
    const auto which = state.chosen_light;
    state.scene = edited(state.scene, [&](Scene& s) { s.lights.erase(s.lights.begin() + which); });
    changed = true;
  }
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  return changed;
}

bool draw_material(ViewState& state) {
  const auto& materials = state.scene->materials;
  if (materials.empty()) return false;
  choose(trf("material of {}###material", materials.size()).c_str(), state.chosen_material,
         materials.size());
  Material m = materials[size_t(state.chosen_material)];
  bool changed = color_field(tr("colour"), m.color);
  changed |= number_field(tr("diffuse Kd"), m.kd, 0, 1);
  ImGui::BeginDisabled(state.is_figure());
  changed |= number_field(tr("mirror Ks"), m.ks, 0, 1);
  changed |= number_field(tr("shine"), m.shine, 0, 1000);
  changed |= number_field(tr("glass T"), m.transmission, 0, 1);
  changed |= number_field(tr("index of refraction"), m.ior, 0.1f, 4);
  ImGui::EndDisabled();
  if (m.transmission > 0 && !(m.ior > 0)) m.ior = 1;  // as files require
  if (changed)
    state.scene =
        edited(state.scene, [&](Scene& s) { s.materials[size_t(state.chosen_material)] = m; });
  faint_text(tr("A click in the picture chooses the material."));
  return changed;
}

void heading(const char* name) {
  ImGui::Spacing();
  ImGui::PushFont(heading_font());
  text(name);
  ImGui::PopFont();
}

}  // namespace

bool draw_material_color(ViewState& state, MaterialId id) {
  if (id >= state.scene->materials.size()) return false;
  Rgb color = state.scene->materials[id].color;
  if (!color_field(tr("the material's colour"), color)) return false;
  state.scene = edited(state.scene, [&](Scene& s) { s.materials[id].color = color; });
  return true;
}

bool draw_scene(ViewState& state) {
  ImGui::PushItemWidth(11 * em());
  heading(tr("Camera"));
  bool changed = draw_camera(state);
  changed |= draw_background(state);
  heading(tr("Lights"));
  ImGui::PushID("light");
  changed |= draw_lights(state);
  ImGui::PopID();
  heading(tr("Materials"));
  ImGui::PushID("material");
  changed |= draw_material(state);
  ImGui::PopID();
  ImGui::PopItemWidth();
  return changed;
}

}  // namespace raio::core::view
