// SIMD arithmetic (Highway), with the few transcendental functions and random numbers of the hot
// path. Include it in files compiled once per instruction set. Everything consists of +, -, *, /
// and square roots, which IEEE 754 defines exactly, so all machines compute the same bits; the
// system's functions do not. foreach_target.h includes this file once per instruction set.
#if defined(RAIO_BASE_WIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_BASE_WIDE_INL_H_
#undef RAIO_BASE_WIDE_INL_H_
#else
#define RAIO_BASE_WIDE_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include "base/vec.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Tags of unsigned or signed 32-bit lanes, as many as a tag of floats has.
template <class D>
using Unsigned = hn::RebindToUnsigned<D>;
template <class D>
using Signed = hn::RebindToSigned<D>;

template <class D>
struct Wide3 {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Wide3<D> set3(D d, Vec3f v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
template <class D>
HWY_INLINE Wide3<D> operator+(const Wide3<D>& a, const Wide3<D>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class D>
HWY_INLINE Wide3<D> operator-(const Wide3<D>& a, const Wide3<D>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class D>
HWY_INLINE Wide3<D> operator-(const Wide3<D>& a) {
  return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
template <class D>
HWY_INLINE Wide3<D> operator*(const Wide3<D>& a, const Wide3<D>& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
template <class D>
HWY_INLINE Wide3<D> operator*(const Wide3<D>& a, hn::Vec<D> s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <class D>
HWY_INLINE hn::Vec<D> dot(const Wide3<D>& a, const Wide3<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class D>
HWY_INLINE hn::Vec<D> length(const Wide3<D>& a) {
  return hn::Sqrt(dot(a, a));
}
/// The largest absolute component.
template <class D>
HWY_INLINE hn::Vec<D> largest(const Wide3<D>& a) {
  return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
template <class D>
HWY_INLINE Wide3<D> normalize(D d, const Wide3<D>& a) {
  return a * hn::Div(hn::Set(d, 1), length(a));
}
/// As in base/vec.h: for vectors of unit length except for rounding.
template <class D>
HWY_INLINE Wide3<D> renormalize(D d, const Wide3<D>& a) {
  return a * hn::Sub(hn::Set(d, 1.5f), hn::Mul(hn::Set(d, 0.5f), dot(a, a)));
}
template <class M, class D>
HWY_INLINE Wide3<D> select(M mask, const Wide3<D>& yes, const Wide3<D>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

/// x / n, for x = 0 or x from 2^-24 to n + 1. Correctly rounded, but faster than division where
/// fused multiply-add exists: it gives the exact error of a rounded quotient, which corrects it.
/// Markstein 1990, "Computation of Elementary Functions on the IBM RISC System/6000 Processor", IBM
/// JRD 34(1). All mantissas were tried with every n computed this way; tests/wide_test.cpp repeats
/// some.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V divide(D d, V x, uint32_t n) {
  const V by = hn::Set(d, float(n));
  if (!HWY_NATIVE_FMA || n > 65536) return hn::Div(x, by);
  const V inverse = hn::Set(d, 1 / float(n)), quotient = hn::Mul(x, inverse);
  return hn::MulAdd(hn::NegMulAdd(quotient, by, x), inverse, quotient);
}

/// Horner's rule; coefficients from the highest to the lowest degree.
template <class V>
HWY_INLINE V polynomial(V, V highest) {
  return highest;
}
template <class V, class... Rest>
HWY_INLINE V polynomial(V x, V highest, V next, Rest... rest) {
  return polynomial(x, hn::Add(hn::Mul(highest, x), next), rest...);
}

/// The logarithm to base 2 of a positive normal number, by the series of atanh about
/// sqrt(1/2)..sqrt(2).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V log2_of(D d, V x) {
  const Unsigned<D> du;
  const Signed<D> di;
  const V one = hn::Set(d, 1);
  const auto bits = hn::BitCast(du, x);
  V exponent =
      hn::ConvertTo(d, hn::Sub(hn::BitCast(di, hn::ShiftRight<23>(bits)), hn::Set(di, 127)));
  V m = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(du, 0x007fffffu)), hn::Set(du, 0x3f800000u)));
  const auto upper = hn::Gt(m, hn::Set(d, float(std::numbers::sqrt2)));
  m = hn::IfThenElse(upper, hn::Mul(m, hn::Set(d, 0.5f)), m);
  exponent = hn::IfThenElse(upper, hn::Add(exponent, one), exponent);
  const V z = hn::Div(hn::Sub(m, one), hn::Add(m, one)), z2 = hn::Mul(z, z);
  const V series = polynomial(z2, hn::Set(d, 1.0f / 11), hn::Set(d, 1.0f / 9), hn::Set(d, 1.0f / 7),
                              hn::Set(d, 1.0f / 5), hn::Set(d, 1.0f / 3), one);
  return hn::Add(exponent, hn::Mul(hn::Mul(hn::Set(d, 2.88539008f), z), series));  // 2 / ln 2
}

/// x^y for 0 <= x <= 1 and y >= 0, with an absolute error below 2e-7: errors in the exponent matter
/// little where the power is small. exp2 uses the Taylor series on -1/2..1/2.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V pow_unit(D d, V x, V y) {
  const Signed<D> di;
  const V one = hn::Set(d, 1), p = hn::Mul(y, log2_of(d, x));
  // Powers below 2^-126 are zero, as are powers of zero except 0^0. Adding `shift` rounds to the
  // nearest integer; hn::Round() without SIMD rounds the largest float below 1/2 to 1.
  const V shift = hn::Set(d, 3 << 22);
  const V whole = hn::Sub(hn::Add(hn::Max(p, hn::Set(d, -126)), shift), shift);
  const V f = hn::Mul(hn::Sub(p, whole), hn::Set(d, float(std::numbers::ln2)));
  const V e = polynomial(f, hn::Set(d, 1.0f / 5040), hn::Set(d, 1.0f / 720), hn::Set(d, 1.0f / 120),
                         hn::Set(d, 1.0f / 24), hn::Set(d, 1.0f / 6), hn::Set(d, 0.5f), one, one);
  const V two_to_whole =
      hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, whole), hn::Set(di, 127))));
  const V power = hn::IfThenElseZero(hn::Ge(p, hn::Set(d, -126)), hn::Mul(e, two_to_whole));
  const auto sure = hn::Or(hn::Ge(x, one), hn::Eq(y, hn::Zero(d)));
  return hn::IfThenElse(sure, one, hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), power));
}

