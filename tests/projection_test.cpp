// Parallel rays: pictures with known closed forms, and that the properties of other pictures still
// hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "data_files.h"
#include "integrate/explain.h"
#include "io/fit_camera.h"
#include "io/pov_write.h"
#include "io/raio/raio.h"
#include "one_picture.h"
#include "render/part.h"
#include "render/turntable.h"
#include "render/warnings.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::expect_one_picture;
using tests::if_sanitized;
using tests::picture_of;
using tests::random_scene;
using tests::same_bytes;

RenderOptions parallel(int width, int height) {
  RenderOptions o;
  o.width = width, o.height = height, o.projection = Projection::orthographic;
  return o;
}

// The axes of a camera, and the size of its picture.
struct SeenFrame {
  Vec3d from, right, up, forward;
  double half_height, half_width;

  SeenFrame(const Camera& c, double width_per_height) : from(c.from) {
    const Vec3d view = Vec3d(c.at) - from;
    forward = normalize(view), right = normalize(cross(forward, Vec3d(c.up)));
    up = cross(right, forward);
    half_height = length(view) * std::tan(double(c.fov_deg) * std::numbers::pi / 360);
    half_width = half_height * width_per_height;
  }
  /// Right, up, and depth.
  Vec3d of(Vec3d p) const {
    p = p - from;
    return {dot(p, right), dot(p, up), dot(p, forward)};
  }
};

Scene ball(Vec3f center, float radius) {
  Scene s;
  s.camera.from = {3, -7, 2}, s.camera.at = {0.5f, 0, 0.3f}, s.camera.up = {0.1f, 0, 1};
  s.camera.fov_deg = 50;
  s.background = {0, 0, 1};
  s.materials = {{Rgb(1, 0, 0), 1, 0, 1, 0, 1}};
  s.spheres = {{center, radius}}, s.sphere_materials = {0};
  return s;
}

// In the middle of a pixel, the square of the distance from the sphere's axis; a pixel is `side`.
struct Around {
  double right, up, square;
};
Around around(const SeenFrame& f, const Vec3d& center, double side, int x, int y) {
  const double right = (x + 0.5) * side - f.half_width - center.x;
  const double up = f.half_height - (y + 0.5) * side - center.y;
  return {right, up, right * right + up * up};
}

// Anywhere, a sphere is a circle of its own radius; its depth and normals follow from x^2 + y^2 +
// z^2 = r^2.
TEST(Parallel, ASphereMatchesItsFormula) {
  const int width = 150, height = 100;
  for (const Vec3f place : {Vec3f(0.5f, 0, 0.3f), Vec3f(1.5f, 3, 1), Vec3f(1, -2.5f, 0.6f)}) {
    const Scene s = ball(place, 1.3f);
    RenderOptions o = parallel(width, height);
    for (const Channel c : {Channel::depth, Channel::normal, Channel::alpha}) o.channels.add(c);
    const RenderSettings settings = resolve_options(o, s);
    const auto accel = build_accel(s, settings.accel);
    const auto film = make_film(s, settings);
    WorkControl control;
    ASSERT_TRUE(render(s, **accel, settings, **film, control).finished);
    const auto depth = std::get<Column<float>>((*film)->resolve(Channel::depth));
    const auto normal = std::get<Column<float>>((*film)->resolve(Channel::normal));
    const SeenFrame f(s.camera, double(width) / height);
    const Vec3d center = f.of(Vec3d(place));
    const double radius = double(1.3f), side = 2 * f.half_height / height;
    int covered = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Around at = around(f, center, side, x, y);
        const double above = radius * radius - at.square;  // the squared height of its surface
        const size_t pixel = size_t(y) * size_t(width) + size_t(x);
        if (std::abs(above) < 1e-4) continue;
        ASSERT_EQ(std::isfinite(depth[pixel]), above > 0) << x << ' ' << y;
        if (above < 0) continue;
        ++covered;
        const double bulge = std::sqrt(above);
        EXPECT_NEAR(double(depth[pixel]), center.z - bulge, 2e-5 / bulge) << x << ' ' << y;
        const Vec3d expected = (f.right * at.right + f.up * at.up - f.forward * bulge) / radius;
        const Vec3d found(normal[3 * pixel], normal[3 * pixel + 1], normal[3 * pixel + 2]);
        EXPECT_LE(length(found - expected), 2e-5 / bulge) << x << ' ' << y;
      }
    const double pixels = std::numbers::pi * radius * radius / (side * side);
    EXPECT_NEAR(covered, pixels, 0.01 * pixels);
  }
}

