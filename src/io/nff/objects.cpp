#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "io/nff/geometry.h"
#include "io/nff/parser.h"
#include "shape/polygon.h"
#include "shape/triangle.h"

namespace raio::nff {
namespace {

constexpr std::string_view kRgb[] = {"red", "green", "blue"};
constexpr std::string_view kXyz[] = {"x", "y", "z"};
constexpr std::string_view kXyzNormal[] = {
    "x", "y", "z", "the normal's x", "the normal's y", "the normal's z"};

bool negative(std::span<const double> numbers) {
  return std::ranges::any_of(numbers, [](double n) { return n < 0; });
}

/// Have the corners an area, but for the last digits of decimal fractions, which are not exact: are
/// they neither all in line nor in loops that cancel? By Newell's sum, twice the area along the
/// normal. What is kept is asked as floats, too, so that it is kept again when written and read.
template <class T>
bool has_area(std::span<const Vec3<T>> corners) {
  Vec3d sum;
  double parts = 0;
  bool all_in_line = true;
  const Vec3d first(corners[0]);
  for (size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3d u = Vec3d(corners[i]) - first, v = Vec3d(corners[i + 1]) - first;
    const Vec3d part = cross(u, v);
    sum += part;
    parts += length(part);
    all_in_line &= in_line(u, v);
  }
  return !all_in_line && length(sum) > 1e-12 * parts;
}

}  // namespace

void Parser::background() {
  double n[3];
  if (!numbers(n, kRgb)) return;
  if (negative(n)) return reject("a colour must not be negative");
  if (background_seen_) warn("the background is given again; the last one counts");
  background_seen_ = true;
  scene_.background = Rgb(float(n[0]), float(n[1]), float(n[2]));
}

void Parser::light() {
  double n[6];
  if (!numbers({n, 3}, kXyz)) return;
  const size_t more = numbers_left_in_line();
  if (more != 0 && more != 3) {
    const std::string_view advice =
        more == 4
            ? ": an intensity of the ENFF dialect, write x y z r g b with r g b multiplied by it"
        : more == 9
            ? ": an area light of a student dialect, write x y z r g b and use `soft-shadows` "
              "with `light-size`"
            : "";
    reject(fmt::format("a light takes 3 or 6 numbers on its line, x y z and r g b, found {}{}",
                       3 + more, advice));
    return skip_to_entity(false);
  }
  if (more == 3 && !numbers({n + 3, 3}, kRgb)) return;
  if (more == 3 && negative({n + 3, 3})) return reject("a colour must not be negative");
  if (object_seen_)
    warn_once(warned_late_light_, "a light after objects; NFF wants all lights before");
  Light light;
  light.position = place({n[0], n[1], n[2]});
  if (too_far(light.position)) return;
  if (more == 3) light.color = Rgb(float(n[3]), float(n[4]), float(n[5]));
  scene_.lights.push_back(light);
}

void Parser::material() {
  static constexpr std::string_view kNames[] = {"red", "green", "blue", "Kd",
                                                "Ks",  "Shine", "T",    "ior"};
  double n[8];
  if (!numbers(n, kNames)) return;
  if (const size_t more = numbers_left_in_line(); more > 0) {
    const std::string_view advice =
        more == 1 ? ": Ka of the ENFF dialect or glossiness of a student one, take it out"
        : more == 3 || more == 4
            ? ": the P3F dialect with a colour of its own for highlights, write its mean as Ks"
            : "";
    reject(fmt::format("f takes 8 numbers, r g b Kd Ks Shine T ior, found {}{}", 8 + more, advice));
    return skip_to_entity(false);
  }
  Material m;
  m.color = {float(n[0]), float(n[1]), float(n[2])};
  m.kd = float(n[3]), m.ks = float(n[4]), m.shine = float(n[5]);
  m.transmission = float(n[6]), m.ior = float(n[7]);
  material_ = material_id(m);
  if (negative({n, 3})) return reject("a colour must not be negative");
  for (size_t i = 3; i < 8; ++i)
    if (n[i] < 0) return reject(fmt::format("{} must not be negative, found {}", kNames[i], n[i]));
  if (m.transmission > 0 && m.ior == 0)
    reject("T is above 0, so ior must be too: 1 for a surface that does not bend light");
}

void Parser::sphere() {
  static constexpr std::string_view kNames[] = {"x", "y", "z", "the radius"};
  double n[4];
  if (!numbers(n, kNames)) return;
  const MaterialId id = material_here();
  const Sphere sphere{place({n[0], n[1], n[2]}), float(n[3])};
  if (sphere.radius == 0) return reject("the radius is zero");
  if (too_far(sphere.center)) return;
  scene_.spheres.push_back(sphere);
  scene_.sphere_materials.push_back(id);
}

void Parser::cone() {
  static constexpr std::string_view kNames[] = {
      "x of the base", "y of the base", "z of the base", "the base radius",
      "x of the apex", "y of the apex", "z of the apex", "the apex radius"};
  double n[8];
  if (!numbers(n, kNames)) return;
  const MaterialId id = material_here();
  const Cone cone{place({n[0], n[1], n[2]}), float(n[3]), place({n[4], n[5], n[6]}), float(n[7])};
  if (cone.base_radius == 0 && cone.apex_radius == 0) return reject("both radii are zero");
  if ((cone.base_radius < 0 && cone.apex_radius > 0) ||
      (cone.base_radius > 0 && cone.apex_radius < 0))
    return reject("one radius is negative and the other is not; for the inside make both negative");
  if (too_far(cone.base) || too_far(cone.apex)) return;
  if (cone.base == cone.apex)
    return reject(
        "base and apex are the same point; for a flat one write disc x y z nx ny nz radius");
  scene_.cones.push_back(cone);
  scene_.cone_materials.push_back(id);
}

void Parser::plane() {
  double n[9];
  for (size_t i = 0; i < 3; ++i)
    if (!numbers({n + 3 * i, 3}, kXyz, {"point", i + 1})) return;
  const MaterialId id = material_here();
  const auto normal = plane_normal({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]});
  if (!normal) return reject("the three points are in line, they make no plane");
  const Plane plane{place({n[0], n[1], n[2]}), *normal};
  if (too_far(plane.point)) return;
  scene_.planes.push_back(plane);
  scene_.plane_materials.push_back(id);
}

