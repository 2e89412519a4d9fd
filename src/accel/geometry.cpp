#include "accel/geometry.h"

#include "shape/polygon.h"

namespace raio {
namespace {

template <class T>
size_t vector_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

// Which side of each primitive is seen; empty when it is both for all.
class SideList {
 public:
  SideList(const Scene& scene, bool one_sided) : scene_(scene), one_sided_(one_sided) {}

  void push(MaterialId material, bool inside_only = false) {
    const bool opaque = scene_.materials[material].transmission == 0;
    list_.push_back(inside_only            ? Sides::inside
                    : one_sided_ && opaque ? Sides::outside
                                           : Sides::both);
    restricted_ |= list_.back() != Sides::both;
  }
  std::vector<Sides> take() { return restricted_ ? std::move(list_) : std::vector<Sides>(); }

 private:
  const Scene& scene_;
  bool one_sided_;
  bool restricted_ = false;
  std::vector<Sides> list_;
};

class TriangleBaker {
 public:
  TriangleBaker(const Scene& scene, Geometry& out, bool one_sided)
      : scene_(scene), out_(out), sides_(scene, one_sided) {}

  void bake() {
    size_t count = scene_.triangles.size();
    for (const Polygon& p : scene_.polygons) count += p.count - 2;
    auto& t = out_.triangles;
    for (auto* corner : {&t.a, &t.b, &t.c})
      for (auto& axis : *corner) axis.reserve(count);
    t.facets.reserve(count);
    const bool smooth = !scene_.triangle_normals.empty();
    constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};

    for (size_t i = 0; i < scene_.triangles.size(); ++i) {
      const Triangle corners = at(scene_.triangles[i], 0);
      push(corners, triangle_normal(corners), scene_.triangle_materials[i],
           smooth ? scene_.triangle_normals[i] : kFlat);
    }
    for (size_t i = 0; i < scene_.polygons.size(); ++i) {
      const Polygon& p = scene_.polygons[i];
      const std::span corners(scene_.positions.data() + p.first, p.count);
      const Vec3f normal = polygon_normal(corners);
      for (const TriangleIndices& piece : triangulate(corners))
        push(at(piece, p.first), normal, scene_.polygon_materials[i], kFlat);
    }
    if (smooth) out_.normals = scene_.normals;
    out_.sides[size_t(ItemKind::triangle)] = sides_.take();
  }

 private:
  Triangle at(const TriangleIndices& i, uint32_t first) const {
    const auto& p = scene_.positions;
    return {p[first + i[0]], p[first + i[1]], p[first + i[2]]};
  }

  void push(const Triangle& t, Vec3f normal, MaterialId material, const TriangleIndices& normals) {
    if (triangle_normal(t) == Vec3f()) return;  // no area: no ray can hit it
    auto& soup = out_.triangles;
    for (int axis = 0; axis < 3; ++axis) {
      soup.a[axis].push_back(t.a[axis]);
      soup.b[axis].push_back(t.b[axis]);
      soup.c[axis].push_back(t.c[axis]);
    }
    soup.facets.push_back({normal, material});
    if (!scene_.triangle_normals.empty()) out_.triangle_normals.push_back(normals);
    sides_.push(material);
  }

  const Scene& scene_;
  Geometry& out_;
  SideList sides_;
};

}  // namespace

size_t Geometry::count(ItemKind kind) const {
  switch (kind) {
    case ItemKind::plane:
      return planes.size();
    case ItemKind::sphere:
      return spheres.radius.size();
    case ItemKind::triangle:
      return triangles.facets.size();
    case ItemKind::cone:
      return cones.size();
  }
  return 0;
}

Box3f Geometry::bounds(ItemId id) const {
  const uint32_t i = item_index(id);
  switch (item_kind(id)) {
    case ItemKind::sphere:
      return raio::bounds(sphere(i));
    case ItemKind::triangle:
      return raio::bounds(triangle(i));
    case ItemKind::cone:
      return raio::bounds(cones[i]);
    case ItemKind::plane:
      break;
  }
  return {};
}

size_t Geometry::bytes() const {
  size_t sum = vector_bytes(planes) + vector_bytes(plane_materials) + vector_bytes(spheres.x) +
               vector_bytes(spheres.y) + vector_bytes(spheres.z) + vector_bytes(spheres.radius) +
               vector_bytes(spheres.material) + vector_bytes(triangles.facets) +
               vector_bytes(triangle_normals) + vector_bytes(normals) + vector_bytes(cones) +
               vector_bytes(cone_materials);
  for (const auto* corner : {&triangles.a, &triangles.b, &triangles.c})
    for (const auto& axis : *corner) sum += vector_bytes(axis);
  for (const auto& s : sides) sum += vector_bytes(s);
  return sum;
}

Geometry bake(const Scene& scene, bool one_sided) {
  Geometry out;
  out.planes = scene.planes;
  out.plane_materials = scene.plane_materials;
  SideList plane_sides(scene, one_sided);
  for (const MaterialId m : scene.plane_materials) plane_sides.push(m);
  out.sides[size_t(ItemKind::plane)] = plane_sides.take();

  SideList sphere_sides(scene, one_sided);
  auto& s = out.spheres;
  for (auto* v : {&s.x, &s.y, &s.z, &s.radius}) v->reserve(scene.spheres.size());
  for (size_t i = 0; i < scene.spheres.size(); ++i) {
    const Sphere& sphere = scene.spheres[i];
    s.x.push_back(sphere.center.x);
    s.y.push_back(sphere.center.y);
    s.z.push_back(sphere.center.z);
    s.radius.push_back(std::abs(sphere.radius));
    sphere_sides.push(scene.sphere_materials[i], sphere.radius < 0);
  }
  s.material = scene.sphere_materials;
  out.sides[size_t(ItemKind::sphere)] = sphere_sides.take();

  TriangleBaker(scene, out, one_sided).bake();

  SideList cone_sides(scene, one_sided);
  out.cones.reserve(scene.cones.size());
  for (size_t i = 0; i < scene.cones.size(); ++i) {
    const Cone& cone = scene.cones[i];
    out.cones.emplace_back(cone);
    cone_sides.push(scene.cone_materials[i], cone.base_radius < 0 || cone.apex_radius < 0);
  }
  out.cone_materials = scene.cone_materials;
  out.sides[size_t(ItemKind::cone)] = cone_sides.take();
  return out;
}

}  // namespace raio
