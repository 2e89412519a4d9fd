// The effect of the grid's resolution: the same picture with grids from coarse to fine, timed
// alternately and counted. The report of 2018 takes twice the cube root of the number of primitives
// per side.
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/executor.h"
#include "measure/timed_share.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core {

/// Cells per side relative to the cube root of the number of primitives: the report's factor, and
/// the smallest and largest that are measured.
inline constexpr float kReportGridFactor = 2, kMinGridFactor = 0.25f, kMaxGridFactor = 8;

struct GridPoint {
  float factor = 0;
  std::array<int, 3> resolution{};
  size_t cells = 0, references = 0, bytes = 0;
  double build_s = 0;
  double tests = 0, steps = 0;  // per ray; primitives tested, cells visited
  int rounds = 0;               // that were timed
  MedianInterval seconds{};     // for the whole picture

  friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

struct GridCurve {
  // By factor; grids with the same cells as the previous one are omitted.
  std::vector<GridPoint> points;
  bool finished = false;
  double done = 0, left_s = 0;  // 0 to 1, and the minimum remaining time

  /// The point with the smallest median; null if there are none.
  const GridPoint* fastest() const;
  /// Seconds at a factor, interpolated linearly over the logarithm of the factor; 0 outside of the
  /// points, or before they were timed.
  double seconds_at(float factor) const;
};

/// Measures the curve for a picture with `options`, ignoring structure, view, channels and numbers
/// of samples (timed_options()). Grids of more than 2^24 cells are omitted.
///
/// `on_news` gets the results so far after each grid is built and counted and after each round,
/// outside of the timed part. If stopped by `control`, it ends soon, without `finished`. Errors:
/// those of make_film(); bad_option if the scene has nothing to put in a grid.
std::expected<GridCurve, Error> measure_grid_curve(
    const Scene& scene, const RenderOptions& options, WorkControl& control,
    const std::function<void(const GridCurve&)>& on_news = {}, const MeasuringEffort& effort = {});

/// A line per point, with headings.
std::string grid_curve_csv(const GridCurve& curve);

}  // namespace raio::core
