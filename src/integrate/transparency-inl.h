// The wavefront's pass for transparent primitives. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_INTEGRATE_TRANSPARENCY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_TRANSPARENCY_INL_H_
#undef RAIO_INTEGRATE_TRANSPARENCY_INL_H_
#else
#define RAIO_INTEGRATE_TRANSPARENCY_INL_H_
#endif

#include <algorithm>
#include <span>
#include <vector>

#include "integrate/layers-inl.h"
#include "integrate/wavefront-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

class Transparency {
 public:
  explicit Transparency(Wavefront& wavefront)
      : w_(wavefront), first_(kRoom), coverage_(kRoom), shares_(kRoom) {}

  // Shades transparent layers in front of the current rays' hits and keeps the rays that pass, with
  // their transmittance as weight. tmax is 0 for rays that hit something.
  void trace(int level, const WideSampler<D>& sampler) {
    PathRays& rays = w_.rays();
    const Accel& accel = w_.scene().accel;
    const size_t n = rays.rays.size();
    const bool many = layers_.find(accel, rays.rays, w_.hits(), w_.context());
    if (w_.stopped()) return;
    if (many) {
      places_.resize(padded(n)), keys_.resize(padded(n));
      for (size_t i = 0; i < n; i += kWidth) {
        const U place = w_.place_of(load(rays.pixel, i)), branch = load(rays.branch, i);
        hn::StoreU(sampler.in_unit(place, branch, kLayer), d, &places_[i]);
        hn::StoreU(sampler.key(place, branch, kLayerKey), du, &keys_[i]);
      }
    }
    layers_.choose(accel, places_.data(), keys_.data(), w_.context());
    if (w_.stopped()) return;
    behind_.use_columns_of(rays);
    std::swap(behind_, rays), std::swap(behind_hits_, w_.hits());
    const auto& list = layers_.shaded();
    if (level == 1 && !list.empty()) add_coverage(n);
    if (level == 1 && many) add_first_features();
    for (size_t begin = 0; begin < list.size(); begin += kChunk) {
      const size_t count = std::min(list.size() - begin, kChunk);
      take_layers(std::span(list).subspan(begin, count));
      for (size_t k = 0; k < count; ++k) first_[k] = list[begin + k].first;
      w_.shade_hits(level, sampler);
      if (w_.stopped()) return;
    }
    size_t kept = 0;
    rays.resize(n), w_.hits().reset(n);
    for (size_t i = 0; i < n; ++i) {
      const float part = layers_.through(i);
      if (part == 0) continue;
      rays.set(kept, behind_, i, part), w_.hits().set(kept, behind_hits_[i]);
      if (layers_.met(i)) rays.rays.tmax[kept] = 0;
      ++kept;
    }
    rays.rays.resize(kept);
    w_.fill_up(kept);
  }

  // Prepares first() and coverage() for the opaque hits of the current rays.
  void begin_opaque() {
    const PathRays& rays = w_.rays();
    for (size_t i = 0; i < rays.rays.size(); ++i) {
      coverage_[i] = covered(rays.weight[0][i]);
      first_[i] = rays.rays.tmax[i] > 0;
    }
  }
  // For the current rays: 1 if they have hit nothing before; and their contribution to the
  // coverage.
  const uint8_t* first() const { return first_.data(); }
  const int64_t* coverage() const { return coverage_.data(); }

  // Finds the transmittance of transparent primitives on each shadow ray that is not `hidden`. The
  // densest primitive and a depth of kExactDepth count exactly; whether the ray passes the rest is
  // random, with the transmittance as the probability.
  void find_shares(const RayBatch& shadow, const uint8_t* hidden, const WideSampler<D>& sampler,
                   uint32_t depth) {
    static constexpr uint32_t kExactDepth = kHalving / 2;
    const size_t n = shadow.size();
    depths_.reset(n, hidden);
    for (size_t i = 0; i < n; i += kWidth) {
      const V u =
          sampler.in_unit(w_.place_of(load(w_.rays().pixel, i)), load(w_.rays().branch, i), depth);
      const V halvings = hn::Neg(log2_of(d, hn::Sub(hn::Set(d, 1), u)));
      const auto limit = hn::ConvertTo(Signed<D>(), hn::Mul(halvings, hn::Set(d, kHalving)));
      hn::StoreU(hn::Add(hn::BitCast(du, limit), hn::Set(du, kExactDepth)), du, &depths_.limit[i]);
    }
    w_.scene().accel.transparent_depths(shadow, depths_, w_.context());
    for (size_t i = 0; i < n; ++i) {
      const uint32_t sum = depths_.sum[i], largest = depths_.largest[i];
      shares_[i] =
          depths_.is_stopped(i) ? 0 : passed(largest + std::min(sum - largest, kExactDepth));
    }
  }
  const float* shares() const { return shares_.data(); }

 private:
  static constexpr size_t kRoom = padded(kChunk);

  // Makes those of behind_ that hit the layers the current rays.
  void take_layers(std::span<const ShadedLayer> layers) {
    const size_t n = layers.size();
    w_.rays().resize(n), w_.hits().reset(n);
    for (size_t k = 0; k < n; ++k) {
      w_.rays().set(k, behind_, layers[k].ray, layers[k].part), w_.hits().set(k, layers[k].hit);
      coverage_[k] = 0;
    }
    w_.rays().rays.resize(n);
    w_.fill_up(n);
  }
  // Adds the coverage of each pixel by its eye rays' transparent layers.
  void add_coverage(size_t n) {
    for (size_t i = 0; i < n; ++i) coverage_[i] = kFullCoverage - covered(layers_.through(i));
    for (size_t i = 0; i < n; i += kWidth)
      w_.sums().add(set3(d, Rgb()), &behind_.pixel[i], hn::FirstN(d, n - i), &coverage_[i]);
  }
  // For eye rays with a first layer that is not shaded.
  void add_first_features() {
    const auto& list = layers_.unshaded_firsts();
    if (list.empty()) return;
    take_layers(list);
    w_.add_features();
  }

  Wavefront& w_;
  Layers layers_;
  std::vector<float> places_;
  std::vector<uint32_t> keys_;
  std::vector<uint8_t> first_;
  std::vector<int64_t> coverage_;
  PathRays behind_;  // the rays that continue behind the layers
  HitBatch behind_hits_;
  DepthBatch depths_;  // of shadow rays
  std::vector<float> shares_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
