// Undo and redo. The window's state is plain data, so its history is a list.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace raio::core::view {

/// A sequence of states, including the current one. The oldest are dropped.
template <class State>
class History {
 public:
  explicit History(State first) { states_.push_back(std::move(first)); }

  /// Records the state once it has settled: a new step if it differs from the current one. Returns
  /// whether it does.
  bool settle(const State& state) {
    if (state == states_[now_]) return false;
    states_.resize(now_ + 1, states_.front());
    states_.push_back(state);
    if (states_.size() > kMost) states_.erase(states_.begin());
    now_ = states_.size() - 1;
    return true;
  }
  /// Forgets the oldest state, unless it is the current one; returns whether it did.
  bool forget_oldest() {
    if (now_ == 0) return false;
    states_.erase(states_.begin());
    --now_;
    return true;
  }
  const std::vector<State>& states() const { return states_; }
  bool can_undo() const { return now_ > 0; }
  bool can_redo() const { return now_ + 1 < states_.size(); }
  /// One step back or forward, if possible; returns the current state.
  const State& undo() { return states_[now_ -= can_undo()]; }
  const State& redo() { return states_[now_ += can_redo()]; }

 private:
  static constexpr size_t kMost = 1000;
  std::vector<State> states_;
  size_t now_ = 0;
};

}  // namespace raio::core::view
