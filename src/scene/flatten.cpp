// Converts instances to primitives, for code without instancing.
#include <algorithm>
#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/platform/memory.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

// The transformed shape; nothing if it is not of the same kind.
std::optional<Sphere> moved(const Sphere& s, const Placement& by) {
  if (by.scale() == 0) return std::nullopt;
  return Sphere{Vec3f(by.point(Vec3d(s.center))), float(by.scale() * double(s.radius))};
}
std::optional<Cone> moved(const Cone& c, const Placement& by) {
  if (by.scale() == 0) return std::nullopt;
  Cone out = c;
  out.base = Vec3f(by.point(Vec3d(c.base))), out.apex = Vec3f(by.point(Vec3d(c.apex)));
  out.base_radius = float(by.scale() * double(c.base_radius));
  out.apex_radius = float(by.scale() * double(c.apex_radius));
  return out;
}
std::optional<Ellipsoid> moved(const Ellipsoid& e, const Placement& by) {
  if (by.scale() == 0) return std::nullopt;
  Ellipsoid out = e;
  out.center = Vec3f(by.point(Vec3d(e.center)));
  for (Vec3f& axis : out.axes) axis = Vec3f(by.vector(Vec3d(axis)));
  return out;
}
std::optional<Disc> moved(const Disc& disc, const Placement& by) {
  if (by.scale() == 0) return std::nullopt;
  Disc out = disc;
  out.center = Vec3f(by.point(Vec3d(disc.center)));
  out.normal = Vec3f(by.normal(Vec3d(disc.normal)));
  out.radius = float(by.scale() * double(disc.radius));
  out.inner = float(by.scale() * double(disc.inner));
  return out;
}
template <class Shape>  // validate() excludes these from objects
std::optional<Shape> moved(const Shape& shape, const Placement&) {
  return shape;
}

// Keeps the front of a mirrored triangle in front.
TriangleIndices turned(const TriangleIndices& t, bool mirrored) {
  return mirrored ? TriangleIndices{t[0], t[2], t[1]} : t;
}

// Appends a column parallel to a pool of `before` elements, which gets `count` more. If only one of
// the two has values, the others get their materials' `usual` value.
template <class T, class Usual>
void append(StridedArray<T>& to, const StridedArray<MaterialId>& materials, size_t before,
            const StridedArray<T>& from, size_t count, const Usual& usual) {
  if (to.empty() && from.empty()) return;
  const bool had = !to.empty();
  to.resize(before + count);
  T* const out = to.data();
  for (size_t i = had ? before : 0; i < before + count; ++i)
    out[i] = i < before || from.empty() ? usual(materials[i]) : from[i - before];
}

class Flattener {
 public:
  explicit Flattener(Scene& scene) : scene_(scene) {}

  // Adds all of `object`, transformed by the matrix. It belongs to `owner` or, if that is 0, to its
  // owner within the object.
  void add(const Object& object, const Matrix& matrix, uint32_t owner) {
    check_stop();
    const Placement by(matrix);
    const size_t positions = scene_.positions.size();
    StopCheck look;
    for (const Vec3f p : object.positions) {
      look();
      scene_.positions.push_back(Vec3f(by.point(Vec3d(p))));
    }
    add_normals(object, by);
    for_each_pool([&](auto pool) {
      add_ranges(object, pool.kind, (scene_.*pool.shapes).size(), (object.*pool.shapes).size(),
                 owner);
      add_pool(object, pool, by, uint32_t(positions));
    });
    add_ranges(object, PoolKind::mesh, scene_.meshes.size(), object.meshes.size(), owner);
    for (const Mesh& mesh : object.meshes) {
      Mesh& out = scene_.meshes.emplace_back(mesh);
      for (Vec3f& p : out.positions) p = Vec3f(by.point(Vec3d(p)));
      for (Vec3f& n : out.normals) n = Vec3f(by.normal(Vec3d(n)));
      const bool mirrored = by.determinant() < 0;
      for (TriangleIndices& t : out.triangles) t = turned(t, mirrored);
      for (TriangleIndices& t : out.normal_indices) t = turned(t, mirrored);
    }
    for (size_t i = 0; i < object.instances.size(); ++i) {
      const Instance& copy = object.instances[i];
      add(object.prototypes[copy.prototype], joined(matrix, copy.matrix),
          owner ? owner : object_of(object, PoolKind::instance, i));
    }
  }
  // Call at the end.
  void sort_ranges() {
    Array<ObjectRange>& all = scene_.object_ranges;
    if (all.empty()) return;
    std::sort(all.data(), all.data() + all.size(), [](const ObjectRange& a, const ObjectRange& b) {
      return std::pair(a.pool, a.first) < std::pair(b.pool, b.first);
    });
  }
  const std::string& error() const { return error_; }

