#include "scene/scene.h"

#include <initializer_list>
#include <string_view>

#include "base/ray.h"
#include "shape/triangle.h"

namespace raio {
namespace {

/// Sentences about what is wrong, not more than anyone reads.
class Problems {
 public:
  template <class... Parts>
  void check(bool sound, const Parts&... parts) {
    if (sound) return;
    if (++count_ > kMost) return;
    std::string sentence;
    (append(sentence, parts), ...);
    sentences_.push_back(std::move(sentence));
  }

  std::vector<std::string> take() {
    if (count_ > kMost) sentences_.push_back(std::to_string(count_ - kMost) + " more problems");
    return std::move(sentences_);
  }

 private:
  static constexpr size_t kMost = 20;

  static void append(std::string& out, std::string_view part) { out += part; }
  static void append(std::string& out, size_t number) { out += std::to_string(number); }

  std::vector<std::string> sentences_;
  size_t count_ = 0;
};

bool at_least_zero(float x) { return std::isfinite(x) && x >= 0; }

bool is_intensity(Rgb c) { return at_least_zero(c.x) && at_least_zero(c.y) && at_least_zero(c.z); }

void check_camera(const Camera& camera, Problems& problems) {
  const bool finite = is_finite(camera.from) && is_finite(camera.at) && is_finite(camera.up);
  problems.check(finite, "camera: from, at and up must be finite");
  const std::string why = finite ? camera_problem(camera) : "";
  problems.check(why.empty(), "camera: ", why);
  problems.check(camera.fov_deg > 0 && camera.fov_deg < 180,
                 "camera: the angle must lie between 0 and 180 degrees");
  problems.check(std::isfinite(camera.hither), "camera: hither must be finite");
  problems.check(camera.width >= 0 && camera.height >= 0 && !camera.width == !camera.height,
                 "camera: the resolution must be two positive numbers, or two zeros for none");
  problems.check(!camera.lens_radius || at_least_zero(*camera.lens_radius),
                 "camera: the lens radius must not be negative");
  problems.check(!camera.focus_distance ||
                     (at_least_zero(*camera.focus_distance) && *camera.focus_distance > 0),
                 "camera: the focus distance must be positive");
}

void check_lights_and_materials(const Scene& scene, Problems& problems) {
  problems.check(is_intensity(scene.background),
                 "background: the colour must be finite and not negative");
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    problems.check(is_finite(light.position), "light ", i, ": the position must be finite");
    problems.check(!light.color || is_intensity(*light.color), "light ", i,
                   ": the colour must be finite and not negative");
  }
  problems.check(!scene.materials.empty(), "there is no material");
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    problems.check(is_intensity(m.color), "material ", i,
                   ": the colour must be finite and not negative");
    problems.check(at_least_zero(m.kd) && at_least_zero(m.ks) && at_least_zero(m.shine) &&
                       at_least_zero(m.transmission) && at_least_zero(m.ior),
                   "material ", i, ": Kd, Ks, Shine, T and ior must be finite and not negative");
    problems.check(!(m.transmission > 0) || m.ior > 0, "material ", i,
                   ": T is above 0, so ior must be too");
  }
}

/// One kind's pool beside its materials.
void check_pool(std::string_view kind, size_t count, const std::vector<MaterialId>& ids,
                size_t materials, Problems& problems) {
  problems.check(count <= kMaxPrimitivesPerKind, "there are ", count, " ", kind, "s, more than ",
                 size_t(kMaxPrimitivesPerKind));
  problems.check(ids.size() == count, "there are ", count, " ", kind, "s but ", ids.size(),
                 " materials for them");
  for (size_t i = 0; i < ids.size(); ++i)
    problems.check(ids[i] < materials, kind, " ", i, ": material ", size_t(ids[i]), " of ",
                   materials);
}

void check_pools(const Scene& scene, Problems& problems) {
  for_each_pool([&](auto pool) {
    check_pool(pool.name, (scene.*pool.shapes).size(), scene.*pool.materials,
               scene.materials.size(), problems);
  });
}

void check_shapes(const Scene& scene, Problems& problems) {
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kind != PrimitiveKind::triangle) {
      const auto& shapes = scene.*kPoolOf<PrimitiveType<kind>>.shapes;
      for (size_t i = 0; i < shapes.size(); ++i)
        check_shape(shapes[i], [&](bool sound, std::string_view expected) {
          problems.check(sound, kPrimitiveKindNames[size_t(kind)], " ", i, ": ", expected);
        });
    }
  });
}

