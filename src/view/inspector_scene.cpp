#include "view/inspector_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "integrate/camera.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr size_t kMaxPieces = 6000;  // of all rays together: a few milliseconds of tracing

bool is_light() { return palette().ground.x > 0.5f; }

void draw_box(ImDrawList& draw, const Projection& projection, const DrawnBox& b) {
  for_each_edge(b.box, [&](const Vec3f& from, const Vec3f& to) {
    if (const auto s = projection.segment(Vec3d(from), Vec3d(to)))
      draw.AddLine((*s)[0], (*s)[1], color(palette().accent, b.alpha), b.alpha >= 1 ? 2.0f : 1.0f);
  });
}

void draw_line(ImDrawList& draw, const Projection& projection, const Vec3d& from, const Vec3d& to,
               ImU32 ink, float width) {
  const auto s = projection.segment(from, to);
  if (!s) return;
  draw.AddLine((*s)[0], (*s)[1], color(palette().ground, 0.55f), width + 0.14f * em());
  draw.AddLine((*s)[0], (*s)[1], ink, width);
}
template <class Corners>
void draw_outline(ImDrawList& draw, const Projection& projection, const Corners& corners, ImU32 ink,
                  float width) {
  for (size_t k = 0; k < corners.size(); ++k)
    draw_line(draw, projection, corners[k], corners[(k + 1) % corners.size()], ink, width);
}

void draw_name(ImDrawList& draw, ImVec2 at, const std::string& name) {
  const ImVec2 size = ImGui::CalcTextSize(name.c_str());
  const ImVec2 lo(at.x + 0.7f * em(), at.y - 1.5f * em());
  draw.AddRectFilled({lo.x - 0.2f * em(), lo.y}, {lo.x + size.x + 0.2f * em(), lo.y + size.y},
                     color(palette().ground, 0.7f), 0.2f * em());
  draw.AddText(lo, color(palette().text), name.c_str());
}

// The camera with its image plane and the pixel there. Its own eye sees nothing of it.
void draw_camera(ImDrawList& draw, const Projection& projection, const app::SideView& view) {
  const auto eye = projection.point(view.eye);
  if (!eye) return;
  const ImU32 ink = color(palette().text, 0.8f);
  std::array<ImVec2, 4> image;
  size_t visible = 0;
  for (const Vec3d& corner : view.image) {
    if (!view.is_parallel) draw_line(draw, projection, view.eye, corner, ink, 0.07f * em());
    if (const auto p = projection.point(corner)) image[visible++] = *p;
  }
  if (visible == 4) draw.AddConvexPolyFilled(image.data(), 4, color(palette().text, 0.12f));
  draw_outline(draw, projection, view.image, ink, 0.12f * em());
  draw_outline(draw, projection, view.pixel, color(palette().accent), 0.16f * em());
  draw.AddCircleFilled(*eye, 0.4f * em(), color(palette().ground));
  draw.AddCircleFilled(*eye, 0.32f * em(), color(palette().text));
  draw_name(draw, *eye, tr("camera"));
}

void draw_light(ImDrawList& draw, const Projection& projection, const app::SideView& view,
                const app::SideView::Light& light) {
  const auto p = projection.point(light.at);
  if (!p) return;
  const ImU32 ink = color(palette().text);
  draw_outline(draw, projection, light.corners, ink, 0.1f * em());
  const auto before =
      light.towards ? projection.point(light.at - *light.towards * (0.1 * view.extent)) : p;
  if (light.towards && before) {
    const float dx = p->x - before->x, dy = p->y - before->y;
    const float length = std::max(float(exact_hypot(dx, dy)), 1.0f);
    const float x = em() * dx / length, y = em() * dy / length;
    const ImVec2 tip(p->x + 1.7f * x, p->y + 1.7f * y);
    draw.AddLine(*p, tip, ink, 0.16f * em());
    for (const float side : {-0.55f, 0.55f})
      draw.AddLine(tip, {p->x + 0.9f * x - side * y, p->y + 0.9f * y + side * x}, ink,
                   0.16f * em());
  } else {
    for (int k = 0; k < 8; ++k) {
      const auto x = float(exact_cos(k * std::numbers::pi / 4)) * em(),
                 y = float(exact_sin(k * std::numbers::pi / 4)) * em();
      draw.AddLine({p->x + 0.6f * x, p->y + 0.6f * y}, {p->x + 0.95f * x, p->y + 0.95f * y}, ink,
                   0.11f * em());
    }
  }
  draw.AddCircleFilled(*p, 0.48f * em(), ink);
  draw.AddCircleFilled(*p, 0.38f * em(), IM_COL32(250, 210, 60, 255));
  draw_name(draw, *p, fmt::format("{} {}", tr("light"), light.number));
}

}  // namespace

