#include "measure/grid_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "accel/accel.h"
#include "base/clock.h"
#include "base/exact_math.h"
#include "base/parallel.h"
#include "integrate/film.h"

namespace raio::core {
namespace {

constexpr double kMaxCells = 1 << 24;
constexpr size_t kFewestCurveRounds = 5, kMaxCurveRounds = 15;
constexpr uint32_t kCurveProbeShards = 16;

class CurveMeasurement {
 public:
  CurveMeasurement(const Scene& scene, const RenderOptions& options, WorkControl& control,
                   const std::function<void(const GridCurve&)>& on_news,
                   const MeasuringEffort& effort)
      : scene_(scene),
        options_(timed_options(options, scene)),
        control_(control),
        on_news_(on_news),
        effort_(effort) {
    options_.accel = {.kind = AccelKind::grid};
    settings_ = resolve_options(options_, scene);
  }

  std::expected<GridCurve, Error> run() {
    if (scene_.primitive_count() == 0)
      return std::unexpected(
          bad_option("", "the scene is empty, so there is nothing to put in a grid"));
    if (build_and_count() && time_rounds()) {
      curve_.finished = true, curve_.done = 1, curve_.left_s = 0;
      tell();
    }
    if (error_) return std::unexpected(std::move(*error_));
    return std::move(curve_);
  }

 private:
  struct Grid {
    RenderSettings settings;
    std::unique_ptr<Accel> accel;
    std::vector<double> seconds;  // per round, for the whole picture
  };

  bool fail(Error why) {
    error_ = std::move(why);
    return false;
  }
  void tell() {
    if (on_news_) on_news_(curve_);
  }

  double pixels() const { return double(settings_.frame().width()) * settings_.frame().height(); }

  std::expected<std::unique_ptr<Accel>, Error> build(const RenderSettings& s) const {
    return Executor(s.threads, &control_).run([&] {
      return build_accel(scene_, s.accel, s.one_sided);
    });
  }

  // The slowest grid determines the rendered fraction of the picture.
  bool build_and_count() {
    const double primitives = double(scene_.primitive_count());
    double slowest = 0;
    for (float factor = kMinGridFactor; factor <= kMaxGridFactor * 1.01f;
         factor *= std::numbers::sqrt2_v<float>) {
      if (double(factor) * factor * factor * primitives > kMaxCells) break;
      Grid grid{.settings = settings_, .accel = {}, .seconds = {}};
      grid.settings.accel.grid_factor = factor;
      const auto start = Clock::now();
      auto accel = build(grid.settings);
      if (control_.stop) return false;
      // The finer ones would need still more.
      if (!accel) break;
      GridPoint point{.factor = factor, .build_s = seconds_since(start)};
      grid.accel = std::move(*accel);
      const AccelInfo info = grid.accel->info();
      point.resolution = info.resolution, point.cells = info.cells;
      point.references = info.references, point.bytes = info.bytes;
      if (!curve_.points.empty() && curve_.points.back().resolution == point.resolution) continue;
      const auto probe =
          render_share(scene_, *grid.accel, grid.settings, kCurveProbeShards, control_);
      if (!probe) return fail(probe.error());
      if (!*probe) return false;
      slowest = std::max(slowest, scaled((*probe)->seconds, **probe));
      if (!count(grid, point)) return false;
      grids_.push_back(std::move(grid)), curve_.points.push_back(point);
      tell();
    }
    share_ = share_for(scene_, settings_, slowest, kTilesPerThread);
    return true;
  }

  double scaled(double seconds, const TimedRun& run) const {
    return seconds * pixels() / double(std::max<uint64_t>(1, run.pixels));
  }

