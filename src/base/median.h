// A median with its confidence interval.
#pragma once

#include <vector>

namespace raio::core {

/// A median and an interval around it.
struct MedianInterval {
  double low = 0, median = 0, high = 0;

  /// Relative to the median.
  double half_width() const { return median > 0 ? (high - low) / 2 / median : 0; }

  friend bool operator==(const MedianInterval&, const MedianInterval&) = default;
};

/// The median of at least one value. The interval contains the median of the underlying
/// distribution, whatever that is, with a probability of at least 90 %; its ends are order
/// statistics chosen by the sign test. Fewer than five values cannot reach 90 %: then the interval
/// spans all values.
MedianInterval median_interval(std::vector<double> values);

}  // namespace raio::core
