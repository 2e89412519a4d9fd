// Makes a scene in code, renders it with its depth, and writes both: necklace picture.png depth.npz.
// With a scene file as third argument that scene is rendered instead.
#include <raio/raio.h>

#include <cmath>
#include <iostream>
#include <vector>

namespace {

raio::Scene necklace() {
  raio::Scene scene;
  scene.set_background({0.2, 0.3, 0.5});
  scene.set_camera({{0, -9, 6}, {0, 0, 0}, {0, 0, 1}, 40});
  scene.add_light({5, -8, 10});
  const uint32_t floor = scene.add_material({{0.9, 0.85, 0.7}, 0.8, 0, 1, 0, 1});
  const uint32_t pearl = scene.add_material({{0.9, 0.2, 0.2}, 0.6, 0.3, 30, 0, 1});
  const std::vector<float> corners = {-6, -6, -1, 6, -6, -1, 6, 6, -1, -6, 6, -1};
  const std::vector<uint32_t> halves = {0, 1, 2, 0, 2, 3};
  scene.add_triangles(4, corners.data(), 2, halves.data(), nullptr, floor);
  std::vector<float> centers, radii;
  for (int i = 0; i < 24; ++i) {
    const double angle = i * 2 * 3.14159265358979 / 24;
    centers.insert(centers.end(), {float(3 * std::cos(angle)), float(3 * std::sin(angle)), 0.0f});
    radii.push_back(i % 2 == 0 ? 0.45f : 0.3f);
  }
  scene.add_spheres(radii.size(), centers.data(), radii.data(), pearl);
  return scene;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::cerr << "usage: necklace PICTURE.png DEPTH.npz [SCENE]\n";
    return 2;
  }
  const raio::Scene scene = argc > 3 ? raio::Scene::read(argv[3]) : necklace();
  raio::Settings settings;
  settings.set("size", "400x300").set("aa", "3").set("soft-shadows").set("threads", "2");
  raio::Job(scene, settings).run().write(argv[1]);
  raio::Job(scene, settings.set("channels", "depth")).run().write(argv[2]);
  return 0;
} catch (const raio::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
