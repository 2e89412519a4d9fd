// Parts of a file that do not fit a scene: a reader guessed them, cut them or left them out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raio::core {

/// Guessed: a rule decided, since the file does not say. Cut: part of a number, row or column is
/// unused. Left out: something is not in the scene.
enum class Severity : uint8_t { warning, error, guessed, cut, left_out };

/// Cases of one kind: their number, the names of the first few, and the location of the first.
struct Notice {
  Severity severity = Severity::warning;
  std::string message;             // "element from the name of the atom"
  size_t count = 0;                // number of cases; 0: about the file as a whole
  std::vector<std::string> names;  // distinct, at most Notices::kNames
  size_t line = 0;                 // of the first case, from 1; 0: unknown
};

/// The notices of a reader, one per kind of case.
class Notices {
 public:
  static constexpr size_t kNames = 5;

  /// Counts `count` more cases of the message, in the order of the file; 0: about the file as a
  /// whole.
  void add(Severity severity, std::string_view message, std::string_view name = {}, size_t line = 0,
           size_t count = 1) {
    auto at = std::find_if(list_.begin(), list_.end(), [&](const Notice& n) {
      return n.severity == severity && n.message == message;
    });
    if (at == list_.end()) {
      list_.push_back({severity, std::string(message), 0, {}, line});
      at = list_.end() - 1;
    }
    at->count += count;
    if (!name.empty() && at->names.size() < kNames &&
        std::find(at->names.begin(), at->names.end(), name) == at->names.end())
      at->names.emplace_back(name);
  }
  /// About the file as a whole.
  void add_whole(Severity severity, std::string_view message) { add(severity, message, {}, 0, 0); }

  const std::vector<Notice>& list() const { return list_; }

 private:
  std::vector<Notice> list_;
};

}  // namespace raio::core
