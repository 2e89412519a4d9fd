// What is around the objects: background, lights, materials, and P3F's requests.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/nff/parser.h"
#include "io/nff/writer.h"

namespace raio::nff {
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
  if (p.seen.background) p.warn("the background is given again; the last one counts");
  p.seen.background = true;
  p.scene().background = Rgb(float(n[0]), float(n[1]), float(n[2]));
}

void read_light(Parser& p) {
  double n[6];
  if (!p.numbers({n, 3}, kXyz)) return;
  const size_t more = p.numbers_left_in_line();
  if (more != 0 && more != 3) {
    const std::string_view advice =
        more == 4
            ? ": an intensity of the ENFF dialect, write x y z r g b with r g b multiplied by it"
        : more == 9
            ? ": an area light of a student dialect, write x y z r g b and use `soft-shadows` "
              "with `light-size`"
            : "";
    p.reject(fmt::format("a light takes 3 or 6 numbers on its line, x y z and r g b, found {}{}",
                         3 + more, advice));
    return p.skip_to_entity(false);
  }
  if (more == 3 && !p.numbers({n + 3, 3}, kRgb)) return;
  if (more == 3 && negative({n + 3, 3})) return p.reject("a colour must not be negative");
  if (p.seen.object)
    p.warn_once(p.seen.late_light, "a light after objects; NFF wants all lights before");
  Light light;
  light.position = p.place({n[0], n[1], n[2]});
  if (p.too_far(light.position)) return;
  if (more == 3) light.color = Rgb(float(n[3]), float(n[4]), float(n[5]));
  p.scene().lights.push_back(light);
}

void read_material(Parser& p) {
  static constexpr std::string_view kNames[] = {"red", "green", "blue", "Kd",
                                                "Ks",  "Shine", "T",    "ior"};
  double n[8];
  if (!p.numbers(n, kNames)) return;
  if (const size_t more = p.numbers_left_in_line(); more > 0) {
    const std::string_view advice =
        more == 1 ? ": Ka of the ENFF dialect or glossiness of a student one, take it out"
        : more == 3 || more == 4
            ? ": the P3F dialect with a colour of its own for highlights, write its mean as Ks"
            : "";
    p.reject(
        fmt::format("f takes 8 numbers, r g b Kd Ks Shine T ior, found {}{}", 8 + more, advice));
    return p.skip_to_entity(false);
  }
  Material m;
  m.color = {float(n[0]), float(n[1]), float(n[2])};
  m.kd = float(n[3]), m.ks = float(n[4]), m.shine = float(n[5]);
  m.transmission = float(n[6]), m.ior = float(n[7]);
  p.set_material(m);
  if (negative({n, 3})) return p.reject("a colour must not be negative");
  for (size_t i = 3; i < 8; ++i)
    if (n[i] < 0)
      return p.reject(fmt::format("{} must not be negative, found {}", kNames[i], n[i]));
  if (m.transmission > 0 && m.ior == 0)
    p.reject("T is above 0, so ior must be too: 1 for a surface that does not bend light");
}

void read_samples(Parser& p) {
  if (const auto samples = p.whole_number("the samples per pixel", 0, 1'000'000))
    p.scene().samples_per_pixel = int(*samples);
}

void read_accel(Parser& p) {
  if (p.whole_number("the structure", 0, 1000))
    p.warn("accel is not used: choose the structure by `accel`");
}

constexpr std::string_view kMtvColors =
    "names of colours are of the MTV dialect, write r g b as numbers";

constexpr std::array kRows = {
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
           .usage = "l takes 3 or 6 numbers on its line: x y z, then r g b",
           .read = read_light,
           .leaves = Entity::Leaves::more},
    Entity{.word = "f",
           .noun = "the material",
           .usage = "f takes 8 numbers: r g b Kd Ks Shine T ior",
           .read = read_material,
           .if_word = kMtvColors},
};

constexpr std::array kWishRows = {
    Entity{.word = "spp",
           .noun = "spp",
           .usage = "spp takes 1 number",
           .read = read_samples,
           .leaves = Entity::Leaves::more},
    Entity{.word = "accel",
           .noun = "accel",
           .usage = "accel takes 1 number",
           .read = read_accel,
           .leaves = Entity::Leaves::more},
};

}  // namespace

constinit const Family kSurroundings = kRows;
constinit const Family kWishes = kWishRows;

void write_surroundings(Writer& w) {
  const Scene& scene = w.scene();
  w.text().word("b").vector(scene.background).end_line();
  if (scene.samples_per_pixel > 0) w.text().word("spp").number(scene.samples_per_pixel).end_line();
  for (const Light& light : scene.lights) {
    w.position("l", light.position);
    if (light.color) w.text().vector(*light.color);
    w.text().end_line();
  }
}

void write_material(Writer& w, const Material& m) {
  w.text().word("f").vector(m.color).number(m.kd).number(m.ks).number(m.shine);
  w.text().number(m.transmission).number(m.ior).end_line();
}

}  // namespace raio::nff
