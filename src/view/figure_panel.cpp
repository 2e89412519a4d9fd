#include "view/figure_panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/srgb.h"
#include "io/colormaps.h"
#include "render/figure_options.h"
#include "view/edit.h"
#include "view/panel_parts.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr float kLabelEms = 7.3f, kButtonEms = 5.8f;

// A label at the left; the widget that follows fills the rest of the row.
void label(const char* name, float width_ems = 0) {
  ImGui::AlignTextToFramePadding();
  text(tr(name));
  ImGui::SameLine(kLabelEms * em());
  ImGui::SetNextItemWidth(width_ems > 0 ? width_ems * em() : -FLT_MIN);
}

void heading(const char* name) {
  ImGui::Spacing();
  ImGui::PushFont(heading_font());
  text(tr(name));
  ImGui::PopFont();
}

void wrapped(const std::string& line, const ImVec4& color) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(0);
  text(line);
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void tooltip(const auto& spec) {
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%s", fmt::format("--{} {}\n{}", spec.name, spec.value_name,
                                        with_settings(option_help(spec), "--"))
                                .c_str());
}

// One of the texts, or the first for the default. Returns whether another was chosen.
bool choose(const char* id, const std::string& shown, std::vector<std::string> texts,
            const std::string& usual, std::string& chosen) {
  bool changed = false;
  if (!ImGui::BeginCombo(id, shown.c_str(), ImGuiComboFlags_HeightLarge)) return false;
  texts.insert(texts.begin(), "");
  for (const std::string& one : texts)
    if (ImGui::Selectable((one.empty() ? usual : one).c_str(), one == chosen))
      chosen = one, changed = true;
  ImGui::EndCombo();
  return changed;
}

class FigurePanel {
 public:
  FigurePanel(ViewState& state, const FigureFacts& facts, FigureResult& result,
              std::string& problem)
      : state_(state), facts_(facts), result_(result), problem_(problem) {}

  bool draw() {
    const ReadChoices none;
    const ReadChoices& has = state_.file ? state_.file->choices : none;
    if (state_.frames() > 1) draw_frames();
    if (has.atoms) draw_atoms(has);
    if (has.points && !has.columns.empty()) draw_colors(has);
    if (has.mesh) draw_smooth();
    heading("Light and lines");
    draw_light();
    if (state_.file) draw_annotations();
    heading("For print");
    draw_print();
    return changed_;
  }

 private:
  // --- the file's reader
  std::string asked(std::string_view option) const {
    return read_option_of(option).text(facts_.read);
  }
  void ask(std::string_view option, std::string text) {
    result_.reads.push_back({&read_option_of(option), std::move(text)});
  }

  // Why the file could not be read with the last change.
  void draw_problem(std::string_view option) const {
    const FigureForm& form = state_.form;
    if (form.option == option && !form.problem.empty())
      wrapped(with_settings(form.problem, ""), palette().bad);
  }

  void combo(const char* name, std::string_view option, const std::vector<std::string>& texts,
             const std::string& usual) {
    std::string chosen = asked(option);
    label(name);
    ImGui::PushID(name);
    if (choose("##combo", chosen.empty() ? usual : chosen, texts, usual, chosen))
      ask(option, chosen);
    tooltip(read_option_of(option));
    ImGui::PopID();
    draw_problem(option);
  }

  void field(const char* name, std::string_view option, const char* hint) {
    FigureForm& form = state_.form;
    std::string typed = form.option == option ? form.typed : asked(option);
    label(name);
    ImGui::PushID(name);
    if (ImGui::InputTextWithHint("##field", hint, &typed)) {
      form.option = option, form.typed = typed;
      form.problem.clear();
    }
    // By Enter or by a click elsewhere.
    if (ImGui::IsItemDeactivatedAfterEdit()) ask(option, form.typed);
    tooltip(read_option_of(option));
    ImGui::PopID();
    draw_problem(option);
  }

