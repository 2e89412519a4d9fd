#include "measure/imitation.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "accel/accel.h"
#include "base/exact_math.h"
#include "integrate/camera.h"
#include "integrate/lights.h"
#include "render/picture.h"
#include "render/render.h"

namespace raio::core {
namespace {

/// A structure with wrong answers for shadow rays.
class WrongShadows final : public Accel {
 public:
  WrongShadows(Geometry geometry, std::unique_ptr<const Accel> right, ShadowRays shadows)
      : Accel(std::move(geometry)), right_(std::move(right)), shadows_(shadows) {}

 private:
  void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    right_->closest(rays, hits, context);
  }
  void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    if (shadows_ != ShadowRays::beyond)
      return void(std::fill_n(hit, rays.size(), shadows_ == ShadowRays::always));
    RayBatch endless = rays;
    for (size_t i = 0; i < rays.size(); ++i)
      if (rays.tmax[i] > 0) endless.tmax[i] = Ray().tmax;
    right_->occluded(endless, hit, context);
  }
  AccelInfo describe() const override { return right_->info(); }

  std::unique_ptr<const Accel> right_;
  ShadowRays shadows_;
};

std::unique_ptr<const Accel> structure_of(const Scene& scene, const RenderSettings& settings,
                                          ShadowRays shadows) {
  auto accel = build_accel(scene, settings.accel, settings.one_sided);
  if (!accel) return nullptr;
  if (shadows == ShadowRays::right) return std::move(*accel);
  Geometry geometry(scene, scene, settings.one_sided, false, settings.accel.opacity);
  return std::make_unique<WrongShadows>(std::move(geometry), std::move(*accel), shadows);
}

std::optional<Image> rendered(const Scene& scene, const RenderSettings& settings,
                              ShadowRays shadows) {
  const auto accel = structure_of(scene, settings, shadows);
  check_stop();
  const auto film = make_film(scene, settings);
  if (!accel || !film) return std::nullopt;
  WorkControl control;
  render(scene, *accel, settings, **film, control);
  check_stop();
  return picture_of(**film);
}

/// The hit points at the pixels' centres; nothing where nothing is hit.
std::vector<std::optional<Vec3f>> points_seen(const Scene& scene, const RenderSettings& s) {
  std::vector<std::optional<Vec3f>> points(size_t(s.width) * size_t(s.height));
  const auto accel = structure_of(scene, s, ShadowRays::right);
  if (!accel) return points;
  const EyeRays eye(s.camera, s.width, s.height, s.angle_to_centers);
  HitBatch hits;
  TraceContext context;
  for (int y = 0; y < s.height; ++y) {
    check_stop();
    RayBatch rays;
    for (int x = 0; x < s.width; ++x) rays.push(eye.pinhole(float(x) + 0.5f, float(y) + 0.5f));
    hits.reset(rays.size());
    accel->closest(rays, hits, context);
    for (size_t x = 0; x < rays.size(); ++x)
      if (hits[x].found()) points[size_t(y) * s.width + x] = rays[x].at(hits.t[x]);
  }
  return points;
}

// Radiance is linear in the intensities, so the part of each light is the difference from the
// picture in shadow.
std::optional<Image> with_falloff(const Imitation& what, const Image& dark) {
  const Rgb usual = uncolored_intensity(what.scene);
  const bool colored =
      std::ranges::any_of(what.scene.lights, [](const Light& l) { return l.color.has_value(); });
  const auto points = points_seen(what.scene, what.settings);
  Image sum = dark;
  Scene lit = what.scene;
  for (const Light& light : what.scene.lights) {
    // A colour would switch off the ambient light.
    lit.lights = {light};
    if (colored) lit.lights[0].color = light.color.value_or(usual);
    const auto one = rendered(lit, what.settings, what.shadows);
    if (!one) return std::nullopt;
    const Rgb weight = colored ? Rgb(1) : usual;
    for (size_t i = 0; i < points.size(); ++i) {
      if (!points[i]) continue;
      const float distance = length(light.position - *points[i]);
      const float part = 1 / (what.falloff == 2 ? distance * distance : distance);
      sum.pixels[i] += (one->pixels[i] - dark.pixels[i]) * weight * part;
    }
  }
  return sum;
}

float distance2(const Rgb& a, const Rgb& b) {
  const auto p = display_bytes(a), q = display_bytes(b);
  float sum = 0;
  for (int c = 0; c < 3; ++c) sum += float((p[c] - q[c]) * (p[c] - q[c]));
  return sum;
}