template <class D>
struct Wide2 {
  hn::Vec<D> x, y;
};

/// Cosine and sine of an angle of at most pi/4, as x and y, by Taylor series.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Wide2<D> cos_sin_near_0(D d, V angle) {
  const V one = hn::Set(d, 1), x2 = hn::Mul(angle, angle);
  return {polynomial(x2, hn::Set(d, 1.0f / 40320), hn::Set(d, -1.0f / 720), hn::Set(d, 1.0f / 24),
                     hn::Set(d, -0.5f), one),
          hn::Mul(angle, polynomial(x2, hn::Set(d, 1.0f / 362880), hn::Set(d, -1.0f / 5040),
                                    hn::Set(d, 1.0f / 120), hn::Set(d, -1.0f / 6), one))};
}

/// The point of the unit circle at an angle of -1 to 1 turns, by rotation to within pi/4 of an
/// axis.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Wide2<D> on_circle(D d, V turns) {
  const Signed<D> di;
  // Adding `shift` rounds to the nearest integer, as in pow_unit().
  const V shift = hn::Set(d, 3 << 22), four = hn::Set(d, 4);
  const V quarters = hn::Sub(hn::Add(hn::Mul(turns, four), shift), shift);
  const V rest = hn::Sub(turns, hn::Mul(quarters, hn::Set(d, 0.25f)));
  const Wide2<D> near = cos_sin_near_0(d, hn::Mul(rest, hn::Set(d, float(2 * std::numbers::pi))));
  const auto quadrant = hn::ConvertTo(di, quarters);
  const auto has_bit = [&](auto number, int bit) HWY_ATTR {
    return hn::RebindMask(d, hn::TestBit(number, hn::Set(di, bit)));
  };
  const auto swapped = has_bit(quadrant, 1);
  const V x = hn::IfThenElse(swapped, near.y, near.x), y = hn::IfThenElse(swapped, near.x, near.y);
  const auto on_left = has_bit(hn::Add(quadrant, hn::Set(di, 1)), 2);
  return {hn::IfThenElse(on_left, hn::Neg(x), x),
          hn::IfThenElse(has_bit(quadrant, 2), hn::Neg(y), y)};
}

