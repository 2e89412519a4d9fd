// Samples a sky (scene/cube_map.h) in any direction, in SIMD. Pure IEEE 754 arithmetic, so a
// direction gets the same light in every lane. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_INTEGRATE_SKY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_SKY_INL_H_
#undef RAIO_INTEGRATE_SKY_INL_H_
#else
#define RAIO_INTEGRATE_SKY_INL_H_
#endif

#include "integrate/tile-inl.h"
#include "scene/cube_map.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// cube_place() for all lanes: a direction's column and row on its face, in texels from the centre
// of the first border texel, and the face's number.
struct WideCubePlace {
  V column, row;
  U face;
};
HWY_INLINE WideCubePlace wide_cube_place(const V3& dir, int side) {
  const V x = hn::Abs(dir.x), y = hn::Abs(dir.y), z = hn::Abs(dir.z), zero = hn::Zero(d);
  const M on_x = hn::And(hn::Ge(x, y), hn::Ge(x, z));
  const M on_y = hn::AndNot(on_x, hn::Ge(y, z));
  const V main = hn::IfThenElse(on_x, dir.x, hn::IfThenElse(on_y, dir.y, dir.z));
  const M ahead = hn::Gt(hn::IfThenElse(on_x, hn::Neg(main), main), zero);  // right is -x
  // s: -z and z on x, -x on y, -x and x on z; t: y on x and z, -z and z on y.
  const V across = hn::IfThenElse(on_x, dir.z, dir.x);
  const V s = hn::IfThenElse(hn::Or(ahead, on_y), hn::Neg(across), across);
  const V t = hn::IfThenElse(on_y, hn::IfThenElse(ahead, hn::Neg(dir.z), dir.z), dir.y);
  const V one = hn::Set(d, 1), by = hn::Abs(main);
  // To texels: centres are whole numbers, and the border texel comes first.
  const V half = hn::Set(d, float(side) / 2), first = hn::Set(d, 0.5f);
  const auto number = [](M mask, uint32_t n) HWY_ATTR {
    return hn::IfThenElseZero(hn::RebindMask(du, mask), hn::Set(du, n));
  };
  const U axis =
      hn::IfThenElse(hn::RebindMask(du, on_x), hn::Zero(du),
                     hn::IfThenElse(hn::RebindMask(du, on_y), hn::Set(du, 2), hn::Set(du, 4)));
  return {hn::Add(hn::Mul(hn::Add(hn::Div(s, by), one), half), first),
          hn::Add(hn::Mul(hn::Sub(one, hn::Div(t, by)), half), first),
          hn::Add(axis, number(hn::Not(ahead), 1))};
}

// Bilinear between the four nearest texels. For any direction, even NaN, it reads texels of the
// map.
HWY_INLINE V3 sky_towards(const CubeMap& sky, const V3& dir) {
  using DI = Signed<D>;
  const DI di;
  const WideCubePlace place = wide_cube_place(dir, sky.side);
  const V most = hn::Set(d, float(sky.side));  // + 1 is the last
  const auto texel = [&](V along) HWY_ATTR {
    const V number = hn::IfThenElseZero(hn::Eq(along, along), along);
    return hn::ConvertTo(di, hn::Min(hn::Max(number, hn::Zero(d)), most));
  };
  const auto column = texel(place.column), row = texel(place.row);
  const V right = hn::Sub(place.column, hn::ConvertTo(d, column));
  const V down = hn::Sub(place.row, hn::ConvertTo(d, row));
  const auto stride = hn::Set(di, int(sky.stride()));
  const auto first =
      hn::Add(hn::Mul(hn::Add(hn::Mul(hn::BitCast(di, place.face), stride), row), stride), column);
  const uint32_t* const texels = sky.texels.data();
  const U a = hn::GatherIndex(du, texels, first);
  const U b = hn::GatherIndex(du, texels + 1, first);
  const U below_a = hn::GatherIndex(du, texels + sky.stride(), first);
  const U below_b = hn::GatherIndex(du, texels + sky.stride() + 1, first);
  const auto between = [&](auto shift) HWY_ATTR {
    const auto value = [&](U packed) HWY_ATTR {
      const U byte = hn::And(hn::ShiftRight<shift()>(packed), hn::Set(du, 255));
      return hn::ConvertTo(d, hn::BitCast(di, byte));
    };
    const auto mix = [](V from, V to, V part)
                         HWY_ATTR { return hn::Add(from, hn::Mul(hn::Sub(to, from), part)); };
    const V above = mix(value(a), value(b), right),
            below = mix(value(below_a), value(below_b), right);
    return hn::Div(mix(above, below, down), hn::Set(d, 255));
  };
  return {between(std::integral_constant<int, 0>()), between(std::integral_constant<int, 8>()),
          between(std::integral_constant<int, 16>())};
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
