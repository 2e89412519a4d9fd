// One render from start to end, for any program: where it starts (a scene, a part file to resume,
// the settings of a picture to repeat), how it stores its work (checkpoints, a time limit,
// cancellation), and its results. Never prints. See docs/long-renders.md.
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/executor.h"
#include "integrate/settings.h"
#include "io/read_scene.h"
#include "render/options.h"
#include "render/part.h"
#include "render/picture.h"
#include "scene/scene.h"

namespace raio::core {

/// What to render and where to store it. Errors name fields with dashes instead of underscores:
/// "add-samples".
struct JobRequest {
  std::string scene;                    // file; empty with `repeat`: that picture's, in its folder
  ReadOptions read = kForPictures;      // for the file
  bool reads_as_given = false;          // with `repeat`: use `read`, not the picture's settings
  std::shared_ptr<const Scene> loaded;  // instead of the file's contents
  std::shared_ptr<const Accel> built;   // instead of building it; of `loaded`, by the same options
  std::string scene_hash;               // of `loaded`, where it is known; takes 40 ms per million
  RenderOptions options;
  std::vector<std::string> of_picture;  // names of the given options that affect the picture

  std::string output;      // picture or part file for write(); empty: none
  Overlay overlay;         // drawn on the picture, not part of its settings; empty: none
  std::string repeat;      // picture that provides the settings; empty: none
  std::string checkpoint;  // part file; empty: none
  double checkpoint_interval_s = 60;
  bool resume = false;             // resumes from the checkpoint if it exists
  int add_samples = 0;             // added to each pixel's samples in the checkpoint
  double time_limit_s = 0;         // of all steps before write(); 0: none
  uint32_t shard = 0, shards = 1;  // as in RenderTask
  SampleSpan sample_range = {};    // only these samples per pixel; empty: all

  /// Whether only a part of a picture is requested.
  bool is_partial() const { return shards > 1 || !sample_range.empty(); }
};

/// Events of a running job, called from any of its threads. Empty functions are not called.
struct JobEvents {
  /// The scene's file was read, with warnings, or failed, with errors.
  // NOLINTNEXTLINE(readability-redundant-member-init)
  std::function<void(const Diagnostics&)> scene_read = {};
  /// A problem that does not end the work.
  std::function<void(const Error&)> warning = {};  // NOLINT(readability-redundant-member-init)
};

/// Results and their cost. `rays` counts the whole picture; `rays_before` of them came with the
/// film, the others are this job's.
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
  uint32_t samples = 0;      // of every pixel, at least
  double mean_samples = 0;   // of all pixels
  double share_at_most = 0;  // of pixels with max_samples, with `noise`
  SampleFaults faults;       // of the whole picture, with coordinates in it
};

/// Call prepare(), run() and write() once each, in this order, and each only if the previous one
/// succeeded. Between prepare() and run(), build() builds the structure early. The same request
/// gives the same bytes, even if it was interrupted, resumed, split or extended.
class RenderJob {
 public:
  /// `control`: shared by consecutive jobs and outliving them; otherwise the job has its own.
  explicit RenderJob(JobRequest request, JobEvents events = {}, WorkControl* control = nullptr);
  ~RenderJob();
  RenderJob(const RenderJob&) = delete;
  RenderJob& operator=(const RenderJob&) = delete;

  /// For progress, and to stop the job from another thread: each step then ends soon with the error
  /// `stopped`, run() after writing the checkpoint, if any.
  WorkControl& control() { return control_; }

  /// Before anything slow, checks that the request can succeed: settings must not contradict each
  /// other, and files must be readable, writable or resumable. Then reads the scene; if it has
  /// errors, returns the first. `begun`: a part to continue, instead of a checkpoint.
  std::expected<void, Error> prepare(std::optional<NamedPart> begun = std::nullopt);

  /// Builds the structure.
  std::expected<void, Error> build();

  /// Builds the structure unless it is built, renders within the time limit and updates the
  /// checkpoint. A limit too short for one sample per pixel is an error (no_resource).
  std::expected<void, Error> run();

  /// Whether the checkpoint, if any, was written at the end of run().
  const std::expected<void, Error>& kept() const { return kept_; }

  /// Writes the output, if any. The notes of write_result() are then in notes().
  std::expected<void, Error> write();

  /// After write(): sentences about what was chosen for the picture.
  const std::vector<std::string>& notes() const { return notes_; }

  /// After prepare(), and after build().
  const Scene& scene() const { return *scene_; }
  const Accel& accel() const { return *accel_; }
  /// For other jobs with the same scene: JobRequest::loaded and built.
  const std::shared_ptr<const Scene>& loaded() const { return scene_; }
  const std::shared_ptr<const Accel>& built() const { return accel_; }

  /// After prepare(). If fewer samples than requested were rendered, the settings say so after
  /// run().
  const RenderSettings& settings() const { return settings_; }
  const Part& part() const { return part_; }
  /// Moves the part to the caller, after the last step.
  Part take_part() { return std::move(part_); }
  RenderFigures figures() const;

 private:
  double seconds() const { return seconds_since(begin_); }
  std::expected<void, Error> find_and_load(std::optional<NamedPart> begun);
  std::expected<void, Error> load();
  std::expected<void, Error> render_and_keep();
  std::expected<void, Error> conclude(bool finished, bool was_stopped);
  void write_checkpoint();
  void describe(const SampleCounts& samples, bool finished);

  Clock::time_point begin_ = Clock::now();
  JobRequest request_;
  JobEvents events_;
  WorkControl own_control_;
  WorkControl& control_;
  std::shared_ptr<const Scene> scene_;
  RenderSettings settings_;
  std::shared_ptr<const Accel> accel_;
  Part part_;
  uint32_t samples_ = 0;  // per pixel, if not as many as the options say
  uint64_t rays_before_ = 0;
  RenderFigures::Times times_;
  double prepare_s_ = 0;
  std::expected<void, Error> kept_;
  std::vector<std::string> notes_;
};

}  // namespace raio::core
