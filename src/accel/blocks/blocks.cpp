#include "accel/blocks/blocks.h"

namespace raio::core {
namespace {

using Ids = std::span<const PrimitiveId>;

void fill_block(const Geometry& g, Ids ids, SphereBlock& block) {
  for (size_t i = 0; i < size_t(kBlockWidth); ++i) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const Sphere s = i < ids.size() ? g.sphere(g.index_of(PrimitiveKind::sphere, ids[i]))
                                    : Sphere{{0, 0, 0}, kNone};
    block.x[i] = s.center.x, block.y[i] = s.center.y, block.z[i] = s.center.z;
    block.radius[i] = s.radius;
  }
}

void fill_block(const Geometry& g, Ids ids, TriangleBlock& block) {
  for (size_t i = 0; i < size_t(kBlockWidth); ++i) {  // three equal vertices have no area
    const Triangle t = i < ids.size() ? g.triangle(g.index_of(PrimitiveKind::triangle, ids[i]))
                                      : Triangle{{}, {}, {}};
    for (int a = 0; a < 3; ++a) {
      block.corner[0][a][i] = t.a[a];
      block.corner[1][a][i] = t.b[a];
      block.corner[2][a][i] = t.c[a];
    }
  }
}

template <PrimitiveKind kind>
void fill_block(const Geometry& g, Ids ids, Block<kind>& block) {
  block = {};
  block.boxes.set_empty();
  for (size_t i = 0; i < ids.size(); ++i) {
    const auto& baked = g.get<kind>(g.index_of(kind, ids[i]));
    block.boxes.set(i, bounds(baked));
    const auto numbers = numbers_of(baked);
    // From the same template, so columns and numbers have the same order.
    constexpr size_t kColumns = sizeof numbers / sizeof(float);
    static_assert(sizeof block.numbers == kColumns * sizeof(float[kBlockWidth]));
    const auto* const from = reinterpret_cast<const float*>(&numbers);
    auto* const to = reinterpret_cast<float*>(&block.numbers);
    for (size_t c = 0; c < kColumns; ++c) to[c * kBlockWidth + i] = from[c];
  }
}

}  // namespace

// clang-tidy does not see uses of members in lambdas with template parameters.
// NOLINTBEGIN(readability-convert-member-functions-to-static)
const PrimitiveId* Blocks::primitives(uint32_t ref) const {
  return with_kind(PrimitiveKind(ref_pool(ref)), [&]<PrimitiveKind kind>() -> const PrimitiveId* {
    if constexpr (kIsBounded<kind>)
      return of<kind>()[ref_index(ref)].primitive;
    else
      return nullptr;
  });
}

void Blocks::fill(const Geometry& geometry, uint32_t ref, Ids ids) {
  with_kind(PrimitiveKind(ref_pool(ref)), [&]<PrimitiveKind kind> {
    if constexpr (kIsBounded<kind>) {
      auto& block = of<kind>()[ref_index(ref)];
      fill_block(geometry, ids, block);
      for (size_t i = 0; i < size_t(kBlockWidth); ++i)
        block.primitive[i] = i < ids.size() ? ids[i] : kNoPrimitive;
    }
  });
}

double Blocks::bytes_of(const std::array<uint32_t, kPools>& counts) {
  double sum = 0;
  for_each_bounded_kind([&]<PrimitiveKind kind> {
    sum += double(counts[size_t(pool_of(kind))]) * sizeof(Block<kind>);
  });
  return sum;
}

void Blocks::resize(const std::array<uint32_t, kPools>& counts) {
  for_each_bounded_kind(
      [&]<PrimitiveKind kind> { of<kind>().resize(counts[size_t(pool_of(kind))]); });
}

size_t Blocks::count() const {
  size_t sum = 0;
  for_each_bounded_kind([&]<PrimitiveKind kind> { sum += of<kind>().size(); });
  return sum;
}

size_t Blocks::bytes() const {
  size_t sum = 0;
  for_each_bounded_kind(
      [&]<PrimitiveKind kind> { sum += of<kind>().size() * sizeof(Block<kind>); });
  return sum;
}
// NOLINTEND(readability-convert-member-functions-to-static)

}  // namespace raio::core
