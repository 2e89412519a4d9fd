#include "device/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <sstream>

#include "base/exact_math.h"
#include "device/look.h"

namespace raio::device {

using core::exact_atan, core::exact_cos, core::exact_sin, core::exact_tan;
using core::Vec3d;

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::string_view kChannelPrefix = "channel.";

// Options of `raio render` for applications that cannot set them: name=value, separated by blanks.
// Applications set the others, such as the size.
constexpr std::string_view kOptions[] = {"samples",   "seed",           "threads",
                                         "accel",     "look",           "sky-light",
                                         "key-light", "occlusion-rays", "occlusion-distance",
                                         "outline",   "depth-cue"};
std::map<std::string, std::string> options_of_environment() {
  std::map<std::string, std::string> out;
  const char* const text = std::getenv("RAIO_OPTIONS");  // NOLINT(concurrency-mt-unsafe)
  std::istringstream words(text ? text : "");
  for (std::string word; words >> word;) {
    const size_t equals = word.find('=');
    out[word.substr(0, equals)] = equals == std::string::npos ? "true" : word.substr(equals + 1);
  }
  return out;
}

uint8_t byte_of(float x) {
  return uint8_t(std::lround(std::clamp(std::isnan(x) ? 0.0f : x, 0.0f, 1.0f) * 255));
}

// The components of pixels, as the type of a channel has them.
std::vector<std::byte> converted(const std::vector<float>& values, DataType type) {
  const Layout layout = *layout_of(type);
  std::vector<std::byte> out(values.size() * size_of(type) / size_t(layout.count));
  for (size_t i = 0; i < values.size(); ++i) {
    const float x = values[i];
    const bool opacity = layout.count == 4 && i % 4 == 3;
    switch (layout.scalar) {
      case Scalar::ufixed8:
        out[i] = std::byte(byte_of(x));
        break;
      case Scalar::srgb8:
        out[i] = std::byte(opacity ? byte_of(x) : display_byte(double(x)));
        break;
      case Scalar::fixed16: {
        const auto fixed = int16_t(std::lround(std::clamp(x, -1.0f, 1.0f) * 32767));
        std::memcpy(&out[2 * i], &fixed, 2);
        break;
      }
      default:
        std::memcpy(&out[4 * i], &x, 4);
    }
  }
  return out;
}

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> out(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(out.data(), values.data(), out.size());
  return out;
}

// The rows of a film from the bottom.
std::vector<float> flipped(const std::vector<float>& rows, size_t width, size_t components) {
  std::vector<float> out;
  out.reserve(rows.size());
  for (size_t y = rows.size() / (width * components); y-- > 0;)
    out.insert(out.end(), rows.begin() + ptrdiff_t(y * width * components),
               rows.begin() + ptrdiff_t((y + 1) * width * components));
  return out;
}

// Types of channels.
bool is_channel_type(std::string_view channel, DataType type) {
  using enum DataType;
  if (channel == "color")
    return type == ufixed8_vec4 || type == ufixed8_rgba_srgb || type == float32_vec4;
  if (channel == "depth") return type == float32;
  if (channel == "normal") return type == float32_vec3 || type == fixed16_vec3;
  if (channel == "albedo")
    return type == float32_vec3 || type == ufixed8_vec3 || type == ufixed8_rgb_srgb;
  return type == uint32;
}

}  // namespace

Frame::~Frame() {
  discard();
  if (!thread_.joinable()) return;
  if (thread_.get_id() == std::this_thread::get_id())
    thread_.detach();  // released by its own callback
  else
    thread_.join();
}

