// The public interface as its users see it: nothing else of Raio is included.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <raio/raio.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "temporary_folder.h"

namespace {

using testing::HasSubstr;
using Floats = std::vector<float>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// An array of a user that Raio can read in place.
struct Ball {
  float center[3], radius;
};
struct Ring {
  float center[3], normal[3], radius, inner;
};
struct Egg {
  float center[3], axes[9];
};
struct Peg {
  float start[3], start_radius, end[3], end_radius;
};
struct Corners {
  uint32_t of[3];
};
struct Point {
  float x[3];
};

const raio::Settings& small() {
  static const raio::Settings settings = raio::Settings().set("size", "48x36").set("threads", "2");
  return settings;
}

Floats picture(const raio::Scene& scene) { return raio::Job(scene, small()).run().rgba(); }

// A new material, a camera and a light, as in kStage.
raio::Scene stage() {
  raio::Scene scene;
  scene.set_background({0.1, 0.2, 0.4});
  scene.set_camera({{0, -9, 4}, {0, 0, 0}, {0, 0, 1}, 40});
  scene.add_light({5, -8, 10});
  scene.add_material({{0.9, 0.5, 0.25}, 0.6, 0.3, 30, 0, 1});
  return scene;
}

constexpr std::string_view kStage =
    "v\nfrom 0 -9 4\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0.1\nresolution 48 36\n"
    "b 0.1 0.2 0.4\nl 5 -8 10\nf 0.9 0.5 0.25 0.6 0.3 30 0 1\n";

std::vector<Ball> balls(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> at(-3, 3), radius(0.05f, 0.4f);
  std::vector<Ball> all;
  for (int i = 0; i < count; ++i)
    all.push_back({{at(random), at(random), at(random)}, radius(random)});
  return all;
}

// With `keep`, as an array of Ball with an owner.
void add_balls(raio::Scene& scene, const std::vector<Ball>& all,
               const std::shared_ptr<const void>& keep = nullptr,
               const raio::Appearance& look = 1) {
  scene.add_spheres({all.data()->center, all.size(), sizeof(Ball), keep},
                    {&all.data()->radius, all.size(), sizeof(Ball), keep}, look);
}

// The message of the error that `f` throws; it must be one of bad input.
template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const raio::Error& error) {
    EXPECT_EQ(error.kind(), raio::ErrorKind::bad_input);
    return error.what();
  }
  return "nothing was refused";
}

TEST(Library, EllipsoidsAndDiscsLookAsFromAFile) {
  raio::Scene scene = stage();
  const Egg eggs[] = {{{-1.5f, 0, 0.5f}, {1, 0, 0, 0, 0.5f, 0, 0, 0, 1.5f}},
                      {{1.5f, 0, 0}, {0.5f, 0.5f, 0, -1, 1, 0, 0, 0, 0.25f}}};
  scene.add_ellipsoids({eggs->center, 2, sizeof(Egg)}, {eggs->axes, 2, sizeof(Egg)}, 1);
  const Floats centers = {0, 0, -1, 0, 1, 1}, normals = {0, 0, 2, 1, -2, 2}, radii = {4, 1};
  const Floats inner = {0, 0.5f};
  scene.add_discs({centers.data(), 2}, {normals.data(), 2}, {radii.data(), 2}, {inner.data(), 2},
                  1);
  const raio::Scene file =
      raio::Scene::parse_nff(std::string(kStage) +
                             "ellipsoid -1.5 0 0.5  1 0 0  0 0.5 0  0 0 1.5\n"
                             "ellipsoid 1.5 0 0  0.5 0.5 0  -1 1 0  0 0 0.25\n"
                             "disc 0 0 -1  0 0 2  4\ndisc 0 1 1  1 -2 2  1 0.5\n");
  EXPECT_EQ(scene.primitive_count(), 4u);
  EXPECT_EQ(scene.bounds(), file.bounds());
  EXPECT_EQ(picture(scene), picture(file));
  // Without its hole the second disc looks different.
  raio::Scene full = stage();
  full.add_discs({centers.data(), 2}, {normals.data(), 2}, {radii.data(), 2}, {}, 1);
  raio::Scene ring = stage();
  ring.add_discs({centers.data(), 2}, {normals.data(), 2}, {radii.data(), 2}, {inner.data(), 2}, 1);
  EXPECT_NE(picture(full), picture(ring));
}

TEST(Library, MovingShapesLookAsFromAFile) {
  raio::Scene scene = stage();
  const Floats starts = {-1, 0, 0, 1, 0, 0.5f}, ends = {-1, 1, 0, 1.5f, 0, 1}, radii = {0.5f, 0.7f};
  scene.add_moving_spheres({starts.data(), 2}, {ends.data(), 2}, {radii.data(), 2}, 0, 2, 1);
  const Floats from = {0, 0, 0, 1, 0, 0, 0, 0, 1}, to = {0, 0, 1, 1, 0, 1, 0, 0, 2};
  scene.add_moving_triangles({from.data(), 1}, {to.data(), 1}, 0, 1, 1);
  const raio::Scene file =
      raio::Scene::parse_nff(std::string(kStage) +
                             "sm -1 0 0 -1 1 0 0.5 0 2\nsm 1 0 0.5 1.5 0 1 0.7 0 2\n"
                             "tm 0 0 0 1 0 0 0 0 1  0 0 1 1 0 1 0 0 2  0 1\n");
  EXPECT_EQ(scene.bounds(), file.bounds());
  EXPECT_EQ(picture(scene), picture(file));
  EXPECT_THAT(
      refusal([&] { scene.add_moving_triangles({from.data(), 1}, {to.data(), 1}, 1, 1, 1); }),
      HasSubstr("moving triangle 0: the movement must begin before it ends"));
  const raio::Accel accel(scene);
  const auto hit = [&](double time) {
    return accel.closest({.origin = {-1, 10, 0}, .direction = {0, -1, 0}, .time = time});
  };
  EXPECT_EQ(hit(0).kind, raio::Kind::moving_sphere);
  EXPECT_NEAR(hit(0).distance, 9.5, 1e-5);
  EXPECT_NEAR(hit(1).distance, 9, 1e-5);
  EXPECT_NEAR(hit(5).distance, 8.5, 1e-5);
}

