// Pictures: the classic shading against closed forms, and invariants of pictures.
#include "render/render.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <thread>

#include "integrate/camera-inl.h"
#include "io/nff/nff.h"
#include "one_picture.h"
#include "render/options.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::if_sanitized;
using tests::random_scene;
using tests::same_bytes;

struct Rendered {
  Image image;
  RayCounts rays;
};

Rendered picture(const Scene& scene, RenderOptions options) {
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel, settings.one_sided);
  EXPECT_TRUE(accel.has_value());
  WorkControl control;
  const auto film = make_film(scene, settings);
  EXPECT_TRUE(film.has_value());
  EXPECT_TRUE(render(scene, **accel, settings, **film, control).finished);
  return {(*film)->resolve(), (*film)->rays()};
}

RenderOptions small(AccelKind kind = AccelKind::grid, int side = 64) {
  RenderOptions o;
  o.accel.kind = kind;
  o.width = o.height = side;
  return o;
}

RenderOptions all_effects(AccelKind kind = AccelKind::grid, int side = 64) {
  RenderOptions o = small(kind, side);
  o.aa = 2, o.lens_samples = 2, o.soft_shadows = true, o.dof = true;
  return o;
}

Scene looking_down(float height = 5) {
  Scene s;
  s.camera.from = {0, 0, height};
  s.camera.at = {0, 0, 0};
  s.camera.up = {0, 1, 0};
  s.camera.fov_deg = 60;
  s.background = {0.2f, 0.3f, 0.5f};
  return s;
}

void add_plane(Scene& s, Plane plane, const Material& material) {
  s.planes.push_back(plane);
  s.plane_materials.push_back(MaterialId(s.materials.size()));
  s.materials.push_back(material);
}

// The point of the plane z = 0 at pixel (x, y) of `looking_down`, and the direction to it.
struct View {
  Vec3d point, dir;
};
View view(const Scene& s, int x, int y, int side) {
  const double half = std::tan(s.camera.fov_deg * std::numbers::pi / 360);
  const Vec3d towards{(2 * (x + 0.5) / side - 1) * half, (1 - 2 * (y + 0.5) / side) * half, -1};
  return {Vec3d(s.camera.from) + towards * double(s.camera.from.z), normalize(towards)};
}

TEST(Shading, PhongOnAPlaneIsTheFormula) {
  Scene s = looking_down();
  const Material m{{0.8f, 0.6f, 0.4f}, 0.7f, 0.3f, 12, 0, 1};
  add_plane(s, {{0, 0, 0}, {0, 0, 1}}, m);
  s.lights = {{{1, 2, 3}, std::nullopt}, {{-2, 1, 4}, std::nullopt}};
  const Image image = picture(s, small()).image;
  for (const auto& [x, y] : {std::pair(0, 0), {20, 31}, {40, 12}, {63, 63}}) {
    const auto [p, d] = view(s, x, y, 64);
    Vec3d expected = Vec3d(m.color) * 0.1;
    for (const Light& light : s.lights) {
      const Vec3d l = normalize(Vec3d(light.position) - p);
      const Vec3d r{-l.x, -l.y, l.z};
      const double highlight = std::pow(std::max(0.0, -dot(r, d)), double(m.shine));
      expected += (Vec3d(m.color) * double(m.kd) * l.z + Vec3d(m.ks * highlight)) / std::sqrt(2.0);
    }
    expected += Vec3d(s.background) * double(m.ks);  // the mirror shows the sky
    EXPECT_NEAR(image.at(x, y).x, expected.x, 2e-6);
    EXPECT_NEAR(image.at(x, y).y, expected.y, 2e-6);
    EXPECT_NEAR(image.at(x, y).z, expected.z, 2e-6);
  }
}

TEST(Shading, ColouredLightsRemoveAmbientLight) {
  Scene s = looking_down();
  add_plane(s, {{0, 0, 0}, {0, 0, 1}}, {{1, 1, 1}, 1, 0, 1, 0, 1});
  s.lights = {{{0, 0, -1}, Rgb(1, 1, 1)}};  // behind the plane
  EXPECT_EQ(picture(s, small()).image.at(9, 9), Rgb(0.0f));
  s.lights[0].color.reset();
  EXPECT_NEAR(picture(s, small()).image.at(9, 9).x, 0.1f, 1e-6);
}

