// The wavefront, shared by all integrators. It owns the tile's pixels, the rays waiting on each
// level of the ray tree, their weights in their pixels, the intersections, and the sums for the
// film. A Shading decides what surfaces emit and which rays follow; it is called once per batch.
//
// Rays are traced in batches, each of one level: eye rays of a tile, then the shadow rays of their
// hits, light by light; children wait for the next level until they fill a batch. A ray carries its
// weight in its pixel, so none waits for another.
//
// wavefront.cpp has the code. Included once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_WAVEFRONT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_WAVEFRONT_INL_H_
#undef RAIO_INTEGRATE_WAVEFRONT_INL_H_
#else
#define RAIO_INTEGRATE_WAVEFRONT_INL_H_
#endif

#include <memory>
#include <utility>
#include <vector>

#include "base/executor.h"
#include "integrate/costs-inl.h"
#include "integrate/path_scene.h"
#include "integrate/pixels-inl.h"
#include "integrate/prepared_scene.h"
#include "integrate/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

class Cutouts;
class Features;
class Transparency;
class Wavefront;
struct Lobes;

// The integrator's part of the wavefront. Each thread has its own, so it may have buffers.
class Shading {
 public:
  virtual ~Shading() = default;

  // Of the ray tree.
  virtual int levels() const { return 1; }
  // Whether rays' weights may differ in red, green and blue.
  virtual bool tints() const { return false; }
  // Whether the integrator's bound limits every sample; else those beyond are clamped.
  virtual bool is_bounded() const { return true; }
  // Whether rays carry the density of their direction.
  virtual bool weighs() const { return false; }
  // Whether begin() needs the costs of eye rays.
  virtual bool counts_rays() const { return false; }
  // The light of rays that hit nothing; sky() if it depends on their direction.
  virtual Rgb background() const = 0;
  virtual bool has_sky() const { return false; }
  virtual V3 sky(const V3&) const { return set3(d, Rgb()); }

  // Receives the current rays' costs, before misses are dropped.
  virtual void begin(Wavefront&, size_t) {}
  // Adds the light of the current rays that hit nothing and returns true, or returns false to leave
  // them to the background. `transparent`: these are eye rays of a picture with alpha, so they add
  // only coverage.
  virtual bool shade_misses(Wavefront&, int /*level*/, bool /*transparent*/,
                            const WideSampler<D>&) {
    return false;
  }
  // Sets points().radiance of the n current rays, all of which hit something.
  virtual void shade(Wavefront&, int level, size_t n, const WideSampler<D>&) = 0;
  // Adds their children.
  virtual void spawn(Wavefront&, int /*level*/, size_t) {}
};

// Receives the wavefront's current rays at each step (integrate/explain.cpp has one).
class Recorder {
 public:
  virtual ~Recorder() = default;

  virtual void begin_sample(uint32_t sample) = 0;
  // All current rays and their hits are known.
  virtual void traced(const Wavefront&, int level) = 0;
  // Children of current rays i, i + 1, ... in `mask` beyond the last level; `side`: as in Children.
  virtual void untraced(const Wavefront&, size_t i, const V3& origin, const V3& dir,
                        const V3& weight, uint32_t side, M mask) = 0;
  // points().radiance of the n current rays is the ambient light.
  virtual void ambient(const Wavefront&, size_t n) = 0;
  // The wavefront's shadow rays towards a light.
  virtual void shadow_rays(const Wavefront&, const uint8_t* occluded, size_t light, size_t n) = 0;
  // The light's contribution to current rays i, i + 1, ...
  virtual void lit(size_t i, size_t n, const V3& diffuse, const V3& both) = 0;
  // Of `path`, at current rays i, i + 1, ...: what the surface emits, the light that it samples,
  // how the path goes on. Densities are per solid angle; weights of emission and light are those of
  // multiple importance sampling.
  struct Bounce {
    V3 normal;  // of shading
    const Lobes& lobes;
    V3 transmittance;  // of the medium before the surface
    V3 emission;
    V emission_density;  // with which the sampling of lights finds it
    V emission_weight;
    V3 light;  // radiance, divided by its density
    V light_density;
    V3 light_bsdf;  // times the cosine
    V light_bsdf_density, light_weight;
    V3 direct;  // the radiance due to an unoccluded light
    V density;  // of the next direction
    V3 weight;  // of the next ray, before roulette
    V chance;   // that it goes on
  };
  virtual void bounced(const Wavefront&, size_t i, size_t n, const PathLights::Choice* lights,
                       const Bounce&) = 0;
  // Rays of paths that leave the scene, and the light from there.
  virtual void escaped(const Wavefront&, size_t i, M mask, const V3& light, V light_density,
                       V weight) = 0;
  // points() of the n current rays are final.
  virtual void shaded(const Wavefront&, size_t n) = 0;
};

