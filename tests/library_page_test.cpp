// The code on docs/library.md: compiled and run here, and compared with the page.
// The page's pieces of code use the same names again.
#pragma GCC diagnostic ignored "-Wshadow"

#include <gtest/gtest.h>
#include <raio/raio.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "temporary_folder.h"

namespace {

using Floats = std::vector<float>;

// Its working directory is its folder.
class LibraryPage : public raio::core::TemporaryFolder {
 protected:
  LibraryPage() { std::filesystem::current_path(folder()); }
  ~LibraryPage() override { std::filesystem::current_path(before_); }

  raio::Scene scene;
  raio::Settings settings = raio::Settings().set("size", {32, 24}).set("samples", 16);
  uint32_t material = 0;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Without comments and white space.
std::string bare(const std::string& code) {
  return std::regex_replace(code, std::regex("//[^\n]*|\\s"), "");
}

TEST_F(LibraryPage, Arrays) {
  struct Atom {
    float x, y, z, r;
  };
  const std::vector<Atom> atoms = {{0, 0, 0, 1}, {2, 0, 0, 0.5f}};
  const Floats packed = {0, 0, 0, 2, 0, 0}, sizes = {1, 0.5f}, shades = {1, 0, 0, 0, 1, 0};
  const float *centers = packed.data(), *radii = sizes.data(), *rgb = shades.data();
  const size_t count = 2;
  const auto load_centers = [&] { return packed; };
  const auto load_radii = [&] { return sizes; };
  // clang-format off
scene.add_spheres({centers, count}, {radii, count}, material);            // x y z each, packed: copied
scene.add_spheres({&atoms[0].x, count, sizeof(Atom)}, {&atoms[0].r, count, sizeof(Atom)}, material);
  // clang-format on
  {
    auto centers = std::make_shared<std::vector<float>>(load_centers());  // x y z x y z ...
    auto radii = std::make_shared<std::vector<float>>(load_radii());
    scene.add_spheres({centers->data(), radii->size(), 12, centers},
                      {radii->data(), radii->size(), 4, radii});
  }
  raio::Appearance look = material;
  look.colors = {rgb, count};
  scene.add_spheres({centers, count}, {radii, count}, look);
  EXPECT_EQ(scene.primitive_count(), 8u);
}

raio::Scene make_tree() {
  raio::Scene scene;
  const Floats center = {0, 0, 0}, radius = {1};
  scene.add_spheres({center.data(), 1}, {radius.data(), 1});
  return scene;
}

TEST_F(LibraryPage, InstancesAndRays) {
  const float matrices[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const size_t count = 1;
  const uint32_t tree = scene.add_prototype(make_tree());  // a Scene
  scene.add_instances(tree, {matrices, count}, "wood");    // 12 floats each: three rows of four
  const std::vector<raio::Ray> rays(3);
  std::vector<uint8_t> hidden(3);
  const raio::Accel accel(scene, raio::Settings().set("accel", "bvh"));
  raio::Hit hit = accel.closest({{0, 0, 9}, {0, 0, -1}});  // origin, direction
  if (hit.found()) std::cout << hit.distance << " to " << hit.index << '\n';
  accel.occluded(rays.size(), rays.data(), hidden.data());  // many at once
  EXPECT_EQ(hit.distance, 8);
  for (const char* from : {"0,-9,4", "6,-6,3"})
    raio::Job(accel, settings.set("from", from)).run().write(std::string(from) + ".png");
  EXPECT_EQ(entries(), 2);
}

TEST_F(LibraryPage, SettingsAndPixels) {
  const raio::Camera camera = scene.camera();
  // clang-format off
  settings.set("size", {320, 240}).set("dof").set("aperture", 0.1).set("channels", "depth,normal");
  settings.set("from", camera.from).set("seed", 7);
  for (const auto& option : raio::Settings::options()) std::cout << option.name << ": " << option.help << '\n';
  // clang-format on
  EXPECT_EQ(settings.get("aperture"), "0.1");
  settings = raio::Settings().set("size", {32, 24});
  raio::Film film = raio::Job(scene, settings.set("channels", "depth,normal")).run();
  std::vector<float> colors = film.rgba();  // width * height * 4
  int components = 0;
  std::vector<float> normals = film.channel("normal", &components);  // components == 3
  EXPECT_EQ(colors.size(), 4u * 32 * 24);
  EXPECT_EQ(normals.size(), 3u * 32 * 24);
  EXPECT_EQ(components, 3);
}

TEST_F(LibraryPage, PartsOfPictures) {
  const raio::Film a = raio::Job(scene, raio::Settings(settings).set("sample-range", "0:8")).run();
  const raio::Film b = raio::Job(scene, raio::Settings(settings).set("sample-range", "8:16")).run();
  const std::string bytes = b.to_bytes();  // to send
  raio::Film whole = raio::Film::merge({a, raio::Film::from_bytes(bytes)});
  if (!whole.complete())
    whole = raio::Job(scene, settings, whole).run();  // renders what is missing()
  whole.write("whole.png");
  EXPECT_EQ(whole.to_bytes(), raio::Job(scene, settings).run().to_bytes());
}

TEST_F(LibraryPage, FilmsOfJobsAtWork) {
  raio::Job job(scene, settings);
  job.on_progress([&](const raio::Progress& progress) {
    if (progress.stage == raio::Progress::Stage::rendering) job.film().write("so-far.raio");
  });
  raio::Film film = job.run();
  film.set("exposure", 1.5).set("tone", "agx").write("bright.png");  // without another render
  EXPECT_TRUE(std::filesystem::exists("bright.png"));
}

TEST_F(LibraryPage, ScenesAsBytes) {
  const auto bytes = std::make_shared<const std::string>(scene.to_bytes());
  const raio::Scene same = raio::Scene::from_bytes(*bytes, bytes);  // columns are read in place
  EXPECT_EQ(same.to_bytes(), *bytes);
}

TEST_F(LibraryPage, Cancelling) {
  raio::Job job(scene, settings);
  job.on_progress([&](const raio::Progress& progress) {
    if (progress.seconds > 60) job.cancel();
  });
  try {
    job.run();
  } catch (const raio::Error& error) {
    if (error.kind() != raio::ErrorKind::cancelled) throw;
  }
  make_tree().write("large.ply");
  raio::Executor executor(4);
  executor.on_progress([&](const raio::Progress& progress) {
    if (progress.seconds > 60) executor.cancel();
  });
  executor.run([&] {
    const raio::Scene scene = raio::Scene::read("large.ply");
    const raio::Accel accel(scene);
  });
}

TEST(LibraryPageText, IsThisCode) {
  const std::string page = text_of(RAIO_SOURCE_DIR "/docs/library.md");
  const std::string own = bare(text_of(RAIO_SOURCE_DIR "/tests/library_page_test.cpp"));
  const std::regex block("```cpp\n([^`]*)```");
  int blocks = 0;
  for (std::sregex_iterator at(page.begin(), page.end(), block), end; at != end; ++at) {
    const std::string code = (*at)[1];
    if (code.find("int main") != std::string::npos) continue;  // as in examples/cpp
    ++blocks;
    EXPECT_NE(own.find(bare(code)), std::string::npos) << code;
  }
  EXPECT_GT(blocks, 9);
}

}  // namespace
