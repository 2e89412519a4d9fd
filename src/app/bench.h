// The benchmark's results as plain data, and the forms in which they are given: text, CSV, JSON.
// Measuring is in bench.cpp, the forms in bench_format.cpp, the picture in plot.h.
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "app/commands.h"
#include "io/image/image.h"
#include "render/render.h"
#include "scene/scene.h"

namespace raio::app {

/// What is timed: the report's two, and Raio's own tree.
inline constexpr std::array kBenchStructures = {AccelKind::none, AccelKind::grid, AccelKind::bvh};

/// One of the report's sixteen combinations of structure and effects, or one with the tree.
struct Combination {
  AccelKind accel = AccelKind::none;  // of kBenchStructures
  bool aa = false, soft_shadows = false, dof = false;

  friend bool operator==(const Combination&, const Combination&) = default;
};

/// Cells along a side of the pixel, and samples of the lens in each, as the report has them: 1
/// sample a pixel plain, 3 with depth of field, 9 with antialiasing, 27 with both.
constexpr int aa_cells(const Combination& c) { return c.aa ? 3 : 1; }
constexpr int lens_samples(const Combination& c) { return c.dof ? 3 : 1; }
constexpr int samples_per_pixel(const Combination& c) {
  return aa_cells(c) * aa_cells(c) * lens_samples(c);
}

/// All of them in the order of the table: by structure, effects counted up in binary.
std::array<Combination, 8 * kBenchStructures.size()> all_combinations();

/// "grid AA DOF", for a progress line.
std::string short_label(const Combination& combination);

/// Where the report's seconds are from, for captions.
inline constexpr std::string_view kReportSource =
    "technical report of 2018, 512x512, its own machine";

/// The report's seconds for a scene file of that name at that size; nothing where they are not
/// known.
std::optional<double> report_seconds(std::string_view scene, int width, int height,
                                     const Combination& combination);

struct BenchRow {
  Combination combination;
  std::vector<double> runs_s;  // rendering alone, one per repeat; never empty
  uint64_t rays = 0;           // of one run
  std::optional<double> report_s;

  /// The median of the runs.
  double seconds() const;
  double rays_per_s() const { return double(rays) / seconds(); }
  /// How many times less than the report's.
  std::optional<double> speedup() const;
};

struct BenchStructure {
  AccelInfo info;
  double build_s = 0;
};

struct BenchTable {
  std::string version, scene;
  std::string machine;  // the processor's model
  int width = 0, height = 0, threads = 0, depth = 0, repeat = 1;
  uint32_t seed = 0;
  std::vector<BenchStructure> structures;
  double disagreement = 0;     // largest share of pixels in which two plain pictures differ
  std::vector<BenchRow> rows;  // in the order of all_combinations()

  /// Seconds of `row` over those of the same structure without effects, 1 for the latter itself.
  double relative_cost(const BenchRow& row) const;
};

struct BenchFailure {
  Exit status;
  std::string message;  // empty when interrupted
};

/// Builds the structures, holds their pictures against each other, times the combinations.
std::expected<BenchTable, BenchFailure> measure_bench(const Scene& scene,
                                                      const BenchCommand& command,
                                                      RenderControl& control);

/// The share of pixels in which the picture of a structure differs by more than 8 of 255 from that
/// of none. An error, one line, when it is more than 0.001: fast and wrong is no result.
std::expected<double, std::string> check_agreement(AccelKind kind, const Image& picture,
                                                   const Image& of_none);

/// Three digits that mean something, never an exponent: "0.0123", "4.56", "98.4", "1260".
std::string three_digits(double value);

/// For people, in at most 100 columns.
std::string table_text(const BenchTable& table);

/// One line per row under a line of names; unknown is empty. Times in seconds.
std::string table_csv(const BenchTable& table);

/// One JSON object; unknown is null.
std::string table_json(const BenchTable& table);

}  // namespace raio::app