void Parser::ellipsoid() {
  Vec3d axes[3];
  double n[3];
  if (!numbers(n, kXyz)) return;
  const Vec3d center(n[0], n[1], n[2]);
  for (size_t i = 0; i < 3; ++i) {
    if (!numbers(n, kXyz, {"semi-axis", i + 1})) return;
    axes[i] = {n[0], n[1], n[2]};
  }
  const MaterialId id = material_here();
  const Ellipsoid ellipsoid{place(center), {Vec3f(axes[0]), Vec3f(axes[1]), Vec3f(axes[2])}};
  if (too_far(ellipsoid.center)) return;
  for (size_t i = 0; i < 3; ++i)
    if (!(length(axes[i]) > 0)) return reject(fmt::format("semi-axis {} is zero", i + 1));
  for (size_t i = 0; i < 3; ++i) {
    const size_t next = (i + 1) % 3;
    const double cosine = dot(normalize(axes[i]), normalize(axes[next]));
    if (std::abs(cosine) > kRightAngle)
      return reject(fmt::format(
          "semi-axes {} and {} are {:.4g} degrees apart, expected 90; make them perpendicular",
          std::min(i, next) + 1, std::max(i, next) + 1,
          std::acos(std::clamp(cosine, -1.0, 1.0)) * (180 / std::numbers::pi)));
  }
  bool sound = true;
  check_shape(ellipsoid, [&](bool holds, std::string_view expected) {
    if (sound && !holds) reject(std::string(expected));
    sound = sound && holds;
  });
  if (!sound) return;
  scene_.ellipsoids.push_back(ellipsoid);
  scene_.ellipsoid_materials.push_back(id);
}

