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
#include "base/vec.h"
#include "shape/cone.h"
#include "shape/disc.h"
#include "shape/ellipsoid.h"
#include "shape/kinds.h"
#include "shape/moving_sphere.h"
#include "shape/moving_triangle.h"
#include "shape/plane.h"
#include "shape/sphere.h"

namespace raio {

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
  float near_clip = 0;        // kept for writing; a ray tracer needs no front plane
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

/// So deep at most are prototypes within prototypes.
inline constexpr int kMaxNested = 16;

/// A copy of an object, where the matrix places it.
struct Instance {
  uint32_t prototype = 0;  // of Scene::prototypes
  Matrix matrix = kIdentity;

  friend bool operator==(const Instance&, const Instance&) = default;
};

struct Scene {
  std::string name;  // of the file, without folder and suffix

  /// All coordinates are stored as floats relative to this point, so that a scene far from zero
  /// keeps its digits. Zero unless a reader finds the camera far away compared with what it looks
  /// at.
  Vec3d origin;

  Camera camera;
  Rgb background;
  std::vector<Light> lights;
  Array<Material> materials;  // never empty in a valid scene
  // Parallel to `materials`, or empty where all are as NFF has them: the colour of highlight and
  // mirror (else white), how far mirrored and refracted directions spread (else 0;
  // docs/shading.md), and the opacity of what has none of its own (else 1).
  Array<Rgb> material_specular;
  Array<float> material_roughness, material_opacity;
  // The texture that a material's colour is multiplied by where a mesh has texture coordinates, or
  // kNoTexture; parallel to `materials`, or empty. The scene that is rendered has the textures, its
  // prototypes have this column only.
  Array<uint32_t> material_texture;
  Array<Texture> textures;
  Array<uint32_t> texels;  // 0xBBGGRR, display values (sRGB)
  Dialect dialect = Dialect::nff;
  // What the file asks for, unless an option says otherwise.
  int samples_per_pixel = 0;  // P3F `spp`; 0: none
  AccelHint structure = AccelHint::any;
  std::string sky_folder;  // P3F env: the folder of a cube map, relative to the scene's file or one
                           // of its parents; empty: none
  /// What is in that folder, in place of `background`. read_scene() reads it; null where it could
  /// not.
  std::shared_ptr<const CubeMap> sky;

  Array<Plane> planes;
  Array<MaterialId> plane_materials;

  Array<Sphere> spheres;
  Array<MaterialId> sphere_materials;

  Array<Cone> cones;  // and cylinders
  Array<MaterialId> cone_materials;

  Array<Ellipsoid> ellipsoids;
  Array<MaterialId> ellipsoid_materials;

  Array<Disc> discs;
  Array<MaterialId> disc_materials;

  Array<MovingSphere> moving_spheres;
  Array<MaterialId> moving_sphere_materials;

  Array<MovingTriangle> moving_triangles;
  Array<MaterialId> moving_triangle_materials;

  Array<Vec3f> positions;
  Array<Vec3f> normals;  // unit

  Array<TriangleIndices> triangles;
  Array<MaterialId> triangle_materials;
  /// Indices into `normals`, parallel to `triangles`, or empty when no triangle is smooth. A flat
  /// triangle among smooth ones has kNoNormal three times.
  Array<TriangleIndices> triangle_normals;

  Array<Polygon> polygons;
  Array<MaterialId> polygon_materials;

  // Each is parallel to its pool, or empty where no primitive of the kind has any. A colour takes
  // the place of the material's, and so does an opacity (0 to 1), the part of the light from behind
  // that is kept back (docs/ambient.md).
  Array<Rgb> plane_colors, sphere_colors, cone_colors, triangle_colors, polygon_colors,
      ellipsoid_colors, disc_colors, moving_sphere_colors, moving_triangle_colors;
  Array<float> plane_opacity, sphere_opacity, cone_opacity, triangle_opacity, polygon_opacity,
      ellipsoid_opacity, disc_opacity, moving_sphere_opacity, moving_triangle_opacity;

  std::vector<Mesh> meshes;

  /// Parts of the scene with a name: object `id` (from 1; 0 is none) is object_names[id - 1]. The
  /// ranges are sorted by pool, then by `first`, and no two overlap.
  std::vector<std::string> object_names;
  Array<ObjectRange> object_ranges;

  /// Objects that are stored once and copied by `instances`. Of each only primitives that stand
  /// still, meshes, instances of its own and object ranges count; its materials and the names of
  /// its objects are those of this scene. A copy without an object of its own shows those.
  std::vector<Scene> prototypes;
  Array<Instance> instances;

