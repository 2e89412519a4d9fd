// Lets rays pass surfaces where the alpha of a texture does: none or all by a mask, else at random;
// shadow rays with their transmittance. Included once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_CUTOUTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_CUTOUTS_INL_H_
#undef RAIO_INTEGRATE_CUTOUTS_INL_H_
#else
#define RAIO_INTEGRATE_CUTOUTS_INL_H_
#endif

#include <algorithm>
#include <vector>

#include "integrate/colors-inl.h"
#include "integrate/sampler-inl.h"
#include "integrate/wavefront-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Of a triangle of `geometry` at barycentric weights b1 and b2; 1 if it has no cutouts.
inline float triangle_opacity_at(const Scene& scene, const Geometry& geometry, uint32_t triangle,
                                 float b1, float b2) {
  const MaterialId material = geometry.facet(triangle).material;
  if (!scene.has_cutouts(material)) return 1;
  return geometry.triangle_opacity(triangle) *
         cutout_alpha(scene, material, texture_coordinates(geometry, triangle, b1, b2));
}

class Cutouts {
 public:
  explicit Cutouts(Wavefront& wavefront) : w_(wavefront) {}

  // Replaces hits of the current rays by the next ones that stop them.
  void trace(const WideSampler<D>& sampler) {
    const PathRays& rays = w_.rays();
    const size_t n = rays.rays.size();
    numbers_.resize(padded(n));
    for (size_t i = 0; i < n; i += kWidth)
      hn::StoreU(sampler.in_unit(w_.place_of(load(rays.pixel, i)), load(rays.branch, i), kAlpha), d,
                 &numbers_[i]);
    go_on(rays.rays, w_.hits(), [&](size_t i, float opacity) {
      float& u = numbers_[i];
      if (u < opacity) return false;
      u = (u - opacity) / (1 - opacity);  // again even, for the next surface
      return true;
    });
  }

  // The same for rays that need no exact shares.
  void trace_nearest(const RayBatch& rays, HitBatch& hits) {
    go_on(rays, hits, [](size_t, float opacity) { return opacity < 0.5f; });
  }

  // Finds which `hidden` rays are not, and the transmittance of all.
  void find_shares(const RayBatch& rays, uint8_t* hidden) {
    const size_t n = rays.size();
    shares_.assign(padded(n), 1);
    hidden_.clear();
    for (size_t i = 0; i < n; ++i)
      if (hidden[i]) hidden_.push_back(uint32_t(i));
    if (hidden_.empty()) return;
    if (rays.has_time() && !shadow_.has_time()) shadow_.add_time();
    shadow_.resize(hidden_.size());
    for (size_t k = 0; k < hidden_.size(); ++k) shadow_.set(k, rays[hidden_[k]]);
    w_.scene().accel.closest(shadow_, stops_, w_.context());
    if (w_.stopped()) return;
    go_on(shadow_, stops_,
          [&](size_t k, float opacity) { return (shares_[hidden_[k]] *= 1 - opacity) > 0; });
    for (size_t k = 0; k < hidden_.size(); ++k) hidden[hidden_[k]] = stops_[k].found();
  }
  float* shares() { return shares_.data(); }

 private:
  // While passes(number of the ray, opacity), a ray goes on behind its hit.
  template <class Passes>
  void go_on(const RayBatch& rays, HitBatch& hits, const Passes& passes) {
    going_.clear();
    for (size_t i = 0; i < rays.size(); ++i) {
      const float opacity = opacity_at(hits[i]);
      if (opacity < 1 && passes(i, opacity)) going_.push_back({uint32_t(i)});
    }
    if (rays.has_time() && !again_.has_time()) again_.add_time();
    while (!going_.empty()) {
      again_.resize(going_.size());
      for (size_t k = 0; k < going_.size(); ++k) {
        Going& g = going_[k];
        Ray ray = rays[g.ray];
        const Vec3f point = ray.origin + ray.dir * hits.t[g.ray];
        const float scale =
            std::max({max_component(abs(point)), max_component(abs(ray.origin)), hits.t[g.ray]});
        g.start = hits.t[g.ray] + offset_length(scale) * g.steps;
        ray.origin = ray.origin + ray.dir * g.start, ray.tmax -= g.start;
        again_.set(k, ray);
      }
      w_.scene().accel.closest(again_, found_, w_.context());
      if (w_.stopped()) return;
      std::erase_if(going_, [&, k = size_t(0)](Going& g) mutable {
        const Hit before = hits[g.ray];
        Hit hit = found_[k++];
        hit.t = hit.found() ? g.start + hit.t : rays.tmax[g.ray];
        hits.set(g.ray, hit);
        // Grazing rays can hit the surface that they start from.
        const bool same = hit.primitive == before.primitive && hit.instance == before.instance;
        g.steps = same ? 2 * g.steps : 1;
        if (!hit.found() || same) return !hit.found();
        const float opacity = opacity_at(hit);
        return opacity == 1 || !passes(g.ray, opacity);
      });
    }
  }

  float opacity_at(const Hit& hit) const {
    if (!hit.found()) return 1;
    const PreparedScene& prepared = w_.scene();
    const Geometry& geometry = prepared.accel.geometry().object_at(hit.instance);
    if (geometry.kind_of(hit.primitive) != PrimitiveKind::triangle) return 1;
    return triangle_opacity_at(prepared.scene, geometry, geometry.index_of(hit.primitive), hit.u,
                               hit.v);
  }

  struct Going {
    uint32_t ray;
    float steps = 1;  // off the surface
    float start = 0;
  };

  Wavefront& w_;
  std::vector<float> numbers_, shares_;
  std::vector<uint32_t> hidden_;  // rays of find_shares()
  RayBatch shadow_;
  HitBatch stops_;
  std::vector<Going> going_;
  RayBatch again_;
  HitBatch found_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
