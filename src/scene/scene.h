// A scene as plain data: one pool per kind of primitive, indices instead of pointers (except for
// the sky), no virtual calls. Readers and generators fill it; accel/ bakes it for tracing. Code
// that handles all arrays uses scene/columns.h, which lists each of them once.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/array.h"
#include "base/box.h"
#include "base/placement.h"
#include "base/strided_array.h"
#include "base/vec.h"
#include "shape/cone.h"
#include "shape/disc.h"
#include "shape/ellipsoid.h"
#include "shape/kinds.h"
#include "shape/moving_sphere.h"
#include "shape/moving_triangle.h"
#include "shape/plane.h"
#include "shape/sphere.h"

namespace raio::core {

struct CubeMap;  // scene/cube_map.h

using MaterialId = uint32_t;

/// The end position of a moving camera, and the times at which the movement begins and ends.
struct CameraMovement {
  Vec3f from, at;
  float begin = 0, end = 1;

  friend bool operator==(const CameraMovement&, const CameraMovement&) = default;
};

/// The directions of eye rays: all from one point, or parallel, from a plane through that point
/// perpendicular to the line of sight. Objects as far away as `at` have the same size in both. Or
/// in all directions, as azimuth and altitude (integrate/camera.h). Files store the numbers.
enum class Projection : uint32_t { perspective, orthographic, omnidirectional };

/// A pinhole, thin-lens, orthographic or omnidirectional camera. Right is `to_at` x `up`; `up` need
/// not be perpendicular.
struct Camera {
  Vec3f from{0, 0, 0};
  Vec3f at{0, 0, -1};
  Vec3f up{0, 1, 0};
  float fov_deg = 45;            // vertical, from edge to edge, in (0, 180)
  float horizontal_fov_deg = 0;  // at least this, for any shape of the picture; 0: any
  Projection projection = Projection::perspective;
  int width = 0, height = 0;  // pixels; 0: not given by the file

  // The thin lens, if the file has one (P3F): radius and distance of the plane in focus, scene
  // units.
  std::optional<float> lens_radius, focus_distance;

  std::optional<CameraMovement> movement;

  bool is_parallel() const { return projection == Projection::orthographic; }
  bool is_omnidirectional() const { return projection == Projection::omnidirectional; }
  bool can_have_lens() const { return projection == Projection::perspective; }

  friend bool operator==(const Camera&, const Camera&) = default;
};

/// The surface of `f` in NFF; docs/shading.md describes its shading.
struct Material {
  Rgb color{0.8f, 0.8f, 0.8f};
  float kd = 0.8f;         // diffuse part
  float ks = 0;            // highlight and mirror part
  float shine = 1;         // the highlight's cosine power
  float transmission = 0;  // T: part of the refracted ray
  float ior = 1;           // index of refraction inside

  friend bool operator==(const Material&, const Material&) = default;
};

inline constexpr uint32_t kNoTexture = 0xffffffffu;

/// What the alpha of a base colour means, as in glTF. Files store the numbers.
enum class AlphaMode : uint32_t { opaque, mask, blend };

/// A surface for the integrator `path`, with the parameters of glTF 2.0 and its extensions
/// (docs/materials.md). Base colour and index of refraction are Material::color and ::ior.
struct StandardSurface {
  uint32_t is_standard = 1;  // 0: `path` maps the Material instead
  float metallic = 0;
  float roughness = 1;  // the square root of alpha of GGX
  float specular = 1;   // scales the reflection of dielectrics
  Rgb specular_color{1, 1, 1};
  float transmission = 0;  // part of the light that is not reflected, refracted instead of diffuse
  uint32_t is_thin = 1;    // transmits without refraction, as a sheet
  Rgb attenuation_color{1, 1, 1};  // what is left inside after attenuation_distance
  float attenuation_distance = 0;  // scene units; 0: any
  Rgb emission{0, 0, 0};           // radiance
  float coat = 0, coat_roughness = 0;
  Rgb sheen_color{0, 0, 0};
  float sheen_roughness = 0;
  uint32_t is_two_sided = 1;
  uint32_t is_unlit = 0;  // reflects nothing; `emission` is the base colour
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  float normal_scale = 1;
  // Textures, or kNoTexture. Roughness is in the green, metallic in the blue channel.
  uint32_t metallic_roughness_texture = kNoTexture, normal_texture = kNoTexture,
           emission_texture = kNoTexture, transmission_texture = kNoTexture;