TEST(Shading, LevelsBelowTheLastAreBackground) {
  // Two facing mirrors: each level adds its weight in background only after the last.
  Scene s = looking_down();
  s.background = {1, 1, 1};
  add_plane(s, {{0, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, 0, 0.5f, 1, 0, 1});
  add_plane(s, {{0, 0, 6}, {0, 0, -1}}, {{0, 0, 0}, 0, 0.5f, 1, 0, 1});
  for (const int depth : {1, 2, 5, 20}) {
    RenderOptions o = small(AccelKind::none, 16);
    o.depth = depth;
    const Rendered p = picture(s, o);
    EXPECT_NEAR(p.image.at(8, 8).x, std::pow(0.5, depth), 1e-6) << depth;
    EXPECT_EQ(p.rays.reflection, 256u * unsigned(depth - 1));
  }
}

// A slab of glass over a floor with a light between: the floor's brightness shows where the ray
// exits.
TEST(Shading, RefractionThroughASlabFollowsSnell) {
  Scene s = looking_down(4);
  s.background = {};
  const float ior = 1.5f, transmission = 0.9f;
  const Material glass{{0, 0, 0}, 0, 0, 1, transmission, ior};
  add_plane(s, {{0, 0, 2}, {0, 0, 1}}, glass);
  add_plane(s, {{0, 0, 1}, {0, 0, -1}}, glass);
  add_plane(s, {{0, 0, 0}, {0, 0, 1}}, {{1, 1, 1}, 1, 0, 1, 0, 1});
  s.lights = {{{0.3f, 0.2f, 0.5f}, Rgb(1, 1, 1)}};
  const Image image = picture(s, small()).image;
  for (const auto& [x, y] : {std::pair(3, 5), {30, 20}, {60, 33}}) {
    const Vec3d d = view(s, x, y, 64).dir;
    const double sine = std::hypot(d.x, d.y), inside = sine / ior;
    const double reach = 2 * sine / std::sqrt(1 - sine * sine) +
                         1 * sine / std::sqrt(1 - sine * sine) +
                         1 * inside / std::sqrt(1 - inside * inside);
    const Vec3d p{d.x / sine * reach, d.y / sine * reach, 0};
    const Vec3d l = normalize(Vec3d(s.lights[0].position) - p);
    EXPECT_NEAR(image.at(x, y).x, transmission * transmission * l.z, 1e-5) << x << " " << y;
  }
}

TEST(Shading, BeyondTheCriticalAngleNothingLeavesTheGlass) {
  Scene s = looking_down(1);
  s.background = {1, 1, 1};
  add_plane(s, {{0, 0, 0}, {0, 0, -1}}, {{0, 0, 0}, 0, 0, 1, 1, 1.5f});  // we are in the glass
  s.camera.fov_deg = 120;
  const int side = 65;
  const Image image = picture(s, small(AccelKind::none, side)).image;
  const double critical = std::asin(1 / 1.5);
  for (int x = 0; x < side; ++x) {
    const Vec3d d = view(s, x, side / 2, side).dir;
    const double angle = std::acos(-d.z);
    if (std::abs(angle - critical) < 1e-3) continue;
    EXPECT_EQ(image.at(x, side / 2).x, angle < critical ? 1.0f : 0.0f) << x;
  }
}

TEST(Shading, SoftShadowsHaveGeometricPenumbras) {
  // A square light of side 1 straight above an edge halfway up: at x the visible fraction is linear
  // from x = -0.5 to 0.5. The light faces the origin, so it is horizontal.
  Scene s = looking_down(3);
  s.camera.from = {0.001f, 0, 3};  // next to the light's edge
  s.camera.fov_deg = 45;
  add_plane(s, {{0, 0, 0}, {0, 0, 1}}, {{1, 1, 1}, 1, 0, 1, 0, 1});
  for (const Vec3f p : {Vec3f(0, -50, 1), {50, -50, 1}, {50, 50, 1}, {0, 50, 1}})
    s.positions.push_back(p);
  s.polygons = {{0, 4}};
  s.polygon_materials = {0};
  s.camera.from = {-3, 0, 0.9f};  // below the edge
  s.camera.at = {0, 0, 0};
  s.camera.up = {0, 0, 1};
  s.lights = {{{0, 0, 2}, Rgb(1, 1, 1)}};
  RenderOptions o = small(AccelKind::none, 32);
  o.soft_shadows = true, o.light_size = 1, o.aa = 16;
  const Image soft = picture(s, o).image;
  o.soft_shadows = false;
  const Image hard = picture(s, o).image;
  // Along the middle column the floor passes from light (left of the edge) into shadow.
  int between = 0;
  for (int y = 0; y < 32; ++y) {
    EXPECT_GE(soft.at(16, y).x, 0.0f);
    between += soft.at(16, y).x > 0.02f && soft.at(16, y).x < 0.98f * hard.at(16, 31).x &&
               std::abs(soft.at(16, y).x - hard.at(16, y).x) > 0.02f;
  }
  EXPECT_GE(between, 3);
}

TEST(Camera, RaysThroughTheLensMeetInTheFocusPlane) {
  Camera camera;
  camera.from = {1, 2, 3}, camera.at = {-2, 1, 0.5f}, camera.up = {0, 0.1f, 1};
  const EyeRays eye(camera, 80, 60);
  const Vec3f forward = normalize(camera.at - camera.from);
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::ScalableTag<float> d;
  using Place = std::array<float, 2>;
  for (const auto& [x, y] : {Place{3, 50}, {40, 30}, {79.5f, 0.5f}}) {
    const Ray centre = eye.pinhole(x, y);
    const Vec3f focus = centre.at(7 / dot(centre.dir, forward));
    for (const auto& [u, v] : {Place{1, 0}, {-0.5f, 0.5f}, {0, -1}}) {
      const auto wide =
          HWY_NAMESPACE::thin_lens(d, HWY_NAMESPACE::eye_at_rest(d, eye), hn::Set(d, x),
                                   hn::Set(d, y), {hn::Set(d, u), hn::Set(d, v)}, 0.3f, 7);
      const auto first = [](const auto& w) {
        return Vec3f(hn::GetLane(w.x), hn::GetLane(w.y), hn::GetLane(w.z));
      };
      const Ray ray{first(wide.origin), first(wide.dir)};
      const Vec3f met = ray.at(7 / dot(ray.dir, forward) -
                               dot(ray.origin - camera.from, forward) / dot(ray.dir, forward));
      EXPECT_LT(length(met - focus), 1e-5f);
      EXPECT_NEAR(length(ray.origin - camera.from), 0.3f * std::hypot(u, v), 1e-6f);
    }
  }
}

TEST(Camera, TheAngleIsVerticalFromEdgeToEdge) {
  Camera camera;
  camera.from = {0, 0, 0}, camera.at = {0, 0, -1}, camera.up = {0, 1, 0}, camera.fov_deg = 50;
  const EyeRays eye(camera, 200, 100);
  const Vec3f top = eye.pinhole(100, 0).dir, left = eye.pinhole(0, 50).dir;
  EXPECT_NEAR(std::atan2(top.y, -top.z) * 180 / std::numbers::pi, 25, 1e-4);
  EXPECT_NEAR(-left.x / -left.z, 2 * std::tan(25 * std::numbers::pi / 180), 1e-5);
  EXPECT_GT(eye.pinhole(199, 50).dir.x, 0);
}

TEST(Render, AnyNumberOfThreadsGivesTheSameBytes) {
  const Scene s = random_scene(300, 5);
  RenderOptions o = all_effects();
  o.width = 100, o.height = 70;
  o.threads = 1;
  const Rendered one = picture(s, o);
  for (const int threads : {2, 3, 7, 16}) {
    o.threads = threads;
    const Rendered many = picture(s, o);
    EXPECT_TRUE(same_bytes(one.image, many.image)) << threads;
    EXPECT_EQ(one.rays.total(), many.rays.total());
  }
  o.seed = 1;
  EXPECT_FALSE(same_bytes(one.image, picture(s, o).image));
}

TEST(Render, StructuresGiveTheSamePicture) {
  for (const bool one_sided : {false, true}) {
    const Scene s = random_scene(if_sanitized(100, 300), 6);
    RenderOptions o = all_effects(AccelKind::none);
    o.one_sided = one_sided;
    const Image none = picture(s, o).image;
    o.accel.kind = AccelKind::grid;
    EXPECT_TRUE(same_bytes(none, picture(s, o).image));
    o.accel.kind = AccelKind::bvh;
    EXPECT_TRUE(same_bytes(none, picture(s, o).image));
    o.accel.kind = AccelKind::embree;
    EXPECT_LE(compare(none, picture(s, o).image).above_8, 0.001);
  }
}

// Nothing in the program has an absolute unit: with all lengths doubled, repeatedly, every float
// has another exponent and the same digits.
TEST(Render, ScaleDoesNotMatterToTheLastBit) {
  const Image image = picture(random_scene(300, 8), all_effects()).image;
  for (const float scale : {0x1p-20f, 0x1p20f})
    for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh})
      EXPECT_TRUE(same_bytes(image, picture(random_scene(300, 8, scale), all_effects(kind)).image))
          << scale;
}

