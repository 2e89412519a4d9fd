// The set of samples that a tile of a film holds.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>
#include <vector>

namespace raio::core {

/// Samples first .. end - 1 of a pixel, numbered from 0.
struct SampleSpan {
  uint32_t first = 0, end = 0;

  uint32_t count() const { return end - first; }
  bool empty() const { return first >= end; }
  friend bool operator==(const SampleSpan&, const SampleSpan&) = default;
};

/// The rounds of a picture whose tiles get different numbers of samples: samples 0 .. first - 1,
/// then in each round as many as in all before it. Sobol's sequence is most even at their ends.
struct SampleRounds {
  uint32_t first = 0;  // 0: no rounds

  /// The first sample of the round of a sample.
  uint32_t start(uint32_t sample) const {
    if (first == 0 || sample < first) return 0;
    uint32_t start = first;
    while (start <= sample / 2) start *= 2;
    return start;
  }
  /// The end of the round that starts there.
  uint32_t end(uint32_t start) const {
    return first == 0 ? std::numeric_limits<uint32_t>::max() : std::max(2 * start, first);
  }
};

/// Spans in ascending order with gaps between them.
class SampleSet {
 public:
  SampleSet() = default;
  SampleSet(SampleSpan span) {
    if (!span.empty()) append(span);
  }

  const std::vector<SampleSpan>& spans() const { return spans_; }
  bool empty() const { return spans_.empty(); }
  /// The lowest sample; for an empty set the largest number.
  uint32_t first() const {
    return empty() ? std::numeric_limits<uint32_t>::max() : spans_.front().first;
  }
  /// One past the highest sample; 0 for an empty set.
  uint32_t end() const { return empty() ? 0 : spans_.back().end; }

  /// The number of samples, in total or within a span.
  uint32_t count() const { return count({0, end()}); }
  uint32_t count(SampleSpan within) const {
    uint32_t count = 0;
    for (const SampleSpan& s : spans_) {
      const SampleSpan both = intersection(s, within);
      if (!both.empty()) count += both.count();
    }
    return count;
  }

  /// The first contiguous missing samples of `wanted`. If none are missing, the span is empty and
  /// its `first` is at least wanted.end.
  SampleSpan first_missing(SampleSpan wanted) const {
    uint32_t first = wanted.first;
    for (const SampleSpan& s : spans_) {
      if (s.end <= first) continue;
      if (s.first > first) return {first, std::max(first, std::min(s.first, wanted.end))};
      first = s.end;
    }
    return {first, std::max(first, wanted.end)};
  }

  /// All missing samples of `wanted`.
  SampleSet missing(SampleSpan wanted) const {
    SampleSet all;
    for (SampleSpan s; !(s = first_missing(wanted)).empty(); wanted.first = s.end) all.append(s);
    return all;
  }

  /// The first contiguous samples that are in both sets; empty if there are none.
  SampleSpan overlap(const SampleSet& other) const {
    for (auto a = spans_.begin(), b = other.spans_.begin();
         a != spans_.end() && b != other.spans_.end(); a->end < b->end ? ++a : ++b)
      if (const SampleSpan both = intersection(*a, *b); !both.empty()) return both;
    return {};
  }

  /// Appends samples after all others, with a gap.
  void append(SampleSpan span) {
    assert(!span.empty() && (empty() || span.first > end()));
    spans_.push_back(span);
  }
  /// Adds samples that are not in the set.
  void add(const SampleSet& other) {
    assert(overlap(other).empty());
    spans_.insert(spans_.end(), other.spans_.begin(), other.spans_.end());
    std::ranges::sort(spans_, {}, &SampleSpan::first);
    size_t last = 0;
    for (const SampleSpan s : spans_)
      if (last > 0 && spans_[last - 1].end == s.first)
        spans_[last - 1].end = s.end;
      else
        spans_[last++] = s;
    spans_.resize(last);
  }

  friend bool operator==(const SampleSet&, const SampleSet&) = default;

 private:
  static SampleSpan intersection(SampleSpan a, SampleSpan b) {
    return {std::max(a.first, b.first), std::min(a.end, b.end)};
  }

  std::vector<SampleSpan> spans_;
};

}  // namespace raio::core