  void draw_frames() {
    const int frames = state_.frames();
    int frame = facts_.read.frame < 0 ? frames + facts_.read.frame : facts_.read.frame;
    FigureForm& form = state_.form;
    if (ImGui::Button(fmt::format("{}###play", form.plays ? tr("Pause") : tr("Play")).c_str(),
                      {kButtonEms * em(), 0}))
      form.plays = !form.plays;
    ImGui::SameLine(kLabelEms * em());
    ImGui::SetNextItemWidth(-FLT_MIN);
    const std::string shown = trf("frame {} of {}", "%d", frames - 1);
    if (ImGui::SliderInt("##frame", &frame, 0, frames - 1, shown.c_str(),
                         ImGuiSliderFlags_AlwaysClamp)) {
      form.plays = false;
      ask("frame", fmt::format("{}", frame));
    }
    label("speed");
    (void)ImGui::SliderInt("##rate", &form.frames_per_s, 1, 60, tr("%d frames per second"),
                           ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
    draw_problem("frame");
  }

  void draw_atoms(const ReadChoices& has) {
    heading("Atoms");
    const auto& style = read_option_of("style");
    std::vector<std::string> styles(style.words.begin(), style.words.end());
    combo("style", "style", styles, trf("automatic: {}", styles[size_t(has.style)]));
    field("only", "only", tr("all"));
    field("hide", "hide", tr("for example water, ion"));
    field("show", "show", tr("even if hidden"));
    if (has.style == AtomStyle::points || facts_.read.radius > 0) draw_radius();
    if (has.assemblies > 0) {
      std::vector<std::string> texts = {"none"};
      for (int i = 1; i <= has.assemblies; ++i) texts.push_back(fmt::format("{}", i));
      combo("assembly", "assembly", texts,
            trf("automatic: {}", has.assembly > 0 ? fmt::format("{}", has.assembly) : "none"));
    }
    if (!has.has_cell) return;
    bool cell = facts_.read.cell.value_or(has.cell);
    label("unit cell");
    if (ImGui::Checkbox("##cell", &cell)) ask("cell", cell ? "true" : "false");
    tooltip(read_option_of("cell"));
    draw_problem("cell");
    std::array<int, 3> images = facts_.read.images;
    label("images");
    if (ImGui::SliderInt3("##images", images.data(), 1, 8, "%d"))
      ask("images",
          fmt::format("{},{},{}", std::clamp(images[0], 1, kMaxImages),
                      std::clamp(images[1], 1, kMaxImages), std::clamp(images[2], 1, kMaxImages)));
    tooltip(read_option_of("images"));
    draw_problem("images");
  }

  void draw_radius() {
    float radius = facts_.read.radius;
    label("radius");
    if (ImGui::DragFloat("##radius", &radius, 0.01f, 0, 1e6f,
                         radius > 0 ? "%.3g" : tr("automatic")))
      ask("radius", radius > 0 ? fmt::format("{:.3g}", radius) : "");
    tooltip(read_option_of("radius"));
    draw_problem("radius");
  }

  void draw_colors(const ReadChoices& has) {
    heading("Colours");
    combo("colour by", "color-by", has.columns,
          !has.atoms                     ? std::string(tr("the file's colours"))
          : facts_.read.color_by.empty() ? trf("automatic: {}", has.color_by)
                                         : std::string(tr("automatic")));
    if (has.atoms) field("colours of", "color-atoms", tr("for example chain A: navy"));
    const auto& scale = state_.file->colors;
    if (!has.atoms && !state_.scene->spheres.empty()) draw_radius();
    if (!scale) return;
    const auto& map = read_option_of("colormap");
    combo("colour map", "colormap", {map.words.begin(), map.words.end()},
          trf("automatic: {}", kColormaps[0]));
    draw_map(scale->map);
    bool automatic = !facts_.read.color_range;
    std::array<double, 2> range =
        facts_.read.color_range.value_or(std::array{scale->least, scale->most});
    label("from, to");
    const auto speed = float(std::max(std::abs(scale->most - scale->least) / 200, 1e-30));
    if (ImGui::DragScalarN("##range", ImGuiDataType_Double, range.data(), 2, speed, nullptr,
                           nullptr, "%.6g"))
      ask("color-range", fmt::format("{:.6g},{:.6g}", range[0], range[1]));
    tooltip(read_option_of("color-range"));
    label("");
    if (ImGui::Checkbox(tr("smallest to largest"), &automatic))
      ask("color-range", automatic ? "" : fmt::format("{:.6g},{:.6g}", range[0], range[1]));
    draw_problem("color-range");
  }

  static void draw_map(std::string_view name) {
    label("");
    const ImVec2 lo = ImGui::GetCursorScreenPos();
    const float wide = ImGui::GetContentRegionAvail().x, high = 0.6f * em();
    constexpr int kSteps = 64;
    for (int i = 0; i < kSteps; ++i) {
      const Rgb c = map_color(name, float(i) / (kSteps - 1)).value_or(Rgb());
      const auto byte = [](float x) { return int(to_byte(srgb_from_linear(x))); };
      ImGui::GetWindowDrawList()->AddRectFilled({lo.x + wide * float(i) / kSteps, lo.y},
                                                {lo.x + wide * float(i + 1) / kSteps, lo.y + high},
                                                IM_COL32(byte(c.x), byte(c.y), byte(c.z), 255));
    }
    ImGui::Dummy({wide, high});
  }

  void draw_smooth() {
    heading("Mesh");
    constexpr float kUsual = 40;
    float degrees = facts_.read.smooth.value_or(kUsual);
    label("smooth edges");
    const std::string form = facts_.read.smooth ? "%.0f°" : tr("automatic");
    if (ImGui::SliderFloat("##smooth", &degrees, 0, 180, form.c_str(),
                           ImGuiSliderFlags_AlwaysClamp))
      ask("smooth", fmt::format("{:.0f}", degrees));
    tooltip(read_option_of("smooth"));
    draw_problem("smooth");
  }

  // --- options of the picture
  void set(std::string_view option, const std::string& value) {
    const OptionSpec& spec = option_of(option);
    RenderOptions options = state_.options;
    if (value.empty()) {
      spec.value.reset(options);
    } else if (const auto done = set_option(options, spec, value); !done) {
      problem_ = done.error().text("--");
      return;
    }
    ViewState next = state_;
    next.options = options;
    if (const auto why = option_conflict(next.request(512, 512), state_.scene.get())) {
      problem_ = why->text("--");
      return;
    }
    state_.options = options;
    changed_ = true;
  }

  void number(const char* name, std::string_view option, float value, float least, float most,
              const char* form) {
    label(name);
    ImGui::PushID(name);
    if (ImGui::SliderFloat("##number", &value, least, most, form, ImGuiSliderFlags_AlwaysClamp))
      set(option, fmt::format("{:.3g}", value));
    tooltip(option_of(option));
    ImGui::PopID();
  }

  void on_or_off(const char* name, std::string_view option, bool on, const char* yes,
                 const char* no) {
    label(name);
    ImGui::PushID(name);
    if (ImGui::Checkbox("##switch", &on)) set(option, on ? yes : no);
    tooltip(option_of(option));
    ImGui::PopID();
  }

  void draw_light() {
    RenderOptions picture = state_.options;
    picture.view = View::picture;
    const RenderSettings used = resolve_options(picture, *state_.scene);
    const FigureSettings& figure = used.figure;
    std::string look = option_of("look").text(state_.options);
    if (const size_t end = look.find('-'); end != std::string::npos) look.resize(end);
    label("look");
    if (choose("##look", look.empty() ? std::string(kLooks[0]) : look,
               {kLooks.begin() + 1, kLooks.end()}, std::string(kLooks[0]), look))
      set("look", look);
    tooltip(option_of("look"));
    draw_background(used);
    number("opacity", "opacity", state_.options.opacity.value_or(1), 0, 1, "%.2f");
    on_or_off("key light", "key-light", figure.key_light == KeyLight::on, "on", "off");
    number("outline", "outline", figure.outline, 0, 8, "%.1f px");
    number("depth cue", "depth-cue", figure.depth_cue, 0, 1, "%.2f");
    int rays = figure.occlusion_rays;
    label("occlusion");
    if (ImGui::SliderInt("##rays", &rays, 1, 32, tr("%d rays to the sky"),
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic))
      set("occlusion-rays", fmt::format("{}", rays));
    tooltip(option_of("occlusion-rays"));
    const Box3f& box = state_.box;
    const float size = box.empty() ? 1 : length(box.size());
    float reach = figure.occlusion_distance;
    label("reach");
    if (ImGui::DragFloat("##reach", &reach, size / 400, 0, 1e30f,
                         reach > 0 ? "%.3g" : tr("any distance")))
      set("occlusion-distance", reach > 0 ? fmt::format("{:.3g}", reach) : "");
    tooltip(option_of("occlusion-distance"));
    on_or_off("page shadow", "shadow-catcher", figure.shadow_catcher, "true", "");
    bool parallel = state_.camera.is_parallel();
    label("parallel rays");
    if (ImGui::Checkbox("##parallel", &parallel)) {
      state_.set_projection(parallel ? core::Projection::orthographic
                                     : core::Projection::perspective);
      changed_ = true;
    }
  }

  void draw_background(const RenderSettings& used) {
    if (used.sky) return;
    const auto display = [](float x) { return std::clamp(srgb_from_linear(x), 0.0f, 1.0f); };
    float color[3] = {display(used.background.x), display(used.background.y),
                      display(used.background.z)};
    const bool own = state_.options.background.has_value();
    label("background", own ? 7 : 0);
    if (ImGui::ColorEdit3("##background", color, ImGuiColorEditFlags_DisplayHex)) {
      const auto byte = [](float x) { return int(to_byte(x)); };
      set("background",
          fmt::format("#{:02x}{:02x}{:02x}", byte(color[0]), byte(color[1]), byte(color[2])));
    }
    tooltip(option_of("background"));
    if (!own) return;
    ImGui::SameLine();
    if (ImGui::Button(tr("the look's"))) {
      state_.options.background.reset();
      changed_ = true;
    }
  }

  void draw_annotations() {
    heading("On the picture");
    const auto box = [this](const char* name, bool& on, bool has, const char* why) {
      ImGui::BeginDisabled(!has);
      bool shown = on && has;
      if (ImGui::Checkbox(tr(name), &shown)) on = shown, changed_ = true;
      ImGui::EndDisabled();
      if (!has && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s", tr(why));
    };
    app::Annotations& some = state_.annotations;
    box("colour bar", some.color_bar, state_.file->colors.has_value(),
        "Nothing is coloured by numbers.");
    ImGui::SameLine();
    box("legend", some.legend, !state_.file->legend.empty(), "The colours have no names.");
    ImGui::SameLine();
    box("scale bar", some.scale_bar, true, "");
    if (!state_.file->colors) return;
    bool left = some.color_bar_side == "left";
    if (ImGui::Checkbox(tr("colour bar at the left"), &left))
      some.color_bar_side = left ? "left" : "right", changed_ = true;
  }

  // --- print
  void draw_print() {
    FigureForm& form = state_.form;
    label("width");
    (void)ImGui::DragFloat("##width", &form.width_mm, 0.5f, 1, 2000, "%.4g mm",
                           ImGuiSliderFlags_AlwaysClamp);
    label("resolution");
    (void)ImGui::DragInt("##dpi", &form.dpi, 1, 10, 2400, "%d dpi", ImGuiSliderFlags_AlwaysClamp);
    const RenderSettings picture = resolve_options(
        state_.print_request(facts_.picture_width, facts_.picture_height), *state_.scene);
    label("");
    faint_text(trf("{} x {} pixels", picture.width, picture.height));
    if (state_.endless()) {
      label("samples");
      (void)ImGui::DragInt("##samples", &form.samples, 1, 1, 65536, tr("%d per pixel"),
                           ImGuiSliderFlags_AlwaysClamp);
    }
    label("transparent");
    (void)ImGui::Checkbox("##transparent", &form.transparent);
    if (facts_.printed) {
      ImGui::ProgressBar(float(*facts_.printed), {-5 * em(), 0});
      ImGui::SameLine();
      if (ImGui::Button(tr("Stop"), {-FLT_MIN, 0})) result_.stops_printing = true;
      return;
    }
    if (ImGui::Button(tr("Save"), {kButtonEms * em(), 0})) result_.prints = true;
    ImGui::SameLine(kLabelEms * em());
    if (ImGui::Button(tr("copy as command"))) result_.copies_print = true;
  }

  ViewState& state_;
  const FigureFacts& facts_;
  FigureResult& result_;
  std::string& problem_;
  bool changed_ = false;
};

}  // namespace

bool draw_figure(ViewState& state, const FigureFacts& facts, FigureResult& result,
                 std::string& problem) {
  ImGui::PushID("figure");  // some have the same names as options
  const bool changed = FigurePanel(state, facts, result, problem).draw();
  ImGui::PopID();
  return changed;
}

}  // namespace raio::core::view