TEST(Render, PicturesSurviveDistanceFromTheOrigin) {
  const Image image = picture(random_scene(300, 8), small()).image;
  const Image moved = picture(random_scene(300, 8, 1, {100, -200, 50}), small()).image;
  // The scene moves by the rounding of its coordinates, 1e-5 of its size; readers do better, by
  // storing coordinates relative to Scene::origin.
  EXPECT_LE(compare(image, moved).above_8, 0.02);
}

TEST(Render, P3dScenesAreTheSameWithEveryStructure) {
  const auto paths = tests::shared_scenes();
  if (paths.empty()) GTEST_SKIP() << "the shared scenes are not here";
  for (const auto& path : paths) {
    if (path.parent_path().filename() != "p3d") continue;
    const auto read = read_nff(path);
    ASSERT_TRUE(read.has_value());
    const bool large = read->scene.primitive_count() > 5000;
    constexpr int kLarge = if_sanitized(8, 48), kSmall = if_sanitized(16, 64);
    RenderOptions o = large ? small(AccelKind::none, kLarge) : all_effects(AccelKind::none, kSmall);
    const Image none = picture(read->scene, o).image;
    o.accel.kind = AccelKind::grid;
    const Image grid = picture(read->scene, o).image;
    o.accel.kind = AccelKind::embree;
    const Image embree = picture(read->scene, o).image;
    o.accel.kind = AccelKind::bvh;
    const Image tree = picture(read->scene, o).image;
    EXPECT_EQ(compare(none, grid).largest, 0) << path;
    EXPECT_EQ(compare(none, tree).largest, 0) << path;
    EXPECT_LE(compare(none, embree).above_8, 0.001) << path;
  }
}