TEST(Library, ColoursOverrideMaterials) {
  const auto all = balls(6);
  raio::Scene colored = stage(), materials = stage();
  // Earlier and later ones without colours keep that of their material.
  add_balls(colored, {all[0], all[1]});
  raio::Appearance look = 1;
  const Floats colors = {1, 0, 0, 0, 0.5f, 1}, opacity = {1, 1};
  look.colors = {colors.data(), 2};
  look.opacity = {opacity.data(), 2};
  add_balls(colored, {all[2], all[3]}, nullptr, look);
  add_balls(colored, {all[4], all[5]});

  const uint32_t red = materials.add_material({{1, 0, 0}, 0.6, 0.3, 30, 0, 1});
  const uint32_t blue = materials.add_material({{0, 0.5, 1}, 0.6, 0.3, 30, 0, 1});
  add_balls(materials, {all[0], all[1]});
  add_balls(materials, {all[2]}, nullptr, red);
  add_balls(materials, {all[3]}, nullptr, blue);
  add_balls(materials, {all[4], all[5]});
  EXPECT_EQ(picture(colored), picture(materials));
  // And opacity shows.
  raio::Scene clear = stage();
  const Floats half = {0.5f, 1};
  look.opacity = {half.data(), 2};
  add_balls(clear, {all[0], all[1]});
  add_balls(clear, {all[2], all[3]}, nullptr, look);
  add_balls(clear, {all[4], all[5]});
  EXPECT_NE(picture(clear), picture(materials));
}

// All kinds, from arrays that can be read in place if `keep` is given.
raio::Scene everything(const std::shared_ptr<const void>& keep) {
  static const std::vector<Ball> kBalls = balls(20);
  static const std::vector<Peg> kPegs = {{{-2, 0, 0}, 0.3f, {-1, 1, 2}, 0.1f},
                                         {{2, 0, 0}, 0.2f, {1, 1, 2}, 0.2f}};
  static const std::vector<Egg> kEggs = {{{0, -1, 1}, {1, 0, 0, 0, 0.5f, 0, 0, 0, 0.25f}}};
  static const std::vector<Ring> kRings = {{{0, 0, 2}, {0, 0.6f, 0.8f}, 1, 0.5f}};
  static const std::vector<Point> kPoints = {{{-4, -4, -1}}, {{4, -4, -1}}, {{0, 4, 1}}};
  static const std::vector<Point> kNormals = {{{0, 0, 1}}, {{0, 0.6f, 0.8f}}, {{0.6f, 0, 0.8f}}};
  static const std::vector<Corners> kTriangles = {{{0, 1, 2}}};
  static const std::vector<Point> kColors(20, {{0.25f, 0.5f, 1}});
  raio::Scene scene = stage();
  raio::Appearance look = 1;
  look.colors = {kColors[0].x, 20, 12, keep};
  add_balls(scene, kBalls, keep, look);
  scene.add_cones({kPegs[0].start, 2, sizeof(Peg), keep}, {kPegs[0].end, 2, sizeof(Peg), keep},
                  {&kPegs[0].start_radius, 2, sizeof(Peg), keep},
                  {&kPegs[0].end_radius, 2, sizeof(Peg), keep});
  scene.add_ellipsoids({kEggs[0].center, 1, sizeof(Egg), keep},
                       {kEggs[0].axes, 1, sizeof(Egg), keep}, 1);
  scene.add_discs(
      {kRings[0].center, 1, sizeof(Ring), keep}, {kRings[0].normal, 1, sizeof(Ring), keep},
      {&kRings[0].radius, 1, sizeof(Ring), keep}, {&kRings[0].inner, 1, sizeof(Ring), keep});
  scene.add_triangles({kPoints[0].x, 3, 12, keep}, {kTriangles[0].of, 1, 12, keep},
                      {kNormals[0].x, 3, 12, keep}, 1);
  return scene;
}

TEST(Library, BorrowedLooksLikeOwned) {
  const auto keep = std::make_shared<int>();
  const raio::Scene owned = everything(nullptr), borrowed = everything(keep);
  // Two columns of spheres and their colours, four of cones, two of ellipsoids, four of discs,
  // three of triangles: each is read in place.
  EXPECT_EQ(keep.use_count(), 1 + 2 + 1 + 4 + 2 + 4 + 3);
  EXPECT_EQ(picture(borrowed), picture(owned));
  raio::Scene twice = borrowed, both = owned;
  const std::vector<Ball> more = {{{0, -4, 0}, 1}};
  add_balls(twice, more);  // copies the borrowed columns
  add_balls(both, more);
  EXPECT_EQ(picture(twice), picture(both));
  EXPECT_NE(picture(twice), picture(owned));
  EXPECT_EQ(picture(borrowed), picture(owned));
}

// Scenes far from zero keep their coordinates relative to a point near them.
TEST(Library, AdditionsToDistantScenesUseFileCoordinates) {
  const std::string far =
      "v\nfrom 1000000 -9 4\nat 1000000 0 0\nup 0 0 1\nangle 40\nhither 0.1\nresolution 48 36\n"
      "f 0.9 0.5 0.25 0.6 0.3 30 0 1\ns 1000000 0 1 0.5\n";
  raio::Scene scene = raio::Scene::parse_nff(far);
  const raio::Scene file = raio::Scene::parse_nff(far + "s 1000001 0 0 1\n");
  const auto ball = std::make_shared<Ball>(Ball{{1000001, 0, 0}, 1});
  scene.add_spheres({ball->center, 1, sizeof(Ball), ball}, {&ball->radius, 1, sizeof(Ball), ball});
  EXPECT_EQ(ball.use_count(), 1);
  EXPECT_EQ(scene.bounds(), file.bounds());
  EXPECT_EQ(picture(scene), picture(file));
  EXPECT_EQ(raio::Accel(scene).closest({{1000001, 0, 9}, {0, 0, -1}}).position,
            (raio::Triple{1000001, 0, 1}));
}

