// What was, for undo and redo. The state of the window is plain data, so its history is a list.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace raio::view {

/// States one after another; the present one is among them. The oldest are forgotten.
template <class State>
class History {
 public:
  explicit History(State first) { states_.push_back(std::move(first)); }

  /// What is so now, once it has settled: a new step if it differs from the present one.
  void settle(const State& state) {
    if (state == states_[now_]) return;
    states_.resize(now_ + 1, states_.front());
    states_.push_back(state);
    if (states_.size() > kMost) states_.erase(states_.begin());
    now_ = states_.size() - 1;
  }
  bool can_undo() const { return now_ > 0; }
  bool can_redo() const { return now_ + 1 < states_.size(); }
  /// One step back or forth, if there is one; the present state.
  const State& undo() { return states_[now_ -= can_undo()]; }
  const State& redo() { return states_[now_ += can_redo()]; }

 private:
  static constexpr size_t kMost = 1000;
  std::vector<State> states_;
  size_t now_ = 0;
};

}  // namespace raio::view
