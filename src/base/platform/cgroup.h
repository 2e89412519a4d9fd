// Limits of a container: what the control groups of Linux let this process have. Both versions:
// docs.kernel.org/admin-guide/cgroup-v2.html and cgroup-v1/. For the POSIX files of this folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raio {

class ControlGroups {
 public:
  /// Those of this process. `root` stands before the names of all files: "" for the system's own.
  explicit ControlGroups(std::string root = "");

  /// The least share of processors that a group on the way to the root of the hierarchy has: 1.5 is
  /// the time of one and a half. Nothing where none has a limit.
  std::optional<double> cores() const;

  struct Memory {
    size_t available = 0;  // bytes below the limit; caches of files count as free
    std::string file;      // that has the limit
  };
  /// Of the group on the way to the root that has the least left. Nothing where none has a limit.
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

}  // namespace raio
