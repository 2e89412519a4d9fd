#include "integrate/prepared_scene.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/wavefront.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <algorithm>
#include <bit>
#include <limits>

#include "integrate/camera-inl.h"
#include "integrate/cutouts-inl.h"
#include "integrate/features-inl.h"
#include "integrate/pixel_filter.h"
#include "integrate/shadings-inl.h"
#include "integrate/transparency-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// Maps a tile of the film, which may be cropped, to the whole picture.
Tile in_picture(const Tile& tile, const Crop& frame) {
  return {tile.x0 + frame.x0, tile.y0 + frame.y0, tile.x1 + frame.x0, tile.y1 + frame.y0};
}

// The place along an axis of a pixel with this part of the filter before it.
V filtered(const float* places, V part) {
  const V along = hn::Mul(part, hn::Set(d, float(kFilterSteps))), whole = hn::Floor(along);
  const auto first = hn::ConvertTo(Signed<D>(), whole);
  const V low = hn::GatherIndex(d, places, first), high = hn::GatherIndex(d, places + 1, first);
  return hn::Add(low, hn::Mul(hn::Sub(high, low), hn::Sub(along, whole)));
}

}  // namespace

Wavefront::Wavefront(const PreparedScene& scene, WorkControl& control,
                     std::unique_ptr<Shading> shading, Recorder* recorder)
    : scene_(scene),
      control_(control),
      shading_(std::move(shading)),
      recorder_(recorder),
      levels_(shading_->levels()),
      counts_rays_(scene.settings.channels.has(Channel::steps) ||
                   scene.settings.channels.has(Channel::tests) || shading_->counts_rays()),
      instanced_(scene.accel.geometry().has_instances()),
      moves_(scene.scene.moves()),
      has_sky_(shading_->has_sky()),
      background_(shading_->background()),
      features_(std::make_unique<Features>(scene)),
      waiting_(size_t(levels_) + 1),
      points_(std::make_unique_for_overwrite<SurfacePoints>()),
      hidden_(padded(kChunk)) {
  if (scene.scene.has_cutouts()) cutouts_ = std::make_unique<Cutouts>(*this);
  if (scene.accel.geometry().any_transparent())
    transparency_ = std::make_unique<Transparency>(*this);
  current_.tinted = shading_->tints(), current_.weighs = shading_->weighs();
  for (PathRays& rays : waiting_) rays.use_columns_of(current_);
  context_.stop = &control.stop;
}

Wavefront::~Wavefront() = default;

void Wavefront::render(size_t tile, SampleSpan samples, Film& film) {
  pixels_.list(in_picture(film.tile(tile), scene_.settings.frame()),
               std::countr_zero(film.row_stride()));
  sums_.begin(film, tile, samples.first, shading_->is_bounded());
  whole_background_ = sums_.fixed(background_);
  for (PathRays& w : waiting_) w.rays.clear();  // left over if a render was stopped
  counts_ = {};
  context_.tests = context_.steps = 0;
  for (sample_ = samples.first; sample_ < samples.end; ++sample_) {
    const uint64_t before = counts_.total();
    sums_.begin_sample();
    if (recorder_) recorder_->begin_sample(sample_);
    add_sample(WideSampler<D>(scene_.sampler, sample_));
    if (context_.stopped() || stop_requested()) return;
    sums_.end_sample();
    control_.rays_done += counts_.total() - before;
    ++control_.work_done;
  }
  counts_.tests = context_.tests, counts_.steps = context_.steps;
  film.add(tile, samples, sums_.all(), counts_, sums_.faults());
}

