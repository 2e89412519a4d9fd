// Raio: a fast, reproducible ray tracer. The library's whole interface; it needs nothing but the
// standard library of C++17.
//
//   raio::Scene scene = raio::Scene::read("balls.nff");
//   raio::Settings settings;
//   settings.set("size", "640x480").set("aa", "4").set("soft-shadows");
//   raio::Job(scene, settings).run().write("balls.png");
//
// The library never prints, never ends the program and changes no global state. Failures are thrown
// as raio::Error. The same scene and settings give the same bytes for any number of threads and on
// any machine. Objects may be used by one thread at a time; Job::cancel() and what is const of an
// Accel by any.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#if defined(__GNUC__)
#define RAIO_API __attribute__((visibility("default")))
#else
#define RAIO_API
#endif

namespace raio::v1 {

/// Three numbers: x, y, z of a point in scene units, or red, green, blue of a colour, of which 1 is
/// the display's white.
using Triple = std::array<double, 3>;

enum class ErrorKind {
  bad_input,     ///< a file, a scene or a value that cannot be used; the message says what can
  cannot_write,  ///< a file that could not be written; nothing is left half-written
  no_resource,   ///< memory, or a library that is not there
  cancelled      ///< Job::cancel() was called
};

/// What went wrong, in one line that names what was found and what was expected.
class RAIO_API Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message, std::string file = {}, int line = 0,
        int column = 0);
  ErrorKind kind() const noexcept { return kind_; }
  /// Of a scene file: its name, and the place of its first mistake, counted from 1; 0: none.
  const std::string& file() const noexcept { return file_; }
  int line() const noexcept { return line_; }
  int column() const noexcept { return column_; }

 private:
  ErrorKind kind_;
  std::string file_;
  int line_, column_;
};

/// The classic surface (docs/shading.md): its colour counts with `kd` where light falls on it,
/// highlights and mirrored rays with `ks`, refracted rays with `transmission`.
struct Material {
  Triple color{0.8, 0.8, 0.8};
  double kd = 0.8, ks = 0;
  double shine = 1;         ///< the highlight's exponent
  double transmission = 0;  ///< 0 opaque
  double ior = 1;           ///< index of refraction inside, above 0
};

/// Rays from one point, or side by side; what is as far away as the point looked at is as large in
/// both.
enum class Projection { perspective, orthographic };

struct Camera {
  Triple from{0, 0, 1}, at{0, 0, 0}, up{0, 1, 0};
  double fov_deg = 45;  ///< vertical, from edge to edge, between 0 and 180
  Projection projection = Projection::perspective;
};

/// `count` elements of N numbers each in memory of the caller: the first at `data`, each `stride`
/// bytes (which may be negative, but not zero) after the one before. Without `keep` they are
/// copied.
///
/// With `keep`, which owns the memory or otherwise holds it, columns that lie as Raio stores them
/// are read in place: nothing is copied, `keep` is held until the last scene, job or structure that
/// reads them is gone, and until then the numbers must not change. Other columns are copied once,
/// and `keep` is not held. Each function says what lies as Raio stores it. In place are only the
/// first primitives of a kind; adding more to them copies them. Files far from zero copy all.
template <class T, size_t N = 1>
struct Column {
  const T* data = nullptr;
  size_t count = 0;
  std::ptrdiff_t stride = std::ptrdiff_t(N * sizeof(T));
  std::shared_ptr<const void> keep = {};
};

/// What the primitives of one call look like; a number is the material of all of them.
struct Appearance {
  Appearance(uint32_t material_number = 0) : material(material_number) {}

  uint32_t material;
  /// Red, green and blue of each, in place of the material's colour, or none. Read in place where
  /// the stride is 12.
  Column<float, 3> colors;
  /// Of each, 0 to 1, or none: the part of the light from behind that is kept back. Read in place
  /// where the stride is 4.
  Column<float> opacity;
};

