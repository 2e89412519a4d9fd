// Measuring and reporting of the suites: alternating runs, a few statistics, rows of results as a
// table for people and lines of JSON for programs.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/json.h"

namespace raio::core::bench {

using app::Json;

/// Ends the program from anywhere. Status 1: a check failed, 2: bad input, 3: no resource.
struct Failure {
  int status;
  std::string message;
};
[[noreturn]] inline void give_up(int status, const std::string& message) {
  throw Failure{status, message};
}

/// One line on standard error: the current activity.
void tell(std::string_view message);

/// Wall time; with the parallel work on this many threads.
double seconds_of(const std::function<void()>& work);
double seconds_on(int threads, const std::function<void()>& work);

/// One of the compared alternatives: does its work once and returns the seconds it took.
using Contender = std::function<double()>;

/// The seconds of each contender in each round. They run alternately in every round, so other load
/// affects them alike. A first round warms up and is not counted.
std::vector<std::vector<double>> alternate(std::span<const Contender> contenders, int rounds);

/// The quantile `q` of the values, in any order, with linear interpolation.
double quantile(std::vector<double> values, double q);
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }

/// median_s, quartiles_s, least_s and runs_s; `ratio`: the median of the `first` divided by that of
/// these.
void add_times(Json& row, const std::vector<double>& runs_s, const std::vector<double>& first);

/// A column of the table: the member `key` of each row, a number times `scale`.
struct TableColumn {
  std::string_view key, heading;
  double scale = 1;
};

void print_table(const std::vector<Json>& rows, std::initializer_list<TableColumn> columns);

/// For each value of `group`: the geometric mean of the rows' `ratio`, and the largest with its
/// scene.
void print_means(const std::vector<Json>& rows, const std::string& group, const std::string& ratio);

/// A line per row, to a file or "-".
void write_json(const std::vector<Json>& rows, const std::string& path);

}  // namespace raio::core::bench