class Wavefront final : public TileRenderer {
 public:
  Wavefront(const PreparedScene& scene, WorkControl& control, std::unique_ptr<Shading> shading,
            Recorder* recorder = nullptr);
  ~Wavefront() override;

  void render(size_t tile, SampleSpan samples, Film& film) override;

  // The input of a Shading: the current rays with their hits and the surfaces there.
  const PreparedScene& scene() const { return scene_; }
  const PathRays& rays() const { return current_; }
  const HitBatch& hits() const { return hits_; }
  SurfacePoints& points() { return *points_; }
  const SurfacePoints& points() const { return *points_; }
  RayCounts& counts() { return counts_; }
  Recorder* recorder() const { return recorder_; }  // null: none
  const RayCosts& costs() const { return costs_; }
  bool stopped() const { return context_.stopped(); }

  // Adds to the pixels of the current rays i, i + 1, ... in `mask`.
  HWY_INLINE void add(const V3& radiance, size_t i, M mask) {
    sums_.add(radiance * current_.weights(i), &current_.pixel[i], mask);
  }
  HWY_INLINE U place_of(U pixel) const { return pixels_.place_of(pixel); }

  // The batch of a Shading's own rays, one per current ray, and whether they are occluded: 0 or 1
  // each. Those with tmax <= 0 count as unoccluded. `depth`: the purpose of random numbers for
  // transparent primitives.
  RayBatch& shadow_rays() { return shadow_; }
  const RayBatch& shadow_rays() const { return shadow_; }
  const uint8_t* occluded(const WideSampler<D>& sampler, uint32_t depth);
  // The transmittance of cutouts and transparent primitives for unoccluded rays; null: all 1.
  const float* shares() const;
  // Rays and hits for a Shading's other queries of opaque primitives, and of cutouts by half.
  RayBatch& probe_rays() { return probes_; }
  const HitBatch& probe();
  HitBatch& probed() { return probed_; }

  // Children of the current rays, for the next level; after the last level they get the background.
  class Children {
   public:
    Children(Wavefront& wavefront, int level, size_t n)
        : w_(wavefront), last_(level == w_.levels_) {
      if (last_) return;
      out_ = &w_.waiting_[size_t(level) + 1];
      size_ = out_->rays.size();
      out_->resize(size_ + n);
    }
    // Adds children of current rays i, i + 1, ... in `mask`, with `part` of their weights, a V or,
    // if rays are tinted, a V3. Returns the number of rays to be traced. `side`: 0 for the
    // reflected child, 1 for the refracted one. `density`: as in PathRays.
    template <class Part>
    HWY_INLINE size_t add(size_t i, const V3& origin, const V3& dir, const Part& part,
                          uint32_t side, M mask, V density = hn::Zero(d)) {
      const V3 weight = w_.current_.weights(i) * part;
      if (last_) {
        w_.add_untraced(i, origin, dir, weight, side, mask);
        return 0;
      }
      const U branch = load(w_.current_.branch, i);
      const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
      out_->put(origin, dir, inf, load(w_.current_.pixel, i),
                hn::Add(hn::Add(branch, branch), hn::Set(du, side)), weight, mask, size_, density);
      const size_t count = hn::CountTrue(d, mask);
      size_ += count;
      return count;
    }
    void done() {
      if (!last_) out_->rays.resize(size_);
    }

