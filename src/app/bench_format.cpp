#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/bench.h"
#include "app/json.h"
#include "app/terminal.h"

namespace raio::app {

namespace {

std::string times(double factor) { return three_digits(factor) + " x"; }

// Brute force as the report calls it.
std::string_view structure_name(AccelKind kind) {
  return kind == AccelKind::none ? "without grid" : accel_name(kind);
}

std::string structure_line(const BenchStructure& structure) {
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

}  // namespace

std::string three_digits(double value) {
  if (!(value > 0) || !std::isfinite(value)) return fmt::format("{:.0f}", value);
  const int before_point = int(std::floor(std::log10(value))) + 1;
  return fmt::format("{:.{}f}", value, std::clamp(3 - before_point, 0, 6));
}

std::string table_text(const BenchTable& table) {
  std::string out =
      fmt::format("{}, {}x{}, depth {}, {} thread{}, {}, raio {}\n{}\n\n", table.scene, table.width,
                  table.height, table.depth, table.threads, table.threads == 1 ? "" : "s",
                  table.repeat > 1 ? fmt::format("median of {}", table.repeat) : "one run",
                  table.version, table.machine);

  constexpr std::string_view kLine =
      "{:<12} {:<3} {:<8} {:<8} {:>7} {:>7} {:>8} {:>9} {:>8} {:>9} {:>8}\n";
  const auto heading = [&](auto... cells) { out += fmt::format(kLine, cells...); };
  heading("structure", "AA", "soft", "depth of", "samples", "report", "ours", "rays", "Mrays/s",
          "speed-up", "cost");
  heading("", "", "shadows", "field", "a pixel", "s", "s", "traced", "", "vs report", "relative");
  out += std::string(97, '-') + "\n";

  const auto mark = [](bool on) { return on ? "yes" : ""; };
  for (const BenchRow& row : table.rows) {
    const Combination& c = row.combination;
    if (&row != &table.rows.front() && c.accel != (&row)[-1].combination.accel) out += "\n";
    const auto speedup = row.speedup();
    out +=
        fmt::format(kLine, structure_name(c.accel), mark(c.aa), mark(c.soft_shadows), mark(c.dof),
                    samples_per_pixel(c), row.report_s ? fmt::format("{:g}", *row.report_s) : "-",
                    three_digits(row.seconds()), human_count(double(row.rays)),
                    three_digits(row.rays_per_s() / 1e6), speedup ? times(*speedup) : "-",
                    times(table.relative_cost(row)));
  }

  out += "\n";
  for (const BenchStructure& structure : table.structures) out += structure_line(structure) + "\n";
  out += fmt::format("The structures' plain pictures differ in {:.3g} % of the pixels.\n",
                     100 * table.disagreement);
  out += fmt::format("report: {}; - where unknown.\n", kReportSource);
  out += "speed-up: report over ours. cost: against the same structure without effects.\n";
  return out;
}

std::string table_csv(const BenchTable& table) {
  const auto optional = [](std::optional<double> v) { return v ? fmt::format("{}", *v) : ""; };
  // A name may hold a comma or a quote (RFC 4180).
  std::string scene = "\"";
  for (const char c : table.scene) scene += c == '"' ? "\"\"" : std::string(1, c);
  scene += "\"";
  std::string out =
      "scene,width,height,depth,threads,accelerator,aa,soft_shadows,dof,samples_per_pixel,"
      "report_s,seconds,rays,rays_per_s,speedup,relative_cost\n";
  for (const BenchRow& row : table.rows) {
    const Combination& c = row.combination;
    out += fmt::format("{},{},{},{},{},{},{:d},{:d},{:d},{},{},{},{},{},{},{}\n", scene,
                       table.width, table.height, table.depth, table.threads, accel_name(c.accel),
                       c.aa, c.soft_shadows, c.dof, samples_per_pixel(c), optional(row.report_s),
                       row.seconds(), row.rays, row.rays_per_s(), optional(row.speedup()),
                       table.relative_cost(row));
  }
  return out;
}

std::string table_json(const BenchTable& table) {
  const auto optional = [](std::optional<double> v) { return v ? Json(*v) : Json(nullptr); };
  Json json{{"version", table.version},
            {"scene", table.scene},
            {"resolution", {table.width, table.height}},
            {"seed", table.seed},
            {"threads", table.threads},
            {"depth", table.depth},
            {"machine", table.machine},
            {"repeat", table.repeat},
            {"report_source", kReportSource},
            {"disagreement", table.disagreement}};
  json["accelerators"] = Json::array();
  for (const auto& [info, build_s] : table.structures) {
    json["accelerators"].push_back({{"name", info.name},
                                    {"bytes", info.bytes},
                                    {"cells", info.cells},
                                    {"references", info.references},
                                    {"build_s", build_s}});
  }
  json["rows"] = Json::array();
  for (const BenchRow& row : table.rows) {
    const Combination& c = row.combination;
    const Json effects{{"aa", c.aa}, {"soft_shadows", c.soft_shadows}, {"dof", c.dof}};
    json["rows"].push_back({{"accelerator", accel_name(c.accel)},
                            {"effects", effects},
                            {"samples_per_pixel", samples_per_pixel(c)},
                            {"report_s", optional(row.report_s)},
                            {"seconds", row.seconds()},
                            {"runs_s", row.runs_s},
                            {"rays", row.rays},
                            {"rays_per_s", row.rays_per_s()},
                            {"speedup", optional(row.speedup())},
                            {"relative_cost", table.relative_cost(row)}});
  }
  return json_text(json);
}

}  // namespace raio::app
