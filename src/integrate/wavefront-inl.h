// The wavefront, shared by all integrators. It owns the tile's pixels, the rays waiting on each
// level of the ray tree, their weights in their pixels, the intersections, and the sums for the
// film. A `Shading` decides what surfaces emit and which rays follow.
//
// Rays are traced in batches, each of one level: eye rays of a tile, then the shadow rays of their
// hits, light by light; children wait for the next level until they fill a batch. A ray carries its
// weight in its pixel, so none waits for another.
//
// A Shading has
//   Shading(const PreparedScene&)
//   static constexpr bool kTints              weights may differ in red, green and blue
//   int levels()                              of the ray tree
//   Rgb background()                          the light of rays that hit nothing
//   static constexpr bool kSky                it may depend on their direction; then also
//     bool has_sky()                            whether it does
//     V3 sky(direction)                         their light
//   static constexpr bool kFloor              there may be a floor that only eye rays hit, with
//                                             visible shadows only; then also
//     bool has_floor()                          whether there is one
//     float floor_distance(ray)                 its distance; 0: none
//     void shade_floor(wavefront, n, sampler)   sets points().kd to the part of the background
//                                               that its shadows absorb for the n current rays
//   bool counts_rays()                        needs each eye ray's own steps and tests
//   void begin(wavefront, n)                  receives these, before misses are dropped
//   void shade(wavefront, level, n, sampler)  sets points().radiance of the n current rays, all of
//                                             which hit something
//   void spawn(wavefront, level, n)           adds their children
//
// A Recorder (integrate/explain.cpp has one) is notified of each ray; with Unrecorded none of that
// is compiled. Included once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_WAVEFRONT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_WAVEFRONT_INL_H_
#undef RAIO_INTEGRATE_WAVEFRONT_INL_H_
#else
#define RAIO_INTEGRATE_WAVEFRONT_INL_H_
#endif

#include <bit>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "base/executor.h"
#include "integrate/camera-inl.h"
#include "integrate/features-inl.h"
#include "integrate/layers-inl.h"
#include "integrate/sampler-inl.h"
#include "integrate/surfaces-inl.h"
#include "integrate/wavefront.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

struct Unrecorded {};

template <class Shading, class Recorder = Unrecorded>
class Wavefront final : public TileRenderer {
 public:
  using Paths = PathRays<Shading::kTints>;
  static constexpr bool kRecords = !std::is_same_v<Recorder, Unrecorded>;

  Wavefront(const PreparedScene& scene, WorkControl& control, Recorder recorder = {})
      : scene_(scene),
        control_(control),
        recorder_(std::move(recorder)),
        shading_(scene),
        features_(scene),
        counts_rays_(scene.settings.channels.has(Channel::steps) ||
                     scene.settings.channels.has(Channel::tests) || shading_.counts_rays()),
        instanced_(scene.accel.geometry().has_instances()),
        waiting_(size_t(shading_.levels()) + 1),
        points_(std::make_unique_for_overwrite<SurfacePoints>()),
        hidden_(padded(kChunk)),
        transparent_(scene.accel.geometry().any_transparent()) {
    if (transparent_) {
      first_.resize(padded(kChunk)), shares_.resize(padded(kChunk));
      coverage_.resize(padded(kChunk));
    }
    if (scene.scene.moves()) {
      moves_ = true;
      shadow_.add_time(), one_.add_time(), probes_.add_time();
    }
    context_.stop = &control.stop;
  }

  void render(size_t tile, SampleSpan samples, Film& film) override {
    list_pixels(in_picture(film.tile(tile)), std::countr_zero(film.row_stride()));
    sums_.begin(film, tile, samples.first);
    background_ = sums_.fixed(shading_.background());
    for (Paths& w : waiting_) w.rays.clear();  // left over if a render was stopped
    counts_ = {};
    context_.tests = context_.steps = 0;
    for (sample_ = samples.first; sample_ < samples.end; ++sample_) {
      const uint64_t before = counts_.total();
      sums_.begin_sample();
      if constexpr (kRecords) recorder_.begin_sample(sample_);
      add_sample(WideSampler<D>(scene_.sampler, sample_));
      if (context_.stopped() || stop_requested()) return;
      sums_.end_sample();
      control_.rays_done += counts_.total() - before;
      ++control_.work_done;
    }
    counts_.tests = context_.tests, counts_.steps = context_.steps;
    film.add(tile, samples, sums_.all(), counts_, sums_.nans());
  }