   private:
    Wavefront& w_;
    bool last_;
    PathRays* out_ = nullptr;
    size_t size_ = 0;
  };

  // For passes, which replace the current rays for a time.
  PathRays& rays() { return current_; }
  HitBatch& hits() { return hits_; }
  TileSums& sums() { return sums_; }
  const TileSums& sums() const { return sums_; }
  TraceContext& context() { return context_; }
  // Rounds n current rays up to whole registers of valid values.
  void fill_up(size_t n);
  // Sets the times of rays that belong one by one to the current ones.
  void set_times(RayBatch& rays) const {
    if (moves_) times_.set(rays, current_.pixel);
  }
  // Shades the n current rays, which all hit something, and spawns their children.
  void shade_hits(int level, const WideSampler<D>& sampler);
  // Adds only the channels of their surfaces.
  void add_features();
  // Adds the light of rays that hit nothing.
  HWY_INLINE void add_escaped(const V3& weight, const V3& dir, const uint32_t* pixels, M mask) {
    if (has_sky_)
      add_sky(weight, dir, pixels, mask);
    else
      add_background(weight, pixels, mask);
    if (sums_.layout().has(Channel::surroundings))
      sums_.add_mean(Channel::surroundings,
                     (has_sky_ ? shading_->sky(dir) : set3(d, background_)) * weight, pixels, mask);
  }
  // The light of one such ray, and its contribution to the pixel.
  std::pair<Rgb, PixelSums> escaped_light(Vec3f dir, Rgb weight) const;

 private:
  void add_sample(const WideSampler<D>& sampler);
  size_t make_eye_rays(size_t first, const WideSampler<D>& sampler);
  void trace_level(int level, const WideSampler<D>& sampler);
  void drop_misses(bool seen);
  void add_untraced(size_t i, const V3& origin, const V3& dir, const V3& weight, uint32_t side,
                    M mask);
  HWY_NOINLINE void add_sky(const V3& weight, const V3& dir, const uint32_t* pixels, M mask);
  void add_background(const V3& weight, const uint32_t* pixels, M mask) {
    if (background_ == Rgb() || hn::AllFalse(d, mask)) return;
    if (hn::AllTrue(d, hn::Or(hn::Not(mask), is_whole(weight))))
      sums_.add(whole_background_, pixels, mask);
    else
      sums_.add(set3(d, background_) * weight, pixels, mask);
  }

  const PreparedScene& scene_;
  WorkControl& control_;
  std::unique_ptr<Shading> shading_;
  Recorder* recorder_;
  const int levels_;
  const bool counts_rays_;
  const bool instanced_;  // the scene has instances
  const bool moves_;      // something in the scene moves
  const bool has_sky_;
  const Rgb background_;
  PixelSums whole_background_{};  // for weight 1
  std::unique_ptr<const Features> features_;
  std::unique_ptr<Cutouts> cutouts_;            // null: there are none
  std::unique_ptr<Transparency> transparency_;  // null: all primitives are opaque
  TraceContext context_;
  TilePixels pixels_;
  SampleTimes times_;
  TileSums sums_;
  uint32_t sample_ = 0;
  RayCounts counts_;
  std::vector<PathRays> waiting_;  // by level
  PathRays current_;               // being traced, with their hits
  HitBatch hits_;
  std::unique_ptr<SurfacePoints> points_;
  RayCosts costs_;
  RayBatch shadow_, probes_;
  HitBatch probed_;
  std::vector<uint8_t> hidden_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
