// The classic shading, as wide as the machine's registers: compiled once for each instruction set
// (Highway's foreach_target) and chosen when the program runs.
//
// Rays go in batches, each of one level of the ray tree: eye rays of a tile, then the shadow rays
// of their hits light by light; their reflections and refractions wait as the next level until they
// fill a batch. A ray carries the weight with which it counts in its pixel, so none waits for
// another.
#include "integrate/classic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/classic_trace.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/camera-inl.h"
#include "integrate/sampler-inl.h"
#include "integrate/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {
namespace {

HWY_INLINE V3 reflect(const V3& dir, const V3& n) {
  return dir - n * hn::Mul(hn::Set(d, 2), dot(dir, n));
}

// Snell's law, for n on the side that `dir` comes from; `in` loses the lanes of total internal
// reflection.
HWY_INLINE V3 refract(const V3& dir, const V3& n, V eta, M& in) {
  const V one = hn::Set(d, 1), cosine = hn::Neg(dot(dir, n));
  const V k = hn::Sub(one, hn::Mul(hn::Mul(eta, eta), hn::Sub(one, hn::Mul(cosine, cosine))));
  in = hn::And(in, hn::Ge(k, hn::Zero(d)));
  const V root = hn::Sqrt(hn::Max(k, hn::Zero(d)));
  return renormalize(d, dir * eta + n * hn::Sub(hn::Mul(eta, cosine), root));
}

class WideTracer final : public ClassicTracer {
 public:
  WideTracer(const ClassicScene& scene, RenderControl& control)
      : scene_(scene),
        control_(control),
        waiting_(size_t(scene.options.depth) + 1),
        vertices_(std::make_unique_for_overwrite<Vertices>()),
        hidden_(padded(kChunk)) {
    context_.stop = &control.stop;
  }

  void render(size_t tile, uint32_t samples, Film& film) override {
    list_pixels(film.tile(tile), std::countr_zero(film.row_stride()));
    sums_.begin(film, tile);
    background_ = sums_.fixed(scene_.scene.background);
    for (PathRays& w : waiting_) w.rays.clear();  // left over where a render was stopped
    counts_ = {};
    context_.tests = context_.steps = 0;
    const uint32_t first = film.samples(tile);
    for (uint32_t s = first; s < samples; ++s) {
      const uint64_t before = counts_.total();
      sums_.begin_sample();
      add_sample(WideSampler<D>(scene_.sampler, s));
      if (context_.stopped()) return;
      sums_.end_sample();
      control_.rays_done += counts_.total() - before;
      ++control_.work_done;
    }
    counts_.tests = context_.tests, counts_.steps = context_.steps;
    film.add(tile, samples - first, sums_.pixels(), counts_);
  }

 private:
  // The tile's pixels, numbered row by row as the film has them, in blocks of 4 x 2, two of
  // which make 4 x 4, four of which make 8 x 8, and so on: structures take neighbours of the batch
  // together.
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
  // Where in the picture the tile's pixels are.
  HWY_INLINE U column_of(U pixel) const {
    return hn::Add(hn::And(pixel, hn::Set(du, (1u << row_bits_) - 1)),
                   hn::Set(du, uint32_t(tile_.x0)));
  }
  HWY_INLINE U row_of(U pixel) const {
    return hn::Add(hn::ShiftRightSame(pixel, row_bits_), hn::Set(du, uint32_t(tile_.y0)));
  }
  // As integrate/sampler.h has it.
  HWY_INLINE U place_of(U pixel) const {
    return hn::Add(hn::ShiftLeft<16>(row_of(pixel)), column_of(pixel));
  }

