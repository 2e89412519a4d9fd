// The inspector's panel.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "view/inspector.h"
#include "view/panel_parts.h"
#include "view/selection.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

using Kind = ExplainedRay::Kind;

template <class T>
std::string exact(Vec3<T> v) {
  return fmt::format("{} {} {}", v.x, v.y, v.z);
}
template <class T>
std::string brief(Vec3<T> v) {
  return fmt::format("{:.4g}  {:.4g}  {:.4g}", v.x, v.y, v.z);
}

void row(const char* name, const std::string& value, const std::string& in_full = {}) {
  constexpr float kColumn = 7, kIndent = 1;  // em
  faint_text(name);
  // Below the name, rather than broken, if both are too long for a line.
  const bool fits =
      ImGui::CalcTextSize(name).x < (kColumn - 0.5f) * em() &&
      ImGui::CalcTextSize(value.c_str()).x <= ImGui::GetContentRegionAvail().x - kColumn * em();
  if (fits)
    ImGui::SameLine(kColumn * em());
  else
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + kIndent * em());
  ImGui::PushTextWrapPos(0);
  text(value);
  ImGui::PopTextWrapPos();
  if (!in_full.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", in_full.c_str());
}
// A place of the file in a scene with coordinates up to `largest`.
void place_row(const char* name, Vec3d place, double largest) {
  row(name, brief(rounded_place(place, largest)), exact(place));
}
template <class T>
void row(const char* name, Vec3<T> v) {
  row(name, brief(v), exact(v));
}

void number_row(const char* name, float x) {
  row(name, fmt::format("{:.5g}", x), fmt::format("{}", x));
}

void wrapped(const std::string& line) {
  ImGui::PushTextWrapPos(0);
  text(line);
  ImGui::PopTextWrapPos();
}

void faint_wrapped(const std::string& line) {
  ImGui::PushTextWrapPos(0);
  faint_text(line);
  ImGui::PopTextWrapPos();
}

ImVec4 patch_of(Vec3d c) {
  const auto part = [](double v) { return float(to_byte(float(v))) / 255; };
  return {part(c.x), part(c.y), part(c.z), 1};
}

void draw_bounce(const ExplainedRay::Bounce& b) {
  row(tr("diffuse"), b.diffuse);
  if (b.mirror != Rgb()) row(tr("metal"), b.mirror);
  if (b.coat != Rgb()) row(tr("dielectric"), b.coat);
  if (b.glass > 0) number_row(tr("glass"), b.glass);
  number_row(tr("roughness"), b.roughness);
  if (b.clearcoat > 0) number_row(tr("clear coat"), b.clearcoat);
  if (b.sheen != Rgb()) row(tr("sheen"), b.sheen);
  if (b.transmittance != Rgb(1)) row(tr("medium"), b.transmittance);
  if (b.emission == Rgb()) return;
  row(tr("emission"), b.emission);
  number_row("w", b.emission_weight);
}

}  // namespace

// The pixel and its buttons stay in place while the rest scrolls.
InspectorResult Inspector::draw_panel(const Rect& where, double now) {
  InspectorResult result;
  begin_panel("inspector", where, false);
  draw_head(result);
  ImGui::BeginChild("rest", {}, false, ImGuiWindowFlags_AlwaysVerticalScrollbar);
  if (found_ && !has_pixel()) draw_region();
  if (has_pixel() && !result.closed) draw_sections(now);
  ImGui::EndChild();
  ImGui::End();
  return result;
}

void Inspector::draw_sections(double now) {
  if (open_section("Tree of rays", true)) {
    // As high as its lines, up to a limit.
    const float lines = ImGui::GetTextLineHeightWithSpacing() * float(children_.size() + 1);
    ImGui::BeginChild("tree", {0, std::min(lines, 16 * em())}, false,
                      ImGuiWindowFlags_HorizontalScrollbar);
    draw_tree(0);
    ImGui::EndChild();
  }
  if (open_section("Step by step", true)) draw_walk(now);
  if (open_section("The ray", true)) draw_ray();
  if (open_section("Contributions to the colour", true)) draw_sum();
}