TEST(Library, ColumnsInRaiosLayoutAreBorrowed) {
  auto all = std::make_shared<std::vector<Ball>>(balls(10));
  const std::weak_ptr<std::vector<Ball>> watch = all;
  auto scene = std::make_unique<raio::Scene>(stage());
  add_balls(*scene, *all, all);
  const auto before = scene->bounds();
  (*all)[3].center[0] = 100;  // visible: nothing was copied
  EXPECT_NE(scene->bounds(), before);
  all.reset();
  EXPECT_FALSE(watch.expired());
  auto accel = std::make_unique<raio::Accel>(*scene);
  scene.reset();
  EXPECT_FALSE(watch.expired());
  EXPECT_TRUE(accel->occluded({{100, 0, 0}, {0, 0, 1}}) || accel->bounds());
  auto job = std::make_unique<raio::Job>(*accel, small());
  accel.reset();
  EXPECT_FALSE(watch.expired());
  job.reset();
  EXPECT_TRUE(watch.expired());
}

TEST(Library, ColumnsOfAnyLayoutAreBorrowed) {
  const auto all = std::make_shared<std::vector<Ball>>(balls(10));
  const auto used = [&](const auto& add) {
    const auto before = all.use_count();
    raio::Scene scene = stage();
    add(scene);
    return all.use_count() - before;
  };
  // Centres and radii in separate arrays, one of which is not kept.
  const auto radii = std::make_shared<Floats>(10, 0.25f);
  const raio::Column<float, 3> centers = {all->data()->center, 10, sizeof(Ball), all};
  EXPECT_EQ(used([&](raio::Scene& s) {
              s.add_spheres(centers, {radii->data(), 10, 4, radii}, 1);
              EXPECT_EQ(radii.use_count(), 2);
            }),
            1);
  EXPECT_EQ(used([&](raio::Scene& s) { s.add_spheres(centers, {radii->data(), 10}, 1); }), 1);
  raio::Scene apart = stage(), together = stage();
  apart.add_spheres(centers, {radii->data(), 10, 4, radii}, 1);
  std::vector<Ball> same = *all;
  for (Ball& ball : same) ball.radius = 0.25f;
  add_balls(together, same);
  EXPECT_EQ(picture(apart), picture(together));
  // Backwards.
  raio::Scene backwards = stage(), forwards = stage();
  const std::vector<Ball> turned(all->rbegin(), all->rend());
  const ptrdiff_t back = -ptrdiff_t(sizeof(Ball));
  backwards.add_spheres({all->back().center, 10, back, all}, {&all->back().radius, 10, back, all},
                        1);
  add_balls(forwards, turned);
  EXPECT_EQ(picture(backwards), picture(forwards));
  // Until more is added.
  EXPECT_EQ(used([&](raio::Scene& s) {
              add_balls(s, *all, all);
              EXPECT_EQ(s.primitive_count(), 10u);
            }),
            2);
  EXPECT_EQ(used([&](raio::Scene& s) {
              add_balls(s, *all, all), add_balls(s, *all, all);
              EXPECT_EQ(s.primitive_count(), 20u);
            }),
            0);
}

TEST(Library, RefusesInvalidColumnsWithoutChanges) {
  raio::Scene scene = stage();
  const Floats xyz = {0, 0, 0, 1, 1, 1}, ones = {1, 1}, bad = {1, kNan};
  const Floats infinite = {0, 0, 0, 1, 1, std::numeric_limits<float>::infinity()};
  const uint32_t corners[] = {0, 1, 2};
  const raio::Column<float, 3> two = {xyz.data(), 2};
  const raio::Column<float> radii = {ones.data(), 2};
  EXPECT_THAT(refusal([&] { scene.add_spheres({nullptr, 2}, radii); }),
              HasSubstr("the centres are a null pointer"));
  EXPECT_THAT(refusal([&] { scene.add_spheres(two, {nullptr, 2}); }),
              HasSubstr("the radii are a null pointer"));
  EXPECT_EQ(refusal([&] { scene.add_spheres(two, {ones.data(), 1}); }),
            "found 2 centres but 1 radii");
  EXPECT_EQ(refusal([&] { scene.add_spheres(two, {}); }), "found 2 centres but 0 radii");
  EXPECT_THAT(refusal([&] { scene.add_spheres(two, {bad.data(), 2}); }),
              HasSubstr("sphere 1: the radius must be finite"));
  EXPECT_THAT(refusal([&] { scene.add_spheres({infinite.data(), 2}, radii); }),
              HasSubstr("sphere 1: the centre must be finite"));
  EXPECT_THAT(refusal([&] { scene.add_spheres(two, radii, 7); }), HasSubstr("unknown material 7"));
  EXPECT_THAT(refusal([&] { scene.add_discs(two, {infinite.data(), 2}, radii); }),
              HasSubstr("the normal of disc 0 is zero or not finite"));
  EXPECT_THAT(refusal([&] { scene.add_discs(two, two, radii, {ones.data(), 1}); }),
              HasSubstr("found 2 centres but 1 inner radii"));
  const Floats skew = {1, 0, 0, 1, 1, 0, 0, 0, 1};
  EXPECT_THAT(refusal([&] { scene.add_ellipsoids({xyz.data(), 1}, {skew.data(), 1}); }),
              HasSubstr("perpendicular"));
  EXPECT_THAT(refusal([&] { scene.add_cones(two, two, radii, radii); }),
              HasSubstr("base and apex are the same point"));
  EXPECT_EQ(refusal([&] { scene.add_triangles(two, {corners, 1}); }),
            "triangle 0 refers to vertex 2 of 2");
  EXPECT_THAT(refusal([&] { scene.add_triangles({infinite.data(), 2}, {}); }),
              HasSubstr("position 1 is not finite"));
  EXPECT_THAT(refusal([&] { scene.add_triangles(two, {}, {xyz.data(), 1}); }),
              HasSubstr("found 2 positions but 1 normals"));
  raio::Appearance look;
  look.colors = {xyz.data(), 1};
  EXPECT_EQ(refusal([&] { scene.add_spheres(two, radii, look); }),
            "found 2 primitives but 1 colours");
  look.colors = {};
  look.opacity = {bad.data(), 2};
  EXPECT_THAT(refusal([&] { scene.add_spheres(two, radii, look); }), HasSubstr("opacity 1 is nan"));
  EXPECT_EQ(scene.primitive_count(), 0u);
  EXPECT_EQ(scene.bounds(), std::nullopt);
  EXPECT_NO_THROW(picture(scene));
}

