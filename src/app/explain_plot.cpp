// Draws the rays of a sample in the scene, seen from the side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/explain.h"
#include "base/exact_math.h"
#include "integrate/camera.h"
#include "render/render.h"

namespace raio::core::app {
namespace {

using Kind = ExplainedRay::Kind;

constexpr double kPaneLeft = 40, kPaneTop = 110, kPane = 1020, kPaneHeight = 850;
constexpr double kListLeft = 1090, kListRight = 1560, kRow = 28;
constexpr int kRows = 28;

struct RayStyle {
  Ink ink;
  double width;
  const char* name;
};
constexpr RayStyle kEye{kBlack, 4, "eye ray"}, kReflected{kVermilion, 4, "reflected"},
    kRefracted{kBlue, 4, "refracted"}, kLit{kGreen, 2, "to a light"},
    kStopped{kPurple, 2, "in shadow"};

RayStyle look_of(const ExplainedRay& r) {
  switch (r.kind) {
    case Kind::eye:
      return kEye;
    case Kind::reflection:
      return kReflected;
    case Kind::refraction:
      return kRefracted;
    case Kind::shadow:
      return r.occluded ? kStopped : kLit;
  }
  return kEye;
}

class Drawing {
 public:
  Drawing(const Explained& what, const Canvas& canvas) : what_(what), canvas_(canvas) {
    find_camera();
  }

  void draw() {
    canvas_.text(kPaneLeft, 44, valid_utf8(what_.scene.name), kBlack, Align::left, 34, true, 700);
    canvas_.text(
        kPaneLeft, 84,
        fmt::format("pixel {},{} of {}x{}, sample {}: the rays that contribute to its colour",
                    what_.pixel[0], what_.pixel[1], what_.settings.width, what_.settings.height,
                    what_.number),
        kGrey);
    canvas_.image(kPaneLeft, kPaneTop, kPane, kPaneHeight, faded(render_scene()));
    canvas_.clipped(kPaneLeft, kPaneTop, kPane, kPaneHeight, [&] {
      draw_structure();
      for (const bool shadows : {true, false})
        for (const ExplainedRay& r : what_.sample.rays)
          if ((r.kind == Kind::shadow) == shadows) draw_ray(r);
      for (size_t i = 0; i < what_.sample.rays.size(); ++i) draw_hit(i);
      draw_objects();
    });
    draw_list();
    draw_legend();
  }

 private:
  Vec3d end_of(size_t i) const { return drawn_end(what_.sample.rays[i], what_.logs[i], side_); }

  void find_camera() {
    side_ = side_view(what_.sample, what_.settings, what_.pixel, kPane / kPaneHeight);
    camera_ = what_.plot_camera.value_or(side_.camera);
    if (what_.plot_from) camera_.from = Vec3f(*what_.plot_from - what_.scene.origin);
    if (!camera_problem(camera_).empty()) camera_ = what_.settings.camera;
    look_along();
  }
  void look_along() {
    const Vec3d view = Vec3d(camera_.at) - Vec3d(camera_.from);
    distance_ = length(view), forward_ = normalize(view);
    right_ = normalize(cross(forward_, Vec3d(camera_.up)));
    up_ = cross(right_, forward_);
    scale_ = kPaneHeight / 2 / exact_tan(double(camera_.fov_deg) * std::numbers::pi / 360);
  }

  Image render_scene() const {
    RenderSettings o = what_.settings;
    o.camera = camera_;
    o.width = int(kPane), o.height = int(kPaneHeight);
    o.dof = o.soft_shadows = o.angle_to_centers = false;
    o.sampler = SamplerKind::jitter;
    o.aa = o.integrator == IntegratorKind::path ? 5 : 2, o.lens_samples = 1, o.samples = 0;
    o.channels = {}, o.crop = {};
    const auto film = make_film(what_.scene, o);
    if (!film) return Image(o.width, o.height);
    WorkControl control;
    render(what_.scene, what_.accel, o, **film, control);
    return (*film)->resolve();
  }

  // Pale, so that lines stand out.
  static Image faded(Image image) {
    for (Rgb& p : image.pixels)
      for (int c = 0; c < 3; ++c) p[c] = 0.55f + 0.45f * std::min(p[c], 1.0f);
    return image;
  }

  struct Dot {
    double x, y, depth;
  };
  Dot project(const Vec3d& p) const {
    const Vec3d v = p - Vec3d(camera_.from);
    const double z = dot(v, forward_), s = scale_ / (camera_.is_parallel() ? distance_ : z);
    return {kPaneLeft + kPane / 2 + s * dot(v, right_),
            kPaneTop + kPaneHeight / 2 - s * dot(v, up_), z};
  }
  bool in_front(const Vec3d& p) const {
    return dot(p - Vec3d(camera_.from), forward_) > 1e-3 * distance_;
  }
  // Whether something lies between the viewer and p.
  bool is_hidden(const Vec3d& p) const {
    const Vec3d eye = eye_of(camera_, p), v = p - eye;
    RayBatch one;
    one.push({Vec3f(eye), Vec3f(normalize(v)), float(length(v) * 0.999)});
    uint8_t hidden[kBatchPad];
    TraceContext context;
    what_.accel.occluded(one, hidden, context);
    return hidden[0] != 0;
  }

