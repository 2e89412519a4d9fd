// The public interface (include/raio/raio.h) over the rooms: plain values in and out, failures as
// exceptions, nothing else.
#define RAIO_LIBRARY_SOURCE
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <raio/raio.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/parallel.h"
#include "io/image/image.h"
#include "io/nff/nff.h"
#include "io/scene_file.h"
#include "render/options.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "render/render.h"
#include "scene/scene.h"

namespace raio::v1 {
namespace {

Vec3d vec(const Triple& t) { return {t[0], t[1], t[2]}; }
Triple triple(Vec3d v) { return {v.x, v.y, v.z}; }
Rgb rgb(const Triple& t) { return Rgb(vec(t)); }

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorKind::bad_input, message); }

ErrorKind kind_of(raio::ErrorKind kind) {
  switch (kind) {
    case raio::ErrorKind::bad_input:
    case raio::ErrorKind::bad_option:
    case raio::ErrorKind::cannot_read:
      return ErrorKind::bad_input;
    case raio::ErrorKind::cannot_write:
      return ErrorKind::cannot_write;
    case raio::ErrorKind::no_resource:
      return ErrorKind::no_resource;
    case raio::ErrorKind::stopped:
      break;
  }
  return ErrorKind::cancelled;
}

[[noreturn]] void fail(const raio::Error& error) {
  throw Error(kind_of(error.kind), error.text(), {}, error.place.line, error.place.column);
}

// Runs out of memory as an Error, too.
template <class F>
auto guarded(F&& f) try {
  return f();
} catch (const std::bad_alloc&) {
  throw Error(ErrorKind::no_resource, "out of memory");
}

const OptionSpec& spec_of(std::string_view name) {
  for (const OptionSpec& spec : render_option_table())
    if (spec.name == name) return spec;
  refuse(fmt::format("there is no setting '{}'", name));
}

}  // namespace

Error::Error(ErrorKind kind, const std::string& message, std::string file, int line, int column)
    : std::runtime_error(message),
      kind_(kind),
      file_(std::move(file)),
      line_(line),
      column_(column) {}

struct Scene::Data {
  raio::Scene scene;
  std::vector<std::string> warnings;
};

