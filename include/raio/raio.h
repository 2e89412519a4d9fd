// Raio: a fast, reproducible ray tracer. This is the whole interface of the library; it needs only
// the standard library of C++17.
//
//   raio::Scene scene = raio::Scene::read("balls.nff");
//   raio::Settings settings;
//   settings.set("size", {640, 480}).set("aa", 4).set("soft-shadows");
//   raio::Job(scene, settings).run().write("balls.png");
//
// The library never prints, never ends the program and changes no global state. Failures are thrown
// as raio::Error. The same scene and settings give the same bytes for any number of threads and on
// any machine. One thread at a time may use an object; any number may call cancel() and const
// functions of an Accel.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#if defined(__GNUC__)
#define RAIO_API __attribute__((visibility("default")))
#else
#define RAIO_API
#endif

// The version is part of the linker's names, not of those in programs.
namespace raio {
inline namespace v1 {

/// Three numbers: x, y, z of a point in scene units, or red, green, blue of a colour; 1 is the
/// display's white.
using Triple = std::array<double, 3>;

enum class ErrorKind {
  bad_input,     ///< an invalid file, scene or value; the message says what is valid
  cannot_write,  ///< a file could not be written; no partial file is left
  no_resource,   ///< out of memory, or a missing library
  cancelled      ///< cancel() of a Job or an Executor was called
};

/// One line that says what was found and what was expected.
class RAIO_API Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message, std::string file = {}, int line = 0,
        int column = 0);
  ErrorKind kind() const noexcept { return kind_; }
  /// For scene files: the name, line and column of the first error, counted from 1; 0: none.
  const std::string& file() const noexcept { return file_; }
  int line() const noexcept { return line_; }
  int column() const noexcept { return column_; }

 private:
  ErrorKind kind_;
  std::string file_;
  int line_, column_;
};

/// The classic surface (docs/shading.md): `kd` scales the diffuse colour, `ks` highlights and
/// mirror reflection, `transmission` refracted rays.
struct Material {
  Triple color{0.8, 0.8, 0.8};
  double kd = 0.8, ks = 0;
  double shine = 1;          ///< the highlight's exponent
  double transmission = 0;   ///< 0 opaque
  double ior = 1;            ///< index of refraction inside, above 0
  Triple specular{1, 1, 1};  ///< colour of highlights and mirror reflection
  double roughness = 0;      ///< spread of reflected and refracted rays (docs/shading.md)
  double opacity = 1;        ///< of primitives without their own, 0 to 1
  /// A texture of add_texture(), multiplied by the colour on meshes with texture coordinates.
  std::optional<uint32_t> texture = std::nullopt;
};

/// How the alpha of a texture is used, as in glTF: `opaque` ignores it, `mask` shows the surface
/// where it is at least a cutoff, and `blend` absorbs that part of the light.
enum class AlphaMode { opaque, mask, blend };

