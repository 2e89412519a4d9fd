// Standard C++, which has no terminals, only two signals and no other programs.
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <limits>

#include "app/commands.h"
#include "app/terminal.h"

namespace raio::core::app {
namespace {

constexpr std::array kStopSignals = {SIGINT, SIGTERM};

std::atomic<WorkControl*> g_control{nullptr};
static_assert(std::atomic<WorkControl*>::is_always_lock_free &&
              decltype(WorkControl::stop)::is_always_lock_free);

// Only uses what a signal handler may use.
void on_signal(int signal) {
  std::signal(signal, SIG_DFL);  // so that the next one ends the program
  if (WorkControl* const control = g_control)
    control->stop = true;
  else
    std::_Exit(kInterrupted);
}

}  // namespace

bool is_terminal() { return false; }
bool standard_output_is_terminal() { return false; }

size_t terminal_columns() { return std::numeric_limits<size_t>::max(); }

struct StopOnSignal::State {
  std::array<void (*)(int), kStopSignals.size()> before{};
};

StopOnSignal::StopOnSignal(WorkControl* control) : state_(std::make_unique<State>()) {
  g_control = control;
  for (size_t i = 0; i < kStopSignals.size(); ++i) {
    state_->before[i] = std::signal(kStopSignals[i], on_signal);
    if (state_->before[i] == SIG_IGN) std::signal(kStopSignals[i], SIG_IGN);
  }
}

StopOnSignal::~StopOnSignal() {
  for (size_t i = 0; i < kStopSignals.size(); ++i)
    if (state_->before[i] != SIG_ERR) std::signal(kStopSignals[i], state_->before[i]);
  g_control = nullptr;
}

void StopOnSignal::be_patient() {}

}  // namespace raio::core::app
