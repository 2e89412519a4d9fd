// Flat primitives: NFF's polygons, planes, and P3F's boxes and meshes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/nff/geometry.h"
#include "io/nff/parser.h"
#include "io/nff/writer.h"
#include "shape/polygon.h"
#include "shape/triangle.h"

namespace raio::core::nff {
namespace {

constexpr std::string_view kXyzNormal[] = {
    "x", "y", "z", "the normal's x", "the normal's y", "the normal's z"};

/// Whether the polygon has an area: its vertices are neither collinear nor in loops that cancel.
/// Uses Newell's sum, which is twice the area along the normal. The tolerance ignores the last
/// digits, since decimal fractions are not exact. The test is repeated in float, so that a polygon
/// that is kept is also kept after it is written and read.
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

constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};

/// Stores normals from the first smooth triangle on.
void add_triangle(Parser& p, const TriangleIndices& corners, const TriangleIndices& normals) {
  Scene& scene = p.scene();
  if (normals != kFlat) scene.triangle_normals.resize(scene.triangles.size(), kFlat);
  if (normals != kFlat || !scene.triangle_normals.empty())
    scene.triangle_normals.push_back(normals);
  p.add(corners, p.material_here());
}

void add_flat(Parser& p, std::span<const Vec3f> points) {
  Array<Vec3f>& positions = p.scene().positions;
  const auto first = uint32_t(positions.size());
  positions.insert(positions.end(), points.begin(), points.end());
  if (points.size() == 3) return add_triangle(p, {first, first + 1, first + 2}, kFlat);
  p.add(Polygon{first, uint32_t(points.size())}, p.material_here());
}

void add_smooth(Parser& p) {
  Array<Vec3f>&positions = p.scene().positions, &normals = p.scene().normals;
  const std::vector<Vec3f>& placed = p.corners.placed;
  const auto first = uint32_t(positions.size()), first_normal = uint32_t(normals.size());
  positions.insert(positions.end(), placed.begin(), placed.end());
  normals.insert(normals.end(), p.corners.normals.begin(), p.corners.normals.end());
  const auto add = [&](const std::array<uint32_t, 3>& t) {
    add_triangle(p, {first + t[0], first + t[1], first + t[2]},
                 {first_normal + t[0], first_normal + t[1], first_normal + t[2]});
  };
  if (placed.size() == 3) return add({0, 1, 2});
  for (const std::array<uint32_t, 3>& t : triangulate(placed))
    // Collinear vertices leave triangles of zero area, which cover nothing.
    if (has_area<float>(std::array{placed[t[0]], placed[t[1]], placed[t[2]]})) add(t);
}

/// Reads n vertices. False if an error was reported.
bool read_corners(Parser& p, size_t n, bool smooth) {
  auto& [written, placed, normals] = p.corners;
  written.clear(), placed.clear(), normals.clear();
  bool sound = true;
  for (size_t i = 1; i <= n; ++i) {
    double x[6];
    const char* const vertex = p.next();
    if (!p.numbers({x, size_t(smooth ? 6 : 3)},
                   smooth ? Parser::Names(kXyzNormal) : Parser::Names(kXyz), {"vertex", i}))
      return false;
    written.push_back({x[0], x[1], x[2]});
    placed.push_back(p.place(written.back()));
    if (p.too_far(placed.back(), vertex)) sound = false;
    if (smooth) {
      const auto normal = unit_normal({x[3], x[4], x[5]});
      if (!normal)
        p.reject(fmt::format("the normal of vertex {} is zero", i), vertex), sound = false;
      normals.push_back(normal.value_or(Vec3f()));
    }
  }
  return sound;
}

void read_polygon(Parser& p, bool smooth) {
  const auto n = p.count("the number of vertices", 3, smooth ? 12 : 6);
  if (!n) return;
  p.material_here();
  if (!read_corners(p, *n, smooth)) return;
  if (!has_area<double>(p.corners.written) || !has_area<float>(p.corners.placed))
    return p.warn(
        "left out: a polygon of zero area (its vertices coincide, are collinear or cross)");
  smooth ? add_smooth(p) : add_flat(p, p.corners.placed);
}

void read_plane(Parser& p) {
  double n[9];
  for (size_t i = 0; i < 3; ++i)
    if (!p.numbers({n + 3 * i, 3}, kXyz, {"point", i + 1})) return;
  const MaterialId id = p.material_here();
  const auto normal = plane_normal({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]});
  if (!normal) return p.reject("the three points are collinear, expected points that span a plane");
  const Plane plane{p.place({n[0], n[1], n[2]}), *normal};
  if (p.too_far(plane.point)) return;
  p.add(plane, id);
}

void read_box(Parser& p) {
  static constexpr std::string_view kNames[] = {"lowest x",  "lowest y",  "lowest z",
                                                "highest x", "highest y", "highest z"};
  double n[6];
  if (!p.numbers(n, kNames)) return;
  p.material_here();
  const Vec3f lo = p.place({n[0], n[1], n[2]}), hi = p.place({n[3], n[4], n[5]});
  if (p.too_far(lo) || p.too_far(hi)) return;
  for (int a = 0; a < 3; ++a)
    if (!(lo[a] < hi[a]))
      return p.reject(
          fmt::format("{} {} is not below {} {}", kNames[a], n[a], kNames[a + 3], n[a + 3]));
  for (const auto& face : box_faces(lo, hi)) add_flat(p, face);
}

