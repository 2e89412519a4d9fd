// Pictures of noise, the same ones at every run.
#pragma once

#include <cstdint>

#include "io/image/image.h"

namespace raio::testing {

inline uint64_t next_random(uint64_t& state) {
  // SplitMix64: Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators".
  uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

/// Values from a little below 0 to a little above 1, different in every channel.
inline Image noise(int width, int height, uint64_t seed = 1) {
  Image image(width, height);
  for (Rgb& pixel : image.pixels)
    for (int channel = 0; channel < 3; ++channel)
      pixel[channel] = float(next_random(seed) >> 40) * 0x1p-24f * 1.5f - 0.25f;
  return image;
}

}  // namespace raio::testing
