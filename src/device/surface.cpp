#include "device/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <utility>

#include "device/look.h"

namespace raio::device {

namespace {

constexpr uint64_t kLargestTexture = 16384;  // of raio::Scene

template <class T, size_t N>
Column<float, N> column(const std::vector<T>& values) {
  return {reinterpret_cast<const float*>(values.data()), values.size(), sizeof(T)};
}

Column<float, 3> column(const std::vector<std::array<float, 3>>& values) {
  return column<std::array<float, 3>, 3>(values);
}
Column<float> column(const std::vector<float>& values) { return column<float, 1>(values); }

// One value for all.
template <size_t N>
Column<float, N> repeated(const std::array<float, N>& value, size_t count) {
  const auto keep = std::make_shared<const std::array<float, N>>(value);
  return {keep->data(), count, 0, keep};
}

// The application's floats, read in place.
template <size_t N>
Column<float, N> borrowed(const Array& array) {
  return {reinterpret_cast<const float*>(array.at(0)), array.count(),
          std::ptrdiff_t(size_of(array.element)), array.memory()};
}

// Adds the primitives of one geometry.
class Adder {
 public:
  Adder(const Object& surface, const Object* instance, uint32_t id, Scene& scene, Part& part,
        bool round_ends)
      : shapes_(*surface.object("geometry")),
        look_(look_of(*surface.object("material"), shapes_, instance)),
        geometry_(shapes_.geometry),
        radii_(geometry_.object<Array>("vertex.radius")),
        id_(id),
        scene_(scene),
        part_(part),
        round_ends_(round_ends) {}

  void add() {
    if (shapes_.primitives == 0) return;
    if (look_.mask || look_.varies() || has_empty_spheres())
      drop_invisible();
    else
      kept_all_ = true;
    if (count() == 0) return;
    if (look_.varies() && !look_.mask && shapes_.corners > 1 &&
        (look_.opacity.rate > Rate::primitive || look_.color.rate > Rate::primitive))
      geometry_.warn("opacities are those of whole primitives");
    if (geometry_.subtype == "sphere")
      add_spheres();
    else if (shapes_.corners == 2)
      add_segments();
    else
      add_triangles();
  }

 private:
  size_t count() const { return kept_all_ ? size_t(shapes_.primitives) : kept_.size(); }
  uint64_t primitive(size_t i) const { return kept_all_ ? i : kept_[i]; }

  // Applications hide spheres by a radius of 0.
  float sphere_radius(uint64_t vertex) const {
    if (!radii_) return geometry_.get("radius", 1.0f);
    return vertex < radii_->count() ? float(radii_->vector(vertex)[0]) : 0;
  }
  bool is_empty(uint64_t primitive) const {
    return shapes_.corners == 1 && sphere_radius(shapes_.vertex(primitive, 0)) == 0;
  }
  bool has_empty_spheres() const {
    for (uint64_t i = 0; i < shapes_.primitives; ++i)
      if (is_empty(i)) return true;
    return false;
  }

  void drop_invisible() {
    for (uint64_t i = 0; i < shapes_.primitives; ++i)
      if (mean_opacity(i) > 0 && !is_empty(i)) kept_.push_back(uint32_t(i));
    kept_all_ = kept_.size() == shapes_.primitives;
  }

  double mean_opacity(uint64_t primitive) const {
    double sum = 0;
    for (uint64_t k = 0; k < shapes_.corners; ++k)
      sum += look_.opacity_at(shapes_.element(primitive, k));
    const double mean = sum / double(shapes_.corners);
    return look_.mask ? double(mean >= 0.5) : mean;
  }
  Vector mean_color(uint64_t primitive) const {
    Vector sum = look_.color.at(shapes_.element(primitive, 0));
    for (uint64_t k = 1; k < shapes_.corners; ++k)
      sum = mixed(sum, look_.color.at(shapes_.element(primitive, k)), 1 / double(k + 1));
    return sum;
  }
  std::array<float, 3> rgb_of(const Vector& color) const {
    std::array<float, 3> out;
    for (size_t k = 0; k < 3; ++k) {
      const bool sound = std::isfinite(color[k]) && color[k] >= 0 && color[k] <= 1e4;
      if (!sound) geometry_.warn("colours that are not from 0 to 10,000 are cut, or black");
      out[k] = sound ? float(color[k]) : color[k] > 1e4 ? 1e4f : 0;
    }
    return out;
  }
  std::array<float, 3> position(uint64_t vertex) const {
    std::array<float, 3> out;
    std::memcpy(out.data(), shapes_.positions->at(vertex), sizeof out);
    return out;
  }

