#include "view/pictures.h"

#include <utility>

#include "view/window.h"

namespace raio::core::view {
namespace {

constexpr double kMessageSeconds = 4;

}  // namespace

Pictures::Pictures(std::unique_ptr<Session> session) {
  main.session = std::move(session);
  main.request = 1;
  other.session = std::make_unique<Session>(Window::wake);
}

void Pictures::request(const ViewState& state, const Stage& stage, double frame_s) {
  const RenderOptions o = state.request(stage.picture_width, stage.picture_height);
  main.request = main.session->request({state.scene, o, frame_s});
}

void Pictures::request_other(Other wanted, const ViewState& state, const Stage& stage,
                             double frame_s) {
  const bool is_new = std::exchange(wanted_, wanted) != wanted;
  if (wanted == Other::none) return other.session->rest();
  RenderOptions o = state.other_request(stage.picture_width, stage.picture_height);
  if (wanted == Other::focus) {
    ViewState focus = state;
    focus.show(View::focus);
    o = focus.request(stage.picture_width, stage.picture_height);
  }
  if (option_conflict(o, state.scene.get())) return;
  other.request = other.session->request({state.scene, o, frame_s});
  if (is_new) other.first_request = other.request;
}

void Pictures::pause(bool pause) const {
  main.session->pause(pause);
  other.session->pause(pause);
}

void Pictures::draw(const ViewState& state, const Stage& stage, float split_at) const {
  main.draw(stage, 0, 1, 1);
  if (!other.has_picture()) return;
  if (wanted_ == Other::focus) other.draw(stage, 0, 1, 0.6f);
  if (wanted_ != Other::without) return;
  other.draw(stage, split_at, 1, 1);
  const auto [left, right] = state.split_labels();
  draw_split_bar(stage, split_at, left, right);
}

std::shared_ptr<const SessionPicture> Pictures::whole(const ViewState& state) const {
  const auto& p = main.picture;
  const bool is_whole =
      p && p->request == main.request && p->samples > 0 && (state.endless() || p->finished);
  return is_whole ? p : nullptr;
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