std::vector<raio::Ray> random_rays(size_t count) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> at(-4, 4), length(0, 8);
  std::vector<raio::Ray> rays(count);
  for (size_t i = 0; i < count; ++i) {
    rays[i] = {{at(random), at(random), at(random)}, {at(random), at(random), at(random)}};
    if (i % 3 == 0) rays[i].length = length(random);
  }
  return rays;
}

bool same(const raio::Hit& a, const raio::Hit& b) {
  return a.distance == b.distance && a.kind == b.kind && a.index == b.index && a.u == b.u &&
         a.v == b.v && a.material == b.material && a.position == b.position && a.normal == b.normal;
}

TEST(LibrarySettings, OptionsHaveTypeRangeAndDefault) {
  std::map<std::string, raio::Settings::Option> all;
  for (const auto& option : raio::Settings::options()) all[option.name] = option;
  const auto& fov = all.at("fov");
  EXPECT_EQ(fov.type, "number");
  EXPECT_EQ(fov.unit, "degrees");
  EXPECT_EQ(fov.minimum, 0.001);
  EXPECT_EQ(fov.maximum, 179);
  EXPECT_EQ(fov.default_value, "") << "it is the scene's";
  EXPECT_EQ(fov.integrators.size(), 4u);
  EXPECT_EQ(all.at("depth").default_value, "") << "it depends on the integrator";
  EXPECT_EQ(all.at("depth").integrators, (std::vector<std::string>{"classic", "path"}));
  EXPECT_EQ(all.at("samples").excludes, (std::vector<std::string>{"lens-samples", "noise"}));
  EXPECT_EQ(all.at("tone").type, "words");
  EXPECT_FALSE(all.at("tone").minimum);
  // Every default is accepted.
  for (const auto& [name, option] : all)
    if (!option.default_value.empty()) (void)raio::Settings().set(name, option.default_value);
}

TEST(LibraryAccel, StructuresMatchBruteForce) {
  const raio::Scene scene = everything(std::make_shared<int>());
  const auto rays = random_rays(5000);
  std::vector<raio::Hit> expected(rays.size());
  raio::Accel(scene, raio::Settings().set("accel", "none"))
      .closest(rays.size(), rays.data(), expected.data());
  size_t found = 0;
  for (const char* kind : {"none", "grid", "bvh"}) {
    const raio::Accel accel(scene, raio::Settings().set("accel", kind));
    EXPECT_EQ(accel.info().kind, kind);
    EXPECT_EQ(accel.info().primitives, scene.primitive_count());
    EXPECT_EQ(accel.bounds(), scene.bounds());
    std::vector<raio::Hit> hits(rays.size());
    std::vector<uint8_t> occluded(rays.size());
    accel.closest(rays.size(), rays.data(), hits.data());
    accel.occluded(rays.size(), rays.data(), occluded.data());
    for (size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(same(hits[i], expected[i])) << kind << " ray " << i;
      ASSERT_EQ(occluded[i], expected[i].found()) << kind << " ray " << i;
      found += expected[i].found();
      if (i % 100) continue;
      EXPECT_TRUE(same(accel.closest(rays[i]), hits[i])) << kind << " ray " << i;
      EXPECT_EQ(accel.occluded(rays[i]), hits[i].found()) << kind << " ray " << i;
    }
  }
  EXPECT_GT(found, 2000u);
}

