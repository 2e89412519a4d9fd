#include "io/pov_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>
#include <unordered_map>

#include "base/exact_math.h"
#include "io/fit_camera.h"
#include "io/plain_scene.h"

namespace raio::core {
namespace {

template <class T>
std::string text(Vec3<T> v) {
  return fmt::format("<{}, {}, {}>", v.x, v.y, v.z);
}

// A primitive of one of the pools.
struct Item {
  MaterialId material;
  PoolKind pool;
  uint32_t index;
};

class PovWriter {
 public:
  explicit PovWriter(const Scene& scene)
      : scene_(scene), is_figure_(scene.dialect == Dialect::data && scene.lights.empty()) {}

  std::string write(const PovPicture& picture, std::string_view comment) {
    header(picture, comment);
    camera(picture);
    lights();
    for (MaterialId i = 0; i < scene_.materials.size(); ++i) material(i);
    const std::vector<Item> items = by_material();
    for (auto first = items.begin(); first != items.end();) {
      const auto last = std::find_if(first, items.end(),
                                     [&](const Item& i) { return i.material != first->material; });
      objects({first, last});
      first = last;
    }
    return std::move(out_);
  }

 private:
  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
    out_ += '\n';
  }

  // No attenuation by depth in the ray tree, and no gamma for numbers.
  void header(const PovPicture& p, std::string_view comment) {
    if (!comment.empty()) line("// {}", comment);
    // POV-Ray bounds objects in floats, which cuts off parts far from 0.
    if (scene_.origin != Vec3d())
      line("#declare Origin = {};  // all coordinates are relative to it", text(scene_.origin));
    line("// povray +I{0}.pov +O{0}.png +W{1} +H{2} {3} -D", p.name, p.width, p.height,
         is_figure_ ? "+A0.1" : "File_Gamma=1.0 -A");
    line("#version 3.7;");
    line(
        "global_settings {{ assumed_gamma 1 ambient_light rgb 1 max_trace_level {} adc_bailout 0 "
        "}}",
        p.depth);
    line("background {{ rgb {} }}", text(is_figure_ ? Rgb(1) : scene_.background));
  }

  // By its vectors, with the lengths of the picture at distance 1, or at any distance for parallel
  // rays: nothing depends on POV-Ray's handedness.
  void camera(const PovPicture& p) {
    const Camera& c = scene_.camera;
    const Vec3d view = Vec3d(c.at) - Vec3d(c.from), forward = normalize(view);
    const Vec3d right = normalize(cross(forward, Vec3d(c.up))), up = cross(right, forward);
    const double angle = double(fitted_fov_deg(c, p.width, p.height)) * std::numbers::pi / 180;
    const double height = 2 * exact_tan(angle / 2) * (c.is_parallel() ? length(view) : 1);
    line("camera {{ {} location {}\n  direction {}\n  right {}\n  up {} }}",
         c.is_parallel() ? "orthographic" : "perspective", text(c.from), text(forward),
         text(right * (height * p.width / p.height)), text(up * height));
  }

  void lights() {
    if (is_figure_) return key_light();
    const auto& all = scene_.lights;
    colored_ = std::ranges::any_of(all, [](const Light& l) { return l.color.has_value(); });
    const Rgb uncolored(float(1 / std::sqrt(double(std::max<size_t>(1, all.size())))));
    for (const Light& l : all)
      line("light_source {{ {} rgb {} }}", text(l.position), text(l.color.value_or(uncolored)));
  }

  // Data has no lights: those of the style `paper` (integrate/figure.h), with an unobstructed sky.
  static constexpr double kSky = 0.6, kKey = 0.6;
  void key_light() {
    const Camera& c = scene_.camera;
    const Vec3d forward = normalize(Vec3d(c.at) - Vec3d(c.from));
    const Vec3d right = normalize(cross(forward, Vec3d(c.up))), up = cross(right, forward);
    const Vec3d to_key = normalize(right * -0.45 + up * 0.7 - forward * 0.75);
    const double far = 100 * length(Vec3d(c.at) - Vec3d(c.from));
    line("light_source {{ {} rgb {} parallel point_at {} }}", text(Vec3d(c.at) + to_key * far),
         kKey, text(c.at));
  }

