// Three-component vectors: points, directions and colours. Built without floating-point
// contraction, so an expression has the same bits on every machine.
#pragma once

#include <algorithm>
#include <cmath>

namespace raio::core {

template <class T>
struct Vec3 {
  T x = 0, y = 0, z = 0;

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Vec3(T s) : x(s), y(s), z(s) {}
  template <class U>
  constexpr explicit Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

  constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  constexpr Vec3& operator+=(Vec3 b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3& operator*=(T s) { return *this = {x * s, y * s, z * s}; }

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend constexpr Vec3 operator*(Vec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return a * s; }
  friend constexpr Vec3 operator/(Vec3 a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

/// A linear colour; 1 is the display's white.
using Rgb = Vec3f;

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
constexpr Vec3<T> min(Vec3<T> a, Vec3<T> b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

template <class T>
constexpr Vec3<T> max(Vec3<T> a, Vec3<T> b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

template <class T>
Vec3<T> abs(Vec3<T> a) {
  return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}

template <class T>
constexpr T max_component(Vec3<T> a) {
  return std::max({a.x, a.y, a.z});
}

/// The axis (0, 1, 2) along which `a` is largest.
template <class T>
constexpr int max_axis(Vec3<T> a) {
  return a.x >= a.y ? (a.x >= a.z ? 0 : 2) : (a.y >= a.z ? 1 : 2);
}

template <class T>
T length(Vec3<T> a) {
  return std::sqrt(dot(a, a));
}

/// `a` normalized; it must not be zero.
template <class T>
Vec3<T> normalize(Vec3<T> a) {
  return a / length(a);
}

/// Normalizes a vector that is already of unit length except for rounding: one step of Newton's
/// method.
template <class T>
Vec3<T> renormalize(Vec3<T> a) {
  return a * (T(1.5) - T(0.5) * dot(a, a));
}

template <class T>
bool is_finite(Vec3<T> a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Two unit vectors that form a right-handed frame (u, v, n) with the unit vector `n`. Duff et al.
/// 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
template <class T>
struct Frame {
  Vec3<T> u, v;

  explicit Frame(Vec3<T> n) {
    const T sign = std::copysign(T(1), n.z);
    const T a = T(-1) / (sign + n.z);
    const T b = n.x * n.y * a;
    u = {T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
    v = {b, sign + n.y * n.y * a, -n.y};
  }
};

}  // namespace raio::core
