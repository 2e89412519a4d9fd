#include "view/pictures.h"

#include <utility>

#include "view/window.h"

namespace raio::core::view {
namespace {

constexpr double kMessageSeconds = 4;

}  // namespace

Pictures::Pictures(std::unique_ptr<Session> session) {
  main.session = std::move(session);
  other.session = std::make_unique<Session>(Window::wake);
}

void Pictures::request_other(const std::optional<SessionRequest>& request, bool is_new) {
  if (!request) return other.session->rest();
  const uint64_t number = other.session->request(*request);
  if (is_new) other.first_request = number;
}

void Pictures::pause(bool on) {
  const std::lock_guard lock(mutex_);
  paused_ = on;
  for (const Side* side : {&main, &other}) side->session->pause(paused_ || held_);
}

void Pictures::hold(bool on) {
  const std::lock_guard lock(mutex_);
  held_ = on;
  for (const Side* side : {&main, &other}) side->session->pause(paused_ || held_);
}

void Pictures::draw(const ViewState& state, const Stage& stage, Other shown, float split_at) const {
  main.draw(stage, 0, 1, 1);
  const bool is_compared = shown == Other::compared;
  if (is_compared || shown == Other::difference)
    (is_compared ? compared : difference)
        .draw(stage.lo, stage.hi, is_compared ? split_at : 0, 1, 1, stage.sharp);
  const auto [left, right] = state.split_labels();
  if (is_compared) draw_split_bar(stage, split_at, left, right);
  if (!other.has_picture()) return;
  if (shown == Other::focus) other.draw(stage, 0, 1, 0.6f);
  if (shown != Other::without) return;
  other.draw(stage, split_at, 1, 1);
  draw_split_bar(stage, split_at, left, right);
}

void Message::say(std::string text, double now) {
  text_ = std::move(text);
  since_ = now;
}

bool Message::expire(double now) {
  if (text_.empty() || age(now) <= kMessageSeconds) return false;
  text_.clear();
  return true;
}

}  // namespace raio::core::view
