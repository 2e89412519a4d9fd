// Tools of several shadings. Included once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_SHADING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_SHADING_INL_H_
#undef RAIO_INTEGRATE_SHADING_INL_H_
#else
#define RAIO_INTEGRATE_SHADING_INL_H_
#endif

#include "integrate/sampler-inl.h"
#include "integrate/wavefront-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Rays that are not in `mask` count as unlit.
HWY_INLINE void put_ray(RayBatch& rays, size_t i, const V3& origin, const V3& dir, V tmax, M mask) {
  hn::Store(origin.x, d, &rays.ox[i]), hn::Store(origin.y, d, &rays.oy[i]);
  hn::Store(origin.z, d, &rays.oz[i]);
  hn::Store(dir.x, d, &rays.dx[i]), hn::Store(dir.y, d, &rays.dy[i]);
  hn::Store(dir.z, d, &rays.dz[i]);
  hn::Store(hn::IfThenElse(mask, tmax, hn::Set(d, -1)), d, &rays.tmax[i]);
}

// Traces the wavefront's shadow rays and adds light(i, the unoccluded share) to the radiance.
// Returns which are occluded; null if there are none.
template <class Light>
const uint8_t* add_lit(Wavefront& w, size_t n, const WideSampler<D>& sampler, Purpose depth,
                       const Light& light) {
  SurfacePoints& v = w.points();
  const RayBatch& rays = w.shadow_rays();
  const V zero = hn::Zero(d);
  size_t asked = 0;
  for (size_t i = 0; i < n; i += kWidth)
    asked += hn::CountTrue(d, hn::And(hn::FirstN(d, n - i), hn::Gt(load(rays.tmax, i), zero)));
  if (asked == 0) return nullptr;
  w.counts().shadow += asked;
  const uint8_t* const hidden = w.occluded(sampler, depth);
  for (size_t i = 0; i < n; i += kWidth) {
    const M sent = hn::And(hn::FirstN(d, n - i), hn::Gt(load(rays.tmax, i), zero));
    const auto stopped = hn::PromoteTo(du, hn::LoadU(hn::Rebind<uint8_t, DU>(), hidden + i));
    const M seen = hn::And(sent, hn::RebindMask(d, hn::Eq(stopped, hn::Zero(du))));
    w.counts().shadow_hits += hn::CountTrue(d, hn::AndNot(seen, sent));
    if (hn::AllFalse(d, seen)) continue;
    const V share = w.shares() ? hn::LoadU(d, w.shares() + i) : hn::Set(d, 1);
    const V3 sum = load(v.radiance, i) + light(i, hn::IfThenElseZero(seen, share));
    store(select(seen, sum, load(v.radiance, i)), v.radiance, i);
  }
  return hidden;
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