TEST(Render, CountsOfBallsMatchThePublishedOnes) {
  const auto path = std::filesystem::path(RAIO_SOURCE_DIR) / "../shared/scenes/spd/balls.nff";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "the shared scenes are not here";
  const auto read = read_nff(path);
  ASSERT_TRUE(read.has_value());
  const RayCounts rays = picture(read->scene, small(AccelKind::grid, 512)).rays;
  // Haines 1987 and Havran 1999; 513 x 513 rays there, 512 x 512 here.
  EXPECT_NEAR(double(rays.eye_hits), 263169, 0.03 * 263169);
  EXPECT_GT(double(rays.reflection), 0.97 * 175095);
  EXPECT_LT(double(rays.reflection), 1.03 * 179884);
  EXPECT_GT(double(rays.shadow), 0.97 * 954368);
  EXPECT_LT(double(rays.shadow), 1.03 * 959244);
}

TEST(Render, StopsSoon) {
  const Scene s = random_scene(20000, 5);
  RenderSettings o = resolve_options(all_effects(AccelKind::none, 2000), s);
  o.aa = 16;
  const auto accel = build_accel(s, o.accel);
  WorkControl control;
  std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    control.stop = true;
  });
  const auto film = make_film(s, o);
  ASSERT_TRUE(film.has_value());
  EXPECT_FALSE(render(s, **accel, o, **film, control).finished);
}