  // The material, with a constant opacity and, if it is constant, the colour.
  uint32_t material(bool with_color) {
    Material m = look_.material;
    if (with_color) {
      const auto c = rgb_of(look_.color.at(shapes_.element(0, 0)));
      m.color = {double(c[0]), double(c[1]), double(c[2])};
    }
    if (!look_.varies() && !look_.mask) m.opacity = look_.opacity_at(shapes_.element(0, 0));
    return add_material(m);
  }

  uint32_t add_material(const Material& m) {
    if (!look_.standard) return scene_.add_material(m);
    StandardMaterial standard = *look_.standard;
    standard.color = m.color, standard.opacity = m.opacity, standard.texture = m.texture;
    if (std::ranges::all_of(m.color, [](double x) { return x <= 1; }))
      return scene_.add_material(standard, m);
    geometry_.warn("a base colour above 1 has no physical material: 'path' shows it matt");
    return scene_.add_material(m);
  }

  // The appearance of primitives that have one colour each.
  Appearance appearance() {
    const bool one_color = look_.color.rate == Rate::constant;
    Appearance out = material(one_color);
    if (!one_color) {
      const Array* const array = look_.color.array.get();
      const bool per_primitive =
          look_.color.rate == Rate::primitive ||
          (look_.color.rate == Rate::vertex && shapes_.corners == 1 && !shapes_.indexed());
      if (array && kept_all_ && per_primitive && array->count() >= count() &&
          (array->element == DataType::float32_vec3 || array->element == DataType::float32_vec4)) {
        out.colors = borrowed<3>(*array), out.colors.count = count();
      } else {
        colors_.clear();
        for (size_t i = 0; i < count(); ++i) colors_.push_back(rgb_of(mean_color(primitive(i))));
        out.colors = column(colors_);
      }
    }
    if (look_.varies() && !look_.mask) {
      opacities_.clear();
      for (size_t i = 0; i < count(); ++i) opacities_.push_back(float(mean_opacity(primitive(i))));
      if (std::ranges::any_of(opacities_, [](float x) { return x < 1; }))
        out.opacity = column(opacities_);
    }
    return out;
  }

  // `primitives`: the numbers in the geometry, if not 0, 1, ...
  void note(Kind kind, size_t added, std::vector<uint32_t> primitives, bool in_mesh = false) {
    uint32_t first = 0;
    for (const Range& r : part_.ranges)
      if (r.kind == kind && r.in_mesh == in_mesh) first += r.count;
    part_.ranges.push_back({kind, first, uint32_t(added), id_, in_mesh, std::move(primitives)});
  }

  void add_spheres() {
    const Appearance look = appearance();
    if (kept_all_ && !shapes_.indexed()) {
      Column<float, 3> centers = borrowed<3>(*shapes_.positions);
      Column<float> sizes =
          radii_ ? borrowed<1>(*radii_) : repeated<1>({sphere_radius(0)}, count());
      centers.count = sizes.count = count();
      scene_.add_spheres(centers, sizes, look);
    } else {
      std::vector<std::array<float, 3>> centers;
      std::vector<float> sizes;
      for (size_t i = 0; i < count(); ++i) {
        const uint64_t v = shapes_.vertex(primitive(i), 0);
        centers.push_back(position(v)), sizes.push_back(sphere_radius(v));
      }
      scene_.add_spheres(column(centers), column(sizes), look);
    }
    note(Kind::sphere, count(), kept_);
  }

