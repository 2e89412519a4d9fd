// A sky: six square pictures around the scene, looked up by direction. Plain data, read by
// io/cube_map.h and sampled by integrate/sky-inl.h.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/hash.h"
#include "base/vec.h"

namespace raio::core {

/// The faces towards -x, +x, +y, -y, +z and -z; values are indices in a CubeMap.
enum class CubeFace : uint8_t { right, left, top, bottom, front, back };
inline constexpr size_t kCubeFaces = 6;
inline constexpr std::array<std::string_view, kCubeFaces> kCubeFaceNames = {
    "right", "left", "top", "bottom", "front", "back"};

/// Where a direction hits a face: s from the left and t from the bottom, -1 to 1. The face is that
/// of the largest component; ties prefer x, then y. As in P3F, (sc, tc) on each face are divided by
/// that component's magnitude.
struct CubePlace {
  CubeFace face = CubeFace::right;
  float s = 0, t = 0;
};
CubePlace cube_place(Vec3f direction);
/// The direction, not normalized, to this place; also beyond the face's edges.
Vec3f cube_direction(const CubePlace& place);

/// Texels are 0xBBGGRR, display values of 0 to 255. A face is stored with a border of one texel,
/// copied from its neighbours, so that filters can ignore edges: (side + 2) rows from top to bottom
/// of (side + 2) texels from left to right.
struct CubeMap {
  std::string folder;  // as named by an option or a scene
  int side = 0;        // of a face, in texels
  std::vector<uint32_t> texels;
  uint8_t largest = 0;  // of all values
  Hash128 hash{};       // of side and texels

  size_t stride() const { return size_t(side) + 2; }
  /// The index of a texel; columns and rows from -1 to side.
  size_t index(CubeFace face, int column, int row) const {
    return (size_t(face) * stride() + size_t(row + 1)) * stride() + size_t(column + 1);
  }

  /// Fills the border texels, `largest` and `hash` when the others are set. Texels at a corner of
  /// the cube are the mean of three faces.
  void finish();
};

}  // namespace raio::core
