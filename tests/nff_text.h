// Scenes as NFF text, for the tests of reading and writing it.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "io/nff/nff.h"

namespace raio::core::tests {

inline const std::string kCamera =
    "v\nfrom 2 1 1\nat 0 0 0\nup 0 0 1\nangle 45\nhither 1\nresolution 64 48\n";
inline const std::string kMaterial = "f 1 0.5 0.25 0.5 0.5 3 0 0\n";

inline std::string texts(const Diagnostics& diagnostics) {
  std::string out;
  for (const Diagnostic& d : diagnostics) out += d.text() + "\n";
  return out;
}

/// The scene of a text that must read, without a word unless it `may_warn`.
inline Scene read(const std::string& text, bool may_warn = false) {
  auto result = parse_nff(text, "t.nff");
  if (!result) {
    ADD_FAILURE() << texts(result.error());
    return {};
  }
  if (!may_warn) {
    EXPECT_EQ(texts(result->notices), "");
  }
  EXPECT_THAT(validate(result->scene), testing::IsEmpty());
  return std::move(result->scene);
}

inline Scene read_objects(const std::string& objects) {
  return read(kCamera + kMaterial + objects);
}

inline std::string file_text(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

inline bool same(const Sphere& a, const Sphere& b) {
  return a.center == b.center && a.radius == b.radius;
}
inline bool same(const Plane& a, const Plane& b) {
  return a.point == b.point && a.normal == b.normal;
}
inline bool same(const Cone& a, const Cone& b) {
  return a.base == b.base && a.base_radius == b.base_radius && a.apex == b.apex &&
         a.apex_radius == b.apex_radius;
}
inline bool same(const Ellipsoid& a, const Ellipsoid& b) {
  return a.center == b.center && std::ranges::equal(a.axes, b.axes);
}
inline bool same(const Disc& a, const Disc& b) {
  return a.center == b.center && a.normal == b.normal && a.radius == b.radius && a.inner == b.inner;
}
inline bool same(const MovingSphere& a, const MovingSphere& b) {
  return a.center == b.center && a.to == b.to && a.radius == b.radius && a.begin == b.begin &&
         a.end == b.end;
}
inline bool same(const MovingTriangle& a, const MovingTriangle& b) {
  return a.from.a == b.from.a && a.from.b == b.from.b && a.from.c == b.from.c && a.to.a == b.to.a &&
         a.to.b == b.to.b && a.to.c == b.to.c && a.begin == b.begin && a.end == b.end;
}
inline bool same(const Light& a, const Light& b) {
  return a.position == b.position && a.color == b.color;
}

template <class List>
void expect_same(const List& a, const List& b)
  requires requires { same(a[0], b[0]); }
{
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(same(a[i], b[i])) << i;
}

/// Position and normal of each vertex of each triangle, then of polygons: the values behind the
/// indices.
inline std::vector<Vec3f> corners(const Scene& scene) {
  std::vector<Vec3f> out;
  for (size_t i = 0; i < scene.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      out.push_back(scene.positions[scene.triangles[i][k]]);
      const uint32_t n = scene.triangle_normals.empty() ? kNoNormal : scene.triangle_normals[i][k];
      out.push_back(n == kNoNormal ? Vec3f() : scene.normals[n]);
    }
  for (const Polygon& p : scene.polygons)
    for (uint32_t k = 0; k < p.count; ++k) out.push_back(scene.positions[p.first + k]);
  return out;
}

inline void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.camera.from, b.camera.from);
  EXPECT_EQ(a.camera.at, b.camera.at);
  EXPECT_EQ(a.camera.up, b.camera.up);
  EXPECT_EQ(a.camera.fov_deg, b.camera.fov_deg);
  EXPECT_EQ(a.requests.near_clip, b.requests.near_clip);
  EXPECT_EQ(a.camera.width, b.camera.width);
  EXPECT_EQ(a.camera.height, b.camera.height);
  EXPECT_EQ(a.camera.lens_radius, b.camera.lens_radius);
  EXPECT_EQ(a.camera.focus_distance, b.camera.focus_distance);
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.requests.samples_per_pixel, b.requests.samples_per_pixel);
  EXPECT_EQ(a.materials, b.materials);
  expect_same(a.lights, b.lights);
  for_each_pool([&]<class Shape>(PoolMembers<Shape> pool) {
    if constexpr (Primitive<Shape>) expect_same(a.*pool.shapes, b.*pool.shapes);
    EXPECT_EQ(a.*pool.materials, b.*pool.materials) << kPoolNames[size_t(pool.kind)];
  });
  ASSERT_EQ(a.polygons.size(), b.polygons.size());
  for (size_t i = 0; i < a.polygons.size(); ++i)
    ASSERT_EQ(a.polygons[i].count, b.polygons[i].count);
  EXPECT_TRUE(corners(a) == corners(b));
}

