// Primitives that Raio adds to NFF and P3F: ellipsoids and discs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "io/nff/geometry.h"
#include "io/nff/parser.h"
#include "io/nff/writer.h"

namespace raio::core::nff {
namespace {

void read_ellipsoid(Parser& p) {
  Vec3d axes[3];
  double n[3];
  if (!p.numbers(n, kXyz)) return;
  const Vec3d center(n[0], n[1], n[2]);
  for (size_t i = 0; i < 3; ++i) {
    if (!p.numbers(n, kXyz, {"semi-axis", i + 1})) return;
    axes[i] = {n[0], n[1], n[2]};
  }
  const MaterialId id = p.material_here();
  const Ellipsoid ellipsoid{p.place(center), {Vec3f(axes[0]), Vec3f(axes[1]), Vec3f(axes[2])}};
  if (p.too_far(ellipsoid.center)) return;
  for (size_t i = 0; i < 3; ++i)
    if (!(length(axes[i]) > 0)) return p.reject(fmt::format("semi-axis {} is zero", i + 1));
  for (size_t i = 0; i < 3; ++i) {
    const size_t next = (i + 1) % 3;
    const double cosine = dot(normalize(axes[i]), normalize(axes[next]));
    if (std::abs(cosine) > kRightAngle)
      return p.reject(fmt::format(
          "semi-axes {} and {} are {:.4g} degrees apart, expected 90; make them perpendicular",
          std::min(i, next) + 1, std::max(i, next) + 1,
          exact_acos(std::clamp(cosine, -1.0, 1.0)) * (180 / std::numbers::pi)));
  }
  bool sound = true;
  check_shape(ellipsoid, [&](bool holds, std::string_view expected) {
    if (sound && !holds) p.reject(std::string(expected));
    sound = sound && holds;
  });
  if (!sound) return;
  p.add(ellipsoid, id);
}

void read_disc(Parser& p) {
  static constexpr std::string_view kNames[] = {"x",
                                                "y",
                                                "z",
                                                "the normal's x",
                                                "the normal's y",
                                                "the normal's z",
                                                "the radius",
                                                "the inner radius"};
  double n[8] = {};
  if (!p.numbers({n, 7}, kNames)) return;
  if (p.numbers_left_in_line() > 0 && !p.numbers({n + 7, 1}, Parser::Names(kNames).subspan(7)))
    return;
  const MaterialId id = p.material_here();
  const auto normal = unit_normal({n[3], n[4], n[5]});
  if (!normal)
    return p.reject("the normal of the disc is zero, expected the direction that it faces");
  const Disc disc{p.place({n[0], n[1], n[2]}), *normal, float(n[6]), float(n[7])};
  if (p.too_far(disc.center)) return;
  if (!(disc.radius > 0))
    return p.reject(fmt::format("the radius must be above 0, found {}", n[6]));
  if (!(disc.inner >= 0 && disc.inner < disc.radius))
    return p.reject(fmt::format(
        "the inner radius must be at least 0 and below the radius, {}, found {}", n[6], n[7]));
  p.add(disc, id);
}

constexpr std::array kAdditionRows = {
    Entity{.word = "ellipsoid",
           .noun = "the ellipsoid",
           .usage = "ellipsoid takes 12 numbers: x y z of the centre, then of each semi-axis",
           .read = read_ellipsoid},
    Entity{.word = "disc",
           .noun = "the disc",
           .usage =
               "disc takes 7 or 8 numbers on its line: x y z, the normal's x y z, radius, then "
               "the inner radius of a ring",
           .read = read_disc},
};

}  // namespace

constinit const Family kAdditions = kAdditionRows;

template <>
void write_shape(Writer& w, const Ellipsoid& e, size_t) {
  w.position("ellipsoid", e.center);
  for (const Vec3f& axis : e.axes) w.text().vector(axis);
  w.text().end_line();
}

template <>
void write_shape(Writer& w, const Disc& d, size_t) {
  w.position("disc", d.center).vector(d.normal).number(d.radius);
  if (d.inner > 0) w.text().number(d.inner);
  w.text().end_line();
}

}  // namespace raio::core::nff
