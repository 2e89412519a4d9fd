#include "app/terminal.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <utility>

#include "app/commands.h"
#include "app/output.h"
#include "base/clock.h"
#include "io/file.h"
#include "io/scene_file.h"

namespace raio::core::app {
namespace {

// The text in the terminal's last line, to be wiped before the next.
std::mutex g_terminal_mutex;
size_t g_progress_width = 0;

void put(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

std::string wiped_progress() {
  const size_t width = std::exchange(g_progress_width, 0);
  return width == 0 ? "" : "\r" + std::string(width, ' ') + "\r";
}

void show_progress(std::string text) {
  // A character in the last column would start a new line on some terminals.
  const size_t most = terminal_columns() - 1;
  if (text.size() > most) text.resize(most);
  const std::lock_guard lock(g_terminal_mutex);
  const size_t before = std::min(std::exchange(g_progress_width, text.size()), most);
  put(fmt::format("\r{:<{}}", text, before));
}

// Three digits, with a prefix for the power of a thousand.
std::string scaled(double value, std::string_view unit) {
  constexpr std::string_view kLetters = " kMGTP";
  size_t power = 0;
  while (value >= 999.5 && power + 1 < kLetters.size()) value /= 1000, ++power;
  const int digits = power == 0 ? 0 : value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
  std::string out = fmt::format("{:.{}f}", value, digits);
  if (power > 0 || !unit.empty()) out += ' ';
  if (power > 0) out += kLetters[power];
  return out += unit;
}

std::string progress_text(const WorkControl& control, double seconds, const std::string& label) {
  const double share = control.share();
  const std::string prefix = label.empty() ? "" : label + "  ";
  if (control.stage == Stage::reading) return prefix + "reading";
  if (control.stage == Stage::building)
    return fmt::format("{}{:3.0f} %  building", prefix, share * 100);
  const double rate = double(control.rays_done) / std::max(seconds, 1e-3);
  std::string left = "...";
  if (share > 0.01 || seconds > 2)
    left = share > 0 ? human_seconds(seconds * (1 - share) / share) : "unknown";
  return fmt::format("{}{:3.0f} %  {}  {} left", prefix, share * 100,
                     human_quantity(rate, "rays/s"), left);
}

}  // namespace

void print_line(std::string_view line) {
  std::string text(line);
  std::ranges::replace_if(text, [](unsigned char c) { return c < 32 || c == 127; }, '?');
  const std::lock_guard lock(g_terminal_mutex);
  put(wiped_progress() + text + "\n");
}

void print_error(std::string_view message) { print_line(fmt::format("raio: error: {}", message)); }

int interrupted() {
  print_line("raio: interrupted; nothing was written");
  return kInterrupted;
}

void print_diagnostics(const Diagnostics& said) {
  constexpr size_t kShown = 5;
  size_t notices = 0;
  for (const Diagnostic& d : said)
    if (d.is_error() || ++notices <= kShown) print_line(d.text("--"));
  if (notices > kShown) print_line(fmt::format("and {} more: raio info", notices - kShown));
}

int refuse(const Diagnostics& said) {
  const Error why = error_of(said.front());
  if (why.kind == ErrorKind::stopped) return fail(why);
  print_diagnostics(said);
  return status_of(why);
}

std::expected<Scene, int> load_scene(const std::string& path, bool quiet, Diagnostics* warnings,
                                     const ReadOptions& options) {
  auto result = read_scene(path, options);
  if (!result) return std::unexpected(refuse(result.error()));
  if (!quiet) print_diagnostics(result->notices);
  if (warnings) *warnings = std::move(result->notices);
  return std::move(result->scene);
}

ProgressLine::ProgressLine(const WorkControl& control, std::string_view mode, std::string label) {
  if (mode == "off" || (mode == "auto" && !is_terminal())) return;
  const auto show = [&control, start = Clock::now(), label = std::move(label)] {
    show_progress(progress_text(control, seconds_since(start), label));
  };
  if (mode == "on") show();  // always shown, however short the work
  ticker_ = Ticker(0.25, show);
}

ProgressLine::~ProgressLine() {
  ticker_ = {};
  const std::lock_guard lock(g_terminal_mutex);
  if (g_progress_width > 0) put(wiped_progress());
}

std::string human_seconds(double s) {
  if (s < 0.9995e-3) return fmt::format("{:.0f} us", s * 1e6);
  if (s < 0.9995) return fmt::format("{:.3g} ms", s * 1e3);
  if (s < 99.95) return fmt::format("{:.3g} s", s);
  if (s < 6000) return fmt::format("{}:{:02} min", int(s) / 60, int(s) % 60);
  return fmt::format("{:.1f} h", s / 3600);
}

std::string human_bytes(double bytes) { return scaled(bytes, "B"); }

std::string human_count(double count) { return scaled(count, ""); }

std::string human_quantity(double value, std::string_view unit) { return scaled(value, unit); }

std::string counted(double count, std::string_view thing) {
  return fmt::format("{} {}{}", human_count(count), thing, count == 1 ? "" : "s");
}

}  // namespace raio::core::app
