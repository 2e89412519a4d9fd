#include "window_driver.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

namespace raio::core {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::minutes kPatience(
    4);  // a machine may be slow; a program that hangs is worse

pid_t start(const std::vector<std::string>& arguments, const std::vector<std::string>& settings,
            const std::string& folder, int from, int to) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, from, to);
  if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::vector<char*> argv, environment;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  for (const std::string& s : settings) environment.push_back(const_cast<char*>(s.c_str()));
  for (char** e = environ; *e; ++e)
    if (std::string_view(*e).substr(0, 8) != "DISPLAY=") environment.push_back(*e);
  argv.push_back(nullptr), environment.push_back(nullptr);
  pid_t process = -1;
  const int failed =
      posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  return failed ? -1 : process;
}

}  // namespace

Display::Display() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
  process_ = start({"Xvfb", "-displayfd", "9", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"},
                   {}, {}, ends[1], 9);
  ::close(ends[1]);
  char c = 0;
  std::string number;
  while (::read(ends[0], &c, 1) == 1 && c != '\n') number += c;
  ::close(ends[0]);
  if (!number.empty()) name_ = ":" + number;
}

Display::~Display() {
  if (process_ <= 0) return;
  ::kill(process_, SIGTERM);
  // It may miss the signal while it starts anew after its last client.
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (::waitpid(process_, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > give_up) ::kill(process_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

WindowDriver::WindowDriver(const Display& display, const std::vector<std::string>& arguments,
                           const std::string& folder) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
  log_end_ = ends[0];
  std::vector<std::string> command = {RAIO_PROGRAM, "view"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.emplace_back("--log");
  // Its memory file is separate, and its texts are English.
  process_ = start(command,
                   {"DISPLAY=" + display.name(), "LIBGL_ALWAYS_SOFTWARE=1", "LC_ALL=C.UTF-8",
                    "XDG_STATE_HOME=" + (folder.empty() ? "/nowhere" : folder + "/state")},
                   folder, ends[1], STDERR_FILENO);
  ::close(ends[1]);
  reader_ = std::thread([this] { read_log(); });
  if (!wait_for("picture: .* samples [1-9]", 0)) return;

  // A window may close while it is being queried.
  XSetErrorHandler([](_XDisplay*, XErrorEvent*) { return 0; });
  x_ = XOpenDisplay(display.name().c_str());
  if (!x_) return;
  // The only visible window; there is no window manager.
  while (!window_ && is_running()) {
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    XQueryTree(x_, DefaultRootWindow(x_), &root, &parent, &children, &count);
    for (unsigned i = 0; i < count; ++i) {
      XWindowAttributes attributes;
      if (XGetWindowAttributes(x_, children[i], &attributes) && attributes.map_state == IsViewable)
        window_ = children[i];
    }
    if (children) XFree(children);
  }
  XSetInputFocus(x_, window_, RevertToPointerRoot, CurrentTime);
  XSync(x_, False);
  if (const auto place = wait_for("place: ([0-9]+),([0-9]+)", 0))
    left_ = std::stoi(place->groups[1]), top_ = std::stoi(place->groups[2]);
}

WindowDriver::~WindowDriver() {
  // Asked first: a killed process does not report coverage or leaks.
  if (x_ && is_running()) key('q');
  for (int i = 0; i < 100 && x_ && is_running(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (is_running()) ::kill(process_, SIGKILL);
  (void)end();
  if (x_) XCloseDisplay(x_);
}

void WindowDriver::read_log() {
  std::string rest;
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t count = ::read(log_end_, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (count <= 0) {
      log_is_closed_ = true;
      news_.notify_all();
      return;
    }
    rest.append(buffer.data(), size_t(count));
    for (size_t end = 0; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1))
      lines_.emplace_back(rest.substr(0, end), now);
    news_.notify_all();
  }
}

size_t WindowDriver::mark() const {
  const std::lock_guard lock(mutex_);
  return lines_.size();
}

std::optional<WindowDriver::Line> WindowDriver::wait_for(const std::string& pattern, size_t from) {
  const std::regex regex(pattern);
  const auto deadline = Clock::now() + kPatience;
  std::unique_lock lock(mutex_);
  while (true) {
    for (; from < lines_.size(); ++from) {
      std::smatch match;
      if (!std::regex_search(lines_[from].first, match, regex)) continue;
      Line line{{}, from + 1, lines_[from].second};
      for (const auto& group : match) line.groups.push_back(group.str());
      return line;
    }
    if (log_is_closed_) return std::nullopt;
    if (news_.wait_until(lock, deadline) == std::cv_status::timeout) return std::nullopt;
  }
}

std::optional<WindowDriver::Picture> WindowDriver::picture(size_t from, int samples) {
  const auto request = wait_for("request: ([0-9]+)", from);
  if (!request) return std::nullopt;
  for (size_t at = request->next;;) {
    const auto line = wait_for("picture: .* samples ([0-9]+) request ([0-9]+) sum ([0-9a-f]+)", at);
    if (!line) return std::nullopt;
    at = line->next;
    const Picture found{std::stoi(line->groups[1]), line->groups[3]};
    if (std::stoi(line->groups[2]) >= std::stoi(request->groups[1]) && found.samples >= samples)
      return found;
  }
}

void WindowDriver::hold(unsigned long keysym, bool down) {
  XTestFakeKeyEvent(x_, XKeysymToKeycode(x_, keysym), down, CurrentTime);
  XFlush(x_);
}

void WindowDriver::key(unsigned long keysym, Held held) {
  // For GLFW, a key pressed again within 20 ms is a repeat, or even in the same millisecond the
  // same event, whatever other keys were pressed in between.
  auto& last_press = last_presses_[keysym];
  std::this_thread::sleep_until(last_press + std::chrono::milliseconds(50));
  constexpr unsigned long kShift = 0xffe1, kCtrl = 0xffe3;
  std::vector<unsigned long> others;
  if (held == Held::ctrl || held == Held::ctrl_shift) others.push_back(kCtrl);
  if (held == Held::shift || held == Held::ctrl_shift) others.push_back(kShift);
  for (const unsigned long other : others) hold(other, true);
  hold(keysym, true), hold(keysym, false);
  last_press = Clock::now();
  for (const unsigned long other : others) hold(other, false);
}

void WindowDriver::move(int x, int y) {
  XTestFakeMotionEvent(x_, -1, left_ + x, top_ + y, CurrentTime);
  XFlush(x_);
}

void WindowDriver::button(int number, bool down) {
  XTestFakeButtonEvent(x_, unsigned(number), down, CurrentTime);
  XFlush(x_);
}

void WindowDriver::click(int x, int y) {
  move(x, y);
  button(1, true), button(1, false);
}

void WindowDriver::drag(int x0, int y0, int x1, int y1, int number) {
  constexpr int kMoves = 8;
  move(x0, y0);
  button(number, true);
  for (int i = 1; i <= kMoves; ++i) move(x0 + (x1 - x0) * i / kMoves, y0 + (y1 - y0) * i / kMoves);
  button(number, false);
}

void WindowDriver::wheel(int x, int y, int steps) {
  move(x, y);
  for (int i = 0; i < std::abs(steps); ++i)
    for (const bool down : {true, false}) button(steps > 0 ? 4 : 5, down);
}

void WindowDriver::resize(int width, int height) {
  XResizeWindow(x_, window_, unsigned(width), unsigned(height));
  XFlush(x_);
}

void WindowDriver::minimise(bool on) {
  on ? XUnmapWindow(x_, window_) : XMapWindow(x_, window_);
  XSync(x_, False);
  if (!on) {
    XWindowAttributes attributes;
    while (XGetWindowAttributes(x_, window_, &attributes) && attributes.map_state != IsViewable) {
    }
    XSetInputFocus(x_, window_, RevertToPointerRoot, CurrentTime);
    XSync(x_, False);
  }
}

std::string WindowDriver::title() const {
  char* name = nullptr;
  if (!XFetchName(x_, window_, &name) || !name) return {};
  std::string title(name);
  XFree(name);
  return title;
}

double WindowDriver::processor_s() const {
  std::ifstream stat("/proc/" + std::to_string(process_) + "/stat");
  std::string text;
  std::getline(stat, text);
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;  // from the state to the page faults
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / double(::sysconf(_SC_CLK_TCK));
}

bool WindowDriver::is_running() {
  if (process_ <= 0) return false;
  if (::waitpid(process_, &status_, WNOHANG) != process_) return true;
  process_ = -1;
  return false;
}

int WindowDriver::end() {
  if (process_ > 0) {
    if (reader_.joinable()) reader_.join();  // it reads until the program ends
    ::waitpid(process_, &status_, 0);
    process_ = -1;
  }
  if (reader_.joinable()) reader_.join();
  if (log_end_ >= 0) ::close(std::exchange(log_end_, -1));
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
}

std::string WindowDriver::log() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (const auto& [line, time] : lines_) text += line + "\n";
  return text;
}

}  // namespace raio::core
