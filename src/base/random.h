// Counter-based random numbers: each is a pure function of (seed, pixel, sample, purpose), so
// pictures do not depend on threads, tiles, resuming or machines.
#pragma once

#include <bit>
#include <cstdint>

namespace raio::core {

/// A hash of one word: the function pcg of Jarzynski and Olano 2020, "Hash Functions for GPU
/// Rendering", JCGT 9(3), after O'Neill 2014.
constexpr uint32_t scramble(uint32_t v) {
  v = v * 747796405u + 2891336453u;
  v = ((v >> ((v >> 28) + 4)) ^ v) * 277803737u;
  return v ^ (v >> 22);
}

/// A hash of two words, the first of which is already random.
constexpr uint32_t hash_of(uint32_t key, uint32_t number) {
  return scramble(key + number * 0x9e3779b9u);
}

/// Element `i` of a pseudo-random permutation of 0..n-1 chosen by `key`, computed without storing
/// it. Each round, "multiply by an odd number, xor the high half into the low", is a bijection on
/// the next power of two; results outside 0..n-1 repeat (cycle walking), which keeps the bijection.
/// Six rounds are the fewest for which small permutations pass for random. After Kensler 2013,
/// "Correlated Multi-Jittered Sampling", Pixar technical memo 13-01.
constexpr uint32_t permute(uint32_t i, uint32_t n, uint32_t key) {
  if (n <= 1) return 0;
  const int bits = std::bit_width(n - 1);
  const uint32_t mask = uint32_t((uint64_t(1) << bits) - 1);
  const int fold = (bits + 1) / 2;
  do {
    for (uint32_t round = 0; round < 6; ++round) {
      const uint32_t word = scramble(key + round * 0x9e3779b9u);
      i = (i + word) & mask;
      i = (i * (std::rotr(word, 16) | 1u)) & mask;
      i ^= i >> fold;
    }
  } while (i >= n);
  return i;
}

}  // namespace raio::core