  // Cylinders, cones and curves: cones whose ends are open, closed by discs, or round.
  void add_segments() {
    constexpr int kSteps = 8;  // in which a colour changes along a segment
    const bool curve = geometry_.subtype == "curve", cylinder = geometry_.subtype == "cylinder";
    const auto primitive_radii = cylinder ? geometry_.object<Array>("primitive.radius") : nullptr;
    const float one_radius = geometry_.get("radius", 1.0f);
    const auto caps = geometry_.object<Array>("vertex.cap");
    const std::string_view closed = curve ? "none" : geometry_.word("caps");
    const bool blends = look_.color.rate == Rate::vertex || look_.color.rate == Rate::corner;

    std::vector<std::array<float, 3>> starts, ends, centers, normals, balls;
    std::vector<float> start_radii, end_radii, disc_radii, ball_radii;
    Looks cone_looks, disc_looks, ball_looks;
    for (size_t i = 0; i < count(); ++i) {
      const auto p = uint32_t(primitive(i));
      const uint64_t a = shapes_.vertex(p, 0), b = shapes_.vertex(p, 1);
      const auto radius_at = [&](uint64_t v) {
        if (primitive_radii)
          return p < primitive_radii->count() ? float(primitive_radii->vector(p)[0]) : 0;
        return cylinder ? one_radius : sphere_radius(v);
      };
      std::array<std::array<float, 3>, 2> ends_of = {position(a), position(b)};
      std::array<float, 2> radii = {radius_at(a), radius_at(b)};
      const std::array<Vector, 2> colors = {look_.color.at(shapes_.element(p, 0)),
                                            look_.color.at(shapes_.element(p, 1))};
      const auto opacity = float(mean_opacity(p));
      std::array<double, 3> axis;
      double length = 0;
      for (size_t k = 0; k < 3; ++k)
        axis[k] = double(ends_of[1][k]) - double(ends_of[0][k]), length += axis[k] * axis[k];
      length = std::sqrt(length);
      for (int end = 0; end < 2; ++end) {
        const auto e = size_t(end);
        const uint64_t v = end ? b : a;
        const bool cap = caps ? v < caps->count() && *caps->at(v) != std::byte()
                              : closed == "both" || closed == (end ? "second" : "first");
        // Segments share the balls between them.
        const bool shared = curve && end == 0 && i > 0 && shapes_.vertex(primitive(i - 1), 1) == a;
        if (round_ends_ || (curve && radii[e] > 0 && !shared)) {
          balls.push_back(ends_of[e]);
          ball_radii.push_back(curve ? radii[e] : std::max(radii[0], radii[1]));
          ball_looks.add(rgb_of(colors[e]), opacity, p);
        } else if (cap && radii[e] > 0 && length > 0) {
          centers.push_back(ends_of[e]), disc_radii.push_back(radii[e]);
          std::array<float, 3> normal;
          for (size_t k = 0; k < 3; ++k) normal[k] = float((end ? 1 : -1) * axis[k] / length);
          normals.push_back(normal), disc_looks.add(rgb_of(colors[e]), opacity, p);
        }
      }
      if (curve && length > 0) {
        // The cone that touches both balls.
        const double slope = (double(radii[0]) - double(radii[1])) / length;
        if (std::abs(slope) >= 1) continue;  // one ball contains the other
        const double across = std::sqrt(1 - slope * slope);
        const std::array<float, 2> ball = radii;
        for (size_t e = 0; e < 2; ++e) {
          for (size_t k = 0; k < 3; ++k)
            ends_of[e][k] =
                float(double(ends_of[e][k]) + axis[k] / length * slope * double(ball[e]));
          radii[e] = float(double(ball[e]) * across);
        }
      }
      if (!(length > 0) || (radii[0] == 0 && radii[1] == 0)) continue;
      const int steps = blends && colors[0] != colors[1] ? kSteps : 1;
      if (steps > 1) geometry_.warn("colours change along it in eight steps");
      const auto between = [](float x, float y, int step, int all) {
        return step == all ? y : float(double(x) + (double(y) - double(x)) * step / all);
      };
      for (int step = 0; step < steps; ++step) {
        std::array<float, 3> from, to;
        for (size_t k = 0; k < 3; ++k)
          from[k] = between(ends_of[0][k], ends_of[1][k], step, steps),
          to[k] = between(ends_of[0][k], ends_of[1][k], step + 1, steps);
        starts.push_back(from), ends.push_back(to);
        start_radii.push_back(between(radii[0], radii[1], step, steps));
        end_radii.push_back(between(radii[0], radii[1], step + 1, steps));
        cone_looks.add(rgb_of(mixed(colors[0], colors[1], (step + 0.5) / steps)), opacity, p);
      }
    }
    const uint32_t m = material(false);
    const bool seen_through = look_.varies() && !look_.mask;
    if (!starts.empty()) {
      scene_.add_cones(column(starts), column(ends), column(start_radii), column(end_radii),
                       cone_looks.appearance(m, seen_through));
      note(Kind::cone, starts.size(), cone_looks.primitives);
    }
    if (!centers.empty()) {
      scene_.add_discs(column(centers), column(normals), column(disc_radii), {},
                       disc_looks.appearance(m, seen_through));
      note(Kind::disc, centers.size(), disc_looks.primitives);
    }
    if (!balls.empty()) {
      scene_.add_spheres(column(balls), column(ball_radii), ball_looks.appearance(m, seen_through));
      note(Kind::sphere, balls.size(), ball_looks.primitives);
    }
  }

