#include "view/legend.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "integrate/views.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr int kHeatStops = 7;

double heat_at(int stop) { return stop == 0 ? 0 : exact_pow(4.0, stop - 1); }

double heat_place(double count) {
  return std::min(count < 1 ? count : 1 + exact_log2(count) / 2, kHeatStops - 1.0) /
         (kHeatStops - 1);
}

Legend heat_legend(const char* title) {
  Legend legend{tr(title), {}, false};
  for (int i = 0; i < kHeatStops; ++i) {
    const double count = heat_at(i);
    legend.stops.push_back({heat_color(count), fmt::format("{}", count)});
  }
  legend.stops.back().label += "+";
  return legend;
}

double view_distance(const Camera& camera) { return length(Vec3d(camera.at) - Vec3d(camera.from)); }

Legend depth_legend(double distance) {
  Legend legend{tr("depth along the line of sight, scene units"), {}, false};
  for (int i = 0; i <= 4; ++i) {
    const float grey = 1 - float(i) / 4;
    legend.stops.push_back(
        {Rgb(grey), i < 4 ? fmt::format("{:.3g}", distance * i / (4 - i)) : "\xe2\x88\x9e"});
  }
  return legend;
}

double counted_place(const Rgb& color) { return heat_place(heat_count(color)); }

// The value shown by the view there, and its position on the scale.
ReadOut value_of(const ViewState& state, const Pick& pick, const Accel* accel, const Rgb& c,
                 int picture_height) {
  const double distance = view_distance(state.camera);
  const auto count = [&](const char* one, const char* many) {
    // The scale ends there; the value may be larger.
    const auto seen = size_t(std::lround(heat_count(c)));
    return ReadOut{(seen >= 1024 ? ">= " : "") + number_of(seen, one, many), counted_place(c)};
  };
  switch (state.options.view) {
    case View::picture:
      return {fmt::format("#{:02x}{:02x}{:02x}", to_byte(c.x), to_byte(c.y), to_byte(c.z)), {}};
    case View::normals:
      if (!pick.hit.found()) return {};
      return {trf("normal {:.2f} {:.2f} {:.2f}", 2 * c.x - 1, 2 * c.y - 1, 2 * c.z - 1), {}};
    case View::depth:
      if (!pick.hit.found()) return {};
      return {trf("depth {:.4g}", pick.depth), pick.depth / (distance + pick.depth)};
    case View::ids:
      return {};
    case View::materials:
      if (!pick.hit.found() || !accel) return {};
      return {
          trf("material {}", accel->geometry().material_of(pick.hit.primitive, pick.hit.instance)),
          {}};
    case View::steps:
      return count("node or cell visited", "nodes or cells visited");
    case View::tests:
      return count("primitive tested", "primitives tested");
    case View::samples:
      return count("sample", "samples");
    case View::focus: {
      if (!pick.hit.found()) return {};
      if (state.camera.is_parallel()) return {trf("blur {:.3g} pixels", 0), 0.5};
      const RenderSettings s = resolve_options(state.request(1, 1), *state.scene);
      const double tangent = exact_tan(double(state.camera.fov_deg) * std::numbers::pi / 360);
      const double blur = 2 * double(s.aperture) * std::abs(pick.depth - double(s.focus)) /
                          pick.depth / (2 * double(s.focus) * tangent) * picture_height;
      const bool sharp = blur<1, behind = pick.depth> double(s.focus);
      return {trf("blur {:.3g} pixels", blur), sharp ? 0.5 : behind ? 1.0 : 0.0};
    }
  }
  return {};
}

std::string what_is_there(const Pick& pick) {
  if (!pick.hit.found()) return tr("background");
  std::string text = pick.what;
  if (!pick.object.empty()) text += " \xc2\xb7 " + pick.object;
  return text + " \xc2\xb7 " + trf("distance {:.4g}", pick.depth);
}

}  // namespace

Legend legend_of(const ViewState& state) {
  switch (state.options.view) {
    case View::picture:
      return {};
    case View::normals:
      return {tr("normal towards the eye"),
              {{Rgb(1, 0.5f, 0.5f), "+x"},
               {Rgb(0, 0.5f, 0.5f), "-x"},
               {Rgb(0.5f, 1, 0.5f), "+y"},
               {Rgb(0.5f, 0, 0.5f), "-y"},
               {Rgb(0.5f, 0.5f, 1), "+z"},
               {Rgb(0.5f, 0.5f, 0), "-z"}},
              true};
    case View::depth:
      return depth_legend(view_distance(state.camera));
    case View::ids:
      return {tr("a colour for each primitive"), {}, true};
    case View::materials:
      return {tr("a colour for each material"), {}, true};
    case View::steps:
      return heat_legend("nodes or cells visited by a ray");
    case View::tests:
      return heat_legend("primitives tested by a ray");
    case View::samples:
      return heat_legend("samples of a pixel");
    case View::focus:
      return {tr("lens blur, relative to a pixel"),
              {{Rgb(0.9f, 0.2f, 0.1f), tr("in front")},
               {Rgb(0.2f, 0.8f, 0.2f), tr("sharp")},
               {Rgb(0.1f, 0.3f, 1), tr("behind")}},
              true};
  }
  return {};
}