TEST(Parallel, EveryIntegratorShowsTheSameOutline) {
  const int side = 90;
  const Scene s = ball({1.5f, 3, 1}, 1.3f);
  const SeenFrame f(s.camera, 1);
  const Vec3d center = f.of(Vec3d(1.5, 3, 1));
  for (const auto kind :
       {IntegratorKind::classic, IntegratorKind::views, IntegratorKind::ambient}) {
    RenderOptions o = parallel(side, side);
    o.integrator = kind, o.aa = 1;
    const Image picture = picture_of(s, o);
    const Rgb nothing = kind == IntegratorKind::views ? Rgb() : s.background;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double off =
            around(f, center, 2 * f.half_height / side, x, y).square - double(1.3f) * double(1.3f);
        if (std::abs(off) > 1e-4) {
          EXPECT_EQ(picture.at(x, y) != nothing, off < 0) << int(kind) << ' ' << x << ' ' << y;
        }
      }
  }
}

// Points at the distance of the point looked at are where they are in perspective.
TEST(Parallel, MatchesPerspectiveAtThePointLookedAt) {
  Camera c = ball({}, 1).camera;
  for (const bool centers : {false, true}) {
    c.projection = Projection::perspective;
    const EyeRays cone(c, 40, 30, centers);
    c.projection = Projection::orthographic;
    const EyeRays rays(c, 40, 30, centers);
    const SeenFrame f(c, 4.0 / 3);
    const double distance = length(Vec3d(c.at) - Vec3d(c.from));
    for (const auto& [x, y] : {std::pair(0.0f, 0.0f), {40, 30}, {20, 15}, {3.5f, 29.5f}}) {
      const Ray a = cone.pinhole(x, y), b = rays.pinhole(x, y);
      const Vec3d seen = Vec3d(a.dir) * (distance / dot(Vec3d(a.dir), f.forward));
      EXPECT_LE(length(f.of(Vec3d(a.origin) + seen) - f.of(Vec3d(b.origin) + f.forward * distance)),
                1e-5);
      EXPECT_EQ(b.dir, rays.forward);
      EXPECT_NEAR(f.of(Vec3d(b.origin)).z, 0, 1e-6) << "from the plane of the eye";
    }
  }
}

TEST(Parallel, AllStructuresMakeOnePicture) {
  constexpr int kWidth = if_sanitized(32, 64), kHeight = if_sanitized(24, 48);
  Scene s = random_scene(150, 4);
  RenderOptions o = parallel(kWidth, kHeight);
  o.aa = 2, o.lens_samples = 2, o.soft_shadows = true, o.gloss = 0.1f;
  EXPECT_GT(expect_one_picture(s, o).at(kWidth / 2, kHeight / 2).x, 0);
  // Rays along an axis have directions with zeros.
  for (const auto& [from, up] : {std::pair(Vec3d(0, 0, 5), Vec3d(0, 1, 0)),
                                 {Vec3d(-5, 0, 0), Vec3d(0, 0, 1)},
                                 {Vec3d(0, 5, 0), Vec3d(1, 0, 0)}}) {
    o.from = from, o.at = Vec3d(), o.up = up;
    expect_one_picture(s, o);
  }
  o = parallel(kWidth, kHeight);
  o.integrator = IntegratorKind::ambient;
  o.samples = 4, o.outline = 2, o.depth_cue = 0.5f, o.shadow_catcher = true;
  expect_one_picture(s, o);
  for (const View view : {View::normals, View::depth, View::ids, View::materials, View::focus}) {
    o = parallel(kWidth, kHeight);
    o.view = view;
    expect_one_picture(s, o);
  }
}

