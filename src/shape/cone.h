// Cones, frusta and cylinders: one shape, the lateral surface between two circles, without caps.
#ifndef RAIO_SHAPE_CONE_H_
#define RAIO_SHAPE_CONE_H_

#include <optional>

#include "base/box.h"
#include "base/exact_math.h"
#include "base/ray.h"
#include "shape/kinds.h"
#include "shape/overlap.h"

namespace raio::core {

/// A cylinder has two equal radii. As in NFF, only the inside is visible if the radii are negative.
struct Cone {
  Vec3f base;
  float base_radius = 0;
  Vec3f apex;
  float apex_radius = 0;

  constexpr bool is_cylinder() const { return base_radius == apex_radius; }
};

constexpr ShapeKind shape_kind(const Cone& c) {
  return c.is_cylinder() ? ShapeKind::cylinder : ShapeKind::cone;
}
inline bool only_inside_seen(const Cone& c) { return c.base_radius < 0 || c.apex_radius < 0; }

/// Calls must(sound, "what is expected") for each condition.
template <class Must>
void check_shape(const Cone& c, Must&& must) {
  const double base = c.base_radius, apex = c.apex_radius;
  must(is_finite(c.base) && is_finite(c.apex), "base and apex must be finite");
  must(!(c.base == c.apex), "base and apex are the same point");
  must(std::isfinite(base) && std::isfinite(apex) && (base != 0 || apex != 0),
       "the radii must be finite and not both zero");
  must(!(base * apex < 0), "one radius is negative and the other is not");
}

/// A cone prepared for intersection when a scene is baked. At height z above the base (0 <= z <=
/// height) the radius is base_radius + slope * z.
struct BakedCone {
  Vec3f base, axis;  // axis: unit, from base to apex
  float height = 0, base_radius = 0, slope = 0;

