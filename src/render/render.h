// From a scene and its structure to a film: eye rays, shading, tiles on all cores.
#pragma once

#include <atomic>
#include <expected>
#include <functional>
#include <optional>
#include <string>

#include "accel/accel.h"
#include "render/film.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio {

/// How many rays of each kind were traced. A hit is counted where the ray met something.
struct RayCounts {
  uint64_t eye = 0, eye_hits = 0;
  uint64_t reflection = 0, refraction = 0;
  uint64_t shadow = 0, shadow_hits = 0;
  uint64_t tests = 0, steps = 0;  // with AccelOptions::counters

  uint64_t total() const { return eye + reflection + refraction + shadow; }
  RayCounts& operator+=(const RayCounts& b);
};

/// Shared with whoever watches a render from another thread.
struct RenderControl {
  std::atomic<bool> stop{false};  // set it to end the render soon
  std::atomic<uint64_t> rays_done{0};
  std::atomic<uint64_t> work_done{0};  // of work_total
  std::atomic<uint64_t> work_total{0};
};

struct RenderResult {
  Film film;
  RayCounts rays;
  double seconds = 0;
};

/// Runs `work`, and all that it runs in parallel (building, rendering), on so many threads.
void on_threads(int threads, const std::function<void()>& work);

/// Why there cannot be a picture of these many pixels, in one line, or nothing: memory that would
/// not suffice. For callers that want to know it before they build a structure.
std::string picture_problem(int width, int height);

/// Renders with resolved options. Nothing when stopped. The error is one line: memory that would
/// not suffice for the picture.
std::expected<std::optional<RenderResult>, std::string> render(const Scene& scene,
                                                               const Accel& accel,
                                                               const RenderOptions& options,
                                                               RenderControl& control);

}  // namespace raio