 private:
  void add_normals(const Object& object, const Placement& by) {
    const auto first = uint32_t(scene_.normals.size());
    StopCheck look;
    for (const Vec3f n : object.normals) {
      look();
      scene_.normals.push_back(Vec3f(by.normal(Vec3d(n))));
    }
    auto& to = scene_.triangle_normals;
    const auto& from = object.triangle_normals;
    if (to.empty() && from.empty()) return;
    constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
    to.resize(scene_.triangles.size(), kFlat);
    for (TriangleIndices at : from) {
      look();
      for (uint32_t& n : at)
        if (n != kNoNormal) n += first;
      to.push_back(turned(at, by.determinant() < 0));
    }
    to.resize(scene_.triangles.size() + object.triangles.size(), kFlat);
  }

  // Reverses the order of their vertices.
  void turn(std::span<Polygon> polygons) {
    Array<Vec3f>& positions = scene_.positions;
    for (Polygon& polygon : polygons) {
      const auto first = uint32_t(positions.size());
      for (uint32_t i = polygon.count; i-- > 0;) positions.push_back(positions[polygon.first + i]);
      polygon.first = first;
    }
  }

  // The object ranges of `count` elements of a pool after the first `before`.
  void add_ranges(const Object& object, PoolKind pool, size_t before, size_t count,
                  uint32_t owner) {
    if (owner && count > 0)
      scene_.object_ranges.push_back({pool, uint32_t(before), uint32_t(count), owner});
    if (owner) return;
    for (ObjectRange range : object.object_ranges) {
      if (range.pool != pool) continue;
      range.first += uint32_t(before);
      scene_.object_ranges.push_back(range);
    }
  }

  template <class Shape>
  void add_pool(const Object& object, PoolMembers<Shape> pool, const Placement& by,
                uint32_t positions) {
    const auto& from = object.*pool.shapes;
    const size_t count = from.size(), before = (scene_.*pool.shapes).size();
    if (count == 0) return;
    (scene_.*pool.shapes).resize(before + count);
    (scene_.*pool.materials).resize(before + count);
    Shape* const shapes = (scene_.*pool.shapes).data() + before;
    MaterialId* const materials = (scene_.*pool.materials).data() + before;
    const bool mirrored = by.determinant() < 0;
    std::atomic<bool> lost = false;
    for_each_index(count, [&](size_t i) {
      materials[i] = (object.*pool.materials)[i];
      shapes[i] = from[i];
      if constexpr (std::is_same_v<Shape, TriangleIndices>) {
        shapes[i] = turned(from[i], mirrored);
        for (uint32_t& corner : shapes[i]) corner += positions;
      } else if constexpr (std::is_same_v<Shape, Polygon>) {
        shapes[i].first += positions;
      } else if (const auto shape = moved(from[i], by)) {
        shapes[i] = *shape;
      } else {
        lost.store(true, std::memory_order_relaxed);
      }
    });
    if constexpr (std::is_same_v<Shape, Polygon>)
      if (mirrored) turn(std::span(shapes, count));
    const auto& ids = scene_.*pool.materials;
    append(scene_.*pool.colors, ids, before, object.*pool.colors, count,
           [&](MaterialId id) { return scene_.materials[id].color; });
    append(scene_.*pool.opacity, ids, before, object.*pool.opacity, count, [&](MaterialId id) {
      return scene_.material_opacity.empty() ? 1 : scene_.material_opacity[id];
    });
    if (lost)
      error_ = "instances of " + std::string(kPoolNames[size_t(pool.kind)]) +
               "s have a non-uniform scale, and such shapes cannot become primitives";
  }

  Scene& scene_;
  std::string error_;
};

// The size of an object with its instances converted to primitives, bytes.
double flat_bytes(const Object& scene) {
  std::vector<double> of_one;
  of_one.reserve(scene.prototypes.size());
  double sum = double(memory_bytes(scene));
  for (const Object& object : scene.prototypes) of_one.push_back(flat_bytes(object));
  for (const Instance& copy : scene.instances) sum += of_one[copy.prototype];
  return sum;
}

}  // namespace

std::string flatten_instances(Scene& scene) {
  if (scene.instances.empty()) {
    scene.prototypes.clear();  // no instances are left
    return {};
  }
  const AvailableMemory available = available_memory();
  if (const double bytes = flat_bytes(scene); bytes > 0.5 * double(available.bytes))
    return "its instances as primitives would take " + std::to_string(uint64_t(bytes * 1e-9) + 1) +
           " GB and " + available.text();
  const StridedArray<Instance> copies = std::move(scene.instances);
  const std::vector<Object> objects = std::move(scene.prototypes);
  const Array<ObjectRange> ranges = std::move(scene.object_ranges);
  scene.instances = {}, scene.prototypes.clear(), scene.object_ranges = {};
  std::vector<uint32_t> owners(copies.size());
  for (const ObjectRange& range : ranges)
    if (range.pool == PoolKind::instance)
      std::fill_n(owners.begin() + range.first, range.count, range.object);
    else
      scene.object_ranges.push_back(range);
  Flattener flattener(scene);
  for (size_t i = 0; i < copies.size(); ++i)
    flattener.add(objects[copies[i].prototype], copies[i].matrix, owners[i]);
  flattener.sort_ranges();
  return flattener.error();
}

}  // namespace raio::core