  void add_sample(const WideSampler<D>& sampler) {
    const size_t deepest = size_t(scene_.options.depth);
    for (size_t eye = 0;;) {
      // The deepest level that fills a batch, or else eye rays, or else, as long as children may
      // come, the first that waits.
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

  // Those of a chunk of the tile's pixels from `first` on; the end of the chunk.
  size_t make_eye_rays(size_t first, const WideSampler<D>& sampler) {
    const RenderOptions& o = scene_.options;
    const EyeRays& eye = scene_.eye;
    PathRays& out = waiting_[1];
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
      WideRay<D> ray = pinhole(d, eye, x, y);
      if (*o.dof) {
        const Wide2<D> square = sampler.in_square(place, branch, kLens);
        const Wide2<D> lens = square_to_disc(d, square.x, square.y);
        ray = thin_lens(d, eye, x, y, lens, o.aperture, o.focus);
      }
      const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
      out.put(ray.origin, ray.dir, inf, pixel, branch, hn::Set(d, 1), all, i - first);
    }
    counts_.eye += end - first;
    return end;
  }

  // The last rays that wait at `level`: what they bring goes to the film, their children wait one
  // further.
  void trace_level(int level, const WideSampler<D>& sampler) {
    current_.take_last(kChunk, waiting_[size_t(level)]);
    context_.coherent = level <= 3;  // eye rays and their first children mostly keep together
    scene_.accel.closest(current_.rays, hits_, context_);
    if (context_.stopped()) return;
    drop_misses();
    const size_t n = current_.rays.size();
    if (level == 1) counts_.eye_hits += n;
    if (n == 0) return;
    find_surfaces(scene_, current_.rays, hits_, n, *vertices_);
    for (size_t l = 0; l < scene_.emitters.size(); ++l) add_light(l, n, sampler);
    if (context_.stopped()) return;
    for (size_t i = 0; i < n; i += kWidth)
      sums_.add(load(vertices_->radiance, i) * load(current_.weight, i), &current_.pixel[i],
                hn::FirstN(d, n - i));
    if (scene_.any_mirror) reflect_rays(level, n);
    if (scene_.any_transparent) refract_rays(level, n);
  }

  // Gives the background to the rays that hit nothing and moves the others together. The lanes
  // after the last of them repeat it, so that they hold something sensible.
  void drop_misses() {
    RayBatch& rays = current_.rays;
    const size_t n = rays.size();
    size_t kept = 0;
    for (size_t i = 0; i < n; i += kWidth) {
      // Sums that are asked for much earlier than they are wanted have left the cache by then.
      const size_t soon = i + 64;  // measured
      for (size_t k = soon; k < std::min(soon + kWidth, n); k += 4)
        sums_.prefetch(current_.pixel[k]);
      const U item = load(hits_.item, i);
      const M in = hn::FirstN(d, n - i);
      const M found = hn::And(in, hn::RebindMask(d, hn::Ne(item, hn::Set(du, kNoPrimitive))));
      const size_t count = hn::CountTrue(d, found);
      add_background(load(current_.weight, i), &current_.pixel[i], hn::AndNot(found, in));
      if (count > 0 && (kept < i || count < kWidth)) {
        put(load(hits_.t, i), found, hits_.t, kept), put(item, found, hits_.item, kept);
        put(load(hits_.u, i), found, hits_.u, kept), put(load(hits_.v, i), found, hits_.v, kept);
        current_.put(origins(rays, i), directions(rays, i), load(rays.tmax, i),
                     load(current_.pixel, i), load(current_.branch, i), load(current_.weight, i),
                     found, kept);
      }
      kept += count;
    }
    rays.resize(kept);
    for (size_t i = kept; kept > 0 && i % kWidth != 0; ++i) {
      rays.set(i, rays[kept - 1]), hits_.set(i, hits_[kept - 1]);
      current_.pixel[i] = current_.pixel[kept - 1], current_.branch[i] = current_.branch[kept - 1];
      current_.weight[i] = current_.weight[kept - 1];
    }
  }

  // What light l brings to the vertices that it sees.
  void add_light(size_t l, size_t n, const WideSampler<D>& sampler) {
    const ClassicScene::Emitter& emitter = scene_.emitters[l];
    Vertices& v = *vertices_;
    const V zero = hn::Zero(d);
    RayBatch& rays = shadow_;
    rays.resize(n);
    size_t lit = 0;
    for (size_t i = 0; i < n; i += kWidth) {
      V3 target = set3(d, emitter.position);
      if (scene_.options.soft_shadows) {
        const Wide2<D> p = sampler.in_square(place_of(load(current_.pixel, i)),
                                             load(current_.branch, i), kLight + uint32_t(l));
        const V half = hn::Set(d, 0.5f);
        target = target + (set3(d, emitter.edge_u) * hn::Sub(p.x, half) +
                           set3(d, emitter.edge_v) * hn::Sub(p.y, half));
      }
      const V3 outside = load(v.outside, i), to_light = target - outside;
      const V distance = length(to_light);
      const M apart = hn::Gt(distance, zero);
      const V3 dir = to_light * hn::IfThenElseZero(apart, hn::Div(hn::Set(d, 1), distance));
      // Nothing from behind the surface, even where a smooth triangle's normal leans that way.
      const M facing =
          hn::And(hn::FirstN(d, n - i), hn::And(hn::Gt(dot(load(v.normal, i), dir), zero),
                                                hn::Gt(dot(load(v.geometric, i), dir), zero)));
      // Ends at the light: short of it by what the division above may have rounded.
      const V tmax = hn::Mul(distance, hn::Set(d, 1 - 4 * std::numeric_limits<float>::epsilon()));
      hn::Store(outside.x, d, &rays.ox[i]), hn::Store(outside.y, d, &rays.oy[i]);
      hn::Store(outside.z, d, &rays.oz[i]);
      hn::Store(dir.x, d, &rays.dx[i]), hn::Store(dir.y, d, &rays.dy[i]);
      hn::Store(dir.z, d, &rays.dz[i]);
      hn::Store(hn::IfThenElse(facing, tmax, hn::Set(d, -1)), d, &rays.tmax[i]);
      lit += hn::CountTrue(d, facing);
    }
    if (lit == 0) return;
    counts_.shadow += lit;
    scene_.accel.occluded(rays, hidden_.data(), context_);
    const V3 intensity = set3(d, emitter.intensity);
    for (size_t i = 0; i < n; i += kWidth) {
      const M facing = hn::And(hn::FirstN(d, n - i), hn::Gt(load(rays.tmax, i), zero));
      const auto hidden = hn::PromoteTo(du, hn::LoadU(hn::Rebind<uint8_t, DU>(), &hidden_[i]));
      const M seen = hn::And(facing, hn::RebindMask(d, hn::Eq(hidden, hn::Zero(du))));
      counts_.shadow_hits += hn::CountTrue(d, hn::AndNot(seen, facing));
      if (hn::AllFalse(d, seen)) continue;
      const V3 dir = directions(rays, i), normal = load(v.normal, i);
      V3 light = load(v.color, i) * hn::Mul(load(v.kd, i), dot(normal, dir));
      const V ks = load(v.ks, i);
      if (!hn::AllFalse(d, hn::Gt(ks, zero))) {
        const V mirror = hn::Neg(dot(reflect(-dir, normal), directions(current_.rays, i)));
        const V highlight = hn::Mul(
            ks, pow_unit(d, hn::Min(hn::Max(mirror, zero), hn::Set(d, 1)), load(v.shine, i)));
        light = light + V3{highlight, highlight, highlight};
      }
      const V3 sum = load(v.radiance, i);
      store(select(seen, sum + intensity * light, sum), v.radiance, i);
    }
  }

  // A smooth triangle's normal can send a ray through the surface that it should leave; then the
  // geometric one decides.
  void reflect_rays(int level, size_t n) {
    const Vertices& v = *vertices_;
    Children children(*this, level, n);
    for (size_t i = 0; i < n; i += kWidth) {
      const V ks = load(v.ks, i);
      const M mirrors = hn::And(hn::FirstN(d, n - i), hn::Gt(ks, hn::Zero(d)));
      if (hn::AllFalse(d, mirrors)) continue;
      const V3 in = directions(current_.rays, i), geometric = load(v.geometric, i);
      V3 dir = renormalize(d, reflect(in, load(v.normal, i)));
      dir = select(hn::Gt(dot(dir, geometric), hn::Zero(d)), dir,
                   renormalize(d, reflect(in, geometric)));
      counts_.reflection += children.add(i, load(v.outside, i), dir, ks, 0, mirrors);
    }
    children.done();
  }

  void refract_rays(int level, size_t n) {
    const Vertices& v = *vertices_;
    Children children(*this, level, n);
    for (size_t i = 0; i < n; i += kWidth) {
      const V transmission = load(v.transmission, i);
      const M clear = hn::And(hn::FirstN(d, n - i), hn::Gt(transmission, hn::Zero(d)));
      if (hn::AllFalse(d, clear)) continue;
      const V3 in = directions(current_.rays, i), geometric = load(v.geometric, i);
      M passes = clear, passes_geometric = clear;
      V3 dir = refract(in, load(v.normal, i), load(v.eta, i), passes);
      const V3 other = refract(in, geometric, load(v.eta, i), passes_geometric);
      const M through = hn::Lt(dot(dir, geometric), hn::Zero(d));
      dir = select(through, dir, other);
      passes = hn::And(passes, hn::Or(through, passes_geometric));
      const V3 inside = offset_point(load(v.point, i), geometric, load(v.scale, i), false);
      counts_.refraction += children.add(i, inside, dir, transmission, 1, passes);
    }
    children.done();
  }

  // The children that the current rays send to the next level; after the last level they bring the
  // background.
  class Children {
   public:
    Children(WideTracer& tracer, int level, size_t n)
        : t_(tracer), last_(level == tracer.scene_.options.depth) {
      if (last_) return;
      out_ = &t_.waiting_[size_t(level) + 1];
      size_ = out_->rays.size();
      out_->resize(size_ + n);
    }
    // The number of rays to be traced.
    size_t add(size_t i, const V3& origin, const V3& dir, V part, uint32_t side, M mask) {
      const V weight = hn::Mul(load(t_.current_.weight, i), part);
      if (last_) {
        t_.add_background(weight, &t_.current_.pixel[i], mask);
        return 0;
      }
      const U branch = load(t_.current_.branch, i);
      const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
      out_->put(origin, dir, inf, load(t_.current_.pixel, i),
                hn::Add(hn::Add(branch, branch), hn::Set(du, side)), weight, mask, size_);
      const size_t count = hn::CountTrue(d, mask);
      size_ += count;
      return count;
    }
    void done() {
      if (!last_) out_->rays.resize(size_);
    }

   private:
    WideTracer& t_;
    bool last_;
    PathRays* out_ = nullptr;
    size_t size_ = 0;
  };

  void add_background(V weight, const uint32_t* pixels, M mask) {
    const Rgb background = scene_.scene.background;
    if (background == Rgb() || hn::AllFalse(d, mask)) return;
    if (hn::AllTrue(d, hn::Or(hn::Not(mask), hn::Eq(weight, hn::Set(d, 1)))))
      sums_.add(background_, pixels, mask);
    else
      sums_.add(set3(d, background) * weight, pixels, mask);
  }

  const ClassicScene& scene_;
  RenderControl& control_;
  TraceContext context_;
  TileSums sums_;
  PixelSums background_{};  // of weight 1
  Tile tile_{};             // of which these are:
  int row_bits_ = 0;        // of a pixel's number, those that count within a row
  RayCounts counts_;
  size_t pixels_ = 0;
  alignas(64) uint32_t pixel_[kTilePixels + 16]{};  // their numbers
  std::vector<PathRays> waiting_;                   // by level
  PathRays current_;                                // being traced, with their hits
  HitBatch hits_;
  std::unique_ptr<Vertices> vertices_;
  RayBatch shadow_;
  std::vector<uint8_t> hidden_;
};

std::unique_ptr<ClassicTracer> make_tracer(const ClassicScene& scene, RenderControl& control) {
  return std::make_unique<WideTracer>(scene, control);
}

}  // namespace
}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio {

HWY_EXPORT(make_tracer);

std::unique_ptr<ClassicTracer> make_classic_tracer(const ClassicScene& scene,
                                                   RenderControl& control) {
  return HWY_DYNAMIC_DISPATCH(make_tracer)(scene, control);
}

}  // namespace raio
#endif
