// Finds the transparent layers that rays meet and chooses which of them are shaded. A ray that
// meets few layers shades all of them. Of many, it shades those with the largest weights and
// chooses one of the others at random, with its weight as the probability, so the mean does not
// change. Beyond the layers that were found in order, each layer stops the ray with its opacity as
// the probability; the nearest one that stops the ray is shaded.
//
// Enderton, Sintorn, Shirley and Luebke 2010, "Stochastic Transparency", I3D.
// Once for each instruction set, as foreach_target.h passes again.
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
namespace raio::HWY_NAMESPACE {
namespace {

// A layer that a ray shades.
struct ShadedLayer {
  uint32_t ray;
  float part;  // of the ray's weight
  Hit hit;
  bool first = false;  // of the ray
};

class Layers {
 public:
  // Finds the first layers of each ray, nearest first, in front of its opaque hit. Returns whether
  // any ray has more layers than it keeps; choose() then needs random numbers.
  bool find(const Accel& accel, const RayBatch& rays, const HitBatch& behind,
            TraceContext& context) {
    const size_t n = rays.size();
    if (rays.has_time()) going_.add_time();
    going_.resize(n), after_.reset(n);
    from_.resize(n), met_.assign(n, {});
    for (size_t i = 0; i < n; ++i) {
      Ray ray = rays[i];
      ray.tmax = behind.t[i];  // of a miss that of the ray
      going_.set(i, ray), after_.set(i, Hit{.t = 0, .item = 0});
      from_[i] = uint32_t(i);
    }
    for (size_t k = 0; k < kKnown && going_.size() > 0; ++k) {
      accel.next_clear(going_, after_, next_, context);
      if (context.stopped()) return false;
      layer_[k].reset(n);
      size_t kept = 0;
      for (size_t j = 0; j < going_.size(); ++j) {
        const Hit hit = next_[j];
        if (!hit.found()) continue;
        Met& met = met_[from_[j]];
        layer_[k].set(from_[j], hit);
        met.depth = std::min(met.depth + accel.geometry().depth_of(hit.item), kMostDepth);
        met.through[met.count++] = passed(met.depth);
        if (met.through[k] == 0) continue;
        going_.set(kept, going_[j]), after_.set(kept, hit), from_[kept] = from_[j];
        ++kept;
      }
      going_.resize(kept);
    }
    return going_.size() > 0;
  }

  // Lists what is shaded, by a random place in [0, 1) and a random key of each ray.
  void choose(const Accel& accel, const float* places, const uint32_t* keys,
              TraceContext& context) {
    shaded_.clear(), unshaded_firsts_.clear();
    const size_t many = going_.size();
    for (uint32_t i = 0, next = 0, behind = 0; i < met_.size(); ++i) {
      const bool is_many = next < many && from_[next] == i;
      if (!is_many) {
        list_all(i);
        continue;
      }
      // Those that choose what is behind the known layers move together.
      if (choose_known(i, places[i])) {
        going_.set(behind, going_[next]), after_.set(behind, after_[next]);
        from_[behind++] = i;
      }
      if (++next == many) going_.resize(behind);
    }
    if (going_.size() == 0) return;
    keys_.resize(going_.size());
    for (size_t j = 0; j < keys_.size(); ++j) keys_[j] = keys[from_[j]];
    accel.next_clear(going_, after_, next_, context, keys_.data());
    for (size_t j = 0; j < keys_.size(); ++j) {
      if (!next_[j].found()) continue;
      Met& met = met_[from_[j]];
      shaded_.push_back({from_[j], met.goes_on, next_[j]});
      met.goes_on = 0;
    }
  }

  const std::vector<ShadedLayer>& shaded() const { return shaded_; }
  // The first layers that are not among them.
  const std::vector<ShadedLayer>& unshaded_firsts() const { return unshaded_firsts_; }
  bool met(size_t i) const { return met_[i].count > 0; }
  // The part of ray i's weight that what is behind the layers counts.
  float through(size_t i) const { return met_[i].goes_on; }

 private:
  static constexpr size_t kKnown = 5;      // one more than are all shaded
  static constexpr float kCounts = 0.25f;  // what is always shaded of many

  struct Met {
    uint32_t depth = 0, count = 0;
    std::array<float, kKnown> through{};  // of the light, to behind each
    float goes_on = 1;
  };

  void list_all(uint32_t i) {
    Met& met = met_[i];
    for (size_t k = 0; k < met.count; ++k) {
      shaded_.push_back({i, met.goes_on - met.through[k], layer_[k][i], k == 0});
      met.goes_on = met.through[k];
    }
  }

  // Does what is behind the known layers go on?
  bool choose_known(uint32_t i, float place) {
    Met& met = met_[i];
    float part[kKnown], rest = 1, before = 1;
    for (size_t k = 0; k < kKnown; ++k) {
      part[k] = before - met.through[k], before = met.through[k];
      if (part[k] < kCounts) continue;
      shaded_.push_back({i, part[k], layer_[k][i], k == 0});
      rest -= part[k];
    }
    if (part[0] < kCounts) unshaded_firsts_.push_back({i, 0, layer_[0][i], true});
    met.goes_on = rest;
    float left = place * rest;
    for (size_t k = 0; k < kKnown; ++k) {
      if (part[k] >= kCounts) continue;
      if (left < part[k]) {
        shaded_.push_back({i, rest, layer_[k][i]});
        met.goes_on = 0;
        return false;
      }
      left -= part[k];
    }
    return true;
  }

  RayBatch going_;  // those that meet more
  HitBatch after_, next_;
  std::vector<uint32_t> from_, keys_;
  std::vector<Met> met_;
  std::array<HitBatch, kKnown> layer_;
  std::vector<ShadedLayer> shaded_, unshaded_firsts_;
};

}  // namespace
}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