/// A surface of metal, plastic, glass, cloth or lacquer, with the parameters of glTF 2.0 and its
/// extensions (docs/materials.md), for the integrator `path`, the default of scenes with such a
/// material. Others show its colour, texture and opacity, matt.
struct StandardMaterial {
  Triple color{0.8, 0.8, 0.8};     ///< base colour, 0 to 1: of metals' reflection, else diffuse
  double metallic = 0;             ///< 0 dielectric to 1 metal
  double roughness = 0.5;          ///< 0 smooth to 1; the square root of alpha of GGX
  double ior = 1.5;                ///< index of refraction inside, above 0
  double specular = 1;             ///< scales the reflection of dielectrics, 0 to 1
  Triple specular_color{1, 1, 1};  ///< the same, coloured; not negative
  double transmission = 0;  ///< 0 to 1: the refracted part of the light that is not reflected
  /// A sheet, which does not bend light, as glTF's thickness 0; else the surface of a solid.
  bool thin = false;
  Triple attenuation_color{1, 1, 1};  ///< of white light after the distance in a solid, 0 to 1
  double attenuation_distance = std::numeric_limits<double>::infinity();  ///< scene units, above 0
  /// Emitted radiance, W/sr/m^2; white paper in full light has 1. Triangles that emit are sampled
  /// as lights; other primitives light what paths find by chance, with more noise.
  Triple emission{0, 0, 0};
  double clearcoat = 0;            ///< a layer of lacquer above everything, 0 to 1
  double clearcoat_roughness = 0;  ///< 0 to 1
  Triple sheen_color{0, 0, 0};     ///< of fibres seen from the side, 0 to 1; black: none
  double sheen_roughness = 0;      ///< 0 to 1
  bool two_sided = true;           ///< whether the back emits, too
  /// Shows its colour and texture as they are, without light; all but these, `two_sided` and the
  /// parameters of opacity is ignored. Primitives cannot have own colours.
  bool unlit = false;
  double opacity = 1;  ///< of primitives without their own, 0 to 1; of `mask`, times the texture's
  AlphaMode alpha_mode = AlphaMode::blend;
  double alpha_cutoff = 0.5;  ///< the least alpha that `mask` shows
  double normal_scale = 1;    ///< scales the slopes of the normal map

  // Textures of add_texture(), on meshes with texture coordinates; multiplied by the number.
  std::optional<uint32_t> texture = std::nullopt;  ///< base colour, and alpha if it has four bytes
  /// Roughness in green and metallic in blue; if it is all there is to say, set both numbers to 1.
  std::optional<uint32_t> metallic_roughness_texture = std::nullopt;
  std::optional<uint32_t> normal_texture = std::nullopt;    ///< normals from 0 to 255 are -1 to 1
  std::optional<uint32_t> emission_texture = std::nullopt;  ///< a colour
  std::optional<uint32_t> transmission_texture = std::nullopt;  ///< in red
};

/// How a texture continues beyond its edges.
enum class TextureWrap { repeat, clamp, mirror };

/// Perspective or parallel rays. Objects at the distance of the point looked at are equally large
/// in both. Or an equirectangular picture of all directions, with the point looked at in the
/// middle: 360 degrees about the up direction, perpendicular to the line of sight, by 180; angle
/// and lens do not apply.
enum class Projection { perspective, orthographic, omnidirectional };

struct Camera {
  Triple from{0, 0, 1}, at{0, 0, 0}, up{0, 1, 0};
  double fov_deg = 45;  ///< vertical, from edge to edge, between 0 and 180
  Projection projection = Projection::perspective;
};

/// A light for the integrator `ambient` with the setting `key-light` = `scene` (docs/ambient.md).
struct Light {
  enum class Kind { point, directional, spot, quad, ring };
  Kind kind = Kind::point;
  /// In scene units: intensity (W/sr) of points and spots, irradiance (W/m^2) of directional lights
  /// on surfaces that face them, radiance (W/sr/m^2) of quads and rings.
  Triple color{1, 1, 1};
  Triple position{0, 0, 0};     ///< of a point or spot; the centre of a ring; a quad's corner
  Triple direction{0, 0, -1};   ///< in which directional lights, spots and rings shine
  double angular_diameter = 0;  ///< degrees, up to 170; makes directional lights soft
  double opening = 180;         ///< degrees; the full angle of the cone of spots and rings
  double falloff = 0;           ///< degrees; the width of its smooth border, inside the cone
  Triple edge1{1, 0, 0}, edge2{0, 1, 0};  ///< of a quad
  bool front = true, back = false;        ///< its emitting sides; front is edge1 x edge2
  double radius = 0, inner_radius = 0;    ///< of a ring; radius 0: as a spot, with an intensity
};