void Inspector::draw_head(InspectorResult& result) {
  result.closed = ImGui::Button("<");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tr("Back to the panel (Escape)"));
  ImGui::SameLine();
  ImGui::PushFont(heading_font());
  const InspectionRequest& q = request_;
  text(q.is_region() ? trf("Pixels {},{} to {},{}", q.pixel[0], q.pixel[1], q.last[0], q.last[1])
                     : trf("Pixel {},{} of {} x {}", q.pixel[0], q.pixel[1], q.options.width,
                           q.options.height));
  ImGui::PopFont();
  if (!found_) return faint_text(tr("tracing ..."));
  if (const int samples = found_->settings.samples_per_pixel(); samples > 1) {
    int sample = request_.sample;
    ImGui::SetNextItemWidth(9 * em());
    if (ImGui::SliderInt("##sample", &sample, 0, samples - 1,
                         fmt::format("{} %d", tr("sample")).c_str()))
      restart(std::clamp(sample, 0, samples - 1));
    ImGui::SameLine();
    if (ImGui::Button("-")) restart(std::max(0, request_.sample - 1));
    ImGui::SameLine();
    if (ImGui::Button("+")) restart(std::min(samples - 1, request_.sample + 1));
    ImGui::SameLine();
    faint_text(trf("of {}", samples));
  }
  if (has_pixel()) {
    const Vec3d rgb = found_->sample.rgb;
    ImGui::ColorButton("##rgb", patch_of(rgb), ImGuiColorEditFlags_NoTooltip,
                       {2 * em(), ImGui::GetFrameHeight()});
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    text(brief(Vec3f(rgb)));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", exact(Vec3f(rgb)).c_str());
  }
  if (ImGui::Button(tr("from the side"))) result.camera = side_camera();
  ImGui::SameLine();
  if (ImGui::Button(tr("from the eye"))) result.camera = eye_;
  if (!has_pixel()) return;
  std::string places;
  for (const char* suffix : {".svg", ".png", ".json"}) {
    std::string name(suffix + 1);
    std::ranges::transform(name, name.begin(), [](char c) { return char(c - 'a' + 'A'); });
    if (name != "SVG") ImGui::SameLine();
    if (ImGui::Button(name.c_str())) result.save = suffix;
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    places += fmt::format(" {} {:.0f},{:.0f}", name, (lo.x + hi.x) / 2, (lo.y + hi.y) / 2);
  }
  ImGui::SameLine();
  result.copied = ImGui::Button(tr("copy command"));
  result.copied_text = ImGui::Button(tr("copy as text"));
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%s", tr("Copies all rays with their numbers, as raio explain prints them"));
  copied_ |= result.copied_text;
  if (copied_) {
    ImGui::SameLine();
    faint_text(tr("copied"));
  }
  if (button_places_.empty()) button_places_ = places;
}

void Inspector::draw_region() {
  std::array<size_t, kRayKinds> counts{};
  int deepest = 1;
  size_t shown = 0;
  for (const RegionRay& r : found_->rays) {
    ++counts[size_t(r.kind)], deepest = std::max(deepest, r.level);
    shown += filter_.passes(r);
  }
  faint_text(number_of(found_->pixels, "pixel inspected", "pixels inspected"));
  bool changed = false;
  for (int k = 0; k < kRayKinds; ++k) {
    ImGui::PushStyleColor(ImGuiCol_CheckMark, ImGui::ColorConvertU32ToFloat4(color_of(RayKind(k))));
    changed |= ImGui::Checkbox(tr(name_of(RayKind(k))), &filter_.kinds[size_t(k)]);
    ImGui::PopStyleColor();
    ImGui::SameLine(11 * em());
    text(fmt::format("{}", counts[size_t(k)]));
  }
  ImGui::PushItemWidth(9 * em());
  filter_.level = std::min(filter_.level, deepest);
  changed |= ImGui::SliderInt(tr("level"), &filter_.level, 0, deepest,
                              filter_.level == 0 ? tr("all") : "%d");
  using Hits = RayFilter::Hits;
  const auto kind_name = [](size_t k) { return tr(kPrimitiveKindNames[k].data()); };
  const std::string chosen = filter_.hits == Hits::anything  ? tr("anything")
                             : filter_.hits == Hits::nothing ? tr("background")
                             : filter_.hits == Hits::kind    ? kind_name(size_t(filter_.number))
                                                             : trf("material {}", filter_.number);
  if (ImGui::BeginCombo(tr("hits"), chosen.c_str())) {
    const auto offer = [&](const std::string& name, Hits hits, int number) {
      if (!ImGui::Selectable(name.c_str(), filter_.hits == hits && filter_.number == number))
        return;
      filter_.hits = hits, filter_.number = number, changed = true;
    };
    offer(tr("anything"), Hits::anything, 0);
    offer(tr("background"), Hits::nothing, 0);
    for (size_t k = 0; k < kPrimitiveKinds; ++k) offer(kind_name(k), Hits::kind, int(k));
    const size_t materials = std::min<size_t>(found_->request.scene->materials.size(), 200);
    for (size_t m = 0; m < materials; ++m) offer(trf("material {}", m), Hits::material, int(m));
    ImGui::EndCombo();
  }
  ImGui::PopItemWidth();
  faint_text(trf("{} of {} rays shown", shown, found_->rays.size()));
  if (changed) update_scene();
}