  // The input of a Shading: the current rays with their hits and the surfaces there.
  const PreparedScene& scene() const { return scene_; }
  const Paths& rays() const { return current_; }
  const HitBatch& hits() const { return hits_; }
  SurfacePoints& points() { return *points_; }
  RayCounts& counts() { return counts_; }
  Recorder& recorder() { return recorder_; }
  bool stopped() const { return context_.stopped(); }
  // For current ray i, in begin(), if rays are counted.
  uint32_t steps(size_t i) const { return ray_steps_[i]; }
  uint32_t tests(size_t i) const { return ray_tests_[i]; }

  // Adds to the pixels of the current rays i, i + 1, ... in `mask`.
  HWY_INLINE void add(const V3& radiance, size_t i, M mask) {
    sums_.add(radiance * current_.weights(i), &current_.pixel[i], mask);
  }

  // As in integrate/sampler.h.
  HWY_INLINE U place_of(U pixel) const {
    const bool far = std::max(tile_.x1, tile_.y1) > 0x10000;
    return place_in_picture(du, row_of(pixel), column_of(pixel), far);
  }

  // The batch of a Shading's own rays, one per current ray, and whether they are occluded: 0 or 1
  // each. Those with tmax <= 0 count as unoccluded. `depth`: the purpose of random numbers for
  // transparent primitives.
  RayBatch& shadow_rays() { return shadow_; }
  const uint8_t* occluded(const WideSampler<D>& sampler, uint32_t depth) {
    if (moves_) set_times(shadow_);
    scene_.accel.occluded(shadow_, hidden_.data(), context_);
    if (transparent_) find_shares(sampler, depth);
    return hidden_.data();
  }
  // Rays and hits for a Shading's other queries of opaque primitives.
  RayBatch& probe_rays() { return probes_; }
  const HitBatch& probe() {
    if (moves_) set_times(probes_);
    scene_.accel.closest(probes_, probed_, context_);
    return probed_;
  }
  HitBatch& probed() { return probed_; }

  // The transmittance of transparent primitives for unoccluded rays; null: all 1.
  const float* shares() const { return transparent_ ? shares_.data() : nullptr; }

  // Children of the current rays, for the next level; after the last level they get the background.
  class Children {
   public:
    Children(Wavefront& wavefront, int level, size_t n)
        : w_(wavefront), last_(level == w_.shading_.levels()) {
      if (last_) return;
      out_ = &w_.waiting_[size_t(level) + 1];
      size_ = out_->rays.size();
      out_->resize(size_ + n);
    }
    // Adds children of current rays i, i + 1, ... in `mask`, with `part` of their weights, a V or,
    // if rays are tinted, a V3. Returns the number of rays to be traced. `side`: 0 for the
    // reflected child, 1 for the refracted one.
    template <class Part>
    size_t add(size_t i, const V3& origin, const V3& dir, const Part& part, uint32_t side, M mask) {
      const auto weight = scaled(w_.current_.weights(i), part);
      if (last_) {
        if constexpr (kRecords)
          w_.recorder_.untraced(w_.current_, i, origin, dir, weight, side, mask,
                                w_.escaped_there());
        w_.add_escaped(weight, dir, &w_.current_.pixel[i], mask);
        return 0;
      }
      const U branch = load(w_.current_.branch, i);
      const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
      out_->put(origin, dir, inf, load(w_.current_.pixel, i),
                hn::Add(hn::Add(branch, branch), hn::Set(du, side)), weight, mask, size_);
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
    Paths* out_ = nullptr;
    size_t size_ = 0;
  };

