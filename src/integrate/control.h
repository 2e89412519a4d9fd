// Shared by a render and its observers in other threads.
#pragma once

#include <atomic>
#include <cstdint>

namespace raio {

struct RenderControl {
  std::atomic<bool> stop{false};  // set it to end the render soon
  std::atomic<uint64_t> rays_done{0};
  std::atomic<uint64_t> work_done{0};  // of work_total
  std::atomic<uint64_t> work_total{0};
};

}  // namespace raio
