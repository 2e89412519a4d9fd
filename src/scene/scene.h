// What a scene file says, as plain data: no pointers but to its sky, no virtual calls, one pool per
// kind of thing and indices between them. Readers and generators fill it, accel/ bakes it for
// tracing. What must go by all of its arrays uses scene/columns.h, which names each of them once.
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

/// Where a camera looks from and at when it has moved, and when it begins to and ends.
struct CameraMovement {
  Vec3f from, at;
  float begin = 0, end = 1;

  friend bool operator==(const CameraMovement&, const CameraMovement&) = default;
};

/// How eye rays go: all from one point, or side by side from the plane through it that the line of
/// sight crosses at a right angle. What is as far away as `at` is as large in both. The numbers
/// stand in files.
enum class Projection : uint32_t { perspective, orthographic };

/// A pinhole or thin-lens camera, or one of parallel rays. Right is `to_at` x `up`; `up` need not
/// be perpendicular.
struct Camera {
  Vec3f from{0, 0, 0};
  Vec3f at{0, 0, -1};
  Vec3f up{0, 1, 0};
  float fov_deg = 45;            // vertical, from edge to edge, in (0, 180)
  float horizontal_fov_deg = 0;  // horizontal at least, whatever the shape of the picture; 0: any
  Projection projection = Projection::perspective;
  int width = 0, height = 0;  // pixels; 0: the file does not say

  // The thin lens, where the file gives one (P3F): radius and distance of the plane in focus, scene
  // units.
  std::optional<float> lens_radius, focus_distance;

  std::optional<CameraMovement> movement;

  bool is_parallel() const { return projection == Projection::orthographic; }

  friend bool operator==(const Camera&, const Camera&) = default;
};

/// The surface of `f` in NFF; see docs/shading.md for what it does with light.
struct Material {
  Rgb color{0.8f, 0.8f, 0.8f};
  float kd = 0.8f;         // diffuse part
  float ks = 0;            // highlight and mirror part
  float shine = 1;         // the highlight's cosine power
  float transmission = 0;  // T: part of the refracted ray
  float ior = 1;           // index of refraction inside

  friend bool operator==(const Material&, const Material&) = default;
};

/// How a texture goes on beyond its edges. The numbers stand in files.
enum class TextureWrap : uint32_t { repeat, clamp, mirror };

/// A picture on meshes: `width` x `height` of Scene::texels from `first` on, rows from top to
/// bottom. Several may share them.
struct Texture {
  uint32_t first = 0, width = 0, height = 0;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;

  friend bool operator==(const Texture&, const Texture&) = default;
};
inline constexpr uint32_t kNoTexture = 0xffffffffu;
inline constexpr uint32_t kLargestTexture = 16384;     // a side, texels
inline constexpr size_t kMaxTexels = size_t(1) << 28;  // of all together

/// More points of a light are not asked for.
inline constexpr int kMaxLightPoints = 1'000'000;

/// The sides of a light along x and z, scene units, and how many points of it the file asks for
/// (kept for writing: a sample takes one, however many there are of it).
struct LightExtent {
  float width = 0, depth = 0;
  int points = 1;

  friend bool operator==(const LightExtent&, const LightExtent&) = default;
};

/// A point light, which soft shadows make a square, or the rectangle that it has by `extent`.
struct Light {
  Vec3f position;
  std::optional<Rgb> color;             // without: 1 / sqrt(number of lights), white
  std::optional<LightExtent> extent{};  // NOLINT(readability-redundant-member-init)
};

/// The language of a scene's file, which decides the model of light that it means: that of NFF, of
/// P3F (docs/p3f.md), or, for data such as atoms, points and meshes, which say nothing of light,
/// that of figures (docs/ambient.md). The numbers stand in files.
enum class Dialect : uint32_t { nff, p3f, data };

/// The acceleration structure that a file asks for (P3F `accel`); no picture depends on it. The
/// numbers stand in files.
enum class AccelHint : uint32_t { any, none, grid, bvh };

/// A triangle or polygon corner list is indices into `Scene::positions`.
using TriangleIndices = std::array<uint32_t, 3>;
inline constexpr uint32_t kNoNormal = 0xffffffffu;