double heat_count(const Rgb& color) {
  double best = 0, nearest = 1e30;
  for (int i = 0; i + 1 < kHeatStops; ++i) {
    const Rgb a = heat_color(heat_at(i)), along = heat_color(heat_at(i + 1)) - a;
    const float part = std::clamp(dot(color - a, along) / dot(along, along), 0.0f, 1.0f);
    const double off = length(a + along * part - color);
    if (off >= nearest) continue;
    nearest = off;
    best = i == 0 ? double(part) : exact_pow(4.0, i - 1 + double(part));
  }
  return best;
}

ReadOut read_out(const ViewState& state, const Pick& pick, const Accel* accel, const Rgb& color,
                 int picture_height) {
  ReadOut out = value_of(state, pick, accel, color, picture_height);
  if (!out.text.empty()) out.text += " \xc2\xb7 ";
  out.text += what_is_there(pick);
  return out;
}

ReadOut read_out(const ViewState& state, const SessionPicture& picture, double x, double y,
                 const Pick& pick) {
  if (x < 0 || x >= 1 || y < 0 || y >= 1 || !picture.image) return {};
  const Image& image = *picture.image;
  return read_out(state, pick, picture.baked ? picture.baked->accel.get() : nullptr,
                  image.at(int(x * image.width), int(y * image.height)), image.height);
}

Rect draw_legend(const Rect& picture, const Legend& legend, std::optional<double> at) {
  if (legend.title.empty()) return {};
  const Palette& p = palette();
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const float pad = 0.6f * em(), line = ImGui::GetFontSize();
  const auto count = float(legend.stops.size());
  float label = 3 * em();
  for (const auto& stop : legend.stops)
    label = std::max(label, ImGui::CalcTextSize(stop.label.c_str()).x + 0.6f * em());
  const float width = std::max(ImGui::CalcTextSize(legend.title.c_str()).x,
                               legend.stops.empty() ? 0 : count * label);
  const float height = legend.stops.empty() ? line : 2.9f * line + 0.5f * em();
  const ImVec2 hi(picture.right - em(), picture.bottom - em());
  const ImVec2 lo(hi.x - width - 2 * pad, hi.y - height - 2 * pad);
  draw.AddRectFilled(lo, hi, color(p.ground, 0.94f), 0.3f * em());
  draw.AddText({lo.x + pad, lo.y + pad}, color(p.text), legend.title.c_str());
  const Rect covered{lo.x, lo.y, hi.x, hi.y};
  if (legend.stops.empty()) return covered;
  const auto ink = [](const Rgb& c) { return color({c.x, c.y, c.z, 1}); };
  const float top = lo.y + pad + line + 0.5f * em(), bottom = top + 0.8f * line;
  const float step = width / count;
  const auto middle = [&](float i) { return lo.x + pad + (i + 0.5f) * step; };
  for (size_t i = 0; i < legend.stops.size(); ++i) {
    const auto& stop = legend.stops[i];
    const auto place = float(i);
    if (legend.discrete) {
      draw.AddRectFilled({middle(place) - 0.4f * step, top}, {middle(place) + 0.4f * step, bottom},
                         ink(stop.color), 0.15f * em());
    } else if (i + 1 < legend.stops.size()) {
      const ImU32 a = ink(stop.color), b = ink(legend.stops[i + 1].color);
      draw.AddRectFilledMultiColor({middle(place), top}, {middle(place + 1), bottom}, a, b, b, a);
    }
    const float half = ImGui::CalcTextSize(stop.label.c_str()).x / 2;
    draw.AddText({middle(place) - half, bottom + 0.15f * line}, color(p.text), stop.label.c_str());
  }
  if (!at) return covered;
  const float x = middle(float(std::clamp(*at, 0.0, 1.0)) * (count - 1)), size = 0.35f * em();
  draw.AddTriangleFilled({x - size, top - size}, {x + size, top - size}, {x, top + size / 2},
                         color(p.text));
  draw.AddLine({x, top}, {x, bottom}, color(p.text), 2);
  return covered;
}

}  // namespace raio::core::view
