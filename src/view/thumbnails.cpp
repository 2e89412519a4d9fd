#include "view/thumbnails.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>
#include <utility>

#include "io/scene_file.h"
#include "render/picture.h"
#include "render/render.h"

namespace raio::core::view {
namespace {

constexpr int kCardWidth = 240, kCardHeight = 160;
constexpr int kSamples = 4, kSamplesOfFigures = 16;  // whose sky is sampled, too
constexpr uintmax_t kMostBytes = 16'000'000;         // compressed ones grow tenfold

// The lines of text after "#" at the head of a file.
std::string comment_of(const std::string& path) {
  std::ifstream file(path);
  std::string about, line;
  while (about.size() < 300 && std::getline(file, line) && line.starts_with("# "))
    about += (about.empty() ? "" : " ") + line.substr(2);
  return about;
}

}  // namespace

std::expected<Thumbnail, std::string> make_thumbnail(const std::string& path) try {
  std::error_code ignored;
  if (const auto bytes = std::filesystem::file_size(path, ignored);
      bytes != uintmax_t(-1) && bytes > kMostBytes)
    return std::unexpected(fmt::format("{} MB: open it to see it", bytes / 1'000'000));
  const auto read = read_scene(path, kForPictures);
  if (!read) return std::unexpected(read.error().front().text());
  const Scene& scene = read->scene;
  RenderOptions options;
  const Camera camera = camera_of(scene, options);
  // All pictures have the same shape: the middle of wider ones, more at the sides of others.
  options.width = kCardWidth, options.height = kCardHeight;
  if (camera.height > 0 && camera.width * kCardHeight > kCardWidth * camera.height) {
    options.width =
        std::min(int(int64_t(kCardHeight) * camera.width / camera.height), 4 * kCardWidth);
    const int left = (options.width - kCardWidth) / 2;
    options.crop = Crop{left, 0, left + kCardWidth, kCardHeight};
  }
  options.samples =
      lights_from_all_sides(integrator_of(options, scene)) ? kSamplesOfFigures : kSamples;
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel, settings.one_sided);
  if (!accel) return std::unexpected(accel.error().text());
  auto film = make_film(scene, settings);
  if (!film) return std::unexpected(film.error().text());
  WorkControl control;
  if (!render(scene, **accel, settings, **film, control).finished)
    return std::unexpected("stopped");
  Thumbnail made{picture_of(**film, settings.view), scene.primitive_count(), comment_of(path)};
  tone_map(made.image, {}, settings.tone, settings.exposure);
  return made;
} catch (const std::bad_alloc&) {
  return std::unexpected(std::string(kNoMemory));
}

Thumbnails::Thumbnails(std::vector<std::string> paths, std::function<void()> on_made) {
  work_ = std::async(
      std::launch::async, [this, paths = std::move(paths), on_made = std::move(on_made)] {
        const int threads = std::max(1, default_threads() / 2);
        for (const std::string& path : paths) {
          auto thumbnail = Executor(threads, &control_).run([&] { return make_thumbnail(path); });
          if (control_.stop) return;
          {
            const std::lock_guard lock(mutex_);
            made_.push_back({path, std::move(thumbnail)});
          }
          on_made();
        }
      });
}

std::vector<Thumbnails::Made> Thumbnails::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(made_, {});
}

}  // namespace raio::core::view
