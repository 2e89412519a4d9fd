// The benchmark for people and for programs: how it is asked for (bench.cpp), and the forms in
// which its table is given, text, CSV and JSON (bench_format.cpp). Measuring is in
// measure/benchmark.h, the report of 2018 in bench_report.h, the picture in plot.h.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "measure/benchmark.h"

namespace raio::app {

/// "grid,bvh": structures, each once, out of none, grid, bvh and embree. The error says what was
/// found and what is accepted.
std::expected<std::vector<AccelKind>, std::string> parse_structures(std::string_view list);

/// "aa,soft-shadows": effects, each once, or "none". Likewise.
std::expected<EffectSet, std::string> parse_effects(std::string_view list);

/// An effect on the command line: "soft-shadows".
std::string effect_word(const BenchmarkEffect& effect);

/// Which option would have no effect because of what is not timed, and what to do, in one line;
/// empty when all is well.
std::string bench_conflict(const BenchmarkRequest& request);

/// Which of the effects to be timed would be none in the scene, and what to do; empty when all is
/// well.
std::string absence_of_effects(const BenchmarkRequest& request, const Scene& scene);

/// Three digits that mean something, never an exponent: "0.0123", "4.56", "98.4", "1260".
std::string three_digits(double value);

/// For people, in at most 100 columns with the effects of the report: the table, what was built,
/// and what becomes of the report's claims.
std::string table_text(const BenchmarkTable& table);

/// One line per row under a line of names; unknown is empty. Times in seconds.
std::string table_csv(const BenchmarkTable& table);

/// One JSON object; unknown is null.
std::string table_json(const BenchmarkTable& table);

}  // namespace raio::app
