// Scene of the public interface: files, and the caller's columns, which are read in place or
// copied.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <utility>

#include "io/nff/nff.h"
#include "io/scene_file.h"
#include "library/library.h"

namespace raio::v1 {

using namespace library;  // NOLINT(google-build-using-namespace)

namespace {

std::unique_ptr<Scene::Data> taken(std::expected<ReadScene, Diagnostics> read) {
  if (!read) {
    const Diagnostic& first = read.error().front();
    throw Error(first.message == kNoMemory ? ErrorKind::no_resource : ErrorKind::bad_input,
                first.text(), first.file, first.line, first.column);
  }
  auto data = std::make_unique<Scene::Data>(Scene::Data{std::move(read->scene), {}});
  for (const Diagnostic& warning : read->notices) data->warnings.push_back(warning.text());
  return data;
}

}  // namespace

Scene::Scene() : data_(std::make_unique<Data>()) {
  data_->scene.name = "scene";
  data_->scene.materials.emplace_back();
}
Scene::Scene(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Scene::Scene(const Scene& other) : data_(std::make_unique<Data>(*other.data_)) {}
Scene& Scene::operator=(const Scene& other) {
  data_ = std::make_unique<Data>(*other.data_);
  return *this;
}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Scene Scene::read(const std::string& path) {
  return guarded([&] { return Scene(taken(read_scene(path, {.instances = true}))); });
}

Scene Scene::parse_nff(std::string_view text, std::string_view name) {
  return guarded([&] { return Scene(taken(raio::parse_nff(text, name))); });
}

void Scene::write(const std::string& path) const {
  guarded([&] {
    if (const auto written = write_scene(data_->scene, path); !written) fail(written.error());
  });
}

const std::vector<std::string>& Scene::warnings() const { return data_->warnings; }

void Scene::set_camera(const Camera& camera) {
  raio::Scene& scene = data_->scene;
  scene.camera.from = Vec3f(vec(camera.from) - scene.origin);
  scene.camera.at = Vec3f(vec(camera.at) - scene.origin);
  scene.camera.up = Vec3f(vec(camera.up));
  scene.camera.fov_deg = float(camera.fov_deg), scene.camera.horizontal_fov_deg = 0;
  scene.camera.projection = raio::Projection(camera.projection);
  scene.camera.movement.reset();
}

Camera Scene::camera() const {
  const raio::Scene& scene = data_->scene;
  return {triple(scene.origin + Vec3d(scene.camera.from)),
          triple(scene.origin + Vec3d(scene.camera.at)), triple(Vec3d(scene.camera.up)),
          double(scene.camera.fov_deg), Projection(scene.camera.projection)};
}

void Scene::set_background(Triple color) {
  data_->scene.background = rgb(color), data_->has_background = true;
  data_->scene.sky = nullptr, data_->scene.sky_folder.clear();
}

void Scene::add_light(Triple position, std::optional<Triple> color) {
  Light light{Vec3f(vec(position) - data_->scene.origin), {}};
  if (color) light.color = rgb(*color);
  data_->scene.lights.push_back(light);
}

namespace {

// Prototypes use the scene's materials.
void share_materials(const raio::Scene& scene, std::vector<raio::Scene>& prototypes) {
  for (raio::Scene& object : prototypes) {
    object.materials = scene.materials;
    object.material_specular = scene.material_specular;
    object.material_roughness = scene.material_roughness;
    object.material_opacity = scene.material_opacity;
    object.material_texture = scene.material_texture;
    share_materials(scene, object.prototypes);
  }
}

}  // namespace

uint32_t Scene::add_material(const Material& m) {
  return guarded([&] {
    raio::Scene& scene = data_->scene;
    const MaterialId id = scene.add_material({rgb(m.color), float(m.kd), float(m.ks),
                                              float(m.shine), float(m.transmission), float(m.ior)});
    share_materials(scene, scene.prototypes);
    return id;
  });
}

namespace {

// An untyped column: `bytes` per element, the members of a struct from `offset`.
struct Part {
  std::string_view name;
  const void* data;
  size_t count;
  ptrdiff_t stride;
  const std::shared_ptr<const void>& keep;
  size_t bytes;
  size_t offset;
  bool optional = false;

  bool given() const { return data || count > 0; }
  const char* at(size_t i) const { return static_cast<const char*>(data) + ptrdiff_t(i) * stride; }
};

template <class T, size_t N>
Part part(std::string_view name, const Column<T, N>& c, size_t offset = 0) {
  return {name, c.data, c.count, c.stride, c.keep, N * sizeof(T), offset};
}

void check_part(const Part& p, std::string_view beside, size_t count) {
  if (p.count != count)
    refuse(fmt::format("found {} {} but {} {}", count, beside, p.count, p.name));
  if (count > 0 && !p.data) refuse(fmt::format("the {} are a null pointer", p.name));
  if (p.stride == 0)
    refuse(
        fmt::format("the stride of the {} is 0, expected the bytes from one to the next", p.name));
}

// An array of structs from the parts; missing ones stay zero. In place if the caller keeps memory
// in the layout of such an array.
template <class T>
Array<T> gathered(std::initializer_list<Part> parts) {
  const Part& first = *parts.begin();
  for (const Part& p : parts)
    if (p.given() || !p.optional) check_part(p, first.name, first.count);
  if (first.count == 0) return {};
  std::vector<std::shared_ptr<const void>> keeps;
  size_t bytes = 0;
  for (const Part& p : parts) {
    if (!p.keep || p.stride != sizeof(T) || p.data != first.at(0) + p.offset) continue;
    bytes += p.bytes;
    keeps.push_back(p.keep);
  }
  const bool aligned = reinterpret_cast<uintptr_t>(first.data) % alignof(T) == 0;
  if (bytes == sizeof(T) && aligned)
    return Array<T>::borrow(
        first.data, first.count,
        std::make_shared<const std::vector<std::shared_ptr<const void>>>(std::move(keeps)));
  std::vector<T> all(first.count);
  for (const Part& p : parts)
    for (size_t i = 0; p.data && i < all.size(); ++i)
      std::memcpy(reinterpret_cast<char*>(&all[i]) + p.offset, p.at(i), p.bytes);
  return all;
}

// The first ones are taken in place.
template <class T>
void join(Array<T>& to, Array<T> more) {
  if (to.empty())
    to = std::move(more);
  else
    to.insert(std::as_const(to).end(), std::as_const(more).begin(), std::as_const(more).end());
}

// From the caller's coordinates to the scene's.
template <class T, class... Points>
void place(const raio::Scene& scene, Array<T>& all, Points... points) {
  if (scene.origin == Vec3d()) return;
  for (T& x : all)
    for (Vec3f* p : {&std::invoke(points, x)...}) *p = Vec3f(Vec3d(*p) - scene.origin);
}

template <class T, class Normal>
void make_unit(Array<T>& all, std::string_view whose, Normal normal) {
  for (size_t i = 0; i < all.size(); ++i) {
    const Vec3d n(std::invoke(normal, std::as_const(all)[i]));
    if (is_unit(Vec3f(n))) continue;
    if (!is_finite(n) || !(length(n) > 0))
      refuse(fmt::format("the normal of {} {} is zero or not finite", whose, i));
    std::invoke(normal, all[i]) = Vec3f(normalize(n));
  }
}

template <class T>
void check_shapes(const Array<T>& shapes, std::string_view kind) {
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (only_inside_seen(shapes[i])) refuse(fmt::format("{} {}: a radius is negative", kind, i));
    check_shape(shapes[i], [&](bool sound, std::string_view expected) {
      if (!sound) refuse(fmt::format("{} {}: {}", kind, i, expected));
    });
  }
}

// The appearance of primitives added together.
struct PoolAppearance {
  PoolAppearance(const raio::Scene& scene, const Appearance& look, size_t count)
      : material(look.material) {
    if (material >= scene.materials.size())
      refuse(fmt::format("unknown material {}, expected a number below {}", material,
                         scene.materials.size()));
    const Part look_colors = part("colours", look.colors);
    const Part look_opacity = part("opacities", look.opacity);
    for (const Part& p : {look_colors, look_opacity})
      if (p.given()) check_part(p, "primitives", count);
    colors = gathered<Rgb>({look_colors});
    opacity = gathered<float>({look_opacity});
    for (size_t i = 0; i < colors.size(); ++i) {
      const Rgb& c = std::as_const(colors)[i];
      if (!is_finite(c) || c.x < 0 || c.y < 0 || c.z < 0)
        refuse(fmt::format("colour {} must be finite and not negative", i));
    }
    for (size_t i = 0; i < opacity.size(); ++i)
      if (const float x = std::as_const(opacity)[i]; !(x >= 0 && x <= 1))
        refuse(fmt::format("opacity {} is {}, expected 0 to 1", i, x));
  }

  MaterialId material;
  Array<Rgb> colors;
  Array<float> opacity;
};

// Appends `more`, or the material's default for each, to the values of the first `before`
// primitives, if there are any values.
template <class T, class Default>
void join_looks(Array<T>& to, Array<T> more, const Array<MaterialId>& materials, size_t before,
                const Default& default_of) {
  if (to.empty() && more.empty()) return;
  for (size_t i = to.size(); i < before; ++i) to.push_back(default_of(materials[i]));
  if (!more.empty()) return join(to, std::move(more));
  to.resize(materials.size(), default_of(materials.back()));
}

float opacity_of(const raio::Scene& scene, MaterialId id) {
  return scene.material_opacity.empty() ? 1 : scene.material_opacity[id];
}

// Nothing fails from here.
template <class Shape>
void append(raio::Scene& scene, Array<Shape> shapes, PoolAppearance looks) {
  constexpr PoolMembers<Shape> pool = kPoolOf<Shape>;
  const size_t before = (scene.*pool.shapes).size();
  Array<MaterialId>& ids = scene.*pool.materials;
  ids.resize(before + shapes.size(), looks.material);
  const auto& materials = std::as_const(scene).materials;
  join_looks(scene.*pool.colors, std::move(looks.colors), ids, before,
             [&](MaterialId id) { return materials[id].color; });
  join_looks(scene.*pool.opacity, std::move(looks.opacity), ids, before,
             [&](MaterialId id) { return opacity_of(scene, id); });
  join(scene.*pool.shapes, std::move(shapes));
}

}  // namespace

void Scene::add_spheres(const Column<float, 3>& centers, const Column<float>& radii,
                        const Appearance& look) {
  guarded([&] {
    auto spheres = gathered<Sphere>({part("centres", centers, offsetof(Sphere, center)),
                                     part("radii", radii, offsetof(Sphere, radius))});
    place(data_->scene, spheres, &Sphere::center);
    check_shapes(spheres, "sphere");
    PoolAppearance looks(data_->scene, look, spheres.size());
    append(data_->scene, std::move(spheres), std::move(looks));
  });
}

void Scene::add_cones(const Column<float, 3>& starts, const Column<float, 3>& ends,
                      const Column<float>& start_radii, const Column<float>& end_radii,
                      const Appearance& look) {
  guarded([&] {
    auto cones =
        gathered<Cone>({part("starts", starts, offsetof(Cone, base)),
                        part("radii of the starts", start_radii, offsetof(Cone, base_radius)),
                        part("ends", ends, offsetof(Cone, apex)),
                        part("radii of the ends", end_radii, offsetof(Cone, apex_radius))});
    place(data_->scene, cones, &Cone::base, &Cone::apex);
    check_shapes(cones, "cone");
    PoolAppearance looks(data_->scene, look, cones.size());
    append(data_->scene, std::move(cones), std::move(looks));
  });
}

void Scene::add_ellipsoids(const Column<float, 3>& centers, const Column<float, 9>& axes,
                           const Appearance& look) {
  guarded([&] {
    auto ellipsoids = gathered<Ellipsoid>({part("centres", centers, offsetof(Ellipsoid, center)),
                                           part("axes", axes, offsetof(Ellipsoid, axes))});
    place(data_->scene, ellipsoids, &Ellipsoid::center);
    check_shapes(ellipsoids, "ellipsoid");
    PoolAppearance looks(data_->scene, look, ellipsoids.size());
    append(data_->scene, std::move(ellipsoids), std::move(looks));
  });
}

void Scene::add_discs(const Column<float, 3>& centers, const Column<float, 3>& normals,
                      const Column<float>& radii, const Column<float>& inner_radii,
                      const Appearance& look) {
  guarded([&] {
    Part inner = part("inner radii", inner_radii, offsetof(Disc, inner));
    inner.optional = true;
    auto discs = gathered<Disc>({part("centres", centers, offsetof(Disc, center)),
                                 part("normals", normals, offsetof(Disc, normal)),
                                 part("radii", radii, offsetof(Disc, radius)), inner});
    place(data_->scene, discs, &Disc::center);
    make_unit(discs, "disc", &Disc::normal);
    check_shapes(discs, "disc");
    PoolAppearance looks(data_->scene, look, discs.size());
    append(data_->scene, std::move(discs), std::move(looks));
  });
}

namespace {

// Moving shapes, all from `begin` to `end`; the parts have the other members.
template <class Shape>
Array<Shape> gathered_moving(std::initializer_list<Part> parts, double begin, double end) {
  Array<Shape> shapes = gathered<Shape>(parts);
  for (Shape& s : shapes) s.begin = float(begin), s.end = float(end);
  return shapes;
}

}  // namespace

void Scene::add_moving_spheres(const Column<float, 3>& starts, const Column<float, 3>& ends,
                               const Column<float>& radii, double begin, double end,
                               const Appearance& look) {
  guarded([&] {
    auto spheres =
        gathered_moving<MovingSphere>({part("starts", starts, offsetof(MovingSphere, center)),
                                       part("ends", ends, offsetof(MovingSphere, to)),
                                       part("radii", radii, offsetof(MovingSphere, radius))},
                                      begin, end);
    place(data_->scene, spheres, &MovingSphere::center, &MovingSphere::to);
    check_shapes(spheres, "moving sphere");
    PoolAppearance looks(data_->scene, look, spheres.size());
    append(data_->scene, std::move(spheres), std::move(looks));
  });
}

void Scene::add_moving_triangles(const Column<float, 9>& starts, const Column<float, 9>& ends,
                                 double begin, double end, const Appearance& look) {
  guarded([&] {
    auto triangles =
        gathered_moving<MovingTriangle>({part("starts", starts, offsetof(MovingTriangle, from)),
                                         part("ends", ends, offsetof(MovingTriangle, to))},
                                        begin, end);
    if (const Vec3d origin = data_->scene.origin; origin != Vec3d())
      for (MovingTriangle& t : triangles)
        for (Vec3f* p : {&t.from.a, &t.from.b, &t.from.c, &t.to.a, &t.to.b, &t.to.c})
          *p = Vec3f(Vec3d(*p) - origin);
    check_shapes(triangles, "moving triangle");
    PoolAppearance looks(data_->scene, look, triangles.size());
    append(data_->scene, std::move(triangles), std::move(looks));
  });
}

namespace {

constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};

// Indices of vertices that come after `first` others.
Array<TriangleIndices> behind(size_t first, Array<TriangleIndices> corners) {
  if (first == 0) return corners;
  for (TriangleIndices& t : corners)
    for (uint32_t& vertex : t) vertex += uint32_t(first);
  return corners;
}

}  // namespace

