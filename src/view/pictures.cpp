#include "view/pictures.h"

#include <utility>

#include "view/window.h"

namespace raio::view {
namespace {

constexpr double kMessageSeconds = 4;

}  // namespace

Pictures::Pictures(std::unique_ptr<Session> session) {
  main.session = std::move(session);
  main.wish = 1;
  other.session = std::make_unique<Session>(Window::wake);
}

void Pictures::wish(const ViewState& state, const Stage& stage, double frame_s) {
  const RenderOptions o = state.wish(stage.picture_width, stage.picture_height);
  main.wish = main.session->wish({state.scene, o, frame_s});
}

void Pictures::wish_other(Other wanted, const ViewState& state, const Stage& stage,
                          double frame_s) {
  const bool is_new = std::exchange(wanted_, wanted) != wanted;
  if (wanted == Other::none) return other.session->rest();
  RenderOptions o = state.other_wish(stage.picture_width, stage.picture_height);
  if (wanted == Other::focus) {
    ViewState focus = state;
    focus.show(View::focus);
    o = focus.wish(stage.picture_width, stage.picture_height);
  }
  if (option_conflict(o, state.scene.get())) return;
  other.wish = other.session->wish({state.scene, o, frame_s});
  if (is_new) other.first_wish = other.wish;
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
      p && p->wish == main.wish && p->samples > 0 && (state.endless() || p->finished);
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

}  // namespace raio::view
