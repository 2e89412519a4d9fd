#include "io/atoms/marks.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "io/atoms/element_names.h"

namespace raio::core {
namespace {

constexpr uint32_t kLong = 1U << 31;  // ASCII leaves this bit free
constexpr uint32_t kNoNumber = UINT32_MAX;
constexpr size_t kShort = 4;

}  // namespace

std::optional<uint64_t> whole_number(std::string_view text) {
  text = without_blanks(text);
  uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

uint32_t AtomMarks::code_of(std::string_view name) {
  const bool is_short = name.size() <= kShort &&
                        std::ranges::all_of(name, [](char c) { return c != 0 && (c & 128) == 0; });
  if (is_short) {
    uint32_t code = 0;
    for (size_t i = name.size(); i-- > 0;) code = code << 8 | uint32_t(name[i]);
    return code;
  }
  if (const auto at = places_.find(name); at != places_.end()) return at->second | kLong;
  const auto place = uint32_t(long_names_.size());
  long_names_.emplace_back(name), places_.emplace(name, place);
  return place | kLong;
}

void AtomMarks::add(std::string_view name, std::optional<uint64_t> number) {
  if (!name.empty()) {
    names_.resize(count_);  // the atoms before have none
    names_.push_back(code_of(name));
  }
  const uint32_t wanted = number && *number < kNoNumber ? uint32_t(*number) : kNoNumber;
  const auto expected = [&] {
    const Run& run = runs_.back();
    return run.number == kNoNumber ? kNoNumber : run.number + (count_ - run.first);
  };
  if (runs_.empty() || expected() != wanted) runs_.push_back({count_, wanted});
  ++count_;
}

std::string AtomMarks::name(uint32_t index) const {
  if (index >= names_.size()) return {};
  uint32_t code = names_[index];
  if (code & kLong) return long_names_[code & ~kLong];
  std::string out;
  for (; code > 0; code >>= 8) out += char(code & 127);
  return out;
}

std::optional<uint32_t> AtomMarks::number(uint32_t index) const {
  if (index >= count_) return std::nullopt;
  const Run& run = *std::prev(std::ranges::upper_bound(runs_, index, {}, &Run::first));
  if (run.number == kNoNumber) return std::nullopt;
  return run.number + (index - run.first);
}

}  // namespace raio::core
