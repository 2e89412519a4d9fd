#include "accel/blocks/blocks.h"

namespace raio {
namespace {

using Items = std::span<const PrimitiveId>;

template <class Block>
void set_items(Items items, Block& block) {
  for (size_t i = 0; i < size_t(kBlockWidth); ++i)
    block.item[i] = i < items.size() ? items[i] : kNoPrimitive;
}

void fill_block(const Geometry& g, Items items, SphereBlock& block) {
  set_items(items, block);
  for (size_t i = 0; i < size_t(kBlockWidth); ++i) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const Sphere s =
        i < items.size() ? g.sphere(primitive_index(items[i])) : Sphere{{0, 0, 0}, kNone};
    block.x[i] = s.center.x, block.y[i] = s.center.y, block.z[i] = s.center.z;
    block.radius[i] = s.radius;
  }
}

void fill_block(const Geometry& g, Items items, TriangleBlock& block) {
  set_items(items, block);
  for (size_t i = 0; i < size_t(kBlockWidth); ++i) {  // three equal corners have no area
    const Triangle t =
        i < items.size() ? g.triangle(primitive_index(items[i])) : Triangle{{}, {}, {}};
    for (int a = 0; a < 3; ++a) {
      block.corner[0][a][i] = t.a[a];
      block.corner[1][a][i] = t.b[a];
      block.corner[2][a][i] = t.c[a];
    }
  }
}

void fill_block(const Geometry& g, Items items, ConeBlock& block) {
  block = {};
  set_items(items, block);
  block.boxes.set_empty();
  for (size_t i = 0; i < items.size(); ++i) {
    const BakedCone& c = g.cone(primitive_index(items[i]));
    block.boxes.set(i, bounds(c));
    for (int a = 0; a < 3; ++a) block.base[a][i] = c.base[a], block.axis[a][i] = c.axis[a];
    block.height[i] = c.height, block.radius[i] = c.base_radius, block.slope[i] = c.slope;
  }
}

}  // namespace

const PrimitiveId* Blocks::items(uint32_t ref) const {
  const uint32_t i = ref_index(ref);
  return ref_pool(ref) == Pool::spheres     ? spheres[i].item
         : ref_pool(ref) == Pool::triangles ? triangles[i].item
                                            : cones[i].item;
}

void Blocks::fill(const Geometry& geometry, uint32_t ref, std::span<const PrimitiveId> items) {
  const uint32_t i = ref_index(ref);
  switch (ref_pool(ref)) {
    case Pool::spheres:
      return fill_block(geometry, items, spheres[i]);
    case Pool::triangles:
      return fill_block(geometry, items, triangles[i]);
    case Pool::cones:
      return fill_block(geometry, items, cones[i]);
    case Pool::nodes:
      break;
  }
}

}  // namespace raio
