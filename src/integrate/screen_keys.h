// Keys that make samples of neighbouring pixels complement each other: one per pixel of a group, to
// be XOR-ed with the points of Sobol's sequence, which the group shares.
//
// For all j and k, the first 2^k samples of all pixels of a block of 2^j x 2^j pixels then form a
// (0,2)-net of 4^j 2^k points, as even as those of one pixel. If one pixel gets too much of
// something, its neighbours get too little: high-frequency noise, which eyes average away. Ahmed
// and Wonka 2020, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical
// Ordering of Pixels", ACM TOG 39(6), have the same aim; this works for any number of samples at
// once.
//
// Proof. Let s_i be the bits of the sample's number, and a_i, b_i those of the pixel's position in
// its group from the finest level up. Over the field of two elements, take the rational function
//
//   f(z)  =  sum s_i z^i  +  sum (a_i + b_i z) / (1 + z + z^2)^(i + 1)
//
// and the coefficients of its Taylor series about z = 0 as the binary digits of x, those about z =
// 1 as the digits of y. The first sum is Sobol's sequence. Two points of a block in the same box of
// a net differ by an f with 2 j + k zeros but at most 2 j + k - 1 poles, which is therefore zero.
// (Niederreiter and Xing construct such sequences; pixels are a place of degree two.)
#pragma once

#include <array>

#include "base/random.h"

namespace raio::core {

/// Groups are 32 x 32 pixels.
inline constexpr int kGroupShift = 5;
inline constexpr uint32_t kGroup = 1u << kGroupShift;

/// The series `bits` over 1 + z + z^2, both modulo z^16; bit i is the coefficient of z^i. Equals (1
/// + z) / (1 + z^3).
constexpr uint32_t over_place(uint32_t bits) {
  bits ^= bits << 1;
  for (const int power : {3, 6, 12}) bits ^= bits << power;
  return bits & 0xffffu;
}

/// Row by row; the digits of x in the low half of a key, those of y in the high half, the first
/// digit lowest. Each block on each level numbers its four quarters in its own order, which hides
/// the lattice of blocks.
inline constexpr auto kScreenKeys = [] {
  std::array<uint32_t, kGroup * kGroup> keys{};
  uint32_t one = 1, z = 2, one_at_1 = 1, z_at_1 = 3;  // about z = 1, z is 1 + w
  for (int level = 0; level < kGroupShift; ++level) {
    one = over_place(one), z = over_place(z);
    one_at_1 = over_place(one_at_1), z_at_1 = over_place(z_at_1);
    const uint32_t side = 1u << level;
    for (uint32_t y = 0; y < kGroup; y += side)
      for (uint32_t x = 0; x < kGroup; x += side) {
        const uint32_t block = (y >> (level + 1)) * kGroup + (x >> (level + 1));
        const uint32_t quarter = (y >> level & 1) * 2 + (x >> level & 1);
        const uint32_t digit = permute(quarter, 4, scramble(block * 8 + uint32_t(level)));
        const uint32_t key =
            (digit & 1 ? one | one_at_1 << 16 : 0) ^ (digit & 2 ? z | z_at_1 << 16 : 0);
        for (uint32_t i = 0; i < side * side; ++i)
          keys[(y + i / side) * kGroup + x + i % side] ^= key;
      }
  }
  return keys;
}();

}  // namespace raio::core
