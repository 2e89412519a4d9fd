#include "scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/srgb.h"

namespace raio::core {
namespace {

// Two neighbouring texels and the position between them.
struct Between {
  size_t first = 0, second = 0;
  float part = 0;
};

// `x`: the coordinate, from 0 to 1 along the side.
Between between_texels(float x, uint32_t side, TextureWrap wrap) {
  if (!std::isfinite(x)) x = 0;
  switch (wrap) {
    case TextureWrap::repeat:
      x -= std::floor(x);
      break;
    case TextureWrap::clamp:
      x = std::min(std::max(x, 0.0f), 1.0f);
      break;
    case TextureWrap::mirror:
      x -= 2 * std::floor(x / 2);
      if (x > 1) x = 2 - x;
      break;
  }
  // Texel centres are whole numbers; -0.5 to side - 0.5.
  const float along = x * float(side) - 0.5f, whole = std::floor(along);
  const auto texel = [&](int i) {
    if (i >= 0 && i < int(side)) return size_t(i);
    const bool below = i < 0;
    return wrap == TextureWrap::repeat ? (below ? side - 1 : 0) : (below ? 0 : size_t(side) - 1);
  };
  return {texel(int(whole)), texel(int(whole) + 1), along - whole};
}

}  // namespace

Rgb texture_color(const Scene& scene, uint32_t texture, Uv at) {
  const Texture& t = scene.textures[texture];
  const Between u = between_texels(at[0], t.width, t.wrap_u);
  const Between v = between_texels(1 - at[1], t.height, t.wrap_v);  // rows go down
  const std::array<float, 256>& linear = linear_from_srgb_bytes();
  const uint32_t* const texels = scene.texels.data() + t.first;
  const auto color = [&](size_t column, size_t row) {
    const uint32_t texel = texels[row * t.width + column];
    return Rgb(linear[texel & 255], linear[texel >> 8 & 255], linear[texel >> 16 & 255]);
  };
  const auto mix = [](Rgb a, Rgb b, float part) { return a + (b - a) * part; };
  return mix(mix(color(u.first, v.first), color(u.second, v.first), u.part),
             mix(color(u.first, v.second), color(u.second, v.second), u.part), v.part);
}

}  // namespace raio::core