  BakedCone() = default;
  explicit BakedCone(const Cone& c) {
    const Vec3d along = Vec3d(c.apex) - Vec3d(c.base);
    const double h = length(along);
    base = c.base;
    axis = Vec3f(along / h);
    height = float(h);
    base_radius = std::abs(c.base_radius);
    slope = float((std::abs(double(c.apex_radius)) - std::abs(double(c.base_radius))) / h);
  }
};

inline BakedCone bake(const Cone& c) { return BakedCone(c); }

/// The same members as plain numbers: of one cone, or each a column for many.
template <class T>
struct ConeNumbers {
  T base[3], axis[3], height, base_radius, slope;
};
inline ConeNumbers<float> numbers_of(const BakedCone& c) {
  return {{c.base.x, c.base.y, c.base.z},
          {c.axis.x, c.axis.y, c.axis.z},
          c.height,
          c.base_radius,
          c.slope};
}

/// Bounds of the baked surface, which rays hit; baking moves it by some ulps.
inline Box3f bounds(const BakedCone& c) {
  const Vec3d base(c.base), axis = normalize(Vec3d(c.axis));
  // A circle with normal n extends r * sqrt(1 - n_x^2) along x; this form avoids cancellation.
  const Vec3d reach(exact_hypot(axis.y, axis.z), exact_hypot(axis.z, axis.x),
                    exact_hypot(axis.x, axis.y));
  Box3d box;
  for (const double z : {0.0, double(c.height)}) {
    const Vec3d center = base + axis * z, extent = reach * (c.base_radius + c.slope * z);
    box.extend(center - extent);
    box.extend(center + extent);
  }
  return rounded_out(box);
}

inline Box3f bounds(const Cone& c) { return bounds(BakedCone(c)); }

/// Up to two hits by distance; `cosine` has the sign of dot(outward normal, ray direction).
struct ConeRoots {
  int count = 0;
  float t[2] = {};
  float cosine[2] = {};
};

/// Solves |x|^2 - z^2 = (r + k z)^2 along the ray, with the origin moved to the ray's point nearest
/// to the middle of the axis. In double: for a thin, distant cone, cancellation grows with the
/// square of distance over radius, too much for a float.
inline ConeRoots cone_roots(const BakedCone& c, const Ray& ray) {
  const Vec3d d(ray.dir), axis(c.axis);
  const double r = c.base_radius, k = c.slope, h = c.height;
  const Vec3d from_base = Vec3d(ray.origin) - Vec3d(c.base);
  const double shift = -dot(from_base - axis * (0.5 * h), d) / dot(d, d);
  const Vec3d o = from_base + d * shift;
  const double oz = dot(o, axis), dz = dot(d, axis);
  // Components perpendicular to the axis, by subtracting vectors, not large squares.
  const Vec3d o_across = o - axis * oz, d_across = d - axis * dz;
  const double o_r = r + k * oz, d_r = k * dz;
  const double a = dot(d_across, d_across) - d_r * d_r;
  const double b = dot(o_across, d_across) - o_r * d_r;
  const double q = dot(o_across, o_across) - o_r * o_r;
  ConeRoots out;
  const auto add = [&](double s) {
    const double z = oz + s * dz;
    if (!(z >= 0 && z <= h) || r + k * z < 0) return;
    const double slope_term = (r + k * z) * k;
    const double cosine = dot(o_across + d_across * s, d) - slope_term * dz;
    out.t[out.count] = float(s + shift);
    out.cosine[out.count++] = float(cosine);
  };
  if (a == 0) {  // parallel to the slope: one root
    if (b != 0) add(-0.5 * q / b);
    return out;
  }
  const double disc = b * b - a * q;
  if (!(disc >= 0)) return out;
  // The root of larger magnitude first, the other from the product, without cancellation.
  const double big = b >= 0 ? -b - std::sqrt(disc) : -b + std::sqrt(disc);
  double s0 = big / a, s1 = big != 0 ? q / big : s0;
  if (s0 > s1) std::swap(s0, s1);
  add(s0);
  if (s1 != s0) add(s1);
  return out;
}

inline std::optional<ShapeHit> first_hit(const BakedCone& c, const Ray& ray, Sides sides) {
  const ConeRoots roots = cone_roots(c, ray);
  for (int k = 0; k < roots.count; ++k)
    if (roots.t[k] > 0 && visible(sides, roots.cosine[k])) return ShapeHit{roots.t[k]};
  return std::nullopt;
}

/// The outward unit normal at `p`, a point on the surface.
inline Vec3f cone_normal(const BakedCone& c, Vec3f p) {
  const Vec3d axis(c.axis), x = Vec3d(p) - Vec3d(c.base);
  const double z = dot(x, axis);
  const Vec3d across = x - axis * z;
  const double rho = length(across);
  // On the axis is the tip, which has no normal; any direction across the axis will do.
  const Vec3d out = rho > 0 ? across / rho : Frame<double>(axis).u;
  return Vec3f(normalize(out - axis * double(c.slope)));
}

inline SurfacePoint surface_point(const BakedCone& c, Vec3f p) {
  const Vec3f normal = cone_normal(c, p);
  const Vec3d axis(c.axis), x = Vec3d(p) - Vec3d(c.base);
  const double z = dot(x, axis), rho = length(x - axis * z);
  // Along the surface normal: the radial error times the cosine of the slope.
  const double error = rho - (c.base_radius + c.slope * z);
  p = Vec3f(Vec3d(p) - Vec3d(normal) * (error / std::sqrt(1 + double(c.slope) * c.slope)));
  const float extent = c.height + std::max(c.base_radius, c.base_radius + c.slope * c.height);
  return {p, normal, extent};
}

/// The exact distance of a point to the surface, in the half plane of axis and point.
inline double cone_distance(const BakedCone& c, Vec3d p) {
  const Vec3d axis(c.axis), x = p - Vec3d(c.base);
  const double z = dot(x, axis), rho = length(x - axis * z);
  const double h = c.height, dr = double(c.slope) * h;
  const double along = ((rho - c.base_radius) * dr + z * h) / (dr * dr + h * h);
  const double s = std::clamp(along, 0.0, 1.0);
  return exact_hypot(rho - (c.base_radius + s * dr), z - s * h);
}

/// Whether the surface may touch the box; "no" is always right.
inline bool overlaps(const BakedCone& c, const Box3d& box) {
  return may_touch(box, [&](const Box3d& part) {
    const Vec3d center = part.center();
    // The axis has unit length only to float precision, and so have distances along it.
    const double slack =
        std::numeric_limits<float>::epsilon() * (length(center - Vec3d(c.base)) + c.height);
    return cone_distance(c, center) > 0.5 * length(part.size()) + slack;
  });
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_CONE_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// The first hits of rays and cones in front of the origins; same order of operations as
// first_hit(), which explains them.
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

// Marks cones i, i + 1, ... that the line of a ray passes further from the axis than their largest
// radius: |(o - base) . (d x axis)| / |d x axis|. `slack` is the relative rounding error, here and
// in the double test, which depends on the square of the height.
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

// Kinds without this function are tested at every box hit; cones must have it.
static_assert(requires(ConeNumbers<float[8]> c, const float* ray) {
  passes_by(hn::CappedTag<float, 8>(), c, 0, ray, ray, 0.0f);
});

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
