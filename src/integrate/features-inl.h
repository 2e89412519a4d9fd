// Channels of the surfaces that eye rays hit. Included once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_FEATURES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_FEATURES_INL_H_
#undef RAIO_INTEGRATE_FEATURES_INL_H_
#else
#define RAIO_INTEGRATE_FEATURES_INL_H_
#endif

#include <algorithm>
#include <memory>

#include "accel/primitive_numbers.h"
#include "integrate/camera-inl.h"
#include "integrate/prepared_scene.h"
#include "integrate/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// The depth of points along the line of sight, or, for all directions, from the eye.
HWY_INLINE V depth_of(const PreparedScene& scene, const V3& points) {
  const V3 away = points - set3(d, scene.eye.from);
  return scene.eye.omnidirectional ? length(away) : dot(away, set3(d, scene.forward));
}

// The depths of the hits of rays i, i + 1, ... along the line of sight, from the camera, wherever
// on the lens they start.
HWY_INLINE V depths_of_hits(const PreparedScene& scene, const RayBatch& rays, const HitBatch& hits,
                            size_t i) {
  const V3 points = origins(rays, i) + directions(rays, i) * load(hits.t, i);
  if (!scene.eye.movement) return depth_of(scene, points);
  V depths = hn::Zero(d);
  for (size_t k = i; k < std::min(i + kWidth, rays.size()); ++k) {
    const Camera camera = camera_at(scene.settings.camera, rays.time[k]);
    const V3 forward = set3(d, normalize(camera.at - camera.from));
    const V3 away = points - set3(d, camera.from);
    const V depth = scene.eye.omnidirectional ? length(away) : dot(away, forward);
    depths = hn::IfThenElse(hn::FirstN(d, k - i), depths, depth);
  }
  return depths;
}

class Features {
 public:
  explicit Features(const PreparedScene& scene)
      : scene_(scene),
        ids_(scene.settings.channels.has(Channel::id)
                 ? std::make_unique<PrimitiveNumbers>(scene.accel.geometry())
                 : nullptr) {}

  // Adds the values of all `rays`, which hit something, to the sums of `pixels`; if `counts` is
  // given, only of rays where it is not 0.
  void add(const RayBatch& rays, const HitBatch& hits, const SurfacePoints& vertices,
           const uint32_t* pixels, const uint8_t* counts, uint32_t sample, TileSums& sums) const {
    const FilmLayout& layout = sums.layout();
    const bool normals = layout.has(Channel::normal), albedo = layout.has(Channel::albedo);
    const bool firsts = sums.is_first(sample);
    for (size_t i = 0; i < rays.size(); i += kWidth) {
      M mask = hn::FirstN(d, rays.size() - i);
      if (counts) {
        const U count = hn::PromoteTo(du, hn::LoadU(hn::Rebind<uint8_t, DU>(), counts + i));
        mask = hn::And(mask, hn::RebindMask(d, hn::Ne(count, hn::Zero(du))));
      }
      if (normals) sums.add_mean(Channel::normal, load(vertices.normal, i), pixels + i, mask);
      if (albedo)
        sums.add_mean(Channel::albedo, load(vertices.color, i) * load(vertices.kd, i), pixels + i,
                      mask);
      if (firsts)
        set_firsts(
            rays, hits, vertices, i,
            [&](Channel channel, size_t component, U values)
                HWY_ATTR { sums.set_first(channel, component, values, pixels + i, mask); },
            layout);
    }
  }

 private:
  template <class Set>
  HWY_INLINE void set_firsts(const RayBatch& rays, const HitBatch& hits,
                             const SurfacePoints& vertices, size_t i, const Set& set,
                             const FilmLayout& layout) const {
    // value(primitive, instance) of the lanes.
    const auto of_hits = [&](auto&& value) HWY_ATTR {
      HWY_ALIGN uint32_t values[kWidth] = {};
      for (size_t k = i; k < std::min(i + kWidth, rays.size()); ++k)
        values[k - i] = value(hits.primitive[k], hits.instance[k]);
      return hn::Load(du, values);
    };
    if (layout.has(Channel::depth))
      set(Channel::depth, 0, hn::BitCast(du, depths_of_hits(scene_, rays, hits, i)));
    for (const Channel channel : {Channel::position, Channel::position_low}) {
      if (!layout.has(channel)) continue;
      const V3 point = load(vertices.point, i);
      const V parts[3] = {point.x, point.y, point.z};
      for (size_t c = 0; c < 3; ++c)
        set(channel, c, in_file(parts[c], scene_.scene.origin[int(c)], channel));
    }
    if (layout.has(Channel::id))
      set(Channel::id, 0, of_hits([&](PrimitiveId id, InstanceId instance) {
            return uint32_t(ids_->number(id, instance));
          }));
    if (layout.has(Channel::object))
      set(Channel::object, 0, of_hits([&](PrimitiveId id, InstanceId instance) {
            return scene_.accel.geometry().object_of(id, instance);
          }));
  }

  // A coordinate of points as in the file, or the rounding error of its float.
  static HWY_INLINE U in_file(V x, double origin, Channel channel) {
    const hn::CappedTag<double, kWidth> doubles;
    const hn::Rebind<float, decltype(doubles)> halves;
    HWY_ALIGN float parts[kWidth];
    hn::Store(x, d, parts);
    for (size_t k = 0; k < kWidth; k += hn::MaxLanes(doubles)) {
      const auto wide =
          hn::Add(hn::Set(doubles, origin), hn::PromoteTo(doubles, hn::Load(halves, parts + k)));
      auto part = hn::DemoteTo(halves, wide);
      if (channel == Channel::position_low)
        part = hn::DemoteTo(halves, hn::Sub(wide, hn::PromoteTo(doubles, part)));
      hn::Store(part, halves, parts + k);
    }
    return hn::BitCast(du, hn::Load(d, parts));
  }

  const PreparedScene& scene_;
  std::unique_ptr<const PrimitiveNumbers> ids_;  // for the channel `id`
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