 private:
  // The tile's pixels, numbered row by row as in the film, in blocks of 4 x 2, two of which form 4
  // x 4, four of which form 8 x 8, and so on: structures trace neighbours of the batch together.
  void list_pixels(const Tile& tile, int row_bits) {
    const Tile before = std::exchange(tile_, tile);
    const int bits_before = std::exchange(row_bits_, row_bits);
    const int width = tile.x1 - tile.x0, height = tile.y1 - tile.y0;
    if (width == before.x1 - before.x0 && height == before.y1 - before.y0 &&
        row_bits == bits_before)
      return;
    pixels_ = 0;
    for (size_t i = 0; i < kTilePixels; i += kWidth) {
      const U n = hn::Iota(du, uint32_t(i));
      const auto bits = [&](uint32_t mask, int down) {
        return hn::ShiftRightSame(hn::And(n, hn::Set(du, mask)), down);
      };
      const U x =
          hn::Or(hn::Or(bits(3, 0), bits(1 << 4, 2)), hn::Or(bits(3 << 6, 3), bits(1 << 10, 5)));
      const U y = hn::Or(hn::Or(bits(3 << 2, 2), bits(1 << 5, 3)),
                         hn::Or(bits(3 << 8, 5), bits(1 << 11, 6)));
      const auto in = hn::And(hn::Lt(x, hn::Set(du, uint32_t(width))),
                              hn::Lt(y, hn::Set(du, uint32_t(height))));
      put(hn::Add(hn::ShiftLeftSame(y, row_bits_), x), hn::RebindMask(d, in), pixel_, pixels_);
      pixels_ += hn::CountTrue(du, in);
    }
  }
  // Maps a tile of the film, which may be cropped, to the whole picture.
  Tile in_picture(const Tile& tile) const {
    const Crop frame = scene_.settings.frame();
    return {tile.x0 + frame.x0, tile.y0 + frame.y0, tile.x1 + frame.x0, tile.y1 + frame.y0};
  }
  // The tile's pixels' positions in the picture.
  HWY_INLINE U column_of(U pixel) const {
    return hn::Add(hn::And(pixel, hn::Set(du, (1u << row_bits_) - 1)),
                   hn::Set(du, uint32_t(tile_.x0)));
  }
  HWY_INLINE U row_of(U pixel) const {
    return hn::Add(hn::ShiftRightSame(pixel, row_bits_), hn::Set(du, uint32_t(tile_.y0)));
  }
  void add_sample(const WideSampler<D>& sampler) {
    if (moves_) draw_times(sampler);
    const size_t deepest = waiting_.size() - 1;
    for (size_t eye = 0;;) {
      // The deepest level that fills a batch, else eye rays, else, while children may come, the
      // first level with rays.
      size_t level = deepest;
      while (level > 0 && waiting_[level].rays.size() < kChunk) --level;
      if (level == 0) {
        level = 1;
        if (eye < pixels_)
          eye = make_eye_rays(eye, sampler);
        else
          while (level <= deepest && waiting_[level].rays.size() == 0) ++level;
        if (level > deepest) return;
      }
      trace_level(int(level), sampler);
      if (context_.stopped()) return;
    }
  }

  // Makes eye rays for a chunk of the tile's pixels from `first`; returns the end of the chunk.
  size_t make_eye_rays(size_t first, const WideSampler<D>& sampler) {
    const RenderSettings& settings = scene_.settings;
    const EyeRays& eye = scene_.eye;
    WideEye<D> wide_eye = eye_at_rest(d, eye);
    Paths& out = waiting_[1];
    const size_t end = std::min(first + kChunk, pixels_);
    out.resize(end - first);
    const M all = hn::FirstN(d, kWidth);
    const U branch = hn::Set(du, kEyeBranch);
    for (size_t i = first; i < end; i += kWidth) {
      const U pixel = hn::Load(du, pixel_ + i), place = place_of(pixel);
      const Wide2<D> within = sampler.in_pixel(place);
      const auto to_float = [](U n) { return hn::ConvertTo(d, hn::BitCast(Signed<D>(), n)); };
      const V x = hn::Add(to_float(column_of(pixel)), within.x);
      const V y = hn::Add(to_float(row_of(pixel)), within.y);
      if (eye.movement) wide_eye = eye_at(d, eye, time_of(pixel, hn::FirstN(d, end - i)));
      WideRay<D> ray = eye.parallel ? parallel(wide_eye, x, y) : pinhole(d, wide_eye, x, y);
      if (settings.dof) {
        const Wide2<D> square = sampler.in_square(place, branch, kLens);
        const Wide2<D> lens = square_to_disc(d, square.x, square.y);
        ray = thin_lens(d, wide_eye, x, y, lens, settings.aperture, settings.focus);
      }
      const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
      out.put(ray.origin, ray.dir, inf, pixel, branch, Paths::whole(), all, i - first);
    }
    counts_.eye += end - first;
    return end;
  }