// Of a line on the outline, each side is equally wide at any depth.
TEST(Parallel, OutlinesAreAsWideAtAnyDepth) {
  const int side = 200;
  const auto line_pixels = [&](float depth) {
    Scene s = ball({}, 1);
    s.camera = {};
    s.camera.from = {0, 0, 10}, s.camera.at = {0, 0, 0};
    s.camera.projection = Projection::orthographic;
    s.spheres[0].center.z = depth, s.background = Rgb(1);
    RenderOptions o;
    o.width = o.height = side;
    o.integrator = IntegratorKind::ambient, o.aa = 1;
    o.key_light = KeyLight::off, o.outline = 3;
    const Image picture = picture_of(s, o);
    return std::ranges::count(picture.pixels, Rgb());
  };
  const double pixel = 20 * std::tan(45 * std::numbers::pi / 360) / side;
  const double ring = 2 * std::numbers::pi * (1 - 1.5 * pixel) * 3 / pixel;
  for (const float depth : {-30.0f, 0.0f, 8.0f})
    EXPECT_NEAR(double(line_pixels(depth)), ring, 0.05 * ring);
}

TEST(Parallel, AMovingCameraMatchesStillOnes) {
  Scene s = random_scene(60, 8);
  Camera& c = s.camera;
  c.projection = Projection::orthographic;
  c.movement = CameraMovement{{1, -7, 2}, {0.2f, 0.1f, 0}, 0, 1};
  RenderOptions o;
  o.width = 60, o.height = 45, o.view = View::normals;  // those of depth start at the nearest
  for (const float time : {0.0f, 0.4f, 1.0f}) {
    o.shutter = {time, time};
    const Image moving = picture_of(s, o);
    Scene still = s;
    still.camera = camera_at(c, time);
    RenderOptions without = o;
    without.shutter.reset();
    const Image standing = picture_of(still, without);
    int apart = 0;  // except for edges
    for (size_t i = 0; i < moving.pixels.size(); ++i)
      apart += length(moving.pixels[i] - standing.pixels[i]) > 1e-4f;
    EXPECT_LE(apart, 8) << time;
  }
  o.shutter.reset(), o.view = View::picture, o.aa = 2;
  expect_one_picture(s, o);
}

TEST(Parallel, SamplesAreExplainedToTheLastBit) {
  const Scene s = random_scene(60, 3);
  RenderOptions o = parallel(40, 30);
  o.soft_shadows = true;
  const RenderSettings settings = resolve_options(o, s);
  const auto accel = build_accel(s, settings.accel);
  const Image picture = picture_of(s, o);
  for (int y = 1; y < 30; y += 4)
    for (int x = 1; x < 40; x += 5) {
      const auto told = explain_sample(s, **accel, settings, x, y, 0);
      ASSERT_TRUE(told);
      EXPECT_EQ(Rgb(told->rgb), picture.at(x, y)) << x << ' ' << y;
      EXPECT_EQ(told->rays[0].ray.dir, EyeRays(settings.camera, 40, 30).forward);
    }
}

// The settings that pictures store give the camera back, whatever would be fitted to the scene.
TEST(Parallel, PicturesAndPartsKnowTheirRays) {
  const Scene water = core::read(kWater, "water.xyz")->scene, balls = random_scene(20, 1);
  for (const Scene* s : {&water, &balls}) {
    RenderOptions o = parallel(64, 40);
    const RenderSettings first = resolve_options(o, *s);
    set_camera(o, turntable_camera(first.camera, 1, 5), *s);
    RenderOptions own = parallel(64, 40);
    own.from = s->origin + Vec3d(s->camera.from), own.at = s->origin + Vec3d(s->camera.at);
    for (const RenderOptions& asked : {parallel(64, 40), o, own}) {
      const RenderSettings settings = resolve_options(asked, *s);
      const Metadata stored = settings_of(*s, settings);
      EXPECT_EQ(setting(stored, "projection"), "orthographic");
      const auto again = options_from(stored);
      ASSERT_TRUE(again) << again.error().text();
      Camera camera = resolve_options(*again, *s).camera;
      camera.horizontal_fov_deg =
          settings.camera.horizontal_fov_deg;  // of no effect where an angle is given
      EXPECT_EQ(camera, settings.camera);
      EXPECT_EQ(settings_of(*s, resolve_options(*again, *s)), stored);
    }
    EXPECT_EQ(setting(settings_of(*s, resolve_options({}, *s)), "projection"), "");
    EXPECT_THAT(difference(settings_of(*s, first), settings_of(*s, resolve_options({}, *s))),
                HasSubstr("`projection` orthographic, not without it"));
  }
}

