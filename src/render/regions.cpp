#include "render/regions.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>

#include "base/parallel.h"
#include "integrate/camera.h"
#include "integrate/surface.h"
#include "shape/offset.h"

namespace raio::core {
namespace {

struct Pixel {
  PrimitiveId primitive = kNoPrimitive;
  InstanceId instance = 0;
  MaterialId material = 0;
  Vec3f point, normal;  // towards the ray
  uint64_t seen = 0;    // a bit per visible light, shared with every 64th after it
  bool hidden = false;  // a light that it faces is occluded
};

// Computes a row, with its shadow rays light by light.
void look(const Scene& scene, const Accel& accel, const EyeRays& eye, float time, int y,
          const std::atomic<bool>& stop, std::span<Pixel> row) {
  RayBatch rays;
  rays.add_time();
  HitBatch hits;
  TraceContext context;
  context.stop = &stop, context.coherent = true;
  for (size_t x = 0; x < row.size(); ++x)
    rays.push(eye.pinhole(float(x) + 0.5f, float(y) + 0.5f, time));
  hits.reset(rays.size());
  accel.closest_of_all(rays, hits, context);
  if (context.stopped()) return;
  std::vector<Vec3f> outside(row.size());
  for (size_t x = 0; x < row.size(); ++x) {
    if (!hits[x].found()) continue;
    const Surface s = surface_at(accel.geometry(), rays[x], hits[x]);
    const Vec3f normal = dot(s.normal, rays[x].dir) < 0 ? s.normal : -s.normal;
    row[x] = {.primitive = hits[x].primitive,
              .instance = hits[x].instance,
              .material = s.material,
              .point = s.point,
              .normal = normal};
    const float size = std::max({std::abs(s.point.x), std::abs(s.point.y), std::abs(s.point.z)});
    // The point may be off the surface by the rounding of the ray's length.
    outside[x] = offset_origin(s.point, normal, size + s.extent + hits[x].t, true);
  }
  std::vector<uint8_t> occluded(padded(row.size()));
  for (size_t l = 0; l < scene.lights.size(); ++l) {
    for (size_t x = 0; x < row.size(); ++x) {
      const Vec3f to_light = scene.lights[l].position - outside[x];
      const float distance = length(to_light);
      const bool faces = row[x].primitive != kNoPrimitive && dot(to_light, row[x].normal) > 0;
      rays.set(x, {outside[x], to_light / distance,
                   faces ? distance * (1 - 4 * std::numeric_limits<float>::epsilon()) : -1, time});
    }
    accel.occluded(rays, occluded.data(), context);
    if (context.stopped()) return;
    for (size_t x = 0; x < row.size(); ++x) {
      if (rays.tmax[x] <= 0) continue;
      if (occluded[x])
        row[x].hidden = true;
      else
        row[x].seen |= uint64_t(1) << (l % 64);
    }
  }
}

// Whether a surface ends, or has a crease, between two neighbours.
bool is_edge(const Pixel& a, const Pixel& b) {
  if (a.primitive == b.primitive && a.instance == b.instance) return false;
  if (a.primitive == kNoPrimitive || b.primitive == kNoPrimitive || a.material != b.material)
    return true;
  constexpr float kCrease = 0.9f;  // the cosine of 26 degrees
  const Vec3f apart = b.point - a.point;
  return dot(a.normal, b.normal) < kCrease || std::abs(dot(apart, a.normal)) > 0.5f * length(apart);
}

Region region_of(const Scene& scene, const std::vector<Pixel>& pixels, int width, int height, int x,
                 int y) {
  const auto at = [&](int column, int row) -> const Pixel& {
    return pixels[size_t(row) * size_t(width) + size_t(column)];
  };
  const Pixel& p = at(x, y);
  bool border = false;
  for (int row = std::max(y - 1, 0); row <= std::min(y + 1, height - 1); ++row)
    for (int column = std::max(x - 1, 0); column <= std::min(x + 1, width - 1); ++column) {
      const Pixel& other = at(column, row);
      if (is_edge(p, other)) return Region::edge;
      border |= p.seen != other.seen;
    }
  if (p.primitive == kNoPrimitive) return Region::background;
  const Material& m = scene.materials[p.material];
  if (m.transmission > 0 || (m.ks > 0 && m.ks >= m.kd)) return Region::mirror;
  if (m.ks > 0) return Region::shiny;
  return border ? Region::shadow_border : p.hidden ? Region::shadow : Region::lit;
}

}  // namespace

std::vector<Region> regions_of(const Scene& scene, const Accel& accel,
                               const RenderSettings& settings, const WorkControl& control) {
  const int width = settings.width, height = settings.height;
  const float time = settings.shutter_open;
  const EyeRays eye(camera_at(settings.camera, time), width, height, settings.angle_to_centers);
  std::vector<Pixel> pixels(size_t(width) * size_t(height));
  parallel_for(size_t(height), [&](size_t y) {
    look(scene, accel, eye, time, int(y), control.stop,
         std::span(pixels).subspan(y * size_t(width), size_t(width)));
  });
  if (control.stop) return {};
  std::vector<Region> regions(pixels.size());
  parallel_for(size_t(height), [&](size_t y) {
    for (int x = 0; x < width; ++x)
      regions[y * size_t(width) + size_t(x)] = region_of(scene, pixels, width, height, x, int(y));
  });
  return regions;
}

RegionDifferences differences(const Image& a, const Image& b, const std::vector<Region>& regions) {
  RegionDifferences found;
  for (size_t i = 0; i < regions.size(); ++i) {
    RegionDifference& d = found[size_t(regions[i])];
    ++d.pixels;
    const auto x = display_bytes(a.pixels[i]), y = display_bytes(b.pixels[i]);
    int most = 0, change = 0;
    for (size_t c = 0; c < 3; ++c)
      most = std::max(most, std::abs(x[c] - y[c])), change += y[c] - x[c];
    if (most <= 8) continue;
    ++d.apart;
    d.mean += change / 3.0;
  }
  for (RegionDifference& d : found) d.mean /= double(std::max<size_t>(d.apart, 1));
  return found;
}

std::optional<Region> suspect(const RegionDifferences& found) {
  const auto apart = [&](Region r) { return found[size_t(r)].apart; };
  const size_t matt = apart(Region::shadow_border) + apart(Region::shadow) + apart(Region::lit);
  const size_t reflecting = apart(Region::mirror) + apart(Region::shiny);
  std::vector<Region> candidates = {Region::background, Region::edge, Region::shadow_border,
                                    Region::shadow, Region::lit};
  if (10 * matt < reflecting) candidates.insert(candidates.end(), {Region::mirror, Region::shiny});
  const Region most = std::ranges::max(candidates, {}, apart);
  return apart(most) > 0 ? std::optional(most) : std::nullopt;
}

std::string_view likely_cause(Region region) {
  static constexpr std::array<std::string_view, kRegionNames.size()> kCauses = {
      "objects there, the background's colour, or the camera",
      "antialiasing, the lens, or the camera by a fraction of a pixel; whole objects: geometry",
      "reflected and refracted rays: their weights, depth, and clamping",
      "normals, highlights, clamping, and reflected rays",
      "positions and sizes of lights, or the number of samples",
      "shadow rays that start inside the object or end beyond the light; ambient light",
      "the diffuse part; if B is much darker, shadow rays that start inside the object or end "
      "beyond the light"};
  return kCauses[size_t(region)];
}

}  // namespace raio::core