// The colours of raio explain, lighter on a dark background.
ImU32 color_of(RayKind kind, float alpha) {
  const auto of = [&](int r, int g, int b) { return IM_COL32(r, g, b, int(255 * alpha)); };
  const bool light = is_light();
  switch (kind) {
    case RayKind::eye:
      return light ? of(26, 26, 31) : of(240, 240, 245);
    case RayKind::reflected:
      return light ? of(213, 94, 0) : of(240, 130, 40);
    case RayKind::refracted:
      return light ? of(0, 114, 178) : of(86, 180, 233);
    case RayKind::lit:
      return light ? of(0, 140, 100) : of(0, 190, 140);
    case RayKind::stopped:
      return light ? of(184, 90, 144) : of(224, 141, 187);
  }
  return of(0, 0, 0);
}

const char* name_of(RayKind kind) {
  constexpr const char* kNames[] = {"eye ray", "reflected", "refracted", "to a light", "in shadow"};
  return kNames[size_t(kind)];
}

void RayScene::set(std::vector<DrawnRay> rays, std::shared_ptr<const BakedScene> hides) {
  rays_ = std::move(rays), hides_ = std::move(hides);
  pieces_ = rays_.empty() ? 1 : std::clamp(kMaxPieces / rays_.size(), size_t(1), size_t(48));
  is_known_ = false;
}

void RayScene::find_hidden(const Camera& camera) {
  if (is_known_ && camera == seen_from_) return;
  is_known_ = true, seen_from_ = camera;
  hidden_.assign(padded(rays_.size() * pieces_), 0);
  if (!hides_ || rays_.empty() || pieces_ < 4) return;
  RayBatch batch;
  for (const DrawnRay& r : rays_)
    for (size_t k = 0; k < pieces_; ++k) {
      const Vec3d point = r.from + (r.to - r.from) * ((double(k) + 0.5) / double(pieces_));
      const Vec3d eye = eye_of(camera, point), v = point - eye;
      const double far = length(v);
      batch.push({Vec3f(eye), far > 0 ? Vec3f(v / far) : Vec3f(0, 0, 1), float(far * 0.999)});
    }
  TraceContext context;
  hides_->accel->occluded(batch, hidden_.data(), context);
}

void RayScene::draw_ray(ImDrawList& draw, const Projection& projection, size_t i) const {
  const DrawnRay& r = rays_[i];
  const bool many = pieces_ < 4;
  const bool thin = r.kind == RayKind::lit || r.kind == RayKind::stopped;
  const float width = (many ? 0.08f : r.chosen ? 0.26f : thin ? 0.11f : 0.17f) * em();
  const auto at = [&](size_t k) {
    return r.from + (r.to - r.from) * (double(k) / double(pieces_));
  };
  for (const bool halo : {true, false}) {
    if (halo && many) continue;
    for (size_t begin = 0, end = 1; begin < pieces_; begin = end++) {
      const uint8_t hidden = hidden_[i * pieces_ + begin];
      while (end < pieces_ && hidden_[i * pieces_ + end] == hidden) ++end;
      if (halo && hidden) continue;
      const auto s = projection.segment(at(begin), at(end));
      if (!s) continue;
      const auto [a, b] = *s;
      if (halo)
        draw.AddLine(a, b, color(palette().ground, 0.55f * r.alpha), width + 0.18f * em());
      else if (!hidden)
        draw.AddLine(a, b, color_of(r.kind, r.alpha), width);
      else {
        const float length = float(exact_hypot(b.x - a.x, b.y - a.y)), step = 0.55f * em();
        const int dots = std::min(int(length / step), 400);
        for (int k = 0; k <= dots; ++k) {
          const float part = dots > 0 ? float(k) / float(dots) : 0.5f;
          draw.AddCircleFilled({a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part},
                               std::max(0.5f * width, 1.0f), color_of(r.kind, 0.75f * r.alpha), 6);
        }
      }
    }
  }
}

