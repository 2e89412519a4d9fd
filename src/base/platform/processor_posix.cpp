#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "base/platform/cgroup.h"
#include "base/platform/processor.h"

namespace raio::core {
namespace {

constexpr int kMaxCores = std::numeric_limits<int>::max();

}  // namespace

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

int usable_cores() {
  const auto cores = ControlGroups().cores();
  if (!cores || *cores > kMaxCores) return kMaxCores;
  return std::max(1, int(std::ceil(*cores)));
}

}  // namespace raio::core
