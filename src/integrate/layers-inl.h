// Finds the transparent layers along rays and chooses which of them are shaded. If there are few,
// all are shaded. Of many, those with the largest weights are shaded, and one of the others is
// chosen at random, with a probability proportional to its weight, so the mean does not change.
// Beyond the layers found in order, each layer stops the ray with its opacity as the probability;
// the nearest of the stopping layers is shaded. If much light passes all layers, the surface or
// background behind them counts with the transmittance, not at random.
//
// Enderton, Sintorn, Shirley and Luebke 2010, "Stochastic Transparency", I3D. Included once per
// instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_LAYERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_LAYERS_INL_H_
#undef RAIO_INTEGRATE_LAYERS_INL_H_
#else
#define RAIO_INTEGRATE_LAYERS_INL_H_
#endif

#include <array>
#include <vector>

#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// A layer to be shaded.
struct ShadedLayer {
  uint32_t ray;
  float part;  // of the ray's weight
  Hit hit;
  bool first = false;  // of the ray
};

class Layers {
 public:
  // Finds the first layers of each ray, nearest first, in front of its opaque hit. Returns whether
  // any ray may have more than are kept; then choose() needs random numbers. If the trace was
  // stopped, there are no layers.
  bool find(const Accel& accel, const RayBatch& rays, const HitBatch& behind,
            TraceContext& context) {
    const size_t n = rays.size();
    for (Front* front : {&going_, &many_}) {
      if (rays.has_time()) front->rays.add_time();
      front->resize(n);
    }
    met_.assign(n, {});
    for (size_t i = 0; i < n; ++i) {
      Ray ray = rays[i];
      ray.tmax = behind.t[i];  // for a miss, that of the ray
      going_.set(i, ray, Hit{.t = 0, .primitive = 0}, uint32_t(i));
    }
    size_t many = 0;
    for (size_t k = 0; k < kKnown && going_.size() > 0; ++k) {
      accel.next_transparent(going_.rays, going_.after, next_, context);
      if (context.stopped()) return false;
      layer_[k].reset(n);
      size_t kept = 0;
      for (size_t j = 0; j < going_.size(); ++j) {
        const Hit hit = next_[j];
        if (!hit.found()) continue;
        const uint32_t i = going_.from[j];
        Met& met = met_[i];
        layer_[k].set(i, hit);
        met.depth =
            std::min(met.depth + accel.geometry().object_at(hit.instance).depth_of(hit.primitive),
                     kMaxOpticalDepth);
        met.through[met.count++] = passed(met.depth);
        if (met.through[k] == 0) continue;
        met.is_many = met.through[k] <= kLittle || met.count == kKnown;
        if (met.is_many)
          many_.set(many++, going_.rays[j], hit, i);
        else
          going_.set(kept++, going_.rays[j], hit, i);
      }
      going_.resize(kept);
    }
    many_.resize(many);
    return many > 0;
  }

  // Lists the layers to shade, given a random position in [0, 1) and a random key per ray.
  void choose(const Accel& accel, const float* places, const uint32_t* keys,
              TraceContext& context) {
    shaded_.clear(), unshaded_firsts_.clear();
    for (uint32_t i = 0; i < met_.size(); ++i)
      if (!met_[i].is_many) list_all(i);
    if (many_.size() == 0) return;
    sum_depths(accel, context);
    // Rays that continue behind the known layers are compacted.
    size_t kept = 0;
    parts_.resize(many_.size()), stops_.resize(many_.size());
    for (size_t j = 0; j < many_.size(); ++j) {
      const uint32_t i = many_.from[j];
      // The transmittance of all layers, if known.
      const float behind = depths_.is_stopped(j) ? 0 : passed(depths_.sum[j]);
      if (!choose_known(i, behind, places[i])) continue;
      const float passes = behind / met_[i].through[met_[i].count - 1];
      parts_[kept] = 1 - met_[i].always - behind;
      stops_[kept] = 1 - passes * passes * passes * passes;
      static_assert(kTries == 4);
      many_.set(kept++, many_.rays[j], many_.after[j], i);
    }
    many_.resize(kept);
    for (uint32_t t = 0; t < kTries && many_.size() > 0; ++t)
      choose_beyond(accel, t, keys, context);
  }

  const std::vector<ShadedLayer>& shaded() const { return shaded_; }
  // The first layers of rays, if not shaded.
  const std::vector<ShadedLayer>& unshaded_firsts() const { return unshaded_firsts_; }
  bool met(size_t i) const { return met_[i].count > 0; }
  // The weight of the surface or background behind the layers, relative to that of ray i.
  float through(size_t i) const { return met_[i].goes_on; }