/// What is to be drawn. Copies are independent of each other.
class RAIO_API Scene {
 public:
  /// Empty, with a black background and the default camera.
  Scene();
  Scene(const Scene&);
  Scene& operator=(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// Reads a scene file of any kind that Raio knows. The error has its first mistake with line and
  /// column.
  static Scene read(const std::string& path);
  /// The same for NFF in memory; `name` stands for the file in messages.
  static Scene parse_nff(std::string_view text, std::string_view name = "scene");
  /// Writes the scene whole or not at all, in the format that the suffix names.
  void write(const std::string& path) const;
  /// What the reader warned of, a line each.
  const std::vector<std::string>& warnings() const;

  void set_camera(const Camera& camera);
  Camera camera() const;
  /// In place of what was there, a sky too.
  void set_background(Triple color);
  /// A point light; without a colour it is white, and n such lights have 1 / sqrt(n) each.
  void add_light(Triple position, std::optional<Triple> color = std::nullopt);

  /// The material's number for what is added afterwards; 0 is there from the beginning where a
  /// scene was made in code.
  uint32_t add_material(const Material& material);

  // Columns of one call have the same count. After an error (a null pointer, a stride of 0, counts
  // that differ, numbers that cannot be) the scene is as it was. Radii are not negative.

  /// In place: x y z radius, both columns in steps of 16 bytes.
  void add_spheres(const Column<float, 3>& centers, const Column<float>& radii,
                   const Appearance& look = {});
  /// From a circle around `starts` to one around `ends`, without caps; equal radii make cylinders.
  /// In place: start, its radius, end, its radius, in steps of 32 bytes.
  void add_cones(const Column<float, 3>& starts, const Column<float, 3>& ends,
                 const Column<float>& start_radii, const Column<float>& end_radii,
                 const Appearance& look = {});
  /// `axes`: three vectors each, from the centre to the surface, perpendicular to each other. In
  /// place: centre and axes, in steps of 48 bytes.
  void add_ellipsoids(const Column<float, 3>& centers, const Column<float, 9>& axes,
                      const Appearance& look = {});
  /// Flat; rings where there are inner radii. Normals are brought to length 1. In place: centre,
  /// normal of length 1, radius, inner radius, in steps of 32 bytes.
  void add_discs(const Column<float, 3>& centers, const Column<float, 3>& normals,
                 const Column<float>& radii, const Column<float>& inner_radii = {},
                 const Appearance& look = {});
  /// Triangles of their own vertices, three indices each; with a normal for each vertex they are
  /// smooth. In place: each column with a stride of 12, normals only of length 1.
  void add_triangles(const Column<float, 3>& positions, const Column<uint32_t, 3>& triangles,
                     const Column<float, 3>& normals = {}, const Appearance& look = {});

  /// Spheres that move evenly from `starts`, where they are until the time `begin`, to `ends`,
  /// where they are from `end` on. The setting `shutter` says of which times a picture is.
  void add_moving_spheres(const Column<float, 3>& starts, const Column<float, 3>& ends,
                          const Column<float>& radii, double begin, double end,
                          const Appearance& look = {});
  /// Triangles whose corners move likewise: three points each.
  void add_moving_triangles(const Column<float, 9>& starts, const Column<float, 9>& ends,
                            double begin, double end, const Appearance& look = {});

  /// Stores an object that add_instances() copies, and returns its number. Of the scene its spheres
  /// and so on, prototypes, instances and named objects count, not camera, lights and background;
  /// planes and what moves are refused. Materials that are not there yet come behind those that
  /// are.
  uint32_t add_prototype(const Scene& prototype);

  // A copy is stored as its matrix: three rows of four numbers, which make (a b c d) * (x y z 1) of
  // a point of the object. Rays meet it as they do the same primitives moved, also mirrored,
  // sheared or stretched. With a name, the copies of a call are an object of their own in the
  // channel `object`, else they are what the prototype's are.

  /// Copies of one object.
  void add_instances(uint32_t prototype, const Column<float, 12>& matrices,
                     std::string_view name = {});
  /// Copies of several, whose numbers are given. In place: number, matrix, in steps of 52 bytes.
  void add_instances(const Column<uint32_t>& prototypes, const Column<float, 12>& matrices,
                     std::string_view name = {});

  /// With those of copies.
  size_t primitive_count() const;
  /// Lowest and highest corner of all that has an end; nothing for an empty scene.
  std::optional<std::array<Triple, 2>> bounds() const;

  struct Data;
  const Data& data() const { return *data_; }

 private:
  friend class Accel;
  explicit Scene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

/// How it is to be drawn: the options of the command line under the same names, without dashes.
class RAIO_API Settings {
 public:
  Settings();
  Settings(const Settings&);
  Settings& operator=(const Settings&);
  ~Settings();

  /// Sets one option from text, as the command line has it: set("size", "640x480"), set("aa", "4");
  /// a switch without a value is on, with "false" off. The error says what is accepted.
  Settings& set(std::string_view name, std::string_view value = "true");
  /// The value as set() takes it; empty where it is left to the scene.
  std::string get(std::string_view name) const;

  struct Option {
    std::string name, value_name, help;  ///< no value_name: a switch
    std::vector<std::string> words;      ///< that the value may be; empty: no list
  };
  /// All options, in the order of the command line's help.
  static std::vector<Option> options();

  struct Data;
  const Data& data() const { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

/// The points origin + t * direction, 0 < t < length. The direction may have any length but zero;
/// t counts scene units all the same. What moves is met where it is at `time`.
struct Ray {
  Triple origin{0, 0, 0}, direction{0, 0, -1};
  double length = std::numeric_limits<double>::infinity();
  double time = 0;
};

/// Cylinders are cones. Triangles are the scene's own, then those of meshes.
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

/// The nearest point of the scene on a ray.
struct Hit {
  double distance = std::numeric_limits<double>::infinity();  ///< scene units; infinite: none
  Kind kind = Kind::plane;
  uint32_t index = 0;  ///< among those of the kind, in the order in which they came
  uint32_t material = 0;
  Triple position{0, 0, 0};
  Triple normal{0, 0, 0};  ///< unit, outward; of smooth triangles the smooth one
  double u = 0, v = 0;     ///< weights of a triangle's second and third corner
  /// Which copy it belongs to, in the order in which they came, the outermost if there are copies
  /// in a copy; `index` then counts in the object that is copied, the innermost. -1: none.
  int64_t instance = -1;

  bool found() const { return distance < std::numeric_limits<double>::infinity(); }
};

/// A scene made ready for tracing: for rays of the caller's own, and for several jobs that render
/// the scene, as from several places. Any number of threads may trace at the same time. Copies are
/// the same structure, which lives as long as the last of them and of the jobs.
class RAIO_API Accel {
 public:
  /// Builds the structure that the settings `accel`, `grid-factor`, `grid-resolution`, `one-sided`
  /// and `counters` ask for, on `threads` threads.
  explicit Accel(Scene scene, const Settings& settings = {});

  Hit closest(const Ray& ray) const;
  /// Is there any hit? Faster than closest().
  bool occluded(const Ray& ray) const;
  /// The same for `count` rays at once, which is faster than one by one, on the calling thread.
  void closest(size_t count, const Ray* rays, Hit* hits) const;
  void occluded(size_t count, const Ray* rays, uint8_t* occluded) const;

  struct Info {
    std::string kind;       ///< "bvh", "grid", "embree" or "none"
    size_t primitives = 0;  ///< that rays meet: a polygon counts as its triangles
    size_t bytes = 0;       ///< besides the scene
    size_t cells = 0;       ///< of a grid; nodes of a tree
    size_t references = 0;  ///< primitives listed in all of them together
  };
  Info info() const;
  /// As Scene::bounds().
  std::optional<std::array<Triple, 2>> bounds() const;

  struct Data;

 private:
  friend class Job;
  std::shared_ptr<const Data> data_;
};

/// How far a render is.
struct Progress {
  double share = 0;   ///< 0 to 1
  uint64_t rays = 0;  ///< traced so far
  double seconds = 0;
};

/// A rendered picture: colours with coverage, and the channels that the settings asked for.
class RAIO_API Film {
 public:
  Film(Film&&) noexcept;
  Film& operator=(Film&&) noexcept;
  ~Film();

  int width() const;
  int height() const;
  /// Red, green, blue and coverage of each pixel, row by row from the top: display values for the
  /// classic shading, not clamped; premultiplied.
  std::vector<float> rgba() const;
  /// The channels asked for, by name ("depth", "normal").
  std::vector<std::string> channels() const;
  /// The numbers of a channel, `components` for each pixel, row by row. The error names the
  /// channels that there are; `id`, `object` and `samples` are read with integers().
  std::vector<float> channel(std::string_view name, int* components = nullptr) const;
  /// The same for the channels of whole numbers, one for each pixel.
  std::vector<uint32_t> integers(std::string_view name) const;
  /// How many samples were not a number (NaN). They count as black.
  uint64_t nan_samples() const;

  /// Writes a picture whole or not at all: .png .exr .npz .npy .ppm .pfm by suffix; .png and .ppm
  /// with the settings `exposure` and `tone`. The error says what the format cannot keep.
  void write(const std::string& path) const;

  struct Data;

 private:
  friend class Job;
  explicit Film(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

/// One render: builds the acceleration structure, where it is not given, and makes the picture.
class RAIO_API Job {
 public:
  /// Takes a copy of both. The error names settings that do not go together.
  Job(const Scene& scene, const Settings& settings);
  /// Of the structure's scene. The settings about structures are those that it was built with; the
  /// error names one that was set to something else.
  Job(const Accel& accel, const Settings& settings);
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Called some ten times a second while run() works, from a thread of its own. If it throws,
  /// run() stops and rethrows the exception.
  void on_progress(std::function<void(const Progress&)> callback);

  /// Works on as many threads as the setting `threads` says, this one among them, and returns when
  /// the picture is done. Throws Error with ErrorKind::cancelled after cancel().
  Film run();

  /// Ends run() soon. Any thread may call it.
  void cancel();

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

/// "0.2.0".
RAIO_API std::string version();

}  // namespace raio::v1

// The version is part of the names that programs link against, not of those that people write.
#ifndef RAIO_LIBRARY_SOURCE
namespace raio {
using namespace v1;
}
#endif
