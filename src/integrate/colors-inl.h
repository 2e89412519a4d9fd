// Colours of primitives that override their materials'. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_INTEGRATE_COLORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_COLORS_INL_H_
#undef RAIO_INTEGRATE_COLORS_INL_H_
#else
#define RAIO_INTEGRATE_COLORS_INL_H_
#endif

#include <optional>

#include "integrate/tile-inl.h"
#include "scene/texture.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Hits, with each primitive's kind and its index in the pool. Lanes after the last hit may hold
// stale values of an earlier batch.
struct HitColumns {
  const HitBatch& hits;
  const uint32_t *kind, *index;

  // The triangle that ray i hits, if any.
  std::optional<uint32_t> triangle(const Geometry& geometry, size_t i) const {
    constexpr auto kTriangle = PrimitiveKind::triangle;
    if (PrimitiveKind(kind[i]) != kTriangle || index[i] >= geometry.count(kTriangle)) return {};
    return index[i];
  }
};

// Gathers the colours of the primitives hit by rays i, i + 1, ... into the lanes of `color`. Called
// for scenes with such colours.
inline void gather_colors(const Geometry& geometry, const HitColumns& hit, size_t i,
                          Floats3& color) {
  for (size_t k = i; k < i + kWidth; ++k) {
    const StridedArray<Rgb>& colors = geometry.colors(PrimitiveKind(hit.kind[k]));
    if (hit.index[k] < colors.size()) color.set(k, colors[hit.index[k]]);
  }
}

// Multiplies by the vertex colours of triangles.
inline void tint_by_vertices(const Geometry& geometry, const HitColumns& hit, size_t i,
                             Floats3& color) {
  const std::span<const Rgb> tints = geometry.vertex_colors();
  for (size_t k = i; k < i + kWidth; ++k) {
    const std::optional<uint32_t> triangle = hit.triangle(geometry, k);
    if (!triangle) continue;
    const TriangleIndices& at = geometry.corners(*triangle);
    const float u = hit.hits.u[k], v = hit.hits.v[k];
    const Rgb tint = tints[at[0]] * (1 - u - v) + tints[at[1]] * u + tints[at[2]] * v;
    color.x.at[k] *= std::max(tint.x, 0.0f), color.y.at[k] *= std::max(tint.y, 0.0f);
    color.z.at[k] *= std::max(tint.z, 0.0f);
  }
}

// Of the point of a triangle with barycentric weights b1 and b2; (0, 0) without coordinates.
inline Uv texture_coordinates(const Geometry& geometry, uint32_t triangle, float b1, float b2) {
  const std::span<const Uv> uv = geometry.texture_coordinates();
  if (uv.empty()) return {};
  const TriangleIndices& at = geometry.corners(triangle);
  const float b0 = 1 - b1 - b2;
  const auto along = [&](size_t axis) {
    return uv[at[0]][axis] * b0 + uv[at[1]][axis] * b1 + uv[at[2]][axis] * b2;
  };
  return {along(0), along(1)};
}

// Multiplies by textures. Their sizes may differ from lane to lane, so they are looked up one by
// one.
inline void tint_by_textures(const Geometry& geometry, const Scene& scene, const HitColumns& hit,
                             size_t i, const MaterialId* materials, Floats3& color) {
  for (size_t k = i; k < i + kWidth; ++k) {
    const std::optional<uint32_t> triangle = hit.triangle(geometry, k);
    if (!triangle) continue;
    const uint32_t texture = scene.material_texture[materials[k]];
    if (texture == kNoTexture) continue;
    const Uv at = texture_coordinates(geometry, *triangle, hit.hits.u[k], hit.hits.v[k]);
    const Rgb tint = texture_color(scene, texture, at);
    color.x.at[k] *= tint.x, color.y.at[k] *= tint.y, color.z.at[k] *= tint.z;
  }
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