// NOLINTNEXTLINE(readability-function-size): one parameter after another
std::optional<Frame::Task> Frame::begin() {
  const auto world = object<World>("world");
  const auto camera = object("camera"), renderer = object("renderer");
  const auto size = get("size", std::array<uint32_t, 2>{0, 0});
  const auto refuse = [&](const std::string& text) {
    device.report(this, Severity::error, Status::invalid_operation, text + "; nothing is rendered");
    return std::nullopt;
  };
  if (!world) return refuse("has no 'world'");
  if (!camera || !camera->info) return refuse("has no 'camera' of a supported kind");
  if (!renderer || !renderer->info) return refuse("has no 'renderer' of a supported kind");
  if (size[0] == 0 || size[1] == 0) return refuse("has no 'size'");

  Task task;
  task.size = size;
  for (const ParameterInfo& parameter : info->parameters) {
    const std::string_view name = parameter.name;
    const Value* const value = name.starts_with(kChannelPrefix) ? find(name) : nullptr;
    if (!value) continue;
    const std::string_view channel = name.substr(kChannelPrefix.size());
    const auto type = value->as<DataType>();
    if (!is_channel_type(channel, type))
      return refuse(
          fmt::format("'{}' is {}, expected {}", name, name_of(type), parameter.description));
    task.channels.emplace(channel, type);
    task.by_rays |= channel == "depth" || channel.ends_with("Id");
  }
  task.world = world->shown();
  task.stamp = world->stamp() ^ (camera->stamp() * 3) ^ (renderer->stamp() * 5);

  Settings& s = task.settings;
  Eye& eye = task.eye;
  eye.from = camera->vec3("position", {0, 0, 0});
  eye.up = camera->vec3("up", {0, 1, 0});
  const Vec3d direction = camera->vec3("direction", {0, 0, 1});
  if (!(length(direction) > 0)) return refuse("the camera's 'direction' is zero");
  eye.forward = normalize(direction);
  if (!(length(cross(eye.forward, eye.up)) > 1e-6 * length(eye.up)))
    eye.up = std::abs(eye.forward.y) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
  if (camera->subtype == "perspective") {
    eye.fov_deg = double(camera->get("fovy", float(std::numbers::pi / 3))) * kDegrees;
    if (!(eye.fov_deg > 0 && eye.fov_deg < 180))
      return refuse("the camera's 'fovy' must be above 0 and below pi");
    if (const float radius = camera->get("apertureRadius", 0.0f); radius > 0)
      s.set("dof")
          .set("aperture", double(radius))
          .set("focus", double(camera->get("focusDistance", 1.0f)));
  } else if (camera->subtype == "orthographic") {
    // At a distance of its height, the picture spans this angle.
    eye.distance = double(camera->get("height", 1.0f));
    if (!(eye.distance > 0)) return refuse("the camera's 'height' must be above 0");
    eye.fov_deg = 2 * exact_atan(0.5) * kDegrees;
  }
  // The region is a part of a larger picture of whole pixels.
  const auto region = camera->get("imageRegion", std::array<float, 4>{0, 0, 1, 1});
  task.whole = size;
  if (region != std::array<float, 4>{0, 0, 1, 1}) {
    for (size_t k = 0; k < 2; ++k) {
      const double part = double(region[2 + k]) - double(region[k]),
                   low = k == 0 ? double(region[0]) : 1 - double(region[3]);
      if (!(part > 0 && low >= 0 && part + low <= 1 + 1e-6) || double(size[k]) / part > 100000)
        return refuse("the camera's 'imageRegion' must be within 0 to 1");
      task.whole[k] = uint32_t(std::lround(double(size[k]) / part));
      if (const double exact = low * double(task.whole[k]);
          std::abs(exact - std::round(exact)) > 1e-3)
        camera->warn("'imageRegion' is rounded to whole pixels");
      task.shift[k] =
          std::min(uint32_t(std::lround(low * double(task.whole[k]))), task.whole[k] - size[k]);
    }
    s.set("crop", {task.shift[0], task.shift[1], task.shift[0] + size[0], task.shift[1] + size[1]});
  }
  const double aspect = double(task.whole[0]) / double(task.whole[1]);
  if (const double asked = double(camera->get("aspect", float(aspect)));
      std::abs(asked / aspect - 1) > 0.01)
    camera->warn(fmt::format(
        "'aspect' {:.3g} differs from that of the frame, {:.3g}, which is used: pixels are square",
        asked, aspect));

  if (const auto image = renderer->object<Array>("background"))
    task.background_image = image->count() > 0 ? image : nullptr;
  else
    task.background = renderer->get("background", std::array<float, 4>{0, 0, 0, 1});
  auto options = options_of_environment();
  Settings own;  // their values
  std::erase_if(options, [&](const auto& option) {
    try {
      own.set(option.first, option.second);
      if (std::ranges::find(kOptions, option.first) != std::end(kOptions)) return false;
      renderer->warn(fmt::format("RAIO_OPTIONS: {} cannot be set here; it can have {}",
                                 option.first, fmt::join(kOptions, ", ")));
    } catch (const Error& error) {
      renderer->warn(fmt::format("RAIO_OPTIONS: {}", error.what()));
    }
    return true;
  });
  const bool accumulates = is_on("accumulation", false);
  int samples = renderer->get("pixelSamples", accumulates ? 4 : 16);
  if (const auto asked = options.extract("samples")) samples = std::stoi(asked.mapped());
  if (samples < 1) return refuse("'pixelSamples' must be at least 1");
  task.samples = uint32_t(samples);
  s.set("size", {task.whole[0], task.whole[1]}).set("from", triple(eye.from));
  s.set("at", triple(eye.from + eye.forward * eye.distance)).set("up", triple(eye.up));
  if (camera->subtype != "omnidirectional") s.set("fov", eye.fov_deg);
  s.set("projection", camera->subtype), eye.projection = camera->subtype;
  if (renderer->subtype == "views") {
    s.set("integrator", "views").set("view", renderer->word("view"));
  } else {
    const bool is_path = renderer->subtype == "path";
    s.set("integrator", is_path ? "path" : "ambient");
    const std::string_view look = is_path ? "application" : renderer->word("look");
    if (look == "application" && !options.contains("look")) {
      const bool lights = task.world->has_lights && renderer->is_on("lights", true);
      // Beside an hdri light, no other light comes from all sides.
      Vec3d sky(1);
      if (!task.world->has_environment)
        sky = renderer->vec3("ambientColor", sky) *
              double(renderer->get("ambientRadiance", lights ? 0.0f : 1.0f));
      else if (renderer->get("ambientRadiance", 0.0f) > 0)
        renderer->warn("'ambientRadiance' is ignored beside an hdri light");
      s.set("look", "matte-1").set("sky-light", triple(sky));
      s.set("key-light", lights ? "scene" : "off");
    } else {
      s.set("key-light", "on");
      if (look != "application") s.set("look", look);
    }
    if (!is_path) s.set("occlusion-rays", renderer->get("ambientSamples", 2));
    if (renderer->find("outline")) s.set("outline", double(renderer->get("outline", 0.0f)));
    if (const float distance = renderer->get("ambientOcclusionDistance", 0.0f); distance > 0)
      s.set("occlusion-distance", double(distance));
    task.open = !task.world->environment_visible;
  }
  if (task.open) s.set("background", "transparent");
  std::string channels;
  for (const char* channel : {"normal", "albedo"})
    if (task.channels.contains(channel))
      channels += (channels.empty() ? "" : ",") + std::string(channel);
  if (!channels.empty()) s.set("channels", channels);

  for (const auto& [name, value] : options) s.set(name, value);

  // Frames of an unchanged scene continue the film.
  if (accumulates && film_ && film_stamp_ == task.stamp && world_ == task.world &&
      picture_.size == size && channels_ == task.channels)
    task.begun = film_, task.samples += film_samples_;
  s.set("samples", int(task.samples));
  return task;
}

