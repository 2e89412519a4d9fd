// Scenes that several tests use.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace raio::core::tests {

/// The standard scenes and the report's, where they are at hand; else empty.
inline std::vector<std::filesystem::path> shared_scenes() {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : {"p3d", "spd"}) {
    const auto dir = std::filesystem::path(RAIO_SOURCE_DIR) / "../shared/scenes" / folder;
    if (!std::filesystem::is_directory(dir)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(dir))
      if (entry.path().extension() == ".nff") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// `count` primitives of every kind in a cube of side 2 about the origin, times `scale`, plus
/// `shift`; a polygon that spans it all, and an infinite plane below.
inline Scene random_scene(int count, uint32_t seed, float scale = 1, Vec3f shift = {}) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  // Drawn one after another: in a call compilers would choose the order.
  const auto point = [&] {
    const float x = unit(rng), y = unit(rng), z = unit(rng);
    return Vec3f(x, y, z);
  };
  const auto place = [&](Vec3f p) { return p * scale + shift; };
  const float size = 1.0f / std::cbrt(float(count));
  Scene scene;
  scene.name = "random";
  scene.camera.from = place({0.3f, -4, 1});
  scene.camera.at = place({});
  scene.camera.up = {0, 0, 1};
  scene.lights = {{place({3, -2, 4}), std::nullopt}, {place({-2, -4, 1}), std::nullopt}};
  scene.background = {0.1f, 0.2f, 0.4f};
  scene.materials = {{{0.9f, 0.6f, 0.3f}, 0.7f, 0.3f, 20, 0, 1},
                     {{0.4f, 0.7f, 0.9f}, 0.8f, 0, 1, 0, 1},
                     {{1, 1, 1}, 0.1f, 0.1f, 50, 0.8f, 1.3f}};
  const auto material = [&] { return MaterialId(rng() % 3); };
  for (int i = 0; i < count; ++i) {
    const Vec3f p = point();
    switch (i % 4) {
      case 0: {
        const float radius = size * (0.3f + 0.2f * unit(rng)) * scale;
        scene.spheres.push_back({place(p), i % 16 == 0 ? -radius : radius});
        scene.sphere_materials.push_back(material());
        break;
      }
      case 1: {
        const float sign = i % 16 == 1 ? -1 : 1;
        const float base = size * 0.3f * scale, apex = i % 8 == 1    ? base
                                                       : i % 24 == 5 ? 0
                                                                     : base / 2;
        scene.cones.push_back({place(p), sign * base, place(p + point() * size), sign * apex});
        scene.cone_materials.push_back(material());
        break;
      }
      case 2: {
        const uint32_t first = uint32_t(scene.positions.size());
        for (int k = 0; k < 3; ++k) scene.positions.push_back(place(p + point() * size));
        scene.triangles.push_back({first, first + 1, first + 2});
        scene.triangle_materials.push_back(material());
        break;
      }
      case 3: {
        const uint32_t first = uint32_t(scene.positions.size());
        const Vec3f u = point() * size, v = point() * size;
        for (const Vec3f corner : {p, p + u, p + u * 0.3f + v * 0.3f, p + v})  // concave
          scene.positions.push_back(place(corner));
        scene.polygons.push_back({first, 4});
        scene.polygon_materials.push_back(material());
        break;
      }
    }
  }
  for (int i = 0; i < count; i += 4) {
    // From a ball to a lens and a needle, in any orientation.
    const Vec3d up = normalize(Vec3d(point()));
    const Frame<double> frame(up);
    const auto axis = [&](Vec3d along) {
      const float part = std::abs(unit(rng));
      return Vec3f(along) * (size * 0.5f * std::max(0.05f, part * part) * scale);
    };
    scene.ellipsoids.push_back({place(point()), {axis(frame.u), axis(frame.v), axis(up)}});
    scene.ellipsoid_materials.push_back(material());
    const float radius = size * (0.3f + 0.2f * unit(rng)) * scale;
    scene.discs.push_back({place(point()), normalize(point()), radius, i % 8 ? 0 : radius / 3});
    scene.disc_materials.push_back(material());
  }
  const uint32_t first = uint32_t(scene.positions.size());
  for (const Vec3f corner : {Vec3f(-9, -9, -1.1f), {9, -9, -1.1f}, {9, 9, -1.1f}, {-9, 9, -1.1f}})
    scene.positions.push_back(place(corner));
  scene.polygons.push_back({first, 4});
  scene.polygon_materials.push_back(1);
  scene.planes.push_back({place({0, 0, -1.5f}), {0, 0, 1}});
  scene.plane_materials.push_back(1);
  return scene;
}

/// random_scene() with spheres and triangles that move, at times from 0 to 1.
inline Scene moving_scene(uint32_t seed) {
  Scene scene = random_scene(120, seed);
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> place(-2, 2);
  const auto point = [&] {
    const float x = place(rng), y = place(rng), z = place(rng);
    return Vec3f(x, y, z);
  };
  for (int i = 0; i < 60; ++i) {
    const Vec3f at = point(), to = at + point() * 0.5f;
    const float begin = float(i % 3) * 0.25f;
    scene.moving_spheres.push_back({at, to, 0.1f + 0.02f * float(i % 7), begin, begin + 0.5f});
    scene.moving_sphere_materials.push_back(MaterialId(i % 2));
    const Vec3f u = point() * 0.3f, v = point() * 0.3f;
    scene.moving_triangles.push_back(
        {{at, at + u, at + v}, {to, to + u, to + v * 1.5f}, begin, begin + 0.5f});
    scene.moving_triangle_materials.push_back(MaterialId(i % 2));
  }
  return scene;
}

}  // namespace raio::core::tests
