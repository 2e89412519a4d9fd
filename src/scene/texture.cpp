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

// Bilinear between the four nearest texels, whose values are value(texel).
template <class F>
auto interpolated(const Scene& scene, uint32_t texture, Uv at, const F& value) {
  const Texture& t = scene.textures[texture];
  const Between u = between_texels(at[0], t.width, t.wrap_u);
  const Between v = between_texels(1 - at[1], t.height, t.wrap_v);  // rows go down
  const uint32_t* const texels = scene.texels.data() + t.first;
  const auto of = [&](size_t column, size_t row) { return value(texels[row * t.width + column]); };
  const auto mix = [](auto a, auto b, float part) { return a + (b - a) * part; };
  return mix(mix(of(u.first, v.first), of(u.second, v.first), u.part),
             mix(of(u.first, v.second), of(u.second, v.second), u.part), v.part);
}

}  // namespace

Rgb texture_color(const Scene& scene, uint32_t texture, Uv at) {
  const std::array<float, 256>& linear = linear_from_srgb_bytes();
  return interpolated(scene, texture, at, [&](uint32_t texel) {
    return Rgb(linear[texel & 255], linear[texel >> 8 & 255], linear[texel >> 16 & 255]);
  });
}

Rgb texture_value(const Scene& scene, uint32_t texture, Uv at) {
  return interpolated(scene, texture, at, [](uint32_t texel) {
    return Rgb(float(texel & 255), float(texel >> 8 & 255), float(texel >> 16 & 255)) / 255;
  });
}

float texture_alpha(const Scene& scene, uint32_t texture, Uv at) {
  return interpolated(scene, texture, at,
                      [](uint32_t texel) { return float(255 - (texel >> 24)) / 255; });
}

float cutout_alpha(const Scene& scene, MaterialId id, Uv at) {
  const StandardSurface& surface = scene.standard_surfaces[id];
  const uint32_t texture = scene.texture_of(id);
  const float alpha = texture == kNoTexture ? 1 : texture_alpha(scene, texture, at);
  if (surface.alpha_mode != AlphaMode::mask) return alpha;
  return alpha >= surface.alpha_cutoff ? 1 : 0;
}

}  // namespace raio::core