// In each pixel the nearest to `of` among the picture, that in shadow, and that in shadow without
// mirrors; or the unchanged picture, if the pixels in shadow form areas instead of speckles.
std::optional<Image> speckled(const Imitation& what, Image lit, const Image& of) {
  if (of.width != lit.width || of.height != lit.height) return lit;
  RenderSettings unmirrored = what.settings;
  unmirrored.no_reflection = true;
  const auto dark = rendered(what.scene, what.settings, ShadowRays::always);
  const auto darker = rendered(what.scene, unmirrored, ShadowRays::always);
  if (!dark || !darker) return std::nullopt;
  Image mixed = lit;
  std::vector<bool> in_shadow(of.pixels.size());
  for (size_t i = 0; i < of.pixels.size(); ++i)
    for (const Image* other : {&*dark, &*darker})
      if (distance2(other->pixels[i], of.pixels[i]) < distance2(mixed.pixels[i], of.pixels[i]))
        mixed.pixels[i] = other->pixels[i], in_shadow[i] = true;
  // The ends of runs of such pixels in rows and columns: two per pixel if all are alone or half of
  // them are random, few if they are areas.
  size_t ends = 0;
  for (size_t y = 0, i = 0; y < size_t(of.height); ++y)
    for (size_t x = 0; x < size_t(of.width); ++x, ++i) {
      ends += x > 0 && in_shadow[i] != in_shadow[i - 1];
      ends += y > 0 && in_shadow[i] != in_shadow[i - size_t(of.width)];
    }
  return ends > size_t(std::ranges::count(in_shadow, true)) / 2 ? mixed : lit;
}

std::optional<Image> with_lights(const Imitation& what, const Image& of) {
  const bool mixed = what.shadows == ShadowRays::speckled;
  const ShadowRays shadows = mixed ? ShadowRays::right : what.shadows;
  auto picture = rendered(what.scene, what.settings, shadows);
  if (!picture) return std::nullopt;
  if (mixed) return speckled(what, std::move(*picture), of);
  if (what.light_scale == 1 && what.falloff == 0) return picture;
  const auto dark = rendered(what.scene, what.settings, ShadowRays::always);
  if (!dark) return std::nullopt;
  if (what.falloff > 0) picture = with_falloff(what, *dark);
  if (!picture) return std::nullopt;
  for (size_t i = 0; i < dark->pixels.size(); ++i)
    picture->pixels[i] =
        dark->pixels[i] + (picture->pixels[i] - dark->pixels[i]) * what.light_scale;
  return picture;
}

// Eye rays only get the background.
std::optional<Image> with_black_rays(const Imitation& what, const Image& of) {
  Imitation black = what;
  black.settings.background = Rgb(), black.settings.sky.reset();
  auto picture = with_lights(black, of);
  if (!picture) return std::nullopt;
  const auto points = points_seen(what.scene, what.settings);
  for (size_t i = 0; i < points.size(); ++i)
    if (!points[i]) picture->pixels[i] = what.settings.background;
  return picture;
}

// The settings of a picture of width x height pixels that shows `scale` as much from top to bottom.
RenderSettings resized(RenderSettings s, int width, int height, double scale) {
  double half = exact_tan(double(s.camera.fov_deg) * std::numbers::pi / 360) * scale;
  if (s.angle_to_centers && s.height > 1) half *= double(s.height) / (s.height - 1);
  s.angle_to_centers = false;
  s.camera.fov_deg = float(exact_atan(half) * 360 / std::numbers::pi);
  s.width = width, s.height = height;
  return s;
}

std::optional<Image> seen_by_camera(const Imitation& what, const Image& of) {
  const auto light = [&](const RenderSettings& settings) {
    Imitation same = what;
    same.settings = settings;
    return what.black_rays ? with_black_rays(same, of) : with_lights(same, of);
  };
  const RenderSettings& s = what.settings;
  if (what.ignores_shape) {
    constexpr int kFiner = 3;  // odd: it has the pixels' centres along the longer side
    const int side = kFiner * std::max(s.width, s.height);
    const auto square = light(resized(s, side, side, 1));
    if (!square) return std::nullopt;
    return picked(*square, s.width, s.height, [&](int x, int y) {
      return std::array{int((x + 0.5) * side / s.width), int((y + 0.5) * side / s.height)};
    });
  }
  const auto [dx, dy] = what.within_pixel;
  if (dx == 1 && dy == 1) return light(s);
  // In a picture with one more column, the pixels' centres are at the borders of this one's.
  const int columns = dx != 1, rows = dy != 1;
  const auto larger =
      light(resized(s, s.width + columns, s.height + rows, double(s.height + rows) / s.height));
  if (!larger) return std::nullopt;
  return picked(*larger, s.width, s.height,
                [&](int x, int y) { return std::array{x + (dx == 2), y + (dy == 2)}; });
}

}  // namespace

std::optional<Image> imitate(const Imitation& what, const Image& of) {
  auto picture = seen_by_camera(what, of);
  if (!picture) return std::nullopt;
  tone_map(*picture, {}, what.settings.tone, what.settings.exposure);
  for (const auto transform : what.transforms) picture = transform(*picture);
  return picture;
}

}  // namespace raio::core
