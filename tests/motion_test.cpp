// Motion blur.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "accel_rays.h"
#include "io/nff/nff.h"
#include "io/raio/raio.h"
#include "random_shapes.h"
#include "render/options.h"
#include "render/render.h"
#include "scenes.h"
#include "shape/moving_sphere.h"
#include "shape/moving_triangle.h"

namespace raio::core {
namespace {

constexpr std::string_view kMoving = "sm -2 -0.5 0 1.5 0.75 -1 0.8 0 3\n";

Scene scene(std::string_view shapes) {
  const std::string before =
      "bclr 0 0 0\nv\nfrom 0 0 10\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0\nresolution 48 36\n"
      "l 3 5 9 1 1 1\nl -4 2 6 0.5 0.5 0.5\n"
      "f 1 0.8 0.6 0.9 1 1 1 0.2 20 0 1\n";
  auto read = parse_nff(before + std::string(shapes), "moving");
  EXPECT_TRUE(read);
  return std::move(read->scene);
}

Image picture(const Scene& scene, const RenderOptions& options) {
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  const auto film = make_film(scene, settings);
  EXPECT_TRUE(accel && film);
  WorkControl control;
  render(scene, **accel, settings, **film, control);
  return (*film)->resolve();
}

bool holds(Box3f outer, const Box3f& inner) {
  const Box3f before = outer;
  outer.extend(inner);
  return length(outer.lo - before.lo) + length(outer.hi - before.hi) < 1e-6f;
}

TEST(MovingSphere, MatchesTheSphereAtEachTime) {
  const MovingSphere s{{-2, -0.5f, 0}, {1.5f, 0.75f, -1}, 0.8f, 0, 3};
  for (const float time : {-1.0f, 0.0f, 0.7f, 1.5f, 3.0f, 9.0f}) {
    const Sphere still = at_time(s, time);
    EXPECT_LE(
        length(still.center - (s.center + (s.to - s.center) * std::clamp(time / 3, 0.0f, 1.0f))),
        1e-6f);
    Ray ray{{0, 0, 10}, normalize(still.center + Vec3f(0.1f, 0.2f, 0) - Vec3f(0, 0, 10))};
    ray.time = time;
    const auto hit = first_hit(s, ray, Sides::both), expected = first_hit(still, ray, Sides::both);
    ASSERT_TRUE(hit && expected);
    EXPECT_NEAR(hit->t, expected->t, 1e-5f);
    EXPECT_TRUE(holds(bounds(s), bounds(still)));
  }
}

TEST(MovingTriangle, MatchesTheTriangleAtEachTime) {
  tests::Random random(3);
  const auto point = [&] { return Vec3f(random.in_cube()); };
  int hits = 0;
  for (int k = 0; k < 20'000; ++k) {
    const MovingTriangle t{{point(), point(), point()}, {point(), point(), point()}, -1, 2};
    Ray ray{point() * 4.0f, {}};
    ray.time = float(random.uniform(-2, 3));
    ray.dir = normalize(point() - ray.origin);
    const Triangle still = at_time(t, ray.time);
    const auto hit = first_hit(t, ray, Sides::both);
    const auto expected = first_hit(still, ray, ShearedRay(ray.dir), Sides::both);
    // Except for rays along edges and triangles seen edge-on.
    const double cosine = std::abs(dot(triangle_normal(still), ray.dir));
    const double edge =
        expected ? std::min({expected->u, expected->v, 1 - expected->u - expected->v}) : 0.01;
    if (edge < 1e-3 || cosine < 1e-3) continue;
    ASSERT_EQ(hit.has_value(), expected.has_value()) << k;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->t, expected->t, 1e-4);
    const float side = dot(triangle_normal(still), ray.dir);
    EXPECT_TRUE(first_hit(t, ray, side < 0 ? Sides::outside : Sides::inside));
    EXPECT_FALSE(first_hit(t, ray, side < 0 ? Sides::inside : Sides::outside));
    EXPECT_TRUE(holds(bounds(t), bounds(still)));
  }
  EXPECT_GT(hits, 1000);
}

// No ray passes between triangles that share an edge, wherever it moves.
TEST(MovingTriangle, AreWatertightTogether) {
  tests::Random random(9);
  const auto point = [&] { return Vec3f(random.in_cube()); };
  for (int k = 0; k < 2000; ++k) {
    const Vec3f a = point(), a1 = point(), b = point(), b1 = point();
    const Vec3f left = point(), left1 = point();
    const MovingTriangle one{{a, b, left}, {a1, b1, left1}, 0, 1};
    Ray ray;
    ray.time = float(random.uniform());
    const Triangle still = at_time(one, ray.time);
    // The other is beyond the edge: the first one, mirrored at its middle.
    const Vec3f right = a + b - left, right1 = a1 + b1 - left1;
    const MovingTriangle other{{b, a, right}, {b1, a1, right1}, 0, 1};
    const Vec3f on_edge = still.a + (still.b - still.a) * float(random.uniform(0.05, 0.95));
    ray.origin = on_edge + Vec3f(random.direction()) * 3.0f;
    ray.dir = normalize(on_edge - ray.origin);
    if (std::abs(dot(triangle_normal(still), ray.dir)) < 1e-3f) continue;
    EXPECT_TRUE(first_hit(one, ray, Sides::both) || first_hit(other, ray, Sides::both)) << k;
  }
}

// Wherever the shape is on its way, the boxes that it touches are reported; and reported boxes are
// mostly near.
template <class Shape, class PointOn>
void check_boxes_on_the_way(const Shape& shape, PointOn&& point_on, tests::Random& random) {
  for (int i = 0; i < 20; ++i) {
    const Vec3d p = point_on(float(random.uniform()));
    Box3d box{p, p};
    box.pad(1e-6);
    for (int a = 0; a < 3; ++a) box.lo[a] -= random.uniform(), box.hi[a] += random.uniform();
    EXPECT_TRUE(overlaps(shape, box));
  }
}

TEST(Movement, IsBoundedWholeAndTightly) {
  tests::Random random(5);
  const auto point = [&] { return Vec3f(random.in_cube() * 3.0); };
  for (int k = 0; k < 500; ++k) {
    const MovingSphere s{point(), point(), 0.4f, 0, 1};
    check_boxes_on_the_way(
        s, [&](float time) { return center_at(s, time) + random.direction() * double(s.radius); },
        random);
    const MovingTriangle t{{point(), point(), point()}, {point(), point(), point()}, 0, 1};
    check_boxes_on_the_way(
        t,
        [&](float time) {
          const Triangle still = at_time(t, time);
          const double u = random.uniform(), v = random.uniform(0, 1 - u);
          return Vec3d(still.a) * (1 - u - v) + Vec3d(still.b) * u + Vec3d(still.c) * v;
        },
        random);
  }
  // Of the 1000 cells of its bounds, one moving along the diagonal touches those next to it.
  const MovingSphere ball{Vec3f(0), Vec3f(10), 0.5f, 0, 1};
  const MovingTriangle leaf{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{9, 9, 9}, {10, 9, 9}, {9, 10, 9}}, 0, 1};
  int by_ball = 0, by_leaf = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d lo(i % 10, i / 10 % 10, i / 100);
    by_ball += overlaps(ball, Box3d{lo, lo + Vec3d(1)});
    by_leaf += overlaps(leaf, Box3d{lo + Vec3d(0.01), lo + Vec3d(0.99)});
  }
  EXPECT_LT(by_ball, 120);
  EXPECT_LT(by_leaf, 60);
}

