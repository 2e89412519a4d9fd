// How a geometry looks: the values of its material, from numbers, attributes and samplers.
#pragma once

#include <raio/raio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "device/objects.h"

namespace raio::device {

using Vector = std::array<double, 4>;

Vector mixed(const Vector& a, const Vector& b, double part);

/// A value may be constant, or differ by primitive, by vertex, or by corner of a primitive.
enum class Rate { constant, primitive, vertex, corner };

struct Element {
  uint64_t primitive, vertex, corner;
};

/// The values of an attribute or of a parameter of a material.
struct Field {
  Rate rate = Rate::constant;
  std::function<Vector(const Element&)> at;
  std::shared_ptr<const Array> array = nullptr;   // the values themselves, if nothing changes them
  std::shared_ptr<const Object> image = nullptr;  // a sampler for which these are coordinates
};

/// The shapes of a geometry: vertices by primitive and corner.
class Shapes {
 public:
  explicit Shapes(const Object& object);

  bool indexed() const { return index_ != nullptr; }
  uint64_t vertex(uint64_t primitive, uint64_t corner) const {
    if (kind_ == "curve") return (index_ ? number(primitive, 0) : primitive) + corner;
    return index_ ? number(primitive, corner) : primitive * corners + corner;
  }
  Element element(uint64_t primitive, uint64_t corner) const {
    return {primitive, vertex(primitive, corner), primitive * corners + corner};
  }
  /// Packed 32-bit indices of triangles that can be read in place.
  Column<uint32_t, 3> triangles() const {
    if (!index_ || index_->element != DataType::uint32_vec3) return {};
    return {reinterpret_cast<const uint32_t*>(index_->at(0)), primitives, 12, index_->memory()};
  }

  const Object& geometry;
  std::shared_ptr<const Array> positions;
  uint64_t corners = 0, primitives = 0;

 private:
  uint64_t number(uint64_t primitive, uint64_t k) const;

  std::shared_ptr<const Array> index_;
  std::string_view kind_;
};

/// A sampler's image.
struct Image {
  const Object& sampler;
  std::shared_ptr<const Array> array;

  /// The value for coordinates, before finished().
  Vector at(const Vector& coordinates) const;
  /// A value after the sampler's transform and offset.
  Vector finished(const Vector& value) const;
};
Image image_of(const Object& sampler);

/// How a surface looks.
struct Look {
  Field color, opacity;
  Material material;  // the rest
  /// The renderer `path` shows this instead, with the colour, opacity and texture above.
  std::optional<StandardMaterial> standard;
  /// Samplers with the coordinates of that of the colour, which become textures of `standard`.
  std::shared_ptr<const Object> metallic, roughness, emissive, transmission;
  bool opaque, mask;
  double cutoff;
  bool color_has_alpha;  // which multiplies the opacity

  double opacity_at(const Element& e) const {
    if (opaque) return 1;
    const double alpha = opacity.at(e)[0] * (color_has_alpha ? color.at(e)[3] : 1);
    return mask ? double(alpha >= cutoff) : std::clamp(std::isfinite(alpha) ? alpha : 1, 0.0, 1.0);
  }
  bool varies() const {
    return !opaque &&
           (opacity.rate != Rate::constant || (color_has_alpha && color.rate != Rate::constant));
  }
};
Look look_of(const Object& material, const Shapes& shapes, const Object* instance);

/// A pixel of a two-dimensional image, interpolated; `at` counts from 0 to 1.
Vector image_at(const Array& image, double x, double y);

}  // namespace raio::device
