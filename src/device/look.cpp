#include "device/look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

namespace raio::device {

Vector mixed(const Vector& a, const Vector& b, double part) {
  Vector out;
  for (size_t k = 0; k < 4; ++k) out[k] = a[k] + (b[k] - a[k]) * part;
  return out;
}
namespace {

using Matrix = std::array<float, 16>;  // column by column

constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Vector times(const Matrix& m, const Vector& v) {
  Vector out{};
  for (size_t row = 0; row < 4; ++row)
    for (size_t column = 0; column < 4; ++column)
      out[row] += double(m[4 * column + row]) * v[column];
  return out;
}

Vector plus(Vector a, const std::array<float, 4>& b) {
  for (size_t k = 0; k < 4; ++k) a[k] += double(b[k]);
  return a;
}

// The texel at a whole number outside or inside of `n` ones; nothing: the border.
std::optional<uint64_t> wrapped(int64_t at, uint64_t n, std::string_view mode) {
  const auto count = int64_t(n);
  if (at >= 0 && at < count) return uint64_t(at);
  if (mode == "clampToBorder") return std::nullopt;
  if (mode == "clampToEdge") return uint64_t(std::clamp<int64_t>(at, 0, count - 1));
  const int64_t turn = mode == "repeat" ? count : 2 * count;
  const int64_t rest = (at % turn + turn) % turn;
  return uint64_t(rest < count ? rest : turn - 1 - rest);
}
Field constant(const Vector& value) {
  return {Rate::constant, [value](const Element&) { return value; }};
}
Field array_field(Rate rate, const std::shared_ptr<const Array>& array) {
  return {rate,
          [array, rate](const Element& e) {
            const uint64_t i = rate == Rate::primitive ? e.primitive
                               : rate == Rate::vertex  ? e.vertex
                                                       : e.corner;
            return i < array->count() ? array->vector(i) : Vector{0, 0, 0, 1};
          },
          array};
}

Field attribute(std::string_view name, const Shapes& shapes, const Object* instance) {
  const Object& geometry = shapes.geometry;
  if (name == "primitiveId")
    return {Rate::primitive, [](const Element& e) { return Vector{double(e.primitive), 0, 0, 1}; }};
  if (name == "objectPosition" || name == "worldPosition") {
    if (name == "worldPosition")
      geometry.warn("'worldPosition' is taken before the instance's transform");
    return array_field(Rate::vertex, shapes.positions);
  }
  if (name.ends_with("Normal")) {
    if (const auto normals = geometry.object<Array>("vertex.normal"))
      return array_field(Rate::vertex, normals);
    geometry.warn(fmt::format("the attribute '{}' needs 'vertex.normal'", name));
    return constant({0, 0, 0, 1});
  }
  const auto uniform = [&](const Object* object) -> std::optional<Field> {
    const Value* const value = object ? object->find(name) : nullptr;
    if (!value || value->type != DataType::float32_vec4) return std::nullopt;
    const auto v = value->as<std::array<float, 4>>();
    return constant({double(v[0]), double(v[1]), double(v[2]), double(v[3])});
  };
  if (const auto field = uniform(instance)) return *field;
  for (const auto& [rate, prefix] :
       {std::pair(Rate::corner, "faceVarying."), std::pair(Rate::vertex, "vertex."),
        std::pair(Rate::primitive, "primitive.")})
    if (auto array = geometry.object<Array>(fmt::format("{}{}", prefix, name)))
      return array_field(rate, array);
  return uniform(&geometry).value_or(constant({0, 0, 0, 1}));
}

// A sampler's values, or, for a mesh with coordinates at its vertices, the coordinates, which a
// texture turns into values.
Field sampled_field(const std::shared_ptr<Object>& sampler, const Shapes& shapes,
                    const Object* instance, bool is_color) {
  if (!sampler->info) return constant({0, 0, 0, 1});
  if (sampler->subtype == "primitive") {
    const auto values = sampler->object<Array>("array");
    const auto offset = sampler->get("inOffset", uint64_t(0));
    if (!values) {
      sampler->warn("has no 'array'");
      return constant({0, 0, 0, 1});
    }
    return {Rate::primitive, [values, offset](const Element& e) {
              const uint64_t i = e.primitive + offset;
              return i < values->count() ? values->vector(i) : Vector{0, 0, 0, 1};
            }};
  }
  Field in = attribute(sampler->word("inAttribute"), shapes, instance);
  in.array = nullptr;
  if (sampler->subtype == "transform")
    return {in.rate,
            [in, sampler](const Element& e) { return image_of(*sampler).finished(in.at(e)); }};
  const Image image = image_of(*sampler);
  if (!image.array || image.array->count() == 0) {
    sampler->warn("has no 'image'");
    return constant({0, 0, 0, 1});
  }
  const auto in_transform = sampler->get("inTransform", kIdentity);
  const auto in_offset = sampler->get("inOffset", std::array<float, 4>{});
  const auto coordinates = [in, in_transform, in_offset](const Element& e) {
    return plus(times(in_transform, in.at(e)), in_offset);
  };
  const bool at_vertices = in.rate == Rate::vertex || in.rate == Rate::corner;
  if (is_color && at_vertices && shapes.corners >= 3)
    return {in.rate, coordinates, nullptr, sampler};
  if (at_vertices && shapes.corners >= 2)
    sampler->warn(is_color ? "is evaluated at vertices, and interpolated between them"
                           : "numbers are evaluated at vertices");
  return {in.rate, [=](const Element& e) { return image.finished(image.at(coordinates(e))); }};
}

// A parameter of a material: a value, the name of an attribute, or a sampler.
Field field_of(const Object& material, std::string_view name, Vector otherwise,
               const Shapes& shapes, const Object* instance, bool is_color = false) {
  const Value* const value = material.find(name);
  if (!value) return constant(otherwise);
  if (value->type == DataType::string) return attribute(value->text, shapes, instance);
  if (value->object) return sampled_field(value->object, shapes, instance, is_color);
  for (int k = 0; k < layout_of(value->type)->count; ++k)
    otherwise[size_t(k)] = number_at(value->bytes.data(), *layout_of(value->type), k);
  return constant(otherwise);
}

Vector constant_of(const Object& material, std::string_view name, const Vector& otherwise,
                   const Shapes& shapes, const Object* instance, bool is_texture = false) {
  const Field field = field_of(material, name, otherwise, shapes, instance);
  if (field.rate != Rate::constant)
    material.warn(fmt::format("'{}' is taken from the first primitive{}", name,
                              is_texture ? ", except by the renderer 'path'" : ""));
  return shapes.primitives > 0 ? field.at(shapes.element(0, 0)) : otherwise;
}

double constant_of(const Object& material, std::string_view name, double otherwise,
                   const Shapes& shapes, const Object* instance, bool is_texture = false) {
  return constant_of(material, name, Vector{otherwise, 0, 0, 1}, shapes, instance, is_texture)[0];
}

// The sampler of a parameter, if the colour's texture has the same coordinates: a mesh has one set
// of them.
std::shared_ptr<const Object> texture_of(const Object& material, std::string_view name,
                                         const Look& look) {
  const Value* const value = material.find(name);
  const auto& color = look.color.image;
  if (!value || !value->object || !color) return nullptr;
  const Object& sampler = *value->object;
  for (const Object* s : {&sampler, color.get()})
    if (s->subtype != "image2D" || s->word("wrapMode1") == "clampToBorder" ||
        s->word("wrapMode2") == "clampToBorder")
      return nullptr;
  const Image image = image_of(sampler);
  const bool same = sampler.word("inAttribute") == color->word("inAttribute") &&
                    sampler.get("inTransform", kIdentity) == color->get("inTransform", kIdentity) &&
                    sampler.get("inOffset", std::array<float, 4>{}) ==
                        color->get("inOffset", std::array<float, 4>{});
  return same && image.array && image.array->count() > 0 ? value->object : nullptr;
}

// A material without colour and opacity. Numbers beyond their range are cut.
StandardMaterial standard_of(const Object& material, const Shapes& shapes, const Object* instance,
                             const Look& look) {
  const auto cut = [&](std::string_view name, double x, double least, double most) {
    if (x >= least && x <= most) return x;
    material.warn(fmt::format("'{}' is cut to {} to {}", name, least, most));
    return x > most ? most : least;
  };
  const auto part = [&](std::string_view name, double otherwise) {
    return cut(name, constant_of(material, name, otherwise, shapes, instance), 0, 1);
  };
  const auto color = [&](std::string_view name, double otherwise, double most) {
    const Vector v =
        constant_of(material, name, {otherwise, otherwise, otherwise, 1}, shapes, instance);
    Triple out;
    for (size_t k = 0; k < 3; ++k) {
      const double light = material.device.display_colors ? light_of_display(v[k]) : v[k];
      out[k] = cut(name, light, 0, most);
    }
    return out;
  };
  StandardMaterial s;
  s.metallic = look.metallic ? 1 : part("metallic", 1);
  s.roughness = look.roughness ? 1 : part("roughness", 1);
  s.ior = cut("ior", constant_of(material, "ior", 1.5, shapes, instance), 1, 100);
  s.specular = part("specular", 0), s.specular_color = color("specularColor", 1, 1e4);
  s.transmission = look.transmission ? 1 : part("transmission", 0);
  s.thin = !(constant_of(material, "thickness", 0, shapes, instance) > 0);
  const double distance =
      double(material.get("attenuationDistance", std::numeric_limits<float>::infinity()));
  if (!s.thin && std::isfinite(distance) && !(distance > 0))
    material.warn("'attenuationDistance' must be above 0 and is ignored");
  else if (!s.thin)
    s.attenuation_distance = distance, s.attenuation_color = color("attenuationColor", 1, 1);
  if (!look.emissive) s.emission = color("emissive", 0, 1e6);
  s.clearcoat = part("clearcoat", 0), s.clearcoat_roughness = part("clearcoatRoughness", 0);
  s.sheen_color = color("sheenColor", 0, 1), s.sheen_roughness = part("sheenRoughness", 0);
  s.alpha_mode = AlphaMode::opaque;  // primitives have opacities, textures no alpha
  return s;
}
}  // namespace

Shapes::Shapes(const Object& object) : geometry(object) {
  positions = object.object<Array>("vertex.position");
  index_ = object.object<Array>("primitive.index");
  kind_ = object.subtype;
  corners = kind_ == "sphere" ? 1 : kind_ == "triangle" ? 3 : kind_ == "quad" ? 4 : 2;
  if (!positions) {
    object.warn("has no 'vertex.position' and is left out");
    return;
  }
  if (index_)
    primitives = index_->count();
  else if (kind_ == "curve")
    primitives = std::max<uint64_t>(positions->count(), 1) - 1;
  else
    primitives = positions->count() / corners;
  for (uint64_t i = 0; index_ && i < primitives; ++i)
    for (int k = 0; k < int(corners); ++k)
      if (const uint64_t v = vertex(i, uint64_t(k)); v >= positions->count()) {
        object.device.report(
            &object, Severity::error, Status::invalid_argument,
            fmt::format("primitive {} refers to vertex {} of {}", i, v, positions->count()));
        primitives = 0;
      }
}

uint64_t Shapes::number(uint64_t primitive, uint64_t k) const {
  const std::byte* const data = index_->at(primitive);
  if (index_->layout.scalar == Scalar::uint32) {
    uint32_t n;
    std::memcpy(&n, data + 4 * k, 4);
    return n;
  }
  uint64_t n;
  std::memcpy(&n, data + 8 * k, 8);
  return n;
}

Image image_of(const Object& sampler) { return {sampler, sampler.object<Array>("image")}; }

Vector Image::at(const Vector& coordinates) const {
  const size_t dimensions = sampler.subtype == "image1D" ? 1 : sampler.subtype == "image2D" ? 2 : 3;
  const bool nearest = sampler.word("filter") == "nearest";
  const auto border = sampler.get("borderColor", std::array<float, 4>{});
  std::array<std::array<std::optional<uint64_t>, 2>, 3> texels{};
  std::array<double, 3> parts{};
  for (size_t k = 0; k < 3; ++k) {
    texels[k] = {0, 0};
    if (k >= dimensions) continue;
    const double n = double(array->size[k]);
    const double at =
        std::clamp(std::isfinite(coordinates[k]) ? coordinates[k] : 0, -1e6, 1e6) * n - 0.5;
    const std::string_view mode =
        sampler.word(dimensions == 1 ? "wrapMode" : fmt::format("wrapMode{}", k + 1));
    const double whole = std::floor(nearest ? at + 0.5 : at);
    parts[k] = nearest ? 0 : at - whole;
    for (int side = 0; side < 2; ++side)
      texels[k][size_t(side)] =
          wrapped(int64_t(whole) + (nearest ? 0 : side), array->size[k], mode);
  }
  const auto texel = [&](int x, int y, int z) {
    const auto &i = texels[0][size_t(x)], &j = texels[1][size_t(y)], &k = texels[2][size_t(z)];
    if (!i || !j || !k)
      return Vector{double(border[0]), double(border[1]), double(border[2]), double(border[3])};
    return array->vector(*i + array->size[0] * (*j + array->size[1] * *k));
  };
  const auto row = [&](int y, int z) { return mixed(texel(0, y, z), texel(1, y, z), parts[0]); };
  const auto plane = [&](int z) { return mixed(row(0, z), row(1, z), parts[1]); };
  return mixed(plane(0), plane(1), parts[2]);
}

Vector Image::finished(const Vector& value) const {
  return plus(times(sampler.get("outTransform", kIdentity), value),
              sampler.get("outOffset", std::array<float, 4>{}));
}

Look look_of(const Object& material, const Shapes& shapes, const Object* instance) {
  Look look;
  const bool matte = material.subtype != "physicallyBased";
  if (!material.info) {
    look.color = constant({0.8, 0.8, 0.8, 1}), look.opacity = constant({1, 0, 0, 1});
    look.opaque = true, look.mask = false, look.cutoff = 0, look.color_has_alpha = false;
  } else {
    const double base = matte ? 0.8 : 1;
    look.color = field_of(material, matte ? "color" : "baseColor", {base, base, base, 1}, shapes,
                          instance, true);
    look.opacity = field_of(material, "opacity", {1, 0, 0, 1}, shapes, instance);
    const std::string_view mode = material.word("alphaMode");
    look.opaque = mode == "opaque", look.mask = mode == "mask";
    look.cutoff = double(material.get("alphaCutoff", 0.5f));
    look.color_has_alpha = !look.color.image;
    if (material.device.display_colors && !look.color.image) {
      look.color.array = nullptr;
      look.color.at = [at = look.color.at](const Element& e) {
        Vector color = at(e);
        for (size_t k = 0; k < 3; ++k) color[k] = light_of_display(color[k]);
        return color;
      };
    }
  }
  Material& m = look.material;
  m.color = {1, 1, 1}, m.kd = 1, m.ks = 0;
  if (matte || !material.info) return look;
  look.metallic = texture_of(material, "metallic", look);
  look.roughness = texture_of(material, "roughness", look);
  look.emissive = texture_of(material, "emissive", look);
  look.transmission = texture_of(material, "transmission", look);
  look.standard = standard_of(material, shapes, instance, look);
  const double metallic = std::clamp(
      constant_of(material, "metallic", 1, shapes, instance, look.metallic != nullptr), 0.0, 1.0);
  const double roughness = std::clamp(
      constant_of(material, "roughness", 1, shapes, instance, look.roughness != nullptr), 0.0, 1.0);
  const double ior = constant_of(material, "ior", 1.5, shapes, instance);
  const double specular =
      std::clamp(constant_of(material, "specular", 0, shapes, instance), 0.0, 1.0);
  // Metals have coloured highlights and no diffuse part; without a path tracer they would be black
  // where no light is mirrored, so half of their colour stays diffuse.
  m.kd = 1 - 0.5 * metallic;
  const double r = (ior - 1) / (ior + 1);
  const Vector base = shapes.primitives > 0 && !look.color.image
                          ? look.color.at(shapes.element(0, 0))
                          : Vector{1, 1, 1, 1};
  const Vector tint =
      field_of(material, "specularColor", {1, 1, 1, 1}, shapes, instance).at({0, 0, 0});
  m.ks = 1;
  for (size_t k = 0; k < 3; ++k)
    m.specular[k] = std::max(r * r * specular * tint[k] * (1 - metallic) + base[k] * metallic, 0.0);
  // From the roughness of Burley 2012 to Blinn's exponent (Walter et al. 2007).
  const double alpha = std::max(roughness * roughness, 0.03);
  m.shine = 2 / (alpha * alpha) - 2;
  if (m.shine < 1) m.ks = 0, m.shine = 1;
  return look;
}
Vector image_at(const Array& image, double x, double y) {
  std::array<uint64_t, 2> low{}, high{};
  std::array<double, 2> part{};
  for (size_t k = 0; k < 2; ++k) {
    const auto last = double(image.size[k] - 1);
    const double at = std::clamp((k == 0 ? x : y) * double(image.size[k]) - 0.5, 0.0, last);
    low[k] = uint64_t(at), high[k] = std::min(low[k] + 1, image.size[k] - 1);
    part[k] = at - double(low[k]);
  }
  const auto row = [&](uint64_t r) {
    const uint64_t first = image.size[0] * r;
    return mixed(image.vector(low[0] + first), image.vector(high[0] + first), part[0]);
  };
  return mixed(row(low[1]), row(high[1]), part[1]);
}

}  // namespace raio::device
