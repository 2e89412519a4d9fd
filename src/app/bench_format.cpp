#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "app/bench.h"
#include "app/bench_report.h"
#include "app/json.h"
#include "app/terminal.h"
#include "base/exact_math.h"

namespace raio::core::app {

namespace {

std::string times(double factor) { return three_digits(factor) + " x"; }

// "±2.5%"
std::string half_width(const Spread& spread) {
  const double percent = 100 * spread.half_width();
  return fmt::format("±{:.{}f}%", percent, percent < 9.95 ? 1 : 0);
}

std::string structure_line(const BenchmarkStructure& structure) {
  const AccelInfo& info = structure.info;
  std::string line = fmt::format("{}: {}", info.name, human_bytes(double(info.bytes)));
  if (info.cells > 0) {
    const auto& r = info.resolution;
    line += fmt::format(", {} {}", human_count(double(info.cells)), r[0] > 0 ? "cells" : "nodes");
    if (r[0] > 0) line += fmt::format(" ({}x{}x{})", r[0], r[1], r[2]);
    line += fmt::format(", {} references", human_count(double(info.references)));
  }
  return line + fmt::format(", built in {}", human_seconds(structure.build_s));
}

// The names of the effects, each in its own column.
std::string effect_cells(EffectSet combined, EffectSet on) {
  if (!on) return "none";
  std::string cells;
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i) {
    if (!(combined >> i & 1)) continue;
    const std::string_view name = kBenchmarkEffects[i].short_name;
    cells +=
        fmt::format("{}{:<{}}", cells.empty() ? "" : " ", on >> i & 1 ? name : "", name.size());
  }
  return cells;
}

struct Column {
  std::array<std::string_view, 2> heading;
  int width;
  bool shown;
  std::function<std::string(const BenchmarkRow& row)> cell;
};

std::vector<Column> columns_of(const BenchmarkTable& table) {
  const bool report = report_knows(table), spread = table.repeat > 1;
  const auto if_known = [](const auto& known, const auto& text) {
    return known ? text(*known) : std::string("-");
  };
  const int effects = int(effect_cells(table.effects, table.effects).size());
  return {
      {{"effects", ""},
       -std::max(effects, 7),
       true,
       [&](const auto& row) { return effect_cells(table.effects, row.combination.effects); }},
      {{"samples", "/ pixel"},
       7,
       true,
       [](const auto& row) {
         return fmt::format("{}", samples_per_pixel(row.combination.effects));
       }},
      {{"report", "s"},
       8,
       report,
       [&table, if_known](const auto& row) {
         return if_known(report_time(table, row), [](const auto& time) { return time.text(); });
       }},
      {{report ? "ours" : "", "s"},
       7,
       true,
       [](const auto& row) { return three_digits(row.seconds().median); }},
      {{"", ""}, 6, spread, [](const auto& row) { return half_width(row.seconds()); }},
      {{"report", "cost"},
       8,
       report,
       [&table, if_known](const auto& row) { return if_known(report_cost(table, row), times); }},
      {{report ? "ours" : "", "cost"},
       8,
       true,
       [&](const auto& row) { return times(table.relative_cost(row).median); }},
      {{"", ""}, 6, spread, [&](const auto& row) { return half_width(table.relative_cost(row)); }},
      {{"speed-up", "vs report"},
       9,
       report,
       [&table](const auto& row) {
         const auto time = report_time(table, row);
         return time ? (time->more_than ? ">" : "") + times(*speedup(table, row)) : "-";
       }},
      {{"", "Mrays/s"},
       8,
       true,
       [](const auto& row) { return three_digits(row.rays_per_s() / 1e6); }},
  };
}

std::string rows_text(const BenchmarkTable& table) {
  constexpr int kStructureWidth = 9;
  const auto columns = columns_of(table);
  const auto line = [&](std::string_view structure, const auto& cell) {
    std::string text = fmt::format("{:<{}}", structure, kStructureWidth);
    for (const Column& column : columns) {
      if (!column.shown) continue;
      text += column.width < 0 ? fmt::format(" {:<{}}", cell(column), -column.width)
                               : fmt::format(" {:>{}}", cell(column), column.width);
    }
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  };
  std::string out = line("structure", [](const Column& c) { return c.heading[0]; });
  out += line("", [](const Column& c) { return c.heading[1]; });
  int width = kStructureWidth;
  for (const Column& column : columns) width += column.shown ? 1 + std::abs(column.width) : 0;
  out += std::string(size_t(width), '-') + "\n";
  for (const BenchmarkRow& row : table.rows) {
    const AccelKind accel = row.combination.accel;
    if (&row != &table.rows.front() && accel != (&row)[-1].combination.accel) out += "\n";
    // Brute force, as the report calls it.
    out += line(accel == AccelKind::none ? "no grid" : accel_name(accel),
                [&](const Column& column) { return column.cell(row); });
  }
  return out;
}

std::string notes_text(const BenchmarkTable& table) {
  std::string out;
  for (const BenchmarkStructure& structure : table.structures)
    out += structure_line(structure) + "\n";
  if (table.disagreement)
    out += fmt::format("The structures' plain pictures differ in {:.3g} % of the pixels.\n",
                       100 * *table.disagreement);
  else
    out += "There is only one structure, so its picture could not be compared.\n";
  if (table.repeat > 1)
    out += fmt::format(
        "Medians of {} runs, ± half of the range. The runs of a\n"
        "structure went in rounds over all its rows, so a drift of the machine affects all "
        "rows alike.\n",
        table.repeat);
  out += "cost: relative to the same structure without effects, in the same round.\n";
  if (report_knows(table))
    out +=
        fmt::format("report: {}; - where unknown.\nspeed-up: report over ours.\n", kReportSource);
  return out;
}

std::string claims_text(const BenchmarkTable& table) {
  const auto claims = report_claims(table);
  if (claims.empty()) return {};
  std::string out = "\nWhat the report claims, by these figures:\n";
  for (size_t i = 0; i < claims.size(); ++i) {
    const auto& [claim, report, ours, verdict] = claims[i];
    out += fmt::format("{}. {}:\n   {}\n", i + 1, claim, verdict_words(verdict));
    out += fmt::format("     report  {}\n     ours    {}\n", report, ours.empty() ? "-" : ours);
  }
  return out;
}

}  // namespace

