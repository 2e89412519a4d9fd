// The scenes of spheres, cylinders and cones.
#include <array>
#include <numbers>

#include "base/exact_math.h"
#include "io/generate/parts.h"

namespace raio::core {
namespace {

using std::numbers::pi;

/// The view of all sphereflakes.
SceneMaker flake_scene() { return {{2.1, 1.3, 1.7}, {0, 0, 0}, kAxisZ, 45, 0.01f}; }

constexpr Material kFlakeFloor{.color = {1, 0.75f, 0.33f}, .kd = 0.8f, .shine = kNoHighlight};
constexpr std::array<Vec3d, 3> kFlakeLights = {Vec3d{4, 3, 2}, Vec3d{1, -4, 4}, Vec3d{-3, 1, 5}};
constexpr std::array<Vec3d, 4> kFlakeFloorCorners = {Vec3d{12, 12, -0.5}, Vec3d{-12, 12, -0.5},
                                                     Vec3d{-12, -12, -0.5}, Vec3d{12, -12, -0.5}};

/// The positions of nine children on a parent that grows along +z: six around its equator and three
/// above, each 60 degrees from its nearest neighbours.
std::array<Vec3d, 9> flake_directions() {
  const auto direction = [](double longitude_deg, double z) {
    const double angle = longitude_deg * pi / 180, across = std::sqrt(1 - z * z);
    return Vec3d(across * exact_cos(angle), across * exact_sin(angle), z);
  };
  std::array<Vec3d, 9> out;
  for (int third = 0; third < 3; ++third) {
    out[third * 3] = direction(120 * third + 45, std::sqrt(2.0 / 3));
    out[third * 3 + 1] = direction(120 * third + 15, 0);
    out[third * 3 + 2] = direction(120 * third + 75, 0);
  }
  return out;
}

/// The shortest rotation from +z to the unit vector `d`. Near the poles its axis is undefined;
/// there the published scene rotates by nothing, or by half a turn about y.
LinearMap rotation_from_z(Vec3d d) {
  constexpr double kPole = 0.9999;
  if (d.z >= kPole) return {};
  if (d.z <= -kPole) return rotation(kAxisY, pi);
  const Vec3d axis = cross(kAxisZ, d);
  return rotation(normalize(axis), d.z, length(axis));
}

struct FlakeSphere {
  Vec3d center;
  double radius;
  Vec3d outward;  // unit, away from the parent
};

void grow_flake(SceneMaker& maker, const std::array<Vec3d, 9>& directions,
                const FlakeSphere& parent, int levels) {
  maker.sphere(parent.center, parent.radius);
  if (levels == 0) return;
  const LinearMap turn = rotation_from_z(parent.outward);
  const double child_radius = parent.radius / 3;
  for (const Vec3d direction : directions) {
    const Vec3d outward = turn(direction);
    const Vec3d center = parent.center + outward * (parent.radius + child_radius);
    grow_flake(maker, directions, {center, child_radius, outward}, levels - 1);
  }
}

void add_flake(SceneMaker& maker, int size, float ks, float shine) {
  maker.use({.color = {1, 0.9f, 0.7f}, .kd = 0.5f, .ks = ks, .shine = shine});
  grow_flake(maker, flake_directions(), {{0, 0, 0}, 0.5, kAxisZ}, size);
}

/// The variant of the technical report of 2018: white lights, and the floor as two triangles.
Scene report_flake(int size, float ks, float shine) {
  SceneMaker maker = flake_scene();
  for (const Vec3d light : kFlakeLights) maker.white_light(light);
  maker.use(kFlakeFloor);
  const auto& floor = kFlakeFloorCorners;
  maker.face({floor[0], floor[1], floor[2]});
  maker.face({floor[2], floor[3], floor[0]});
  add_flake(maker, size, ks, shine);
  return maker.finish();
}

/// The midpoints of the edges of a dodecahedron, as six pentagons: one around the z axis, and five
/// tilted by the angle between faces. Scaled so that tubes of radius `tube` stay inside the unit
/// sphere.
std::array<std::array<Vec3d, 5>, 6> linked_pentagons(double tube) {
  const double radius = 1 / (1 + tube);
  std::array<std::array<Vec3d, 5>, 6> rings;
  for (int i = 0; i < 5; ++i) {
    const double angle = i * 2 * pi / 5;
    rings[0][i] = Vec3d(exact_cos(angle), exact_sin(angle), 0) * radius;
  }
  const double dihedral = 2 * exact_acos(exact_cos(pi / 3) / exact_sin(pi / 5));
  const LinearMap tilt = rotation(kAxisX, dihedral);
  for (int ring = 1; ring < 6; ++ring) {
    const LinearMap turn = rotation(kAxisZ, (2 * ring - 1) * pi / 5);
    for (int i = 0; i < 5; ++i) rings[ring][i] = turn(tilt(rings[0][i]));
  }
  return rings;
}

constexpr double kTube = 0.07412;

/// One element of the pyramid: six rings with different colours.
void add_rings(SceneMaker& maker, const std::array<std::array<Vec3d, 5>, 6>& rings, Vec3d at) {
  constexpr std::array<Rgb, 6> kColors = {Rgb{1, 0, 0}, Rgb{0, 1, 0}, Rgb{0, 0, 1},
                                          Rgb{0, 1, 1}, Rgb{1, 0, 1}, Rgb{1, 1, 0}};
  for (int ring = 0; ring < 6; ++ring) {
    maker.use({.color = kColors[ring], .kd = 0.5f, .ks = 0.2f, .shine = 3.0827f, .ior = 0});
    for (int i = 0; i < 5; ++i) {
      const Vec3d joint = rings[ring][i] + at, previous = rings[ring][(i + 4) % 5] + at;
      maker.cylinder(joint, previous, kTube);
      maker.sphere(joint, kTube);
    }
  }
}

/// A branch and everything that grows from it, after Aono and Kunii 1984, "Botanical Tree Image
/// Generation", IEEE CG&A 4(5). In its own frame the branch extends from 0 to z = 1.
void grow_branch(SceneMaker& maker, Vec3d base, const LinearMap& frame, double radius, int levels) {
  constexpr double kTaper = 0.67;
  struct Fork {
    LinearMap turn;
    double shrink;
  };
  const auto fork_of = [](double angle_deg, double turn_deg, double shrink) {
    return Fork{rotation(kAxisZ, turn_deg * pi / 180) * rotation(kAxisX, angle_deg * pi / 180),
                shrink};
  };
  static const std::array<Fork, 2> kForks = {fork_of(40, 90, 0.65), fork_of(25, 230, 0.70)};

  const Vec3d tip = base + frame.z;
  const double tip_radius = radius * kTaper;
  maker.cone(base, radius, tip, tip_radius);
  maker.sphere(tip, tip_radius);
  if (levels == 0) return;
  for (const Fork& fork : kForks) {
    const LinearMap turned = frame * fork.turn;
    const LinearMap shrunk{turned.x * fork.shrink, turned.y * fork.shrink, turned.z * fork.shrink};
    grow_branch(maker, tip, shrunk, tip_radius, levels - 1);
  }
}

}  // namespace

Scene make_balls(int size) {
  SceneMaker maker = flake_scene();
  for (const Vec3d light : kFlakeLights) maker.light(light);
  maker.use(kFlakeFloor);
  maker.face(kFlakeFloorCorners);
  add_flake(maker, size, 0.5f, 3.0827f);
  return maker.finish();
}

Scene make_sphereflake(int size) { return report_flake(size, 0.5f, 3.0827f); }
Scene make_balls_low(int) { return report_flake(1, 0.5f, 30.0827f); }
Scene make_balls_medium(int) { return report_flake(2, 0.7f, 190.0827f); }
Scene make_balls_high(int) { return report_flake(4, 0.5f, 3.0827f); }

Scene make_rings(int size) {
  // At this distance a ball of radius 1 just fills the 45 degrees of the view; layers have the same
  // spacing.
  const double spread = 1 / exact_sin(pi / 8);
  const Vec3d eye{-1, -spread, 0.5};
  SceneMaker maker(eye, eye + kAxisY, kAxisZ, 45, 1);
  maker.light({3, -spread, 3});
  maker.light({-4, -spread, 1});
  maker.light({2, -spread, -4});

  // The wall fills the view and a hundredth more.
  maker.use({.color = {1, 1, 1}, .kd = 1, .shine = kNoHighlight, .ior = 0});
  const double y = spread * (size + 1);
  const double half = 1.01 * (y - eye.y) * exact_tan(pi / 8);
  maker.face({{eye.x + half, y, eye.z + half},
              {eye.x - half, y, eye.z + half},
              {eye.x - half, y, eye.z - half},
              {eye.x + half, y, eye.z - half}});

  const auto rings = linked_pentagons(kTube);
  for (int layer = 0; layer < size; ++layer) {
    for (int row = 0; row <= layer; ++row) {
      for (int column = 0; column <= layer; ++column) {
        add_rings(maker, rings,
                  {double(2 * column - layer), spread * (layer + 1), double(2 * row - layer)});
      }
    }
  }
  return maker.finish();
}

Scene make_tree(int size) {
  SceneMaker maker({4.5, 0.4, 2}, {0, 0, 1.5}, kAxisZ, 45, 1);
  for (const Vec3d light :
       {Vec3d{-5, 5, 50}, Vec3d{30, -30, 30}, Vec3d{-40, -30, 20}, Vec3d{10, 30, 40},
        Vec3d{-30, 40, 10}, Vec3d{50, 25, 20}, Vec3d{-10, -60, 30}}) {
    maker.light(light);
  }
  maker.use({.color = {0.2f, 0.7f, 0.2f}, .kd = 1, .shine = kNoHighlight, .ior = 0});
  maker.face({{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}});
  maker.use({.color = {0.55f, 0.4f, 0.2f}, .kd = 1, .shine = kNoHighlight, .ior = 0});
  grow_branch(maker, {0, 0, 0}, {}, 0.15, size);
  return maker.finish();
}

/// Antonio Costa's scene, added to the databases in 1993.
Scene make_lattice(int size) {
  const double cell = 1.0 / size;
  const double middle = (size / 2 + 0.5) * cell;
  SceneMaker maker({middle, 1, 1 - cell / 2}, {middle, -1, -1 - cell / 2}, {0.2, 1, 0}, 60, 0);
  for (const Vec3d axis : {kAxisX, kAxisY, kAxisZ}) {
    maker.light(Vec3d(0.5) + axis * 1.5);
    maker.light(Vec3d(0.5) - axis * 1.5);
  }
  const auto for_each_node = [&](int nx, int ny, int nz, auto&& add) {
    for (int x = 0; x <= nx; ++x) {
      for (int y = 0; y <= ny; ++y) {
        for (int z = 0; z <= nz; ++z) add(Vec3d(x, y, z) / double(size));
      }
    }
  };
  const double ball = cell / 4, rod = cell / 16;
  maker.use({.color = Rgb(0.9f), .kd = 0.5f, .ks = 0.5f, .shine = 3.0827f, .ior = 0});
  for_each_node(size, size, size, [&](Vec3d node) { maker.sphere(node, ball); });

  // Rods start just below the surface of a ball, as deep as in the published scene.
  const double start = 0.99 * ball * (1 - std::sqrt(rod / ball));
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d along;
    along[axis] = 1;
    Rgb color(0.1f);
    color[axis] = 0.9f;
    maker.use({.color = color, .kd = 0.99f, .shine = kNoHighlight, .ior = 0});
    for_each_node(size - (axis == 0), size - (axis == 1), size - (axis == 2), [&](Vec3d node) {
      maker.cylinder(node + along * start, node + along * (cell - start), rod);
    });
  }
  return maker.finish();
}

}  // namespace raio::core