  size_t primitive_count() const;  // with those of copies

  /// Is anything elsewhere at another time?
  bool moves() const {
    return !moving_spheres.empty() || !moving_triangles.empty() || camera.movement;
  }

  /// What the two columns say of a material.
  Rgb specular_of(MaterialId id) const {
    return material_specular.empty() ? Rgb(1) : material_specular[id];
  }
  float roughness_of(MaterialId id) const {
    return material_roughness.empty() ? 0 : material_roughness[id];
  }
  /// Appends a material, and to the columns beside it what they then need.
  MaterialId add_material(const Material& material, Rgb specular = Rgb(1), float roughness = 0,
                          float opacity = 1, uint32_t texture = kNoTexture);
};

/// A pool and what belongs to its primitives, as members of Scene.
template <class Shape>
struct PoolMembers {
  PoolKind kind;
  Array<Shape> Scene::* shapes;
  Array<MaterialId> Scene::* materials;
  Array<Rgb> Scene::* colors;
  Array<float> Scene::* opacity;
};

/// All pools, named once: everything that treats them alike goes by this list.
inline constexpr std::tuple kScenePools = {
    PoolMembers{PoolKind::plane, &Scene::planes, &Scene::plane_materials, &Scene::plane_colors,
                &Scene::plane_opacity},
    PoolMembers{PoolKind::sphere, &Scene::spheres, &Scene::sphere_materials, &Scene::sphere_colors,
                &Scene::sphere_opacity},
    PoolMembers{PoolKind::cone, &Scene::cones, &Scene::cone_materials, &Scene::cone_colors,
                &Scene::cone_opacity},
    PoolMembers{PoolKind::triangle, &Scene::triangles, &Scene::triangle_materials,
                &Scene::triangle_colors, &Scene::triangle_opacity},
    PoolMembers{PoolKind::polygon, &Scene::polygons, &Scene::polygon_materials,
                &Scene::polygon_colors, &Scene::polygon_opacity},
    PoolMembers{PoolKind::ellipsoid, &Scene::ellipsoids, &Scene::ellipsoid_materials,
                &Scene::ellipsoid_colors, &Scene::ellipsoid_opacity},
    PoolMembers{PoolKind::disc, &Scene::discs, &Scene::disc_materials, &Scene::disc_colors,
                &Scene::disc_opacity},
    PoolMembers{PoolKind::moving_sphere, &Scene::moving_spheres, &Scene::moving_sphere_materials,
                &Scene::moving_sphere_colors, &Scene::moving_sphere_opacity},
    PoolMembers{PoolKind::moving_triangle, &Scene::moving_triangles,
                &Scene::moving_triangle_materials, &Scene::moving_triangle_colors,
                &Scene::moving_triangle_opacity},
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
std::array<size_t, kShapeKinds> count_primitives(const Scene& scene);

/// Makes primitives of all copies, so that nothing is an instance any more. The error is one line:
/// a copy that is stretched unevenly and whose primitives have no name then. What belongs to an
/// object still does.
std::string flatten_instances(Scene& scene);

/// Around all primitives but infinite planes.
Box3f bounds(const Scene& scene);

/// Is the opacity of anything below 1?
bool any_transparent(const Scene& scene);

/// Does any primitive have a colour of its own?
bool any_colors(const Scene& scene);

/// The largest component of those colours; 0 without any.
float brightest_color(const Scene& scene);
/// Of the colours of vertices; at least 1.
float brightest_tint(const Scene& scene);

/// The id of the object to which an element of a pool belongs; 0: to none. Takes the logarithm of
/// the number of ranges.
uint32_t object_of(const Scene& scene, PoolKind pool, size_t index);

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

/// The sum of the sizes of the pools, in bytes.
size_t memory_bytes(const Scene& scene);

/// The camera as it is at a time, which does not move.
Camera camera_at(const Camera& camera, float time);

/// Why a camera with finite numbers looks nowhere, now or on its way, or nothing.
std::string camera_problem(const Camera& camera);

/// A name of all that a picture can depend on, 32 hexadecimal digits: the same for two files that
/// differ in comments, spelling or name only. `near_clip` and the names of objects do not count.
std::string content_hash(const Scene& scene);

/// What makes a scene unfit for rendering, one sentence each, naming the element by its index;
/// empty for a sound scene. Readers report the same with line and column before it comes to this;
/// scenes made in code meet it first. Checks that all numbers are finite, sizes positive, indices
/// in range, pools of equal length, and that the camera has a direction. Works on all threads.
std::vector<std::string> validate(const Scene& scene);

}  // namespace raio