  struct Looks {
    std::vector<std::array<float, 3>> colors;
    std::vector<float> opacities;
    std::vector<uint32_t> primitives;

    void add(const std::array<float, 3>& color, float opacity, uint32_t primitive) {
      colors.push_back(color), opacities.push_back(opacity), primitives.push_back(primitive);
    }
    Appearance appearance(uint32_t material, bool with_opacity) const {
      Appearance out = material;
      out.colors = column(colors);
      if (with_opacity) out.opacity = column(opacities);
      return out;
    }
  };

  // NOLINTNEXTLINE(readability-function-size): vertices, normals and colours depend on each other
  void add_triangles() {
    const bool quads = shapes_.corners == 4;
    const auto normals = geometry_.object<Array>("vertex.normal"),
               corner_normals = geometry_.object<Array>("faceVarying.normal");
    const bool shaded =
        look_.color.image || look_.color.rate == Rate::vertex || look_.color.rate == Rate::corner;
    const bool tiles = look_.color.image && look_.color.image->subtype == "image3D";
    const bool split =
        corner_normals || look_.color.rate == Rate::corner || (shaded && look_.varies()) || tiles;

    // Vertices and indices, in place if possible.
    std::vector<std::array<float, 3>> own_positions, own_normals;
    std::vector<std::array<uint32_t, 3>> own_triangles;
    std::vector<uint32_t> primitives;
    std::vector<Element> vertices;  // of which attributes are taken
    Column<float, 3> positions, normal_column;
    Column<uint32_t, 3> triangles;
    if (!split) {
      positions = borrowed<3>(*shapes_.positions);
      if (kept_all_ && !quads) triangles = shapes_.triangles();
    }
    if (!triangles.data) {
      static constexpr uint64_t kTriangle[1][3] = {{0, 1, 2}}, kQuad[2][3] = {{0, 1, 3}, {1, 2, 3}};
      for (size_t i = 0; i < count(); ++i) {
        const uint64_t p = primitive(i);
        for (int half = 0; half < (quads ? 2 : 1); ++half) {
          std::array<uint32_t, 3> corners;
          for (size_t k = 0; k < 3; ++k) {
            const Element e = shapes_.element(p, quads ? kQuad[half][k] : kTriangle[0][k]);
            corners[k] = uint32_t(split ? vertices.size() : e.vertex);
            if (split) vertices.push_back(e), own_positions.push_back(position(e.vertex));
          }
          own_triangles.push_back(corners);
          if (quads || !kept_all_) primitives.push_back(uint32_t(p));
        }
      }
      triangles = {own_triangles.data()->data(), own_triangles.size(), 12};
    }
    if (split)
      positions = column(own_positions);
    else if (shaded)
      for (uint64_t v = 0; v < shapes_.positions->count(); ++v) vertices.push_back({0, v, v});
    if (const auto array = corner_normals ? corner_normals : normals) {
      const auto normal = [&](uint64_t i) {
        const Vector v = i < array->count() ? array->vector(i) : Vector{0, 0, 0, 0};
        return std::array<float, 3>{float(v[0]), float(v[1]), float(v[2])};
      };
      bool sound = true;
      if (split)
        for (const Element& e : vertices)
          own_normals.push_back(normal(corner_normals ? e.corner : e.vertex));
      else
        for (uint64_t v = 0; v < shapes_.positions->count(); ++v) own_normals.push_back(normal(v));
      for (std::array<float, 3>& n : own_normals)
        if (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] == 0) sound = false;
      if (!sound) repair_normals(own_normals, positions, triangles);
      normal_column = column(own_normals);
    }

