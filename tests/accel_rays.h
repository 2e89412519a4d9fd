// Rays of all kinds through a scene, and the differences of two structures' hits.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "accel/accel.h"
#include "integrate/camera.h"
#include "scenes.h"

namespace raio::core::tests {

inline Vec3f random_direction(std::mt19937& rng) {
  std::normal_distribution<float> normal;
  while (true) {
    const Vec3f d(normal(rng), normal(rng), normal(rng));
    if (dot(d, d) > 1e-6f) return normalize(d);
  }
}

// Ordinary and pathological rays: through the scene from outside and inside, along the axes and in
// the planes of cells, towards the boxes' corners, and of limited length.
inline RayBatch awkward_rays(const Scene& scene, int count, uint32_t seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Box3f box = bounds(scene);
  if (box.empty()) box = {scene.camera.at - Vec3f(1), scene.camera.at + Vec3f(1)};
  const auto inside = [&] { return box.lo + box.size() * Vec3f(unit(rng), unit(rng), unit(rng)); };
  RayBatch rays;
  const EyeRays eye(scene.camera, 64, 64);
  const float extent = max_component(box.size());
  for (int i = 0; i < count; ++i) {
    Ray ray;
    switch (i % 5) {
      case 0:
        ray = eye.pinhole(64 * unit(rng), 64 * unit(rng));
        break;
      case 1:
        ray = {inside(), random_direction(rng)};
        break;
      case 2: {
        const Vec3f origin = inside() + random_direction(rng) * (2 * extent);
        ray = {origin, normalize(inside() - origin)};
        break;
      }
      case 3: {  // along an axis, from a point on a face of the box or of a cell of a grid
        const int axis = int(rng() % 3);
        Vec3f origin = inside(), dir;
        dir[axis] = rng() % 2 ? 1.0f : -1.0f;
        origin[(axis + 1) % 3] =
            box.lo[(axis + 1) % 3] + box.size()[(axis + 1) % 3] * float(rng() % 9) / 8;
        ray = {origin - dir * extent, dir};
        break;
      }
      case 4:
        ray = {inside(), random_direction(rng), extent * 0.2f * unit(rng)};
        break;
    }
    rays.push(ray);
  }
  return rays;
}

// The scene with two-sided surfaces, which coherent rays require.
inline Scene two_sided(Scene scene) {
  for (Sphere& s : scene.spheres) s.radius = std::abs(s.radius);
  for (Cone& c : scene.cones)
    c.base_radius = std::abs(c.base_radius), c.apex_radius = std::abs(c.apex_radius);
  return scene;
}

// Shadow rays: from the hits of eye rays towards a light, in their order, including rays that need
// no test.
inline RayBatch shadow_rays(const Accel& accel, const RayBatch& eye, Vec3f light) {
  HitBatch hits;
  TraceContext context;
  accel.closest(eye, hits, context);
  RayBatch rays;
  for (size_t i = 0; i < eye.size(); ++i) {
    const Vec3f point = eye[i].at(hits[i].found() ? 0.999f * hits[i].t : 1.0f);
    const Vec3f to_light = light - point;
    const float distance = length(to_light);
    rays.push({point, to_light / distance, hits[i].found() && i % 5 ? distance : -1.0f});
  }
  return rays;
}

// The same rays at times from before the first movement to after the last of moving_scene().
inline RayBatch at_any_time(RayBatch rays) {
  rays.add_time();
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> time(-0.25f, 1.25f);
  for (size_t i = 0; i < rays.size(); ++i) rays.time[i] = time(rng);
  return rays;
}

// Packets: blocks of pixels.
inline RayBatch eye_rays(const Scene& scene, int side) {
  RayBatch rays;
  const EyeRays eye(scene.camera, side, side);
  for (int y = 0; y < side; y += 4)
    for (int x = 0; x < side; x += 4)
      for (int k = 0; k < 16; ++k) rays.push(eye.pinhole(float(x + k % 4), float(y + k / 4)));
  return rays;
}

struct Disagreement {
  size_t closest = 0, occluded = 0, total = 0;
};

// A structure's results for rays.
struct Answers {
  HitBatch closest;
  std::vector<uint8_t> occluded;
};
inline Answers answers(const Accel& accel, const RayBatch& rays, bool coherent = false) {
  TraceContext context;
  context.coherent = coherent;
  Answers out;
  out.occluded.resize(padded(rays.size()));
  accel.closest(rays, out.closest, context);
  accel.occluded(rays, out.occluded.data(), context);
  return out;
}

// `exact`: the same item at the same distance to the last bit; otherwise the distance to a
// tolerance, which may belong to another of several primitives that touch (and not the rays along
// the axes).
inline Disagreement disagreement(const Answers& oracle, const Accel& accel, const RayBatch& rays,
                                 bool exact, bool coherent = false) {
  const Answers found = answers(accel, rays, coherent);
  Disagreement out;
  out.total = rays.size();
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit a = oracle.closest[i], b = found.closest[i];
    if (!exact && i % 5 == 3) continue;  // along edges of boxes: in or out are both right
    EXPECT_EQ(oracle.occluded[i] != 0, a.found()) << "the oracle disagrees with itself, ray " << i;
    const bool same =
        exact ? a.primitive == b.primitive && a.instance == b.instance && (!a.found() || a.t == b.t)
              : a.found() == b.found() && (!a.found() || std::abs(a.t - b.t) <= 1e-4f * a.t);
    out.closest += !same;
    out.occluded += oracle.occluded[i] != found.occluded[i];
  }
  return out;
}
inline Disagreement disagreement(const Accel& oracle, const Accel& accel, const RayBatch& rays,
                                 bool exact, bool coherent = false) {
  return disagreement(answers(oracle, rays, coherent), accel, rays, exact, coherent);
}

inline std::unique_ptr<Accel> build(const Scene& scene, AccelOptions options,
                                    bool one_sided = false) {
  auto accel = build_accel(scene, options, one_sided);
  EXPECT_TRUE(accel.has_value()) << accel.error().text();
  return std::move(*accel);
}

struct ScaleAndShift {
  float scale;
  Vec3f shift;
};
inline const ScaleAndShift kScalesAndShifts[] = {
    {1, {}}, {1e-6f, {}}, {1e6f, {}}, {1, {500, -300, 100}}};

}  // namespace raio::core::tests