std::string seconds_label(double s) {
  return s < 1 ? three_digits(s * 1000) + " ms" : three_digits(s) + " s";
}

std::string tick_label(double s) {
  return s < 0.999e-3 ? fmt::format("{:g} µs", s * 1e6)
         : s < 0.999  ? fmt::format("{:g} ms", s * 1000)
                      : fmt::format("{:g} s", s);
}

std::string three_digits(double value) {
  if (!(value > 0) || !std::isfinite(value)) return fmt::format("{:.0f}", value);
  const int before_point = int(std::floor(exact_log10(value))) + 1;
  return fmt::format("{:.{}f}", value, std::clamp(3 - before_point, 0, 6));
}

std::string table_text(const BenchmarkTable& table) {
  return fmt::format("{}, {}x{}, depth {}, {} thread{}, {}, raio {}\n{}\n\n", table.scene,
                     table.width, table.height, table.depth, table.threads,
                     table.threads == 1 ? "" : "s",
                     table.repeat > 1 ? fmt::format("median of {}", table.repeat) : "one run",
                     table.version, table.machine) +
         rows_text(table) + "\n" + notes_text(table) + claims_text(table);
}

std::string table_csv(const BenchmarkTable& table) {
  const auto optional = [](std::optional<double> v) { return v ? fmt::format("{}", *v) : ""; };
  // A name may contain a comma or a quote (RFC 4180).
  std::string scene = "\"";
  for (const char c : table.scene) scene += c == '"' ? "\"\"" : std::string(1, c);
  scene += "\"";
  std::string out = "scene,width,height,depth,threads,accelerator";
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    if (table.lists(i)) out += fmt::format(",{}", kBenchmarkEffects[i].name);
  out +=
      ",samples_per_pixel,report_s,report_more_than,runs,seconds,seconds_min,seconds_max,rays,"
      "rays_per_s,speedup,report_cost,relative_cost,relative_cost_min,relative_cost_max\n";
  for (const BenchmarkRow& row : table.rows) {
    const auto [accel, effects] = row.combination;
    const auto report = report_time(table, row);
    const Spread seconds = row.seconds(), cost = table.relative_cost(row);
    out += fmt::format("{},{},{},{},{},{}", scene, table.width, table.height, table.depth,
                       table.threads, accel_name(accel));
    for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
      if (table.lists(i)) out += effects >> i & 1 ? ",1" : ",0";
    out += fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", samples_per_pixel(effects),
                       report ? fmt::format("{}", report->seconds) : "",
                       report ? fmt::format("{:d}", report->more_than) : "", row.runs_s.size(),
                       seconds.median, seconds.least, seconds.most, row.rays, row.rays_per_s(),
                       optional(speedup(table, row)), optional(report_cost(table, row)),
                       cost.median, cost.least, cost.most);
  }
  return out;
}

