// Pictures of noise, the same ones at every run.
#pragma once

#include <bit>
#include <cstdint>

#include "io/image/image.h"

namespace raio::core::tests {

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

/// With alpha from 0 to 1, to which the colours are premultiplied, and layers of all kinds, in the
/// order in which they are read.
inline Picture layered(int width, int height) {
  Picture picture;
  picture.color = noise(width, height);
  uint64_t seed = 2;
  for (Rgb& pixel : picture.color.pixels) {
    picture.alpha.push_back(float(next_random(seed) % 9) / 8);
    pixel *= picture.alpha.back();
  }
  const auto layer = [&]<class T>(const char* name, std::vector<std::string> components, T) {
    Column<T> values;
    for (size_t i = 0; i < picture.alpha.size() * components.size(); ++i)
      values.push_back(std::bit_cast<T>(uint32_t(next_random(seed))));
    picture.layers.push_back({name, std::move(components), std::move(values)});
  };
  layer("albedo", {"R", "G", "B"}, 0.f);
  layer("depth", {"Z"}, 0.f);
  layer("id", {"I"}, 0u);
  layer("light.key", {"R", "G", "B", "A"}, 0.f);
  layer("normal", {"X", "Y", "Z"}, 0.f);
  layer("pair", {"first", "second"}, 0u);
  layer("samples", {""}, 0u);
  return picture;
}

}  // namespace raio::core::tests
