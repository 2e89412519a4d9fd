// A sky: six square pictures around everything, seen by direction alone. Plain data, which
// io/cube_map.h reads and integrate/sky-inl.h looks up.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/hash.h"
#include "base/vec.h"

namespace raio {

/// The faces towards -x, +x, +y, -y, +z and -z. The numbers are places in a CubeMap.
enum class CubeFace : uint8_t { right, left, top, bottom, front, back };
inline constexpr size_t kCubeFaces = 6;
inline constexpr std::array<std::string_view, kCubeFaces> kCubeFaceNames = {
    "right", "left", "top", "bottom", "front", "back"};

/// Where a direction meets a face: s from the left and t from the bottom, -1 to 1. The face is that
/// of the largest component; of equal ones, x goes before y and y before z. What (sc, tc) is on
/// each face, before it is divided by that component's magnitude, is P3F's.
struct CubePlace {
  CubeFace face = CubeFace::right;
  float s = 0, t = 0;
};
CubePlace cube_place(Vec3f direction);
/// The direction, not of unit length, that meets a face there. Also beyond its edges.
Vec3f cube_direction(const CubePlace& place);

/// Texels are 0xBBGGRR, display values of 0 to 255. A face is stored with a texel more on each
/// side, those of its neighbours, so that filters need not know of edges: (side + 2) rows from top
/// to bottom of (side + 2) texels from left to right.
struct CubeMap {
  std::string folder;  // as an option or a scene names it
  int side = 0;        // of a face, texels
  std::vector<uint32_t> texels;
  uint8_t largest = 0;  // of all values
  Hash128 hash{};       // of side and texels

  size_t stride() const { return size_t(side) + 2; }
  /// Of a texel of a face; columns and rows from -1 to side.
  size_t index(CubeFace face, int column, int row) const {
    return (size_t(face) * stride() + size_t(row + 1)) * stride() + size_t(column + 1);
  }

  /// Fills the texels around the faces, `largest` and `hash` after the others were set. What three
  /// faces have at a corner of the cube is the mean of theirs.
  void finish();
};

}  // namespace raio
