// The version, for people and for citations.
#pragma once

#include <string>
#include <string_view>

namespace raio::core::app {

/// The commit of the build, as found by cmake/commit.cmake; without a hash if the source was not a
/// git work tree.
struct Commit {
  std::string_view hash, date;  // "abc1234", "2026-11-22"
  bool modified = false;        // the work tree differed from the commit
};
Commit commit();

/// "raio 0.2.0 (abc1234, 2026-11-22)".
std::string version_text();

}  // namespace raio::core::app