void Inspector::draw_tree(int ray) {
  const auto& below = children_[size_t(ray)];
  ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_DefaultOpen | ImGuiTreeNodeFlags_OpenOnArrow |
                             ImGuiTreeNodeFlags_SpanAvailWidth;
  if (below.empty()) flags |= ImGuiTreeNodeFlags_Leaf;
  if (ray == ray_) flags |= ImGuiTreeNodeFlags_Selected;
  const ImVec4 ink =
      ImGui::ColorConvertU32ToFloat4(color_of(kind_of(found_->sample.rays[size_t(ray)])));
  ImGui::PushStyleColor(ImGuiCol_Text, ink);
  const bool is_open =
      ImGui::TreeNodeEx(fmt::format("{}###ray{}", label_of(ray), ray).c_str(), flags);
  ImGui::PopStyleColor();
  if (ray == ray_ && std::exchange(brings_ray_in_, false)) ImGui::SetScrollHereY();
  if (ImGui::IsItemClicked() && !ImGui::IsItemToggledOpen()) playing_ = false, choose(ray, -1);
  if (!is_open) return;
  for (const bool shadow : {true, false})
    for (const int child : below)
      if ((found_->sample.rays[size_t(child)].kind == Kind::shadow) == shadow) draw_tree(child);
  ImGui::TreePop();
}

void Inspector::draw_walk(double now) {
  const std::pair<const char*, Walk> buttons[] = {{"|<", Walk::first},
                                                  {"<##back", Walk::back},
                                                  {nullptr, Walk::play},
                                                  {">##on", Walk::on},
                                                  {">|", Walk::last}};
  for (const auto& [name, where] : buttons) {
    if (where != Walk::first) ImGui::SameLine();
    const bool pressed =
        name ? ImGui::Button(name, {1.9f * em(), 0})
             : ImGui::Button(fmt::format("{}###play", playing_ ? tr("stop") : tr("play")).c_str(),
                             {4 * em(), 0});
    if (pressed) (void)walk(where, now);
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  ImGui::SliderFloat("##speed", &speed_, 0.5f, 1000, "%.3g/s", ImGuiSliderFlags_Logarithmic);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tr("Steps per second"));
  if (steps_.empty()) return faint_text(tr("The ray has no steps"));
  int step = step_ + 1;
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt(
          "##step", &step, 0, int(steps_.size()),
          step == 0 ? tr("all of the ray") : trf("step %d of {}", steps_.size()).c_str()))
    playing_ = false, choose(ray_, step - 1);
  if (step_ < 0) return faint_wrapped(tr("Press play, or the keys , and . for single steps"));
  // Of constant height, so that nothing jumps between steps.
  ImGui::BeginChild("step", {0, 17 * em()});
  const TraversalStep& s = steps_[size_t(step_)];
  wrapped(s.words);
  if (!s.formula.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, palette().accent);
    wrapped(s.formula);
    ImGui::PopStyleColor();
  }
  for (const auto& [name, value] : s.variables) row(name.c_str(), value);
  ImGui::EndChild();
}

void Inspector::draw_ray() const {
  const ExplainedRay& r = found_->sample.rays[size_t(ray_)];
  place_row(tr("origin"), place(r.ray.origin), found_->request.largest);
  row(tr("direction"), r.ray.dir);
  row(tr("weight"),
      trf("{} of the pixel's colour",
          r.weight == Rgb(r.weight.x) ? fmt::format("{:.4g}", r.weight.x) : brief(r.weight)),
      exact(r.weight));
  if (r.kind == Kind::shadow) {
    const auto& bounce = found_->sample.rays[size_t(r.parent)].bounce;
    if (bounce) return draw_sampled_light(ray_, *bounce);
    row(tr("light"), label_of(ray_));
    return draw_terms(r);
  }
  if (r.surface)
    draw_surface(r);
  else
    row(tr("background"), r.background);
  row(tr("adds"), r.adds);
}