namespace {

std::unique_ptr<Scene::Data> taken(std::expected<ReadScene, Diagnostics> read) {
  if (!read) {
    const Diagnostic& first = read.error().front();
    throw Error(first.message == kNoMemory ? ErrorKind::no_resource : ErrorKind::bad_input,
                first.text(), first.file, first.line, first.column);
  }
  auto data = std::make_unique<Scene::Data>(Scene::Data{std::move(read->scene), {}});
  for (const Diagnostic& warning : read->warnings) data->warnings.push_back(warning.text());
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
  return guarded([&] { return Scene(taken(read_scene(path))); });
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
  scene.camera.fov_deg = float(camera.fov_deg);
}

Camera Scene::camera() const {
  const raio::Scene& scene = data_->scene;
  return {triple(scene.origin + Vec3d(scene.camera.from)),
          triple(scene.origin + Vec3d(scene.camera.at)), triple(Vec3d(scene.camera.up)),
          double(scene.camera.fov_deg)};
}

void Scene::set_background(Triple color) { data_->scene.background = rgb(color); }

void Scene::add_light(Triple position, std::optional<Triple> color) {
  Light light{Vec3f(vec(position) - data_->scene.origin), {}};
  if (color) light.color = rgb(*color);
  data_->scene.lights.push_back(light);
}

uint32_t Scene::add_material(const Material& m) {
  data_->scene.materials.push_back({rgb(m.color), float(m.kd), float(m.ks), float(m.shine),
                                    float(m.transmission), float(m.ior)});
  return uint32_t(data_->scene.materials.size() - 1);
}

namespace {

// Point number i of an array of x y z, as the scene keeps it.
Vec3f point(const raio::Scene& scene, const float* xyz, size_t i) {
  const Vec3f p = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
  return scene.origin == Vec3d() ? p : Vec3f(Vec3d(p) - scene.origin);
}

}  // namespace

void Scene::add_spheres(size_t count, const float* centers, const float* radii, uint32_t material) {
  guarded([&] {
    raio::Scene& scene = data_->scene;
    for (size_t i = 0; i < count; ++i) {
      if (!(radii[i] > 0))
        refuse(fmt::format("the radius of sphere {} is {}, not above 0", i, radii[i]));
      scene.spheres.push_back({point(scene, centers, i), radii[i]});
    }
    scene.sphere_materials.resize(scene.spheres.size(), material);
  });
}

void Scene::add_cones(size_t count, const float* starts, const float* ends,
                      const float* start_radii, const float* end_radii, uint32_t material) {
  guarded([&] {
    raio::Scene& scene = data_->scene;
    for (size_t i = 0; i < count; ++i)
      scene.cones.push_back(
          {point(scene, starts, i), start_radii[i], point(scene, ends, i), end_radii[i]});
    scene.cone_materials.resize(scene.cones.size(), material);
  });
}

void Scene::add_triangles(size_t vertices, const float* positions, size_t triangles,
                          const uint32_t* indices, const float* normals, uint32_t material) {
  guarded([&] {
    raio::Scene& scene = data_->scene;
    const auto first = uint32_t(scene.positions.size());
    const auto first_normal = uint32_t(scene.normals.size());
    for (size_t i = 0; i < 3 * triangles; ++i)
      if (indices[i] >= vertices)
        refuse(fmt::format("triangle {} names vertex {} of {}", i / 3, indices[i], vertices));
    for (size_t i = 0; i < vertices; ++i) {
      scene.positions.push_back(point(scene, positions, i));
      if (!normals) continue;
      const Vec3f n = {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
      if (!(length(n) > 0)) refuse(fmt::format("the normal of vertex {} is zero", i));
      scene.normals.push_back(normalize(n));
    }
    constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
    // Normals are kept from the first smooth triangle on.
    if (normals) scene.triangle_normals.resize(scene.triangles.size(), kFlat);
    const bool smooth = !scene.triangle_normals.empty() || normals;
    for (size_t t = 0; t < triangles; ++t) {
      const uint32_t* const v = indices + 3 * t;
      scene.triangles.push_back({first + v[0], first + v[1], first + v[2]});
      if (normals)
        scene.triangle_normals.push_back(
            {first_normal + v[0], first_normal + v[1], first_normal + v[2]});
      else if (smooth)
        scene.triangle_normals.push_back(kFlat);
    }
    scene.triangle_materials.resize(scene.triangles.size(), material);
  });
}

size_t Scene::primitive_count() const { return data_->scene.primitive_count(); }

std::optional<std::array<Triple, 2>> Scene::bounds() const {
  const Box3f box = raio::bounds(data_->scene);
  if (box.empty()) return std::nullopt;
  const Vec3d origin = data_->scene.origin;
  return std::array{triple(origin + Vec3d(box.lo)), triple(origin + Vec3d(box.hi))};
}

struct Settings::Data {
  RenderOptions options;
};

Settings::Settings() : data_(std::make_unique<Data>()) {}
Settings::Settings(const Settings& other) : data_(std::make_unique<Data>(*other.data_)) {}
Settings& Settings::operator=(const Settings& other) {
  data_ = std::make_unique<Data>(*other.data_);
  return *this;
}
Settings::~Settings() = default;

Settings& Settings::set(std::string_view name, std::string_view value) {
  const OptionSpec& spec = spec_of(name);
  if (spec.is_switch() && value != "true" && value != "false")
    refuse(fmt::format("{}: expected true or false, found '{}'", name, value));
  if (const auto done = set_option(data_->options, spec, value); !done) fail(done.error());
  return *this;
}

std::string Settings::get(std::string_view name) const {
  return option_text(data_->options, spec_of(name));
}

std::vector<Settings::Option> Settings::options() {
  std::vector<Option> all;
  for (const OptionSpec& spec : render_option_table()) {
    Option& option = all.emplace_back(Option{
        std::string(spec.name), std::string(spec.value_name), with_settings(spec.help, {}), {}});
    for (const std::string_view word : spec.words) option.words.emplace_back(word);
  }
  return all;
}

struct Film::Data {
  Picture picture;
  Metadata settings;
};

Film::Film(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;
Film::~Film() = default;

int Film::width() const { return data_->picture.color.width; }
int Film::height() const { return data_->picture.color.height; }

std::vector<float> Film::rgba() const {
  const Picture& p = data_->picture;
  std::vector<float> out;
  out.reserve(4 * p.color.pixels.size());
  for (size_t i = 0; i < p.color.pixels.size(); ++i) {
    const Rgb& c = p.color.pixels[i];
    out.insert(out.end(), {c.x, c.y, c.z, p.alpha.empty() ? 1.0f : p.alpha[i]});
  }
  return out;
}

std::vector<std::string> Film::channels() const {
  std::vector<std::string> names;
  for (const Layer& layer : data_->picture.layers) names.push_back(layer.name);
  return names;
}

std::vector<float> Film::channel(std::string_view name, int* components) const {
  const auto& layers = data_->picture.layers;
  const auto layer = std::ranges::find(layers, name, &Layer::name);
  if (layer == layers.end())
    refuse(fmt::format("the film has no channel '{}'; it has {}", name,
                       layers.empty() ? "none" : fmt::format("{}", fmt::join(channels(), ", "))));
  if (components) *components = int(layer->components.size());
  return std::visit(
      [](const auto& values) { return std::vector<float>(values.begin(), values.end()); },
      layer->values);
}

void Film::write(const std::string& path) const {
  guarded([&] {
    if (const auto done = write_picture(data_->picture, path, data_->settings); !done)
      fail(done.error());
  });
}

struct Job::Data {
  raio::Scene scene;
  RenderSettings settings;
  RenderControl control;
  std::function<void(const Progress&)> on_progress;
};

Job::Job(const Scene& scene, const Settings& settings)
    : data_(guarded([&] { return std::make_unique<Data>(scene.data().scene); })) {
  if (const auto problems = validate(data_->scene); !problems.empty()) refuse(problems.front());
  const RenderOptions& options = settings.data().options;
  if (const auto why = option_conflict(options, &data_->scene)) fail(*why);
  data_->settings = resolve_options(options, data_->scene);
}
Job::~Job() = default;

void Job::on_progress(std::function<void(const Progress&)> callback) {
  data_->on_progress = std::move(callback);
}

namespace {

// Tells of a render's progress while it lives.
class Teller {
 public:
  Teller(const RenderControl& control, const std::function<void(const Progress&)>& tell) {
    if (!tell) return;
    using Clock = std::chrono::steady_clock;
    ticker_ = Ticker(0.1, [&, start = Clock::now()] {
      const double total = double(std::max<uint64_t>(1, control.work_total));
      tell({double(control.work_done) / total, control.rays_done,
            std::chrono::duration<double>(Clock::now() - start).count()});
    });
  }

 private:
  Ticker ticker_;
};

}  // namespace

Film Job::run() {
  return guarded([&] {
    const RenderSettings& settings = data_->settings;
    const Teller teller(data_->control, data_->on_progress);
    const auto film = make_film(data_->scene, settings);
    if (!film) fail(film.error());
    std::expected<std::unique_ptr<Accel>, raio::Error> accel;
    on_threads(settings.threads,
               [&] { accel = build_accel(data_->scene, settings.accel, settings.one_sided); });
    if (!accel) fail(accel.error());
    if (!render(data_->scene, **accel, settings, **film, data_->control).finished)
      throw Error(ErrorKind::cancelled, "the render was cancelled");
    return Film(std::make_unique<Film::Data>(
        Film::Data{picture_of(**film, settings), settings_of(data_->scene, settings)}));
  });
}

void Job::cancel() { data_->control.stop = true; }

std::string version() { return RAIO_VERSION; }

}  // namespace raio::v1