// Passes, parts and interruptions, in one film, against the picture rendered at once.
TEST(Render, AFilmIsResumedToTheSameBytes) {
  const Scene s = random_scene(60, 5);
  RenderOptions request = all_effects(AccelKind::automatic, 100);
  for (const bool sobol : {false, true}) {
    if (sobol) request.aa = request.lens_samples = 0, request.samples = 11;
    const Rendered whole = picture(s, request);
    const RenderSettings o = resolve_options(request, s);
    const auto accel = build_accel(s, o.accel);
    const auto film = make_film(s, o);
    WorkControl control;
    const auto part = [&](const RenderTask& task) {
      EXPECT_TRUE(render(s, **accel, o, **film, control, task).finished);
    };
    part({.samples = 3, .shard = 1, .shards = 3});
    control.stop = true;
    EXPECT_FALSE(render(s, **accel, o, **film, control).finished);
    control.stop = false;
    EXPECT_FALSE(same_bytes(whole.image, (*film)->resolve()));
    part({.samples = 1});
    part({.samples = 8, .shard = 0, .shards = 2});
    part({});
    EXPECT_TRUE(same_bytes(whole.image, (*film)->resolve()));
    EXPECT_EQ(whole.rays.total(), (*film)->rays().total());
    part({});  // nothing is left to do
    EXPECT_EQ(whole.rays.total(), (*film)->rays().total());
  }
}

TEST(Render, SobolSamplesAreTheFirstOfMore) {
  const Scene s = random_scene(60, 6);
  RenderOptions request = small(AccelKind::automatic, 40);
  request.soft_shadows = true, request.dof = true;
  request.samples = 5;
  const Rendered few = picture(s, request);
  RenderSettings more = resolve_options(request, s);
  more.samples = 50;
  const auto accel = build_accel(s, more.accel);
  const auto film = make_film(s, more);
  WorkControl control;
  render(s, **accel, more, **film, control, {.samples = 5});
  EXPECT_TRUE(same_bytes(few.image, (*film)->resolve()));
}

TEST(Render, DeepTreesOfGlassStayInBounds) {
  // Every hit has two children: 2^14 rays a pixel at the last level.
  Scene s = looking_down();
  const Material glass{{0.2f, 0.2f, 0.2f}, 0.1f, 0.5f, 10, 0.5f, 1.4f};
  s.materials = {glass};
  std::mt19937 rng(3);
  for (int i = 0; i < 40; ++i) {
    s.spheres.push_back(
        {{float(rng() % 100) / 25 - 2, float(rng() % 100) / 25 - 2, float(i % 5) - 2}, 0.5f});
    s.sphere_materials.push_back(0);
  }
  s.lights = {{{2, 3, 9}, std::nullopt}};
  RenderOptions o = small(AccelKind::grid, 8);
  o.depth = 15;
  const Rendered p = picture(s, o);
  EXPECT_GT(p.rays.refraction, 10000u);
  for (const Rgb& c : p.image.pixels) EXPECT_TRUE(is_finite(c));
}

TEST(Render, APictureBeyondMemoryIsRefused) {
  const Scene s = random_scene(4, 1);
  RenderSettings o = resolve_options(small(), s);
  o.width = 60000, o.height = 60000;
  const auto film = make_film(s, o);
  ASSERT_FALSE(film.has_value());
  EXPECT_NE(film.error().message.find("60000x60000"), std::string::npos);
}

void add(Film& film, Rgb rgb) {
  const Vec3d v = Vec3d(rgb) * film.scale();
  std::vector<PixelSums> sums(film.tile_sums());
  sums[0] = {{std::llrint(v.x), std::llrint(v.y), std::llrint(v.z)}};
  const uint32_t sample = film.samples(0).end();
  film.add(0, SampleSpan{sample, sample + 1}, {sums.data()}, {});
}

