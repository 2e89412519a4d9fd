// Scene of the public interface: files, and the caller's columns, which are read in place or
// copied.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <utility>

#include "base/exact_math.h"
#include "io/fit_camera.h"
#include "io/nff/nff.h"
#include "io/raio/raio.h"
#include "io/scene_file.h"
#include "library/library.h"
#include "render/picture_options.h"

namespace raio::inline v1 {

using namespace core;           // NOLINT(google-build-using-namespace)
using namespace core::library;  // NOLINT(google-build-using-namespace)

namespace {

std::unique_ptr<Scene::Data> taken(std::expected<ReadScene, Diagnostics> read) {
  if (!read) {
    const Diagnostic& first = read.error().front();
    if (first.message == kStopped) fail(stopped_error());
    throw Error(first.message == kNoMemory ? ErrorKind::no_resource : ErrorKind::bad_input,
                first.text(), first.file, first.line, first.column);
  }
  auto data = std::make_unique<Scene::Data>(Scene::Data{std::move(read->scene), {}});
  for (const Diagnostic& warning : read->notices) data->warnings.push_back(warning.text());
  data->colors = std::move(read->colors), data->legend = std::move(read->legend);
  data->unit = std::move(read->unit);
  return data;
}

// A background that lights the scene is one of them.
ReadOptions read_options(const Settings& settings) {
  ReadOptions read = settings.data().read;
  RenderOptions options = settings.data().options;
  if (const auto why = read_background(options, read)) fail(*why);
  read.instances = true;
  return read;
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

Scene Scene::read(const std::string& path) { return read(path, {}); }

Scene Scene::read(const std::string& path, const Settings& settings) {
  return guarded_work(settings.data().options.threads, [&] {
    ReadOptions read = read_options(settings);
    Scene scene(taken(read_scene(path, read)));
    scene.data_->read = std::move(read);
    return scene;
  });
}

Scene Scene::parse(std::string_view bytes, std::string_view name, const Settings& settings) {
  return guarded_work(settings.data().options.threads, [&] {
    ReadOptions read = read_options(settings);
    Scene scene(taken(parse_scene(bytes, name, read)));
    scene.data_->read = std::move(read);
    return scene;
  });
}

Scene Scene::parse_nff(std::string_view text, std::string_view name) {
  return guarded_work(0, [&] { return Scene(taken(core::parse_nff(text, name))); });
}

void Scene::write(const std::string& path) const {
  guarded_work(0, [&] {
    if (const auto written = write_scene(data_->scene, path); !written) fail(written.error());
  });
}

std::string Scene::to_bytes() const {
  return guarded_work(0, [&] {
    if (const auto problems = validate(data_->scene); !problems.empty()) refuse(problems.front());
    return encode_raio_scene(data_->scene);
  });
}

Scene Scene::from_bytes(std::string_view bytes, std::shared_ptr<const void> keep) {
  return guarded_work(0, [&] {
    auto scene = decode_raio_scene(bytes, keep);
    if (!scene) refuse(scene.error());
    scene->name = Scene().data().scene.name;
    auto data = std::make_unique<Data>(Data{std::move(*scene), {}});
    if (!data->scene.requests.sky_folder.empty())
      data->warnings.emplace_back(
          "its sky is not in the bytes; the background is that of the scene");
    return Scene(std::move(data));
  });
}

const std::vector<std::string>& Scene::warnings() const { return data_->warnings; }

std::optional<ColorScale> Scene::color_scale() const {
  if (!data_->colors) return std::nullopt;
  const core::ColorScale& scale = *data_->colors;
  return ColorScale{scale.name, scale.least, scale.most, colormap(scale.map)};
}

std::vector<LegendEntry> Scene::legend() const {
  std::vector<LegendEntry> entries;
  for (const auto& [name, color] : data_->legend) entries.push_back({name, triple(Vec3d(color))});
  return entries;
}

const std::string& Scene::unit() const { return data_->unit; }

void Scene::set_camera(const Camera& camera) {
  core::Scene& scene = data_->scene;
  scene.camera.from = Vec3f(vec(camera.from) - scene.origin);
  scene.camera.at = Vec3f(vec(camera.at) - scene.origin);
  scene.camera.up = Vec3f(vec(camera.up));
  scene.camera.fov_deg = float(camera.fov_deg), scene.camera.horizontal_fov_deg = 0;
  scene.camera.projection = core::Projection(camera.projection);
  scene.camera.movement.reset();
}

Camera Scene::camera() const {
  const core::Scene& scene = data_->scene;
  return {triple(scene.origin + Vec3d(scene.camera.from)),
          triple(scene.origin + Vec3d(scene.camera.at)), triple(Vec3d(scene.camera.up)),
          double(scene.camera.fov_deg), Projection(scene.camera.projection)};
}

void Scene::fit_camera(std::optional<Triple> direction, Triple up, double margin) {
  guarded_work(0, [&] {
    core::Scene& scene = data_->scene;
    if (length(vec(up)) == 0 || !is_finite(vec(up)))
      refuse("up: expected a finite direction other than zero");
    if (!(margin >= 0 && margin < 0.5))
      refuse(fmt::format("margin: expected a number from 0 up to 0.5, found {}", margin));
    core::Camera camera = scene.camera;
    camera.movement.reset();
    if (camera.width == 0) camera.width = 1200, camera.height = 900;
    if (direction) {
      if (length(vec(*direction)) == 0 || !is_finite(vec(*direction)))
        refuse("direction: expected a finite direction other than zero");
      const Vec3d forward = normalize(vec(*direction));
      Vec3d upright = normalize(vec(up));
      if (length(cross(forward, upright)) < 1e-3)
        upright = std::abs(forward.y) < 0.5 ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
      camera.up = Vec3f(upright);
      camera.at = {}, camera.from = Vec3f(forward * -1.0);
      camera = fitted_along(scene, camera, Fit::all, camera.fov_deg);
    } else {
      camera = fitted_from(scene, camera, std::nullopt, Vec3f(normalize(vec(up))), Fit::all,
                           camera.fov_deg);
    }
    const auto widened = [&](float degrees) {
      constexpr double kHalf = std::numbers::pi / 360;
      const double tangent = exact_tan(double(degrees) * kHalf) / (1 - 2 * margin);
      return margin > 0 ? float(exact_atan(tangent) / kHalf) : degrees;
    };
    camera.fov_deg = widened(camera.fov_deg);
    camera.horizontal_fov_deg = widened(camera.horizontal_fov_deg);
    scene.camera = camera;
  });
}

void Scene::set_figure(bool is_figure) {
  data_->scene.dialect = is_figure ? Dialect::data : Dialect::nff;
}

void Scene::set_background(Triple color) {
  data_->scene.background = rgb(color), data_->has_background = true;
  data_->scene.sky = nullptr, data_->scene.requests.sky_folder.clear();
}

namespace {

// An untyped column: `bytes` per element.
struct Part {
  std::string_view name;
  const void* data;
  size_t count;
  ptrdiff_t stride;
  std::shared_ptr<const void> keep;
  size_t bytes;
  bool optional = false;

  bool given() const { return data || count > 0; }
};

template <class T, size_t N>
Part part(std::string_view name, const Column<T, N>& c) {
  return {name, c.data, c.count, c.stride, c.keep, N * sizeof(T)};
}

template <class T, size_t N>
Part optional_part(std::string_view name, const Column<T, N>& c) {
  Part p = part(name, c);
  p.optional = true;
  return p;
}

// One value for all `count` elements.
template <class T>
Part constant_part(const T& value, size_t count) {
  auto keep = std::make_shared<const T>(value);
  const T* const data = keep.get();
  return {"", data, count, 0, std::move(keep), sizeof(T)};
}

void check_part(const Part& p, std::string_view beside, size_t count) {
  if (p.count != count)
    refuse(fmt::format("found {} {} but {} {}", count, beside, p.count, p.name));
  if (count > 0 && !p.data) refuse(fmt::format("the {} are a null pointer", p.name));
}

// The part, if the caller keeps its memory alive, else a copy.
Part kept(Part p) {
  if (p.keep) return p;
  const auto copy = std::make_shared<std::vector<char>>(p.count * p.bytes);
  for (size_t i = 0; i < p.count; ++i)
    std::memcpy(copy->data() + i * p.bytes,
                static_cast<const char*>(p.data) + ptrdiff_t(i) * p.stride, p.bytes);
  p.data = copy->data(), p.stride = ptrdiff_t(p.bytes), p.keep = copy;
  return p;
}

// Elements with the parts as members, in place where the caller keeps them. Missing optional parts
// are zero.
template <class T>
StridedArray<T> gathered(std::array<Part, kMemberOffsets<T>.size()> parts) {
  const size_t count = parts[0].count;
  for (Part& p : parts) {
    if (p.optional && !p.given()) p = constant_part(std::array<char, sizeof(T)>(), count);
    check_part(p, parts[0].name, count);
  }
  if (count == 0) return {};
  std::array<typename StridedArray<T>::Member, kMemberOffsets<T>.size()> members;
  std::vector<std::shared_ptr<const void>> keeps;
  for (size_t m = 0; m < parts.size(); ++m) {
    const Part p = kept(std::move(parts[m]));
    members[m] = {p.data, p.stride};
    keeps.push_back(p.keep);
  }
  return StridedArray<T>::borrow(
      members, count,
      std::make_shared<const std::vector<std::shared_ptr<const void>>>(std::move(keeps)));
}

// From the caller's coordinates to the scene's.
template <class T, class... Points>
void place(const core::Scene& scene, StridedArray<T>& all, Points... points) {
  if (scene.origin == Vec3d()) return;
  for (T& x : all)
    for (Vec3f* p : {&std::invoke(points, x)...}) *p = Vec3f(Vec3d(*p) - scene.origin);
}

template <class T, class Normal>
void make_unit(StridedArray<T>& all, std::string_view whose, Normal normal) {
  for (size_t i = 0; i < all.size(); ++i) {
    const Vec3d n(std::invoke(normal, std::as_const(all)[i]));
    if (is_unit(Vec3f(n))) continue;
    if (!is_finite(n) || !(length(n) > 0))
      refuse(fmt::format("the normal of {} {} is zero or not finite", whose, i));
    std::invoke(normal, all[i]) = Vec3f(normalize(n));
  }
}

template <class T>
void check_shapes(const StridedArray<T>& shapes, std::string_view kind) {
  for (size_t i = 0; i < shapes.size(); ++i) {
    if (only_inside_seen(shapes[i])) refuse(fmt::format("{} {}: a radius is negative", kind, i));
    check_shape(shapes[i], [&](bool sound, std::string_view expected) {
      if (!sound) refuse(fmt::format("{} {}: {}", kind, i, expected));
    });
  }
}

// The light of unlit surfaces is that of their material.
void check_takes_colors(const core::Scene& scene, MaterialId id) {
  if (const core::StandardSurface* const s = scene.standard_surface_of(id); s && s->is_unlit)
    refuse(fmt::format("material {} is unlit, so primitives and vertices cannot have own colours",
                       id));
}

// The appearance of primitives added together.
struct PoolAppearance {
  PoolAppearance(const core::Scene& scene, const Appearance& look, size_t count)
      : material(look.material) {
    if (material >= scene.materials.size())
      refuse(fmt::format("unknown material {}, expected a number below {}", material,
                         scene.materials.size()));
    const Part look_colors = part("colours", look.colors);
    const Part look_opacity = part("opacities", look.opacity);
    for (const Part& p : {look_colors, look_opacity})
      if (p.given()) check_part(p, "primitives", count);
    if (look_colors.given()) check_takes_colors(scene, material);
    if (look_colors.given()) colors = gathered<Rgb>({look_colors});
    if (look_opacity.given()) opacity = gathered<float>({look_opacity});
    for (size_t i = 0; i < colors.size(); ++i) {
      const Rgb c = std::as_const(colors)[i];
      if (!is_finite(c) || c.x < 0 || c.y < 0 || c.z < 0)
        refuse(fmt::format("colour {} must be finite and not negative", i));
    }
    for (size_t i = 0; i < opacity.size(); ++i)
      if (const float x = std::as_const(opacity)[i]; !(x >= 0 && x <= 1))
        refuse(fmt::format("opacity {} is {}, expected 0 to 1", i, x));
  }

  MaterialId material;
  StridedArray<Rgb> colors;
  StridedArray<float> opacity;
};

// Appends `more`, or the material's default for each, to the values of the first `before`
// primitives, if there are any values.
template <class T, class Default>
void join_looks(StridedArray<T>& to, const StridedArray<T>& more,
                const StridedArray<MaterialId>& materials, size_t before,
                const Default& default_of) {
  if (to.empty() && more.empty()) return;
  for (size_t i = to.size(); i < before; ++i) to.push_back(default_of(materials[i]));
  if (more.empty())
    to.resize(materials.size(), default_of(materials.back()));
  else
    to.append(more);
}

// Nothing fails from here.
template <class Shapes>
void append(core::Scene& scene, const Shapes& shapes, const PoolAppearance& looks) {
  constexpr auto pool = kPoolOf<typename Shapes::value_type>;
  const size_t before = (scene.*pool.shapes).size();
  StridedArray<MaterialId>& ids = scene.*pool.materials;
  ids.resize(before + shapes.size(), looks.material);
  const auto& materials = std::as_const(scene).materials;
  join_looks(scene.*pool.colors, looks.colors, std::as_const(ids), before,
             [&](MaterialId id) { return materials[id].color; });
  join_looks(scene.*pool.opacity, looks.opacity, std::as_const(ids), before,
             [&](MaterialId id) { return scene.opacity_of(id); });
  (scene.*pool.shapes).append(shapes);
}

}  // namespace

void Scene::add_spheres(const Column<float, 3>& centers, const Column<float>& radii,
                        const Appearance& look) {
  guarded([&] {
    auto spheres = gathered<Sphere>({part("centres", centers), part("radii", radii)});
    place(data_->scene, spheres, &Sphere::center);
    check_shapes(spheres, "sphere");
    PoolAppearance looks(data_->scene, look, spheres.size());
    append(data_->scene, spheres, looks);
  });
}

void Scene::add_cones(const Column<float, 3>& starts, const Column<float, 3>& ends,
                      const Column<float>& start_radii, const Column<float>& end_radii,
                      const Appearance& look) {
  guarded([&] {
    auto cones = gathered<Cone>({part("starts", starts), part("radii of the starts", start_radii),
                                 part("ends", ends), part("radii of the ends", end_radii)});
    place(data_->scene, cones, &Cone::base, &Cone::apex);
    check_shapes(cones, "cone");
    PoolAppearance looks(data_->scene, look, cones.size());
    append(data_->scene, cones, looks);
  });
}

void Scene::add_ellipsoids(const Column<float, 3>& centers, const Column<float, 9>& axes,
                           const Appearance& look) {
  guarded([&] {
    auto ellipsoids = gathered<Ellipsoid>({part("centres", centers), part("axes", axes)});
    place(data_->scene, ellipsoids, &Ellipsoid::center);
    check_shapes(ellipsoids, "ellipsoid");
    PoolAppearance looks(data_->scene, look, ellipsoids.size());
    append(data_->scene, ellipsoids, looks);
  });
}

void Scene::add_discs(const Column<float, 3>& centers, const Column<float, 3>& normals,
                      const Column<float>& radii, const Column<float>& inner_radii,
                      const Appearance& look) {
  guarded([&] {
    auto discs = gathered<Disc>({part("centres", centers), part("normals", normals),
                                 part("radii", radii), optional_part("inner radii", inner_radii)});
    place(data_->scene, discs, &Disc::center);
    make_unit(discs, "disc", &Disc::normal);
    check_shapes(discs, "disc");
    PoolAppearance looks(data_->scene, look, discs.size());
    append(data_->scene, discs, looks);
  });
}

void Scene::add_moving_spheres(const Column<float, 3>& starts, const Column<float, 3>& ends,
                               const Column<float>& radii, double begin, double end,
                               const Appearance& look) {
  guarded([&] {
    auto spheres = gathered<MovingSphere>(
        {part("starts", starts), part("ends", ends), part("radii", radii),
         constant_part(float(begin), starts.count), constant_part(float(end), starts.count)});
    place(data_->scene, spheres, &MovingSphere::center, &MovingSphere::to);
    check_shapes(spheres, "moving sphere");
    PoolAppearance looks(data_->scene, look, spheres.size());
    append(data_->scene, spheres, looks);
  });
}

void Scene::add_moving_triangles(const Column<float, 9>& starts, const Column<float, 9>& ends,
                                 double begin, double end, const Appearance& look) {
  guarded([&] {
    auto triangles = gathered<MovingTriangle>({part("starts", starts), part("ends", ends),
                                               constant_part(float(begin), starts.count),
                                               constant_part(float(end), starts.count)});
    if (const Vec3d origin = data_->scene.origin; origin != Vec3d())
      for (MovingTriangle& t : triangles)
        for (Vec3f* p : {&t.from.a, &t.from.b, &t.from.c, &t.to.a, &t.to.b, &t.to.c})
          *p = Vec3f(Vec3d(*p) - origin);
    check_shapes(triangles, "moving triangle");
    PoolAppearance looks(data_->scene, look, triangles.size());
    append(data_->scene, triangles, looks);
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

void Scene::add_mesh(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                     const Column<float, 3>& normals, const Column<float, 2>& uv,
                     const Column<float, 3>& vertex_colors, uint32_t material) {
  add_mesh(positions, triangles, normals, uv, vertex_colors, Column<uint32_t>{&material, 1});
}

void Scene::add_mesh(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                     const Column<float, 3>& normals, const Column<float, 2>& uv,
                     const Column<float, 3>& vertex_colors, const Column<uint32_t>& materials) {
  guarded([&] {
    core::Scene& scene = data_->scene;
    const Part numbers = part("materials", materials);
    if (materials.count != 1) check_part(numbers, "triangles", triangles.count);
    const auto attribute = [&]<class T>(const Part& p, T) {
      if (p.given()) check_part(p, "positions", positions.count);
      return p.given() ? gathered<T>({p}) : StridedArray<T>();
    };
    Mesh mesh;
    auto points = gathered<Vec3f>({part("positions", positions)});
    place(scene, points, std::identity());
    for (size_t i = 0; i < points.size(); ++i)
      if (!is_finite(std::as_const(points)[i])) refuse(fmt::format("position {} is not finite", i));
    auto units = attribute(part("normals", normals), Vec3f());
    make_unit(units, "vertex", std::identity());
    const auto colors = attribute(part("vertex colours", vertex_colors), Rgb());
    for (size_t i = 0; i < colors.size(); ++i)
      if (const Rgb c = colors[i]; !is_finite(c) || c.x < 0 || c.y < 0 || c.z < 0)
        refuse(fmt::format("vertex colour {} must be finite and not negative", i));
    const auto places = attribute(part("texture coordinates", uv), Uv());
    for (size_t i = 0; i < places.size(); ++i)
      if (const Uv t = places[i]; !std::isfinite(t[0]) || !std::isfinite(t[1]))
        refuse(fmt::format("texture coordinate {} is not finite", i));
    mesh.triangles = gathered<TriangleIndices>({part("triangles", triangles)}).packed();
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const uint32_t vertex : std::as_const(mesh.triangles)[i])
        if (vertex >= points.size())
          refuse(fmt::format("triangle {} refers to vertex {} of {}", i, vertex, points.size()));
    mesh.positions = points.packed(), mesh.normals = units.packed();
    mesh.colors = colors.packed(), mesh.uv = places.packed();
    mesh.materials = gathered<MaterialId>({numbers}).packed();
    for (const MaterialId material : std::as_const(mesh.materials)) {
      if (material >= scene.materials.size())
        refuse(fmt::format("unknown material {}, expected a number below {}", material,
                           scene.materials.size()));
      if (!colors.empty()) check_takes_colors(scene, material);
    }
    scene.meshes.push_back(std::move(mesh));
  });
}

void Scene::add_triangles(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                          const Column<float, 3>& normals, const Appearance& look) {
  guarded([&] {
    core::Scene& scene = data_->scene;
    const Part smooth = part("normals", normals);
    auto points = gathered<Vec3f>({part("positions", positions)});
    if (smooth.given()) check_part(smooth, "positions", points.size());
    auto units = smooth.given() ? gathered<Vec3f>({smooth}) : StridedArray<Vec3f>();
    const auto corners = gathered<TriangleIndices>({part("triangles", triangles)}).packed();
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
      scene.triangle_normals.append(behind(first_normal, corners));
    } else if (!scene.triangle_normals.empty()) {
      scene.triangle_normals.resize(before + corners.size(), kFlat);
    }
    scene.positions.append(points.packed());
    scene.normals.append(units.packed());
    append(scene, behind(first, corners), looks);
  });
}

namespace {

// Moves the textures of an object to the scene and renumbers them.
void take_textures(core::Scene& scene, core::Scene& object) {
  if (object.texels.size() > kMaxTexels - scene.texels.size())
    refuse(fmt::format("the textures have {} texels, the maximum is {}",
                       scene.texels.size() + object.texels.size(), kMaxTexels));
  const auto first = uint32_t(scene.textures.size()), first_texel = uint32_t(scene.texels.size());
  for (Texture& texture : object.textures) texture.first += first_texel;
  const auto renumber = [&](uint32_t& texture) {
    if (texture != kNoTexture) texture += first;
  };
  std::ranges::for_each(object.material_texture, renumber);
  for (core::StandardSurface& s : object.standard_surfaces)
    for (uint32_t* texture : {&s.metallic_roughness_texture, &s.normal_texture, &s.emission_texture,
                              &s.transmission_texture})
      renumber(*texture);
  scene.textures.append(object.textures);
  scene.texels.append(object.texels);
  object.textures = {}, object.texels = {};
}

// The numbers in `scene` of the materials of `object`; missing ones are added.
std::vector<MaterialId> numbers_in(core::Scene& scene, const core::Scene& object) {
  std::vector<MaterialId> numbers;
  for (MaterialId id = 0; id < object.materials.size(); ++id) {
    const auto& materials = std::as_const(scene).materials;
    const core::Material material = object.materials[id];
    const Rgb specular = object.specular_of(id);
    const float roughness = object.roughness_of(id), opacity = object.opacity_of(id);
    const core::StandardSurface* const surface = object.standard_surface_of(id);
    const auto has_same_surface = [&](MaterialId other) {
      const core::StandardSurface* const its = std::as_const(scene).standard_surface_of(other);
      return surface && its ? *surface == *its : surface == its;
    };
    MaterialId same = 0;
    while (same < materials.size() &&
           !(materials[same] == material && scene.specular_of(same) == specular &&
             scene.roughness_of(same) == roughness && scene.opacity_of(same) == opacity &&
             scene.texture_of(same) == object.texture_of(id) && has_same_surface(same)))
      ++same;
    if (same == materials.size()) {
      scene.add_material(material, specular, roughness, opacity, object.texture_of(id));
      if (surface) scene.set_standard_surface(*surface);
    }
    numbers.push_back(same);
  }
  return numbers;
}

// Renumbers materials and named objects of an object and those within it.
void renumber(Object& object, const std::vector<MaterialId>& materials, uint32_t names) {
  const auto change = [&](auto& ids) {
    for (MaterialId& id : ids) id = materials[id];
  };
  for_each_pool([&](auto pool) { change(object.*pool.materials); });
  for (Mesh& mesh : object.meshes) change(mesh.materials);
  for (ObjectRange& range : object.object_ranges) range.object += names;
  for (Object& inner : object.prototypes) renumber(inner, materials, names);
}

int depth_of(const Object& scene) {
  int depth = 0;
  for (const Object& object : scene.prototypes) depth = std::max(depth, 1 + depth_of(object));
  return depth;
}

}  // namespace

uint32_t Scene::add_prototype(const Scene& prototype) {
  return guarded_work(0, [&] {
    core::Scene object = prototype.data_->scene;
    object.camera = {};
    if (!object.planes.empty()) refuse("an infinite plane cannot be instanced");
    if (object.has_moving()) refuse("moving primitives cannot be instanced");
    if (1 + depth_of(object) > kMaxNested)
      refuse(fmt::format("prototypes are nested more than {} deep", kMaxNested));
    if (const auto problems = validate(object); !problems.empty()) refuse(problems.front());
    core::Scene& scene = data_->scene;
    const std::vector<std::string> names = std::exchange(object.object_names, {});
    take_textures(scene, object);
    renumber(object, numbers_in(scene, object), uint32_t(scene.object_names.size()));
    scene.object_names.insert(scene.object_names.end(), names.begin(), names.end());
    scene.prototypes.push_back(std::move(object));
    return uint32_t(scene.prototypes.size() - 1);
  });
}

namespace {

void append_instances(core::Scene& scene, StridedArray<Instance> copies, std::string_view name) {
  bool far = scene.origin != Vec3d();
  for (size_t i = 0; i < copies.size(); ++i) {
    const Instance copy = std::as_const(copies)[i];
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
  scene.instances.append(copies);
}

}  // namespace

void Scene::add_instances(uint32_t prototype, const Column<float, 12>& matrices,
                          std::string_view name) {
  guarded([&] {
    auto copies =
        gathered<Instance>({constant_part(prototype, matrices.count), part("matrices", matrices)});
    append_instances(data_->scene, std::move(copies), name);
  });
}

void Scene::add_instances(const Column<uint32_t>& prototypes, const Column<float, 12>& matrices,
                          std::string_view name) {
  guarded([&] {
    auto copies = gathered<Instance>({part("prototypes", prototypes), part("matrices", matrices)});
    append_instances(data_->scene, std::move(copies), name);
  });
}

size_t Scene::primitive_count() const { return data_->scene.primitive_count(); }

size_t Scene::count(Kind kind) const {
  size_t count = 0, k = 0;
  for_each_pool([&](auto pool) {  // in the order of Kind
    if (k++ == size_t(kind)) count = (data_->scene.*pool.shapes).size();
  });
  return count;
}

size_t Scene::mesh_triangle_count() const {
  size_t count = 0;
  for (const Mesh& mesh : data_->scene.meshes) count += mesh.triangles.size();
  return count;
}

size_t Scene::instance_count() const { return data_->scene.instances.size(); }

std::optional<std::array<Triple, 2>> Scene::bounds() const { return bounds_of(data_->scene); }

}  // namespace raio::inline v1
