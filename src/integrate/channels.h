// Named channels of numbers that a film can hold besides colours (AOVs), each with the rule that
// combines the samples of a pixel. The film, the files and the command line take names and meanings
// from this one table.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace raio::core {

enum class Channel : uint8_t {
  alpha,
  depth,
  position,
  normal,
  albedo,
  id,
  object,
  samples,
  variance,
  steps,
  tests,
  position_low,
  lamps,
  emission,
  surroundings
};

/// How the samples of a pixel become its value. `first` takes the lowest sample in the film, for
/// values without a meaningful mean: a distance, an id. `derived` is computed when the film is
/// resolved.
enum class ChannelRule : uint8_t { mean, first, derived };

struct ChannelSpec {
  Channel channel;
  std::string_view name;        // in --channels, the EXR layer, the .npz array
  std::string_view components;  // a letter each: EXR's names after the dot
  ChannelRule rule;
  double bound;  // of a sample's value, for the rule `mean`; 0: that of the film's colours
  bool integer;  // 32-bit integers, not floats
  std::string_view help;
};

inline constexpr std::array kChannels = {
    ChannelSpec{Channel::alpha, "alpha", "A", ChannelRule::mean, 1, false,
                "the covered share of the pixel; leaves the background out of the colours"},
    ChannelSpec{Channel::depth, "depth", "Z", ChannelRule::first, 0, false,
                "distance from the eye along the line of sight; infinite where nothing is hit"},
    ChannelSpec{Channel::position, "position", "XYZ", ChannelRule::first, 0, false,
                "the hit point in the coordinates of the file; 0 where nothing is hit"},
    ChannelSpec{Channel::normal, "normal", "XYZ", ChannelRule::mean, 1, false,
                "the unit shading normal towards the eye; 0 where nothing is hit"},
    ChannelSpec{Channel::albedo, "albedo", "RGB", ChannelRule::mean, 1 << 14, false,
                "the surface's diffuse colour, Kd times its colour"},
    ChannelSpec{Channel::id, "id", "I", ChannelRule::first, 0, true,
                "the number of the primitive, from 1; 0 where nothing is hit"},
    ChannelSpec{Channel::object, "object", "I", ChannelRule::first, 0, true,
                "the number of the named object, from 1; 0 where there is none"},
    ChannelSpec{Channel::samples, "samples", "N", ChannelRule::derived, 0, true,
                "the number of samples of the pixel"},
    ChannelSpec{Channel::variance, "variance", "RGB", ChannelRule::derived, 0, false,
                "of the samples' colours; 0 for one sample"},
    ChannelSpec{Channel::steps, "steps", "N", ChannelRule::mean, 1 << 30, false,
                "cells or nodes that an eye ray visits"},
    ChannelSpec{Channel::tests, "tests", "N", ChannelRule::mean, 1 << 30, false,
                "primitives that an eye ray is tested against"},
    ChannelSpec{Channel::position_low, "position_low", "XYZ", ChannelRule::first, 0, false,
                "the rounding error of `position`; added automatically if data is far from 0"},
    ChannelSpec{Channel::lamps, "lamps", "RGB", ChannelRule::mean, 0, false,
                "the part of the colours that the scene's lights light, with `path`"},
    ChannelSpec{Channel::emission, "emission", "RGB", ChannelRule::mean, 0, false,
                "the part that surfaces emit, with `path`"},
    ChannelSpec{Channel::surroundings, "surroundings", "RGB", ChannelRule::mean, 0, false,
                "the part of the background, sky or environment, with `path`"},
};

/// Light groups: they add up to the colours.
inline constexpr std::array kLightGroups = {Channel::lamps, Channel::emission,
                                            Channel::surroundings};

constexpr const ChannelSpec& spec_of(Channel channel) { return kChannels[size_t(channel)]; }

/// A set of channels.
class ChannelSet {
 public:
  constexpr ChannelSet() = default;
  constexpr bool has(Channel c) const { return bits_ >> int(c) & 1; }
  constexpr void add(Channel c) { bits_ |= 1u << int(c); }
  constexpr bool empty() const { return bits_ == 0; }

  friend constexpr bool operator==(ChannelSet, ChannelSet) = default;

 private:
  uint32_t bits_ = 0;
};

}  // namespace raio::core
