// Rendering for someone who watches and keeps changing their mind: a thread that always works on
// the newest request. No window in it: a window says what it wants and looks at what there is.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "accel/accel.h"
#include "base/clock.h"
#include "base/median.h"
#include "integrate/film.h"
#include "io/image/image.h"
#include "render/options.h"
#include "render/render.h"
#include "scene/scene.h"

namespace raio {

/// A scene with its structure, which is that of an earlier version of the scene where only lights,
/// background or materials have changed since.
struct BakedScene {
  std::shared_ptr<const Scene> scene;
  AccelOptions options;
  bool one_sided = false;
  std::shared_ptr<const Accel> accel;  // keeps the scene of which it was built
  AccelInfo info;
  double build_s = 0;
};

struct SessionRequest {
  std::shared_ptr<const Scene> scene;
  RenderOptions options;  // as the command line has them, with a size
  /// While something moves: a picture in about so many seconds, as fine as that allows. 0: in full,
  /// sample after sample until there are as many as the options say.
  double frame_s = 0;
};

/// What there is to see. Immutable once handed out.
struct SessionPicture {
  uint64_t request = 0;  // the number of the request that it answers
  std::shared_ptr<const Image> image;
  int samples = 0;  // of every pixel; 0: a preview, coarse in part or whole, without figures
  bool finished = false;
  RenderSettings settings;  // of the size in full
  std::shared_ptr<const BakedScene> baked;
  /// Seconds that a sample of all pixels takes, told from whole samples that were rendered while
  /// nothing was to be shown, or from one that took long. Zero until there are some.
  MedianInterval sample_s{};
  double render_s = 0;         // all samples together
  RayCounts rays;              // likewise
  std::optional<Error> error;  // why the request got no picture; the image is an older one
};

/// How far a request is that has no whole sample yet.
struct SessionProgress {
  enum Stage { structure, sample } stage = structure;
  double passed_s = 0;  // since the stage began
  double share = 0;     // of the sample, 0 to 1
  double left_s = 0;    // that it is expected to take; 0 while nothing is known
};

class Session {
 public:
  /// `on_picture` is called from the session's thread when there is a new picture.
  explicit Session(std::function<void()> on_picture = [] {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Replaces what was requested before, whose work ends at once; only a frame of a movement is
  /// left to end by itself when the movement goes on, or there would never be any. Never waits for
  /// rays. Returns the request's number, 1 for the first.
  uint64_t request(SessionRequest request);

  /// Nothing is requested any more. Does not wait either.
  void rest();

  /// Paused, a request gets its first sample and no more.
  void pause(bool paused);

  /// Whether the machine is left alone: all is done that was requested, or paused. Once a paused
  /// session is idle it stays so until the next request.
  bool is_idle() const;

  /// Of the request that is being worked on; nothing once it has a whole sample.
  std::optional<SessionProgress> progress() const;

  /// The newest picture; null before the first.
  std::shared_ptr<const SessionPicture> picture() const;

 private:
  void run();
  void serve(const SessionRequest& request, SessionPicture& next);
  bool bake(const SessionRequest& request, SessionPicture& next);
  void refine(SessionPicture& next);
  bool first_sample(Film& film, double expected_s, SessionPicture& next);
  bool time_sample(SessionPicture& next);
  bool probe(SessionPicture& next);
  bool preview(double seconds, SessionPicture& next);
  bool render_scaled(double scale, SessionPicture& next);
  double expected_s(const SessionPicture& next) const;
  bool may_go_on();
  void begin_stage(SessionProgress::Stage stage, double expected_s);
  bool fail(Error why, SessionPicture& next);
  void publish(const SessionPicture& next);

  std::function<void()> on_picture_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable news_;
  std::optional<SessionRequest> request_;  // not yet taken up
  uint64_t requests_ = 0;
  bool paused_ = false, ending_ = false, waiting_ = false;
  struct Stage {
    SessionProgress::Stage stage = SessionProgress::structure;
    Clock::time_point start;
    double expected_s = 0;
    uint32_t part = 0, parts = 0;  // that are rendered one after the other
  };
  std::optional<Stage> stage_;
  std::optional<Clock::time_point> frame_must_end_;  // that of a movement, which is being rendered
  std::shared_ptr<const SessionPicture> picture_;

  RenderControl control_;
  // The session thread's own.
  std::shared_ptr<const BakedScene> baked_;
  // What besides the camera the last request asked for.
  std::pair<std::shared_ptr<const Scene>, RenderOptions> like_;
  double pixel_s_ = 0;  // what a sample of a pixel takes with that; 0: unknown
  std::thread thread_;
};

}  // namespace raio
