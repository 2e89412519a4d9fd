// Moving primitives and cameras: P3F's spheres, and Raio's triangles, boxes and camera.
#include <fmt/format.h>

#include <array>
#include <initializer_list>

#include "io/nff/geometry.h"
#include "io/nff/parser.h"
#include "io/nff/writer.h"

namespace raio::core::nff {
namespace {

constexpr std::string_view kTimes[] = {"the start time", "the end time"};

/// Converts the numbers, three each, to points; false if one is too far away.
bool place(Parser& p, const double* n, std::initializer_list<Vec3f*> points) {
  for (Vec3f* point : points) {
    *point = p.place({n[0], n[1], n[2]});
    if (p.too_far(*point)) return false;
    n += 3;
  }
  return true;
}

bool set_times(Parser& p, const double* n, float& begin, float& end) {
  begin = float(n[0]), end = float(n[1]);
  if (begin < end) return true;
  p.reject(fmt::format("the end time must be after the start time, {}, found {}", n[0], n[1]));
  return false;
}

void read_moving_sphere(Parser& p) {
  static constexpr std::string_view kNames[] = {"x",
                                                "y",
                                                "z",
                                                "x at the end",
                                                "y at the end",
                                                "z at the end",
                                                "the radius",
                                                "the start time",
                                                "the end time"};
  double n[9];
  if (!p.numbers(n, kNames)) return;
  const MaterialId id = p.material_here();
  MovingSphere sphere;
  sphere.radius = float(n[6]);
  if (!place(p, n, {&sphere.center, &sphere.to}) || !set_times(p, n + 7, sphere.begin, sphere.end))
    return;
  if (!(sphere.radius > 0))
    return p.reject(fmt::format("the radius must be above 0, found {}", n[6]));
  p.add(sphere, id);
}

void read_moving_triangle(Parser& p) {
  double n[20];
  for (size_t i = 0; i < 6; ++i)
    if (!p.numbers({n + 3 * i, 3}, kXyz, {i < 3 ? "corner" : "the end of corner", i % 3 + 1}))
      return;
  if (!p.numbers({n + 18, 2}, kTimes)) return;
  const MaterialId id = p.material_here();
  MovingTriangle t;
  if (!place(p, n, {&t.from.a, &t.from.b, &t.from.c, &t.to.a, &t.to.b, &t.to.c}) ||
      !set_times(p, n + 18, t.begin, t.end))
    return;
  p.add(t, id);
}

void read_box(Parser& p) {
  static constexpr std::string_view kNames[] = {
      "lowest x",        "lowest y",         "lowest z",         "highest x",
      "highest y",       "highest z",        "the end's low x",  "the end's low y",
      "the end's low z", "the end's high x", "the end's high y", "the end's high z",
      "the start time",  "the end time"};
  double n[14];
  if (!p.numbers(n, kNames)) return;
  const MaterialId id = p.material_here();
  Vec3f lo, hi, lo_end, hi_end;
  float begin = 0, end = 0;
  if (!place(p, n, {&lo, &hi, &lo_end, &hi_end}) || !set_times(p, n + 12, begin, end)) return;
  for (size_t i : {0, 1, 2, 6, 7, 8})
    if (!(n[i] < n[i + 3]))
      return p.reject(
          fmt::format("{} {} is not below {} {}", kNames[i], n[i], kNames[i + 3], n[i + 3]));
  const auto from = box_faces(lo, hi), to = box_faces(lo_end, hi_end);
  for (size_t face = 0; face < from.size(); ++face) {
    const auto &f = from[face], &t = to[face];
    for (const size_t k : {1, 2})
      p.add(MovingTriangle{{f[0], f[k], f[k + 1]}, {t[0], t[k], t[k + 1]}, begin, end}, id);
  }
}

void read_camera_movement(Parser& p) {
  static constexpr std::string_view kNames[] = {"x in \"from\"",  "y in \"from\"", "z in \"from\"",
                                                "x in \"at\"",    "y in \"at\"",   "z in \"at\"",
                                                "the start time", "the end time"};
  double n[8];
  if (!p.numbers(n, kNames)) return;
  Camera& camera = p.scene().camera;
  if (!p.seen.camera) return p.reject("vm before v, expected the camera before its movement");
  if (camera.movement) return p.reject("a second vm, expected at most one");
  CameraMovement movement;
  if (!place(p, n, {&movement.from, &movement.at}) ||
      !set_times(p, n + 6, movement.begin, movement.end))
    return;
  camera.movement = movement;
  if (const std::string wrong = camera_problem(camera); !wrong.empty()) p.reject(wrong);
}

constexpr std::array kMovementRows = {
    Entity{.word = "sm",
           .noun = "the moving sphere",
           .usage =
               "sm takes 9 numbers: x y z at the start, x y z at the end, radius, start time, end "
               "time",
           .read = read_moving_sphere},
    Entity{.word = "tm",
           .noun = "the moving triangle",
           .usage =
               "tm takes 20 numbers: three vertices at the start, three at the end, start time, "
               "end time",
           .read = read_moving_triangle},
    Entity{.word = "bm",
           .noun = "the moving box",
           .usage = "bm takes 14 numbers: lowest and highest corner at the start and at the end, "
                    "start time, end time",
           .read = read_box},
    Entity{.word = "vm",
           .noun = "the movement of the camera",
           .usage = "vm takes 8 numbers: from and at at the end of the movement, start time, end "
                    "time",
           .read = read_camera_movement,
           .leaves = Entity::Leaves::more},
};

}  // namespace

constinit const Family kMovements = kMovementRows;

template <>
void write_shape(Writer& w, const MovingSphere& s, size_t) {
  w.position("sm", s.center);
  w.position({}, s.to).number(s.radius).number(s.begin).number(s.end).end_line();
}

template <>
void write_shape(Writer& w, const MovingTriangle& t, size_t) {
  w.text().word("tm");
  for (const Vec3f corner : {t.from.a, t.from.b, t.from.c, t.to.a, t.to.b, t.to.c})
    w.position({}, corner);
  w.text().number(t.begin).number(t.end).end_line();
}

void write_camera_movement(Writer& w) {
  const auto& movement = w.scene().camera.movement;
  if (!movement) return;
  w.position("vm", movement->from);
  w.position({}, movement->at).number(movement->begin).number(movement->end).end_line();
}

}  // namespace raio::core::nff