    if (!shaded) {
      Appearance look = appearance();
      if (quads) look = doubled(look);
      scene_.add_triangles(positions, triangles, normal_column, look);
      return note(Kind::triangle, triangles.count, std::move(primitives));
    }
    std::vector<std::array<float, 2>> uv;
    std::vector<std::array<float, 3>> colors;
    if (tiles) {
      uv = add_tiles(vertices);
    } else if (look_.color.image) {
      const Texture texture = add_texture();
      look_.material.texture = texture.number;
      add_other_textures();
      for (const Element& e : vertices) {
        const Vector at = look_.color.at(e);
        const auto inside = [&](size_t k) {
          return float(std::isfinite(at[k]) ? texture.scale[k] * at[k] + texture.shift[k] : 0);
        };
        uv.push_back({inside(0), 1 - inside(1)});
      }
    } else {
      for (const Element& e : vertices) colors.push_back(rgb_of(look_.color.at(e)));
    }
    // Materials hold the opacities of meshes.
    std::vector<uint32_t> materials;
    if (look_.varies() && !look_.mask) {
      constexpr int kLevels = 64;
      std::array<std::optional<uint32_t>, kLevels + 1> levels;
      for (size_t i = 0; i < triangles.count; ++i) {
        const double opacity = mean_opacity(primitives.empty() ? primitive(i) : primitives[i]);
        auto& level = levels[size_t(std::lround(opacity * kLevels))];
        if (!level) {
          Material m = look_.material;
          m.opacity = std::round(opacity * kLevels) / kLevels;
          level = add_material(m);
        }
        materials.push_back(*level);
      }
      geometry_.warn("opacities are in steps of 1/64");
    } else {
      materials.push_back(material(false));
    }
    scene_.add_mesh(positions, triangles, normal_column, column<std::array<float, 2>, 2>(uv),
                    column(colors), Column<uint32_t>{materials.data(), materials.size()});
    note(Kind::triangle, triangles.count, std::move(primitives), true);
  }

  // The appearance of two triangles for each quadrilateral.
  Appearance doubled(const Appearance& look) {
    Appearance out = look.material;
    if (look.colors.data) {
      std::vector<std::array<float, 3>> twice;
      for (size_t i = 0; i < look.colors.count; ++i) {
        std::array<float, 3> c;
        std::memcpy(c.data(),
                    reinterpret_cast<const std::byte*>(look.colors.data) +
                        std::ptrdiff_t(i) * look.colors.stride,
                    sizeof c);
        twice.push_back(c), twice.push_back(c);
      }
      colors_ = std::move(twice), out.colors = column(colors_);
    }
    if (look.opacity.data) {
      std::vector<float> twice;
      for (size_t i = 0; i < look.opacity.count; ++i)
        twice.push_back(look.opacity.data[i]), twice.push_back(look.opacity.data[i]);
      opacities_ = std::move(twice), out.opacity = column(opacities_);
    }
    return out;
  }

