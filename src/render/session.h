// Interactive rendering: a thread that always works on the newest request. Independent of any
// window, which makes requests and shows the pictures.
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

namespace raio::core {

/// A scene with its structure, possibly that of an earlier version of the scene if only lights,
/// background or materials have changed since.
struct BakedScene {
  std::shared_ptr<const Scene> scene;
  AccelOptions options;
  bool one_sided = false;
  std::shared_ptr<const Accel> accel;  // keeps its scene alive
  AccelInfo info;
  double build_s = 0;
};

struct SessionRequest {
  std::shared_ptr<const Scene> scene;
  RenderOptions options;  // as on the command line, with a size
  /// During movements: the target time of a picture, which limits its resolution. 0: full size,
  /// sample after sample up to the number in the options.
  double frame_s = 0;
};

/// The current picture. Immutable once published.
struct SessionPicture {
  uint64_t request = 0;  // the request that it answers
  std::shared_ptr<const Image> image;
  int samples = 0;  // per pixel; 0: a preview, coarse in part or whole, without figures
  bool finished = false;
  RenderSettings settings;  // for the full size
  std::shared_ptr<const BakedScene> baked;
  /// Seconds for a sample of all pixels, from whole samples rendered while nothing was shown, or
  /// from a slow one. Zero until measured.
  MedianInterval sample_s{};
  double render_s = 0;         // all samples together
  RayCounts rays;              // likewise
  std::optional<Error> error;  // why the request got no picture; the image is an older one
};

/// The progress of a request without a whole sample yet.
struct SessionProgress {
  enum Stage { structure, sample } stage = structure;
  double passed_s = 0;  // since the stage began
  double share = 0;     // of the stage, 0 to 1
  double left_s = 0;    // expected remaining time; 0 while unknown
};

class Session {
 public:
  /// `on_picture` is called from the session's thread for each new picture.
  explicit Session(std::function<void()> on_picture = [] {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Replaces the previous request and ends its work at once, with two exceptions: a frame of a
  /// movement that goes on, and a structure that the new request needs, too. Otherwise neither
  /// would ever be finished. Never waits for rays. Returns the request's number, 1 for the first.
  uint64_t request(SessionRequest request);

  /// Cancels the request. Does not wait either.
  void rest();

  /// While paused, a request gets only its first sample.
  void pause(bool paused);

  /// Whether all requested work is done or paused. A paused idle session stays idle until the next
  /// request.
  bool is_idle() const;

  /// For the current request; nothing once it has a whole sample.
  std::optional<SessionProgress> progress() const;

  /// The newest picture; null before the first.
  std::shared_ptr<const SessionPicture> picture() const;

 private:
  void run();
  void serve(const SessionRequest& request, SessionPicture& next);
  bool bake(const SessionRequest& request, SessionPicture& next);
  void refine(SessionPicture& next);
  bool first_sample(Film& film, double expected_s, SessionPicture& next);
  bool time_sample(Film& film, SessionPicture& next);
  std::optional<double> render_to(Film& film, int samples, const SessionPicture& next);
  std::optional<double> add_samples(Film& film, int count, SessionPicture& next);
  void show(const Film& film, SessionPicture& next);
  bool probe(SessionPicture& next);
  bool preview(double seconds, SessionPicture& next);
  bool render_scaled(double scale, SessionPicture& next);
  double expected_s(const SessionPicture& next) const;
  bool may_go_on();
  bool is_paused() const;
  void begin_stage(SessionProgress::Stage stage, double expected_s);
  bool fail(Error why, SessionPicture& next);
  void publish(const SessionPicture& next);

  std::function<void()> on_picture_;
  mutable std::mutex mutex_;  // guards the following
  std::condition_variable news_;
  std::optional<SessionRequest> request_;  // not yet started
  uint64_t requests_ = 0;
  bool paused_ = false, ending_ = false, waiting_ = false;
  struct Stage {
    SessionProgress::Stage stage = SessionProgress::structure;
    Clock::time_point start;
    double expected_s = 0;
    uint32_t part = 0, parts = 0;  // parts of a sample, rendered one after the other
  };
  std::optional<Stage> stage_;
  std::optional<Clock::time_point> frame_must_end_;  // deadline of the movement's current frame
  std::shared_ptr<const SessionPicture> picture_;
  const SessionRequest* built_ = nullptr;  // whose structure is being built

  WorkControl control_, build_control_;
  // The session thread's own.
  std::shared_ptr<const BakedScene> baked_;
  // The last request without the camera.
  std::pair<std::shared_ptr<const Scene>, RenderOptions> like_;
  double pixel_s_ = 0;  // cost of a pixel's sample with that request; 0: unknown
  std::thread thread_;
};

}  // namespace raio::core