  friend bool operator==(const StandardSurface&, const StandardSurface&) = default;
};

/// How a texture continues beyond its edges. Files store the numbers.
enum class TextureWrap : uint32_t { repeat, clamp, mirror };

/// A picture for meshes: `width` x `height` of Scene::texels starting at `first`, rows from top to
/// bottom. Textures may share texels.
struct Texture {
  uint32_t first = 0, width = 0, height = 0;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;

  friend bool operator==(const Texture&, const Texture&) = default;
};
inline constexpr uint32_t kLargestTexture = 16384;     // a side, texels
inline constexpr size_t kMaxTexels = size_t(1) << 28;  // of all together

/// The maximum number of points of a light.
inline constexpr int kMaxLightPoints = 1'000'000;

/// The sides of a light along x and z, scene units, and the number of its points in the file, which
/// is kept for writing only: a sample takes one point in any case.
struct LightExtent {
  float width = 0, depth = 0;
  int points = 1;

  friend bool operator==(const LightExtent&, const LightExtent&) = default;
};

/// A point light, which soft shadows turn into a square, or a rectangle if it has an `extent`.
struct Light {
  Vec3f position;
  std::optional<Rgb> color;             // nothing: white, 1 / sqrt(number of lights)
  std::optional<LightExtent> extent{};  // NOLINT(readability-redundant-member-init)
};

/// The kinds of physical lights. Files store the numbers.
enum class LightKind : uint32_t { point, directional, spot, quad, ring };
inline constexpr auto kLightKindNames =
    std::to_array<std::string_view>({"point", "directional", "spot", "quad", "ring"});

/// A light in physical units (docs/ambient.md), unlike those of NFF. Angles are in degrees.
struct PhysicalLight {
  LightKind kind = LightKind::point;
  Rgb color{1, 1, 1};  // intensity of points and spots; irradiance; radiance of quads and rings
  Vec3f position;      // of points and spots; the centre of a ring; a corner of a quad
  Vec3f direction{0, 0, -1};   // in which directional lights, spots and rings shine, of any length
  float angular_diameter = 0;  // of directional lights
  float opening = 180, falloff = 0;      // of spots and rings: the cone and its border inside
  Vec3f edge1{1, 0, 0}, edge2{0, 1, 0};  // of a quad
  uint32_t front = 1, back = 0;          // whether a quad emits towards edge1 x edge2, or back
  float radius = 0, inner_radius = 0;    // of a ring; radius 0: as a spot
};

/// A picture of the light from infinitely far away: `width` x `height` of
/// Scene::environment_texels, rows from `up` to down, the middle column towards `direction`, the
/// next ones to the right of it as seen from within.
struct Environment {
  uint32_t width = 0, height = 0;
  Vec3f up{0, 0, 1}, direction{1, 0, 0};
  uint32_t visible = 1;  // whether eye rays see it
};

/// The language of a scene's file, which selects the shading: that of NFF, that of P3F
/// (docs/p3f.md), or, for data without lighting such as atoms, points and meshes, that of figures
/// (docs/ambient.md). Files store the numbers.
enum class Dialect : uint32_t { nff, p3f, data };

/// The acceleration structure requested by a file (P3F `accel`); it does not change the picture.
/// Files store the numbers.
enum class AccelHint : uint32_t { any, none, grid, bvh };

/// The vertices of a triangle, as indices into `Scene::positions`.
using TriangleIndices = std::array<uint32_t, 3>;
inline constexpr uint32_t kNoNormal = 0xffffffffu;

/// The vertices of a polygon are positions[first] ... positions[first + count - 1]; count >= 4 (a
/// polygon with three vertices is stored as a triangle).
struct Polygon {
  uint32_t first = 0, count = 0;
};

/// Texture coordinates: (0, 0) at the lower left corner, (1, 1) at the upper right one.
using Uv = std::array<float, 2>;

/// Triangles with their own vertices, which have more attributes than those of the scene.
struct Mesh {
  Array<Vec3f> positions;
  // Attributes of vertices, each as long as `positions`, or empty.
  Array<Vec3f> normals;  // unit; of any length if there are normal_indices
  Array<Uv> uv;
  Array<Rgb> colors;  // multiplied by the material's colour

