// The radiance of a scene's environment (scene/scene.h) in any direction, in SIMD. Included once
// per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_ENVIRONMENT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_ENVIRONMENT_INL_H_
#undef RAIO_INTEGRATE_ENVIRONMENT_INL_H_
#else
#define RAIO_INTEGRATE_ENVIRONMENT_INL_H_
#endif

#include "integrate/tile-inl.h"
#include "scene/scene.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// The axes of an environment, and where directions fall in its picture.
class EnvironmentFrame {
 public:
  explicit EnvironmentFrame(const Environment& picture)
      : width_(float(picture.width)), height_(float(picture.height)) {
    const Vec3d up = normalize(Vec3d(picture.up));
    const Vec3d right = normalize(cross(Vec3d(picture.direction), up));
    right_ = Vec3f(right), up_ = Vec3f(up), forward_ = Vec3f(cross(up, right));
  }

  // In texels from the centre of the first. `left` and `above` are the whole part, from -1 to the
  // last column or row, for any direction, even NaN.
  struct Place {
    V column, row, left, above;
  };
  HWY_INLINE Place place(const V3& dir) const {
    const V x = dot(dir, set3(d, right_)), z = dot(dir, set3(d, forward_));
    const V y = dot(dir, set3(d, up_)), half = hn::Set(d, 0.5f);
    const V azimuth = turns_of(d, x, z);
    const V altitude = turns_of(d, y, hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(z, z))));
    const V columns = hn::Set(d, width_), rows = hn::Set(d, height_);
    const V row = hn::Sub(hn::Mul(hn::Sub(half, hn::Add(altitude, altitude)), rows), half);
    const V column = hn::Sub(hn::Mul(hn::Add(azimuth, half), columns), half);
    return {column, row, hn::Floor(within(column, columns)), hn::Floor(within(row, rows))};
  }

  // The direction to the right, up and forward by these, seen from within.
  HWY_INLINE V3 direction(V right, V up, V forward) const {
    return set3(d, right_) * right + set3(d, up_) * up + set3(d, forward_) * forward;
  }

 private:
  // -1 to `most` - 1/2; -1 for NaN.
  static HWY_INLINE V within(V along, V most) {
    const V least = hn::Set(d, -1), number = hn::IfThenElse(hn::Eq(along, along), along, least);
    return hn::Min(hn::Max(number, least), hn::Sub(most, hn::Set(d, 0.5f)));
  }

  float width_, height_;
  Vec3f right_, up_, forward_;
};

class EnvironmentLight {
 public:
  explicit EnvironmentLight(const Scene& scene)
      : picture_(scene.environment[0]), texels_(&scene.environment_texels[0].x), frame_(picture_) {}

  // Bilinear between the four nearest texels. For any direction, even NaN, it reads texels of the
  // picture.
  HWY_INLINE V3 radiance(const V3& dir) const {
    const auto [column, row, left, above] = frame_.place(dir);
    const V one = hn::Set(d, 1), right = hn::Add(left, one), below = hn::Add(above, one);
    const V last_column = hn::Set(d, float(picture_.width) - 1);
    const V last_row = hn::Set(d, float(picture_.height) - 1);
    // The picture continues beyond its left and right edges.
    const V from = hn::IfThenElse(hn::Lt(left, hn::Zero(d)), last_column, left);
    const V to = hn::IfThenElseZero(hn::Le(right, last_column), right);
    const auto at = [&](V in_row, V in_column) HWY_ATTR {
      return texel(hn::Min(hn::Max(in_row, hn::Zero(d)), last_row), in_column);
    };
    const auto mix = [](const V3& a, const V3& b, V part) HWY_ATTR { return a + (b - a) * part; };
    const V across = hn::Sub(column, left);
    return mix(mix(at(above, from), at(above, to), across),
               mix(at(below, from), at(below, to), across), hn::Sub(row, above));
  }

 private:
  HWY_INLINE V3 texel(V row, V column) const {
    const Signed<D> di;
    const auto width = hn::Set(di, int(picture_.width));
    const auto number = hn::Add(hn::Mul(hn::ConvertTo(di, row), width), hn::ConvertTo(di, column));
    const auto first = hn::Mul(number, hn::Set(di, 3));
    return {hn::GatherIndex(d, texels_, first), hn::GatherIndex(d, texels_ + 1, first),
            hn::GatherIndex(d, texels_ + 2, first)};
  }

  const Environment& picture_;
  const float* texels_;
  EnvironmentFrame frame_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