  // Traces the last waiting rays of `level`: their light goes to the film, their children to the
  // next level.
  void trace_level(int level, const WideSampler<D>& sampler) {
    current_.take_last(kChunk, waiting_[size_t(level)]);
    if (moves_) set_times(current_.rays);
    context_.coherent = level <= 3;  // eye rays and their first children are mostly coherent
    if (level == 1 && counts_rays_)
      trace_one_by_one();
    else
      scene_.accel.closest(current_.rays, hits_, context_);
    if (context_.stopped()) return;
    if constexpr (kRecords) recorder_.traced(level, current_, hits_, escaped_there());
    if (level == 1 && counts_rays_) {
      add_costs();
      shading_.begin(*this, current_.rays.size());
    }
    if (transparent_) trace_transparent(level, sampler);
    if (context_.stopped()) return;
    bool seen = level > 1 || !sums_.layout().has(Channel::alpha);
    if constexpr (Shading::kFloor)
      if (level == 1 && shading_.has_floor()) {
        add_floor(seen, sampler);
        if (context_.stopped()) return;
        seen = false;
      }
    // A picture with alpha gets its background later.
    drop_misses(seen);
    if (transparent_)
      for (size_t i = 0; i < current_.rays.size(); ++i) {
        coverage_[i] = covered(current_.weight[0][i]);
        first_[i] = current_.rays.tmax[i] > 0;
      }
    shade_hits(level, sampler);
  }

  // Shades the hits of the current rays and spawns their children.
  void shade_hits(int level, const WideSampler<D>& sampler) {
    const size_t n = current_.rays.size();
    if (n == 0) return;
    if (level == 1)
      counts_.eye_hits +=
          transparent_ ? size_t(std::count(first_.begin(), first_.begin() + ptrdiff_t(n), 1)) : n;
    if (moves_) set_times(current_.rays);  // of the remaining rays
    find_surfaces(scene_.accel.geometry(), scene_.scene, current_.rays, hits_, n, *points_);
    if (level == 1 && sums_.layout().planes() > 0)
      features_.add(current_.rays, hits_, *points_, current_.pixel.data(),
                    transparent_ ? first_.data() : nullptr, sample_, sums_);
    shading_.shade(*this, level, n, sampler);
    if (context_.stopped()) return;
    if constexpr (kRecords) recorder_.shaded(current_, *points_, n, sums_);
    const int64_t coverage = level == 1 ? kFullCoverage : 0;
    for (size_t i = 0; i < n; i += kWidth) {
      const V3 light = load(points_->radiance, i) * current_.weights(i);
      const uint32_t* const pixels = &current_.pixel[i];
      if (transparent_ && level == 1)
        sums_.add(light, pixels, hn::FirstN(d, n - i), &coverage_[i]);
      else
        sums_.add(light, pixels, hn::FirstN(d, n - i), coverage);
    }
    shading_.spawn(*this, level, n);
  }

  // Gives rays that hit nothing the background, if it is `seen`, else the coverage of a floor's
  // shadow in front of it.
  void add_floor(bool seen, const WideSampler<D>& sampler) {
    const size_t n = current_.rays.size();
    std::swap(behind_, current_), std::swap(behind_hits_, hits_);
    current_.resize(n), hits_.reset(n);
    size_t missed = 0, met = 0;
    for (const bool on_floor : {true, false}) {
      for (size_t i = 0; i < n; ++i) {
        if (behind_hits_.primitive[i] != kNoPrimitive) continue;
        const float t = shading_.floor_distance(behind_.rays[i]);
        if ((t > 0) != on_floor) continue;
        hits_.t[missed] = t;
        current_.set(missed++, behind_, i);
      }
      if (on_floor) met = missed;
    }
    current_.rays.resize(missed);
    fill_up(missed);
    if (moves_) set_times(current_.rays);
    Floats& dark = points_->kd;
    std::fill_n(dark.at, missed + kWidth, 0.0f);
    if (met > 0) {
      current_.rays.resize(met);
      shading_.shade_floor(*this, met, sampler);
      if (context_.stopped()) return;
      std::fill(dark.at + met, dark.at + missed + kWidth, 0.0f);
      current_.rays.resize(missed);
    }
    std::vector<int64_t> coverage(seen ? 0 : padded(missed));
    for (size_t i = 0; i < missed; i += kWidth) {
      const uint32_t* const pixels = &current_.pixel[i];
      const M mask = hn::FirstN(d, missed - i);
      if (seen) {
        const V left = hn::Sub(hn::Set(d, 1), load(dark, i));
        add_escaped(scaled(current_.weights(i), left), directions(current_.rays, i), pixels, mask);
        continue;
      }
      for (size_t k = i; k < std::min(i + kWidth, missed); ++k)
        coverage[k] = covered(current_.weight[0][k] * dark.at[k]);
      sums_.add(set3(d, Rgb()), pixels, mask, &coverage[i]);
    }
    std::swap(behind_, current_), std::swap(behind_hits_, hits_);
  }