void check_triangles(const Scene& scene, Problems& problems) {
  for (size_t i = 0; i < scene.positions.size(); ++i)
    problems.check(is_finite(scene.positions[i]), "position ", i, ": must be finite");
  for (size_t i = 0; i < scene.normals.size(); ++i)
    problems.check(is_finite(scene.normals[i]) && is_unit(scene.normals[i]), "normal ", i,
                   ": must have length 1");
  for (size_t i = 0; i < scene.triangles.size(); ++i)
    for (const uint32_t corner : scene.triangles[i])
      problems.check(corner < scene.positions.size(), "triangle ", i, ": corner ", size_t(corner),
                     " of ", scene.positions.size(), " positions");
  problems.check(
      scene.triangle_normals.empty() || scene.triangle_normals.size() == scene.triangles.size(),
      "there are ", scene.triangles.size(), " triangles but ", scene.triangle_normals.size(),
      " triples of normals");
  constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
  for (size_t i = 0; i < scene.triangle_normals.size(); ++i) {
    if (scene.triangle_normals[i] == kFlat) continue;
    for (const uint32_t normal : scene.triangle_normals[i])
      problems.check(normal < scene.normals.size(), "triangle ", i, ": normal ", size_t(normal),
                     " of ", scene.normals.size());
  }
  for (size_t i = 0; i < scene.polygons.size(); ++i) {
    const Polygon& polygon = scene.polygons[i];
    problems.check(polygon.count >= 4, "polygon ", i, ": ", size_t(polygon.count),
                   " corners, fewer than 4");
    problems.check(size_t(polygon.first) + polygon.count <= scene.positions.size(), "polygon ", i,
                   ": corners up to ", size_t(polygon.first) + polygon.count, " of ",
                   scene.positions.size(), " positions");
  }
}

}  // namespace

std::array<size_t, kShapeKinds> count_primitives(const Scene& scene) {
  std::array<size_t, kShapeKinds> counts{};
  for_each_pool([&](auto pool) {
    for (const auto& shape : scene.*pool.shapes) ++counts[size_t(shape_kind(shape))];
  });
  return counts;
}

Box3f bounds(const Scene& scene) {
  Box3f box;
  for_each_bounded_kind([&]<PrimitiveKind kind> {
    if constexpr (kind != PrimitiveKind::triangle)
      for (const auto& shape : scene.*kPoolOf<PrimitiveType<kind>>.shapes)
        box.extend(bounds(bake(shape)));
  });
  // By index, as a position may belong to nothing.
  for (const TriangleIndices& triangle : scene.triangles)
    for (const uint32_t corner : triangle) box.extend(scene.positions[corner]);
  for (const Polygon& polygon : scene.polygons)
    for (uint32_t i = 0; i < polygon.count; ++i)
      box.extend(scene.positions[size_t(polygon.first) + i]);
  return box;
}

size_t memory_bytes(const Scene& scene) {
  const auto bytes = [](const auto& column) { return column.size() * sizeof(*column.data()); };
  size_t sum = bytes(scene.lights) + bytes(scene.materials) + bytes(scene.positions) +
               bytes(scene.normals) + bytes(scene.triangle_normals);
  for_each_pool(
      [&](auto pool) { sum += bytes(scene.*pool.shapes) + bytes(scene.*pool.materials); });
  return sum;
}

std::string camera_problem(const Camera& camera) {
  const Vec3d view = Vec3d(camera.at) - Vec3d(camera.from), up(camera.up);
  if (!(length(view) > 0)) return "from and at are the same point";
  if (!(length(up) > 0)) return "up is zero";
  if (!(length(cross(view, up)) > 1e-7 * length(view) * length(up)))
    return "up is parallel to the line of sight";
  return {};
}

std::vector<std::string> validate(const Scene& scene) {
  Problems problems;
  problems.check(is_finite(scene.origin), "the origin must be finite");
  problems.check(scene.samples_per_pixel >= 0, "the samples per pixel must not be negative");
  check_camera(scene.camera, problems);
  check_lights_and_materials(scene, problems);
  check_pools(scene, problems);
  check_shapes(scene, problems);
  check_triangles(scene, problems);
  return problems.take();
}

}  // namespace raio
