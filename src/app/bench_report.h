// The technical report of 2018 on whose table the benchmark is modelled: its seconds, and what it
// claims, held against what was measured. What an effect costs relative to none, and what a grid
// gains, compares programs and does not depend on the machine.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/benchmark.h"

namespace raio::app {

/// Where its figures are from, for captions.
inline constexpr std::string_view kReportSource =
    "technical report of 2018, 512x512, its own machine";

/// A time with the digits that the report gives.
struct ReportTime {
  double seconds = 0;
  int decimals = 3;
  bool more_than = false;  // it took longer; the report does not say how much

  /// "24.251", "12", ">3600".
  std::string text() const;
};

/// What the report says of a scene file of that name; nothing where it says nothing.
std::optional<ReportTime> report_time(std::string_view scene, const Combination& combination);

/// Likewise, for a row of a table, which has to be of the report's size.
std::optional<ReportTime> report_time(const BenchmarkTable& table, const BenchmarkRow& row);

/// The report's seconds over those of the same structure without effects.
std::optional<double> report_cost(const BenchmarkTable& table, const BenchmarkRow& row);

/// How many times less than the report's seconds a row's are.
std::optional<double> speedup(const BenchmarkTable& table, const BenchmarkRow& row);

/// Does the report know a time of the table?
bool report_knows(const BenchmarkTable& table);

enum class Verdict { confirmed, corrected, unknown };
/// "confirmed", "corrected", "cannot be told from these rows".
std::string_view verdict_words(Verdict verdict);

struct ReportClaim {
  std::string_view claim;
  std::string report, ours;  // the figures; ours is empty where rows are missing
  Verdict verdict = Verdict::unknown;
};

/// The report's five claims beside the table's figures; none when the report knows no time of the
/// table.
std::vector<ReportClaim> report_claims(const BenchmarkTable& table);

}  // namespace raio::app