void Inspector::draw_surface(const ExplainedRay& r) const {
  const ExplainedRay::Surface& s = *r.surface;
  row(tr("hits"), app::name_of(found_->baked->accel->geometry(), r.hit.primitive));
  number_row("t", r.hit.t);
  place_row(tr("point"), place(s.point), found_->request.largest);
  row(tr("normal"), s.normal);
  if (s.geometric != s.normal) row(tr("flat normal"), s.geometric);
  row(tr("material"), fmt::format("{}", s.material));
  if (r.bounce) {
    draw_bounce(*r.bounce);
    for (const int k : children_[size_t(ray_)])
      if (found_->sample.rays[size_t(k)].kind == Kind::shadow) draw_sampled_light(k, *r.bounce);
    return row("C", s.radiance);
  }
  row(tr("colour"), s.color);
  number_row("Kd", s.kd), number_row("Ks", s.ks);
  if (s.specular != Rgb(1)) row(tr("its colour"), s.specular);
  number_row("Shine", s.shine), number_row("T", s.transmission);
  number_row(tr("refractive index"), s.ior);
  if (s.gloss > 0) number_row(tr("gloss"), s.gloss);
  if (s.translucency > 0) number_row(tr("translucency"), s.translucency);
  if (s.transmission > 0) {
    number_row("eta", s.eta), number_row("cos", s.cosine);
    if (s.cosine2_behind >= 0)
      number_row("cos'", std::sqrt(s.cosine2_behind));
    else
      row("cos'", tr("total internal reflection"));
    if (s.reflectance) number_row("Kr", *s.reflectance);
  }
  row(tr("ambient"), r.ambient);
  for (const int k : children_[size_t(ray_)]) {
    const ExplainedRay& light = found_->sample.rays[size_t(k)];
    if (light.kind != Kind::shadow) continue;
    row(fmt::format("{} {}", tr("light"), light.light).c_str(), label_of(k));
    if (!light.occluded) draw_terms(light);
  }
  row("C", s.radiance);
}

void Inspector::draw_sampled_light(int shadow, const ExplainedRay::Bounce& b) const {
  row(tr("light"), label_of(shadow));
  row("L", found_->sample.rays[size_t(shadow)].ray.dir);
  if (b.light_density > 0) number_row("q", b.light_density);
  number_row("w", b.light_weight);
  row("BSDF cos", b.light_bsdf);
  row("direct", found_->sample.rays[size_t(shadow)].occluded ? Rgb() : b.direct);
}

// A light's intensity, angles and terms.
void Inspector::draw_terms(const ExplainedRay& light) const {
  const ExplainedRay::Light& lit = *light.lit;
  const bool blinn = found_->settings.shading == ShadingModel::blinn_phong;
  row("I", found_->sample.lights[size_t(light.light)].intensity);
  row("L", light.ray.dir);
  number_row("N.L", lit.n_dot_l);
  row(tr("diffuse"), Vec3f(light.diffuse));
  number_row(blinn ? "N.H" : "R.V", lit.cosine);
  number_row("^Shine", lit.power);
  row(tr("highlight"), Vec3f(light.highlight));
}

// Exact: a pixel's sum consists of these very numbers.
void Inspector::draw_sum() const {
  Vec3d sum;
  const auto& rays = found_->sample.rays;
  constexpr size_t kMaxRows = 200;
  size_t rows = 0;
  for (const int i : order_) {
    const ExplainedRay& r = rays[size_t(i)];
    if (r.kind == Kind::shadow) continue;
    sum = sum + r.adds;
    if (++rows <= kMaxRows) row(trf("ray {}", i).c_str(), r.adds);
  }
  if (rows > kMaxRows) faint_text(trf("and {} more", rows - kMaxRows));
  ImGui::Separator();
  row(sum == found_->sample.rgb ? tr("= the sample") : tr("sum"), sum);
}

}  // namespace raio::core::view
