// The clock for measuring time.
#pragma once

#include <chrono>

namespace raio::core {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace raio::core
