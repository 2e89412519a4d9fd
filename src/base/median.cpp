#include "base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raio::core {

MedianInterval median_interval(std::vector<double> values) {
  std::ranges::sort(values);
  const size_t n = values.size(), half = n / 2;
  // The median lies below the (k + 1)th smallest value with the probability that n coin tosses show
  // at most k heads. The other end is symmetric.
  size_t outside = 0;
  double term = std::ldexp(1.0, -int(n)), below = term;
  for (size_t k = 1; k < half; ++k) {
    term *= double(n - k + 1) / double(k), below += term;
    if (2 * below > 0.1) break;
    outside = k;
  }
  const double median = n % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
  return {values[outside], median, values[n - 1 - outside]};
}

}  // namespace raio::core