TEST(Motion, StructuresAgreeOnRaysOfAnyTime) {
  for (const bool one_sided : {false, true}) {
    const Scene scene = tests::moving_scene(one_sided);
    const RayBatch rays = tests::at_any_time(tests::awkward_rays(scene, 10'000, 4));
    const auto oracle = tests::build(scene, {.kind = AccelKind::none}, one_sided);
    const tests::Answers expected = tests::answers(*oracle, rays);
    size_t of_moving = 0;
    for (size_t i = 0; i < rays.size(); ++i)
      of_moving +=
          expected.closest[i].found() &&
          oracle->geometry().kind_of(expected.closest[i].primitive) >= PrimitiveKind::moving_sphere;
    EXPECT_GT(of_moving, 500u);
    for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh})
      for (const bool coherent : {false, true}) {
        const auto found = tests::disagreement(
            expected, *tests::build(scene, {.kind = kind}, one_sided), rays, true, coherent);
        EXPECT_EQ(found.closest + found.occluded, 0u) << int(kind) << coherent << one_sided;
      }
  }
}

TEST(Motion, AMomentIsTheStillPicture) {
  RenderOptions o;
  o.aa = 2;
  for (const float time : {0.0f, 1.5f, 3.0f}) {
    const Scene moving = scene(std::string(kMoving) + "s 0 -2 0 0.7\n");
    o.shutter = {time, time};
    const Sphere at = at_time(moving.moving_spheres[0], time);
    Scene still = scene("s 0 0 0 0.8\ns 0 -2 0 0.7\n");
    still.dialect = Dialect::p3f;
    still.spheres[0].center = at.center;
    const Image a = picture(moving, o);
    o.shutter = {};
    const Image b = picture(still, o);
    size_t apart = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) apart += length(a.pixels[i] - b.pixels[i]) > 0.02f;
    EXPECT_LE(apart, 3u) << "grazed in double and in float";
  }
}