void Wavefront::add_sample(const WideSampler<D>& sampler) {
  if (moves_) times_.draw(pixels_, scene_.settings, sampler);
  const size_t deepest = waiting_.size() - 1;
  for (size_t eye = 0;;) {
    // The deepest level that fills a batch, else eye rays, else, while children may come, the
    // first level with rays.
    size_t level = deepest;
    while (level > 0 && waiting_[level].rays.size() < kChunk) --level;
    if (level == 0) {
      level = 1;
      if (eye < pixels_.count())
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
size_t Wavefront::make_eye_rays(size_t first, const WideSampler<D>& sampler) {
  const RenderSettings& settings = scene_.settings;
  const EyeRays& eye = scene_.eye;
  WideEye<D> wide_eye = eye_at_rest(d, eye);
  PathRays& out = waiting_[1];
  const size_t end = std::min(first + kChunk, pixels_.count());
  out.resize(end - first);
  const M all = hn::FirstN(d, kWidth);
  const U branch = hn::Set(du, kEyeBranch);
  for (size_t i = first; i < end; i += kWidth) {
    const U pixel = pixels_.numbers(i), place = place_of(pixel);
    Wide2<D> within = sampler.in_pixel(place);
    if (const float* const places = scene_.filter_places)
      within = {filtered(places, within.x), filtered(places, within.y)};
    const auto to_float = [](U n)
                              HWY_ATTR { return hn::ConvertTo(d, hn::BitCast(Signed<D>(), n)); };
    const V x = hn::Add(to_float(pixels_.column_of(pixel)), within.x);
    const V y = hn::Add(to_float(pixels_.row_of(pixel)), within.y);
    if (eye.movement) wide_eye = eye_at(d, eye, times_.of(pixel, hn::FirstN(d, end - i)));
    WideRay<D> ray = eye.parallel          ? parallel(wide_eye, x, y)
                     : eye.omnidirectional ? omnidirectional(d, eye, wide_eye, x, y)
                                           : pinhole(d, wide_eye, x, y);
    if (settings.dof) {
      const Wide2<D> square = sampler.in_square(place, branch, kLens);
      const Wide2<D> lens = square_to_disc(d, square.x, square.y);
      ray = thin_lens(d, wide_eye, x, y, lens, settings.aperture, settings.focus);
    }
    const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
    out.put(ray.origin, ray.dir, inf, pixel, branch, set3(d, Rgb(1)), all, i - first);
  }
  counts_.eye += end - first;
  return end;
}

// Traces the last waiting rays of `level`: adds their light to the film and their children to the
// next level.
void Wavefront::trace_level(int level, const WideSampler<D>& sampler) {
  current_.take_last(kChunk, waiting_[size_t(level)]);
  set_times(current_.rays);
  context_.coherent = level <= 3;  // eye rays and their first children are mostly coherent
  const bool counts = level == 1 && counts_rays_;
  if (counts)
    costs_.trace(scene_.accel, current_.rays, hits_, context_);
  else
    scene_.accel.closest(current_.rays, hits_, context_);
  if (context_.stopped()) return;
  if (cutouts_) cutouts_->trace(sampler);
  if (context_.stopped()) return;
  if (recorder_) recorder_->traced(*this, level);
  if (counts) {
    costs_.add(sums_, current_.pixel);
    shading_->begin(*this, current_.rays.size());
  }
  if (transparency_) transparency_->trace(level, sampler);
  if (context_.stopped()) return;
  // A picture with alpha gets its background later.
  const bool transparent = level == 1 && sums_.layout().has(Channel::alpha);
  const bool done = shading_->shade_misses(*this, level, transparent, sampler);
  if (context_.stopped()) return;
  drop_misses(!transparent && !done);
  if (transparency_) transparency_->begin_opaque();
  shade_hits(level, sampler);
}

void Wavefront::shade_hits(int level, const WideSampler<D>& sampler) {
  const size_t n = current_.rays.size();
  if (n == 0) return;
  const uint8_t* const first = transparency_ ? transparency_->first() : nullptr;
  if (level == 1) counts_.eye_hits += first ? size_t(std::count(first, first + n, 1)) : n;
  set_times(current_.rays);  // of the remaining rays
  find_surfaces(scene_.accel.geometry(), scene_.scene, current_.rays, hits_, n, *points_);
  if (level == 1 && sums_.layout().planes() > 0)
    features_->add(current_.rays, hits_, *points_, current_.pixel.data(), first, sample_, sums_);
  shading_->shade(*this, level, n, sampler);
  if (context_.stopped()) return;
  if (recorder_) recorder_->shaded(*this, n);
  const int64_t coverage = level == 1 ? kFullCoverage : 0;
  for (size_t i = 0; i < n; i += kWidth) {
    const V3 light = load(points_->radiance, i) * current_.weights(i);
    const uint32_t* const pixels = &current_.pixel[i];
    if (transparency_ && level == 1)
      sums_.add(light, pixels, hn::FirstN(d, n - i), transparency_->coverage() + i);
    else
      sums_.add(light, pixels, hn::FirstN(d, n - i), coverage);
  }
  shading_->spawn(*this, level, n);
}

void Wavefront::add_features() {
  const size_t n = current_.rays.size();
  counts_.eye_hits += n;
  if (sums_.layout().planes() == 0) return;
  set_times(current_.rays);
  find_surfaces(scene_.accel.geometry(), scene_.scene, current_.rays, hits_, n, *points_);
  features_->add(current_.rays, hits_, *points_, current_.pixel.data(), nullptr, sample_, sums_);
}

const uint8_t* Wavefront::occluded(const WideSampler<D>& sampler, uint32_t depth) {
  set_times(shadow_);
  scene_.accel.occluded(shadow_, hidden_.data(), context_);
  if (cutouts_) cutouts_->find_shares(shadow_, hidden_.data());
  if (transparency_) transparency_->find_shares(shadow_, hidden_.data(), sampler, depth);
  if (cutouts_ && transparency_)
    for (size_t i = 0; i < shadow_.size(); ++i) cutouts_->shares()[i] *= transparency_->shares()[i];
  return hidden_.data();
}

const float* Wavefront::shares() const {
  return cutouts_ ? cutouts_->shares() : transparency_ ? transparency_->shares() : nullptr;
}

const HitBatch& Wavefront::probe() {
  set_times(probes_);
  scene_.accel.closest(probes_, probed_, context_);
  if (cutouts_ && !context_.stopped()) cutouts_->trace_nearest(probes_, probed_);
  return probed_;
}

// Gives the background, if it is `seen`, to rays that hit nothing and compacts the others. Lanes
// after the last repeat it, so that they hold valid values.
void Wavefront::drop_misses(bool seen) {
  RayBatch& rays = current_.rays;
  const size_t n = rays.size();
  size_t kept = 0;
  for (size_t i = 0; i < n; i += kWidth) {
    // Sums prefetched much earlier would have left the cache.
    const size_t soon = i + 64;  // measured
    for (size_t k = soon; k < std::min(soon + kWidth, n); k += 4) sums_.prefetch(current_.pixel[k]);
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
                   kept, current_.densities(i));
    }
    kept += count;
  }
  rays.resize(kept);
  fill_up(kept);
}

void Wavefront::fill_up(size_t n) {
  for (size_t i = n; n > 0 && i % kWidth != 0; ++i)
    current_.set(i, current_, n - 1), hits_.set(i, hits_[n - 1]);
}

std::pair<Rgb, PixelSums> Wavefront::escaped_light(Vec3f dir, Rgb weight) const {
  Rgb light = background_;
  if (has_sky_) {
    const V3 sky = shading_->sky(set3(d, dir));
    light = {hn::GetLane(sky.x), hn::GetLane(sky.y), hn::GetLane(sky.z)};
  }
  return {light, sums_.fixed(light * weight)};
}

void Wavefront::add_sky(const V3& weight, const V3& dir, const uint32_t* pixels, M mask) {
  if (!hn::AllFalse(d, mask)) sums_.add(shading_->sky(dir) * weight, pixels, mask);
}

void Wavefront::add_untraced(size_t i, const V3& origin, const V3& dir, const V3& weight,
                             uint32_t side, M mask) {
  if (recorder_) recorder_->untraced(*this, i, origin, dir, weight, side, mask);
  add_escaped(weight, dir, &current_.pixel[i], mask);
}

namespace {

std::unique_ptr<TileRenderer> make_renderer(const PreparedScene& scene, WorkControl& control) {
  // In the order of IntegratorKind.
  static constexpr auto kShadings = std::to_array(
      {make_classic_shading, make_views_shading, make_ambient_shading, make_path_shading});
  static_assert(kShadings.size() == kIntegratorNames.size());
  return std::make_unique<Wavefront>(scene, control,
                                     kShadings[size_t(scene.settings.integrator)](scene));
}

}  // namespace
}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

HWY_EXPORT(make_renderer);

std::unique_ptr<TileRenderer> make_tile_renderer(const PreparedScene& scene, WorkControl& control) {
  return HWY_DYNAMIC_DISPATCH(make_renderer)(scene, control);
}

}  // namespace raio::core
#endif