  Array<TriangleIndices> triangles;  // indices into `positions`
  /// Indices into `normals`, parallel to `triangles`; empty: those of `triangles`. A flat triangle
  /// has kNoNormal three times.
  Array<TriangleIndices> normal_indices;
  Array<MaterialId> materials;  // one for the whole mesh, or one per triangle
};

/// The pools of an object, including meshes and instances. Files store the numbers.
enum class PoolKind : uint32_t {
  plane,
  sphere,
  cone,
  triangle,
  polygon,
  mesh,
  ellipsoid,
  disc,
  moving_sphere,
  moving_triangle,
  instance
};
inline constexpr auto kPoolNames = std::to_array<std::string_view>(
    {"plane", "sphere", "cone", "triangle", "polygon", "mesh", "ellipsoid", "disc", "moving_sphere",
     "moving_triangle", "instance"});

/// The elements first ... first + count - 1 of a pool, which belong to an object.
struct ObjectRange {
  PoolKind pool = PoolKind::plane;
  uint32_t first = 0, count = 0;
  uint32_t object = 0;  // its id

  friend bool operator==(const ObjectRange&, const ObjectRange&) = default;
};

/// The maximum depth of nested prototypes.
inline constexpr int kMaxNested = 16;

/// An instance of a prototype, transformed by the matrix.
struct Instance {
  uint32_t prototype = 0;  // of Object::prototypes
  Matrix matrix = kIdentity;

  friend bool operator==(const Instance&, const Instance&) = default;
};

// The shapes with members that a caller may store in separate columns.
template <>
inline constexpr std::array kMemberOffsets<Sphere> = {offsetof(Sphere, center),
                                                      offsetof(Sphere, radius)};
template <>
inline constexpr std::array kMemberOffsets<Cone> = {
    offsetof(Cone, base), offsetof(Cone, base_radius), offsetof(Cone, apex),
    offsetof(Cone, apex_radius)};
template <>
inline constexpr std::array kMemberOffsets<Ellipsoid> = {offsetof(Ellipsoid, center),
                                                         offsetof(Ellipsoid, axes)};
template <>
inline constexpr std::array kMemberOffsets<Disc> = {offsetof(Disc, center), offsetof(Disc, normal),
                                                    offsetof(Disc, radius), offsetof(Disc, inner)};
template <>
inline constexpr std::array kMemberOffsets<MovingSphere> = {
    offsetof(MovingSphere, center), offsetof(MovingSphere, to), offsetof(MovingSphere, radius),
    offsetof(MovingSphere, begin), offsetof(MovingSphere, end)};
template <>
inline constexpr std::array kMemberOffsets<MovingTriangle> = {
    offsetof(MovingTriangle, from), offsetof(MovingTriangle, to), offsetof(MovingTriangle, begin),
    offsetof(MovingTriangle, end)};
template <>
inline constexpr std::array kMemberOffsets<Instance> = {offsetof(Instance, prototype),
                                                        offsetof(Instance, matrix)};

/// Shapes with several members may be stored as columns; indices, which tracing reads in place, may
/// not.
template <class Shape>
using ShapeArray =
    std::conditional_t<(kMemberOffsets<Shape>.size() > 1), StridedArray<Shape>, Array<Shape>>;

/// Geometry with its materials, which a scene may show in several places. Materials are indices
/// into Scene::materials, objects ids for Scene::object_names. Copies share all arrays until one of
/// them changes.
struct Object {
  /// All coordinates are floats relative to this point, so a scene far from zero keeps its
  /// precision. Zero, unless a reader finds that the scene is far from zero relative to its size.
  Vec3d origin;