void read_faces(Parser& p, size_t first, size_t vertices, size_t faces) {
  static constexpr std::string_view kNames[] = {"the first index", "the second index",
                                                "the third index"};
  for (size_t i = 1; i <= faces; ++i) {
    double n[3];
    const char* const here = p.next();
    if (!p.numbers(n, kNames, {"face", i})) return;
    TriangleIndices face{};
    bool sound = true;
    for (int k = 0; k < 3 && sound; ++k) {
      const double index = n[k] < 0 ? double(vertices) + n[k] : n[k] - 1;
      sound = n[k] != 0 && index == std::floor(index) && index >= 0 && index < double(vertices);
      if (sound)
        face[k] = uint32_t(first + size_t(index));
      else
        p.reject(fmt::format("{} of face {} is {}, expected 1 to {} or -1 to -{}", kNames[k], i,
                             n[k], vertices, vertices),
                 here);
    }
    if (!sound) continue;
    const auto& at = p.scene().positions;
    if (!has_area<float>(std::array{at[face[0]], at[face[1]], at[face[2]]}))
      p.warn(fmt::format("left out: face {} has zero area", i), here);
    else
      add_triangle(p, face, kFlat);
  }
}

void read_mesh(Parser& p) {
  const auto vertices = p.count("the number of vertices", 3, 6);
  if (!vertices) return;
  const auto faces = p.count("the number of faces", 1, 6);
  if (!faces) return;
  const size_t first = p.scene().positions.size();
  if (*vertices > first) p.scene().positions.reserve(first + *vertices);
  for (size_t i = 1; i <= *vertices; ++i) {
    double x[3];
    if (!p.numbers(x, kXyz, {"vertex", i})) return;
    p.scene().positions.push_back(p.place({x[0], x[1], x[2]}));
    p.too_far(p.scene().positions.back());
  }
  p.material_here();
  read_faces(p, first, *vertices, *faces);
}

constexpr std::array kFlatRows = {
    Entity{.word = "p",
           .noun = "the polygon",
           .usage = "p takes a count, then that many vertices of 3 numbers",
           .read = [](Parser& p) { read_polygon(p, false); }},
    Entity{.word = "pp",
           .noun = "the smooth polygon",
           .usage = "pp takes a count, then that many vertices of 6 numbers",
           .read = [](Parser& p) { read_polygon(p, true); }},
    Entity{.word = "pl",
           .noun = "the plane",
           .usage = "pl takes 9 numbers: three points",
           .read = read_plane},
    Entity{.word = "box",
           .noun = "the box",
           .usage = "box takes 6 numbers: lowest and highest corner",
           .read = read_box},
    Entity{.word = "mesh",
           .noun = "the mesh",
           .usage =
               "mesh takes two counts, then that many vertices of 3 numbers and faces of 3 indices",
           .read = read_mesh},
};

/// A vector of length 1 in double that rounds to the float normal. The length of a rounded unit
/// vector is not exactly 1, and dividing by it can change the rounding. So each component moves by
/// the same fraction of half its last bit, which reaches length 1 and stays within the range that
/// rounds to the float.
Vec3d unrounded(Vec3f normal) {
  const Vec3d n(normal);
  Vec3d half_bit;
  double reach = 0;
  for (int a = 0; a < 3; ++a) {
    half_bit[a] = 0.5 * (double(std::nextafter(normal[a], 2 * normal[a])) - n[a]);
    reach += half_bit[a] * n[a];
  }
  if (!(reach > 0)) return n;
  const double part = std::clamp((1 - dot(n, n)) / (2 * reach), -1.0, 1.0);
  return n + half_bit * part;
}

}  // namespace

constinit const Family kFlats = kFlatRows;

template <>
void write_shape(Writer& w, const TriangleIndices& corners, size_t i) {
  const Scene& scene = w.scene();
  const bool smooth = !scene.triangle_normals.empty() && scene.triangle_normals[i][0] != kNoNormal;
  w.text().word(smooth ? "pp 3" : "p 3").end_line();
  for (int k = 0; k < 3; ++k) {
    w.position({}, scene.positions[corners[k]]);
    if (smooth) w.text().vector(scene.normals[scene.triangle_normals[i][k]]);
    w.text().end_line();
  }
}

template <>
void write_shape(Writer& w, const Polygon& polygon, size_t) {
  w.text().word("p").number(polygon.count).end_line();
  for (size_t k = polygon.first; k < size_t(polygon.first) + polygon.count; ++k)
    w.position({}, w.scene().positions[k]).end_line();
}

template <>
void write_shape(Writer& w, const Plane& plane, size_t) {
  const Vec3d n = unrounded(plane.normal);
  const bool plain = w.scene().origin == Vec3d();
  Vec3d point = w.scene().origin + Vec3d(plane.point);
  if (plain)
    for (int a = 0; a < 3; ++a) point[a] = as_read(plane.point[a]);
  // Edges such that their cross product is n over its largest component, computed without a
  // difference of products: with that component along z they are (1, 0, -n.x/n.z) and (0, 1,
  // -n.y/n.z).
  const int k = max_axis(abs(n)), i = (k + 1) % 3, j = (k + 2) % 3;
  const auto edges = [&](double size) {
    Vec3d u, v;
    u[i] = size, u[k] = -n[i] / n[k] * size;
    v[j] = size, v[k] = -n[j] / n[k] * size;
    if (n[k] < 0) std::swap(u, v);
    return std::pair(point + u, point + v);
  };
  // Longer edges keep more digits of a plane that is nearly vertical or far away. Use the shortest
  // edges that read back exactly.
  double size = 1;
  const auto reads_back = [&] {
    const auto [b, c] = edges(size);
    return plane_normal(point, b, c) == plane.normal;
  };
  while (size < 1e30 && !reads_back()) size *= 1024;
  if (!reads_back()) size = 1;  // no rounding gives this normal; write the nearest
  const auto [b, c] = edges(size);
  if (plain)
    w.text().word("pl").vector(plane.point);
  else
    w.text().word("pl").vector(point);
  w.text().vector(b).vector(c).end_line();
}

}  // namespace raio::core::nff
