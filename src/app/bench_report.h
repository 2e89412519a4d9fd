// The technical report of 2018, the model of the benchmark's table: its times, and its claims,
// judged by measurements. Costs of effects relative to none, and gains of a grid, compare programs
// and do not depend on the machine.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/benchmark.h"

namespace raio::core::app {

/// The source of its figures, for captions.
inline constexpr std::string_view kReportSource =
    "technical report of 2018, 512x512, its own machine";

/// A time with the report's digits.
struct ReportTime {
  double seconds = 0;
  int decimals = 3;
  bool more_than = false;  // a lower bound

  /// "24.251", "12", ">3600".
  std::string text() const;
};

/// The report's time for a scene file of that name; nothing if there is none.
std::optional<ReportTime> report_time(std::string_view scene, const Combination& combination);

/// Likewise for a row of a table, which must have the report's size.
std::optional<ReportTime> report_time(const BenchmarkTable& table, const BenchmarkRow& row);

/// The report's time relative to the same structure without effects.
std::optional<double> report_cost(const BenchmarkTable& table, const BenchmarkRow& row);

/// The report's time divided by the row's.
std::optional<double> speedup(const BenchmarkTable& table, const BenchmarkRow& row);

/// Whether the report has a time for the table.
bool report_knows(const BenchmarkTable& table);

enum class Verdict { confirmed, corrected, unknown };
/// "confirmed", "corrected", "cannot be told from these rows".
std::string_view verdict_words(Verdict verdict);

struct ReportClaim {
  std::string_view claim;
  std::string report, ours;  // the figures; ours is empty if rows are missing
  Verdict verdict = Verdict::unknown;
};

/// The report's five claims with the table's figures; none if the report has no times for the
/// table.
std::vector<ReportClaim> report_claims(const BenchmarkTable& table);

}  // namespace raio::core::app