void Scene::add_triangles(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                          const Column<float, 3>& normals, const Appearance& look) {
  guarded([&] {
    raio::Scene& scene = data_->scene;
    const Part smooth = part("normals", normals);
    auto points = gathered<Vec3f>({part("positions", positions)});
    if (smooth.given()) check_part(smooth, "positions", points.size());
    auto units = gathered<Vec3f>({smooth});
    const auto corners = gathered<TriangleIndices>({part("triangles", triangles)});
    place(scene, points, std::identity());
    make_unit(units, "vertex", std::identity());
    for (size_t i = 0; i < points.size(); ++i)
      if (!is_finite(std::as_const(points)[i])) refuse(fmt::format("position {} is not finite", i));
    for (size_t i = 0; i < corners.size(); ++i)
      for (const uint32_t vertex : corners[i])
        if (vertex >= points.size())
          refuse(fmt::format("triangle {} refers to vertex {} of {}", i, vertex, points.size()));
    const size_t first = scene.positions.size(), first_normal = scene.normals.size();
    if (first + points.size() >= kNoNormal)
      refuse(fmt::format("{} vertices exceed the range of indices", first + points.size()));
    PoolAppearance looks(scene, look, corners.size());

    // Normals are stored from the first smooth triangle on.
    const size_t before = scene.triangles.size();
    if (smooth.given()) {
      if (scene.triangle_normals.size() < before) scene.triangle_normals.resize(before, kFlat);
      join(scene.triangle_normals, behind(first_normal, corners));
    } else if (!scene.triangle_normals.empty()) {
      scene.triangle_normals.resize(before + corners.size(), kFlat);
    }
    join(scene.positions, std::move(points));
    join(scene.normals, std::move(units));
    append(scene, behind(first, corners), std::move(looks));
  });
}

