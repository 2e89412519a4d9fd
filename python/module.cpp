// The module raio._raio: the C++ library (include/raio/raio.h) for the Python package in
// python/raio, which checks and converts arguments. Long calls release the GIL, work on a thread of
// their own, and end soon on Ctrl-C.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>
#include <raio/raio.h>

#ifndef _WIN32
#include <pthread.h>
#endif

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace nb = nanobind;
using namespace nb::literals;  // NOLINT(google-build-using-namespace)

namespace {

using raio::Triple;

// --- arrays

using Floats1 = nb::ndarray<const float, nb::ndim<1>, nb::device::cpu>;
using Floats2 = nb::ndarray<const float, nb::ndim<2>, nb::device::cpu>;
using Indices1 = nb::ndarray<const uint32_t, nb::ndim<1>, nb::device::cpu>;
using Indices2 = nb::ndarray<const uint32_t, nb::ndim<2>, nb::device::cpu>;

// Keeps an array alive for the library, which releases it in any thread, even after Python's end.
template <class Array>
std::shared_ptr<const void> keep(const Array& array) {
  return {new Array(array), [](const Array* kept) {
            if (!Py_IsInitialized()) return;
            const nb::gil_scoped_acquire gil;
            delete kept;
          }};
}

// Rows of N numbers; the package has checked the shape.
template <size_t N, class Array>
auto column(const Array& array) {
  using T = std::remove_const_t<typename Array::Scalar>;
  return raio::Column<T, N>{array.data(), array.shape(0),
                            std::ptrdiff_t(array.stride(0) * int64_t(sizeof(T))), keep(array)};
}
template <size_t N, class Array>
auto column(const std::optional<Array>& array) {
  using T = std::remove_const_t<typename Array::Scalar>;
  return array ? column<N>(*array) : raio::Column<T, N>{};
}

// A numpy array that owns the numbers.
template <class T>
auto owned(std::vector<T> numbers, std::initializer_list<size_t> shape) {
  auto* const all = new std::vector<T>(std::move(numbers));
  const nb::capsule owner(all, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T>(all->data(), shape, owner);
}

nb::bytes bytes(const std::string& text) { return nb::bytes(text.data(), text.size()); }

// --- errors

// Raised by the package's own exception for files; it is set when the module is imported.
nb::object& scene_error() {
  static nb::object type;
  return type;
}

void raise(const raio::Error& error) {
  const nb::object text = nb::module_::import_("raio._options").attr("with_keywords")(error.what());
  switch (error.kind()) {
    case raio::ErrorKind::bad_input:
      if (error.line() > 0 || !error.file().empty()) {
        const nb::object value = scene_error()(text, error.file(), error.line(), error.column());
        PyErr_SetObject(scene_error().ptr(), value.ptr());
      } else {
        PyErr_SetObject(PyExc_ValueError, text.ptr());
      }
      return;
    case raio::ErrorKind::cannot_write:
      PyErr_SetObject(PyExc_OSError, text.ptr());
      return;
    case raio::ErrorKind::no_resource:
      PyErr_SetObject(std::strstr(error.what(), "memory") ? PyExc_MemoryError : PyExc_RuntimeError,
                      text.ptr());
      return;
    case raio::ErrorKind::cancelled:
      PyErr_SetObject(PyExc_KeyboardInterrupt, text.ptr());
      return;
  }
}

// --- long work

// After a fork, the library's threads are missing in the child, where waiting for them would never
// end.
enum class Threads : uint8_t { none, started, lost };
std::atomic<Threads> g_threads = Threads::none;

void need_threads() {
  if (g_threads == Threads::lost)
    throw std::runtime_error(
        "this process was forked after Raio had started threads; start processes with "
        "multiprocessing's method \"spawn\" or \"forkserver\"");
  g_threads = Threads::started;
}

// Calls f without the GIL.
template <class F>
auto unlocked(const F& f) {
  need_threads();
  const nb::gil_scoped_release no_gil;
  return f();
}

// The newest progress, from the library's thread to Python's.
class Board {
 public:
  void post(const raio::Progress& progress) {
    const std::lock_guard lock(mutex_);
    progress_ = progress;
  }
  std::optional<raio::Progress> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(progress_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::optional<raio::Progress> progress_;
};

constexpr const char* stage_name(raio::Progress::Stage stage) {
  switch (stage) {
    case raio::Progress::Stage::reading:
      return "reading";
    case raio::Progress::Stage::building:
      return "building";
    case raio::Progress::Stage::rendering:
      break;
  }
  return "rendering";
}

// Calls `work` on a thread of its own. Python's signals are handled meanwhile: if one raises, calls
// `cancel`. `report`, a Python function or None, receives the progress.
void attended(const std::function<void()>& work, const std::function<void()>& cancel, Board& board,
              const nb::object& report) {
  std::mutex mutex;
  std::condition_variable news;
  bool is_done = false;
  std::exception_ptr failure;
  std::optional<nb::python_error> raised;
  need_threads();
  {
    const nb::gil_scoped_release no_gil;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      is_done = true;
      news.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!news.wait_for(lock, std::chrono::milliseconds(50), [&] { return is_done; })) {
      lock.unlock();
      {
        const nb::gil_scoped_acquire gil;
        try {
          if (PyErr_CheckSignals() != 0) throw nb::python_error();
          if (const auto progress = board.take(); progress && !report.is_none())
            report(stage_name(progress->stage), progress->share, progress->rays);
        } catch (nb::python_error& error) {
          if (!raised) raised.emplace(std::move(error));
          cancel();
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (raised) throw nb::python_error(std::move(*raised));
  if (failure) std::rethrow_exception(failure);
}

// The same for calls of the library that a Job does not make.
void executed(const raio::Settings* settings, const nb::object& report,
              const std::function<void()>& work) {
  const std::string threads = settings ? settings->get("threads") : "";
  raio::Executor executor(threads.empty() ? 0 : std::stoi(threads));
  Board board;
  if (!report.is_none()) executor.on_progress([&](const auto& progress) { board.post(progress); });
  attended([&] { executor.run(work); }, [&] { executor.cancel(); }, board, report);
}

raio::Film render(const raio::Accel& accel, const raio::Settings& settings, const raio::Film* begun,
                  const nb::object& report) {
  std::optional<raio::Job> job;
  std::optional<raio::Film> film;
  Board board;
  unlocked([&] { job.emplace(accel, settings, begun ? std::optional(*begun) : std::nullopt); });
  if (!report.is_none()) job->on_progress([&](const auto& progress) { board.post(progress); });
  attended([&] { film.emplace(job->run()); }, [&] { job->cancel(); }, board, report);
  unlocked([&] { job.reset(); });
  return std::move(*film);
}

// The film of a picture before its first sample.
raio::Film begin(const raio::Scene& scene, const raio::Settings& settings) {
  return unlocked([&] { return raio::Job(scene, settings).film(); });
}

// --- scenes

raio::Appearance look(uint32_t material, const std::optional<Floats2>& colors,
                      const std::optional<Floats1>& opacity) {
  raio::Appearance appearance(material);
  appearance.colors = column<3>(colors);
  appearance.opacity = column<1>(opacity);
  return appearance;
}

nb::tuple camera_tuple(const raio::Camera& c) {
  return nb::make_tuple(c.from, c.at, c.up, c.fov_deg,
                        c.projection == raio::Projection::orthographic);
}

// --- annotations, as tuples of plain values, which can be pickled

using ScaleTuple = std::tuple<std::string, double, double, std::vector<float>>;
using LegendTuples = std::vector<std::pair<std::string, Triple>>;
using AnnotationsTuple = std::tuple<std::optional<ScaleTuple>, bool, LegendTuples,
                                    std::optional<std::pair<double, std::string>>>;

std::optional<ScaleTuple> tuple_of(const std::optional<raio::ColorScale>& scale) {
  if (!scale) return std::nullopt;
  return ScaleTuple(scale->name, scale->least, scale->most, scale->colors);
}

LegendTuples tuples_of(const std::vector<raio::LegendEntry>& legend) {
  LegendTuples all;
  for (const auto& [name, color] : legend) all.emplace_back(name, color);
  return all;
}

AnnotationsTuple tuple_of(const raio::Annotations& drawn) {
  AnnotationsTuple all{
      tuple_of(drawn.color_bar), drawn.color_bar_at_left, tuples_of(drawn.legend), {}};
  if (const auto& bar = drawn.scale_bar) std::get<3>(all) = {bar->pixels_per_unit, bar->unit};
  return all;
}

raio::Annotations annotations_of(const AnnotationsTuple& all) {
  const auto& [color_bar, at_left, legend, scale_bar] = all;
  raio::Annotations wanted;
  wanted.color_bar_at_left = at_left;
  if (color_bar) wanted.color_bar = std::make_from_tuple<raio::ColorScale>(*color_bar);
  for (const auto& [name, color] : legend) wanted.legend.push_back({name, color});
  if (scale_bar) wanted.scale_bar = {scale_bar->first, scale_bar->second};
  return wanted;
}

void bind_scene(nb::module_& m) {
  using raio::Scene;
  nb::class_<Scene>(m, "Scene")
      .def(nb::init<>())
      .def(nb::init<const Scene&>())
      .def_static(
          "read",
          [](const std::string& path, const raio::Settings& settings, const nb::object& report) {
            std::optional<Scene> scene;
            executed(&settings, report, [&] { scene.emplace(Scene::read(path, settings)); });
            return std::move(*scene);
          },
          "path"_a, "settings"_a, "report"_a = nb::none())
      .def_static(
          "parse",
          [](const nb::bytes& data, const std::string& name, const raio::Settings& settings) {
            const std::string_view text(data.c_str(), data.size());
            std::optional<Scene> scene;
            executed(&settings, nb::none(),
                     [&] { scene.emplace(Scene::parse(text, name, settings)); });
            return std::move(*scene);
          },
          "data"_a, "name"_a, "settings"_a)
      .def_static("from_bytes",
                  [](const nb::bytes& data) {
                    const std::string_view text(data.c_str(), data.size());
                    return unlocked([&] { return Scene::from_bytes(text); });
                  })
      .def("to_bytes",
           [](const Scene& scene) {
             std::string data;
             executed(nullptr, nb::none(), [&] { data = scene.to_bytes(); });
             return bytes(data);
           })
      .def("write",
           [](const Scene& scene, const std::string& path) {
             executed(nullptr, nb::none(), [&] { scene.write(path); });
           })
      .def("warnings", &Scene::warnings)
      .def("color_scale", [](const Scene& scene) { return tuple_of(scene.color_scale()); })
      .def("legend", [](const Scene& scene) { return tuples_of(scene.legend()); })
      .def("unit", &Scene::unit)
      .def("camera", [](const Scene& scene) { return camera_tuple(scene.camera()); })
      .def("set_camera",
           [](Scene& scene, Triple from, Triple at, Triple up, double fov_deg, bool parallel) {
             scene.set_camera(
                 {from, at, up, fov_deg,
                  parallel ? raio::Projection::orthographic : raio::Projection::perspective});
           })
      .def(
          "fit_camera",
          [](Scene& scene, std::optional<Triple> direction, Triple up, double margin) {
            unlocked([&] { scene.fit_camera(direction, up, margin); });
          },
          "direction"_a.none(), "up"_a, "margin"_a)
      .def("set_figure", &Scene::set_figure)
      .def("set_background", &Scene::set_background)
      .def("add_light", nb::overload_cast<Triple, std::optional<Triple>, double>(&Scene::add_light),
           "position"_a, "color"_a.none(), "size"_a)
      .def("add_material",
           [](Scene& scene, Triple color, double kd, double ks, double shine, double transmission,
              double ior, Triple specular, double roughness, double opacity,
              std::optional<uint32_t> texture) {
             return scene.add_material(
                 {color, kd, ks, shine, transmission, ior, specular, roughness, opacity, texture});
           })
      .def(
          "add_standard_material",
          [](Scene& scene, Triple color, double metallic, double roughness, double ior,
             double specular, Triple specular_color, double transmission, bool thin,
             Triple attenuation_color, double attenuation_distance, Triple emission,
             double clearcoat, double clearcoat_roughness, Triple sheen_color,
             double sheen_roughness, bool two_sided, bool unlit, double opacity, int alpha_mode,
             double alpha_cutoff, double normal_scale, std::optional<uint32_t> texture,
             std::optional<uint32_t> metallic_roughness_texture,
             std::optional<uint32_t> normal_texture, std::optional<uint32_t> emission_texture,
             std::optional<uint32_t> transmission_texture) {
            return scene.add_material(raio::StandardMaterial{color,
                                                             metallic,
                                                             roughness,
                                                             ior,
                                                             specular,
                                                             specular_color,
                                                             transmission,
                                                             thin,
                                                             attenuation_color,
                                                             attenuation_distance,
                                                             emission,
                                                             clearcoat,
                                                             clearcoat_roughness,
                                                             sheen_color,
                                                             sheen_roughness,
                                                             two_sided,
                                                             unlit,
                                                             opacity,
                                                             raio::AlphaMode(alpha_mode),
                                                             alpha_cutoff,
                                                             normal_scale,
                                                             texture,
                                                             metallic_roughness_texture,
                                                             normal_texture,
                                                             emission_texture,
                                                             transmission_texture});
          },
          nb::kw_only(), "color"_a, "metallic"_a, "roughness"_a, "ior"_a, "specular"_a,
          "specular_color"_a, "transmission"_a, "thin"_a, "attenuation_color"_a,
          "attenuation_distance"_a, "emission"_a, "clearcoat"_a, "clearcoat_roughness"_a,
          "sheen_color"_a, "sheen_roughness"_a, "two_sided"_a, "unlit"_a, "opacity"_a,
          "alpha_mode"_a, "alpha_cutoff"_a, "normal_scale"_a, "texture"_a.none(),
          "metallic_roughness_texture"_a.none(), "normal_texture"_a.none(),
          "emission_texture"_a.none(), "transmission_texture"_a.none())
      .def("add_texture",
           [](Scene& scene,
              nb::ndarray<const uint8_t, nb::ndim<3>, nb::c_contig, nb::device::cpu> texels) {
             return scene.add_texture(uint32_t(texels.shape(1)), uint32_t(texels.shape(0)),
                                      texels.data(), raio::TextureWrap::repeat,
                                      raio::TextureWrap::repeat, int(texels.shape(2)));
           })
      .def("add_spheres",
           [](Scene& scene, const Floats2& centers, const Floats1& radii, uint32_t material,
              const std::optional<Floats2>& colors, const std::optional<Floats1>& opacity) {
             executed(nullptr, nb::none(),
                      [&, c = column<3>(centers), r = column<1>(radii),
                       l = look(material, colors, opacity)] { scene.add_spheres(c, r, l); });
           })
      .def("add_cones",
           [](Scene& scene, const Floats2& starts, const Floats2& ends, const Floats1& start_radii,
              const Floats1& end_radii, uint32_t material, const std::optional<Floats2>& colors,
              const std::optional<Floats1>& opacity) {
             executed(nullptr, nb::none(),
                      [&, a = column<3>(starts), b = column<3>(ends), ra = column<1>(start_radii),
                       rb = column<1>(end_radii),
                       l = look(material, colors, opacity)] { scene.add_cones(a, b, ra, rb, l); });
           })
      .def("add_ellipsoids",
           [](Scene& scene, const Floats2& centers, const Floats2& axes, uint32_t material,
              const std::optional<Floats2>& colors, const std::optional<Floats1>& opacity) {
             executed(nullptr, nb::none(),
                      [&, c = column<3>(centers), a = column<9>(axes),
                       l = look(material, colors, opacity)] { scene.add_ellipsoids(c, a, l); });
           })
      .def("add_discs",
           [](Scene& scene, const Floats2& centers, const Floats2& normals, const Floats1& radii,
              const Floats1& inner_radii, uint32_t material, const std::optional<Floats2>& colors,
              const std::optional<Floats1>& opacity) {
             executed(nullptr, nb::none(),
                      [&, c = column<3>(centers), n = column<3>(normals), r = column<1>(radii),
                       i = column<1>(inner_radii),
                       l = look(material, colors, opacity)] { scene.add_discs(c, n, r, i, l); });
           })
      .def("add_triangles",
           [](Scene& scene, const Floats2& positions, const Indices2& triangles,
              const std::optional<Floats2>& normals, uint32_t material,
              const std::optional<Floats2>& colors, const std::optional<Floats1>& opacity) {
             executed(
                 nullptr, nb::none(),
                 [&, p = column<3>(positions), t = column<3>(triangles), n = column<3>(normals),
                  l = look(material, colors, opacity)] { scene.add_triangles(p, t, n, l); });
           })
      .def("add_mesh",
           [](Scene& scene, const Floats2& positions, const Indices2& triangles,
              const std::optional<Floats2>& normals, const std::optional<Floats2>& uv,
              const std::optional<Floats2>& colors, uint32_t material) {
             executed(nullptr, nb::none(),
                      [&, p = column<3>(positions), t = column<3>(triangles),
                       n = column<3>(normals), w = column<2>(uv),
                       c = column<3>(colors)] { scene.add_mesh(p, t, n, w, c, material); });
           })
      .def("add_prototype", &Scene::add_prototype)
      .def("add_instances",
           [](Scene& scene, uint32_t prototype, const Floats2& matrices) {
             scene.add_instances(prototype, column<12>(matrices));
           })
      .def("primitive_count", &Scene::primitive_count)
      .def("count", [](const Scene& scene, int kind) { return scene.count(raio::Kind(kind)); })
      .def("mesh_triangle_count", &Scene::mesh_triangle_count)
      .def("instance_count", &Scene::instance_count)
      .def("bounds", &Scene::bounds);
}

void bind_rays(nb::module_& m) {
  using raio::Accel;
  nb::class_<Accel>(m, "Accel")
      .def(
          "__init__",
          [](Accel* self, const raio::Scene& scene, const raio::Settings& settings,
             const Accel* like, const nb::object& report) {
            std::optional<Accel> accel;
            executed(&settings, report, [&] { accel.emplace(scene, settings, like); });
            new (self) Accel(std::move(*accel));
          },
          "scene"_a, "settings"_a, "like"_a.none() = nb::none(), "report"_a = nb::none())
      .def("info",
           [](const Accel& accel) {
             const Accel::Info info = accel.info();
             nb::dict all;
             all["kind"] = info.kind, all["primitives"] = info.primitives;
             all["bytes"] = info.bytes, all["cells"] = info.cells;
             all["references"] = info.references;
             return all;
           })
      .def("closest",
           [](const Accel& accel, const Floats2& origins, const Floats2& directions,
              const std::optional<Floats1>& lengths, bool wants_all) {
             const size_t n = origins.shape(0), more = wants_all ? n : 0;
             std::vector<float> distance(n), position(3 * more), normal(3 * more), uv(2 * more);
             std::vector<uint8_t> kind(more);
             std::vector<int64_t> index(more), instance(more);
             Accel::Hits hits{distance.data()};
             if (wants_all)
               hits = {distance.data(), kind.data(),   index.data(), instance.data(),
                       position.data(), normal.data(), uv.data()};
             executed(nullptr, nb::none(),
                      [&, o = column<3>(origins), d = column<3>(directions),
                       l = column<1>(lengths)] { accel.closest(o, d, l, hits); });
             nb::dict all;
             all["distance"] = owned(std::move(distance), {n});
             if (!wants_all) return all;
             all["kind"] = owned(std::move(kind), {n});
             all["id"] = owned(std::move(index), {n});
             all["instance"] = owned(std::move(instance), {n});
             all["position"] = owned(std::move(position), {n, 3});
             all["normal"] = owned(std::move(normal), {n, 3});
             all["uv"] = owned(std::move(uv), {n, 2});
             return all;
           })
      .def("occluded", [](const Accel& accel, const Floats2& origins, const Floats2& directions,
                          const std::optional<Floats1>& lengths) {
        const size_t n = origins.shape(0);
        std::vector<uint8_t> occluded(n);
        executed(nullptr, nb::none(),
                 [&, o = column<3>(origins), d = column<3>(directions), l = column<1>(lengths)] {
                   accel.occluded(o, d, l, occluded.data());
                 });
        return owned(std::move(occluded), {n});
      });
}

void bind_film(nb::module_& m) {
  using raio::Film;
  const auto size = [](const Film& film) {
    return std::pair{size_t(film.height()), size_t(film.width())};
  };
  nb::class_<Film>(m, "Film")
      .def(nb::init<const Film&>())
      .def_static(
          "read",
          [](const std::string& path) { return unlocked([&] { return Film::read(path); }); })
      .def_static("from_bytes",
                  [](const nb::bytes& data) {
                    const std::string_view text(data.c_str(), data.size());
                    return unlocked([&] { return Film::from_bytes(text); });
                  })
      .def_static("merge",
                  [](const std::vector<const Film*>& films) {
                    return unlocked([&] {
                      std::vector<Film> all;
                      for (const Film* film : films) all.push_back(*film);
                      return Film::merge(std::move(all));
                    });
                  })
      .def("to_bytes",
           [](const Film& film) { return bytes(unlocked([&] { return film.to_bytes(); })); })
      .def("write",
           [](const Film& film, const std::string& path) { unlocked([&] { film.write(path); }); })
      .def("encode",
           [](const Film& film, const std::string& format) {
             return bytes(unlocked([&] { return film.encode(format); }));
           })
      .def("add",
           [](Film& film, const nb::bytes& data) {
             const std::string_view text(data.c_str(), data.size());
             unlocked([&] { film.add(Film::from_bytes(text)); });
           })
      .def("missing", nb::overload_cast<>(&Film::missing, nb::const_))
      .def("missing", nb::overload_cast<uint32_t, uint32_t>(&Film::missing, nb::const_))
      .def("tiles", &Film::tiles)
      .def("samples", &Film::samples)
      .def("settings", &Film::settings)
      .def("set",
           [](Film& film, std::string_view name, std::string_view value) { film.set(name, value); })
      .def("size", [](const Film& film) { return std::pair{film.width(), film.height()}; })
      .def("rgba",
           [size](const Film& film) {
             auto pixels = unlocked([&] { return film.rgba(); });
             const auto [h, w] = size(film);
             return owned(std::move(pixels), {h, w, 4});
           })
      .def("display",
           [size](const Film& film) {
             auto pixels = unlocked([&] { return film.display(); });
             const auto [h, w] = size(film);
             return owned(std::move(pixels), {h, w, 4});
           })
      .def("channels", &Film::channels)
      .def("channel",
           [size](const Film& film, std::string_view name) -> nb::object {
             const auto [h, w] = size(film);
             if (name == "id" || name == "object" || name == "samples")
               return nb::cast(owned(unlocked([&] { return film.integers(name); }), {h, w}));
             int components = 1;
             auto values = unlocked([&] { return film.channel(name, &components); });
             if (components == 1) return nb::cast(owned(std::move(values), {h, w}));
             return nb::cast(owned(std::move(values), {h, w, size_t(components)}));
           })
      .def("annotate",
           [](Film& film, const AnnotationsTuple& annotations) {
             film.annotate(annotations_of(annotations));
           })
      .def("annotations", [](const Film& film) { return tuple_of(film.annotations()); })
      .def("pixels_per_unit", &Film::pixels_per_unit)
      .def("nan_samples", &Film::nan_samples);
}

void bind_settings(nb::module_& m) {
  using raio::Settings;
  nb::class_<Settings>(m, "Settings")
      .def(nb::init<>())
      .def(nb::init<const Settings&>())
      .def("set", [](Settings& settings, std::string_view name,
                     std::string_view value) { settings.set(name, value); })
      .def("get", &Settings::get);
  m.def("options", [] {
    nb::list all;
    for (const Settings::Option& option : Settings::options()) {
      nb::dict entry;
      entry["name"] = option.name, entry["value_name"] = option.value_name;
      entry["help"] = option.help, entry["words"] = option.words, entry["type"] = option.type;
      entry["of_reader"] = option.of_reader, entry["default"] = option.default_value;
      all.append(entry);
    }
    return all;
  });
}

}  // namespace

NB_MODULE(_raio, m) {
  nb::set_leak_warnings(false);  // the package's own objects live until Python's end
  nb::register_exception_translator([](const std::exception_ptr& failure, void*) {
    try {
      std::rethrow_exception(failure);
    } catch (const raio::Error& error) {
      raise(error);
    }
  });
#ifndef _WIN32
  pthread_atfork(nullptr, nullptr, [] {
    if (g_threads == Threads::started) g_threads = Threads::lost;
  });
#endif
  bind_settings(m);
  bind_scene(m);
  bind_rays(m);
  bind_film(m);
  m.def("begin", &begin);
  m.def("render", &render, "accel"_a, "settings"_a, "begun"_a.none(), "report"_a = nb::none());
  m.def("set_scene_error", [](nb::object type) { scene_error() = std::move(type); });
  m.def("drawing_problem", &raio::drawing_problem);
  m.def("version", &raio::version);
  m.def("parse_color", &raio::parse_color);
  m.def("to_linear", [](nb::ndarray<float, nb::ndim<1>, nb::c_contig, nb::device::cpu> values) {
    unlocked([&] { raio::to_linear(values.data(), values.size()); });
  });
  m.def("colormap", [](std::string_view name) { return owned(raio::colormap(name), {256, 3}); });
}