TEST(Parallel, PartsMakeTheWholePicture) {
  const Scene s = random_scene(40, 6);
  RenderOptions o = parallel(150, 100);
  o.aa = 2;
  const RenderSettings settings = resolve_options(o, s);
  const auto accel = build_accel(s, settings.accel);
  const auto part = [&](uint32_t shard) {
    Part out{{settings_of(s, settings), shard, 3}, std::move(*make_film(s, settings))};
    WorkControl control;
    EXPECT_TRUE(
        render(s, **accel, settings, *out.film, control, {.shard = shard, .shards = 3}).finished);
    return out;
  };
  std::vector<NamedPart> parts;
  for (uint32_t i = 0; i < 3; ++i) parts.push_back({"part", part(i)});
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged) << merged.error().text();
  EXPECT_TRUE(same_bytes(merged->film->resolve(), picture_of(s, o)));
  // A crop is the same pixels.
  o.crop = Crop{30, 20, 90, 70};
  const Image crop = picture_of(s, o), whole = merged->film->resolve();
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 60; ++x) ASSERT_EQ(crop.at(x, y), whole.at(x + 30, y + 20));
}

TEST(Parallel, CamerasFittedToDataShowAllOfItAndNoMore) {
  std::string text = "40\n\n";
  std::mt19937 rng(7);
  for (int i = 0; i < 40; ++i)
    text += fmt::format("C {} {} {}\n", rng() % 17, rng() % 11, rng() % 23);
  const Scene s = core::read(text, "cloud.xyz", {.style = AtomStyle::space_filling})->scene;
  for (const auto& [width, height] : {std::pair(400, 300), {300, 900}, {900, 200}}) {
    const Camera c = resolve_options(parallel(width, height), s).camera;
    EXPECT_TRUE(c.is_parallel());
    const SeenFrame f(c, double(width) / height);
    double left = 1e30, right = -left, low = left, high = -left, nearest = left;
    for (const Sphere& sphere : s.spheres) {
      const Vec3d at = f.of(Vec3d(sphere.center));
      const double r = double(sphere.radius);
      left = std::min(left, at.x - r), right = std::max(right, at.x + r);
      low = std::min(low, at.y - r), high = std::max(high, at.y + r);
      nearest = std::min(nearest, at.z - r);
    }
    EXPECT_GT(nearest, 0) << "nothing is behind the plane of the eye";
    // In the middle, with a margin of 6 % on two sides.
    EXPECT_NEAR(left + right, 0, 1e-4);
    EXPECT_NEAR(low + high, 0, 1e-4);
    EXPECT_NEAR(std::max(right / f.half_width, high / f.half_height), 1 / 1.06, 1e-4);
  }
  // A given position is kept, and so is an angle.
  RenderOptions o = parallel(400, 300);
  o.from = Vec3d(40, 0, 5);
  EXPECT_EQ(resolve_options(o, s).camera.at, s.camera.at);
  o = parallel(400, 300), o.fov_deg = 3;
  EXPECT_EQ(resolve_options(o, s).camera.fov_deg, 3);
}