TEST(LibraryAccel, ArraysOfRaysHaveTheHitsOfSingleOnes) {
  const raio::Accel accel(everything(std::make_shared<int>()));
  const auto rays = random_rays(9000);
  std::vector<std::array<float, 7>> rows(rays.size());  // a stride of 28 bytes
  std::vector<raio::Ray> rounded(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    auto& row = rows[i];
    for (size_t k = 0; k < 3; ++k)
      row[k] = float(rays[i].origin[k]), row[3 + k] = float(rays[i].direction[k]);
    row[6] = float(rays[i].length);
    rounded[i] = {{double(row[0]), double(row[1]), double(row[2])},
                  {double(row[3]), double(row[4]), double(row[5])},
                  double(row[6])};
  }
  std::vector<raio::Hit> expected(rays.size());
  accel.closest(rays.size(), rounded.data(), expected.data());
  const size_t n = rays.size();
  Floats distance(n), position(3 * n), normal(3 * n), uv(2 * n), alone(n);
  std::vector<uint8_t> kind(n), occluded(n);
  std::vector<int64_t> index(n), instance(n);
  const raio::Column<float, 3> origins{rows[0].data(), n, 28},
      directions{rows[0].data() + 3, n, 28};
  const raio::Column<float> lengths{rows[0].data() + 6, n, 28};
  accel.closest(origins, directions, lengths,
                {distance.data(), kind.data(), index.data(), instance.data(), position.data(),
                 normal.data(), uv.data()});
  accel.closest(origins, directions, lengths, {alone.data()});
  accel.occluded(origins, directions, lengths, occluded.data());
  EXPECT_EQ(alone, distance);
  for (size_t i = 0; i < n; ++i) {
    const raio::Hit& hit = expected[i];
    ASSERT_EQ(distance[i], float(hit.distance)) << i;
    ASSERT_EQ(occluded[i] != 0, hit.found()) << i;
    ASSERT_EQ(index[i], hit.found() ? int64_t(hit.index) : -1) << i;
    ASSERT_EQ(instance[i], hit.instance) << i;
    ASSERT_EQ(normal[3 * i], float(hit.normal[0])) << i;
    if (!hit.found()) continue;
    ASSERT_EQ(kind[i], uint8_t(hit.kind)) << i;
    ASSERT_EQ(position[3 * i + 2], float(hit.position[2])) << i;
    ASSERT_EQ(uv[2 * i + 1], float(hit.v)) << i;
  }
  EXPECT_THAT(
      refusal([&] { accel.closest(origins, {rows[0].data(), n - 1, 28}, {}, {distance.data()}); }),
      HasSubstr("found 9000 origins, but 8999 directions"));
}

TEST(LibraryAccel, OtherColoursShareTheTree) {
  raio::Scene scene = everything(std::make_shared<int>());
  const raio::Accel first(scene);
  scene.add_light({3, 3, 3});
  const raio::Accel second(scene, {}, &first);
  EXPECT_EQ(second.info().bytes, first.info().bytes);
  const auto picture = [&](const raio::Accel& accel) {
    return raio::Job(accel, raio::Settings().set("size", "40x30")).run().rgba();
  };
  EXPECT_EQ(picture(second), picture(raio::Accel(scene)));
  EXPECT_NE(picture(second), picture(first));
}

TEST(LibraryAccel, HitsHavePositionAndPrimitive) {
  raio::Scene scene = stage();
  const Floats center = {0, 0, 0}, radius = {2};
  scene.add_spheres({center.data(), 1}, {radius.data(), 1}, 1);
  // The first triangle has no area: the second is number 1 all the same.
  const Floats corners = {10, 0, 0, 14, 0, 0, 10, 4, 0};
  const uint32_t indices[] = {0, 0, 1, 0, 1, 2};
  scene.add_triangles({corners.data(), 3}, {indices, 2});
  const raio::Accel accel(scene);
  const raio::Hit sphere = accel.closest({{0, 0, 10}, {0, 0, -5}});
  EXPECT_EQ(sphere.kind, raio::Kind::sphere);
  EXPECT_EQ(sphere.distance, 8);
  EXPECT_EQ(sphere.position, (raio::Triple{0, 0, 2}));
  EXPECT_EQ(sphere.normal, (raio::Triple{0, 0, 1}));
  EXPECT_EQ(sphere.material, 1u);
  const raio::Hit triangle = accel.closest({{11, 2, 3}, {0, 0, -1}});
  EXPECT_EQ(triangle.kind, raio::Kind::triangle);
  EXPECT_EQ(triangle.index, 1u);
  EXPECT_EQ(triangle.distance, 3);
  EXPECT_EQ(triangle.u, 0.25);
  EXPECT_EQ(triangle.v, 0.5);
  EXPECT_EQ(triangle.material, 0u);
  EXPECT_FALSE(accel.closest({{11, 2, 3}, {0, 0, -1}, 2.5}).found());
  EXPECT_FALSE(accel.closest({{11, 2, 3}, {0, 0, 1}}).found());
  for (const double length : {1e-300, 1e-160, 1e160, 1e300})
    EXPECT_EQ(accel.closest({{11, 2, 3}, {0, 0, -length}}).distance, 3) << length;
  EXPECT_THAT(refusal([&] { accel.closest({{0, 0, 0}, {0, 0, 0}}); }),
              HasSubstr("ray 0: the direction is zero"));
  EXPECT_THAT(refusal([&] { accel.occluded({{double(kNan), 0, 0}, {0, 0, 1}}); }),
              HasSubstr("ray 0: a number is not finite"));
  EXPECT_THAT(refusal([&] { accel.closest(1, nullptr, nullptr); }), HasSubstr("null pointer"));
}

TEST(LibraryAccel, PolygonsAreCountedAsPolygons) {
  const raio::Accel accel(
      raio::Scene::parse_nff(std::string(kStage) +
                             "p 3\n0 0 0\n1 0 0\n0 1 0\n"
                             "p 4\n10 0 0\n12 0 0\n12 2 0\n10 2 0\np 4\n20 0 0\n22 0 0\n22 2 0\n"
                             "20 2 0\n"));
  EXPECT_EQ(accel.info().primitives, 5u);
  for (const double y : {0.5, 1.5}) {
    const raio::Hit hit = accel.closest({{20.9, y, 5}, {0, 0, -1}});
    EXPECT_EQ(hit.kind, raio::Kind::polygon);
    EXPECT_EQ(hit.index, 1u);
    EXPECT_EQ(hit.u, 0);
  }
  EXPECT_EQ(accel.closest({{0.2, 0.2, 5}, {0, 0, -1}}).kind, raio::Kind::triangle);
}