/// `count` elements of N numbers each in the caller's memory: the first at `data`, each `stride`
/// bytes (may be negative) after the previous one; 0: all are the first. Without `keep` they are
/// copied.
///
/// With `keep`, which owns the memory, they are read in place, with any stride and alignment.
/// Nothing is copied: `keep` is held until the last scene, job or structure that reads them is
/// destroyed, and the numbers must not change until then. Triangles and their vertices are read in
/// place only if they are packed and aligned. Only the first primitives of a kind are read in
/// place; adding more copies them. If Raio must change numbers, for example normals of another
/// length than 1 or files far from the origin, all columns of the call are copied.
template <class T, size_t N = 1>
struct Column {
  const T* data = nullptr;
  size_t count = 0;
  std::ptrdiff_t stride = std::ptrdiff_t(N * sizeof(T));
  std::shared_ptr<const void> keep = {};
};

/// The appearance of the primitives of one call; a single number is the material of all of them.
struct Appearance {
  Appearance(uint32_t material_number = 0) : material(material_number) {}

  uint32_t material;
  /// Red, green and blue per primitive, overriding the material's colour, or none.
  Column<float, 3> colors;
  /// Opacity per primitive, 0 to 1, or none: the part of the light from behind that is absorbed.
  Column<float> opacity;
};

/// Numbers shown as colours: `colors` are three numbers of light each, from that of `least` to that
/// of `most`, as many as colormap() returns.
struct ColorScale {
  std::string name;  ///< of the numbers
  double least = 0, most = 1;
  std::vector<float> colors = {};
};

/// A colour with a meaning.
struct LegendEntry {
  std::string name;
  Triple color;
};

/// What a picture tells about its scene, drawn as by --color-bar, --legend and --scale-bar of `raio
/// render`.
struct Annotations {
  struct ScaleBar {
    double pixels_per_unit;  ///< see Film
    std::string unit;        ///< of length; empty: none
  };

  std::optional<ColorScale> color_bar = std::nullopt;
  bool color_bar_at_left = false;  ///< the legend takes the other side
  std::vector<LegendEntry> legend = {};
  std::optional<ScaleBar> scale_bar = std::nullopt;
};

class Settings;
enum class Kind;

