#include "scene/scene.h"

#include <algorithm>
#include <tuple>

#include "scene/columns.h"
#include "shape/triangle.h"

namespace raio::core {
namespace {

std::string plural(size_t count, std::string_view noun) {
  std::string text = std::to_string(count) + " " + std::string(noun);
  if (count != 1) text += noun == "mesh" ? "es" : "s";
  return text;
}

void extend_by_copies(Box3f& box, const Object& scene, const Matrix* matrix);

// The bounds of the object transformed by `matrix`; null: untransformed.
Box3f bounds_of(const Object& scene, const Matrix* matrix) {
  const Placement place(matrix ? *matrix : kIdentity);
  const double scale = place.scale();
  Box3f box;
  const auto add_point = [&](Vec3f p) { box.extend(matrix ? Vec3f(place.point(Vec3d(p))) : p); };
  // Bounds all spheres, rounded once, which is several times faster.
  Box3d of_spheres;
  if (!matrix)
    for (const Sphere& sphere : scene.spheres) of_spheres.extend(exact_bounds(sphere));
  if (!of_spheres.empty()) box = rounded_out(of_spheres);
  for_each_bounded_kind([&]<PrimitiveKind kind> {
    if constexpr (kind == PrimitiveKind::sphere)
      if (!matrix) return;
    if constexpr (kind != PrimitiveKind::triangle)
      for (const auto& shape : scene.*kPoolOf<PrimitiveType<kind>>.shapes) {
        const Box3f own = bounds(bake(shape));
        if (!matrix)
          box.extend(own);
        else if (std::is_same_v<PrimitiveType<kind>, Sphere> && scale > 0)
          box.extend(bounds(Sphere{Vec3f(place.point(Vec3d(own.center()))),
                                   float(scale * double(own.size().x) / 2)}));
        else
          box.extend(rounded_out(place.box(own)));
      }
  });
  // By index, as a position may be unused.
  for (const TriangleIndices& triangle : scene.triangles)
    for (const uint32_t corner : triangle) add_point(scene.positions[corner]);
  for (const Polygon& polygon : scene.polygons)
    for (uint32_t i = 0; i < polygon.count; ++i)
      add_point(scene.positions[size_t(polygon.first) + i]);
  for (const Mesh& mesh : scene.meshes)
    for (const TriangleIndices& triangle : mesh.triangles)
      for (const uint32_t corner : triangle) add_point(mesh.positions[corner]);
  extend_by_copies(box, scene, matrix);
  return box;
}

// Descends into an instance only if the bounds of its object extend beyond the box; in a large
// assembly most do not. Those that extend furthest come first.
void extend_by_copies(Box3f& box, const Object& scene, const Matrix* matrix) {
  std::vector<Box3f> of_object;
  of_object.reserve(scene.prototypes.size());
  for (const Object& object : scene.prototypes) of_object.push_back(bounds_of(object, nullptr));
  std::vector<Matrix> matrices;
  matrices.reserve(scene.instances.size());
  std::vector<Box3d> reach;
  for (const Instance& copy : scene.instances) {
    matrices.push_back(matrix ? joined(*matrix, copy.matrix) : copy.matrix);
    Box3d outer = Placement(matrices.back()).box(of_object[copy.prototype]);
    // More than rounding, and than the tolerance of a uniform scale.
    const Vec3d slack = (outer.hi - outer.lo) * 1e-3 + (abs(outer.lo) + abs(outer.hi)) * 1e-6;
    reach.push_back({outer.lo - slack, outer.hi + slack});
  }
  const auto look_into = [&](size_t i) {
    for (int axis = 0; axis < 3; ++axis)
      if (!(reach[i].lo[axis] >= double(box.lo[axis]) && reach[i].hi[axis] <= double(box.hi[axis])))
        return box.extend(bounds_of(scene.prototypes[scene.instances[i].prototype], &matrices[i]));
  };
  for (int axis = 0; axis < 3 && !reach.empty(); ++axis) {
    const auto low = [&](const Box3d& b) { return b.lo[axis]; };
    const auto high = [&](const Box3d& b) { return b.hi[axis]; };
    look_into(size_t(std::ranges::min_element(reach, {}, low) - reach.begin()));
    look_into(size_t(std::ranges::max_element(reach, {}, high) - reach.begin()));
  }
  for (size_t i = 0; i < reach.size(); ++i) look_into(i);
}

// The number of instances of each prototype.
std::vector<size_t> count_copies(const Object& scene) {
  std::vector<size_t> copies(scene.prototypes.size());
  for (const Instance& copy : scene.instances) ++copies[copy.prototype];
  return copies;
}

}  // namespace

MaterialId Scene::add_material(const Material& material, Rgb specular, float roughness,
                               float opacity, uint32_t texture) {
  const auto add = [count = materials.size()](auto& column, const auto& value, const auto& usual) {
    if (column.empty() && value == usual) return;
    column.resize(count, usual);
    column.push_back(value);
  };
  add(material_specular, specular, Rgb(1));
  add(material_roughness, roughness, 0.0f);
  add(material_opacity, opacity, 1.0f);
  add(material_texture, texture, kNoTexture);
  if (!standard_surfaces.empty()) standard_surfaces.push_back({.is_standard = 0});
  materials.push_back(material);
  return MaterialId(materials.size() - 1);
}

namespace {

bool has_alpha(const Scene& scene, const Texture& texture) {
  const auto first = scene.texels.begin() + texture.first;
  return std::any_of(first, first + size_t(texture.width) * texture.height,
                     [](uint32_t texel) { return texel >> 24 > 0; });
}

}  // namespace

MaterialId Scene::add_standard_material(StandardSurface surface, const Material& classic,
                                        float alpha, uint32_t texture, Rgb specular,
                                        float roughness) {
  constexpr float kNothingLeft = 2;  // an alpha cutoff beyond all alphas
  if (surface.is_unlit)              // the rest is for programs without it
    surface = {.metallic = 0,
               .emission = classic.color,
               .is_two_sided = surface.is_two_sided,
               .is_unlit = 1,
               .alpha_mode = surface.alpha_mode,
               .alpha_cutoff = surface.alpha_cutoff,
               .emission_texture = texture};
  if (surface.alpha_mode == AlphaMode::mask) {
    // For the texture's alpha alone: that of the factor is not an opacity here.
    float& cutoff = surface.alpha_cutoff;
    cutoff = cutoff > 0 ? std::min(cutoff / alpha, kNothingLeft) : 0;
    // Cutouts are those of triangles; other primitives have an opacity.
    alpha = cutoff > 1 ? 0 : 1;
  }
  if (texture != kNoTexture && surface.alpha_cutoff <= 1 && !has_alpha(*this, textures[texture]))
    surface.alpha_mode = AlphaMode::opaque;
  const MaterialId id = add_material(classic, specular, roughness, alpha, texture);
  set_standard_surface(surface);
  return id;
}

bool Scene::has_cutouts() const {
  for (MaterialId id = 0; id < standard_surfaces.size(); ++id)
    if (has_cutouts(id)) return true;
  return false;
}

bool Scene::has_emission() const {
  return std::ranges::any_of(standard_surfaces, [](const StandardSurface& s) {
    return s.is_standard && s.emission != Rgb();
  });
}

void Scene::set_standard_surface(const StandardSurface& surface) {
  standard_surfaces.resize(materials.size(), {.is_standard = 0});
  standard_surfaces[materials.size() - 1] = surface;
}

size_t Object::primitive_count() const {
  size_t sum = 0;
  for_each_pool([&](auto pool) { sum += (this->*pool.shapes).size(); });
  for (const Mesh& mesh : meshes) sum += mesh.triangles.size();
  const std::vector<size_t> copies = count_copies(*this);
  for (size_t i = 0; i < prototypes.size(); ++i)
    if (copies[i] > 0) sum += copies[i] * prototypes[i].primitive_count();
  return sum;
}

std::array<size_t, kShapeKinds> count_primitives(const Object& object) {
  std::array<size_t, kShapeKinds> counts{};
  for_each_pool([&](auto pool) {
    for (const auto& shape : object.*pool.shapes) ++counts[size_t(shape_kind(shape))];
  });
  for (const Mesh& mesh : object.meshes)
    counts[size_t(ShapeKind::triangle)] += mesh.triangles.size();
  const std::vector<size_t> copies = count_copies(object);
  for (size_t i = 0; i < copies.size(); ++i) {
    if (copies[i] == 0) continue;
    const auto of_one = count_primitives(object.prototypes[i]);
    for (size_t k = 0; k < counts.size(); ++k) counts[k] += copies[i] * of_one[k];
  }
  return counts;
}

Box3f bounds(const Object& object) { return bounds_of(object, nullptr); }

size_t memory_bytes(const Object& object) {
  size_t bytes = 0;
  const auto add = [&](ColumnName, const auto& column) { bytes += column.bytes(); };
  for_each_object_column(object, add);
  for (const Mesh& mesh : object.meshes) for_each_mesh_column(mesh, add);
  for (const Object& inner : object.prototypes) bytes += memory_bytes(inner);
  return bytes;
}

size_t memory_bytes(const Scene& scene) {
  size_t bytes = scene.lights.size() * sizeof(Light);
  for (const std::string& name : scene.object_names) bytes += name.size();
  for_each_column(scene, [&](ColumnName, const auto& column) { bytes += column.bytes(); });
  for (const Object& object : scene.prototypes) bytes += memory_bytes(object);
  return bytes;
}

namespace {

bool any_below_one(const auto& opacity) {
  return std::ranges::any_of(opacity, [](float o) { return o < 1; });
}

bool any_own_opacity(const Object& object) {
  bool any = false;
  for_each_pool(object, [&](PoolKind, auto&, auto&, auto&, const auto& opacity) {
    any = any || any_below_one(opacity);
  });
  return any || std::ranges::any_of(object.prototypes, any_own_opacity);
}

}  // namespace

bool any_transparent(const Scene& scene, const Object& object) {
  return any_below_one(scene.material_opacity) || any_own_opacity(object);
}
bool any_transparent(const Scene& scene) { return any_transparent(scene, scene); }

bool any_colors(const Object& object) {
  bool any = false;
  for_each_pool(object,
                [&](PoolKind, auto&, auto&, const auto& colors, auto&) { any |= !colors.empty(); });
  return any || std::ranges::any_of(object.prototypes, [](auto& s) { return any_colors(s); });
}

float brightest_color(const Object& object) {
  float brightest = 0;
  for_each_pool(object, [&](PoolKind, auto&, auto&, const auto& colors, auto&) {
    for (const Rgb color : colors) brightest = std::max(brightest, max_component(color));
  });
  for (const Object& prototype : object.prototypes)
    brightest = std::max(brightest, brightest_color(prototype));
  return brightest;
}

float brightest_tint(const Object& object) {
  float brightest = 1;
  for (const Mesh& mesh : object.meshes)
    for (const Rgb& color : mesh.colors) brightest = std::max(brightest, max_component(color));
  for (const Object& prototype : object.prototypes)
    brightest = std::max(brightest, brightest_tint(prototype));
  return brightest;
}

Scene standalone(const Scene& around, const Object& object) {
  Scene scene;
  static_cast<Object&>(scene) = object;
  scene.materials = around.materials;
  scene.material_specular = around.material_specular;
  scene.material_roughness = around.material_roughness;
  scene.material_opacity = around.material_opacity;
  scene.material_texture = around.material_texture;
  scene.standard_surfaces = around.standard_surfaces;
  return scene;
}

uint32_t object_of(const Object& object, PoolKind pool, size_t index) {
  const auto behind = std::ranges::upper_bound(
      object.object_ranges, std::pair(pool, index), std::less(),
      [](const ObjectRange& r) { return std::pair(r.pool, size_t(r.first)); });
  if (behind == object.object_ranges.begin()) return 0;
  const ObjectRange& range = behind[-1];
  return range.pool == pool && index - range.first < range.count ? range.object : 0;
}

std::string text_of(const Scene& scene, std::initializer_list<Feature> features) {
  std::string text;
  const auto name = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  const auto add = [&](std::string_view what, size_t count, std::string_view noun) {
    if (count > 0) name(std::string(what) + " of " + plural(count, noun));
  };
  const auto meshes_with = [&](auto column) {
    return size_t(
        std::ranges::count_if(scene.meshes, [&](const Mesh& m) { return !(m.*column).empty(); }));
  };
  for (const Feature feature : features) {
    switch (feature) {
      case Feature::opacity:
        for_each_pool(scene, [&](PoolKind kind, auto&, auto&, auto&, const auto& opacity) {
          add("opacity", size_t(std::ranges::count_if(opacity, [](float o) { return o < 1; })),
              kPoolNames[size_t(kind)]);
        });
        add("opacity",
            size_t(std::ranges::count_if(scene.material_opacity, [](float o) { return o < 1; })),
            "material");
        break;
      case Feature::vertex_colors:
        add("colours of the vertices", meshes_with(&Mesh::colors), "mesh");
        break;
      case Feature::texture_coordinates:
        add("texture coordinates", meshes_with(&Mesh::uv), "mesh");
        break;
      case Feature::textures:
        add("textures",
            size_t(std::ranges::count_if(scene.material_texture,
                                         [](uint32_t texture) { return texture != kNoTexture; })),
            "material");
        break;
      case Feature::object_names:
        add("names", scene.object_names.size(), "object");
        break;
      case Feature::specular_colors:
        add("specular colours",
            size_t(std::ranges::count_if(scene.material_specular,
                                         [](Rgb color) { return color != Rgb(1); })),
            "material");
        break;
      case Feature::roughness:
        add("roughness",
            size_t(std::ranges::count_if(scene.material_roughness, [](float r) { return r > 0; })),
            "material");
        break;
      case Feature::light_extents:
        add("extents",
            size_t(std::ranges::count_if(scene.lights,
                                         [](const Light& l) { return l.extent.has_value(); })),
            "light");
        break;
      case Feature::movement:
        add("movement", scene.moving_spheres.size(), "sphere");
        add("movement", scene.moving_triangles.size(), "triangle");
        add("movement", scene.camera.movement ? 1 : 0, "camera");
        break;
      case Feature::sky:
        if (!scene.requests.sky_folder.empty()) name("the sky in " + scene.requests.sky_folder);
        break;
      case Feature::physical_lights:
        if (const size_t count = scene.physical_lights.size(); count > 0)
          name(plural(count, "physical light"));
        break;
      case Feature::all_directions:
        if (scene.camera.is_omnidirectional()) name("the camera's view in all directions");
        break;
      case Feature::environment:
        if (!scene.environment.empty()) name("the environment");
        break;
    }
  }
  return text;
}

Camera camera_at(const Camera& camera, float time) {
  Camera out = camera;
  out.movement.reset();
  if (const auto& m = camera.movement) {
    const double part = part_moved(m->begin, m->end, time);
    out.from = Vec3f(between(camera.from, m->from, part));
    out.at = Vec3f(between(camera.at, m->at, part));
  }
  return out;
}

std::string camera_problem(const Camera& camera) {
  const Vec3d view = Vec3d(camera.at) - Vec3d(camera.from), up(camera.up);
  if (!(length(view) > 0)) return "from and at are the same point";
  if (!(length(up) > 0)) return "up is zero";
  if (!(length(cross(view, up)) > 1e-7 * length(view) * length(up)))
    return "up is parallel to the line of sight";
  if (const auto& m = camera.movement) {
    // The line of sight changes linearly, and so does its product with `up`. How close to zero does
    // it get?
    const Vec3d end = Vec3d(m->at) - Vec3d(m->from);
    const Vec3d first = cross(view, up), way = cross(end, up) - first;
    const double way2 = dot(way, way);
    const double part = way2 > 0 ? std::clamp(-dot(first, way) / way2, 0.0, 1.0) : 0;
    if (!(length(first + way * part) > 1e-7 * (length(view) + length(end)) * length(up)))
      return "during the camera's movement, up becomes parallel to the line of sight, or from and "
             "at coincide";
  }
  return {};
}

}  // namespace raio::core
