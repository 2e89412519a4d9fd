// Triangles in SIMD lanes; shape/triangle.h explains.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_SHAPE_TRIANGLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_SHAPE_TRIANGLE_INL_H_
#undef RAIO_SHAPE_TRIANGLE_INL_H_
#else
#define RAIO_SHAPE_TRIANGLE_INL_H_
#endif

#include "shape/first_hits-inl.h"
#include "shape/triangle.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

// Distances and weights of the triangles with sheared corners (x, y, z), all still to be divided by
// `det`, and which of them the lines of the rays hit.
template <class D>
struct TriangleLanes {
  hn::Mask<D> in;
  hn::Vec<D> det, t, u, v;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE TriangleLanes<D> edge_test(D d, const V* x, const V* y, const V* z) {
  const V zero = hn::Zero(d);
  const V u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
  const V v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
  const V w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
  const V smallest = hn::Min(hn::Min(u, v), w), largest = hn::Max(hn::Max(u, v), w);
  const V det = hn::Add(hn::Add(u, v), w);
  const V t = hn::Add(hn::Add(hn::Mul(u, z[0]), hn::Mul(v, z[1])), hn::Mul(w, z[2]));
  const auto both = hn::And(hn::Lt(smallest, zero), hn::Gt(largest, zero));
  return {hn::AndNot(both, hn::Ne(det, zero)), det, t, v, w};
}
// And which of them are passed near enough, for those seen edge-on.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> within_reach(D d, const V* x, const V* y) {
  const V x0 = hn::Min(hn::Min(x[0], x[1]), x[2]), x1 = hn::Max(hn::Max(x[0], x[1]), x[2]);
  const V y0 = hn::Min(hn::Min(y[0], y[1]), y[2]), y1 = hn::Max(hn::Max(y[0], y[1]), y[2]);
  const V reach = hn::Max(hn::Max(hn::Neg(x0), x1), hn::Max(hn::Neg(y0), y1));
  const V away = hn::Max(hn::Max(x0, hn::Neg(x1)), hn::Max(y0, hn::Neg(y1)));
  return hn::Le(away, hn::Mul(hn::Set(d, kEdgeSlack), reach));
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
