#include "integrate/views.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/views.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "base/exact_math.h"
#include "base/random.h"
#include "integrate/features-inl.h"
#include "integrate/shadings-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// A bright colour, unrelated to those of neighbouring ids.
Rgb id_color(uint32_t id) {
  const uint32_t bits = scramble(id);
  const auto part = [&](int shift) { return 0.25f + 0.75f * float(bits >> shift & 255) / 255; };
  return {part(0), part(8), part(16)};
}

class ViewsShading final : public Shading {
 public:
  explicit ViewsShading(const PreparedScene& scene)
      : view_(scene.settings.view),
        distance_(length(scene.settings.camera.at - scene.settings.camera.from)),
        focus_(scene.settings.focus) {
    // A lens of radius R focused at F blurs a point at depth z over a circle of diameter 2 R |z -
    // F| / z on the focal plane. Other projections have no lens.
    const float pixel = length(scene.eye.per_y) * scene.settings.preview_scale;
    if (scene.settings.camera.can_have_lens())
      blur_ = 2 * scene.settings.aperture / (pixel * focus_);
  }

  Rgb background() const override { return {}; }
  bool counts_rays() const override { return view_ == View::steps || view_ == View::tests; }

  void begin(Wavefront& w, size_t n) override {
    if (!counts_rays()) return;
    for (size_t i = 0; i < n; i += kWidth)
      w.add(colors(
                [&](size_t k) {
                  return heat_color(double(view_ == View::steps ? w.costs().steps(i + k)
                                                                : w.costs().tests(i + k)));
                },
                std::min(n - i, kWidth)),
            i, hn::FirstN(d, n - i));
  }

  void shade(Wavefront& w, int, size_t n, const WideSampler<D>&) override {
    SurfacePoints& v = w.points();
    const V half = hn::Set(d, 0.5f);
    for (size_t i = 0; i < n; i += kWidth) {
      V3 radiance = set3(d, Rgb());
      if (view_ == View::normals) {
        radiance = set3(d, Rgb(0.5f)) + load(v.normal, i) * half;
      } else if (!counts_rays()) {
        HWY_ALIGN float depths[kWidth];
        hn::Store(depths_of_hits(w.scene(), w.rays().rays, w.hits(), i), d, depths);
        radiance =
            colors([&](size_t k) { return color(w, i + k, depths[k]); }, std::min(n - i, kWidth));
      }
      store(radiance, v.radiance, i);
    }
  }

 private:
  // color(0), color(1) ... in the first `count` lanes.
  template <class Color>
  static V3 colors(Color&& color, size_t count) {
    HWY_ALIGN float lanes[3][kWidth] = {};
    for (size_t k = 0; k < count; ++k) {
      const Rgb c = color(k);
      lanes[0][k] = c.x, lanes[1][k] = c.y, lanes[2][k] = c.z;
    }
    return {hn::Load(d, lanes[0]), hn::Load(d, lanes[1]), hn::Load(d, lanes[2])};
  }

  Rgb color(Wavefront& w, size_t i, float depth) const {
    const SurfacePoints& v = w.points();
    if (view_ == View::depth) return Rgb(distance_ / (distance_ + depth));
    const Vec3f normal = {v.normal.x.at[i], v.normal.y.at[i], v.normal.z.at[i]};
    const float shade = 0.4f + 0.6f * std::abs(dot(normal, w.rays().rays[i].dir));
    if (view_ == View::ids)
      return id_color(key_of(w.scene().accel.geometry(), w.hits()[i])) * shade;
    if (view_ == View::materials) return id_color(v.material[i]) * shade;
    return focus_color(depth) * shade;
  }

  // Different for all primitives.
  static uint32_t key_of(const Geometry& geometry, const Hit& hit) {
    const uint32_t key = geometry.object_at(hit.instance).key_of(hit.primitive);
    return hit.instance ? hash_of(key, hit.instance) : key;
  }

  Rgb focus_color(float depth) const {
    const float pixels = blur_ * std::abs(depth - focus_) / depth;
    if (pixels < 1) return {0.2f, 0.9f, 0.3f};
    const float much = float(exact_log2(std::min(pixels, 32.0f))) / 5;
    const Rgb grey(0.7f), full = depth < focus_ ? Rgb(0.9f, 0.2f, 0.1f) : Rgb(0.1f, 0.3f, 1);
    return grey * (1 - much) + full * much;
  }

  View view_;
  float distance_, focus_, blur_ = 0;
};

}  // namespace

std::unique_ptr<Shading> make_views_shading(const PreparedScene& scene) {
  return std::make_unique<ViewsShading>(scene);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

double views_bound(const Scene&, const RenderSettings&) { return 1; }

Rgb heat_color(double count) {
  static constexpr std::array<Rgb, 7> kScale = {Rgb(0, 0, 0), Rgb(0, 0, 1), Rgb(0, 1, 1),
                                                Rgb(0, 1, 0), Rgb(1, 1, 0), Rgb(1, 0, 0),
                                                Rgb(1, 1, 1)};
  const double place = count < 1 ? count : 1 + exact_log2(count) / 2;
  if (place >= kScale.size() - 1) return kScale.back();
  const auto step = size_t(place);
  const float part = float(place - double(step));
  return kScale[step] * (1 - part) + kScale[step + 1] * part;
}

}  // namespace raio::core
#endif