  // In pieces; dotted where hidden.
  void draw_segment(const Vec3d& from, const Vec3d& to, Ink ink, double width) const {
    constexpr int kPieces = 96;
    const auto at = [&](double part) { return from + (to - from) * part; };
    int begin = 0;
    bool hidden = false, seen = false;
    const auto flush = [&](int end) {
      if (!seen || end <= begin) return;
      const Dot a = project(at(double(begin) / kPieces)), b = project(at(double(end) / kPieces));
      canvas_.line(a.x, a.y, b.x, b.y, ink, hidden ? width * 0.7 : width, hidden);
    };
    for (int i = 0; i < kPieces; ++i) {
      const bool front = in_front(at(double(i) / kPieces)) && in_front(at((i + 1.0) / kPieces));
      const bool covered = front && is_hidden(at((i + 0.5) / kPieces));
      if (front != seen || covered != hidden) flush(i), begin = i, seen = front, hidden = covered;
    }
    flush(kPieces);
  }

  void draw_ray(const ExplainedRay& r) const {
    const RayStyle look = look_of(r);
    const size_t i = size_t(&r - what_.sample.rays.data());
    draw_segment(Vec3d(r.ray.origin), end_of(i), look.ink, look.width);
  }

  void draw_hit(size_t i) const {
    const ExplainedRay& r = what_.sample.rays[i];
    if (!r.surface || !in_front(end_of(i))) return;
    const Dot p = project(end_of(i));
    canvas_.disc(p.x, p.y, 12, kWhite);
    canvas_.disc(p.x, p.y, 10.5, look_of(r).ink);
    canvas_.text(p.x, p.y, fmt::format("{}", i), kWhite, Align::center, 12, true);
  }

  void draw_stroke(const Vec3d& from, const Vec3d& to, Ink ink, double width) const {
    if (!in_front(from) || !in_front(to)) return;
    const Dot a = project(from), b = project(to);
    canvas_.line(a.x, a.y, b.x, b.y, ink, width);
  }
  template <class Corners>
  void draw_outline(const Corners& corners, Ink ink, double width) const {
    for (size_t k = 0; k < corners.size(); ++k)
      draw_stroke(corners[k], corners[(k + 1) % corners.size()], ink, width);
  }

  // The camera with its image plane and the pixel there; the lights.
  void draw_objects() const {
    for (const SideView::Light& light : side_.lights) draw_light(light);
    if (!in_front(side_.eye)) return;
    for (const Vec3d& corner : side_.image)
      if (!side_.is_parallel) draw_stroke(side_.eye, corner, kGrey, 1.2);
    draw_outline(side_.image, kGrey, 2);
    draw_outline(side_.pixel, kVermilion, 3);
    const Dot p = project(side_.eye);
    canvas_.disc(p.x, p.y, 8, kBlack);
    canvas_.text(p.x + 14, p.y - 14, "camera", kBlack, Align::left, 16, true);
  }
  void draw_light(const SideView::Light& light) const {
    if (!in_front(light.at)) return;
    draw_outline(light.corners, kBlack, 2);
    const Dot p = project(light.at);
    if (light.towards) {
      const Dot q = project(light.at - *light.towards * (0.1 * side_.extent));
      const double length = std::max(exact_hypot(p.x - q.x, p.y - q.y), 1.0);
      const double x = (p.x - q.x) / length, y = (p.y - q.y) / length;
      for (const double side : {-1.0, 1.0})
        canvas_.line(p.x + 26 * x, p.y + 26 * y, p.x + 12 * x - side * 10 * y,
                     p.y + 12 * y + side * 10 * x, kBlack, 3);
      canvas_.line(p.x, p.y, p.x + 26 * x, p.y + 26 * y, kBlack, 3);
    }
    for (int k = 0; k < 8; ++k) {
      const double x = exact_cos(k * std::numbers::pi / 4), y = exact_sin(k * std::numbers::pi / 4);
      if (!light.towards)
        canvas_.line(p.x + 11 * x, p.y + 11 * y, p.x + 17 * x, p.y + 17 * y, kBlack, 2);
    }
    canvas_.disc(p.x, p.y, 9, kBlack);
    canvas_.disc(p.x, p.y, 7, {250, 210, 60});
    canvas_.text(p.x + 18, p.y - 18, fmt::format("light {}", light.number), kBlack, Align::left, 16,
                 true);
  }