/// A polygon's corners are positions[first] ... positions[first + count - 1]; count >= 4 (three
/// corners make a triangle).
struct Polygon {
  uint32_t first = 0, count = 0;
};

/// Two coordinates on a picture: (0, 0) at its lower left corner, (1, 1) at the upper right one.
using Uv = std::array<float, 2>;

/// Triangles with vertices of their own, which carry more than the scene's do.
struct Mesh {
  Array<Vec3f> positions;
  // Of the vertices, each as long as `positions`, or empty.
  Array<Vec3f> normals;  // unit; as long as it likes where there are normal_indices
  Array<Uv> uv;
  Array<Rgb> colors;  // each multiplied into the material's

  Array<TriangleIndices> triangles;  // indices into `positions`
  /// Indices into `normals`, parallel to `triangles`; empty: those of `triangles`. A flat triangle
  /// has kNoNormal three times.
  Array<TriangleIndices> normal_indices;
  Array<MaterialId> materials;  // one for all, or one for each triangle
};

/// What objects are made of: the pools of a scene, its meshes and its copies. The numbers stand in
/// files.
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

/// Prototypes are nested at most this deep.
inline constexpr int kMaxNested = 16;

/// An instance of a prototype, placed by the matrix.
struct Instance {
  uint32_t prototype = 0;  // of Object::prototypes
  Matrix matrix = kIdentity;

  friend bool operator==(const Instance&, const Instance&) = default;
};

// The members that a caller may keep in columns of their own.
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

/// Shapes with several members may lie in columns; indices, which tracing reads in place, may not.
template <class Shape>
using ShapeArray =
    std::conditional_t<(kMemberOffsets<Shape>.size() > 1), StridedArray<Shape>, Array<Shape>>;

/// Geometry and what it looks like, which a scene may show in several places. Its materials are
/// numbers in Scene::materials, its objects numbers in Scene::object_names. Copies share all
/// arrays until one of them changes.
struct Object {
  /// All coordinates are stored as floats relative to this point, so that a scene far from zero
  /// keeps its digits. Zero unless a reader finds the camera far away compared with what it looks
  /// at.
  Vec3d origin;

  // Of each pool the materials are parallel to the shapes, and so are colours and opacities, which
  // are empty where no primitive of the kind has any. A colour takes the place of the material's,
  // and so does an opacity (0 to 1), the part of the light from behind that is kept back
  // (docs/ambient.md).
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

  // Of triangles and polygons.
  Array<Vec3f> positions;
  Array<Vec3f> normals;  // unit
  /// Indices into `normals`, parallel to `triangles`, or empty when no triangle is smooth. A flat
  /// triangle among smooth ones has kNoNormal three times.
  Array<TriangleIndices> triangle_normals;

  std::vector<Mesh> meshes;

  /// Which elements belong to which object of Scene::object_names: object `id` (from 1; 0 is none)
  /// is object_names[id - 1]. The ranges are sorted by pool, then by `first`, and no two overlap.
  Array<ObjectRange> object_ranges;

  /// Objects that are stored once and placed by `instances`: without planes and moving primitives.
  /// An instance without an object of its own shows those of its prototype.
  std::vector<Object> prototypes;
  ShapeArray<Instance> instances;

  size_t primitive_count() const;  // with those of instances

  /// Does any primitive move?
  bool has_moving() const { return !moving_spheres.empty() || !moving_triangles.empty(); }
};

/// What a file asks for, unless an option says otherwise. No picture has it by itself.
struct FileRequests {
  int samples_per_pixel = 0;  // P3F `spp`; 0: none
  AccelHint structure = AccelHint::any;
  /// P3F `env`: the folder of a cube map, relative to the scene's file or one of its parents;
  /// empty: none. read_scene() reads it into Scene::sky.
  std::string sky_folder;
  float near_clip = 0;  // NFF `hither`; kept for writing only
};

/// An object, where it is seen from, and what it is lit by and made of.
struct Scene : Object {
  std::string name;  // of the file, without folder and suffix
  Dialect dialect = Dialect::nff;
  FileRequests requests;