// Blur is the mean of the moments.
TEST(Motion, IsTheMeanOfAThousandStillPictures) {
  const Scene moving = scene(kMoving);
  RenderOptions o;
  o.samples = 1024;
  const Image blurred = picture(moving, o);
  std::vector<Vec3d> mean(blurred.pixels.size());
  constexpr int kStills = 1000;
  for (int k = 0; k < kStills; ++k) {
    RenderOptions still;
    const float time = 3 * (float(k) + 0.5f) / kStills;
    still.shutter = {time, time}, still.aa = 1, still.seed = uint32_t(k);
    const Image one = picture(moving, still);
    for (size_t i = 0; i < mean.size(); ++i)
      mean[i] = mean[i] + Vec3d(one.pixels[i]) * (1.0 / kStills);
  }
  double sum = 0, worst = 0;
  for (size_t i = 0; i < mean.size(); ++i) {
    const double apart = length(Vec3d(blurred.pixels[i]) - mean[i]);
    sum += apart * apart, worst = std::max(worst, apart);
  }
  EXPECT_LE(std::sqrt(sum / double(mean.size())), 0.01);
  EXPECT_LE(worst, 0.1);
}

// The black side of a box; its edge crosses a white picture uniformly from x = -1 to x = 1: a
// pixel's fraction of white is a ramp.
TEST(Motion, AMovingEdgeIsItsExactRamp) {
  Scene s = scene("bm -50 -50 -0.001 -1 50 0 -50 -50 -0.001 1 50 0 0 1\n");
  s.background = Rgb(1);
  s.materials = {Material{.color = Rgb(0), .kd = 0}};
  RenderOptions o;
  o.width = 33, o.height = 33;
  const double pixel = 2 * 10 * std::tan(20 * std::numbers::pi / 180) / 33;
  // The white fraction when the fraction `part` of the time has passed.
  const auto white = [](double x, double open, double close) {
    return std::clamp(((x + 1) / 2 - open) / (close - open), 0.0, 1.0);
  };
  for (const auto& [open, close] : {std::array{0.0f, 1.0f}, {0.25f, 0.5f}}) {
    o.shutter = {open, close};
    for (const bool sobol : {false, true}) {
      o.samples = sobol ? 1024 : 0, o.aa = sobol ? 0 : 32;
      Image image = picture(s, o);
      for (int x = 0; x < 33; ++x) {
        double expected = 0;
        constexpr int kParts = 1000;
        for (int i = 0; i < kParts; ++i)
          expected += white((x + (i + 0.5) / kParts - 16.5) * pixel, open, close) / kParts;
        for (const int y : {5, 16}) EXPECT_NEAR(image.at(x, y).x, expected, 0.02) << x << ' ' << y;
      }
    }
  }
}

TEST(Motion, IsTheSameWithEveryStructureAndAnyNumberOfThreads) {
  Scene s = tests::moving_scene(7);
  s.camera = scene("").camera;
  s.camera.movement = CameraMovement{{1, 0.5f, 9}, {0, 0.2f, 0}, 0, 1};
  RenderOptions o;
  o.aa = 2, o.soft_shadows = true, o.dof = true, o.width = 60, o.height = 40;
  o.accel.kind = AccelKind::none;
  const Image expected = picture(s, o);
  for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh})
    for (const int threads : {1, 3}) {
      o.accel.kind = kind, o.threads = threads;
      EXPECT_EQ(picture(s, o).pixels, expected.pixels);
    }
}

// A moment of a moving and turning camera equals the picture of a still camera there.
TEST(Motion, AMomentOfTheCameraIsThatCamera) {
  Scene moving = scene("s -1 0 0 1\ns 1.2 0.4 -1 0.8\npl 0 -1 0 1 -1 0 0 -1 -1\n");
  moving.camera.movement = CameraMovement{{4, 2, 8}, {1, 0.5f, -1}, 0, 2};
  moving.camera.lens_radius = 0.05f;
  Scene still = moving;
  RenderOptions o;
  o.channels.add(Channel::depth);
  o.aa = 2;
  for (const float time : {0.0f, 0.7f, 2.0f}) {
    o.shutter = {time, time};
    still.camera = camera_at(moving.camera, time);
    const Image a = picture(moving, o);
    o.shutter = {};
    o.focus = length(moving.camera.at - moving.camera.from);
    const Image b = picture(still, o);
    o.focus = 0;
    size_t apart = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) apart += length(a.pixels[i] - b.pixels[i]) > 0.02f;
    EXPECT_LE(apart, 20u) << "edges, in float and in double";
  }
}

