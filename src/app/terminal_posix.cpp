// Terminal, signals and programs with POSIX.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <limits>
#include <thread>

#include "app/commands.h"
#include "app/terminal.h"
#include "io/file.h"

namespace raio::core::app {
namespace {

constexpr std::array kStopSignals = {SIGINT, SIGTERM, SIGHUP};

// How long a command may take to stop.
constexpr int kPatienceMs = 300;

std::atomic<int> g_wake{-1};

// Restricted to what a signal handler may do.
void on_signal(int) {
  const int error = errno;
  const char byte = 0;
  [[maybe_unused]] const ssize_t written = ::write(g_wake, &byte, 1);
  errno = error;
}

/// A pipe that programs executed later do not inherit.
bool open_pipe(int (&ends)[2]) {
#ifdef __APPLE__  // without pipe2
  return ::pipe(ends) == 0 && ::fcntl(ends[0], F_SETFD, FD_CLOEXEC) == 0 &&
         ::fcntl(ends[1], F_SETFD, FD_CLOEXEC) == 0;
#else
  return ::pipe2(ends, O_CLOEXEC) == 0;
#endif
}

}  // namespace

size_t terminal_columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : std::numeric_limits<size_t>::max();
}

bool is_terminal() { return ::isatty(STDERR_FILENO) != 0; }
bool standard_output_is_terminal() { return ::isatty(STDOUT_FILENO) == 1; }

struct StopOnSignal::State {
  int wake[2] = {-1, -1};  // a pipe: a byte from the signal handler, closed by the destructor
  std::array<struct sigaction, kStopSignals.size()> before{};
  std::atomic<bool> patient{false};
  std::thread thread;
};

StopOnSignal::StopOnSignal(WorkControl* control) : state_(std::make_unique<State>()) {
  if (!open_pipe(state_->wake)) return;  // signals then have their default actions
  g_wake = state_->wake[1];
  auto& before = state_->before;
  for (size_t i = 0; i < kStopSignals.size(); ++i) {
    struct sigaction action{};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    ::sigaction(kStopSignals[i], nullptr, &before[i]);
    if (before[i].sa_handler != SIG_IGN) ::sigaction(kStopSignals[i], &action, nullptr);
  }
  state_->thread = std::thread([control, wake = state_->wake[0], &patient = state_->patient] {
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
    const bool more = ::poll(&next, 1, patient ? -1 : kPatienceMs) != 0;
    if (more && !signalled()) return;
    remove_unfinished_files();
    print_line("raio: interrupted");
    ::_exit(kInterrupted);
  });
}

StopOnSignal::~StopOnSignal() {
  if (!state_->thread.joinable()) return;
  for (size_t i = 0; i < kStopSignals.size(); ++i)
    ::sigaction(kStopSignals[i], &state_->before[i], nullptr);
  g_wake = -1;
  ::close(state_->wake[1]);
  state_->thread.join();
  ::close(state_->wake[0]);
}

void StopOnSignal::be_patient() { state_->patient = true; }

}  // namespace raio::core::app
