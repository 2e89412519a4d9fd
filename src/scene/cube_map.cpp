#include "scene/cube_map.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace raio::core {
namespace {

// The face's own texel nearest to a direction.
size_t nearest(const CubeMap& map, Vec3f direction) {
  const CubePlace place = cube_place(direction);
  const auto texel = [&](float along) {
    return std::clamp(int((along + 1) / 2 * float(map.side)), 0, map.side - 1);
  };
  return map.index(place.face, texel(place.s), texel(-place.t));
}

uint32_t mean(std::array<uint32_t, 3> texels) {
  uint32_t out = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    uint32_t sum = 1;  // rounds to nearest
    for (const uint32_t texel : texels) sum += texel >> shift & 255;
    out |= sum / 3 << shift;
  }
  return out;
}

// Fills the border of a face from its neighbours.
void surround(CubeMap& map, CubeFace face) {
  const int n = map.side;
  const auto outside = [&](int column, int row) {
    const auto along = [&](int texel) { return float(2 * texel + 1) / float(n) - 1; };
    map.texels[map.index(face, column, row)] =
        map.texels[nearest(map, cube_direction({face, along(column), -along(row)}))];
  };
  for (int i = 0; i < n; ++i) outside(i, -1), outside(i, n), outside(-1, i), outside(n, i);
  for (const int row : {-1, n})
    for (const int column : {-1, n}) {
      const int in_row = std::clamp(row, 0, n - 1), in_column = std::clamp(column, 0, n - 1);
      map.texels[map.index(face, column, row)] =
          mean({map.texels[map.index(face, in_column, in_row)],
                map.texels[map.index(face, column, in_row)],
                map.texels[map.index(face, in_column, row)]});
    }
}

}  // namespace

CubePlace cube_place(Vec3f d) {
  const float x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  if (x >= y && x >= z) {
    // Looking towards +z with +y up, -x is at the right.
    if (d.x > 0) return {CubeFace::left, d.z / x, d.y / x};
    return {CubeFace::right, -d.z / x, d.y / x};
  }
  if (y >= z) {
    if (d.y > 0) return {CubeFace::top, -d.x / y, -d.z / y};
    return {CubeFace::bottom, -d.x / y, d.z / y};
  }
  if (d.z > 0) return {CubeFace::front, -d.x / z, d.y / z};
  return {CubeFace::back, d.x / z, d.y / z};
}

Vec3f cube_direction(const CubePlace& p) {
  switch (p.face) {
    case CubeFace::right:
      return {-1, p.t, -p.s};
    case CubeFace::left:
      return {1, p.t, p.s};
    case CubeFace::top:
      return {-p.s, 1, -p.t};
    case CubeFace::bottom:
      return {-p.s, -1, p.t};
    case CubeFace::front:
      return {-p.s, p.t, 1};
    case CubeFace::back:
      break;
  }
  return {p.s, p.t, -1};
}

void CubeMap::finish() {
  // The faces' own texels first: neighbours read them. Border texels are only read at corners.
  parallel_for(kCubeFaces, [&](size_t face) { surround(*this, CubeFace(face)); });
  std::array<Hash128, kCubeFaces + 1> hashes;
  std::array<uint8_t, kCubeFaces> most{};
  const size_t count = stride() * stride();
  parallel_for(kCubeFaces, [&](size_t face) {
    const uint32_t* const first = texels.data() + face * count;
    hashes[face] = hash128({reinterpret_cast<const char*>(first), count * sizeof(uint32_t)});
    for (size_t i = 0; i < count; ++i)
      for (int shift = 0; shift < 24; shift += 8)
        most[face] = std::max(most[face], uint8_t(first[i] >> shift & 255));
  });
  hashes.back() = {uint64_t(side), 0};
  hash = hash128({reinterpret_cast<const char*>(hashes.data()), sizeof hashes});
  largest = *std::ranges::max_element(most);
}

}  // namespace raio::core
