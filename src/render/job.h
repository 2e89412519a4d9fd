// One render from its beginning to its end, for every program that makes pictures: where it starts
// (a scene, a part file to go on with, the settings of a picture to repeat), how it keeps what it
// has (checkpoints, a time limit, being stopped), and what came of it. Never prints.
// docs/long-renders.md
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "base/clock.h"
#include "base/error.h"
#include "integrate/control.h"
#include "integrate/settings.h"
#include "io/read_scene.h"
#include "render/options.h"
#include "render/part.h"
#include "render/picture.h"
#include "scene/scene.h"

namespace raio {

/// What is to be rendered, and where that is to be kept. Errors call a field by its name with a
/// dash for each underscore: "add-samples".
struct JobRequest {
  std::string scene;                    // file; empty with `repeat`: of that picture, beside it
  ReadOptions read = kForPictures;      // of the file
  bool reads_as_given = false;          // with `repeat`: by `read`, not as that picture says
  std::shared_ptr<const Scene> loaded;  // instead of what is in the file
  std::shared_ptr<const Accel> built;   // instead of building it, of `loaded` by the same options
  RenderOptions options;
  std::vector<std::string> of_picture;  // names of the options given on which the picture depends

  std::string output;      // picture or part file, which write() writes; empty: none
  Overlay overlay;         // of the picture, of whose settings it is none; empty: none
  std::string repeat;      // picture whose settings are taken; empty: none
  std::string checkpoint;  // part file; empty: none
  double checkpoint_interval_s = 60;
  bool resume = false;             // goes on with the checkpoint, if it is there
  int add_samples = 0;             // to those of each pixel in the checkpoint
  double time_limit_s = 0;         // from the making of the job; 0: none
  uint32_t shard = 0, shards = 1;  // as in RenderTask
  SampleSpan sample_range = {};    // only these samples of each pixel; empty: all

  /// Whether only a part of a picture is asked for.
  bool is_partial() const { return shards > 1 || !sample_range.empty(); }
};

/// What a job tells while it works, from any thread of it. Empty functions are not called.
struct JobEvents {
  /// The scene's file was read, with warnings, or could not be, with errors.
  // NOLINTNEXTLINE(readability-redundant-member-init)
  std::function<void(const Diagnostics&)> scene_read = {};
  /// The work goes on, but something is not as it should be.
  std::function<void(const Error&)> warning = {};  // NOLINT(readability-redundant-member-init)
};

/// What was made, and what it cost. Rays are those of the whole picture; without those that the
/// film had before, they are the work of this job.
struct RenderFigures {
  struct Times {
    double load = 0, build = 0, render = 0, write = 0, total = 0;  // seconds
  };

  std::shared_ptr<const Scene> scene;
  RenderSettings settings;
  AccelInfo accel;
  Times times;
  RayCounts rays;
  uint64_t rays_before = 0;
  uint32_t samples = 0;  // that every pixel has
  NanSamples nans;       // of the whole picture, too; its pixel counts in the whole picture
};

/// prepare(), run() and write(), once each and in this order, each only if the one before went
/// well. The same request brings the same bytes, whatever was interrupted, resumed, split or added.
class RenderJob {
 public:
  /// `control`: one that several jobs have, one after another, and that outlives them; else the job
  /// has its own.
  explicit RenderJob(JobRequest request, JobEvents events = {}, RenderControl* control = nullptr);
  ~RenderJob();
  RenderJob(const RenderJob&) = delete;
  RenderJob& operator=(const RenderJob&) = delete;

  /// For progress, and to stop the job from another thread: prepare() and run() then end soon with
  /// the error `stopped`, run() after it has written the checkpoint, where there is one to be.
  RenderControl& control() { return control_; }

  /// Refuses what cannot become a picture, before anything long: settings that do not go together,
  /// files that cannot be read, written or gone on with. Then reads the scene and builds the
  /// structure. Of a scene with errors, the error is the first of them.
  std::expected<void, Error> prepare();

  /// Renders, as far as the time limit allows, and keeps the checkpoint up to date. A limit that
  /// did not suffice for one sample of every pixel is an error (no_resource).
  std::expected<void, Error> run();

  /// Whether the checkpoint, if any, could be written at the end of run().
  const std::expected<void, Error>& kept() const { return kept_; }

  /// Writes the output. Nothing to do without one.
  std::expected<void, Error> write();

  /// After prepare().
  const Scene& scene() const { return *scene_; }
  const Accel& accel() const { return *accel_; }
  /// What another picture of the scene can start from: JobRequest::loaded and built.
  const std::shared_ptr<const Scene>& loaded() const { return scene_; }
  const std::shared_ptr<const Accel>& built() const { return accel_; }

  /// After prepare(). With fewer samples than were asked for, the settings say so after run().
  const RenderSettings& settings() const { return settings_; }
  const Part& part() const { return part_; }
  RenderFigures figures() const;

 private:
  class Checkpoint;

  double seconds() const { return seconds_since(begin_); }
  std::expected<void, Error> load();
  std::expected<void, Error> build();
  void describe(const SampleCounts& samples);

  Clock::time_point begin_ = Clock::now();
  JobRequest request_;
  JobEvents events_;
  RenderControl own_control_;
  RenderControl& control_;
  std::shared_ptr<const Scene> scene_;
  RenderSettings settings_;
  std::shared_ptr<const Accel> accel_;
  Part part_;
  uint32_t samples_ = 0;  // of a pixel, when not all that the options say
  uint64_t rays_before_ = 0;
  RenderFigures::Times times_;
  std::expected<void, Error> kept_;
};

}  // namespace raio
