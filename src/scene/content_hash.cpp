#include <bit>
#include <cstring>

#include "base/hash.h"
#include "scene/scene.h"

namespace raio {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pools are hashed as they lie in memory, which other machines shall agree with");

/// Gathers plain values, whose bytes all count.
class Gatherer {
 public:
  template <class... T>
  void add(const T&... values) {
    (bytes_.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  }
  // An element is `kNumbers` numbers of four bytes with nothing between them.
  template <size_t kNumbers, class T>
  void add_pool(const std::vector<T>& pool) {
    static_assert(sizeof(T) == 4 * kNumbers);
    add(uint64_t(pool.size()),
        hash128({reinterpret_cast<const char*>(pool.data()), pool.size() * sizeof(T)}));
  }
  void add_text(std::string_view text) {
    add(uint64_t(text.size()));
    bytes_ += text;
  }
  template <class T>
  void add_optional(const std::optional<T>& value) {
    add(uint32_t(value.has_value()), value.value_or(T()));
  }

  std::string name() const { return hex(hash128(bytes_)); }

 private:
  std::string bytes_;
};

}  // namespace

std::string content_hash(const Scene& s) {
  Gatherer all;
  const Camera& camera = s.camera;
  all.add(s.origin, camera.from, camera.at, camera.up, camera.fov_deg);
  all.add(camera.width, camera.height, s.samples_per_pixel, s.background);
  all.add_optional(camera.lens_radius);
  all.add_optional(camera.focus_distance);
  for (const Light& light : s.lights) {
    all.add(light.position);
    all.add_optional(light.color);
  }
  all.add(uint64_t(s.lights.size()));
  all.add_pool<8>(s.materials);
  all.add_pool<6>(s.planes);
  all.add_pool<1>(s.plane_materials);
  all.add_pool<4>(s.spheres);
  all.add_pool<1>(s.sphere_materials);
  all.add_pool<8>(s.cones);
  all.add_pool<1>(s.cone_materials);
  all.add_pool<3>(s.positions);
  all.add_pool<3>(s.normals);
  all.add_pool<3>(s.triangles);
  all.add_pool<1>(s.triangle_materials);
  all.add_pool<3>(s.triangle_normals);
  all.add_pool<2>(s.polygons);
  all.add_pool<1>(s.polygon_materials);
  // Kinds that came later count only where a scene has them, so that scenes without them keep
  // their names.
  for_each_pool([&](auto pool) {
    using Shape = std::remove_cvref_t<decltype((s.*pool.shapes)[0])>;
    if constexpr (!std::is_same_v<Shape, Plane> && !std::is_same_v<Shape, Sphere> &&
                  !std::is_same_v<Shape, Cone> && !std::is_same_v<Shape, TriangleIndices> &&
                  !std::is_same_v<Shape, Polygon>) {
      if ((s.*pool.shapes).empty()) return;
      all.add_text(pool.name);
      all.add_pool<sizeof(Shape) / 4>(s.*pool.shapes);
      all.add_pool<1>(s.*pool.materials);
    }
  });
  return all.name();
}

}  // namespace raio
