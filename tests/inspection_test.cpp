// The results of the window's inspector, without the window.
#include "view/inspection.h"

#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "io/nff/nff.h"
#include "render/render.h"

namespace raio::core::view {
namespace {

constexpr std::string_view kScene =
    "b 0.1 0.2 0.3\n"
    "v\nfrom 0 -6 2\nat 0 0 0.5\nup 0 0 1\nangle 40\nhither 0\nresolution 40 30\n"
    "l 3 -4 5\nl -3 -4 4\n"
    "f 1 0 0 0.8 0.4 10 0 1\ns 0 0 0.7 0.7\n"
    "f 1 1 1 0.1 0.1 10 0.8 1.5\ns -1.4 -0.8 0.5 0.5\n"
    "f 0.8 0.8 0.7 0.9 0 1 0 1\np 4\n-5 -5 0\n5 -5 0\n5 5 0\n-5 5 0\n";

InspectionRequest request(AccelKind kind) {
  InspectionRequest q;
  q.scene = std::make_shared<const Scene>(parse_nff(kScene, "scene")->scene);
  q.options.width = 40, q.options.height = 30;
  q.options.aa = 2, q.options.soft_shadows = true;
  q.options.accel.kind = kind;
  return q;
}

TEST(Inspection, SamplesSumUpToThePixelThatIsRendered) {
  for (const AccelKind kind : {AccelKind::bvh, AccelKind::grid, AccelKind::none}) {
    InspectionRequest q = request(kind);
    const RenderSettings settings = resolve_options(q.options, *q.scene);
    const auto accel = build_accel(*q.scene, settings.accel);
    const auto film = make_film(*q.scene, settings);
    ASSERT_TRUE(accel && film);
    WorkControl control;
    render(*q.scene, **accel, settings, **film, control);
    const Image image = (*film)->resolve();
    for (const std::array<int, 2> pixel : {std::array{20, 14}, {8, 15}, {20, 28}, {1, 1}}) {
      Vec3d sum;
      q.pixel = q.last = pixel;
      for (q.sample = 0; q.sample < settings.samples_per_pixel(); ++q.sample) {
        const auto found = inspect(q, false);
        ASSERT_FALSE(found->error);
        ASSERT_EQ(found->logs.size(), found->sample.rays.size());
        EXPECT_TRUE(found->logs.front().has_value());
        sum = sum + found->sample.rgb;
      }
      const Rgb rendered = image.pixels[size_t(pixel[1] * 40 + pixel[0])];
      EXPECT_EQ(Rgb(sum * (1.0 / settings.samples_per_pixel())), rendered)
          << pixel[0] << ',' << pixel[1];
    }
  }
}

TEST(Inspection, ARegionHasTheRaysOfItsPixels) {
  InspectionRequest q = request(AccelKind::bvh);
  q.pixel = {0, 14}, q.last = {39, 14};
  const auto row = inspect(q, false);
  ASSERT_FALSE(row->error);
  EXPECT_EQ(row->pixels, 40u);
  std::array<size_t, kRayKinds> found{}, expected{};
  for (const RegionRay& r : row->rays) ++found[size_t(r.kind)];
  for (int x = 0; x < 40; ++x) {
    q.pixel = q.last = {x, 14};
    const auto pixel = inspect(q, false);
    for (const ExplainedRay& r : pixel->sample.rays) ++expected[size_t(kind_of(r))];
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(found[size_t(RayKind::eye)], 40u);
  for (const RegionRay& r : row->rays) {
    // A stopped ray has an occluder.
    if (r.kind == RayKind::stopped) {
      EXPECT_TRUE(r.hit.has_value());
    }
  }
  q.options.width = q.options.height = 300;
  q.pixel = {0, 0}, q.last = {299, 299};
  const auto all = inspect(q, false);
  EXPECT_LE(all->pixels, size_t(kMaxRegionPixels));
  EXPECT_GT(all->pixels, size_t(kMaxRegionPixels) / 4);
  EXPECT_LE(all->rays.size(), kMaxRegionRays);
}

TEST(Inspection, FiltersByKindLevelAndHit) {
  RegionRay eye, mirrored;
  eye.hit = PrimitiveKind::sphere, eye.material = 2;
  mirrored.kind = RayKind::reflected, mirrored.level = 2;
  RayFilter filter;
  EXPECT_TRUE(filter.passes(eye) && filter.passes(mirrored));
  filter.level = 2;
  EXPECT_TRUE(!filter.passes(eye) && filter.passes(mirrored));
  filter = {};
  filter.kinds[size_t(RayKind::reflected)] = false;
  EXPECT_TRUE(filter.passes(eye) && !filter.passes(mirrored));
  filter = {.hits = RayFilter::Hits::nothing};
  EXPECT_TRUE(!filter.passes(eye) && filter.passes(mirrored));
  filter = {.hits = RayFilter::Hits::kind, .number = int(PrimitiveKind::sphere)};
  EXPECT_TRUE(filter.passes(eye) && !filter.passes(mirrored));
  filter.number = int(PrimitiveKind::triangle);
  EXPECT_FALSE(filter.passes(eye));
  filter = {.hits = RayFilter::Hits::material, .number = 2};
  EXPECT_TRUE(filter.passes(eye) && !filter.passes(mirrored));
  filter.number = 0;  // a ray without a hit has no material, not the first one
  EXPECT_FALSE(filter.passes(mirrored));
}

TEST(Inspection, TheNewestRequestWins) {
  std::atomic<int> news = 0;
  Inspection inspection([&] { ++news; });
  InspectionRequest q = request(AccelKind::grid);
  for (int x = 0; x < 20; ++x) {
    q.pixel = q.last = {x, 14};
    inspection.start(q);
  }
  std::shared_ptr<const Inspected> found;
  for (int i = 0; i < 1000 && inspection.busy(); ++i) {
    if (auto one = inspection.poll()) found = one;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(found);
  EXPECT_EQ(found->request.pixel[0], 19);
  EXPECT_GT(news, 0);
}

}  // namespace
}  // namespace raio::core::view