TEST(Film, SumsDoNotDependOnOrder) {
  std::mt19937 rng(1);
  std::vector<Rgb> values;
  for (int i = 0; i < 1000; ++i) values.push_back({float(rng()) * 1e-9f, float(rng() % 7), 1e-7f});
  Film forward(1, 1, 10), backward(1, 1, 10);
  for (const Rgb& v : values) add(forward, v);
  for (size_t i = values.size(); i-- > 0;) add(backward, values[i]);
  EXPECT_EQ(forward.samples(0), SampleSet({0, 1000}));
  EXPECT_TRUE(same_bytes(forward.resolve(), backward.resolve()));
}

// The variance of the samples' colours agrees with the means of more and more samples, also if a
// film with one sample is resumed.
TEST(Film, VarianceIsThatOfTheSamples) {
  const Scene scene = random_scene(30, 5);
  RenderOptions options = small();
  options.samples = 4;
  options.channels.add(Channel::variance);
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  ASSERT_TRUE(accel);
  WorkControl control;
  const auto one_by_one = make_film(scene, settings), at_once = make_film(scene, settings);
  std::vector<Image> means;
  for (uint32_t n = 1; n <= 4; ++n) {
    ASSERT_TRUE(render(scene, **accel, settings, **one_by_one, control, {.samples = n}).finished);
    means.push_back((*one_by_one)->resolve());
  }
  ASSERT_TRUE(render(scene, **accel, settings, **at_once, control, {.samples = 4}).finished);
  const auto values = [](const Film& film) {
    return std::get<Column<float>>(film.resolve(Channel::variance));
  };
  const Column<float> variance = values(**at_once);
  EXPECT_EQ(values(**one_by_one), variance);
  double most = 0;
  for (size_t i = 0; i < means[3].pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double mean = double(means[3].pixels[i][c]);
      double sum = 0, before = 0;
      for (size_t n = 1; n <= 4; ++n) {
        const double all = double(n) * double(means[n - 1].pixels[i][c]);
        sum += std::pow(all - before - mean, 2);
        before = all;
      }
      EXPECT_NEAR(double(variance[3 * i + size_t(c)]), sum / 3, 1e-5);
      most = std::max(most, sum / 3);
    }
  EXPECT_GT(most, 0.01);
}

// Random samples of a dim, a bright and a middling component of one film: the estimates of 100
// films of 64 samples each, against the variance of all these samples.
TEST(Film, VarianceIsRightForDimAndBright) {
  constexpr int kSeeds = 100, kSamples = 64;
  constexpr double kValues[] = {1e-4, 1e5, 1};
  ChannelSet channels;
  channels.add(Channel::variance);
  double said[3] = {}, sum[3] = {}, squares[3] = {};
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 rng(seed);
    Film film(1, 1, 2e5, kTileSide, channels);
    for (uint32_t k = 0; k < kSamples; ++k) {
      TileSamples sample;
      sample.samples = SampleSpan{k, k + 1};
      for (int c = 0; c < 3; ++c) {
        const double value = kValues[c] * (0.5 + 1e-9 * double(rng() % 1000000000));
        const auto fixed = std::llrint(value * film.scale());
        sample.sums.push_back(fixed);
        sample.squares.push_back(Uint128(fixed) * Uint128(fixed));
        sum[c] += value / kValues[c], squares[c] += std::pow(value / kValues[c], 2);
      }
      sample.sums.push_back(kFullCoverage);
      EXPECT_TRUE(film.can_hold(sample));
      film.add(0, sample);
    }
    const auto variance = std::get<Column<float>>(film.resolve(Channel::variance));
    for (size_t c = 0; c < 3; ++c) said[c] += double(variance[c]) / kSeeds;
  }
  for (size_t c = 0; c < 3; ++c) {
    const double n = kSamples * kSeeds, mean = sum[c] / n;
    const double expected = (squares[c] / n - mean * mean) * n / (n - 1);
    EXPECT_NEAR(said[c] / (kValues[c] * kValues[c]) / expected, 1, 0.01) << kValues[c];
  }
}