void Parser::disc() {
  static constexpr std::string_view kNames[] = {"x",
                                                "y",
                                                "z",
                                                "the normal's x",
                                                "the normal's y",
                                                "the normal's z",
                                                "the radius",
                                                "the inner radius"};
  double n[8] = {};
  if (!numbers({n, 7}, kNames)) return;
  if (numbers_left_in_line() > 0 && !numbers({n + 7, 1}, Names(kNames).subspan(7))) return;
  const MaterialId id = material_here();
  const auto normal = unit_normal({n[3], n[4], n[5]});
  if (!normal) return reject("the normal of the disc is zero, expected the direction it faces");
  const Disc disc{place({n[0], n[1], n[2]}), *normal, float(n[6]), float(n[7])};
  if (too_far(disc.center)) return;
  if (!(disc.radius > 0)) return reject(fmt::format("the radius must be above 0, found {}", n[6]));
  if (!(disc.inner >= 0 && disc.inner < disc.radius))
    return reject(fmt::format(
        "the inner radius must be at least 0 and below the radius, {}, found {}", n[6], n[7]));
  scene_.discs.push_back(disc);
  scene_.disc_materials.push_back(id);
}

void Parser::polygon(bool smooth) {
  const auto n = count("the number of corners", 3, smooth ? 12 : 6);
  if (!n) return;
  material_here();
  if (!corners(*n, smooth)) return;
  if (!has_area<double>(corners_) || !has_area<float>(placed_))
    return warn("left out: a polygon without area (its corners repeat, are in line or cross)");
  smooth ? add_smooth() : add_flat(placed_);
}

/// Reads n corners. False if an error was reported.
bool Parser::corners(size_t n, bool smooth) {
  corners_.clear(), placed_.clear(), normals_.clear();
  const char* const entity = begin_;
  bool sound = true;
  for (size_t i = 1; i <= n; ++i) {
    double x[6];
    p_ = skip_blanks(p_);
    const char* const corner = p_;
    if (!numbers({x, size_t(smooth ? 6 : 3)}, smooth ? Names(kXyzNormal) : Names(kXyz),
                 {"corner", i}))
      return false;
    corners_.push_back({x[0], x[1], x[2]});
    placed_.push_back(place(corners_.back()));
    begin_ = corner;  // what follows is about the corner
    if (too_far(placed_.back())) sound = false;
    if (smooth) {
      const auto normal = unit_normal({x[3], x[4], x[5]});
      if (!normal) reject(fmt::format("the normal of corner {} is zero", i)), sound = false;
      normals_.push_back(normal.value_or(Vec3f()));
    }
    begin_ = entity;
  }
  return sound;
}

void Parser::add_flat(std::span<const Vec3f> points) {
  const auto first = uint32_t(scene_.positions.size());
  scene_.positions.insert(scene_.positions.end(), points.begin(), points.end());
  if (points.size() == 3)
    return add_triangle({first, first + 1, first + 2}, {kNoNormal, kNoNormal, kNoNormal});
  scene_.polygon_materials.push_back(material_here());
  scene_.polygons.push_back({first, uint32_t(points.size())});
}

void Parser::add_smooth() {
  const auto first = uint32_t(scene_.positions.size());
  const auto first_normal = uint32_t(scene_.normals.size());
  scene_.positions.insert(scene_.positions.end(), placed_.begin(), placed_.end());
  scene_.normals.insert(scene_.normals.end(), normals_.begin(), normals_.end());
  const auto add = [&](const std::array<uint32_t, 3>& t) {
    add_triangle({first + t[0], first + t[1], first + t[2]},
                 {first_normal + t[0], first_normal + t[1], first_normal + t[2]});
  };
  if (placed_.size() == 3) return add({0, 1, 2});
  for (const std::array<uint32_t, 3>& t : triangulate(placed_))
    // Corners in line leave pieces without area, which cover nothing.
    if (has_area<float>(std::array{placed_[t[0]], placed_[t[1]], placed_[t[2]]})) add(t);
}

/// Normals are kept from the first smooth triangle on.
void Parser::add_triangle(TriangleIndices corners, TriangleIndices normals) {
  constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
  if (normals != kFlat) scene_.triangle_normals.resize(scene_.triangles.size(), kFlat);
  if (normals != kFlat || !scene_.triangle_normals.empty())
    scene_.triangle_normals.push_back(normals);
  scene_.triangle_materials.push_back(material_here());
  scene_.triangles.push_back(corners);
}