void Frame::render(std::function<void()> completed) {
  if (thread_.get_id() == std::this_thread::get_id())
    return device.report(this, Severity::error, Status::invalid_operation,
                         "cannot be rendered by its own callback");
  ready(true);
  if (thread_.joinable()) thread_.join();
  std::optional<Task> task;
  try {
    const std::lock_guard lock(device.mutex());
    task = begin();
  } catch (const std::exception& error) {
    device.report(this, Severity::error, Status::invalid_operation,
                  fmt::format("{}; nothing is rendered", error.what()));
  }
  if (!task) return;
  rendered_ = done_ = discarded_ = false, progress_ = 0;
  thread_ =
      std::thread([this, completed = std::move(completed), task = std::move(*task)]() mutable {
        try {
          work(std::move(task));
        } catch (const std::exception& error) {
          const auto* const own = dynamic_cast<const Error*>(&error);
          if (!own || own->kind() != ErrorKind::cancelled)
            device.report(this, Severity::error,
                          own && own->kind() == ErrorKind::no_resource ? Status::out_of_memory
                                                                       : Status::unknown_error,
                          error.what());
        }
        {
          const std::lock_guard lock(mutex_);
          job_ = nullptr, rendered_ = true;
          changed_.notify_all();
        }
        const auto keep = weak_from_this();
        if (completed) completed();
        if (const auto self = keep.lock()) {  // the callback may have released the frame
          const std::lock_guard lock(mutex_);
          done_ = true;
          changed_.notify_all();
        }
      });
}