TEST(Parallel, RaysHaveNoLens) {
  Scene s = random_scene(5, 1);
  const auto refused = [&](auto change) {
    RenderOptions o = parallel(40, 30);
    change(o);
    const auto why = option_conflict(o, &s), without_scene = option_conflict(o);
    EXPECT_TRUE(why && without_scene && why->message == without_scene->message);
    return why ? why->subject + ": " + why->message : "";
  };
  EXPECT_THAT(refused([](RenderOptions& o) { o.dof = true; }),
              HasSubstr("dof: a lens needs `projection` perspective"));
  EXPECT_THAT(refused([](RenderOptions& o) { o.aperture = 1; }), HasSubstr("aperture: a lens"));
  EXPECT_THAT(refused([](RenderOptions& o) { o.focus = 1; }), HasSubstr("focus: a lens"));
  // The scene's is dropped with a warning.
  const Image sharp = picture_of(s, parallel(40, 30));
  s.camera.lens_radius = 0.5f;
  EXPECT_FALSE(option_conflict(parallel(40, 30), &s));
  const RenderSettings settings = resolve_options(parallel(40, 30), s);
  EXPECT_FALSE(settings.dof);
  EXPECT_TRUE(same_bytes(picture_of(s, parallel(40, 30)), sharp));
  const auto warnings = scene_warnings(s, settings, nullptr);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0].sentence, HasSubstr("lens has no effect on parallel rays"));
  EXPECT_TRUE(scene_warnings(s, resolve_options({}, s), nullptr).empty());
  // Its own rays count as those of an option.
  s.camera.projection = Projection::orthographic;
  RenderOptions o;
  o.dof = true;
  EXPECT_TRUE(option_conflict(o, &s));
  o.projection = Projection::perspective;
  EXPECT_FALSE(option_conflict(o, &s));
  EXPECT_TRUE(resolve_options(o, s).dof);
}

TEST(Parallel, ScenesKeepTheirRays) {
  Scene s = random_scene(5, 1);
  const std::string hash = content_hash(s), bytes = encode_raio_scene(s);
  s.camera.projection = Projection::orthographic;
  EXPECT_NE(content_hash(s), hash);
  EXPECT_THAT(validate(s), testing::IsEmpty());
  const std::string stored = encode_raio_scene(s);
  const auto again = decode_raio_scene(stored, nullptr);
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->camera, s.camera);
  EXPECT_EQ(encode_raio_scene(*again), stored);
  EXPECT_THAT(bytes, testing::Not(HasSubstr("camera_projection"))) << "files are as they were";
  EXPECT_EQ(lost_features(s, SceneFormat::nff), "the camera's parallel rays");
  EXPECT_EQ(lost_features(s, SceneFormat::pov), "");
  s.camera.projection = Projection(3);
  EXPECT_THAT(validate(s), testing::ElementsAre(HasSubstr("projection")));
}

// The lengths of `right` and `up` are those of POV-Ray's picture.
TEST(Parallel, PovRayGetsThePictureSize) {
  Scene s = ball({}, 1);
  s.camera = {};
  s.camera.from = {0, -4, 0}, s.camera.at = {0, 0, 0}, s.camera.up = {0, 0, 1};
  s.camera.fov_deg = float(std::atan(0.5) * 360 / std::numbers::pi);
  s.camera.projection = Projection::orthographic;
  const std::string pov = write_pov(s, {.width = 300, .height = 200});
  EXPECT_THAT(pov, HasSubstr("camera { orthographic location <0, -4, 0>"));
  const auto vector = [&](const std::string& name) {
    Vec3d v;
    const size_t at = pov.find(name + " <");
    EXPECT_EQ(std::sscanf(pov.c_str() + at + name.size(), " <%lf, %lf, %lf>", &v.x, &v.y, &v.z), 3);
    return v;
  };
  EXPECT_LE(length(vector("right") - Vec3d(6, 0, 0)), 1e-5);
  EXPECT_LE(length(vector(" up") - Vec3d(0, 0, 4)), 1e-5);
  EXPECT_LE(length(vector("direction") - Vec3d(0, 1, 0)), 1e-6);
}

}  // namespace
}  // namespace raio::core
