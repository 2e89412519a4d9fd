// Limits of a container: the processors and the memory that Linux control groups allow this
// process. Versions 1 and 2: docs.kernel.org/admin-guide/cgroup-v2.html and cgroup-v1/.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raio::core {

class ControlGroups {
 public:
  /// The control groups of this process. `root` is prepended to all file names, for tests.
  explicit ControlGroups(std::string root = "");

  /// The smallest processor quota on the path to the root of the hierarchy, in processors, for
  /// example 1.5. Nothing without a limit.
  std::optional<double> cores() const;

  struct Memory {
    size_t available = 0;  // bytes below the limit; caches of files count as free
    std::string file;      // with the limit
  };
  /// The group on the path to the root with the least memory left. Nothing without a limit.
  std::optional<Memory> memory() const;

 private:
  // The folders of a controller, from the group of this process to the root of the hierarchy.
  struct Hierarchy {
    bool is_v2 = false;
    std::vector<std::string> folders;
  };
  Hierarchy hierarchy_of(std::string_view controller, std::string_view groups,
                         std::string_view mounts) const;

  std::string root_;
  Hierarchy cpu_, memory_;
};

}  // namespace raio::core