namespace {

Json row_json(const BenchmarkTable& table, const BenchmarkRow& row) {
  const auto optional = [](const auto& v) { return v ? Json(*v) : Json(nullptr); };
  const auto report = report_time(table, row);
  Json effects;
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    if (table.lists(i))
      effects[std::string(kBenchmarkEffects[i].name)] = bool(row.combination.effects >> i & 1);
  const Spread seconds = row.seconds(), cost = table.relative_cost(row);
  return {{"accelerator", accel_name(row.combination.accel)},
          {"effects", effects},
          {"samples_per_pixel", samples_per_pixel(row.combination.effects)},
          {"report_s", report ? Json(report->seconds) : Json(nullptr)},
          {"report_more_than", report ? Json(report->more_than) : Json(nullptr)},
          {"runs", row.runs_s.size()},
          {"seconds", seconds.median},
          {"seconds_min", seconds.least},
          {"seconds_max", seconds.most},
          {"runs_s", row.runs_s},
          {"rays", row.rays},
          {"rays_per_s", row.rays_per_s()},
          {"speedup", optional(speedup(table, row))},
          {"report_cost", optional(report_cost(table, row))},
          {"relative_cost", cost.median},
          {"relative_cost_min", cost.least},
          {"relative_cost_max", cost.most}};
}

}  // namespace

std::string table_json(const BenchmarkTable& table) {
  Json json{{"version", table.version},
            {"scene", table.scene},
            {"resolution", {table.width, table.height}},
            {"seed", table.seed},
            {"threads", table.threads},
            {"depth", table.depth},
            {"machine", table.machine},
            {"repeat", table.repeat},
            {"report_source", kReportSource},
            {"disagreement", table.disagreement ? Json(*table.disagreement) : Json(nullptr)}};
  json["accelerators"] = Json::array();
  for (const auto& [info, build_s] : table.structures) {
    json["accelerators"].push_back({{"name", info.name},
                                    {"bytes", info.bytes},
                                    {"cells", info.cells},
                                    {"references", info.references},
                                    {"build_s", build_s}});
  }
  json["rows"] = Json::array();
  for (const BenchmarkRow& row : table.rows) json["rows"].push_back(row_json(table, row));
  json["claims"] = Json::array();
  for (const auto& [claim, report, ours, verdict] : report_claims(table))
    json["claims"].push_back({{"claim", claim},
                              {"report", report},
                              {"ours", ours.empty() ? Json(nullptr) : Json(ours)},
                              {"verdict", verdict_words(verdict)}});
  return json_text(json);
}

}  // namespace raio::core::app
