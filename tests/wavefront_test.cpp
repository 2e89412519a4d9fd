// The interface between the wavefront and a Shading, with a test shading: mirrors that tint what
// they reflect.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "accel_rays.h"
#include "integrate/surface.h"
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
  EXPECT_EQ(film.faults().nans, (CountedSamples{8, 2, 0}));
  EXPECT_EQ(film.resolve().at(0, 0), Rgb(0.5f));
  EXPECT_EQ(film.resolve().at(2, 0), Rgb(0.125f, 0.25f, 0.25f));
  wavefront.render(0, {2, 3}, film);  // beyond the bound it counts as the bound
  EXPECT_EQ(film.faults().nans.count, 8u);
  EXPECT_FLOAT_EQ(film.resolve().at(3, 3).x, 1.25f / 3);
  EXPECT_EQ(film.faults().clamped, (CountedSamples{8, 2, 0}));
  EXPECT_TRUE(film.can_hold(film.copy(0)));
  CountedSamples both{1, 3, 1};
  both += {2, 0, 2};
  EXPECT_EQ(both, (CountedSamples{3, 3, 1}));
  both += {1, 2, 1};
  EXPECT_EQ(both, (CountedSamples{4, 2, 1}));
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

// Single rays and batches get the same normals, also on smooth triangles whose winding contradicts
// their normals.
TEST(Surfaces, OneAtATimeEqualManyAtOnce) {
  Scene scene = core::tests::random_scene(400, 7);
  for (size_t i = 0; i < scene.positions.size(); ++i)
    scene.normals.push_back(normalize(Vec3f(1, 0.5f, 0.2f) + scene.positions[i] * 0.3f));
  scene.triangle_normals = scene.triangles;
  const auto accel = core::tests::build(scene, {});
  const Geometry& geometry = accel->geometry();
  ASSERT_TRUE(geometry.any_smooth());
  const RayBatch asked = core::tests::awkward_rays(scene, 4000, 3);
  RayBatch rays;
  HitBatch hits, found;
  TraceContext context;
  accel->closest(asked, hits, context);
  found.reset(kChunk);
  for (size_t i = 0; i < asked.size() && rays.size() < kChunk; ++i) {
    if (!hits[i].found()) continue;
    found.set(rays.size(), hits[i]);
    rays.push(asked[i]);
  }
  const size_t n = rays.size() / kWidth * kWidth;
  ASSERT_GT(n, 500u);
  const auto points = std::make_unique<SurfacePoints>();
  find_surfaces(geometry, scene, rays, found, n, *points);
  size_t contradicting = 0;
  for (size_t i = 0; i < n; ++i) {
    const Surface one = surface_at(geometry, rays[i], found[i]);
    const Vec3f many = {points->normal.x.at[i], points->normal.y.at[i], points->normal.z.at[i]};
    const Vec3f facing = {points->geometric.x.at[i], points->geometric.y.at[i],
                          points->geometric.z.at[i]};
    EXPECT_NEAR(std::abs(dot(one.normal, many)), 1, 1e-5) << i;
    if (const auto kind = geometry.kind_of(found.primitive[i]); kind == PrimitiveKind::triangle) {
      const uint32_t index = geometry.index_of(kind, found.primitive[i]);
      // Both lie on the side of the triangle that its winding gives.
      const Vec3f outward = geometry.facet(index).normal;
      EXPECT_GE(dot(one.normal, outward), 0) << i;
      EXPECT_GE(dot(many, facing), 0) << i;
      if (const TriangleIndices* corners = geometry.corner_normals(index))
        contradicting += dot(geometry.normals()[(*corners)[0]], outward) < 0;
    }
  }
  EXPECT_GT(contradicting, 3u);
}

}  // namespace
}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