  // In each pool, materials are parallel to the shapes; so are colours and opacities, which are
  // empty if no primitive of the kind has one. A colour replaces the material's, and so does an
  // opacity (0 to 1), the absorbed fraction of the light from behind (docs/ambient.md).
  ShapeArray<Plane> planes;
  ShapeArray<Sphere> spheres;
  ShapeArray<Cone> cones;  // and cylinders
  ShapeArray<Ellipsoid> ellipsoids;
  ShapeArray<Disc> discs;
  ShapeArray<MovingSphere> moving_spheres;
  ShapeArray<MovingTriangle> moving_triangles;
  ShapeArray<TriangleIndices> triangles;
  ShapeArray<Polygon> polygons;
  StridedArray<MaterialId> plane_materials, sphere_materials, cone_materials, ellipsoid_materials,
      disc_materials, moving_sphere_materials, moving_triangle_materials, triangle_materials,
      polygon_materials;
  StridedArray<Rgb> plane_colors, sphere_colors, cone_colors, ellipsoid_colors, disc_colors,
      moving_sphere_colors, moving_triangle_colors, triangle_colors, polygon_colors;
  StridedArray<float> plane_opacity, sphere_opacity, cone_opacity, ellipsoid_opacity, disc_opacity,
      moving_sphere_opacity, moving_triangle_opacity, triangle_opacity, polygon_opacity;

  // Shared by triangles and polygons.
  Array<Vec3f> positions;
  Array<Vec3f> normals;  // unit
  /// Indices into `normals`, parallel to `triangles`, or empty when no triangle is smooth. A flat
  /// triangle among smooth ones has kNoNormal three times.
  Array<TriangleIndices> triangle_normals;

  std::vector<Mesh> meshes;

  /// The elements of each object: object `id` (from 1; 0 is none) has the name
  /// Scene::object_names[id - 1]. The ranges are sorted by pool, then by `first`, and do not
  /// overlap.
  Array<ObjectRange> object_ranges;

  /// Objects that are stored once and placed by `instances`, without planes and moving primitives.
  /// If an instance belongs to no named object, the objects within its prototype are used.
  std::vector<Object> prototypes;
  ShapeArray<Instance> instances;

  size_t primitive_count() const;  // includes those of instances

  /// Whether any primitive moves.
  bool has_moving() const { return !moving_spheres.empty() || !moving_triangles.empty(); }
};

/// Requests of a file, which options override. No picture depends on them directly.
struct FileRequests {
  int samples_per_pixel = 0;  // P3F `spp`; 0: none
  AccelHint structure = AccelHint::any;
  /// P3F `env`: the folder of a cube map, relative to the scene's file or one of its parents;
  /// empty: none. read_scene() reads it into Scene::sky.
  std::string sky_folder;
  float near_clip = 0;  // NFF `hither`; kept for writing only
};

/// An object with a camera, lights and materials.
struct Scene : Object {
  std::string name;  // of the file, without folder and extension
  Dialect dialect = Dialect::nff;
  FileRequests requests;

  Camera camera;
  Rgb background;
  /// Replaces `background`; null: none, or the folder could not be read.
  std::shared_ptr<const CubeMap> sky;
  std::vector<Light> lights;
  Array<PhysicalLight> physical_lights;
  Array<Environment> environment;  // at most one
  Array<Rgb> environment_texels;   // radiance

  Array<Material> materials;  // never empty in a valid scene
  // Parallel to `materials`, or empty if all have the defaults of NFF: the colour of highlight and
  // mirror (white), the spread of mirrored and refracted directions (0; docs/shading.md), and the
  // opacity of primitives without their own (1).
  Array<Rgb> material_specular;
  Array<float> material_roughness, material_opacity;
  // The texture multiplied by the material's colour where a mesh has texture coordinates, or
  // kNoTexture; parallel to `materials`, or empty.
  Array<uint32_t> material_texture;
  Array<Texture> textures;
  Array<uint32_t> texels;  // 0xTTBBGGRR: display values (sRGB) or data; T: 255 - alpha
  Array<StandardSurface> standard_surfaces;  // parallel to `materials`, or empty

