// NFF's round primitives: spheres, and cones with cylinders.
#include <array>

#include "io/nff/parser.h"
#include "io/nff/writer.h"

namespace raio::core::nff {
namespace {

void read_sphere(Parser& p) {
  static constexpr std::string_view kNames[] = {"x", "y", "z", "the radius"};
  double n[4];
  if (!p.numbers(n, kNames)) return;
  const MaterialId id = p.material_here();
  const Sphere sphere{p.place({n[0], n[1], n[2]}), float(n[3])};
  if (sphere.radius == 0) return p.reject("the radius is zero");
  if (p.too_far(sphere.center)) return;
  p.add(sphere, id);
}

void read_cone(Parser& p) {
  static constexpr std::string_view kNames[] = {
      "x of the base", "y of the base", "z of the base", "the base radius",
      "x of the apex", "y of the apex", "z of the apex", "the apex radius"};
  double n[8];
  if (!p.numbers(n, kNames)) return;
  const MaterialId id = p.material_here();
  const Cone cone{p.place({n[0], n[1], n[2]}), float(n[3]), p.place({n[4], n[5], n[6]}),
                  float(n[7])};
  if (cone.base_radius == 0 && cone.apex_radius == 0) return p.reject("both radii are zero");
  if ((cone.base_radius < 0 && cone.apex_radius > 0) ||
      (cone.base_radius > 0 && cone.apex_radius < 0))
    return p.reject(
        "one radius is negative and the other is not; for the inside make both negative");
  if (p.too_far(cone.base) || p.too_far(cone.apex)) return;
  if (cone.base == cone.apex)
    return p.reject(
        "base and apex are the same point; for a flat one write disc x y z nx ny nz radius");
  p.add(cone, id);
}

constexpr std::array kRoundRows = {
    Entity{.word = "s",
           .noun = "the sphere",
           .usage = "s takes 4 numbers: x y z radius",
           .read = read_sphere,
           .surplus = {2,
                       "with 6 it is a highlight's light of the Graphics Gems V dialect: write "
                       "\"l\""}},
    Entity{.word = "c",
           .noun = "the cone",
           .usage = "c takes 8 numbers: x y z radius of the base, then of the apex",
           .read = read_cone},
};

}  // namespace

constinit const Family kRounds = kRoundRows;

template <>
void write_shape(Writer& w, const Sphere& s, size_t) {
  w.position("s", s.center).number(s.radius).end_line();
}

template <>
void write_shape(Writer& w, const Cone& c, size_t) {
  w.position("c", c.base).number(c.base_radius);
  w.position({}, c.apex).number(c.apex_radius).end_line();
}

}  // namespace raio::core::nff
