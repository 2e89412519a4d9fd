#include "render/debug_view.h"

#include <array>
#include <cmath>

#include "base/random.h"
#include "integrate/camera.h"
#include "integrate/surface.h"

namespace raio {
namespace {

// A bright colour that has nothing to do with those of neighbouring ids.
Rgb id_color(uint32_t id) {
  const uint32_t bits = scramble(id);
  const auto part = [&](int shift) { return 0.25f + 0.75f * float(bits >> shift & 255) / 255; };
  return {part(0), part(8), part(16)};
}

class DebugTracer {
 public:
  DebugTracer(const Scene& scene, const Accel& accel, const RenderOptions& options)
      : accel_(accel),
        options_(options),
        eye_(camera_of(scene, options), options.width, options.height) {
    const Camera camera = camera_of(scene, options);
    forward_ = normalize(camera.at - camera.from);
    distance_ = length(camera.at - camera.from);
    // A lens of radius R in focus at F blurs what is at depth z over a circle of diameter
    // 2 R |z - F| / z on the plane in focus.
    blur_ = 2 * options.aperture / (length(eye_.per_y) * options.focus);
  }

  Rgb color(int x, int y, const std::atomic<bool>& stop) const {
    const Ray ray = eye_.pinhole(float(x) + 0.5f, float(y) + 0.5f);
    RayBatch rays;  // of one ray: its own steps and tests
    HitBatch hits;
    rays.push(ray);
    hits.reset(1);
    TraceContext context;
    context.stop = &stop;
    accel_.closest(rays, hits, context);
    if (stop) return {};  // what is in hits then may be no hit
    if (options_.view == View::steps) return heat_color(double(context.steps));
    if (options_.view == View::tests) return heat_color(double(context.tests));
    return hits[0].found() ? color(ray, hits[0]) : Rgb();
  }

 private:
  Rgb color(const Ray& ray, const Hit& hit) const {
    const Surface surface = surface_at(accel_.geometry(), ray, hit);
    const float facing = dot(surface.normal, ray.dir);
    const float shade = 0.4f + 0.6f * std::abs(facing);
    switch (options_.view) {
      case View::normals:
        return Rgb(0.5f) + surface.normal * (facing < 0 ? 0.5f : -0.5f);
      case View::depth:
        return Rgb(distance_ / (distance_ + hit.t));
      case View::ids:
        return id_color(hit.item) * shade;
      case View::materials:
        return id_color(surface.material) * shade;
      case View::focus:
        return focus_color(hit.t * dot(ray.dir, forward_)) * shade;
      case View::picture:
      case View::steps:
      case View::tests:
      case View::samples:
        break;
    }
    return {};
  }

  Rgb focus_color(float depth) const {
    const float pixels = blur_ * std::abs(depth - options_.focus) / depth;
    if (pixels < 1) return {0.2f, 0.9f, 0.3f};
    const float much = std::min(1.0f, std::log2(pixels) / 5);  // 32 pixels and more
    const Rgb grey(0.7f),
        full = depth < options_.focus ? Rgb(0.9f, 0.2f, 0.1f) : Rgb(0.1f, 0.3f, 1);
    return grey * (1 - much) + full * much;
  }

  const Accel& accel_;
  const RenderOptions& options_;
  EyeRays eye_;
  Vec3f forward_;
  float distance_ = 1, blur_ = 0;
};

}  // namespace

Rgb heat_color(double count) {
  static constexpr std::array<Rgb, 7> kScale = {Rgb(0, 0, 0), Rgb(0, 0, 1), Rgb(0, 1, 1),
                                                Rgb(0, 1, 0), Rgb(1, 1, 0), Rgb(1, 0, 0),
                                                Rgb(1, 1, 1)};
  const double place = count < 1 ? count : 1 + std::log2(count) / 2;
  if (place >= kScale.size() - 1) return kScale.back();
  const auto step = size_t(place);
  const float part = float(place - double(step));
  return kScale[step] * (1 - part) + kScale[step + 1] * part;
}

std::optional<Image> render_debug_view(const Scene& scene, const Accel& accel,
                                       const RenderOptions& options, RenderControl& control) {
  const DebugTracer tracer(scene, accel, options);
  Image image(options.width, options.height);
  const uint64_t pixels = uint64_t(image.width);
  control.rays_done = control.work_done = 0;
  control.work_total = pixels * uint64_t(image.height);
  on_threads(options.threads, [&] {
    parallel_for(image.height, [&](int y) {
      for (int x = 0; x < image.width && !control.stop; ++x)
        image.at(x, y) = tracer.color(x, y, control.stop);
      control.rays_done += pixels, control.work_done += pixels;
    });
  });
  if (control.stop) return std::nullopt;
  return image;
}

Image picture_of(const Film& film, const RenderOptions& options) {
  if (options.view != View::samples) return film.resolve();
  Image image(film.width(), film.height());
  for (size_t t = 0; t < film.tiles(); ++t) {
    const Rgb color = heat_color(film.samples(t));
    const Tile tile = film.tile(t);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) image.at(x, y) = color;
  }
  return image;
}

}  // namespace raio
