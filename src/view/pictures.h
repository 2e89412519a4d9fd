// The contents of the window's picture: the picture itself, and for comparison the same without the
// last effect switched, or the focal plane over it.
#pragma once

#include <mutex>

#include "render/session.h"
#include "view/side.h"
#include "view/stage.h"
#include "view/state.h"

namespace raio::core::view {

/// The picture over or beside the main one.
enum class Other { none, without, focus, compared, difference };

class Pictures {
 public:
  /// `session` already has its first request.
  explicit Pictures(std::unique_ptr<Session> session);

  Side main, other;

  /// `is_new`: pictures of earlier requests are of another kind. Nothing: the session rests.
  void request_other(const std::optional<SessionRequest>& request, bool is_new);

  Texture compared, difference;  // a picture of another program, and how the two differ

  /// By the user.
  void pause(bool on);
  /// By a measurement, from its thread: as if paused.
  void hold(bool on);
  /// Whether no session is busy. Also from other threads.
  bool are_idle() const { return main.session->is_idle() && other.session->is_idle(); }

  /// `split_at`: the position of the bar between the two, 0 to 1.
  void draw(const ViewState& state, const Stage& stage, Other shown, float split_at) const;

 private:
  std::mutex mutex_;
  bool paused_ = false, held_ = false;  // guarded by mutex_
};

/// One line at the bottom of the picture, for a while.
class Message {
 public:
  void say(std::string text, double now);
  const std::string& text() const { return text_; }
  /// How long it has been shown.
  double age(double now) const { return now - since_; }
  /// Removes it when its time is over; returns whether it did.
  bool expire(double now);

 private:
  std::string text_;
  double since_ = -1e9;
};

}  // namespace raio::core::view