TEST(LibraryAccel, CountsTellWhichCallAddedWhatIsHit) {
  raio::Scene scene = stage();
  const Floats corners = {0, 0, 0, 4, 0, 0, 0, 4, 0}, aside = {10, 0, 0, 14, 0, 0, 10, 4, 0};
  const uint32_t triangle[] = {0, 1, 2};
  const Floats center = {0, 0, 20}, radius = {2};
  raio::Scene object;
  object.add_spheres({center.data(), 1}, {radius.data(), 1});
  scene.add_mesh({corners.data(), 3}, {triangle, 1}, {}, {}, {});
  scene.add_triangles({aside.data(), 3}, {triangle, 1});
  const Floats place = {1, 0, 0, 30, 0, 1, 0, 0, 0, 0, 1, 0};
  scene.add_instances(scene.add_prototype(object), {place.data(), 1});
  EXPECT_EQ(scene.count(raio::Kind::triangle), 1u);
  EXPECT_EQ(scene.count(raio::Kind::sphere), 0u);
  EXPECT_EQ(object.count(raio::Kind::sphere), 1u);
  EXPECT_EQ(scene.mesh_triangle_count(), 1u);
  EXPECT_EQ(scene.instance_count(), 1u);
  const raio::Accel accel(scene);
  EXPECT_EQ(accel.closest({{11, 1, 5}, {0, 0, -1}}).index, 0u);
  EXPECT_EQ(accel.closest({{1, 1, 5}, {0, 0, -1}}).index, scene.count(raio::Kind::triangle));
}

TEST(LibraryAccel, ThreadsTraceTogether) {
  const raio::Accel accel(everything(nullptr));
  const auto rays = random_rays(3000);
  std::vector<std::vector<raio::Hit>> hits(4, std::vector<raio::Hit>(rays.size()));
  std::vector<std::thread> threads;
  for (auto& own : hits)
    threads.emplace_back([&] { accel.closest(rays.size(), rays.data(), own.data()); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& own : hits)
    for (size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(own[i], hits[0][i])) << i;
}

TEST(LibraryAccel, JobsShareAStructureWithoutChangingPictures) {
  const raio::Scene scene = everything(nullptr);
  const raio::Accel accel(scene, raio::Settings().set("accel", "grid").set("one-sided"));
  for (const char* from : {"0,-9,4", "6,-6,3"}) {
    raio::Settings settings = small();
    settings.set("from", from);
    const Floats shared = raio::Job(accel, settings).run().rgba();
    EXPECT_EQ(shared, raio::Job(scene, settings.set("one-sided")).run().rgba()) << from;
    EXPECT_EQ(shared, raio::Job(accel, settings).run().rgba()) << from;
  }
  EXPECT_THAT(refusal([&] { raio::Job(accel, raio::Settings().set("accel", "bvh")); }),
              HasSubstr("accel is bvh, but the structure was built with grid"));
  EXPECT_THAT(refusal([&] { raio::Job(accel, raio::Settings().set("grid-factor", "2")); }),
              HasSubstr("grid-factor is 2, but the structure was built without it"));
  EXPECT_THAT(refusal([&] { raio::Job(accel, raio::Settings().set("view", "tests")); }),
              HasSubstr("built with counters"));
}

TEST(LibraryAccel, RefusesMissingStructures) {
  EXPECT_THAT(refusal([] {
                raio::Accel(stage(), raio::Settings().set("accel", "bvh").set("grid-factor", "2"));
              }),
              HasSubstr("grid-factor"));
  const raio::Accel empty(stage());
  EXPECT_EQ(empty.bounds(), std::nullopt);
  EXPECT_FALSE(empty.occluded({}));
}

using LibraryFile = raio::core::TemporaryFolder;

// A ball and a triangle, in existing materials and in a new one.
raio::Scene thing() {
  raio::Scene scene = stage();
  const Floats center = {0, 0, 0.2f}, radius = {0.5f};
  scene.add_spheres({center.data(), 1}, {radius.data(), 1}, 1);
  const uint32_t blue = scene.add_material({{0.1, 0.2, 0.9}, 0.8, 0, 1, 0, 1});
  const Floats corners = {-1, -1, -0.4f, 1, -1, -0.4f, 0, 1, -0.4f};
  const uint32_t triangle[] = {0, 1, 2};
  scene.add_triangles({corners.data(), 3}, {triangle, 1}, {}, blue);
  return scene;
}

// In Raio's layout.
struct Copy {
  uint32_t prototype;
  float matrix[12];
};

TEST(LibraryInstances, InstancesLookLikeTransformedPrimitives) {
  // By halves and quarters, with exact sums.
  const Floats shifts = {-1.5f, 0.25f, 1.25f};
  raio::Scene copies = stage(), moved = stage();
  const uint32_t number = copies.add_prototype(thing());
  EXPECT_EQ(number, 0u);
  const uint32_t blue = moved.add_material({{0.1, 0.2, 0.9}, 0.8, 0, 1, 0, 1});
  for (const float x : shifts) {
    const Floats matrix = {1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0};
    copies.add_instances(number, {matrix.data(), 1});
    const Floats center = {x, 0, 0.2f}, radius = {0.5f};
    moved.add_spheres({center.data(), 1}, {radius.data(), 1}, 1);
    const Floats corners = {x - 1, -1, -0.4f, x + 1, -1, -0.4f, x, 1, -0.4f};
    const uint32_t triangle[] = {0, 1, 2};
    moved.add_triangles({corners.data(), 3}, {triangle, 1}, {}, blue);
  }
  EXPECT_EQ(copies.primitive_count(), 6u);
  EXPECT_EQ(copies.bounds(), moved.bounds());
  // The object's material is appended to the others.
  EXPECT_EQ(copies.add_material({}), 3u);
  const Floats a = picture(copies), b = picture(moved);
  size_t differ = 0;
  for (size_t i = 0; i < a.size(); ++i) differ += std::abs(a[i] - b[i]) > 1e-3f;
  EXPECT_LE(differ, a.size() / 200);  // at edges
  EXPECT_NE(a, picture(stage()));
}

TEST(LibraryInstances, HitsNameInstanceAndPrimitive) {
  raio::Scene scene = stage(), pair;
  const uint32_t inner = pair.add_prototype(thing());
  const Floats matrices = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0};
  pair.add_instances(inner, {matrices.data(), 2});
  const uint32_t outer = scene.add_prototype(pair), single = scene.add_prototype(thing());
  const Copy copies[] = {{single, {1, 0, 0, -4, 0, 1, 0, 0, 0, 0, 1, 0}},
                         {outer, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}};
  const auto kept = std::make_shared<std::vector<Copy>>(copies, copies + 2);
  scene.add_instances({&kept->data()->prototype, 2, sizeof(Copy), kept},
                      {kept->data()->matrix, 2, sizeof(Copy), kept});
  EXPECT_EQ(kept.use_count(), 3);  // read in place
  const Floats center = {0, 8, 0}, radius = {1};
  scene.add_spheres({center.data(), 1}, {radius.data(), 1}, 1);
  const raio::Accel accel(scene);
  const auto from_above = [&](double x, double y) {
    return accel.closest({{x, y, 9}, {0, 0, -1}});
  };
  EXPECT_EQ(from_above(0, 8).instance, -1);
  EXPECT_EQ(from_above(0, 8).index, 0u);
  EXPECT_EQ(from_above(-4, 0).instance, 0);
  EXPECT_EQ(from_above(-4, 0).kind, raio::Kind::sphere);
  EXPECT_NEAR(from_above(-4, 0).distance, 8.3, 1e-5);
  for (const double x : {0.0, 4.0}) {
    EXPECT_EQ(from_above(x, 0).instance, 1);
    EXPECT_EQ(from_above(x, 0).index, 0u);
    const raio::Hit triangle = from_above(x, -0.9);
    EXPECT_EQ(triangle.kind, raio::Kind::triangle);
    EXPECT_EQ(triangle.index, 0u);
    EXPECT_EQ(triangle.material, 2u);
    EXPECT_EQ(triangle.instance, 1);
    EXPECT_NEAR(triangle.u, 0.475, 1e-5);
  }
}

