// Loops over many things on all threads, and over few on one: to wake the others takes as long as
// thousands of primitives.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace raio {

inline constexpr size_t kLoopChunk = 4096;

constexpr size_t chunks_of(size_t count) { return (count + kLoopChunk - 1) / kLoopChunk; }

/// Calls f(c, first, end) for the chunks c of 0 .. count - 1.
template <class F>
void for_chunks(size_t count, const F& f) {
  const auto one = [&](size_t c) { f(c, c * kLoopChunk, std::min(count, (c + 1) * kLoopChunk)); };
  if (const size_t chunks = chunks_of(count); chunks > 1)
    tbb::parallel_for(size_t(0), chunks, one);
  else if (chunks == 1)
    one(0);
}

/// Calls f(i) for 0 .. count - 1.
template <class F>
void for_each_index(size_t count, const F& f) {
  for_chunks(count, [&](size_t, size_t first, size_t end) {
    for (size_t i = first; i < end; ++i) f(i);
  });
}

}  // namespace raio
