// The surroundings of the objects: background, lights, materials, and P3F's requests.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/nff/parser.h"
#include "io/nff/writer.h"

namespace raio::core::nff {
namespace {

constexpr std::string_view kRgb[] = {"red", "green", "blue"};
constexpr std::string_view kXyz[] = {"x", "y", "z"};

bool negative(std::span<const double> numbers) {
  return std::ranges::any_of(numbers, [](double n) { return n < 0; });
}

void read_background(Parser& p) {
  double n[3];
  if (!p.numbers(n, kRgb)) return;
  if (negative(n)) return p.reject("a colour must not be negative");
  if (p.seen.background) p.warn("a second background; the last one is used");
  p.seen.background = true;
  p.scene().background = Rgb(float(n[0]), float(n[1]), float(n[2]));
}

void read_light(Parser& p) {
  static constexpr std::string_view kExtent[] = {"the width", "the depth", "the number of points"};
  double n[9];
  if (!p.numbers({n, 3}, kXyz)) return;
  const size_t more = p.numbers_left_in_line();
  if (more != 0 && more != 3 && more != 6) {
    const std::string_view advice =
        more == 4
            ? "; an intensity of the ENFF dialect: write x y z r g b with r g b multiplied by it"
        : more == 9 ? "; an area light of a student dialect: write x y z width depth n r g b"
                    : "";
    p.reject(fmt::format(
        "a light takes 3, 6 or 9 numbers on its line, x y z, x y z r g b or x y z width "
        "depth n r g b, found {}{}",
        3 + more, advice));
    return p.skip_to_entity(false);
  }
  if (more == 6 && !p.numbers({n + 3, 3}, kExtent)) return;
  const std::span<double> color(n + more, 3);
  if (more > 0 && !p.numbers(color, kRgb)) return;
  if (more > 0 && negative(color)) return p.reject("a colour must not be negative");
  if (more == 6 && negative({n + 3, 2}))
    return p.reject(fmt::format(
        "the width and depth of a light must not be negative, found {} and {}", n[3], n[4]));
  if (more == 6 && !(n[5] >= 1 && n[5] <= kMaxLightPoints && n[5] == std::floor(n[5])))
    return p.reject(
        fmt::format("the number of points of a light must be whole, from 1 to {}, found {}",
                    kMaxLightPoints, n[5]));
  if (p.seen.object)
    p.warn_once(p.seen.late_light, "a light follows objects, but NFF requires all lights first");
  Light light;
  light.position = p.place({n[0], n[1], n[2]});
  if (p.too_far(light.position)) return;
  if (more > 0) light.color = Rgb(float(color[0]), float(color[1]), float(color[2]));
  if (more == 6) light.extent = LightExtent{float(n[3]), float(n[4]), int(n[5])};
  p.scene().lights.push_back(light);
}

// P3F adds the colour of the highlight and, optionally, the roughness of the surface.
void read_material(Parser& p) {
  static constexpr std::string_view kNff[] = {"red", "green", "blue", "Kd",
                                              "Ks",  "Shine", "T",    "ior"};
  static constexpr std::string_view kP3f[] = {
      "red",           "green", "blue",  "Kd", "specular red", "specular green",
      "specular blue", "Ks",    "Shine", "T",  "ior",          "roughness"};
  double n[12] = {};
  // Only for messages: missing or malformed numbers may belong to either dialect.
  const bool expects_p3f = p.scene().dialect == Dialect::p3f || p.numbers_left_in_line() > 8;
  if (!p.numbers({n, 8}, expects_p3f ? Parser::Names(kP3f) : kNff)) return;
  const size_t more = p.numbers_left_in_line();
  const bool p3f = more == 3 || more == 4;
  if (more > 0 && !p3f) {
    p.reject(
        fmt::format("f takes 8, 11 or 12 numbers, r g b Kd Ks Shine T ior or r g b Kd sr sg sb Ks "
                    "Shine T ior [roughness], found {}{}",
                    8 + more,
                    more == 1 ? "; Ka of the ENFF dialect or glossiness of a student dialect: "
                                "take it out"
                              : ""));
    return p.skip_to_entity(false);
  }
  const Parser::Names names = p3f ? Parser::Names(kP3f) : kNff;
  if (p3f && !p.numbers({n + 8, more}, names.subspan(8))) return;
  const size_t count = 8 + more, specular = p3f ? 3 : 0;  // numbers between Kd and Ks
  Parser::Surface surface;
  Material& m = surface.material;
  m.color = {float(n[0]), float(n[1]), float(n[2])};
  m.kd = float(n[3]), m.ks = float(n[4 + specular]), m.shine = float(n[5 + specular]);
  m.transmission = float(n[6 + specular]), m.ior = float(n[7 + specular]);
  if (p3f) {
    p.scene().dialect = Dialect::p3f;
    surface.specular = {float(n[4]), float(n[5]), float(n[6])};
    surface.roughness = float(n[11]);
  }
  p.set_material(surface);
  if (negative({n, 3}) || (p3f && negative({n + 4, 3})))
    return p.reject("a colour must not be negative");
  for (size_t i = 3; i < count; ++i)
    if (n[i] < 0) return p.reject(fmt::format("{} must not be negative, found {}", names[i], n[i]));
  if (m.transmission > 0 && m.ior == 0)
    p.reject("T is above 0 and ior is 0, expected ior above 0; 1 does not refract");
}

void read_sky(Parser& p) {
  const std::string_view folder = p.rest_of_line();
  p.scene().dialect = Dialect::p3f;
  if (folder.empty())
    return p.reject("env takes the folder of a sky's six pictures on its line, found none");
  if (std::ranges::any_of(folder, [](char c) { return uint8_t(c) < 32; }))
    return p.reject(
        fmt::format("the folder of env is {}, expected a name without tabs or control characters",
                    quoted(folder)));
  if (p.seen.sky) p.warn("a second sky; the last one is used");
  p.seen.sky = true;
  p.scene().requests.sky_folder = folder;
}

void read_samples(Parser& p) {
  if (const auto samples = p.whole_number("the samples per pixel", 0, 1'000'000))
    p.scene().requests.samples_per_pixel = int(*samples);
}

void read_accel(Parser& p) {
  constexpr AccelHint kHints[] = {AccelHint::none, AccelHint::grid, AccelHint::bvh};
  if (const auto structure = p.whole_number("the structure", 0, 2))
    p.scene().requests.structure = kHints[size_t(*structure)];
}

constexpr std::string_view kMtvColors =
    "colour names belong to the MTV dialect; write r g b as numbers";

constexpr std::array kSurroundingRows = {
    Entity{.word = "b",
           .noun = "the background",
           .usage = "b takes 3 numbers: r g b",
           .read = read_background,
           .leaves = Entity::Leaves::more,
           .if_word = kMtvColors},
    Entity{.word = "bclr",
           .noun = "the background",
           .usage = "b takes 3 numbers: r g b",
           .read = read_background,
           .leaves = Entity::Leaves::more,
           .if_word = kMtvColors},
    Entity{.word = "l",
           .noun = "the light",
           .usage =
               "l takes 3, 6 or 9 numbers on its line: x y z, x y z r g b or x y z width depth n "
               "r g b",
           .read = read_light,
           .leaves = Entity::Leaves::more},
    Entity{.word = "f",
           .noun = "the material",
           .usage =
               "f takes 8 numbers, r g b Kd Ks Shine T ior, or, on one line, 11 or 12, r g b Kd "
               "sr sg sb Ks Shine T ior [roughness]",
           .read = read_material,
           .if_word = kMtvColors},
};

constexpr std::array kHintRows = {
    Entity{.word = "env",
           .noun = "the sky",
           .usage = "env takes the folder of a sky's six pictures",
           .read = read_sky,
           .leaves = Entity::Leaves::more},
    Entity{.word = "spp",
           .noun = "spp",
           .usage = "spp takes 1 number",
           .read = read_samples,
           .leaves = Entity::Leaves::more},
    Entity{.word = "accel",
           .noun = "accel",
           .usage = "accel takes 1 number: 0 for none, 1 for a grid, 2 for a tree",
           .read = read_accel,
           .leaves = Entity::Leaves::more},
};

}  // namespace

constinit const Family kSurroundings = kSurroundingRows;
constinit const Family kHints = kHintRows;

void write_surroundings(Writer& w) {
  const Scene& scene = w.scene();
  const bool p3f = scene.dialect == Dialect::p3f;
  w.text().word(p3f ? "bclr" : "b").vector(scene.background).end_line();
  if (!scene.requests.sky_folder.empty() && p3f)
    w.text().word("env").word(scene.requests.sky_folder).end_line();
  if (scene.requests.structure != AccelHint::any)
    w.text().word("accel").number(uint32_t(scene.requests.structure) - 1).end_line();
  if (scene.requests.samples_per_pixel > 0)
    w.text().word("spp").number(scene.requests.samples_per_pixel).end_line();
  const Rgb usual(float(1 / std::sqrt(double(std::max<size_t>(1, scene.lights.size())))));
  for (const Light& light : scene.lights) {
    w.position("l", light.position);
    if (light.extent)
      w.text().number(light.extent->width).number(light.extent->depth).number(light.extent->points);
    if (light.extent || light.color) w.text().vector(light.color.value_or(usual));
    w.text().end_line();
  }
}

void write_material(Writer& w, MaterialId id) {
  const Scene& scene = w.scene();
  const Material& m = scene.materials[id];
  const bool p3f = scene.dialect == Dialect::p3f;
  w.text().word("f").vector(m.color).number(m.kd);
  if (p3f) w.text().vector(scene.specular_of(id));
  w.text().number(m.ks).number(m.shine).number(m.transmission).number(m.ior);
  if (const float roughness = scene.roughness_of(id); p3f && roughness > 0)
    w.text().number(roughness);
  w.text().end_line();
}

}  // namespace raio::core::nff