TEST(LibraryFilm, AlphaIsAChannel) {
  const raio::Scene scene = stage();
  raio::Settings settings = small();
  const raio::Film film = raio::Job(scene, settings.set("channels", "alpha,depth")).run();
  EXPECT_EQ(film.channels(), (std::vector<std::string>{"alpha", "depth"}));
  int components = 0;
  const Floats alpha = film.channel("alpha", &components), rgba = film.rgba();
  EXPECT_EQ(components, 1);
  ASSERT_EQ(4 * alpha.size(), rgba.size());
  for (size_t i = 0; i < alpha.size(); ++i) EXPECT_EQ(alpha[i], rgba[4 * i + 3]);
}

TEST(LibraryFilm, IdsAreIntegers) {
  raio::Settings settings = small();
  const raio::Film film = raio::Job(stage(), settings.set("channels", "alpha,depth,id")).run();
  EXPECT_EQ(film.integers("id").size(), size_t(film.width()) * size_t(film.height()));
  EXPECT_EQ(film.nan_samples(), 0u);
  const auto error = [](auto&& call) -> std::string {
    try {
      call();
    } catch (const raio::Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error([&] { (void)film.channel("id"); }),
            "channel 'id' has integers; read it with integers()");
  for (const char* name : {"alpha", "depth"})
    EXPECT_NE(error([&] { (void)film.integers(name); }).find("read it with channel()"),
              std::string::npos);
  EXPECT_EQ(error([&] { (void)film.integers("normal"); }),
            "the film has no channel 'normal'; it has alpha, depth, id");
}

TEST(LibraryInstances, NamesMakeObjects) {
  raio::Scene scene = stage();
  const uint32_t number = scene.add_prototype(thing());
  const Floats left = {1, 0, 0, -1.5f, 0, 1, 0, 0, 0, 0, 1, 0},
               right = {1, 0, 0, 1.5f, 0, 1, 0, 0, 0, 0, 1, 0};
  scene.add_instances(number, {left.data(), 1}, "left");
  scene.add_instances(number, {right.data(), 1}, "right");
  raio::Settings settings = small();
  const raio::Film film = raio::Job(scene, settings.set("channels", "object,id")).run();
  const std::vector<uint32_t> objects = film.integers("object"), ids = film.integers("id");
  std::array<size_t, 3> counts{};
  for (size_t i = 0; i < objects.size(); ++i) {
    const size_t object = objects[i];
    ASSERT_LT(object, 3u);
    ++counts[object];
    EXPECT_EQ(object == 0, ids[i] == 0);
    if (object > 0) {
      EXPECT_EQ(object == 1, i % 48 < 24) << i;
    }
  }
  EXPECT_GT(counts[1], 30u);
  EXPECT_EQ(counts[1], counts[2]);
}

TEST(LibraryInstances, RefusesPrimitivesThatCannotBeInstanced) {
  raio::Scene scene = stage();
  const auto error = [](auto&& f) -> std::string {
    try {
      f();
    } catch (const raio::Error& e) {
      EXPECT_EQ(e.kind(), raio::ErrorKind::bad_input);
      return e.what();
    }
    return "";
  };
  const Floats none(12), zero = {0, 0, 0}, one = {1};
  EXPECT_THAT(error([&] { scene.add_instances(0, {none.data(), 1}); }),
              HasSubstr("instance 0: unknown prototype 0, expected a number below 0"));
  const uint32_t number = scene.add_prototype(thing());
  EXPECT_THAT(error([&] { scene.add_instances(number, {none.data(), 1}); }),
              HasSubstr("instance 0: the matrix must be finite and have an inverse"));
  EXPECT_THAT(error([&] { scene.add_instances(number, {nullptr, 1}); }),
              HasSubstr("the matrices are a null pointer"));
  raio::Scene moving = stage();
  moving.add_moving_spheres({zero.data(), 1}, {zero.data(), 1}, {one.data(), 1}, 0, 1);
  EXPECT_THAT(error([&] { scene.add_prototype(moving); }), HasSubstr("moving primitives"));
  raio::Scene deep = thing();
  for (int i = 0; i < 15; ++i) {
    raio::Scene around;
    around.add_prototype(deep);
    deep = around;
  }
  EXPECT_EQ(error([&] { raio::Scene().add_prototype(deep); }), "");
  raio::Scene around;
  around.add_prototype(deep);
  EXPECT_THAT(error([&] { raio::Scene().add_prototype(around); }),
              HasSubstr("nested more than 16"));
  EXPECT_EQ(scene.primitive_count(), 0u);
}

TEST_F(LibraryFile, KeepsInstances) {
  raio::Scene scene = stage();
  const Floats matrix = {0, -1, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0};
  scene.add_instances(scene.add_prototype(thing()), {matrix.data(), 1}, "turned");
  const std::string binary = file("copies.raio").string(), text = file("copies.nff").string();
  scene.write(binary);
  EXPECT_EQ(picture(raio::Scene::read(binary)), picture(scene));
  scene.write(text);  // as primitives
  EXPECT_EQ(raio::Scene::read(text).primitive_count(), 2u);
}

TEST_F(LibraryFile, KeepsAdditions) {
  const raio::Scene scene = everything(std::make_shared<int>());
  scene.write(file("scene.raio").string());
  EXPECT_EQ(picture(raio::Scene::read(file("scene.raio").string())), picture(scene));
}

TEST(LibraryJob, ReportsProgressAndCanBeCancelled) {
  const raio::Scene scene = everything(nullptr);
  raio::Job job(scene, raio::Settings().set("size", "2000x2000").set("aa", "16"));
  job.on_progress([&](const raio::Progress& progress) {
    EXPECT_LE(progress.share, 1);
    job.cancel();
  });
  try {
    job.run();
    FAIL() << "it ran to its end";
  } catch (const raio::Error& error) {
    EXPECT_EQ(error.kind(), raio::ErrorKind::cancelled);
  }
}

TEST(LibraryJob, RethrowsExceptionsOfCallbacks) {
  const raio::Scene scene = everything(nullptr);
  raio::Job job(scene, raio::Settings().set("size", "2000x2000").set("aa", "16"));
  int calls = 0;
  job.on_progress([&](const raio::Progress&) {
    ++calls;
    throw std::out_of_range("the caller's own");
  });
  EXPECT_THROW(job.run(), std::out_of_range);
  EXPECT_EQ(calls, 1);
}

// Calls f() until it throws; the caller's callback throws at the first time. Half a minute is
// enough for any machine.
template <class F>
void until_it_throws(const F& f) {
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < patience) f();
}