// The same for pictures that differ only in the brightness of lights.
TEST(Film, VarianceOfADimPictureIsThatOfABrightOne) {
  const auto variance = [](float color) {
    Scene scene = random_scene(30, 5);
    for (Light& light : scene.lights) light.color = Rgb(color);
    for (Material& material : scene.materials) material.ks = material.transmission = 0;
    // Unused; its colour makes the film of the dim lights hold 1e5, too.
    scene.materials.push_back({.color = Rgb(color < 1 ? 1e6f : 1.0f)});
    scene.background = Rgb();
    RenderOptions options = small();
    options.integrator = IntegratorKind::classic;
    options.shading = ShadingModel::phong;  // no ambient light
    options.samples = 32, options.soft_shadows = true;
    options.channels.add(Channel::variance);
    const RenderSettings settings = resolve_options(options, scene);
    const auto accel = build_accel(scene, settings.accel);
    const auto film = make_film(scene, settings);
    EXPECT_GT((*film)->bound(), 1e5);
    WorkControl control;
    EXPECT_TRUE(render(scene, **accel, settings, **film, control).finished);
    return std::get<Column<float>>((*film)->resolve(Channel::variance));
  };
  const float dim = 1e-4f, bright = 1e5f;
  const Column<float> of_dim = variance(dim), of_bright = variance(bright);
  double dims = 0, brights = 0;
  size_t noisy = 0;
  for (size_t i = 0; i < of_dim.size(); ++i) {
    const double a = double(of_dim[i]) / (double(dim) * dim);
    const double b = double(of_bright[i]) / (double(bright) * bright);
    dims += a, brights += b, noisy += b > 1e-3;
  }
  EXPECT_GT(noisy, 20u);
  EXPECT_NEAR(dims / brights, 1, 0.01);
}

TEST(Film, HoldsBrightAndDim) {
  Film film(1, 1, 1e6);
  for (int i = 0; i < 4; ++i) add(film, Rgb(1e6f, 1, 1e-5f));
  const Image image = film.resolve();
  EXPECT_FLOAT_EQ(image.at(0, 0).x, 1e6f);
  EXPECT_NEAR(image.at(0, 0).y, 1, 1e-5f);
  EXPECT_NEAR(image.at(0, 0).z, 1e-5f, 0.5 / film.scale());
  EXPECT_GT(image.at(0, 0).z, 0);
}

TEST(Film, TilesAreFilledInPlace) {
  // Tiles with a side that is no power of two, smaller ones at the edges, and pictures smaller than
  // a tile.
  for (const auto& [width, height] : {std::pair(61, 50), {5, 3}, {100, 2}}) {
    Film film(width, height, 1000, 24);
    const auto fill = [&](size_t t, PixelSums* sums, double sample) {
      const Tile tile = film.tile(t);
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
          sums[size_t(y - tile.y0) * film.row_stride() + size_t(x - tile.x0)] = {
              {int64_t(x * film.scale()), int64_t(y * film.scale()), int64_t(sample)}};
    };
    for (size_t t = 0; t < film.tiles(); ++t) {
      // Begun and left: nothing of it is in the film, now or later.
      PixelSums* const left = film.begin(t).sums;
      ASSERT_NE(left, nullptr);
      std::fill_n(left, film.tile_sums(), PixelSums{{1, 2, 3}});
      EXPECT_TRUE(film.samples(t).empty());
      EXPECT_EQ(film.copy(t), TileSamples());
      PixelSums* const sums = film.begin(t).sums;
      for (size_t i = 0; i < film.tile_sums(); ++i) ASSERT_EQ(sums[i], PixelSums()) << i;
      fill(t, sums, film.scale());
      film.add(t, SampleSpan{0, 1}, {sums}, {.eye = t});
      EXPECT_EQ(film.begin(t).sums, nullptr);
      std::vector<PixelSums> more(film.tile_sums());
      fill(t, more.data(), 3 * film.scale());
      film.add(t, SampleSpan{1, 2}, {more.data()}, {.eye = 1});
    }
    Film copied(width, height, 1000, 24);
    for (size_t t = 0; t < film.tiles(); ++t) {
      EXPECT_EQ(film.copy(t).rays.eye, t + 1);
      copied.replace(t, film.copy(t));
      EXPECT_EQ(copied.copy(t), film.copy(t));
    }
    const Image image = film.resolve();
    EXPECT_TRUE(same_bytes(image, copied.resolve()));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) EXPECT_EQ(image.at(x, y), Rgb(float(x), float(y), 2));
    copied.replace(0, {});
    EXPECT_NE(copied.begin(0).sums, nullptr);
    EXPECT_EQ(copied.resolve().at(0, 0), Rgb());
  }
}