// A camera moving past still objects sees what a still one does when the objects move past.
TEST(Motion, IsTheSameWithInstances) {
  const Scene alone =
      scene("s 0 -1 -2 1.2\ntm -1 0 1 1 0 1 0 1 1  0 1 1 1 2 1 0 2 0 0 3\n" + std::string(kMoving));
  Scene beside = alone, object;  // behind the camera
  object.materials = alone.materials;
  object.spheres.push_back({{0, 0, 0}, 1}), object.sphere_materials.push_back(0);
  beside.prototypes.push_back(object);
  beside.instances.push_back({0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 100}});
  RenderOptions o;
  o.samples = 8, o.soft_shadows = true;
  o.channels.add(Channel::normal), o.channels.add(Channel::position);
  for (const auto kind : {AccelKind::none, AccelKind::bvh}) {
    o.accel.kind = kind;
    EXPECT_TRUE(picture(beside, o).pixels == picture(alone, o).pixels);
  }
}

// A given position stops the scene's camera, even if it is the same.
TEST(Motion, AGivenCameraStandsStill) {
  Scene moving = scene("s 0 0 0 1\n");
  moving.camera.movement = CameraMovement{moving.camera.from + Vec3f(2, 0, 0), {2, 0, 0}, 0, 1};
  RenderOptions o;
  o.from = Vec3d(moving.camera.from);
  const Camera still = resolve_options(o, moving).camera;
  EXPECT_FALSE(still.movement);
  RenderOptions again;
  set_camera(again, still, moving);
  EXPECT_EQ(resolve_options(again, moving).camera, still);
  // And one that fits the width has the angle that is given.
  moving.camera.horizontal_fov_deg = 60, o.fov_deg = moving.camera.fov_deg, o.width = 200,
  o.height = 500;
  again.width = o.width, again.height = o.height;
  const Camera narrow = resolve_options(o, moving).camera;
  set_camera(again, narrow, moving);
  EXPECT_EQ(resolve_options(again, moving).camera, narrow);
}

TEST(Motion, AMovingCameraMatchesAMovingScene) {
  Scene by_camera = scene("s 0 0 0 1\n");
  by_camera.lights.clear();
  by_camera.dialect = Dialect::nff;
  by_camera.camera.movement =
      CameraMovement{by_camera.camera.from + Vec3f(2, 0, 0), {2, 0, 0}, 0, 1};
  Scene by_sphere = by_camera;
  by_sphere.camera.movement.reset();
  by_sphere.spheres = {}, by_sphere.sphere_materials = {};
  by_sphere.moving_spheres.push_back({{0, 0, 0}, {-2, 0, 0}, 1, 0, 1});
  by_sphere.moving_sphere_materials.push_back(0);
  RenderOptions o;
  o.samples = 256;
  o.channels.add(Channel::alpha);
  const Image a = picture(by_camera, o), b = picture(by_sphere, o);
  double worst = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    worst = std::max(worst, double(length(a.pixels[i] - b.pixels[i])));
  EXPECT_LE(worst, 0.02);
}

TEST(Motion, ReadsBack) {
  const Scene s = scene(std::string(kMoving) +
                        "tm 0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1.5 -1 2\n"
                        "bm -1 -1 -1 1 1 1 0 0 0 2 2 3 0 1\nvm 1 0 10 1 0 0 0 3\n");
  ASSERT_EQ(s.moving_triangles.size(), 13u);
  const auto again = parse_nff(write_nff(s), "moving");
  ASSERT_TRUE(again);
  EXPECT_EQ(content_hash(again->scene), content_hash(s));
  EXPECT_EQ(again->scene.camera, s.camera);
  EXPECT_EQ(write_nff(again->scene), write_nff(s));
  const auto binary = decode_raio_scene(encode_raio_scene(s), nullptr);
  ASSERT_TRUE(binary) << binary.error();
  EXPECT_EQ(content_hash(*binary), content_hash(s));
  EXPECT_EQ(binary->camera, s.camera);
}

// A box that moves in name only equals the box.
TEST(Motion, ABoxAtRestIsTheBox) {
  RenderOptions o;
  o.aa = 2;
  const Image a = picture(scene("bm -1 -1 -1 1 1 1 -1 -1 -1 1 1 1 0 1\ns 1 1 1 0.5\n"), o);
  const Image b = picture(scene("box -1 -1 -1 1 1 1\ns 1 1 1 0.5\n"), o);
  size_t apart = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) apart += length(a.pixels[i] - b.pixels[i]) > 0.02f;
  EXPECT_LE(apart, 3u);
}

TEST(Motion, TheShutterNeedsMotion) {
  RenderOptions o;
  o.shutter = {0, 0.5f};
  const Scene still = scene("s 0 0 0 1\n"), moving = scene(kMoving);
  const auto why = option_conflict(o, &still);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->message, "has no effect on a scene without motion; leave it out");
  EXPECT_FALSE(option_conflict(o, &moving));
  EXPECT_EQ(resolve_options({}, moving).shutter_close, 3);
  EXPECT_EQ(
      option_arguments(options_of(resolve_options(o, moving), moving)).find("--shutter 0,0.5") !=
          std::string::npos,
      true);
}

}  // namespace
}  // namespace raio::core