  // The cells, nodes and leaves that the eye ray visits.
  void draw_structure() const {
    const auto& log = what_.logs[0];
    if (!log || log->steps.size() > 200) return;
    for (const TraceLog::Step& step : log->steps) {
      for_each_edge(step.box, [&](const Vec3f& from, const Vec3f& to) {
        if (!in_front(Vec3d(from)) || !in_front(Vec3d(to))) return;
        const Dot a = project(Vec3d(from)), b = project(Vec3d(to));
        canvas_.line(a.x, a.y, b.x, b.y, kGrey, step.leaf ? 1.2 : 0.7);
      });
    }
  }

  void draw_list() const {
    double y = kPaneTop + 8;
    int rows = 0;
    const auto& rays = what_.sample.rays;
    for (size_t i = 0; i < rays.size() && rows < kRows; ++i, ++rows, y += kRow) {
      const ExplainedRay& r = rays[i];
      const RayStyle look = look_of(r);
      const double x = kListLeft + 14.0 * (r.level - 1) + (r.kind == Kind::shadow ? 14 : 0);
      if (r.kind == Kind::shadow) {
        canvas_.line(x - 8, y, x + 8, y, look.ink, 3);
      } else {
        canvas_.disc(x, y, 10.5, look.ink);
        canvas_.text(x, y, fmt::format("{}", i), kWhite, Align::center, 12, true);
      }
      canvas_.text(x + 18, y, line_of(i), kBlack, Align::left, 16, false, kListRight - x - 18);
    }
    if (rows < int(rays.size()))
      canvas_.text(kListLeft, y, fmt::format("and {} more", rays.size() - size_t(rows)), kGrey,
                   Align::left, 16);
  }

  std::string line_of(size_t i) const {
    const ExplainedRay& r = what_.sample.rays[i];
    if (r.kind == Kind::shadow) {
      const TraceLog::Test* const by = r.occluded ? stopper(what_.logs[i]) : nullptr;
      const auto& bounce = what_.sample.rays[size_t(r.parent)].bounce;
      const std::string name = "light " + light_name(what_.sample, r);
      if (by) return name + " is behind " + name_of(what_.accel.geometry(), by->primitive);
      const Vec3d light = bounce ? Vec3d(bounce->direct) : r.diffuse + r.highlight;
      return name + (r.occluded ? " is hidden"
                                : fmt::format(": {:.3f} {:.3f} {:.3f}", light.x, light.y, light.z));
    }
    const std::string hit =
        !r.traced       ? "beyond the last level"
        : r.hit.found() ? fmt::format("{}, t = {:.4g}",
                                      name_of(what_.accel.geometry(), r.hit.primitive), r.hit.t)
                        : "background";
    return fmt::format("{}, weight {:.3g} in the pixel", hit, r.weight.x);
  }

  void draw_legend() const {
    double y = kPaneTop + kRow * (kRows + 1.5) - 30;
    canvas_.text(kListLeft, y,
                 fmt::format("colour {:.4f} {:.4f} {:.4f}", what_.sample.rgb.x, what_.sample.rgb.y,
                             what_.sample.rgb.z),
                 kBlack, Align::left, 18, true);
    canvas_.box(kListRight - 60, y - 18, 60, 36, kFaint);
    const auto part = [](double v) { return int(to_byte(float(v))); };
    const Vec3d& rgb = what_.sample.rgb;
    canvas_.box(kListRight - 58, y - 16, 56, 32, {part(rgb.x), part(rgb.y), part(rgb.z)});
    double x = kPaneLeft;
    for (const RayStyle& look : {kEye, kReflected, kRefracted, kLit, kStopped}) {
      canvas_.line(x, 980, x + 34, 980, look.ink, look.width);
      canvas_.text(x + 44, 980, look.name, kBlack, Align::left, 16);
      x += 74 + canvas_.text_width(look.name, 16);
    }
    canvas_.line(x, 980, x + 34, 980, kGrey, 3, true);
    canvas_.text(x + 44, 980, "behind something", kBlack, Align::left, 16);
    x += 74 + canvas_.text_width("behind something", 16);
    canvas_.line(x, 980, x + 34, 980, kGrey, 1.2);
    canvas_.text(x + 44, 980,
                 what_.settings.accel.kind == AccelKind::grid ? "cells that the eye ray visits"
                                                              : "boxes that the eye ray visits",
                 kBlack, Align::left, 16);
  }

  const Explained& what_;
  const Canvas& canvas_;
  SideView side_;
  double scale_ = 1, distance_ = 1;
  Camera camera_;
  Vec3d forward_, right_, up_;
};

}  // namespace

std::expected<std::string, std::string> draw_explained(const Explained& what, PlotFormat format) {
  return draw_page(format, [&](const Canvas& canvas) { Drawing(what, canvas).draw(); });
}

}  // namespace raio::core::app