/// A scene. Copies are independent of each other.
class RAIO_API Scene {
 public:
  /// Empty, with a black background and the default camera.
  Scene();
  Scene(const Scene&);
  Scene& operator=(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// Reads a scene file of any supported format, with the reader's settings (`style`, `color-by`).
  /// The error states its first fault, with line and column.
  static Scene read(const std::string& path, const Settings& settings);
  static Scene read(const std::string& path);
  /// The same for the bytes of such a file in memory; `name` with its suffix helps to detect the
  /// format, and messages use it as the file name.
  static Scene parse(std::string_view bytes, std::string_view name, const Settings& settings);
  /// The same for NFF in memory; messages use `name` as the file name.
  static Scene parse_nff(std::string_view text, std::string_view name = "scene");
  /// Writes the scene, whole or not at all, in the format given by the suffix.
  void write(const std::string& path) const;
  /// The bytes of a .raio scene, which stores everything but the pictures of a sky.
  std::string to_bytes() const;
  /// Reads such bytes. They are not trusted: the error states what is damaged. With `keep`, which
  /// owns the bytes, columns are read in place; otherwise they are copied.
  static Scene from_bytes(std::string_view bytes, std::shared_ptr<const void> keep = {});
  /// Warnings of the reader, one line each.
  const std::vector<std::string>& warnings() const;
  /// For annotations, of a scene that was read: the numbers that its colours show, if they do,
  /// names of its colours, and the unit of its lengths ("Å"); empty: unknown. Stored in no scene
  /// file.
  std::optional<ColorScale> color_scale() const;
  std::vector<LegendEntry> legend() const;
  const std::string& unit() const;

  void set_camera(const Camera& camera);
  Camera camera() const;
  /// Fits the camera to all finite primitives, seen in this direction (from the camera), or else at
  /// an angle from above, with the projection and angle of the current camera. If `up` is along the
  /// direction, y is up, or else z. `margin`: the free space on each side, as a fraction of the
  /// picture's size, below 0.5.
  void fit_camera(std::optional<Triple> direction = std::nullopt, Triple up = {0, 0, 1},
                  double margin = 0);
  /// Whether it is a figure of data, like a file of atoms, points or meshes: by default lit from
  /// everywhere (docs/ambient.md), on the background of the style.
  void set_figure(bool is_figure);
  /// Replaces the background, or a sky.
  void set_background(Triple color);
  /// Adds a point light; without a colour it is white, and n such lights have 1 / sqrt(n) each.
  /// With the setting `soft-shadows` it is a square of this size (scene units), if not 0.
  void add_light(Triple position, std::optional<Triple> color = std::nullopt, double size = 0);
  /// Adds a light in physical units, which needs the integrator `ambient`.
  void add_light(const Light& light);
  /// Surrounds the scene with light from infinitely far away; needs the integrator `ambient`.
  /// Copies a picture of `width` x `height` linear radiances, three numbers each, row by row from
  /// `up` to down over 180 degrees. The middle column is towards `direction`, made perpendicular to
  /// `up`; columns continue to the right, over 360 degrees. Surfaces receive the radiance times the
  /// setting `sky-light`, by default 1. Eye rays see it as it is, if it is `visible` and no
  /// `background` is set. A size of 0 x 0 removes it.
  void set_environment(uint32_t width, uint32_t height, const float* rgb, Triple up = {0, 0, 1},
                       Triple direction = {1, 0, 0}, bool visible = true);

  /// Returns the material's number for primitives added later; scenes made in code start with
  /// material 0.
  uint32_t add_material(const Material& material);
  /// The error names a parameter that is not in its range, or that has no effect. A template, so
  /// that add_material({...}) is a Material.
  template <class M, class = std::enable_if_t<std::is_same_v<M, StandardMaterial>>>
  uint32_t add_material(const M& material) {
    Material matt;
    matt.kd = 1;
    return add_material(material, matt);
  }
  /// The same, and what other integrators than `path` show: the kd, ks, shine, transmission,
  /// specular and roughness of `classic`; the rest is that of `material`.
  uint32_t add_material(const StandardMaterial& material, const Material& classic);
  /// Copies a picture of `width` x `height` pixels, row by row from the top, and returns its
  /// number. A pixel has three bytes, or four with alpha (`channels`), straight. Colours are
  /// display values (sRGB); other numbers are 0 to 255 for 0 to 1.
  uint32_t add_texture(uint32_t width, uint32_t height, const uint8_t* texels,
                       TextureWrap wrap_u = TextureWrap::repeat,
                       TextureWrap wrap_v = TextureWrap::repeat, int channels = 3);

  // The columns of one call must have equal counts. After an error (null pointer, different counts,
  // invalid numbers) the scene is unchanged. Radii must not be negative.

  void add_spheres(const Column<float, 3>& centers, const Column<float>& radii,
                   const Appearance& look = {});
  /// From a circle around `starts` to one around `ends`, without caps; equal radii make cylinders.
  void add_cones(const Column<float, 3>& starts, const Column<float, 3>& ends,
                 const Column<float>& start_radii, const Column<float>& end_radii,
                 const Appearance& look = {});
  /// `axes`: three perpendicular vectors each, from the centre to the surface.
  void add_ellipsoids(const Column<float, 3>& centers, const Column<float, 9>& axes,
                      const Appearance& look = {});
  /// Flat discs; rings if there are inner radii. Normals are normalized.
  void add_discs(const Column<float, 3>& centers, const Column<float, 3>& normals,
                 const Column<float>& radii, const Column<float>& inner_radii = {},
                 const Appearance& look = {});
  /// Triangles as three indices each into their own vertices; with a normal per vertex they are
  /// smooth.
  void add_triangles(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                     const Column<float, 3>& normals = {}, const Appearance& look = {});

  /// Triangles with a colour per vertex, multiplied by that of the material, or texture
  /// coordinates: (0, 0) is the lower left corner of a texture, (1, 1) the upper right one.
  void add_mesh(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                const Column<float, 3>& normals, const Column<float, 2>& uv,
                const Column<float, 3>& vertex_colors, uint32_t material = 0);
  /// The same with a material for each triangle.
  void add_mesh(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                const Column<float, 3>& normals, const Column<float, 2>& uv,
                const Column<float, 3>& vertex_colors, const Column<uint32_t>& materials);

  /// Spheres that move uniformly from `starts` at the time `begin` to `ends` at `end`; they rest
  /// before and after. The setting `shutter` selects the times that a picture covers.
  void add_moving_spheres(const Column<float, 3>& starts, const Column<float, 3>& ends,
                          const Column<float>& radii, double begin, double end,
                          const Appearance& look = {});
  /// Triangles that move in the same way: three vertices each.
  void add_moving_triangles(const Column<float, 9>& starts, const Column<float, 9>& ends,
                            double begin, double end, const Appearance& look = {});

  /// Stores an object for add_instances() and returns its number. Uses the scene's primitives,
  /// prototypes, instances and named objects, not its camera, lights and background; planes and
  /// moving primitives are refused. New materials are appended.
  uint32_t add_prototype(const Scene& prototype);

  // An instance is stored as its matrix: three rows of four numbers, multiplied with (x y z 1) of a
  // point of the object. Rays hit it like the transformed primitives, also if mirrored, sheared or
  // stretched. With a name, the instances of a call are one object in the channel `object`;
  // otherwise they belong to the prototype's objects.

  /// Instances of one object.
  void add_instances(uint32_t prototype, const Column<float, 12>& matrices,
                     std::string_view name = {});
  /// Instances of several objects, by number.
  void add_instances(const Column<uint32_t>& prototypes, const Column<float, 12>& matrices,
                     std::string_view name = {});

  /// Including those of instances.
  size_t primitive_count() const;
  /// Those of a kind that are neither in instances nor in meshes. With the next two, taken before
  /// and after a call, it tells which call added what a Hit names.
  size_t count(Kind kind) const;
  size_t mesh_triangle_count() const;
  size_t instance_count() const;
  /// The lowest and highest corner of all finite primitives; nothing for an empty scene.
  std::optional<std::array<Triple, 2>> bounds() const;

  struct Data;
  const Data& data() const { return *data_; }

 private:
  friend class Accel;
  explicit Scene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

/// How to read a scene and to render it: the options of the command line under the same names,
/// without dashes.
class RAIO_API Settings {
 public:
  Settings();
  Settings(const Settings&);
  Settings& operator=(const Settings&);
  ~Settings();

  /// Sets one option from text as on the command line: set("size", "640x480"), set("aa", "4"); a
  /// switch without a value is on, with "false" off. The error lists the accepted values.
  Settings& set(std::string_view name, std::string_view value = "true");

  // The same with values, which are converted to text: set("aa", 4), set("dof", false), set("size",
  // {640, 480}), set("from", camera.from).

  template <class T, class = std::enable_if_t<std::is_arithmetic_v<T> && !std::is_same_v<T, char>>>
  Settings& set(std::string_view name, T value) {
    if constexpr (std::is_same_v<T, bool>) return set(name, value ? "true" : "false");
    const double number = double(value);
    return set_numbers(name, &number, 1);
  }
  template <class T, class = std::enable_if_t<std::is_arithmetic_v<T>>>
  Settings& set(std::string_view name, std::initializer_list<T> values) {
    const std::vector<double> numbers(values.begin(), values.end());
    return set_numbers(name, numbers.data(), numbers.size());
  }
  Settings& set(std::string_view name, std::initializer_list<double> values) {
    return set_numbers(name, values.begin(), values.size());
  }
  Settings& set(std::string_view name, const Triple& values) {
    return set_numbers(name, values.data(), values.size());
  }

  /// The value in the form of set(); empty if the scene decides.
  std::string get(std::string_view name) const;

  struct Option {
    std::string name, value_name, help;  ///< an empty value_name: a switch
    std::vector<std::string> words;      ///< allowed values; empty: no fixed list
    /// "switch", "integer", "number", "words", "vector", "color", "size", "list" or "text".
    std::string type;
    bool of_reader = false;     ///< for Scene::read()
    std::string unit;           ///< "degrees", "scene units"; empty: none
    std::string default_value;  ///< empty: the scene or another setting decides, see `help`
    std::optional<double> minimum, maximum;  ///< of numbers
    std::vector<std::string> integrators;    ///< others refuse the option
    std::vector<std::string> excludes;       ///< options that cannot be combined with it
  };
  /// All options, in the order of the command line's help: of readers (Scene::read), of pictures,
  /// and of long renders.
  static std::vector<Option> options();

  struct Data;
  const Data& data() const { return *data_; }

 private:
  friend class Film;
  friend class Scene;
  Settings& set_numbers(std::string_view name, const double* values, size_t count);
  std::unique_ptr<Data> data_;
};

/// The points origin + t * direction, 0 < t < length. The direction may have any length except 0; t
/// is in scene units nevertheless. `time` sets the positions of moving primitives.
struct Ray {
  Triple origin{0, 0, 0}, direction{0, 0, -1};
  double length = std::numeric_limits<double>::infinity();
  double time = 0;
};

/// Cylinders are cones. Triangles are the scene's own, followed by those of meshes.
enum class Kind {
  plane,
  sphere,
  cone,
  triangle,
  polygon,
  ellipsoid,
  disc,
  moving_sphere,
  moving_triangle
};

/// The nearest hit on a ray.
struct Hit {
  double distance = std::numeric_limits<double>::infinity();  ///< scene units; infinite: none
  Kind kind = Kind::plane;
  uint32_t index = 0;  ///< among those of the kind, in the order of addition
  uint32_t material = 0;
  Triple position{0, 0, 0};
  Triple normal{0, 0, 0};  ///< unit, outward; interpolated for smooth triangles
  double u = 0, v = 0;     ///< weights of a triangle's second and third vertex
  /// The index of the instance, in the order of addition; for nested instances, the outermost.
  /// `index` then counts in the object of the innermost. -1: none.
  int64_t instance = -1;

  bool found() const { return distance < std::numeric_limits<double>::infinity(); }
};

/// A scene prepared for tracing: for the caller's own rays, and for several jobs that render the
/// scene, for instance from several viewpoints. Any number of threads may trace at the same time.
/// Copies and jobs share the structure; the last one destroys it.
class RAIO_API Accel {
 public:
  /// Builds the structure selected by the settings `accel`, `grid-factor`, `grid-resolution`,
  /// `one-sided` and `counters`, with `threads` threads.
  /// Primitives that are those of `like`, in the whole scene or in a prototype, share its trees:
  /// other colours, lights and cameras cost nothing.
  explicit Accel(Scene scene, const Settings& settings = {}, const Accel* like = nullptr);

  Hit closest(const Ray& ray) const;
  /// Whether there is any hit. Faster than closest().
  bool occluded(const Ray& ray) const;
  /// The same for `count` rays on the calling thread, which is faster than one by one.
  void closest(size_t count, const Ray* rays, Hit* hits) const;
  void occluded(size_t count, const Ray* rays, uint8_t* occluded) const;

  /// The hits of many rays as arrays of the caller; null pointers are not filled in. See Hit.
  struct Hits {
    float* distance = nullptr;  ///< infinite: none
    uint8_t* kind = nullptr;
    int64_t* index = nullptr;     ///< -1: none
    int64_t* instance = nullptr;  ///< -1: none
    float* position = nullptr;    ///< three numbers each; NaN: none
    float* normal = nullptr;      ///< three numbers each; 0: none
    float* uv = nullptr;          ///< two numbers each
  };
  /// Traces rays with the threads of the caller's Executor. Directions may have any length but 0;
  /// `lengths` limits them.
  void closest(const Column<float, 3>& origins, const Column<float, 3>& directions,
               const Column<float>& lengths, const Hits& hits) const;
  void occluded(const Column<float, 3>& origins, const Column<float, 3>& directions,
                const Column<float>& lengths, uint8_t* occluded) const;

  struct Info {
    std::string kind;       ///< "bvh", "grid", "embree" or "none"
    size_t primitives = 0;  ///< in the structure: a polygon counts as its triangles
    size_t bytes = 0;       ///< without the scene
    size_t cells = 0;       ///< of a grid; nodes of a tree
    size_t references = 0;  ///< entries in the lists of all cells
  };
  Info info() const;
  /// See Scene::bounds().
  std::optional<std::array<Triple, 2>> bounds() const;

  struct Data;

 private:
  friend class Job;
  std::shared_ptr<const Data> data_;
};

/// The progress of work.
struct Progress {
  enum class Stage { reading, building, rendering };

  double share = 0;   ///< of the stage, 0 to 1; 0 if unknown
  uint64_t rays = 0;  ///< traced so far
  double seconds = 0;
  Stage stage = Stage::rendering;
};

/// The threads, progress and cancellation of all calls within run(). Without an Executor, jobs and
/// structures use the setting `threads`, and other calls one thread per core, or fewer if the
/// container has a limit.
///
///   raio::Executor executor(4);
///   executor.on_progress([](const raio::Progress& p) { show(p.share); });
///   executor.run([&] { scene = raio::Scene::read("large.ply"); });
class RAIO_API Executor {
 public:
  /// `threads` includes the calling thread; 0: one per core.
  explicit Executor(int threads = 0);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Called about ten times a second during run(), from another thread, while files are read and
  /// structures are built; a Job reports its own progress. If the callback throws, run() stops and
  /// rethrows the exception.
  void on_progress(std::function<void(const Progress&)> callback);

  /// Calls `work` and rethrows its exceptions. After cancel(), calls of the library throw Error
  /// with ErrorKind::cancelled and discard their unfinished results.
  void run(const std::function<void()>& work);

  /// Soon ends the work in run(), also in later runs. Any thread may call it.
  void cancel();

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

/// The sums of all or some of a picture's samples. A film can be stored, continued by a Job, even
/// on another machine, and merged with others in any order; the result has the bytes of a single
/// render. Copies are independent of each other.
class RAIO_API Film {
 public:
  Film(const Film&);
  Film& operator=(const Film&);
  Film(Film&&) noexcept;
  Film& operator=(Film&&) noexcept;
  ~Film();

  /// Reads a part file (.raio), for example a checkpoint. The error states what is damaged.
  static Film read(const std::string& path);
  /// Writes a part file if the suffix is .raio, else a picture: .png .exr .npz .npy .ppm .pfm; .png
  /// and .ppm with exposure and tone. Only .exr and .npz have channels besides alpha. Whole or not
  /// at all. The error states which samples are missing; a film ended by a time limit is complete.
  void write(const std::string& path) const;
  /// To and from the bytes of a part file, which are not trusted.
  std::string to_bytes() const;
  static Film from_bytes(std::string_view bytes);

  /// Combines the samples of all films, exactly, in any order. The error names a film that does not
  /// fit, by its file if it was read, and the reason: other settings, or samples that another film
  /// has, too.
  static Film merge(std::vector<Film> films);

  /// Adds the samples of another film, exactly. The error gives the reason if it does not fit, as
  /// for merge(); this film is then unchanged.
  Film& add(Film other);

  /// Whether it has all samples that its settings request.
  bool complete() const;
  /// The missing samples, in one line; empty if it is complete.
  std::string missing() const;
  /// The samples missing in every tile of a shard, counted from 0, as spans from the first to
  /// before the last; nothing if its tiles miss different ones.
  std::optional<std::vector<std::array<uint32_t, 2>>> missing(uint32_t shard,
                                                              uint32_t shards) const;
  /// The number of tiles; tile t is in the shard t modulo their number.
  size_t tiles() const;
  /// The fewest and the most samples of a pixel, within its shard.
  std::array<uint32_t, 2> samples() const;
  /// All settings that affect the picture, including those from the scene, `shard` and
  /// `sample-range`. A Job with them repeats or continues the film.
  Settings settings() const;
  /// Sets `exposure` or `tone`, which affect the display of the film, not its samples. The error
  /// lists the accepted values.
  Film& set(std::string_view name, std::string_view value);
  Film& set(std::string_view name, double value);

  /// Draws these on the pictures of write(), display() and encode(), not on rgba() and parts, which
  /// do not store them. Needs Cairo where the program runs; the error says what is missing.
  Film& annotate(Annotations wanted);
  const Annotations& annotations() const;
  /// The size of a scene unit at the point looked at; 0: unknown, since the film was read or
  /// merged.
  double pixels_per_unit() const;

  int width() const;
  int height() const;
  /// Red, green, blue and coverage per pixel, row by row from the top: display values for the
  /// classic shading, not clamped; premultiplied. Pixels without samples are black.
  std::vector<float> rgba() const;
  /// The picture as PNG displays it: red, green, blue, opacity of each pixel, row by row; straight.
  std::vector<uint8_t> display() const;
  /// The bytes of such a picture file: format ".png", ".exr", ".npz", ".npy", ".ppm" or ".pfm".
  std::string encode(std::string_view format) const;
  /// The names of the requested channels ("depth", "normal").
  std::vector<std::string> channels() const;
  /// The values of a channel, `components` per pixel, row by row. The error names the available
  /// channels; use integers() for `id`, `object` and `samples`.
  std::vector<float> channel(std::string_view name, int* components = nullptr) const;
  /// The same for integer channels, one value per pixel.
  std::vector<uint32_t> integers(std::string_view name) const;
  /// The number of NaN samples, which count as black.
  uint64_t nan_samples() const;

  struct Data;

 private:
  friend class Job;
  explicit Film(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

/// One render, as by `raio render`: builds the acceleration structure, unless given, and renders a
/// film, or the missing samples of another film. With `shard` or `sample-range` it renders a part,
/// with `time-limit` as many samples as time permits. It writes its `checkpoint`.
class RAIO_API Job {
 public:
  /// Copies the scene. `begun`: a film to continue, with the same settings; only `samples` may be
  /// larger. The error names settings that cannot be combined or differ from those of the film.
  Job(const Scene& scene, const Settings& settings, std::optional<Film> begun = std::nullopt);
  /// Renders the structure's scene. Keeps the settings that the structure was built with; the error
  /// names one that was set differently.
  Job(const Accel& accel, const Settings& settings, std::optional<Film> begun = std::nullopt);
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Called about ten times a second during run(), from another thread, also while the structure is
  /// built. If the callback throws, run() stops and rethrows the exception.
  void on_progress(std::function<void(const Progress&)> callback);

  /// Renders with the number of threads in the setting `threads`, including this one, and returns
  /// the film. Call it once. Throws Error with ErrorKind::cancelled after cancel(), and with
  /// ErrorKind::no_resource if the time limit was too short for a sample of each pixel; film() then
  /// has the finished samples.
  Film run();

  /// A copy of the current film, until run() has returned it: for showing, storing or continuing
  /// it. Any thread may call it.
  Film film() const;

  /// Ends run() soon. Any thread may call it.
  void cancel();

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

/// The light of a colour: a name, "#rrggbb", both of display values, or "r,g,b".
RAIO_API Triple parse_color(std::string_view text);

/// Converts display values (sRGB, 0 to 1) to light.
RAIO_API void to_linear(float* values, size_t count);

/// The light of the 256 colours of a map, three numbers each: "viridis", "plasma", "cividis" or
/// "coolwarm".
RAIO_API std::vector<float> colormap(std::string_view name);

/// Why Film::annotate() cannot draw here, in one line; empty: it can.
RAIO_API std::string drawing_problem();

/// "0.2.0".
RAIO_API std::string version();

}  // namespace v1
}  // namespace raio