  // The coverage of a part of a pixel.
  static int64_t covered(float part) { return std::llround(double(part) * double(kFullCoverage)); }

  // Shades transparent layers in front of the current rays' hits and keeps the rays that pass, with
  // their transmittance as weight. tmax is 0 for rays that hit something.
  void trace_transparent(int level, const WideSampler<D>& sampler) {
    const size_t n = current_.rays.size();
    const bool many = layers_.find(scene_.accel, current_.rays, hits_, context_);
    if (context_.stopped()) return;
    if (many) {
      layer_places_.resize(padded(n)), layer_keys_.resize(padded(n));
      for (size_t i = 0; i < n; i += kWidth) {
        const U place = place_of(load(current_.pixel, i)), branch = load(current_.branch, i);
        hn::StoreU(sampler.in_unit(place, branch, kLayer), d, &layer_places_[i]);
        hn::StoreU(sampler.key(place, branch, kLayerKey), du, &layer_keys_[i]);
      }
    }
    layers_.choose(scene_.accel, layer_places_.data(), layer_keys_.data(), context_);
    if (context_.stopped()) return;
    std::swap(behind_, current_), std::swap(behind_hits_, hits_);
    const auto& list = layers_.shaded();
    if (level == 1 && !list.empty()) add_coverage(n);
    if (level == 1 && many) add_first_features();
    for (size_t begin = 0; begin < list.size(); begin += kChunk) {
      const size_t count = std::min(list.size() - begin, kChunk);
      take_layers(std::span(list).subspan(begin, count));
      for (size_t k = 0; k < count; ++k) first_[k] = list[begin + k].first;
      shade_hits(level, sampler);
      if (context_.stopped()) return;
    }
    size_t kept = 0;
    current_.resize(n), hits_.reset(n);
    for (size_t i = 0; i < n; ++i) {
      const float part = layers_.through(i);
      if (part == 0) continue;
      current_.set(kept, behind_, i, part), hits_.set(kept, behind_hits_[i]);
      if (layers_.met(i)) current_.rays.tmax[kept] = 0;
      ++kept;
    }
    current_.rays.resize(kept);
    fill_up(kept);
  }
  // Makes those of behind_ that hit the layers the current rays.
  void take_layers(std::span<const ShadedLayer> layers) {
    const size_t n = layers.size();
    current_.resize(n), hits_.reset(n);
    for (size_t k = 0; k < n; ++k) {
      current_.set(k, behind_, layers[k].ray, layers[k].part), hits_.set(k, layers[k].hit);
      coverage_[k] = 0;
    }
    current_.rays.resize(n);
    fill_up(n);
  }
  // Adds the coverage of each pixel by its eye rays' transparent layers.
  void add_coverage(size_t n) {
    for (size_t i = 0; i < n; ++i) coverage_[i] = kFullCoverage - covered(layers_.through(i));
    for (size_t i = 0; i < n; i += kWidth)
      sums_.add(set3(d, Rgb()), &behind_.pixel[i], hn::FirstN(d, n - i), &coverage_[i]);
  }
  // For eye rays with a first layer that is not shaded.
  void add_first_features() {
    const auto& list = layers_.unshaded_firsts();
    if (list.empty()) return;
    counts_.eye_hits += list.size();
    if (sums_.layout().planes() == 0) return;
    take_layers(list);
    if (moves_) set_times(current_.rays);
    find_surfaces(scene_.accel.geometry(), scene_.scene, current_.rays, hits_, list.size(),
                  *points_);
    features_.add(current_.rays, hits_, *points_, current_.pixel.data(), nullptr, sample_, sums_);
  }