void Parser::box() {
  static constexpr std::string_view kNames[] = {"lowest x",  "lowest y",  "lowest z",
                                                "highest x", "highest y", "highest z"};
  double n[6];
  if (!numbers(n, kNames)) return;
  material_here();
  const Vec3f lo = place({n[0], n[1], n[2]}), hi = place({n[3], n[4], n[5]});
  if (too_far(lo) || too_far(hi)) return;
  for (int a = 0; a < 3; ++a)
    if (!(lo[a] < hi[a]))
      return reject(
          fmt::format("{} {} is not below {} {}", kNames[a], n[a], kNames[a + 3], n[a + 3]));
  // Per axis the low side, from which the other two axes in turn run clockwise, and the high side.
  for (int a = 0; a < 3; ++a) {
    const int u = (a + 1) % 3, v = (a + 2) % 3;
    for (const bool high : {false, true}) {
      std::array<Vec3f, 4> quad;
      for (int i = 0; i < 4; ++i) {
        const bool across = i == 1 || i == 2, along = i >= 2;
        quad[i][a] = high ? hi[a] : lo[a];
        quad[i][high ? u : v] = across ? hi[high ? u : v] : lo[high ? u : v];
        quad[i][high ? v : u] = along ? hi[high ? v : u] : lo[high ? v : u];
      }
      add_flat(quad);
    }
  }
}

void Parser::mesh() {
  const auto vertices = count("the number of vertices", 3, 6);
  if (!vertices) return;
  const auto faces = count("the number of faces", 1, 6);
  if (!faces) return;
  const size_t first = scene_.positions.size();
  if (*vertices > first) scene_.positions.reserve(first + *vertices);
  for (size_t i = 1; i <= *vertices; ++i) {
    double x[3];
    if (!numbers(x, kXyz, {"vertex", i})) return;
    scene_.positions.push_back(place({x[0], x[1], x[2]}));
    too_far(scene_.positions.back());
  }
  material_here();
  mesh_faces(first, *vertices, *faces);
}

void Parser::mesh_faces(size_t first, size_t vertices, size_t faces) {
  static constexpr std::string_view kNames[] = {"the first index", "the second index",
                                                "the third index"};
  const char* const entity = begin_;
  for (size_t i = 1; i <= faces; ++i) {
    double n[3];
    p_ = skip_blanks(p_);
    const char* const face_begin = p_;
    begin_ = entity;
    if (!numbers(n, kNames, {"face", i})) return;
    begin_ = face_begin;  // what follows is about the face
    TriangleIndices face;
    bool sound = true;
    for (int k = 0; k < 3; ++k) {
      const double index = n[k] < 0 ? double(vertices) + n[k] : n[k] - 1;
      if (n[k] != 0 && index == std::floor(index) && index >= 0 && index < double(vertices)) {
        face[k] = uint32_t(first + size_t(index));
        continue;
      }
      reject(fmt::format("{} of face {} is {}, expected 1 to {} or -1 to -{}", kNames[k], i, n[k],
                         vertices, vertices));
      sound = false;
      break;
    }
    if (!sound) continue;
    const auto& at = scene_.positions;
    if (!has_area<float>(std::array{at[face[0]], at[face[1]], at[face[2]]}))
      warn(fmt::format("left out: face {} has no area", i));
    else
      add_triangle(face, {kNoNormal, kNoNormal, kNoNormal});
  }
}

void Parser::accel() {
  if (whole_number("the structure", 0, 1000))
    warn("accel is not used: choose the structure by `accel`");
}

MaterialId Parser::material_here() {
  object_seen_ = true;
  if (!material_) {
    warn_once(warned_no_material_, "an object before any f: it gets a grey material");
    material_ = material_id(Material());
  }
  return *material_;
}

MaterialId Parser::material_id(const Material& material) {
  const auto [entry, added] =
      material_ids_.try_emplace(material, MaterialId(scene_.materials.size()));
  if (added) scene_.materials.push_back(material);
  return entry->second;
}

size_t Parser::MaterialHash::operator()(const Material& m) const {
  uint64_t hash = 0;
  for (const float x :
       {m.color.x, m.color.y, m.color.z, m.kd, m.ks, m.shine, m.transmission, m.ior})
    // Adding zero makes both zeros the same, as they compare equal.
    hash = (std::rotl(hash, 23) ^ std::bit_cast<uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
  return size_t(hash ^ hash >> 32);
}

bool Parser::too_far(Vec3f p) {
  if (is_finite(p)) return false;
  reject("too far from the camera for a float");
  return true;
}

}  // namespace raio::nff
