// Random input to the window, for sanitized builds: keys, clicks, drags, the wheel and new sizes,
// on scenes, molecules and meshes, whose files change, break and vanish meanwhile. `./check noise`.
#include <X11/keysym.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "window_driver.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kRound(60);  // with one file
constexpr std::array kScenes = {"shapes.nff",    "course/glass.nff", "tetra.nff",    "lens.p3f",
                                "fullerene.xyz", "droplet.dump",     "nanotube.gro", "quartz.cif",
                                "spiral.ply",    "knot.obj",         "crates.gltf"};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Noise {
 public:
  Noise(const Display& display, fs::path folder, unsigned seed)
      : display_(display), folder_(std::move(folder)), random_(seed) {}

  /// Whether the window lived as long as it was to live, and ended well.
  bool round(const std::string& scene, Clock::time_point end) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "state/raio");
    fs::copy(fs::path(RAIO_SOURCE_DIR) / "scenes" / scene, folder_);
    name_ = fs::path(scene).filename().string();
    whole_ = bytes_of(folder_ / name_);
    std::ofstream(folder_ / "state/raio/window") << "size 900 700\n";
    const std::string render =
        fmt::format("cd '{}' && '{}' render '{}' --size 90x60 --quiet -o b.ppm", folder_.string(),
                    RAIO_PROGRAM, name_);
    std::vector<std::string> arguments = {name_};
    if (one_in(3) && std::system(render.c_str()) == 0)
      arguments.insert(arguments.end(), {"--compare", "b.ppm"});
    WindowDriver window(display_, arguments, folder_.string());
    size_t inputs = 0;
    for (; Clock::now() < end && window.is_running(); ++inputs) {
      act(window);
      std::this_thread::sleep_for(std::chrono::milliseconds(up_to(60)));
    }
    // Some keys quit, others end what is open first.
    for (int i = 0; i < 200 && window.is_running(); ++i) {
      window.key(XK_Escape);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    if (window.is_running()) return report(window, scene, inputs, "does not end");
    const int status = window.end();
    if (status != 0) return report(window, scene, inputs, fmt::format("ended with {}", status));
    for (const char* finding : {"Sanitizer", "runtime error"})
      if (window.log().find(finding) != std::string::npos)
        return report(window, scene, inputs, finding);
    fmt::print("{}: {} inputs\n", scene, inputs);
    return true;
  }

 private:
  int up_to(int most) { return std::uniform_int_distribution<int>(0, most)(random_); }
  bool one_in(int n) { return up_to(n - 1) == 0; }

  bool report(const WindowDriver& window, const std::string& scene, size_t inputs,
              const std::string& what) {
    fmt::print(stderr, "{}\n{}: after {} inputs: {}\n", window.log(), scene, inputs, what);
    return false;
  }

  void act(WindowDriver& window) {
    using enum WindowDriver::Held;
    const auto x = [this] { return up_to(900); };
    const auto y = [this] { return up_to(700); };
    switch (up_to(19)) {
      case 0:
      case 1:
      case 2:
      case 3:
      case 4:
      case 5: {
        // All but those that end the program.
        constexpr std::array kOthers = {XK_space, XK_comma, XK_period,   XK_Return,
                                        XK_Home,  XK_F1,    XK_F2,       XK_F3,
                                        XK_Left,  XK_Up,    XK_BackSpace};
        const int key = up_to(36 + int(kOthers.size()));
        const int letter = XK_a + key;
        if (key < 26)
          return window.key(letter == XK_q ? XK_r : (unsigned long)letter, one_in(5)   ? shift
                                                                           : one_in(8) ? ctrl
                                                                                       : nothing);
        if (key < 36) return window.key((unsigned long)(XK_0 + key - 26));
        return window.key(
            (unsigned long)(kOthers[size_t(std::min(key - 36, int(kOthers.size()) - 1))]));
      }
      case 6:
      case 7:
      case 8:
      case 9:
      case 10:
        return window.click(x(), y());
      case 11:
      case 12:
      case 13:
        return window.drag(x(), y(), x(), y(), 1 + up_to(2));
      case 14:
      case 15:
        return window.wheel(x(), y(), up_to(8) - 4);
      case 16:
        if (one_in(3)) window.resize(60 + up_to(1100), 60 + up_to(900));
        return;
      case 17:
        if (one_in(6)) window.minimise(true), window.minimise(false);
        return;
      default:
        return change_files();
    }
  }

  void change_files() {
    if (!one_in(6)) return;
    const fs::path path = folder_ / name_;
    std::string text = whole_;
    switch (up_to(5)) {
      case 0:
        fs::remove(path);
        return;
      case 1:
        text.resize(size_t(up_to(int(text.size()))));
        break;
      case 2:
        for (int i = 0; i < 5; ++i) text[size_t(up_to(int(text.size()) - 1))] = char(up_to(255));
        break;
      case 3:
        std::ofstream(folder_ / "b.ppm") << "P6 90 60 255\n"
                                         << std::string(size_t(up_to(16200)), 'x');
        return;
      default:
        break;
    }
    std::ofstream(path, std::ios::binary) << text;
  }

  const Display& display_;
  fs::path folder_;
  std::mt19937 random_;
  std::string name_, whole_;
};

}  // namespace
}  // namespace raio::core

int main(int argc, char** argv) {
  using namespace raio::core;
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 60;
  const unsigned seed = argc > 2 ? unsigned(std::atoi(argv[2])) : std::random_device()();
  fmt::print("seed {}\n", seed);
  const Display display;
  if (display.name().empty()) {
    fmt::print(stderr, "Xvfb does not start; packages.txt has it\n");
    return 3;
  }
  Noise noise(display, fs::temp_directory_path() / fmt::format("raio-noise-{}", seed), seed);
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  for (size_t i = seed; Clock::now() < end; ++i)
    if (!noise.round(kScenes[i % kScenes.size()], std::min(end, Clock::now() + kRound))) return 1;
  return 0;
}
