#include "io/environment.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/exact_math.h"
#include "base/parallel.h"
#include "base/srgb.h"
#include "io/clear_sky.h"
#include "io/file.h"
#include "io/image/codecs.h"

namespace raio::core {
namespace {

constexpr uint64_t kMaxPictureBytes = uint64_t(1) << 31;

/// The axis closest to the vector.
Vec3d axis_near(Vec3d v) {
  int longest = 1;
  for (const int axis : {0, 2})
    if (std::abs(v[axis]) > std::abs(v[longest])) longest = axis;
  Vec3d axis;
  axis[longest] = v[longest] < 0 ? -1 : 1;
  return axis;
}

/// As linear_from_srgb(), fast for display values of 8 bits.
float light_of(float encoded) {
  const uint8_t byte = to_byte(encoded);
  return float(byte) / 255 == encoded ? linear_from_srgb_bytes()[byte] : linear_from_srgb(encoded);
}

/// Why the picture cannot light a scene, or nothing.
std::string environment_problem(const Image& image) {
  if (image.width > kLargestEnvironment || image.height > kLargestEnvironment / 2)
    return fmt::format("it has {} x {} pixels; expected at most {} x {}", image.width, image.height,
                       kLargestEnvironment, kLargestEnvironment / 2);
  if (std::abs(image.width - 2 * image.height) > 1)
    return fmt::format(
        "it has {} x {} pixels; expected a picture of all directions, twice as wide as high",
        image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgb& c = image.at(x, y);
      if (!is_finite(c) || c.x < 0 || c.y < 0 || c.z < 0)
        return fmt::format(
            "the pixel in column {}, row {} (from 0, 0 at the upper left) is {},{},{}; expected "
            "finite numbers of at least 0",
            x, y, c.x, c.y, c.z);
    }
  return {};
}

// Turned counterclockwise by `rotation` degrees.
void surround(Scene& scene, const Image& image, Vec3f up, double rotation) {
  const Vec3d axis = axis_near(Vec3d(up));
  const Vec3d middle = axis.z != 0 ? Vec3d(0, 1, 0) : Vec3d(0, 0, -1);
  const double turn = rotation * std::numbers::pi / 180;
  const Vec3d direction = middle * exact_cos(turn) + cross(axis, middle) * exact_sin(turn);
  scene.environment = {{.width = uint32_t(image.width),
                        .height = uint32_t(image.height),
                        .up = Vec3f(axis),
                        .direction = Vec3f(direction)}};
  scene.environment_texels =
      Array<Rgb>(image.pixels.data(), image.pixels.data() + image.pixels.size());
}

}  // namespace

std::expected<void, Error> set_environment(Scene& scene, const std::filesystem::path& path,
                                           Vec3f up, double rotation) {
  const auto refused = [&](std::string why) {
    return std::unexpected(
        Error{ErrorKind::bad_input, path.string(), "the environment: " + std::move(why)});
  };
  const auto bytes = read_file(path, kMaxPictureBytes);
  if (!bytes) return refused(bytes.error().message);
  auto image = decode_image(*bytes);
  if (!image) return refused(image.error());
  if (std::string why = environment_problem(*image); !why.empty()) return refused(std::move(why));
  if (is_display_format(*bytes))
    parallel_for(size_t(image->height), [&](size_t y) {
      for (int x = 0; x < image->width; ++x) {
        Rgb& c = image->at(x, int(y));
        c = {light_of(c.x), light_of(c.y), light_of(c.z)};
      }
    });
  surround(scene, *image, up, rotation);
  return {};
}

void set_clear_sky(Scene& scene, double turbidity, double elevation, double azimuth, Vec3f up,
                   double rotation) {
  surround(scene, clear_sky(turbidity, elevation), up, rotation - azimuth);
}

}  // namespace raio::core