  Camera camera;
  Rgb background;
  /// In place of `background`; null: none, or the folder could not be read.
  std::shared_ptr<const CubeMap> sky;
  std::vector<Light> lights;

  Array<Material> materials;  // never empty in a valid scene
  // Parallel to `materials`, or empty where all are as NFF has them: the colour of highlight and
  // mirror (else white), how far mirrored and refracted directions spread (else 0;
  // docs/shading.md), and the opacity of what has none of its own (else 1).
  Array<Rgb> material_specular;
  Array<float> material_roughness, material_opacity;
  // The texture that a material's colour is multiplied by where a mesh has texture coordinates, or
  // kNoTexture; parallel to `materials`, or empty.
  Array<uint32_t> material_texture;
  Array<Texture> textures;
  Array<uint32_t> texels;  // 0xBBGGRR, display values (sRGB)

  std::vector<std::string> object_names;

  /// Is anything elsewhere at another time?
  bool moves() const { return has_moving() || camera.movement; }

  /// What the columns say of a material.
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
  /// Appends a material, and to the columns beside it what they then need.
  MaterialId add_material(const Material& material, Rgb specular = Rgb(1), float roughness = 0,
                          float opacity = 1, uint32_t texture = kNoTexture);
};

/// A pool and what belongs to its primitives, as members of Object.
template <class Shape>
struct PoolMembers {
  PoolKind kind;
  ShapeArray<Shape> Object::* shapes;
  StridedArray<MaterialId> Object::* materials;
  StridedArray<Rgb> Object::* colors;
  StridedArray<float> Object::* opacity;
};

/// All pools, named once: everything that treats them alike goes by this list.
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

/// How many primitives of each kind, indexed by ShapeKind.
std::array<size_t, kShapeKinds> count_primitives(const Object& object);

/// Makes primitives of all copies, so that nothing is an instance any more. The error is one line:
/// a copy that is stretched unevenly and whose primitives have no name then. What belongs to an
/// object still does.
std::string flatten_instances(Scene& scene);

/// Around all primitives but infinite planes.
Box3f bounds(const Object& object);

/// Is the opacity of anything below 1, in the scene or in an object of its?
bool any_transparent(const Scene& scene);
bool any_transparent(const Scene& scene, const Object& object);

/// Does any primitive have a colour of its own?
bool any_colors(const Object& object);

/// The largest component of those colours; 0 without any.
float brightest_color(const Object& object);
/// Of the colours of vertices; at least 1.
float brightest_tint(const Object& object);

/// The id of the object to which an element of a pool belongs; 0: to none. Takes the logarithm of
/// the number of ranges.
uint32_t object_of(const Object& object, PoolKind pool, size_t index);

/// What a scene may have that not every shading shows and not every format keeps.
enum class Feature : uint8_t {
  opacity,
  vertex_colors,
  texture_coordinates,
  textures,
  object_names,
  specular_colors,
  roughness,
  light_extents,
  sky,
  movement
};

/// How much the scene has of them, in one line, as in "opacity of 12 spheres, names of 3 objects";
/// empty where it has none.
std::string text_of(const Scene& scene, std::initializer_list<Feature> features);

/// The sum of the sizes of all arrays, in bytes.
size_t memory_bytes(const Scene& scene);
size_t memory_bytes(const Object& object);

/// The camera as it is at a time, which does not move.
Camera camera_at(const Camera& camera, float time);

/// Why a camera with finite numbers looks nowhere, now or on its way, or nothing.
std::string camera_problem(const Camera& camera);

/// A prototype as a scene of its own, with the materials of the scene around it.
Scene standalone(const Scene& around, const Object& object);

/// A name of all that a picture can depend on, 32 hexadecimal digits: the same for two files that
/// differ in comments, spelling or name only. `near_clip` and the names of objects do not count.
std::string content_hash(const Scene& scene);

/// What makes a scene unfit for rendering, one sentence each, naming the element by its index;
/// empty for a sound scene. Readers report the same with line and column before it comes to this;
/// scenes made in code meet it first. Checks that all numbers are finite, sizes positive, indices
/// in range, pools of equal length, and that the camera has a direction. Works on all threads.
std::vector<std::string> validate(const Scene& scene);

}  // namespace raio::core
