// What the grid's resolution does: the same picture with grids from coarse to fine, timed in turns
// and counted. The report of 2018 takes twice the cube root of the number of primitives a side.
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "integrate/control.h"
#include "measure/timed_share.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio {

/// Cells a side per cube root of the number of primitives: the factor that the report has, and the
/// least and the greatest that are measured.
inline constexpr float kReportGridFactor = 2, kMinGridFactor = 0.25f, kMaxGridFactor = 8;

struct GridPoint {
  float factor = 0;
  std::array<int, 3> resolution{};
  size_t cells = 0, references = 0, bytes = 0;
  double build_s = 0;
  double tests = 0, steps = 0;  // a ray; primitives tested, cells visited
  int rounds = 0;               // that were timed
  MedianInterval seconds{};     // of the whole picture

  friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

struct GridCurve {
  // By factor; those that have the cells of the one before are left out.
  std::vector<GridPoint> points;
  bool finished = false;
  double done = 0, left_s = 0;  // 0 to 1, and what it will take at least until that is 1

  /// The point whose median is least; null before there is one.
  const GridPoint* fastest() const;
  /// Seconds at a factor, between two points as a straight line over the logarithm of the factor;
  /// 0 beyond them, or before they were timed.
  double seconds_at(float factor) const;
};

/// Measures the curve for a picture with `options`, whose structure, view, channels and numbers of
/// samples do not count (timed_options()). Grids of more than 2^24 cells are left out.
///
/// `on_news` gets what is known so far after each grid is built and counted and after each round,
/// outside of what is timed. Told to stop by `control` it ends soon, without `finished`. Errors:
/// those of make_film(); bad_option where the scene has nothing to put in a grid.
std::expected<GridCurve, Error> measure_grid_curve(
    const Scene& scene, const RenderOptions& options, RenderControl& control,
    const std::function<void(const GridCurve&)>& on_news = {}, const MeasuringEffort& effort = {});

/// A line for each point, with headings.
std::string grid_curve_csv(const GridCurve& curve);

}  // namespace raio
