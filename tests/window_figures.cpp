// The response times of the window for docs/view.md. The real program on a separate display, with
// input as in the tests; times are taken here, outside it, when its log reports a picture on the
// screen.
#include <X11/keysym.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>
#include <thread>

#include "window_driver.h"

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr int kStarts = 9, kKeys = 50;
constexpr double kOrbitSeconds = 4, kMoveSeconds = 0.008;  // as often as a mouse tells

// For what the window remembers.
std::string state_folder() {
  const auto folder = std::filesystem::temp_directory_path() / "raio-window-figures";
  std::filesystem::create_directories(folder);
  return folder.string();
}

double median(std::vector<double> v) {
  std::ranges::sort(v);
  return v[v.size() / 2];
}

// Milliseconds from the start of the program until its first picture is visible.
double first_picture_ms(const raio::core::Display& display,
                        const std::vector<std::string>& arguments) {
  const auto start = Clock::now();
  raio::core::WindowDriver window(display, arguments, state_folder());
  const auto picture = window.wait_for("picture: ", 0);
  window.key(XK_q);
  return picture ? Milliseconds(picture->time - start).count() : NAN;
}

// Turns the scene in circles and counts the pictures.
void orbit(raio::core::WindowDriver& window, int width, int height) {
  window.move(width / 2, height / 2);
  window.button(1, true);
  const size_t from = window.mark();
  const auto start = Clock::now();
  for (double s = 0; s < kOrbitSeconds; s = Milliseconds(Clock::now() - start).count() * 1e-3) {
    window.move(int(width * (0.5 + 0.2 * std::sin(2 * s))),
                int(height * (0.5 + 0.05 * std::sin(3 * s))));
    std::this_thread::sleep_for(std::chrono::duration<double>(kMoveSeconds));
  }
  const size_t end = window.mark();
  window.button(1, false);
  std::vector<double> widths, heights;
  for (size_t at = from;;) {
    const auto line = window.wait_for("picture: ([0-9]+)x([0-9]+) samples 0", at);
    if (!line || line->next > end) break;
    widths.push_back(std::stod(line->groups[1])), heights.push_back(std::stod(line->groups[2]));
    at = line->next;
  }
  (void)window.wait_for("picture: .* samples [1-9]", end);
  if (widths.empty()) return fmt::print("  while it turns: no picture\n");
  fmt::print("  while it turns: {:.1f} pictures a second of {}x{} (median; least {}x{})\n",
             double(widths.size()) / kOrbitSeconds, median(widths), median(heights),
             std::ranges::min(widths), std::ranges::min(heights));
}

// From the press of a key to the first picture that shows its effect or view.
void press_keys(raio::core::WindowDriver& window, std::span<const unsigned long> keys) {
  std::vector<double> ms;
  for (int i = 0; i < kKeys; ++i) {
    const size_t from = window.mark();
    const auto pressed = Clock::now();
    window.key(keys[size_t(i) % keys.size()]);
    const auto request = window.wait_for("request: ([0-9]+)", from);
    if (!request) return;
    const auto seen =
        window.wait_for("picture: .* request " + request->groups[1] + " ", request->next);
    if (!seen) return;
    ms.push_back(Milliseconds(seen->time - pressed).count());
    // Refining by the time of the next press, at any moment of it.
    (void)window.picture(from);
    std::this_thread::sleep_for(std::chrono::milliseconds(100 + 37 * i % 100));
  }
  fmt::print("  from key to picture: {:.1f} ms (median of {}; worst {:.1f})\n", median(ms), kKeys,
             std::ranges::max(ms));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: raio_window_figures SCENE...\n");
    return 2;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // results as they come
  const raio::core::Display display;
  constexpr int kSide = 512;
  for (int i = 1; i < argc; ++i) {
    const std::vector<std::string> arguments = {std::filesystem::absolute(argv[i]).string(),
                                                "--size", fmt::format("{}x{}", kSide, kSide)};
    fmt::print("{}, {}x{}\n", std::filesystem::path(argv[i]).stem().string(), kSide, kSide);
    std::vector<double> starts;
    for (int k = 0; k < kStarts; ++k) starts.push_back(first_picture_ms(display, arguments));
    fmt::print("  first picture: {:.0f} ms (median of {}; worst {:.0f})\n", median(starts), kStarts,
               std::ranges::max(starts));
    raio::core::WindowDriver window(display, arguments, state_folder());
    orbit(window, kSide, kSide);
    // Figures have views, but no effects.
    const std::string suffix = std::filesystem::path(argv[i]).extension();
    if (suffix == ".nff" || suffix == ".p3f")
      press_keys(window, std::array<unsigned long, 5>{XK_a, XK_s, XK_d, XK_r, XK_t});
    else
      press_keys(window, std::array<unsigned long, 4>{XK_2, XK_1, XK_3, XK_1});
    window.key(XK_q);
    (void)window.end();
  }
  return 0;
}