/// The angle of the point (x, y) from the x axis towards the y axis, -1/2 to 1/2 turns; 0 for the
/// origin. The arctangent of at most tan(pi/8) is a Taylor series.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V turns_of(D d, V y, V x) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1);
  const V across = hn::Abs(x), up = hn::Abs(y);
  const V most = hn::Max(across, up), least = hn::Min(across, up);
  const auto diagonal = hn::Gt(least, hn::Mul(most, hn::Set(d, float(std::numbers::sqrt2 - 1))));
  const V over = hn::IfThenElse(diagonal, hn::Sub(least, most), least);
  const V under = hn::IfThenElse(diagonal, hn::Add(least, most), most);
  const V t = hn::IfThenElseZero(hn::Gt(under, zero), hn::Div(over, under)), t2 = hn::Mul(t, t);
  const V series = polynomial(t2, hn::Set(d, 1.0f / 17), hn::Set(d, -1.0f / 15),
                              hn::Set(d, 1.0f / 13), hn::Set(d, -1.0f / 11), hn::Set(d, 1.0f / 9),
                              hn::Set(d, -1.0f / 7), hn::Set(d, 0.2f), hn::Set(d, -1.0f / 3), one);
  V turns = hn::Mul(hn::Mul(t, series), hn::Set(d, float(0.5 / std::numbers::pi)));
  turns = hn::IfThenElse(diagonal, hn::Add(turns, hn::Set(d, 0.125f)), turns);
  turns = hn::IfThenElse(hn::Gt(up, across), hn::Sub(hn::Set(d, 0.25f), turns), turns);
  turns = hn::IfThenElse(hn::Lt(x, zero), hn::Sub(hn::Set(d, 0.5f), turns), turns);
  return hn::CopySign(turns, y);
}

/// Maps the unit square to the unit disc, keeping areas and neighbourhoods. Shirley and Chiu 1997,
/// "A Low Distortion Map Between Disk and Square", JGT 2(3).
template <class D, class V = hn::Vec<D>>
HWY_INLINE Wide2<D> square_to_disc(D d, V u, V v) {
  const V one = hn::Set(d, 1), two = hn::Set(d, 2);
  const V a = hn::Sub(hn::Mul(two, u), one), b = hn::Sub(hn::Mul(two, v), one);
  const auto wide = hn::Gt(hn::Abs(a), hn::Abs(b));
  const V r = hn::IfThenElse(wide, a, b), other = hn::IfThenElse(wide, b, a);
  const V ratio = hn::IfThenElse(hn::Eq(r, hn::Zero(d)), r, hn::Div(other, r));
  const Wide2<D> near = cos_sin_near_0(d, hn::Mul(hn::Set(d, float(std::numbers::pi / 4)), ratio));
  const V rc = hn::Mul(r, near.x), rs = hn::Mul(r, near.y);
  return {hn::IfThenElse(wide, rc, rs), hn::IfThenElse(wide, rs, rc)};
}

template <class DU>
struct Wide4 {
  hn::Vec<DU> x, y, z, w;
};

/// Four independent 32-bit words from a key of four: pcg4d of Jarzynski and Olano 2020, "Hash
/// Functions for GPU Rendering", JCGT 9(3).
template <class DU>
HWY_INLINE Wide4<DU> hash4(DU du, Wide4<DU> v) {
  const auto times = hn::Set(du, 1664525u), plus = hn::Set(du, 1013904223u);
  for (auto* word : {&v.x, &v.y, &v.z, &v.w}) *word = hn::Add(hn::Mul(*word, times), plus);
  const auto mix = [&]() HWY_ATTR __attribute__((always_inline)) {
    v.x = hn::Add(v.x, hn::Mul(v.y, v.w));
    v.y = hn::Add(v.y, hn::Mul(v.z, v.x));
    v.z = hn::Add(v.z, hn::Mul(v.x, v.y));
    v.w = hn::Add(v.w, hn::Mul(v.y, v.z));
  };
  mix();
  for (auto* word : {&v.x, &v.y, &v.z, &v.w}) *word = hn::Xor(*word, hn::ShiftRight<16>(*word));
  mix();
  return v;
}

/// Uniform in [0, 1): the 24 high bits, which a float holds exactly.
template <class D>
HWY_INLINE hn::Vec<D> to_unit(D d, hn::Vec<Unsigned<D>> bits) {
  return hn::Mul(hn::ConvertTo(d, hn::BitCast(Signed<D>(), hn::ShiftRight<8>(bits))),
                 hn::Set(d, 0x1p-24f));
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
