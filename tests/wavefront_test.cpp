// The interface between the wavefront and a Shading, with a test shading: mirrors that tint what
// they reflect.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "accel_rays.h"
#include "integrate/wavefront-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

class TintedMirrors final : public Shading {
 public:
  explicit TintedMirrors(const PreparedScene& scene)
      : levels_(scene.settings.depth), background_(scene.settings.background) {}

  int levels() const override { return levels_; }
  bool tints() const override { return true; }
  Rgb background() const override { return background_; }

  void shade(Wavefront& w, int, size_t n, const WideSampler<D>&) override {
    for (size_t i = 0; i < n; i += kWidth) store(set3(d, Rgb()), w.points().radiance, i);
  }
  void spawn(Wavefront& w, int level, size_t n) override {
    const SurfacePoints& v = w.points();
    Wavefront::Children children(w, level, n);
    for (size_t i = 0; i < n; i += kWidth) {
      const V3 in = directions(w.rays().rays, i), normal = load(v.normal, i);
      const V3 out = in - normal * hn::Mul(hn::Set(d, 2), dot(in, normal));
      children.add(i, load(v.outside, i), out, set3(d, Rgb(0.5f, 1, 0.25f)), 0,
                   hn::FirstN(d, n - i));
    }
    children.done();
  }

 private:
  int levels_;
  Rgb background_;
};

Rgb corner_pixel(const Scene& scene, int levels) {
  const auto accel = core::tests::build(scene, {});
  RenderSettings settings;
  settings.background = scene.background;
  settings.camera = scene.camera;
  settings.width = settings.height = 4;
  settings.depth = levels;
  const PreparedScene prepared(scene, *accel, settings);
  WorkControl control;
  Film film(4, 4, 1);
  Wavefront(prepared, control, std::make_unique<TintedMirrors>(prepared)).render(0, {0, 1}, film);
  return film.resolve().at(0, 0);
}

// Emits NaN in odd samples, and light beyond all bounds in sample 2.
class Faulty final : public Shading {
 public:
  bool counts_rays() const override { return true; }
  Rgb background() const override { return {}; }
  bool has_sky() const override { return true; }
  V3 sky(const V3& dir) const override {
    const float limits[] = {0.25f, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()};
    const V right = hn::IfThenElse(hn::Gt(dir.x, hn::Zero(d)), hn::Set(d, limits[sample_ % 3]),
                                   hn::Set(d, 0.5f));
    return {right, hn::Set(d, 0.5f), hn::Set(d, 0.5f)};
  }
  void begin(Wavefront&, size_t) override { ++sample_; }
  void shade(Wavefront&, int, size_t, const WideSampler<D>&) override {}

 private:
  int sample_ = -1;
};

TEST(Wavefront, CountsNanAsBlack) {
  Scene scene;
  scene.materials = {Material()};
  scene.camera.from = {0, 0, 1}, scene.camera.at = {0, 0, 0};
  const auto accel = core::tests::build(scene, {});
  RenderSettings settings;
  settings.camera = scene.camera;
  settings.width = settings.height = 4;
  settings.samples = 3;
  settings.channels.add(Channel::variance);
  const PreparedScene prepared(scene, *accel, settings);
  WorkControl control;
  Film film(4, 4, 1, kTileSide, settings.channels);
  Wavefront wavefront(prepared, control, std::make_unique<Faulty>());
  wavefront.render(0, {0, 2}, film);
  EXPECT_EQ(film.nans(), (NanSamples{8, 2, 0}));
  EXPECT_EQ(film.resolve().at(0, 0), Rgb(0.5f));
  EXPECT_EQ(film.resolve().at(2, 0), Rgb(0.125f, 0.25f, 0.25f));
  wavefront.render(0, {2, 3}, film);  // beyond the bound it counts as the bound
  EXPECT_EQ(film.nans().count, 8u);
  EXPECT_FLOAT_EQ(film.resolve().at(3, 3).x, 1.25f / 3);
  EXPECT_TRUE(film.can_hold(film.copy(0)));
  NanSamples both{1, 3, 1};
  both += {2, 0, 2};
  EXPECT_EQ(both, (NanSamples{3, 3, 1}));
  both += {1, 2, 1};
  EXPECT_EQ(both, (NanSamples{4, 2, 1}));
}

TEST(Wavefront, WeighsRaysByColor) {
  Scene scene;
  scene.background = {1, 0.5f, 0.25f};
  scene.materials = {Material()};
  scene.camera.from = {0, 0, 1}, scene.camera.at = {0, 0, 0};
  EXPECT_EQ(corner_pixel(scene, 2), Rgb(1, 0.5f, 0.25f));
  scene.planes = {Plane{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {0};
  EXPECT_EQ(corner_pixel(scene, 2), Rgb(0.5f, 0.5f, 0.0625f));
  // A second mirror behind the camera: the children of the last level get the background.
  scene.planes = {Plane{{0, 0, 0}, {0, 0, 1}}, Plane{{0, 0, 2}, {0, 0, -1}}};
  scene.plane_materials = {0, 0};
  EXPECT_EQ(corner_pixel(scene, 1), Rgb(0.5f, 0.5f, 0.0625f));
  EXPECT_EQ(corner_pixel(scene, 2), Rgb(0.25f, 0.5f, 0.015625f));
}

}  // namespace
}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