  // Vertices without a normal get that of a triangle.
  void repair_normals(std::vector<std::array<float, 3>>& normals, const Column<float, 3>& positions,
                      const Column<uint32_t, 3>& triangles) const {
    geometry_.warn("normals of length 0 are replaced by those of triangles");
    const auto point = [&](uint32_t v, size_t k) {
      return double(
          reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(positions.data) +
                                         std::ptrdiff_t(v) * positions.stride)[k]);
    };
    for (size_t i = 0; i < triangles.count; ++i) {
      const uint32_t* const t = triangles.data + 3 * i;
      for (int corner = 0; corner < 3; ++corner) {
        auto& n = normals[t[corner]];
        if (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0) continue;
        std::array<double, 3> u, v;
        for (size_t k = 0; k < 3; ++k)
          u[k] = point(t[1], k) - point(t[0], k), v[k] = point(t[2], k) - point(t[0], k);
        for (size_t k = 0; k < 3; ++k)
          n[k] = float(u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
      }
    }
    for (auto& n : normals)
      if (!(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0)) n = {0, 0, 1};
  }

  struct Texture {
    uint32_t number;
    std::array<double, 2> scale = {1, 1}, shift = {0, 0};  // of coordinates
  };

  // The sampler's image as a texture of eight bits, linearly interpolated; for `nearest`, with
  // texels large enough that their borders are sharp.
  Texture add_texture() {
    const Object& sampler = *look_.color.image;
    const Image image = image_of(sampler);
    const bool flat = sampler.subtype == "image1D", nearest = sampler.word("filter") == "nearest";
    const auto border_color = sampler.get("borderColor", std::array<float, 4>{});
    std::array<TextureWrap, 2> wraps = {TextureWrap::clamp, TextureWrap::clamp};
    std::array<uint64_t, 2> from = {image.array->size[0], flat ? 1 : image.array->size[1]}, to{};
    std::array<uint64_t, 2> border{}, factor{};
    Texture out{};
    for (size_t k = 0; k < (flat ? 1u : 2u); ++k) {
      const std::string_view mode =
          sampler.word(flat ? "wrapMode" : fmt::format("wrapMode{}", k + 1));
      if (mode == "repeat") wraps[k] = TextureWrap::repeat;
      if (mode == "mirrorRepeat") wraps[k] = TextureWrap::mirror;
      border[k] = mode == "clampToBorder" ? 1 : 0;
      factor[k] = nearest ? std::clamp<uint64_t>(1024 / from[k], 1, 64) : 1;
      const double inner = double(from[k] * factor[k]), all = inner + 2 * double(border[k]);
      out.scale[k] = inner / all, out.shift[k] = double(border[k]) / all;
    }
    if (flat) factor[1] = 1, out.scale[1] = 0, out.shift[1] = 0.5;
    for (size_t k = 0; k < 2; ++k) {
      to[k] = from[k] * factor[k] + 2 * border[k];
      if (to[k] > kLargestTexture)
        throw Error(ErrorKind::bad_input,
                    fmt::format("an image of {} x {} texels; a side may have {}", from[0], from[1],
                                kLargestTexture - 2));
    }
    std::vector<uint8_t> bytes;
    for (uint64_t y = 0; y < to[1]; ++y)
      for (uint64_t x = 0; x < to[0]; ++x) {
        const bool outside =
            x < border[0] || y < border[1] || x >= to[0] - border[0] || y >= to[1] - border[1];
        Vector texel =
            outside ? Vector{double(border_color[0]), double(border_color[1]),
                             double(border_color[2]), double(border_color[3])}
                    : image.array->vector((x - border[0]) / factor[0] +
                                          image.array->size[0] * ((y - border[1]) / factor[1]));
        texel = image.finished(texel);
        for (size_t k = 0; k < 3; ++k) bytes.push_back(texel_byte(texel[k]));
      }
    out.number =
        scene_.add_texture(uint32_t(to[0]), uint32_t(to[1]), bytes.data(), wraps[0], wraps[1]);
    return out;
  }

