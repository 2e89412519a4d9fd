// Makes a scene in code, renders it with its depth, and writes both: necklace picture.png
// depth.npz. With a scene file as third argument that scene is rendered instead.
#include <raio/raio.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <vector>

namespace {

// In Raio's layout of spheres, so these are read in place.
struct Pearl {
  float center[3], radius;
};

raio::Scene necklace() {
  raio::Scene scene;
  scene.set_background({0.2, 0.3, 0.5});
  scene.set_camera({{0, -9, 6}, {0, 0, 0}, {0, 0, 1}, 40});
  scene.add_light({5, -8, 10});
  const uint32_t floor = scene.add_material({{0.9, 0.85, 0.7}, 0.8, 0, 1, 0, 1});
  const uint32_t pearl = scene.add_material({{0.9, 0.2, 0.2}, 0.6, 0.3, 30, 0, 1});
  const float center[] = {0, 0, -1}, up[] = {0, 0, 1}, radius[] = {6};
  scene.add_discs({center, 1}, {up, 1}, {radius, 1}, {}, floor);

  const auto pearls = std::make_shared<std::vector<Pearl>>();
  std::vector<float> colors;
  for (int i = 0; i < 24; ++i) {
    const double angle = i * 2 * 3.14159265358979 / 24;
    const auto x = float(3 * std::cos(angle)), y = float(3 * std::sin(angle));
    pearls->push_back({{x, y, 0}, i % 2 == 0 ? 0.45f : 0.3f});
    colors.insert(colors.end(), {0.9f, 0.2f, float(i) / 24});
  }
  raio::Appearance look = pearl;
  look.colors = {colors.data(), 24};  // copied
  scene.add_spheres({pearls->data()->center, 24, sizeof(Pearl), pearls},
                    {&pearls->data()->radius, 24, sizeof(Pearl), pearls}, look);
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
  settings.set("size", {400, 300}).set("aa", 3).set("soft-shadows").set("threads", 2);
  const raio::Accel accel(scene);  // for both pictures
  raio::Job(accel, settings).run().write(argv[1]);
  raio::Job(accel, settings.set("channels", "depth")).run().write(argv[2]);
  const raio::Hit hit = accel.closest({{0, 0, 9}, {0.3, 0, -1}});
  if (hit.found()) std::cout << "a ray from above travels " << hit.distance << '\n';
  return 0;
} catch (const raio::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
