#include "app/terminal.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <limits>
#include <mutex>
#include <utility>

#include "app/commands.h"
#include "io/file.h"
#include "io/scene_file.h"

namespace raio::app {
namespace {

constexpr std::array kStopSignals = {SIGINT, SIGTERM, SIGHUP};

// How long a command that was asked to end may take for it.
constexpr int kPatienceMs = 300;

std::atomic<int> g_wake{-1};

// Only what a signal handler may do.
void on_signal(int) {
  const int error = errno;
  const char byte = 0;
  [[maybe_unused]] const ssize_t written = ::write(g_wake, &byte, 1);
  errno = error;
}

// What stands in the last line of the terminal and is to be wiped before the next.
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

size_t terminal_columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : std::numeric_limits<size_t>::max();
}

void show_progress(std::string text) {
  // A character in the last column would begin a new line on some terminals.
  const size_t most = terminal_columns() - 1;
  if (text.size() > most) text.resize(most);
  const std::lock_guard lock(g_terminal_mutex);
  const size_t before = std::min(std::exchange(g_progress_width, text.size()), most);
  put(fmt::format("\r{:<{}}", text, before));
}

std::string scaled(double value, double step, std::string_view units, int decimals = 3) {
  size_t unit = 0;
  while (value >= step * 0.9995 && unit + 1 < units.size()) value /= step, ++unit;
  const int digits = value < 10 ? decimals - 1 : value < 100 ? decimals - 2 : 0;
  const std::string number = fmt::format("{:.{}f}", value, unit == 0 ? 0 : digits);
  return units[unit] == ' ' ? number : number + " " + units[unit];
}

std::string progress_text(const RenderControl& control, double seconds, const std::string& label) {
  const double total = double(std::max<uint64_t>(1, control.work_total));
  const double share = double(control.work_done) / total;
  const double rate = double(control.rays_done) / std::max(seconds, 1e-3);
  std::string left = "...";
  if (share > 0.01 || seconds > 2)
    left = share > 0 ? human_seconds(seconds * (1 - share) / share) : "unknown";
  return fmt::format("{}{:3.0f} %  {}rays/s  {} left", label.empty() ? "" : label + "  ",
                     share * 100, human_count(rate) + (rate < 1000 ? " " : ""), left);
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

std::expected<Scene, int> load_scene(const std::string& path, bool quiet) {
  auto result = read_scene(path);
  if (!result) {
    for (const Diagnostic& d : result.error()) print_line(d.text());
    const bool machine = result.error().front().message == kNoMemory;
    return std::unexpected(int(machine ? kNoResource : kBadInput));
  }
  if (!quiet)
    for (const Diagnostic& d : result->warnings) print_line(d.text());
  return std::move(result->scene);
}

StopOnSignal::StopOnSignal(RenderControl* control) {
  if (::pipe2(wake_, O_CLOEXEC) != 0) return;  // signals then do what they do by themselves
  g_wake = wake_[1];
  for (size_t i = 0; i < kStopSignals.size(); ++i) {
    struct sigaction action{};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    ::sigaction(kStopSignals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) ::sigaction(kStopSignals[i], &action, nullptr);
  }
  thread_ = std::thread([this, control, wake = wake_[0]] {
    char byte = 0;
    const auto signalled = [&] {
      ssize_t count = 0;
      while ((count = ::read(wake, &byte, 1)) < 0 && errno == EINTR) {
      }
      return count == 1;
    };
    if (!signalled()) return;
    if (control) control->stop = true;
    pollfd next{wake, POLLIN, 0};
    const bool more = ::poll(&next, 1, patient_ ? -1 : kPatienceMs) != 0;
    if (more && !signalled()) return;
    remove_unfinished_files();
    print_line("raio: interrupted");
    ::_exit(kInterrupted);
  });
}

StopOnSignal::~StopOnSignal() {
  if (!thread_.joinable()) return;
  for (size_t i = 0; i < kStopSignals.size(); ++i)
    ::sigaction(kStopSignals[i], &before_[i], nullptr);
  g_wake = -1;
  ::close(wake_[1]);
  thread_.join();
  ::close(wake_[0]);
}

ProgressLine::ProgressLine(const RenderControl& control, std::string_view mode, std::string label) {
  if (mode == "off" || (mode == "auto" && !isatty(STDERR_FILENO))) return;
  // Who asked for it sees it however short the work is.
  const bool at_once = mode == "on";
  thread_ = std::jthread([&control, at_once, label = std::move(label)](std::stop_token done) {
    using namespace std::chrono;
    const auto start = steady_clock::now();
    const auto show = [&] {
      show_progress(
          progress_text(control, duration<double>(steady_clock::now() - start).count(), label));
    };
    if (at_once) show();
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, done, milliseconds(250), [&] { return done.stop_requested(); }))
      show();
    const std::lock_guard terminal_lock(g_terminal_mutex);
    put(wiped_progress());
  });
}

ProgressLine::~ProgressLine() = default;

std::string human_seconds(double s) {
  if (s < 0.9995e-3) return fmt::format("{:.0f} us", s * 1e6);
  if (s < 0.9995) return fmt::format("{:.3g} ms", s * 1e3);
  if (s < 99.95) return fmt::format("{:.3g} s", s);
  if (s < 6000) return fmt::format("{}:{:02} min", int(s) / 60, int(s) % 60);
  return fmt::format("{:.1f} h", s / 3600);
}

std::string human_bytes(double bytes) {
  return scaled(bytes, 1000, " kMGTP") + (bytes < 1000 ? " B" : "B");
}

std::string human_count(double count) { return scaled(count, 1000, " kMGTP"); }

size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return size_t(usage.ru_maxrss) * 1024;
}

}  // namespace raio::app