  // The values of samplers as a texture with the size of the largest, a sampler for each channel.
  uint32_t add_data_texture(
      const std::array<const Object*, 3>& samplers, const Object& wrapping,
      const std::function<uint8_t(const Object&, const Vector&, size_t)>& byte) {
    std::array<uint64_t, 2> size = {1, 1};
    for (const Object* sampler : samplers)
      for (size_t k = 0; sampler && k < 2; ++k) {
        const uint64_t own = image_of(*sampler).array->size[k];
        const bool nearest = sampler->word("filter") == "nearest";
        size[k] = std::max(size[k], own * (nearest ? std::clamp<uint64_t>(1024 / own, 1, 64) : 1));
      }
    if (std::max(size[0], size[1]) > kLargestTexture)
      throw Error(ErrorKind::bad_input,
                  fmt::format("an image of {} x {} texels; a side may have {}", size[0], size[1],
                              kLargestTexture));
    std::vector<uint8_t> bytes;
    for (uint64_t y = 0; y < size[1]; ++y)
      for (uint64_t x = 0; x < size[0]; ++x)
        for (size_t k = 0; k < 3; ++k) {
          if (!samplers[k]) {
            bytes.push_back(255);
            continue;
          }
          const Image image = image_of(*samplers[k]);
          const Vector at = {(double(x) + 0.5) / double(size[0]),
                             (double(y) + 0.5) / double(size[1]), 0, 1};
          bytes.push_back(byte(*samplers[k], image.finished(image.at(at)), k));
        }
    std::array<TextureWrap, 2> wraps = {TextureWrap::clamp, TextureWrap::clamp};
    for (size_t k = 0; k < 2; ++k) {
      const std::string_view mode = wrapping.word(k == 0 ? "wrapMode1" : "wrapMode2");
      if (mode == "repeat") wraps[k] = TextureWrap::repeat;
      if (mode == "mirrorRepeat") wraps[k] = TextureWrap::mirror;
    }
    return scene_.add_texture(uint32_t(size[0]), uint32_t(size[1]), bytes.data(), wraps[0],
                              wraps[1]);
  }

  // Those of `path`. The first number of a sampler counts where one is asked for.
  void add_other_textures() {
    if (!look_.standard) return;
    StandardMaterial& s = *look_.standard;
    const auto part = [&](const Object&, const Vector& v, size_t) {
      if (!(v[0] >= 0 && v[0] <= 1)) geometry_.warn("texels that are not from 0 to 1 are cut");
      return uint8_t(std::lround(255 * std::clamp(std::isfinite(v[0]) ? v[0] : 0, 0.0, 1.0)));
    };
    const Object *metallic = look_.metallic.get(), *roughness = look_.roughness.get();
    if (metallic || roughness)
      s.metallic_roughness_texture =
          add_data_texture({nullptr, roughness, metallic}, metallic ? *metallic : *roughness, part);
    if (const Object* const t = look_.transmission.get())
      s.transmission_texture = add_data_texture({t, nullptr, nullptr}, *t, part);
    const Object* const light = look_.emissive.get();
    if (!light) return;
    const Image image = image_of(*light);
    const auto light_at = [&](const Vector& v, size_t k) {
      return geometry_.device.display_colors ? light_of_display(v[k]) : v[k];
    };
    double most = 0;
    for (uint64_t i = 0; i < image.array->count(); ++i)
      for (size_t k = 0; k < 3; ++k)
        most = std::max(most, light_at(image.finished(image.array->vector(i)), k));
    if (!(most > 0 && most <= 1e6))
      return geometry_.warn("an image of 'emissive' is black or too bright");
    s.emission = {most, most, most};
    s.emission_texture = add_data_texture(
        {light, light, light}, *light, [&](const Object&, const Vector& v, size_t k) {
          return display_byte(std::max(light_at(v, k), 0.0) / most);
        });
  }