void RayScene::draw(const Rect& area, const Camera& camera, const Stage& stage) {
  find_hidden(camera);
  const Projection projection(camera, stage);
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect({area.left, area.top}, {area.right, area.bottom}, true);
  draw.AddRectFilled({area.left, area.top}, {area.right, area.bottom},
                     color(palette().ground, is_light() ? 0.5f : 0.55f));
  for (const DrawnBox& b : boxes) draw_box(draw, projection, b);
  for (const bool chosen : {false, true})
    for (size_t i = 0; i < rays_.size(); ++i)
      if (rays_[i].chosen == chosen) draw_ray(draw, projection, i);
  if (objects) {
    draw_camera(draw, projection, *objects);
    for (const auto& light : objects->lights) draw_light(draw, projection, *objects, light);
  }
  for (const DrawnRay& r : rays_) {
    const auto p = projection.point(r.to);
    if (!p || (r.label.empty() && !r.is_sample)) continue;
    if (r.is_sample) {
      draw.AddCircle(*p, 0.3f * em(), color_of(r.kind, r.alpha), 0, 0.12f * em());
      continue;
    }
    const float radius = 0.62f * em();
    draw.AddCircleFilled(*p, radius + 0.1f * em(), color(palette().ground, r.alpha));
    draw.AddCircleFilled(*p, radius, color_of(r.kind, r.alpha));
    const float size = 0.8f * em();
    const ImVec2 text = ImGui::GetFont()->CalcTextSizeA(size, 1e9f, 0, r.label.c_str());
    draw.AddText(ImGui::GetFont(), size, {p->x - text.x / 2, p->y - text.y / 2},
                 color(palette().ground, r.alpha), r.label.c_str());
  }
  for (const Vec3d& at : points)
    if (const auto p = projection.point(at)) {
      draw.AddCircleFilled(*p, 0.42f * em(), color(palette().ground));
      draw.AddCircleFilled(*p, 0.32f * em(), color(palette().accent));
    }
  draw.PopClipRect();
}

void draw_ray_legend(const Rect& area, bool has_boxes) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  struct Entry {
    const char* name;
    ImU32 ink;
    bool dotted;
  };
  std::vector<Entry> entries;
  entries.reserve(kRayKinds + 2);
  for (int k = 0; k < kRayKinds; ++k)
    entries.push_back({tr(name_of(RayKind(k))), color_of(RayKind(k)), false});
  entries.push_back({tr("behind something"), color(palette().text), true});
  if (has_boxes) entries.push_back({tr("box or cell"), color(palette().accent), false});
  const float line = 1.3f * em(), pad = 0.5f * em(), mark = 1.6f * em();
  float width = 0;
  for (const Entry& e : entries) width = std::max(width, ImGui::CalcTextSize(e.name).x);
  const ImVec2 lo(area.left + 0.8f * em(), area.top + 0.8f * em());
  const ImVec2 hi(lo.x + width + mark + 3 * pad, lo.y + line * float(entries.size()) + 2 * pad);
  draw.AddRectFilled(lo, hi, color(palette().ground, 0.88f), 0.3f * em());
  float y = lo.y + pad + line / 2;
  for (const Entry& e : entries) {
    const float x = lo.x + pad;
    if (e.dotted)
      for (int k = 0; k < 4; ++k)
        draw.AddCircleFilled({x + (float(k) + 0.5f) * mark / 4, y}, 0.1f * em(), e.ink, 6);
    else
      draw.AddLine({x, y}, {x + mark, y}, e.ink, 0.17f * em());
    draw.AddText({x + mark + pad, y - ImGui::GetFontSize() / 2}, color(palette().text), e.name);
    y += line;
  }
}

}  // namespace raio::core::view
