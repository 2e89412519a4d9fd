#include "bench/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "app/bench.h"
#include "io/file.h"
#include "render/render.h"

namespace raio::core::bench {

void tell(std::string_view message) { fmt::print(stderr, "raio_bench: {}\n", message); }

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double seconds_on(int threads, const std::function<void()>& work) {
  double seconds = 0;
  Executor(threads).run([&] { seconds = seconds_of(work); });
  return seconds;
}

std::vector<std::vector<double>> alternate(std::span<const Contender> contenders, int rounds) {
  std::vector<std::vector<double>> seconds(contenders.size());
  for (const Contender& c : contenders) c();
  for (int round = 0; round < rounds; ++round)
    for (size_t i = 0; i < contenders.size(); ++i) seconds[i].push_back(contenders[i]());
  return seconds;
}

double quantile(std::vector<double> values, double q) {
  std::ranges::sort(values);
  const double place = q * double(values.size() - 1);
  const size_t below = size_t(place), above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], place - double(below));
}

void add_times(Json& row, const std::vector<double>& runs_s, const std::vector<double>& first) {
  row["median_s"] = median(runs_s);
  row["quartiles_s"] = {quantile(runs_s, 0.25), quantile(runs_s, 0.75)};
  row["least_s"] = std::ranges::min(runs_s);
  row["runs_s"] = runs_s;
  if (&runs_s != &first) row["ratio"] = median(first) / median(runs_s);
}

namespace {

std::string cell(const Json& row, const TableColumn& column) {
  if (!row.contains(column.key)) return "-";
  const Json& value = row[column.key];
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer() && column.scale == 1) return value.dump();
  return app::three_digits(value.get<double>() * column.scale);
}

}  // namespace

void print_table(const std::vector<Json>& rows, std::initializer_list<TableColumn> columns) {
  std::vector<std::string> lines(rows.size() + 1);
  for (const TableColumn& column : columns) {
    std::vector<std::string> cells{std::string(column.heading)};
    for (const Json& row : rows) cells.push_back(cell(row, column));
    const size_t width = std::ranges::max(cells, {}, &std::string::size).size();
    const bool text = std::ranges::any_of(rows, [&](const Json& row) {
      return row.contains(column.key) && row[column.key].is_string();
    });
    for (size_t i = 0; i < cells.size(); ++i)
      lines[i] += text ? fmt::format("{:<{}}  ", cells[i], width)
                       : fmt::format("{:>{}}  ", cells[i], width);
  }
  for (std::string& line : lines) {
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  }
}

void print_means(const std::vector<Json>& rows, const std::string& group,
                 const std::string& ratio) {
  std::vector<std::string> groups;
  for (const Json& row : rows)
    if (row.contains(ratio) &&
        std::ranges::find(groups, row[group].get<std::string>()) == groups.end())
      groups.push_back(row[group]);
  for (const std::string& name : groups) {
    double log_sum = 0, worst = 0;
    int count = 0;
    std::string where;
    for (const Json& row : rows) {
      if (!row.contains(ratio) || row[group] != name) continue;
      const double value = row[ratio];
      log_sum += std::log(value), ++count;
      if (value > worst) worst = value, where = row["scene"];
    }
    fmt::print("{}, {}: geometric mean {}, largest {} ({})\n", ratio, name,
               app::three_digits(std::exp(log_sum / count)), app::three_digits(worst), where);
  }
}

void write_json(const std::vector<Json>& rows, const std::string& path) {
  std::string lines;
  for (const Json& row : rows)
    lines += row.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  if (const auto written = write_file(path, lines); !written) give_up(3, written.error().text());
}

}  // namespace raio::core::bench
