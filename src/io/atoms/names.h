// Numbers names in the order of first use.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace raio::core {

class Names {
 public:
  explicit Names(std::vector<std::string>& list) : list_(list) {}
  uint32_t number(std::string_view name) {
    if (const auto at = numbers_.find(name); at != numbers_.end()) return at->second;
    list_.emplace_back(name);
    return numbers_.emplace(name, uint32_t(list_.size() - 1)).first->second;
  }

 private:
  std::vector<std::string>& list_;
  std::map<std::string, uint32_t, std::less<>> numbers_;
};

}  // namespace raio::core