  bool count(const Grid& grid, GridPoint& point) {
    RenderSettings s = grid.settings;
    s.accel.counters = true;
    const auto accel = build(s);
    if (control_.stop) return false;
    if (!accel) return fail(accel.error());
    const auto run = render_share(scene_, **accel, s, kCurveProbeShards, control_);
    if (!run) return fail(run.error());
    if (!*run) return false;
    const RayCounts& rays = (*run)->rays;
    const double all = double(std::max<uint64_t>(1, rays.total()));
    point.tests = double(rays.tests) / all, point.steps = double(rays.steps) / all;
    return true;
  }

  // The order is reversed every other time.
  bool time_rounds() {
    for (size_t round = 1; round <= kMaxCurveRounds; ++round) {
      const auto start = Clock::now();
      for (size_t i = 0; i < grids_.size(); ++i)
        if (!time(round % 2 ? i : grids_.size() - 1 - i)) return false;
      bool close = round >= kFewestCurveRounds;
      for (size_t i = 0; i < grids_.size(); ++i) {
        GridPoint& point = curve_.points[i];
        point.seconds = median_interval(grids_[i].seconds), point.rounds = int(round);
        close = close && point.seconds.half_width() <= effort_.close_enough;
      }
      const double round_s = seconds_since(start);
      curve_.left_s =
          close ? 0 : round_s * double(round < kFewestCurveRounds ? kFewestCurveRounds - round : 1);
      curve_.done = double(round) * round_s / (double(round) * round_s + curve_.left_s);
      tell();
      if (close) break;
    }
    return true;
  }

  bool time(size_t i) {
    Grid& grid = grids_[i];
    double seconds = 0;
    int runs = 0;
    do {
      const auto run = render_share(scene_, *grid.accel, grid.settings, share_, control_);
      if (!run) return fail(run.error());
      if (!*run) return false;
      seconds += scaled(std::max((*run)->seconds, 1e-9), **run), ++runs;
    } while (seconds / share_ < effort_.least_run_s);
    grid.seconds.push_back(seconds / runs);
    return true;
  }

  const Scene& scene_;
  RenderOptions options_;
  RenderSettings settings_;
  WorkControl& control_;
  const std::function<void(const GridCurve&)>& on_news_;
  const MeasuringEffort effort_;
  std::vector<Grid> grids_;  // parallel to the points
  uint32_t share_ = 1;
  GridCurve curve_;
  std::optional<Error> error_;
};

}  // namespace

const GridPoint* GridCurve::fastest() const {
  const GridPoint* best = nullptr;
  for (const GridPoint& p : points)
    if (p.rounds > 0 && (!best || p.seconds.median < best->seconds.median)) best = &p;
  return best;
}

double GridCurve::seconds_at(float factor) const {
  for (size_t i = 0; i < points.size(); ++i) {
    const GridPoint& to = points[i];
    if (to.factor < factor || to.rounds == 0) continue;
    if (to.factor == factor) return to.seconds.median;
    if (i == 0 || points[i - 1].rounds == 0) return 0;
    const GridPoint& from = points[i - 1];
    const double part =
        exact_log(double(factor / from.factor)) / exact_log(double(to.factor / from.factor));
    return from.seconds.median + part * (to.seconds.median - from.seconds.median);
  }
  return 0;
}

std::expected<GridCurve, Error> measure_grid_curve(
    const Scene& scene, const RenderOptions& options, WorkControl& control,
    const std::function<void(const GridCurve&)>& on_news, const MeasuringEffort& effort) {
  return CurveMeasurement(scene, options, control, on_news, effort).run();
}

std::string grid_curve_csv(const GridCurve& curve) {
  std::string csv =
      "factor,cells_x,cells_y,cells_z,cells,references,bytes,build_s,tests_per_ray,steps_per_ray,"
      "rounds,seconds,seconds_low,seconds_high\n";
  for (const GridPoint& p : curve.points)
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", p.factor,
                   p.resolution[0], p.resolution[1], p.resolution[2], p.cells, p.references,
                   p.bytes, p.build_s, p.tests, p.steps, p.rounds, p.seconds.median, p.seconds.low,
                   p.seconds.high);
  return csv;
}

}  // namespace raio::core