namespace {

uint32_t texture_of(const raio::Scene& scene, MaterialId id) {
  return scene.material_texture.empty() ? kNoTexture : scene.material_texture[id];
}

// Moves the textures of an object to the scene and renumbers them.
void take_textures(raio::Scene& scene, raio::Scene& object) {
  if (object.texels.size() > kMaxTexels - scene.texels.size())
    refuse(fmt::format("the textures have {} texels, the maximum is {}",
                       scene.texels.size() + object.texels.size(), kMaxTexels));
  const auto first = uint32_t(scene.textures.size()), first_texel = uint32_t(scene.texels.size());
  for (Texture& texture : object.textures) texture.first += first_texel;
  for (uint32_t& texture : object.material_texture)
    if (texture != kNoTexture) texture += first;
  join(scene.textures, std::move(object.textures));
  join(scene.texels, std::move(object.texels));
  object.textures = {}, object.texels = {};
}

// The numbers in `scene` of the materials of `object`; missing ones are added.
std::vector<MaterialId> numbers_in(raio::Scene& scene, const raio::Scene& object) {
  std::vector<MaterialId> numbers;
  for (MaterialId id = 0; id < object.materials.size(); ++id) {
    const auto& materials = std::as_const(scene).materials;
    const raio::Material material = object.materials[id];
    const Rgb specular = object.specular_of(id);
    const float roughness = object.roughness_of(id), opacity = opacity_of(object, id);
    MaterialId same = 0;
    while (same < materials.size() &&
           !(materials[same] == material && scene.specular_of(same) == specular &&
             scene.roughness_of(same) == roughness && opacity_of(scene, same) == opacity &&
             texture_of(scene, same) == texture_of(object, id)))
      ++same;
    if (same == materials.size())
      scene.add_material(material, specular, roughness, opacity, texture_of(object, id));
    numbers.push_back(same);
  }
  return numbers;
}

// Renumbers materials and named objects of an object and those within it.
void renumber(raio::Scene& object, const std::vector<MaterialId>& materials, uint32_t names) {
  const auto change = [&](Array<MaterialId>& ids) {
    for (MaterialId& id : ids) id = materials[id];
  };
  for_each_pool([&](auto pool) { change(object.*pool.materials); });
  for (Mesh& mesh : object.meshes) change(mesh.materials);
  for (ObjectRange& range : object.object_ranges) range.object += names;
  for (raio::Scene& inner : object.prototypes) renumber(inner, materials, names);
}

int depth_of(const raio::Scene& scene) {
  int depth = 0;
  for (const raio::Scene& object : scene.prototypes) depth = std::max(depth, 1 + depth_of(object));
  return depth;
}

// The contents of an object, without camera, lights and background.
raio::Scene object_of(const raio::Scene& scene) {
  raio::Scene object = scene;
  object.name.clear();
  object.camera = {}, object.background = {}, object.lights.clear();
  object.dialect = {}, object.samples_per_pixel = 0, object.structure = {};
  object.sky_folder.clear(), object.sky = nullptr;
  return object;
}

}  // namespace

