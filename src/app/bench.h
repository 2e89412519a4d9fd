// The command `raio bench`: its arguments (bench.cpp) and the formats of its table: text, CSV and
// JSON (bench_format.cpp). measure/benchmark.h measures, bench_report.h has the report of 2018,
// plot.h the picture.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "measure/benchmark.h"

namespace raio::core::app {

/// Parses "grid,bvh": structures, each once, among none, grid, bvh and embree. The error says what
/// was found and what is accepted.
std::expected<std::vector<AccelKind>, std::string> parse_structures(std::string_view list);

/// Parses "aa,soft-shadows": effects, each once, or "none". Likewise.
std::expected<EffectSet, std::string> parse_effects(std::string_view list);

/// An effect on the command line: "soft-shadows".
std::string effect_word(const BenchmarkEffect& effect);

/// Names an option that does not affect the timed work, and the remedy, in one line; empty if there
/// is none.
std::string bench_conflict(const BenchmarkRequest& request);

/// Names a timed effect that cannot occur in the scene, and what to do; empty if there is none.
std::string absence_of_effects(const BenchmarkRequest& request, const Scene& scene);

/// Three significant digits, never an exponent: "0.0123", "4.56", "98.4", "1260".
std::string three_digits(double value);

/// "12.3 ms" next to a bar, "10 ms" at an axis.
std::string seconds_label(double seconds);
std::string tick_label(double seconds);

/// For people, in at most 100 columns with the report's effects: the table, the structures, and the
/// verdicts on the report's claims.
std::string table_text(const BenchmarkTable& table);

/// One line per row under a line of names; empty if unknown. Times in seconds.
std::string table_csv(const BenchmarkTable& table);

/// One JSON object; null if unknown.
std::string table_json(const BenchmarkTable& table);

}  // namespace raio::core::app