 private:
  static constexpr size_t kKnown = 5;          // one more than the maximum that are all shaded
  static constexpr float kLittle = 1 / 128.f;  // transmittance below which layers are not listed
  static constexpr float kCounts =
      0.28f;  // weight above which one of many is always shaded; measured
  static constexpr uint32_t kTries = 4;  // attempts to find a layer that stops a ray
  static constexpr uint32_t kExactDepth = 3 * kHalving;  // of all layers

  struct Met {
    uint32_t depth = 0, count = 0;
    bool is_many = false;
    std::array<float, kKnown> through{};  // transmittance to behind each
    float always = 0;                     // of many, the weight that is always shaded
    float goes_on = 1;
  };

  // Rays that look for more layers behind those found.
  struct Front {
    RayBatch rays;
    HitBatch after;
    std::vector<uint32_t> from;  // their indices among the rays of find()

    size_t size() const { return rays.size(); }
    void resize(size_t n) { rays.resize(n), after.reset(n), from.resize(n); }
    void set(size_t i, const Ray& ray, const Hit& hit, uint32_t number) {
      rays.set(i, ray), after.set(i, hit), from[i] = number;
    }
  };

  void list_all(uint32_t i) {
    Met& met = met_[i];
    for (size_t k = 0; k < met.count; ++k) {
      shaded_.push_back({i, met.goes_on - met.through[k], layer_[k][i], k == 0});
      met.goes_on = met.through[k];
    }
  }

  // Sums the depths of all layers, if small; other rays are stopped.
  void sum_depths(const Accel& accel, TraceContext& context) {
    const size_t n = many_.size();
    is_dense_.resize(n);
    for (size_t j = 0; j < n; ++j) is_dense_[j] = met_[many_.from[j]].depth >= kExactDepth;
    depths_.reset(n, is_dense_.data());
    std::fill_n(depths_.limit.begin(), n, kExactDepth);
    accel.transparent_depths(many_.rays, depths_, context);
  }

  // Whether a layer behind the known ones is chosen.
  bool choose_known(uint32_t i, float behind, float place) {
    Met& met = met_[i];
    float part[kKnown], before = 1;
    for (size_t k = 0; k < met.count; ++k) {
      part[k] = before - met.through[k], before = met.through[k];
      if (part[k] < kCounts) continue;
      shaded_.push_back({i, part[k], layer_[k][i], k == 0});
      met.always += part[k];
    }
    if (part[0] < kCounts) unshaded_firsts_.push_back({i, 0, layer_[0][i], true});
    const float rest = 1 - met.always - behind;
    met.goes_on = behind;
    float left = place * rest;
    for (size_t k = 0; k < met.count; ++k) {
      if (part[k] >= kCounts) continue;
      if (left < part[k]) {
        shaded_.push_back({i, rest, layer_[k][i]});
        return false;
      }
      left -= part[k];
    }
    return true;
  }

  // If the transmittance is known, a ray looks several times for a layer that stops it; the
  // fraction of successful attempts then scales the weight. Otherwise unstopped rays continue.
  void choose_beyond(const Accel& accel, uint32_t t, const uint32_t* keys, TraceContext& context) {
    const size_t n = many_.size();
    keys_.resize(n);
    for (size_t j = 0; j < n; ++j) keys_[j] = keys[many_.from[j]] + t;
    accel.next_transparent(many_.rays, many_.after, next_, context, keys_.data());
    size_t kept = 0;
    for (size_t j = 0; j < n; ++j) {
      const uint32_t i = many_.from[j];
      if (next_[j].found()) {
        shaded_.push_back({i, parts_[j] / stops_[j], next_[j]});
      } else if (met_[i].goes_on > 0) {
        parts_[kept] = parts_[j], stops_[kept] = stops_[j];
        many_.set(kept++, many_.rays[j], many_.after[j], i);
      } else {
        met_[i].goes_on = parts_[j];
      }
    }
    many_.resize(kept);
  }

  Front going_,
      many_;  // rays that look for the next layer, and those that may have more than they keep
  HitBatch next_;
  DepthBatch depths_;
  std::vector<uint8_t> is_dense_;
  std::vector<float> parts_, stops_;  // of rays that choose a layer behind the known ones
  std::vector<uint32_t> keys_;
  std::vector<Met> met_;
  std::array<HitBatch, kKnown> layer_;
  std::vector<ShadedLayer> shaded_, unshaded_firsts_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