class RandomScene {
 public:
  explicit RandomScene(uint64_t seed) : random_(seed) {}

  Scene make() {
    Scene scene;
    scene.camera.from = point();
    scene.camera.at = scene.camera.from + Vec3f(3, number(), number());
    scene.camera.up = {number() / 1000, number() / 1000, 5};
    scene.camera.fov_deg = float(1 + random_() % 170) + 0.1f;
    if (random_() % 2) scene.camera.width = 640, scene.camera.height = 480;
    if (random_() % 2) scene.camera.lens_radius = std::abs(number());
    if (random_() % 2) scene.camera.focus_distance = std::abs(number());
    scene.background = color();
    scene.requests.samples_per_pixel = int(random_() % 5);
    for (size_t i = random_() % 4; i > 0; --i)
      scene.lights.push_back({point(), random_() % 2 ? std::optional(color()) : std::nullopt});
    for (int i = 0; i < 5; ++i)
      scene.materials.push_back({color(), std::abs(number()), 0.5f, float(i), 0.1f, 1.5f});
    const auto material = [&] { return MaterialId(random_() % 5); };
    for (int i = 0; i < 20; ++i) {
      scene.planes.push_back({point(), unit()});
      scene.plane_materials.push_back(material());
      scene.spheres.push_back({point(), number()});
      scene.sphere_materials.push_back(material());
      const float r = number();
      scene.cones.push_back({point(), r, point(), random_() % 2 ? r : r / 3});
      scene.cone_materials.push_back(material());
      const Vec3d up(unit());
      const Frame<double> frame(up);
      const auto axis = [&](Vec3d along) { return Vec3f(along * double(number())); };
      scene.ellipsoids.push_back({point(), {axis(frame.u), axis(frame.v), axis(up)}});
      scene.ellipsoid_materials.push_back(material());
      const float radius = std::abs(number());
      scene.discs.push_back({point(), unit(), radius, random_() % 2 ? 0 : radius / 3});
      scene.disc_materials.push_back(material());
      const float begin = number(), end = begin + std::abs(begin);
      scene.moving_spheres.push_back({point(), point(), std::abs(number()), begin, end});
      scene.moving_sphere_materials.push_back(material());
      scene.moving_triangles.push_back(
          {{point(), point(), point()}, {point(), point(), point()}, begin, end});
      scene.moving_triangle_materials.push_back(material());
      triangle(scene, material());
      scene.polygons.push_back({uint32_t(scene.positions.size()), 4});
      scene.polygon_materials.push_back(material());
      const Vec3f corner = point(), u = point(), v = point();
      for (const Vec3f p : {corner, corner + u, corner + u + v, corner + v})
        scene.positions.push_back(p);
    }
    for_each_pool([&](auto pool) {
      EXPECT_FALSE((scene.*pool.shapes).empty()) << kPoolNames[size_t(pool.kind)];
    });
    return scene;
  }

 private:
  float number() {
    const int exponent = int(random_() % 12) - 6;
    float x = 0;
    while (x == 0) x = std::ldexp(float(int(random_() % 20001) - 10000) * 1.1e-4f, exponent);
    return x;
  }
  Vec3f point() { return {number(), number(), number()}; }
  Rgb color() { return abs(point()); }
  Vec3f unit() {
    Vec3d n(point());
    if (random_() % 4 == 0) n[int(random_() % 3)] = 0;
    if (random_() % 8 == 0) n[int(random_() % 3)] *= 1e-12;
    if (random_() % 8 == 0) n = {0, 0, random_() % 2 ? 1.0 : -1.0};
    return Vec3f(normalize(n));
  }
  void triangle(Scene& scene, MaterialId material) {
    const bool smooth = random_() % 2;
    TriangleIndices at, normals{kNoNormal, kNoNormal, kNoNormal};
    for (int k = 0; k < 3; ++k) {
      at[k] = uint32_t(scene.positions.size());
      scene.positions.push_back(point());
      if (!smooth) continue;
      normals[k] = uint32_t(scene.normals.size());
      scene.normals.push_back(unit());
    }
    scene.triangles.push_back(at);
    scene.triangle_normals.push_back(normals);
    scene.triangle_materials.push_back(material);
  }

  std::mt19937_64 random_;
};

// The standard scenes of the report and of Haines, where they are at hand.
inline const std::filesystem::path kSharedFolder = RAIO_SOURCE_DIR "/../shared/scenes";

inline std::string many_spheres() {
  std::string text;
  while (text.size() < 300'000) text += "s 0 0 0 1\n";
  return text;
}

}  // namespace raio::core::tests
