// Which Raio this is, for people and for those who cite it.
#pragma once

#include <string>
#include <string_view>

namespace raio::app {

/// The commit that the program was built from, as cmake/commit.cmake found it at the last build;
/// without a hash where the source was no git work tree.
struct Commit {
  std::string_view hash, date;  // "abc1234", "2026-11-22"
  bool modified = false;        // the work tree differed from the commit
};
Commit commit();

/// "raio 0.2.0 (abc1234, 2026-11-22)".
std::string version_text();

}  // namespace raio::app