void Frame::work(Task task) {
  const auto start = std::chrono::steady_clock::now();
  const Accel& accel = task.world->accel(task.settings);
  {
    const std::lock_guard lock(mutex_);
    if (discarded_) return;
    job_ = std::make_shared<Job>(accel, task.settings, std::move(task.begun));
    job_->on_progress([this](const Progress& p) { progress_ = float(p.share); });
  }
  Film film = job_->run();
  Picture picture;
  picture.size = task.size;
  const size_t width = task.size[0], height = task.size[1];
  picture.color = flipped(film.rgba(), width, 4);
  if (device.display_colors)
    for (size_t k = 0; k < 3; ++k)
      task.background[k] = float(light_of_display(double(task.background[k])));
  for (size_t y = 0; task.open && y < height; ++y)
    for (size_t x = 0; x < width; ++x) {
      float* const pixel = &picture.color[4 * (y * width + x)];
      std::array<float, 4> behind = task.background;
      if (pixel[3] < 1 && task.background_image) {
        const auto v = image_at(*task.background_image, (double(x) + 0.5) / double(width),
                                (double(y) + 0.5) / double(height));
        for (size_t k = 0; k < 4; ++k) behind[k] = float(v[k]);
      }
      for (size_t k = 0; k < 3; ++k) pixel[k] += (1 - pixel[3]) * behind[k];
      pixel[3] += (1 - pixel[3]) * behind[3];
    }
  for (size_t i = 0; device.display_colors && i < picture.color.size(); ++i)
    if (i % 4 != 3) picture.color[i] = float(display_of_light(double(picture.color[i])));
  if (task.channels.contains("albedo")) picture.albedo = flipped(film.channel("albedo"), width, 3);
  if (task.channels.contains("normal")) {
    picture.normal = flipped(film.channel("normal"), width, 3);
    for (size_t i = 0; i < picture.normal.size(); i += 3) {
      float* const n = &picture.normal[i];
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (int k = 0; k < 3; ++k) n[k] = length > 0 ? n[k] / length : 0;
    }
  }
  if (task.by_rays) cast_rays(task, accel, picture);

  const std::lock_guard lock(mutex_);
  if (discarded_) return;
  film_ = std::move(film), film_stamp_ = task.stamp, film_samples_ = task.samples;
  world_ = task.world, picture_ = std::move(picture), channels_ = task.channels;
  mapped_.clear();
  progress_ = 1;
  duration_ = std::chrono::duration<float>(std::chrono::steady_clock::now() - start).count();
}

