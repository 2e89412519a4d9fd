// How closely a median is known.
#pragma once

#include <vector>

namespace raio {

/// A median, and an interval around it.
struct MedianInterval {
  double low = 0, median = 0, high = 0;

  /// As a part of the median.
  double half_width() const { return median > 0 ? (high - low) / 2 / median : 0; }

  friend bool operator==(const MedianInterval&, const MedianInterval&) = default;
};

/// Of at least one value. The interval contains the median of the values' distribution, whatever
/// that is, with a probability of at least 90 %: it ends at two of the values in order, which are
/// chosen by the sign test. Fewer than five values cannot be that sure; theirs reaches from the
/// least to the most.
MedianInterval median_interval(std::vector<double> values);

}  // namespace raio