  // Finds the transmittance of transparent primitives on each shadow ray. The densest primitive and
  // a depth of kExactDepth count exactly; whether the ray passes the rest is random, with the
  // transmittance as the probability.
  void find_shares(const WideSampler<D>& sampler, uint32_t depth) {
    static constexpr uint32_t kExactDepth = kHalving / 2;
    const size_t n = shadow_.size();
    depths_.reset(n, hidden_.data());
    for (size_t i = 0; i < n; i += kWidth) {
      const V u =
          sampler.in_unit(place_of(load(current_.pixel, i)), load(current_.branch, i), depth);
      const V halvings = hn::Neg(log2_of(d, hn::Sub(hn::Set(d, 1), u)));
      const auto limit = hn::ConvertTo(Signed<D>(), hn::Mul(halvings, hn::Set(d, kHalving)));
      hn::StoreU(hn::Add(hn::BitCast(du, limit), hn::Set(du, kExactDepth)), du, &depths_.limit[i]);
    }
    scene_.accel.transparent_depths(shadow_, depths_, context_);
    for (size_t i = 0; i < n; ++i) {
      const uint32_t sum = depths_.sum[i], largest = depths_.largest[i];
      shares_[i] =
          depths_.is_stopped(i) ? 0 : passed(largest + std::min(sum - largest, kExactDepth));
    }
  }

  // Sets the times of rays that correspond one by one to the current ones: the times of their
  // pixels' samples.
  void set_times(RayBatch& rays) {
    if (!rays.has_time()) rays.add_time();
    for (size_t i = 0; i < rays.size(); i += kWidth)
      hn::StoreU(time_of(load(current_.pixel, i), hn::FirstN(d, rays.size() - i)), d,
                 &rays.time[i]);
  }
  // Lanes outside `mask` may have invalid pixel numbers.
  HWY_INLINE V time_of(U pixel, M mask) const {
    const U known = hn::IfThenElseZero(hn::RebindMask(du, mask), pixel);
    return hn::GatherIndex(d, times_.data(), hn::BitCast(Signed<D>(), known));
  }
  // For all pixels of the tile.
  void draw_times(const WideSampler<D>& sampler) {
    const RenderSettings& s = scene_.settings;
    const V length = hn::Set(d, s.shutter_close - s.shutter_open);
    const U branch = hn::Set(du, kEyeBranch);
    times_.resize(size_t(tile_.y1 - tile_.y0) << row_bits_);
    for (size_t i = 0; i < pixels_; i += kWidth) {
      const U pixel = hn::Load(du, pixel_ + i);
      const V part = sampler.in_unit(place_of(pixel), branch, kTime);
      const V time = hn::Add(hn::Set(d, s.shutter_open), hn::Mul(length, part));
      alignas(64) uint32_t number[kWidth];
      alignas(64) float at[kWidth];
      hn::Store(pixel, du, number), hn::Store(time, d, at);
      for (size_t k = 0; k < std::min(kWidth, pixels_ - i); ++k) times_[number[k]] = at[k];
    }
  }

  // Traces rays one by one, so that each ray's cost is known.
  void trace_one_by_one() {
    const size_t n = current_.rays.size();
    hits_.reset(n);
    ray_steps_.resize(n), ray_tests_.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const uint64_t steps = context_.steps, tests = context_.tests;
      one_.clear();
      one_.push(current_.rays[i]);
      scene_.accel.closest(one_, one_hit_, context_);
      hits_.set(i, one_hit_[0]);
      ray_steps_[i] = uint32_t(context_.steps - steps);
      ray_tests_[i] = uint32_t(context_.tests - tests);
    }
  }
  void add_costs() {
    const auto add = [&](Channel channel, const std::vector<uint32_t>& counts) {
      if (!sums_.layout().has(channel)) return;
      for (size_t i = 0; i < counts.size(); ++i)
        sums_.add_mean(channel, counts[i], current_.pixel[i]);
    };
    add(Channel::steps, ray_steps_);
    add(Channel::tests, ray_tests_);
  }