TEST(Render, SurvivesLightBeyondTheRangeOfFloats) {
  Scene s = looking_down();
  s.lights = {{{0, 0, 4}, std::nullopt}};
  add_plane(s, {{0, 0, 0}, {0, 0, 1}}, {{1e30f, 1e30f, 1}, 1e30f, 0, 1, 0, 1});
  const Image image = picture(s, small(AccelKind::automatic, 8)).image;
  for (const Rgb& p : image.pixels) EXPECT_TRUE(is_finite(p));
  EXPECT_GT(image.at(4, 4).x, 1e30f);
}

TEST(Options, OpenValuesComeFromTheScene) {
  Scene s;
  s.camera.from = {0, 0, 10};
  s.camera.at = {0, 0, 0};
  RenderSettings o = resolve_options({}, s);
  EXPECT_EQ(o.width, 512);
  EXPECT_EQ(o.height, 512);
  EXPECT_EQ(o.aa, 1);
  EXPECT_FALSE(o.dof);
  EXPECT_FLOAT_EQ(o.focus, 10);
  EXPECT_FLOAT_EQ(o.aperture, 0.2f);
  EXPECT_GE(o.threads, 1);
  s.camera.width = 30, s.camera.height = 20, s.requests.samples_per_pixel = 16;
  s.camera.lens_radius = 0.5f, s.camera.focus_distance = 3.0f;
  o = resolve_options({}, s);
  EXPECT_EQ(o.width, 30);
  EXPECT_EQ(o.height, 20);
  EXPECT_EQ(o.aa, 4);
  EXPECT_TRUE(o.dof);
  EXPECT_FLOAT_EQ(o.focus, 3);
  EXPECT_FLOAT_EQ(o.aperture, 0.5f);
  RenderOptions own;
  own.aa = 2, own.dof = false, own.width = 7, own.height = 9;
  o = resolve_options(own, s);
  EXPECT_EQ(o.aa, 2);
  EXPECT_FALSE(o.dof);
  EXPECT_EQ(o.width, 7);
}

TEST(Options, SayWhatTheyAccept) {
  const auto set = [](std::string_view name, std::string_view text) {
    RenderOptions o;
    for (const OptionSpec& spec : render_option_table())
      if (spec.name == name) return set_option(o, spec, text);
    return std::expected<void, Error>(
        std::unexpected(Error{ErrorKind::bad_option, "", "no such option", {}}));
  };
  for (const auto& [name, text] : {std::pair("size", "640x480"),
                                   {"size", "1x1"},
                                   {"accel", "embree"},
                                   {"aa", "3"},
                                   {"grid-resolution", "4x5x6"},
                                   {"seed", "4294967295"},
                                   {"light-size", "0.5"},
                                   {"depth", "32"},
                                   {"grid-factor", "1e1"}})
    EXPECT_TRUE(set(name, text).has_value())
        << name << " " << text << ": " << set(name, text).error().text();
  for (const auto& [name, text] : {std::pair("size", "640"),
                                   {"size", "0x5"},
                                   {"size", "640x480x3"},
                                   {"size", "-1x5"},
                                   {"accel", "bvh9"},
                                   {"aa", "0"},
                                   {"aa", "1.5"},
                                   {"aa", ""},
                                   {"grid-resolution", "4x5"},
                                   {"seed", "-1"},
                                   {"light-size", "nan"},
                                   {"light-size", "-1"},
                                   {"depth", "33"},
                                   {"focus", "inf"},
                                   {"threads", "0"}}) {
    const auto result = set(name, text);
    ASSERT_FALSE(result.has_value()) << name << " " << text;
    EXPECT_NE(result.error().text().find("expected"), std::string::npos) << result.error().text();
  }
}

}  // namespace
}  // namespace raio::core
