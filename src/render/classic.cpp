#include "render/classic.h"

#include "render/surface.h"
#include "shape/offset.h"

namespace raio {
namespace {

// Rays traced at a time. Bounds the memory of a ray tree: the deepest level goes first, so that no
// level ever holds more than the children of one such chunk.
constexpr size_t kChunk = 1024;

inline Vec3f reflect(Vec3f d, Vec3f n) { return d - n * (2 * dot(d, n)); }

// Snell's law, for n on the side that d comes from; nothing at total internal reflection.
// Inlined, as calls with vectors by value cost more here than the arithmetic.
[[gnu::always_inline]] inline std::optional<Vec3f> refract(Vec3f d, Vec3f n, float eta) {
  const float cosine = -dot(d, n);
  const float k = 1 - eta * eta * (1 - cosine * cosine);
  if (k < 0) return std::nullopt;
  return renormalize(d * eta + n * (eta * cosine - std::sqrt(k)));
}

}  // namespace

double radiance_bound(const Scene& scene, int depth) {
  double light = 0.1;  // ambient
  for (const Light& l : scene.lights) light += l.color ? max_component(*l.color) : 1.0;
  double brightest = 0, gain = 0;
  for (const Material& m : scene.materials) {
    brightest = std::max(brightest, light * (max_component(m.color) * (1.0 + m.kd) + m.ks));
    gain = std::max(gain, double(m.ks) + m.transmission);
  }
  brightest += max_component(scene.background);
  double sum = 0, weight = 1;
  for (int level = 0; level <= depth; ++level, weight *= gain) sum += weight * brightest;
  return sum;
}

ClassicScene::ClassicScene(const Scene& s, const Accel& a, const RenderOptions& o)
    : scene(s),
      accel(a),
      options(o),
      eye(s.camera, o.width, o.height),
      sampler(o.seed, o.aa, o.lens_samples) {
  const bool any_color =
      std::ranges::any_of(s.lights, [](const Light& l) { return l.color.has_value(); });
  ambient = any_color ? Rgb() : Rgb(0.1f);
  const Rgb uncolored(float(1 / std::sqrt(double(std::max<size_t>(1, s.lights.size())))));
  for (const Light& l : s.lights) {
    Emitter e{l.position, l.color.value_or(uncolored), {}, {}};
    if (o.soft_shadows) {
      const Vec3f to_at = s.camera.at - l.position;
      const float distance = length(to_at);
      const Frame<float> frame(distance > 0 ? to_at / distance : Vec3f(0, 0, 1));
      const float size = o.light_size > 0 ? o.light_size : 0.1f * distance;
      e.edge_u = frame.u * size, e.edge_v = frame.v * size;
    }
    emitters.push_back(e);
  }
}

void ClassicTracer::PathRays::take_last(size_t count, PathRays& from) {
  rays.clear();
  if (from.rays.size() <= count) return std::swap(*this, from);
  const size_t left = from.rays.size() - count;
  for (size_t i = left; i < from.rays.size(); ++i)
    push(from.rays[i], from.pixel[i], from.branch[i], from.weight[i]);
  from.rays.resize(left);
}

ClassicTracer::ClassicTracer(const ClassicScene& scene, const RenderControl& control)
    : scene_(scene),
      waiting_(size_t(scene.options.depth) + 1),
      shadows_(scene.emitters.size()),
      hidden_(kChunk) {
  context_.stop = &control.stop;
}

void ClassicTracer::add_sample(const Tile& tile, uint32_t sample, Film& film) {
  const RenderOptions& o = scene_.options;
  sample_ = sample;
  for (PathRays& w : waiting_) w.rays.clear();  // left over where a render was stopped
  PathRays& eye = waiting_[1];
  const auto push = [&](int x, int y) {
    const uint32_t pixel = uint32_t(y) * uint32_t(o.width) + uint32_t(x);
    const Point2 place = scene_.sampler.in_pixel(pixel, sample);
    const float px = float(x) + place.x, py = float(y) + place.y;
    Ray ray;
    if (*o.dof) {
      const Point2 square = scene_.sampler.in_square(pixel, sample, kEyeBranch, kLens);
      ray = scene_.eye.thin_lens(px, py, square_to_disc(square.x, square.y), o.aperture, o.focus);
    } else {
      ray = scene_.eye.pinhole(px, py);
    }
    eye.push(ray, pixel, kEyeBranch, 1);
  };
  // In blocks of 4 x 2: structures take eight neighbours of the batch together.
  for (int y = tile.y0; y < tile.y1; y += 2)
    for (int x = tile.x0; x < tile.x1; x += 4)
      for (int by = y; by < std::min(y + 2, tile.y1); ++by)
        for (int bx = x; bx < std::min(x + 4, tile.x1); ++bx) push(bx, by);
  for (int level = 1; level > 0 && !context_.stopped();) {
    if (waiting_[size_t(level)].rays.size() == 0) {
      --level;
      continue;
    }
    trace_level(level, film);
    if (level < o.depth) ++level;
  }
  counts_.tests = context_.tests, counts_.steps = context_.steps;
}

// The last rays that wait at `level`: what they bring goes to the film, their children wait one
// further.
void ClassicTracer::trace_level(int level, Film& film) {
  current_.take_last(kChunk, waiting_[size_t(level)]);
  const size_t n = current_.rays.size();
  context_.coherent = level <= 3;  // eye rays and their first children mostly keep together
  scene_.accel.closest(current_.rays, hits_, context_);
  if (level == 1) counts_.eye += n;
  for (size_t i = 0; i < n && !context_.stopped(); ++i) {
    if (hits_.item[i] != kNoItem) {
      if (level == 1) ++counts_.eye_hits;
      shade(level, i, film);
    } else {
      film.add(current_.pixel[i], scene_.scene.background * current_.weight[i]);
    }
  }
  trace_shadows(film);
}

void ClassicTracer::shade(int level, size_t i, Film& film) {
  const Ray ray = current_.rays[i];
  const uint32_t pixel = current_.pixel[i], branch = current_.branch[i];
  const float weight = current_.weight[i];
  const Surface surface = surface_at(scene_.accel.geometry(), ray, hits_[i]);
  const Material& material = scene_.scene.materials[surface.material];

  const bool entering = dot(surface.geometric, ray.dir) < 0;
  const Vec3f geometric = entering ? surface.geometric : -surface.geometric;
  const Vec3f normal = entering ? surface.normal : -surface.normal;
  const Vec3f outside = offset_origin(surface.point, geometric, surface.scale, true);

  if (scene_.ambient.x > 0) film.add(pixel, scene_.ambient * material.color * weight);
  for (size_t l = 0; l < scene_.emitters.size(); ++l) {
    const ClassicScene::Emitter& emitter = scene_.emitters[l];
    Vec3f target = emitter.position;
    if (scene_.options.soft_shadows) {
      const Point2 p = scene_.sampler.in_square(pixel, sample_, branch, kLight + uint32_t(l));
      target += emitter.edge_u * (p.x - 0.5f) + emitter.edge_v * (p.y - 0.5f);
    }
    const Vec3f to_light = target - outside;
    const float distance = length(to_light);
    if (!(distance > 0)) continue;
    const Vec3f dir = to_light * (1 / distance);
    const float cosine = dot(normal, dir);
    // Nothing from behind the surface, even where a smooth triangle's normal leans that way.
    if (!(cosine > 0) || !(dot(geometric, dir) > 0)) continue;
    Rgb light = material.color * (material.kd * cosine);
    if (material.ks > 0) {
      const float mirror = -dot(reflect(-dir, normal), ray.dir);
      light += Rgb(material.ks * pow_unit(std::min(mirror, 1.0f), material.shine));
    }
    // Ends at the light: short of it by what the division above may have rounded.
    const float tmax = distance * (1 - 4 * std::numeric_limits<float>::epsilon());
    shadows_[l].push({outside, dir, tmax}, pixel, emitter.intensity * light * weight);
  }

  // A smooth triangle's normal can send a ray through the surface that it should leave; then the
  // geometric one decides.
  if (material.ks > 0) {
    Vec3f dir = renormalize(reflect(ray.dir, normal));
    if (!(dot(dir, geometric) > 0)) dir = renormalize(reflect(ray.dir, geometric));
    if (level < scene_.options.depth) ++counts_.reflection;
    spawn(level, {outside, dir}, pixel, 2 * branch, weight * material.ks, film);
  }
  if (material.transmission > 0) {
    const float eta = entering ? 1 / material.ior : material.ior;
    auto dir = refract(ray.dir, normal, eta);
    if (dir && !(dot(*dir, geometric) < 0)) dir = refract(ray.dir, geometric, eta);
    if (dir) {
      const Vec3f inside = offset_origin(surface.point, geometric, surface.scale, false);
      if (level < scene_.options.depth) ++counts_.refraction;
      spawn(level, {inside, *dir}, pixel, 2 * branch + 1, weight * material.transmission, film);
    }
  }
}

void ClassicTracer::spawn(int level, const Ray& ray, uint32_t pixel, uint32_t branch, float weight,
                          Film& film) {
  if (level < scene_.options.depth)
    waiting_[size_t(level) + 1].push(ray, pixel, branch, weight);
  else
    film.add(pixel, scene_.scene.background * weight);
}

void ClassicTracer::trace_shadows(Film& film) {
  for (ShadowRays& shadow : shadows_) {
    const size_t n = shadow.rays.size();
    scene_.accel.occluded(shadow.rays, hidden_.data(), context_);
    counts_.shadow += n;
    if (!context_.stopped())
      for (size_t i = 0; i < n; ++i) {
        if (hidden_[i])
          ++counts_.shadow_hits;
        else
          film.add(shadow.pixel[i], shadow.light[i]);
      }
    shadow.rays.clear();
  }
}

}  // namespace raio