  std::vector<std::string> object_names;

  /// Whether the camera or any primitive moves.
  bool moves() const { return has_moving() || camera.movement; }

  /// The values of a material in the columns, or their defaults.
  Rgb specular_of(MaterialId id) const {
    return material_specular.empty() ? Rgb(1) : material_specular[id];
  }
  float roughness_of(MaterialId id) const {
    return material_roughness.empty() ? 0 : material_roughness[id];
  }
  float opacity_of(MaterialId id) const {
    return material_opacity.empty() ? 1 : material_opacity[id];
  }
  uint32_t texture_of(MaterialId id) const {
    return material_texture.empty() ? kNoTexture : material_texture[id];
  }
  /// Null if the material is NFF's.
  const StandardSurface* standard_surface_of(MaterialId id) const {
    if (standard_surfaces.empty() || !standard_surfaces[id].is_standard) return nullptr;
    return &standard_surfaces[id];
  }
  /// Whether the alpha of the material's texture lets rays pass triangles.
  bool has_cutouts(MaterialId id) const {
    const StandardSurface* const surface = standard_surface_of(id);
    if (!surface || surface->alpha_mode == AlphaMode::opaque) return false;
    return texture_of(id) != kNoTexture ||
           (surface->alpha_mode == AlphaMode::mask && surface->alpha_cutoff > 1);
  }
  bool has_cutouts() const;
  /// Whether any surface emits light.
  bool has_emission() const;
  /// Makes the last material a standard surface.
  void set_standard_surface(const StandardSurface& surface);
  /// Appends a material, and extends the columns that it needs.
  MaterialId add_material(const Material& material, Rgb specular = Rgb(1), float roughness = 0,
                          float opacity = 1, uint32_t texture = kNoTexture);
  /// Appends a standard surface with the colour and the index of refraction of `classic`, which
  /// other integrators than `path` show. `alpha`, and the texture's, are those of the base colour,
  /// used as `surface.alpha_mode` says; opaque ones use neither the texture's nor a cutoff.
  MaterialId add_standard_material(StandardSurface surface, const Material& classic,
                                   float alpha = 1, uint32_t texture = kNoTexture,
                                   Rgb specular = Rgb(1), float roughness = 0);
};

/// A pool and its columns, as members of Object.
template <class Shape>
struct PoolMembers {
  PoolKind kind;
  ShapeArray<Shape> Object::* shapes;
  StridedArray<MaterialId> Object::* materials;
  StridedArray<Rgb> Object::* colors;
  StridedArray<float> Object::* opacity;
};

/// All pools, listed once, for code that treats them alike.
inline constexpr std::tuple kScenePools = {
    PoolMembers<Plane>{PoolKind::plane, &Object::planes, &Object::plane_materials,
                       &Object::plane_colors, &Object::plane_opacity},
    PoolMembers<Sphere>{PoolKind::sphere, &Object::spheres, &Object::sphere_materials,
                        &Object::sphere_colors, &Object::sphere_opacity},
    PoolMembers<Cone>{PoolKind::cone, &Object::cones, &Object::cone_materials, &Object::cone_colors,
                      &Object::cone_opacity},
    PoolMembers<TriangleIndices>{PoolKind::triangle, &Object::triangles,
                                 &Object::triangle_materials, &Object::triangle_colors,
                                 &Object::triangle_opacity},
    PoolMembers<Polygon>{PoolKind::polygon, &Object::polygons, &Object::polygon_materials,
                         &Object::polygon_colors, &Object::polygon_opacity},
    PoolMembers<Ellipsoid>{PoolKind::ellipsoid, &Object::ellipsoids, &Object::ellipsoid_materials,
                           &Object::ellipsoid_colors, &Object::ellipsoid_opacity},
    PoolMembers<Disc>{PoolKind::disc, &Object::discs, &Object::disc_materials, &Object::disc_colors,
                      &Object::disc_opacity},
    PoolMembers<MovingSphere>{PoolKind::moving_sphere, &Object::moving_spheres,
                              &Object::moving_sphere_materials, &Object::moving_sphere_colors,
                              &Object::moving_sphere_opacity},
    PoolMembers<MovingTriangle>{PoolKind::moving_triangle, &Object::moving_triangles,
                                &Object::moving_triangle_materials, &Object::moving_triangle_colors,
                                &Object::moving_triangle_opacity},
};
static_assert(kPoolNames.size() == std::tuple_size_v<decltype(kScenePools)> + 2,
              "each pool, and those of meshes and instances, has a name");

template <class Shape>
inline constexpr PoolMembers<Shape> kPoolOf = std::get<PoolMembers<Shape>>(kScenePools);

/// Calls f(members) for each.
template <class F>
constexpr void for_each_pool(F&& f) {
  std::apply([&](const auto&... members) { (f(members), ...); }, kScenePools);
}

constexpr ShapeKind shape_kind(const TriangleIndices&) { return ShapeKind::triangle; }
constexpr ShapeKind shape_kind(const Polygon&) { return ShapeKind::polygon; }
static_assert(std::apply(
                  []<class... Shape>(PoolMembers<Shape>...) {
                    return ((size_t(shape_kind(Shape())) < kShapeKindNames.size()) && ...);
                  },
                  kScenePools),
              "each ShapeKind has a name");

/// The number of primitives of each kind, indexed by ShapeKind.
std::array<size_t, kShapeKinds> count_primitives(const Object& object);

/// Replaces all instances by primitives, which keep their objects. The error is one line: a
/// non-uniform scale that turns a primitive into a shape that Raio does not have.
std::string flatten_instances(Scene& scene);

/// Encloses all primitives except infinite planes.
Box3f bounds(const Object& object);

/// Whether the scene or any of its objects has an opacity below 1.
bool any_transparent(const Scene& scene);
bool any_transparent(const Scene& scene, const Object& object);

/// Whether any primitive has its own colour.
bool any_colors(const Object& object);

/// The largest component of those colours; 0 without any.
float brightest_color(const Object& object);
/// The same for vertex colours; at least 1.
float brightest_tint(const Object& object);

/// The id of the object that owns an element of a pool; 0: none. Takes logarithmic time in the
/// number of ranges.
uint32_t object_of(const Object& object, PoolKind pool, size_t index);

/// Features of a scene that some shadings do not show and some formats do not store.
enum class Feature : uint8_t {
  opacity,
  vertex_colors,
  texture_coordinates,
  textures,
  object_names,
  specular_colors,
  roughness,
  light_extents,
  physical_lights,
  sky,
  environment,
  movement,
  all_directions
};

/// The numbers of these features in the scene, in one line, such as "opacity of 12 spheres, names
/// of 3 objects"; empty if there are none.
std::string text_of(const Scene& scene, std::initializer_list<Feature> features);

/// The sum of the sizes of all arrays, in bytes.
size_t memory_bytes(const Scene& scene);
size_t memory_bytes(const Object& object);

/// The camera at a time, without movement.
Camera camera_at(const Camera& camera, float time);

/// Why a camera with finite numbers has no valid direction, at the start or during its movement;
/// empty if it has one.
std::string camera_problem(const Camera& camera);

/// A prototype as a separate scene, with the materials of the scene around it.
Scene standalone(const Scene& around, const Object& object);

/// A hash of everything that a picture can depend on, 32 hexadecimal digits: equal for two files
/// that differ only in comments, spelling or name. `near_clip` and object names do not count.
std::string content_hash(const Scene& scene);

/// The first fault of a standard surface with an index of refraction, in a scene with this number
/// of textures, which names the parameter as the library does; empty if it is sound.
std::string fault_of(const StandardSurface& surface, float ior, size_t textures);

/// The faults that prevent rendering, one sentence each, naming the element by its index; empty for
/// a valid scene. Readers report the same faults earlier, with line and column, so mostly scenes
/// made in code fail here. Checks that all numbers are finite, sizes positive, indices in range,
/// pools of equal length, and that the camera has a direction. Works on all threads.
std::vector<std::string> validate(const Scene& scene);

}  // namespace raio::core