// Depth and numbers of what the centres of the pixels show.
void Frame::cast_rays(const Task& task, const Accel& accel, Picture& picture) {
  const Eye& eye = task.eye;
  const size_t width = task.size[0], height = task.size[1], count = width * height;
  const Vec3d right = normalize(cross(eye.forward, eye.up)), up = cross(right, eye.forward);
  const double half_height = exact_tan(eye.fov_deg / 2 / kDegrees) * eye.distance;
  const double half_width = half_height * task.whole[0] / task.whole[1];
  std::vector<std::array<float, 3>> origins(count), directions(count);
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x) {
      // From -1 to 1, right and up.
      const double across = 2 * (double(task.shift[0] + x) + 0.5) / task.whole[0] - 1;
      const double upward =
          1 - 2 * (double(task.shift[1] + (height - 1 - y)) + 0.5) / task.whole[1];
      Vec3d origin = eye.from, direction = eye.forward;
      if (eye.projection == "omnidirectional") {
        const double azimuth = across * std::numbers::pi, elevation = upward * std::numbers::pi / 2;
        direction =
            (eye.forward * exact_cos(azimuth) + right * exact_sin(azimuth)) * exact_cos(elevation) +
            up * exact_sin(elevation);
      } else {
        const Vec3d offset = right * (across * half_width) + up * (upward * half_height);
        if (eye.projection == "perspective")
          direction = normalize(eye.forward + offset);
        else
          origin = origin + offset;
      }
      for (size_t k = 0; k < 3; ++k)
        origins[y * width + x][k] = float(origin[int(k)]),
                            directions[y * width + x][k] = float(direction[int(k)]);
    }
  picture.depth.resize(count);
  std::vector<uint8_t> kinds(count);
  std::vector<int64_t> indices(count), instances(count);
  accel.closest(Column<float, 3>{origins.data()->data(), count},
                Column<float, 3>{directions.data()->data(), count}, {},
                {.distance = picture.depth.data(),
                 .kind = kinds.data(),
                 .index = indices.data(),
                 .instance = instances.data()});
  for (auto* numbers : {&picture.object_id, &picture.primitive_id, &picture.instance_id})
    numbers->resize(count);
  for (size_t i = 0; i < count; ++i) {
    const auto [object, primitive, instance] =
        task.world->numbers_of(Kind(kinds[i]), indices[i], instances[i]);
    picture.object_id[i] = object, picture.primitive_id[i] = primitive,
    picture.instance_id[i] = instance;
  }
}

bool Frame::ready(bool wait) {
  std::unique_lock lock(mutex_);
  // The callback's own thread would wait for itself.
  const bool inside = thread_.get_id() == std::this_thread::get_id();
  const auto done = [&] { return inside ? rendered_ : done_; };
  if (wait) changed_.wait(lock, done);
  return done();
}

void Frame::wait_rendered() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return rendered_; });
}

void Frame::discard() {
  const std::lock_guard lock(mutex_);
  discarded_ = true;
  if (job_) job_->cancel();
}

void Frame::forget() {
  wait_rendered();
  const std::lock_guard lock(mutex_);
  world_ = nullptr, film_ = std::nullopt;
}

const void* Frame::map(std::string_view channel, uint32_t* width, uint32_t* height,
                       DataType* type) {
  ready(true);
  const std::lock_guard lock(mutex_);
  const std::string_view name =
      channel.starts_with(kChannelPrefix) ? channel.substr(kChannelPrefix.size()) : channel;
  const auto found = channels_.find(name);
  if (found == channels_.end()) {
    device.report(this, Severity::error, Status::invalid_argument,
                  fmt::format("'{}' cannot be mapped: {}", channel,
                              picture_.size[0] == 0 ? "nothing was rendered"
                                                    : "the frame has no such channel"));
    *width = *height = 0, *type = DataType::unknown;
    return nullptr;
  }
  *width = picture_.size[0], *height = picture_.size[1], *type = found->second;
  auto mapped = mapped_.find(name);
  if (mapped == mapped_.end()) {
    std::vector<std::byte> bytes;
    if (name == "color")
      bytes = converted(picture_.color, *type);
    else if (name == "albedo")
      bytes = converted(picture_.albedo, *type);
    else if (name == "normal")
      bytes = converted(picture_.normal, *type);
    else if (name == "depth")
      bytes = bytes_of(picture_.depth);
    else
      bytes = bytes_of(name == "primitiveId" ? picture_.primitive_id
                       : name == "objectId"  ? picture_.object_id
                                             : picture_.instance_id);
    mapped = mapped_.emplace(name, std::move(bytes)).first;
  }
  return mapped->second.data();
}

}  // namespace raio::device