  // Textures hold display values.
  uint8_t texel_byte(double value) const {
    if (!(value >= 0 && value <= 1)) geometry_.warn("texels that are not from 0 to 1 are cut");
    return display_byte(geometry_.device.display_colors ? light_of_display(value) : value);
  }

  // The values of an image of three dimensions on each triangle, in a square tile of a texture.
  // Returns the texture coordinates of the vertices, three per triangle.
  std::vector<std::array<float, 2>> add_tiles(const std::vector<Element>& vertices) {
    const Object& sampler = *look_.color.image;
    const Image image = image_of(sampler);
    const size_t triangles = vertices.size() / 3;
    const auto across = size_t(std::ceil(std::sqrt(double(triangles))));
    const size_t side = std::clamp<size_t>(4096 / across, 4, 256), width = across * side;
    if (width > kLargestTexture)
      throw Error(
          ErrorKind::bad_input,
          fmt::format("an image of three dimensions on {} triangles is too much", triangles));
    std::vector<uint8_t> bytes(width * width * 3);
    std::vector<std::array<float, 2>> uv;
    const double span = double(side) - 3;  // texels between two corners; one more is around them
    for (size_t i = 0; i < triangles; ++i) {
      std::array<Vector, 3> corners;
      for (size_t k = 0; k < 3; ++k) corners[k] = look_.color.at(vertices[3 * i + k]);
      const size_t left = i % across * side, top = i / across * side;
      for (size_t y = 0; y < side; ++y)
        for (size_t x = 0; x < side; ++x) {
          const double u = (double(x) - 1) / span, v = (double(y) - 1) / span;
          Vector at;
          for (size_t k = 0; k < 4; ++k)
            at[k] = corners[0][k] + u * (corners[1][k] - corners[0][k]) +
                    v * (corners[2][k] - corners[0][k]);
          const Vector value = image.finished(image.at(at));
          for (size_t k = 0; k < 3; ++k)
            bytes[3 * ((top + y) * width + left + x) + k] = texel_byte(value[k]);
        }
      for (const auto& [u, v] : {std::pair(0.0, 0.0), std::pair(1.0, 0.0), std::pair(0.0, 1.0)})
        uv.push_back({float((double(left) + 1.5 + u * span) / double(width)),
                      float(1 - (double(top) + 1.5 + v * span) / double(width))});
    }
    look_.material.texture = scene_.add_texture(uint32_t(width), uint32_t(width), bytes.data());
    return uv;
  }

  Shapes shapes_;
  Look look_;
  const Object& geometry_;
  std::shared_ptr<const Array> radii_;
  uint32_t id_;
  Scene& scene_;
  Part& part_;
  bool round_ends_;
  bool kept_all_ = false;
  std::vector<uint32_t> kept_;  // the primitives that are visible
  std::vector<std::array<float, 3>> colors_;
  std::vector<float> opacities_;
};
}  // namespace

const Range* Part::find(Kind kind, uint32_t index) const {
  for (const Range& r : ranges)
    if (r.kind == kind && index >= r.first && index - r.first < r.count) return &r;
  return nullptr;
}

void number_meshes(Part& part) {
  uint32_t own = 0;
  for (const Range& r : part.ranges)
    if (r.kind == Kind::triangle && !r.in_mesh) own += r.count;
  for (Range& r : part.ranges)
    if (r.in_mesh) r.first += own;
}

void add_surface(const Object& surface, const Object* instance, uint32_t id, Scene& scene,
                 Part& part, bool round_ends) {
  const auto geometry = surface.object("geometry"), material = surface.object("material");
  if (!geometry) return surface.warn("a surface has no 'geometry' and is left out");
  if (!material) return surface.warn("a surface has no 'material' and is left out");
  if (!geometry->info || !surface.is_on("visible", true)) return;
  try {
    Adder(surface, instance, id, scene, part, round_ends).add();
  } catch (const Error& error) {
    surface.device.report(geometry.get(), Severity::error, Status::invalid_argument,
                          fmt::format("{}; the surface is left out", error.what()));
  }
}

}  // namespace raio::device
