// Cones in SIMD lanes.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_SHAPE_CONE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_SHAPE_CONE_INL_H_
#undef RAIO_SHAPE_CONE_INL_H_
#else
#define RAIO_SHAPE_CONE_INL_H_
#endif

#include "shape/cone.h"
#include "shape/first_hits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

// The first hits in front of the rays with cones. shape/cone.h explains; the order of operations is
// its.
template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const ConeNumbers<V>& c, const V* origin, const V* dir) {
  const auto dot3 = [&](const V* x, const V* y) {
    return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]);
  };
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5);
  V from_base[3], from_middle[3], o[3], o_across[3], d_across[3];
  for (int a = 0; a < 3; ++a) {
    from_base[a] = hn::Sub(origin[a], c.base[a]);
    from_middle[a] = hn::Sub(from_base[a], hn::Mul(c.axis[a], hn::Mul(half, c.height)));
  }
  const V shift = hn::Div(hn::Neg(dot3(from_middle, dir)), dot3(dir, dir));
  for (int a = 0; a < 3; ++a) o[a] = hn::Add(from_base[a], hn::Mul(dir[a], shift));
  const V oz = dot3(o, c.axis), dz = dot3(dir, c.axis);
  for (int a = 0; a < 3; ++a) {
    o_across[a] = hn::Sub(o[a], hn::Mul(c.axis[a], oz));
    d_across[a] = hn::Sub(dir[a], hn::Mul(c.axis[a], dz));
  }
  const V o_r = hn::Add(c.base_radius, hn::Mul(c.slope, oz)), d_r = hn::Mul(c.slope, dz);
  const V qa = hn::Sub(dot3(d_across, d_across), hn::Mul(d_r, d_r));
  const V qb = hn::Sub(dot3(o_across, d_across), hn::Mul(o_r, d_r));
  const V qc = hn::Sub(dot3(o_across, o_across), hn::Mul(o_r, o_r));
  const V disc = hn::Sub(hn::Mul(qb, qb), hn::Mul(qa, qc));
  const hn::Mask<D> parallel = hn::Eq(qa, zero);
  const hn::Mask<D> real = hn::Or(hn::Ge(disc, zero), parallel);
  if (hn::AllFalse(d, real)) {
    const typename FirstHits<D>::Floats f;
    return {hn::Ne(hn::Zero(f), hn::Zero(f)), hn::Zero(f)};
  }
  const V root = hn::Sqrt(hn::Max(disc, zero));
  const V big =
      hn::IfThenElse(hn::Ge(qb, zero), hn::Sub(hn::Neg(qb), root), hn::Add(hn::Neg(qb), root));
  V s0 = hn::Div(big, qa);
  V s1 = hn::IfThenElse(hn::Ne(big, zero), hn::Div(qc, big), s0);
  const hn::Mask<D> swap = hn::Gt(s0, s1);
  const V first = hn::IfThenElse(swap, s1, s0);
  s1 = hn::IfThenElse(swap, s0, s1);
  s0 = hn::IfThenElse(parallel, hn::Div(hn::Mul(hn::Set(d, -0.5), qc), qb), first);
  const auto on_surface = [&](V s) {
    const V z = hn::Add(oz, hn::Mul(s, dz));
    const hn::Mask<D> within = hn::And(hn::Ge(z, zero), hn::Le(z, c.height));
    return hn::AndNot(hn::Lt(hn::Add(c.base_radius, hn::Mul(c.slope, z)), zero), within);
  };
  const hn::Mask<D> in0 =
      hn::And(hn::And(on_surface(s0), real), hn::Or(hn::Not(parallel), hn::Ne(qb, zero)));
  const hn::Mask<D> in1 = hn::And(hn::And(on_surface(s1), real), hn::Not(parallel));
  return first_of(d, in0, hn::Add(s0, shift), in1, hn::Add(s1, shift));
}

// Cones i, i + 1, ... of the columns whose axes the line of a ray passes further away than their
// largest radius: |(o - base) . (d x axis)| / |d x axis|, but for rounding, here and in the test in
// double, which goes by the square of the height. `slack`: that rounding, in parts of the numbers.
template <class F, size_t n>
HWY_INLINE hn::Mask<F> passes_by(F f, const ConeNumbers<float[n]>& c, int i, const float* origin,
                                 const float* dir, float slack) {
  using V = hn::Vec<F>;
  V o[3], d[3], axis[3];
  for (int a = 0; a < 3; ++a) {
    o[a] = hn::Sub(hn::Set(f, origin[a]), hn::Load(f, c.base[a] + i));
    d[a] = hn::Set(f, dir[a]), axis[a] = hn::Load(f, c.axis[a] + i);
  }
  const V x = hn::Sub(hn::Mul(d[1], axis[2]), hn::Mul(d[2], axis[1]));
  const V y = hn::Sub(hn::Mul(d[2], axis[0]), hn::Mul(d[0], axis[2]));
  const V z = hn::Sub(hn::Mul(d[0], axis[1]), hn::Mul(d[1], axis[0]));
  const V height = hn::Load(f, c.height + i);
  const V size = hn::Add(hn::Add(hn::Abs(o[0]), hn::Abs(o[1])), hn::Add(hn::Abs(o[2]), height));
  const V rounding = hn::Mul(size, hn::Set(f, slack));
  const V apart = hn::Sub(hn::Abs(dot(f, x, y, z, o[0], o[1], o[2])), rounding);
  const V base = hn::Load(f, c.base_radius + i);
  const V apex = hn::MulAdd(hn::Load(f, c.slope + i), height, base);
  const V reach = hn::Mul(hn::Max(base, apex), hn::Set(f, 1 + slack));
  const V across = hn::Sqrt(dot(f, x, y, z, x, y, z));
  return hn::Gt(apart, hn::Mul(reach, across));
}

// Who has no such function is tested whenever its box is met: that shall not happen to cones.
static_assert(requires(ConeNumbers<float[8]> c, const float* ray) {
  passes_by(hn::CappedTag<float, 8>(), c, 0, ray, ray, 0.0f);
});

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