  // POV-Ray reduces ambient and diffuse light by the pigment's transmittance; the classic shading
  // does not, so they are increased here.
  void material(MaterialId id) {
    const Material& m = scene_.materials[id];
    const bool p3f = scene_.dialect == Dialect::p3f, divides = p3f && m.transmission > 0;
    const double transmit = std::min(divides ? 1.0 : double(m.transmission), 0.999999);
    const double part = 1 / (1 - transmit);
    line("#declare M{} = texture {{ pigment {{ rgb {} transmit {} }}", id, text(m.color),
         float(transmit));
    const std::string mirror = divides ? "0, 1 fresnel on"
                               : scene_.material_specular.empty()
                                   ? fmt::format("{}", m.ks)
                                   : "rgb " + text(scene_.specular_of(id) * m.ks);
    // Blinn's highlight, or Phong's.
    const std::string highlight =
        p3f ? fmt::format("specular {} roughness {}", m.ks, 1 / std::max(m.shine, 1e-6f))
            : fmt::format("phong {} phong_size {}", m.ks, m.shine);
    line("  finish {{ ambient {} diffuse {} {} reflection {{ {} }}{} }} }}",
         float((is_figure_        ? kSky
                : p3f || colored_ ? 0
                                  : 0.1) *
               part),
         float(double(m.kd) * part), highlight, mirror, divides ? " conserve_energy" : "");
  }

  std::vector<Item> by_material() const {
    std::vector<Item> items;
    for_each_pool([&](auto pool) {
      const auto& materials = scene_.*pool.materials;
      for (uint32_t i = 0; i < materials.size(); ++i) items.push_back({materials[i], pool.kind, i});
    });
    std::ranges::sort(items, {},
                      [](const Item& i) { return std::tuple(i.material, i.pool, i.index); });
    return items;
  }

  // Shapes of one material. Glass is one object, so that POV-Ray knows which surface leads out of
  // which medium. Its shadow is that of an opaque one, since in the classic shading everything
  // blocks light.
  void objects(std::span<const Item> items) {
    const MaterialId id = items.front().material;
    const Material& m = scene_.materials[id];
    if (m.transmission == 0) return shapes(items, fmt::format(" texture {{ M{} }}", id));
    line("#declare Glass{} = union {{", id);
    shapes(items, "");
    line("}}");
    line("object {{ Glass{0} texture {{ M{0} }} interior {{ ior {1} }} no_shadow }}", id, m.ior);
    line("object {{ Glass{} pigment {{ rgb 0 }} no_image no_reflection }}", id);
  }

  // `texture`: appended to each shape.
  void shapes(std::span<const Item> items, const std::string& texture) {
    std::vector<uint32_t> flat, smooth;
    for (const Item& item : items) {
      if (item.pool == PoolKind::triangle)
        (is_smooth(item.index) ? smooth : flat).push_back(item.index);
      else
        for_each_pool([&]<class Shape>(PoolMembers<Shape> pool) {
          if constexpr (!std::is_same_v<Shape, TriangleIndices>)
            if (item.pool == pool.kind) shape((scene_.*pool.shapes)[item.index], texture);
        });
    }
    mesh(flat, false, texture);
    mesh(smooth, true, texture);
  }

  void shape(const Plane& p, const std::string& texture) {
    const double distance = dot(Vec3d(p.normal), Vec3d(p.point));
    line("plane {{ {}, {}{} }}", text(p.normal), distance, texture);
  }
  void shape(const Sphere& s, const std::string& texture) {
    line("sphere {{ {}, {}{} }}", text(s.center), std::abs(s.radius), texture);
  }
  void shape(const Cone& c, const std::string& texture) {
    const float base = std::abs(c.base_radius), apex = std::abs(c.apex_radius);
    if (base == apex)
      line("cylinder {{ {}, {}, {} open{} }}", text(c.base), text(c.apex), base, texture);
    else
      line("cone {{ {}, {}, {}, {} open{} }}", text(c.base), base, text(c.apex), apex, texture);
  }

