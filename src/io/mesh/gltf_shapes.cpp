#include "io/mesh/gltf_shapes.h"

#include <map>
#include <numbers>
#include <utility>

#include "base/exact_math.h"

namespace raio::core::gltf {
namespace {

/// A frustum between two rings of `sides` + 1 points, so that each face has its own normal at an
/// apex.
Surface between_rings(double y0, double r0, double y1, double r1, Vec3d normal_at_x, int sides) {
  Surface out;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const double c = exact_cos(angle), s = exact_sin(angle);
    const Vec3d normal(normal_at_x.x * c, normal_at_x.y, normal_at_x.x * s);
    for (const auto& [y, r] : {std::pair(y0, r0), std::pair(y1, r1)}) {
      out.positions.push_back(Vec3f(Vec3d(r * c, y, r * s)));
      out.normals.push_back(Vec3f(normalize(normal)));
    }
    const auto a = uint32_t(2 * i), b = uint32_t(2 * ((i + 1) % sides));
    if (r1 > 0) out.triangles.push_back({a, a + 1, b + 1});
    if (r0 > 0) out.triangles.push_back({a, b + 1, b});
  }
  return out;
}

std::array<double, 4> rotation_of_y(Vec3d to) {
  const Vec3d y = normalize(to);
  const Frame<double> frame(y);
  return rotation_to(frame.v, y, frame.u);
}

// An icosahedron with each face subdivided into four, repeatedly.
Surface unit_sphere(int splits) {
  const double t = std::numbers::phi;
  std::vector<Vec3d> at = {{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                           {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                           {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
  std::vector<TriangleIndices> faces = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (; splits > 0; --splits) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [known, is_new] = middles.try_emplace(std::minmax(a, b), uint32_t(at.size()));
      if (is_new) at.push_back(normalize(normalize(at[a]) + normalize(at[b])));
      return known->second;
    };
    std::vector<TriangleIndices> finer;
    for (const auto& [a, b, c] : faces) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  Surface out;
  for (const Vec3d p : at) out.positions.push_back(Vec3f(normalize(p)));
  out.normals = out.positions;
  out.triangles = std::move(faces);
  return out;
}

Surface unit_frustum(double apex, int sides) {
  return between_rings(0, 1, 1, apex, {1, 1 - apex, 0}, sides);
}

Surface unit_ring(double inner, int sides) {
  return between_rings(0, 1, 0, inner, {0, 1, 0}, sides);
}

}  // namespace

Surface surface_of(const UnitShape& shape, int detail) {
  const int sides = 8 << detail;
  switch (shape.kind) {
    case UnitShape::Kind::sphere:
      return unit_sphere(detail);
    case UnitShape::Kind::frustum:
      return unit_frustum(shape.ratio, sides);
    default:
      return unit_ring(shape.ratio, sides);
  }
}

size_t triangles_of(const UnitShape& shape, int detail) {
  const size_t sides = size_t(8) << detail;
  if (shape.kind == UnitShape::Kind::sphere) return size_t(20) << (2 * detail);
  return shape.ratio > 0 ? 2 * sides : sides;
}

PlacedShape placed(const Sphere& s) {
  const Vec3d radius(std::abs(double(s.radius)));
  return {{UnitShape::Kind::sphere}, {Vec3d(s.center), {0, 0, 0, 1}, radius}};
}

PlacedShape placed(const Cone& c) {
  Vec3d base(c.base), apex(c.apex);
  double at_base = std::abs(double(c.base_radius)), at_apex = std::abs(double(c.apex_radius));
  if (at_base < at_apex) std::swap(base, apex), std::swap(at_base, at_apex);
  const Vec3d along = apex - base;
  return {{UnitShape::Kind::frustum, at_apex / at_base},
          {base, rotation_of_y(along), {at_base, length(along), at_base}}};
}

PlacedShape placed(const Disc& d) {
  const double radius = d.radius;
  return {{UnitShape::Kind::ring, double(d.inner) / radius},
          {Vec3d(d.center), rotation_of_y(Vec3d(d.normal)), {radius, 1, radius}}};
}

PlacedShape placed(const Ellipsoid& e) {
  const Vec3d x(e.axes[0]), y(e.axes[1]);
  const Vec3d ex = normalize(x), ez = normalize(cross(x, y));
  return {{UnitShape::Kind::sphere},
          {Vec3d(e.center),
           rotation_to(ex, cross(ez, ex), ez),
           {length(x), length(y), length(Vec3d(e.axes[2]))}}};
}

PlacedShape placed(const MovingSphere& s) { return placed(at_time(s, s.begin)); }

}  // namespace raio::core::gltf