TEST_F(LibraryFile, AnExecutorsCallbackEndsLoadsAndBuildsByThrowing) {
  const raio::Scene scene = everything(nullptr);
  scene.write(file("scene.raio").string());
  const std::function<void()> works[] = {
      [&] { (void)raio::Scene::read(file("scene.raio").string()); },
      [&] { (void)raio::Accel(scene); },
      [&] { (void)raio::Accel(scene, raio::Settings().set("accel", "grid")); }};
  for (const auto& work : works) {
    raio::Executor executor(2);
    int calls = 0;
    executor.on_progress([&](const raio::Progress& progress) {
      ++calls;
      EXPECT_NE(progress.stage, raio::Progress::Stage::rendering);
      throw std::out_of_range("the caller's own");
    });
    EXPECT_THROW(executor.run([&] { until_it_throws(work); }), std::out_of_range);
    EXPECT_EQ(calls, 1);
    EXPECT_NO_THROW(work());  // what it left is sound
  }
}

TEST_F(LibraryFile, ACancelledExecutorEndsAllWithinIt) {
  const raio::Scene scene = everything(nullptr);
  scene.write(file("scene.raio").string());
  raio::Executor executor(2);
  int ran = 0;
  executor.run([&] { ++ran; });
  executor.cancel();
  const raio::Settings settings = raio::Settings().set("size", "64x64").set("threads", "2");
  const std::function<void()> works[] = {
      [&] { (void)raio::Scene::read(file("scene.raio").string()); },
      [&] { (void)raio::Accel(scene); }, [&] { (void)raio::Job(scene, settings).run(); }};
  for (const auto& work : works) {
    try {
      executor.run(work);
      FAIL() << "it ran to its end";
    } catch (const raio::Error& error) {
      EXPECT_EQ(error.kind(), raio::ErrorKind::cancelled);
    }
  }
  EXPECT_EQ(ran, 1);
  EXPECT_THROW(raio::Executor(-1), raio::Error);
}

// In a new process, because threads started by oneTBB stay.
TEST_F(LibraryFile, OneThreadIsOneFromLoadToWrite) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const std::string scene = file("scene.raio").string(), picture = file("picture.exr").string();
  const auto work = [&](int threads) {
    raio::Executor(threads).run([&] {
      raio::Scene made;
      const auto all = balls(100'000);
      add_balls(made, all, nullptr, 0);
      made.write(scene);
      const raio::Scene read = raio::Scene::read(scene);
      const raio::Settings settings =
          raio::Settings().set("size", "300x200").set("tone", "agx").set("channels", "depth");
      raio::Job(read, settings).run().write(picture);
      raio::Job(raio::Accel(read, settings), settings).run().write(picture);
    });
    const auto all = std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
    std::filesystem::remove_all(folder());
    std::_Exit(all == 1 ? 0 : 1);
  };
  EXPECT_EXIT(work(1), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(work(2), testing::ExitedWithCode(1), "");  // so it is told
}

}  // namespace