  // The unit sphere, transformed by the matrix with the semi-axes as columns; POV-Ray writes it
  // column by column, with the translation last.
  void shape(const Ellipsoid& e, const std::string& texture) {
    const auto numbers = [](Vec3f v) { return fmt::format("{}, {}, {}", v.x, v.y, v.z); };
    line("sphere {{ 0, 1 matrix <{}, {}, {}, {}>{} }}", numbers(e.axes[0]), numbers(e.axes[1]),
         numbers(e.axes[2]), numbers(e.center), texture);
  }
  void shape(const Disc& d, const std::string& texture) {
    line("disc {{ {}, {}, {}, {}{} }}", text(d.center), text(d.normal), d.radius, d.inner, texture);
  }
  // POV-Ray has no moving primitives: uses the start.
  void shape(const MovingSphere& s, const std::string& texture) {
    shape(at_time(s, s.begin), texture);
  }
  void shape(const MovingTriangle& t, const std::string& texture) {
    line("triangle {{ {}, {}, {}{} }}", text(t.from.a), text(t.from.b), text(t.from.c), texture);
  }
  void shape(const Polygon& p, const std::string& texture) {
    fmt::format_to(std::back_inserter(out_), "polygon {{ {}", p.count + 1);
    for (uint32_t k = 0; k <= p.count; ++k)
      out_ += ", " + text(scene_.positions[p.first + k % p.count]);
    line("{} }}", texture);
  }

  bool is_smooth(uint32_t triangle) const {
    return !scene_.triangle_normals.empty() && scene_.triangle_normals[triangle][0] != kNoNormal;
  }

  void mesh(const std::vector<uint32_t>& triangles, bool smooth, const std::string& texture) {
    if (triangles.empty()) return;
    const Lists corners = lists(triangles, scene_.triangles, scene_.positions);
    Lists normals;
    if (smooth) normals = lists(triangles, scene_.triangle_normals, scene_.normals);
    line("mesh2 {{");
    line(" vertex_vectors {{ {} }}", corners.vectors);
    if (smooth) line(" normal_vectors {{ {} }}", normals.vectors);
    line(" face_indices {{ {} }}", corners.indices);
    if (smooth) line(" normal_indices {{ {} }}", normals.indices);
    line("{} }}", texture);
  }

  // The vectors of a pool used by the triangles, renumbered, with the new indices.
  struct Lists {
    std::string vectors, indices;
  };
  static Lists lists(const std::vector<uint32_t>& triangles, const Array<TriangleIndices>& corners,
                     const Array<Vec3f>& pool) {
    std::unordered_map<uint32_t, size_t> number;
    std::string named, faces;
    for (const uint32_t t : triangles) {
      for (const uint32_t corner : corners[t])
        if (number.try_emplace(corner, number.size()).second) named += ",\n " + text(pool[corner]);
      fmt::format_to(std::back_inserter(faces), ",\n <{}, {}, {}>", number[corners[t][0]],
                     number[corners[t][1]], number[corners[t][2]]);
    }
    return {std::to_string(number.size()) + named, std::to_string(triangles.size()) + faces};
  }

  const Scene& scene_;
  const bool is_figure_;  // for data, which Raio lights itself
  bool colored_ = false;
  std::string out_;
};

}  // namespace

std::string write_pov(const Scene& scene, const PovPicture& picture, std::string_view comment) {
  if (!is_plain(scene)) return write_pov(plain_scene(scene), picture, comment);
  return PovWriter(scene).write(picture, comment);
}

}  // namespace raio::core