uint32_t Scene::add_prototype(const Scene& prototype) {
  return guarded([&] {
    raio::Scene object = object_of(prototype.data_->scene);
    if (!object.planes.empty()) refuse("an infinite plane cannot be instanced");
    if (object.moves()) refuse("moving primitives cannot be instanced");
    if (1 + depth_of(object) > kMaxNested)
      refuse(fmt::format("prototypes are nested more than {} deep", kMaxNested));
    if (const auto problems = validate(object); !problems.empty()) refuse(problems.front());
    raio::Scene& scene = data_->scene;
    const std::vector<std::string> names = std::exchange(object.object_names, {});
    take_textures(scene, object);
    renumber(object, numbers_in(scene, object), uint32_t(scene.object_names.size()));
    scene.object_names.insert(scene.object_names.end(), names.begin(), names.end());
    scene.prototypes.push_back(std::move(object));
    share_materials(scene, scene.prototypes);
    return uint32_t(scene.prototypes.size() - 1);
  });
}

namespace {

void append_instances(raio::Scene& scene, Array<Instance> copies, std::string_view name) {
  bool far = scene.origin != Vec3d();
  for (size_t i = 0; i < copies.size(); ++i) {
    const Instance& copy = std::as_const(copies)[i];
    if (copy.prototype >= scene.prototypes.size())
      refuse(fmt::format("instance {}: unknown prototype {}, expected a number below {}", i,
                         copy.prototype, scene.prototypes.size()));
    if (!Placement(copy.matrix).is_sound())
      refuse(fmt::format("instance {}: the matrix must be finite and have an inverse", i));
    far |= scene.prototypes[copy.prototype].origin != Vec3d();
  }
  // From the caller's coordinates to the stored ones.
  for (size_t i = 0; far && i < copies.size(); ++i) {
    Instance& copy = copies[i];
    const Vec3d shift =
        Placement(copy.matrix).point(scene.prototypes[copy.prototype].origin) - scene.origin;
    for (int axis = 0; axis < 3; ++axis) copy.matrix[size_t(4 * axis) + 3] = float(shift[axis]);
  }
  if (!name.empty() && !copies.empty()) {
    scene.object_names.emplace_back(name);
    scene.object_ranges.push_back({PoolKind::instance, uint32_t(scene.instances.size()),
                                   uint32_t(copies.size()), uint32_t(scene.object_names.size())});
  }
  join(scene.instances, std::move(copies));
}

}  // namespace

void Scene::add_instances(uint32_t prototype, const Column<float, 12>& matrices,
                          std::string_view name) {
  guarded([&] {
    auto copies = gathered<Instance>({part("matrices", matrices, offsetof(Instance, matrix))});
    for (Instance& copy : copies) copy.prototype = prototype;
    append_instances(data_->scene, std::move(copies), name);
  });
}

void Scene::add_instances(const Column<uint32_t>& prototypes, const Column<float, 12>& matrices,
                          std::string_view name) {
  guarded([&] {
    auto copies = gathered<Instance>({part("prototypes", prototypes, offsetof(Instance, prototype)),
                                      part("matrices", matrices, offsetof(Instance, matrix))});
    append_instances(data_->scene, std::move(copies), name);
  });
}

size_t Scene::primitive_count() const { return data_->scene.primitive_count(); }

std::optional<std::array<Triple, 2>> Scene::bounds() const { return bounds_of(data_->scene); }

}  // namespace raio::v1