  // Gives the background, if it is `seen`, to rays that hit nothing and compacts the others. Lanes
  // after the last repeat it, so that they hold valid values.
  void drop_misses(bool seen) {
    RayBatch& rays = current_.rays;
    const size_t n = rays.size();
    size_t kept = 0;
    for (size_t i = 0; i < n; i += kWidth) {
      // Sums prefetched much earlier would have left the cache.
      const size_t soon = i + 64;  // measured
      for (size_t k = soon; k < std::min(soon + kWidth, n); k += 4)
        sums_.prefetch(current_.pixel[k]);
      const U primitive = load(hits_.primitive, i);
      const M in = hn::FirstN(d, n - i);
      const M found = hn::And(in, hn::RebindMask(d, hn::Ne(primitive, hn::Set(du, kNoPrimitive))));
      const size_t count = hn::CountTrue(d, found);
      if (seen)
        add_escaped(current_.weights(i), directions(rays, i), &current_.pixel[i],
                    hn::AndNot(found, in));
      if (count > 0 && (kept < i || count < kWidth)) {
        put(load(hits_.t, i), found, hits_.t, kept), put(primitive, found, hits_.primitive, kept);
        put(load(hits_.u, i), found, hits_.u, kept), put(load(hits_.v, i), found, hits_.v, kept);
        if (instanced_) put(load(hits_.instance, i), found, hits_.instance, kept);
        current_.put(origins(rays, i), directions(rays, i), load(rays.tmax, i),
                     load(current_.pixel, i), load(current_.branch, i), current_.weights(i), found,
                     kept);
      }
      kept += count;
    }
    rays.resize(kept);
    fill_up(kept);
  }
  void fill_up(size_t kept) {
    for (size_t i = kept; kept > 0 && i % kWidth != 0; ++i)
      current_.set(i, current_, kept - 1), hits_.set(i, hits_[kept - 1]);
  }

  // For a Recorder: the light of a ray of some direction and weight that hits nothing.
  auto escaped_there() const {
    return [this](Vec3f dir, Rgb weight) HWY_ATTR {
      Rgb background = shading_.background();
      if constexpr (Shading::kSky)
        if (shading_.has_sky()) {
          const V3 sky = shading_.sky(set3(d, dir));
          background = {hn::GetLane(sky.x), hn::GetLane(sky.y), hn::GetLane(sky.z)};
        }
      return std::pair(background, sums_.fixed(background * weight));
    };
  }

  // Adds the light of rays that hit nothing.
  HWY_INLINE void add_escaped(const typename Paths::Weight& weight, const V3& dir,
                              const uint32_t* pixels, M mask) {
    if constexpr (Shading::kSky)
      if (shading_.has_sky()) return add_sky(weight, dir, pixels, mask);
    add_background(weight, pixels, mask);
  }

  void add_sky(const typename Paths::Weight& weight, const V3& dir, const uint32_t* pixels,
               M mask) {
    if (!hn::AllFalse(d, mask)) sums_.add(shading_.sky(dir) * weight, pixels, mask);
  }

  void add_background(const typename Paths::Weight& weight, const uint32_t* pixels, M mask) {
    const Rgb background = shading_.background();
    if (background == Rgb() || hn::AllFalse(d, mask)) return;
    if (hn::AllTrue(d, hn::Or(hn::Not(mask), is_whole(weight))))
      sums_.add(background_, pixels, mask);
    else
      sums_.add(set3(d, background) * weight, pixels, mask);
  }

  const PreparedScene& scene_;
  WorkControl& control_;
  [[no_unique_address]] Recorder recorder_;
  Shading shading_;
  Features features_;
  const bool counts_rays_;
  const bool instanced_;  // the scene has instances
  TraceContext context_;
  bool moves_ = false;        // something in the scene moves
  std::vector<float> times_;  // per pixel of the tile, for the sample
  TileSums sums_;
  uint32_t sample_ = 0;
  PixelSums background_{};  // for weight 1
  Tile tile_{};             // the tile of the following:
  int row_bits_ = 0;        // bits of a pixel's number within a row
  RayCounts counts_;
  size_t pixels_ = 0;
  alignas(64) uint32_t pixel_[kTilePixels + 16]{};  // their numbers
  std::vector<Paths> waiting_;                      // by level
  Paths current_;                                   // being traced, with their hits
  HitBatch hits_;
  std::unique_ptr<SurfacePoints> points_;
  RayBatch shadow_, probes_;
  HitBatch probed_;
  std::vector<uint8_t> hidden_;
  // With transparent primitives: shadow rays' optical depths and transmittances; layers along rays,
  // and the rays continuing behind them.
  bool transparent_ = false;
  DepthBatch depths_;
  std::vector<float> shares_;
  std::vector<int64_t> coverage_;  // of the current rays
  std::vector<uint8_t> first_;     // likewise: whether they have hit nothing before
  Layers layers_;
  std::vector<float> layer_places_;
  std::vector<uint32_t> layer_keys_;
  Paths behind_;
  HitBatch behind_hits_;
  RayBatch one_;
  HitBatch one_hit_;
  std::vector<uint32_t> ray_steps_, ray_tests_;  // of each current ray, if counted
};

}  // namespace
}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
