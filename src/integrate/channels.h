// What a film can hold of a picture besides its colours: named channels of numbers, each with the
// rule by which the samples of a pixel become one value. One table, from which the film, the files
// and the command line take names and meanings.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace raio {

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
  position_low
};

/// How the samples of a pixel become its value. `first` is that of the lowest sample that the film
/// has, for what has no sound mean: the distance to two things, the number of one. `derived` is
/// worked out from the film when it is resolved.
enum class ChannelRule : uint8_t { mean, first, derived };

struct ChannelSpec {
  Channel channel;
  std::string_view name;        // in --channels, of the layer in EXR, of the array in .npz
  std::string_view components;  // a letter each: EXR's names after the dot
  ChannelRule rule;
  double bound;  // of a sample's value, where the rule is `mean`
  bool integer;  // numbers of 32 bits, not floats
  std::string_view help;
};

inline constexpr std::array kChannels = {
    ChannelSpec{
        Channel::alpha, "alpha", "A", ChannelRule::mean, 1, false,
        "the share of the pixel that something covers; without the background in the colours"},
    ChannelSpec{Channel::depth, "depth", "Z", ChannelRule::first, 0, false,
                "distance from the eye along the line of sight; infinite where nothing is"},
    ChannelSpec{Channel::position, "position", "XYZ", ChannelRule::first, 0, false,
                "where the surface is, in the coordinates of the file; 0 where nothing is"},
    ChannelSpec{Channel::normal, "normal", "XYZ", ChannelRule::mean, 1, false,
                "the unit normal towards the eye, as shading sees it; 0 where nothing is"},
    ChannelSpec{Channel::albedo, "albedo", "RGB", ChannelRule::mean, 1 << 14, false,
                "the surface's diffuse colour, Kd times its colour"},
    ChannelSpec{Channel::id, "id", "I", ChannelRule::first, 0, true,
                "a number of each primitive, from 1; 0 where nothing is"},
    ChannelSpec{Channel::object, "object", "I", ChannelRule::first, 0, true,
                "a number of each named object, from 1; 0 where there is none"},
    ChannelSpec{Channel::samples, "samples", "N", ChannelRule::derived, 0, true,
                "how many samples the pixel has"},
    ChannelSpec{Channel::variance, "variance", "RGB", ChannelRule::derived, 0, false,
                "of the samples' colours; 0 for one sample"},
    ChannelSpec{Channel::steps, "steps", "N", ChannelRule::mean, 1 << 30, false,
                "cells or nodes that an eye ray visits"},
    ChannelSpec{Channel::tests, "tests", "N", ChannelRule::mean, 1 << 30, false,
                "primitives that an eye ray is tested against"},
    ChannelSpec{
        Channel::position_low, "position_low", "XYZ", ChannelRule::first, 0, false,
        "what the floats of `position` leave of it; comes with it where data is far from 0"},
};

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

}  // namespace raio
