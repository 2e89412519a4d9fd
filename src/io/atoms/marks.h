// The name and the number that a file gives each of its atoms. Files have millions of them, so
// names are packed and numbers stored as runs.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raio::core {

/// The number that a text has between blanks, in decimal digits; nothing if there is more or less.
std::optional<uint64_t> whole_number(std::string_view text);

class AtomMarks {
 public:
  /// The next atom of the file. An empty name or no number: the file has none. Numbers of 2^32 - 1
  /// or more are dropped.
  void add(std::string_view name, std::optional<uint64_t> number);

  /// By the atom's index among those added.
  std::string name(uint32_t index) const;
  std::optional<uint32_t> number(uint32_t index) const;

 private:
  // Atoms numbered one after the other.
  struct Run {
    uint32_t first;  // its index
    uint32_t number;
  };
  uint32_t code_of(std::string_view name);

  uint32_t count_ = 0;
  std::vector<uint32_t> names_;  // up to four letters each, or a place in long_names_
  std::vector<std::string> long_names_;
  std::map<std::string, uint32_t, std::less<>> places_;  // of long names
  std::vector<Run> runs_;
};

}  // namespace raio::core
