// The scenes of triangles and polygons: gears, tetra and mount.
#include <array>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/exact_math.h"
#include "io/generate/parts.h"

namespace raio::core {
namespace {

using std::numbers::pi;

constexpr int kTeeth = 36;
constexpr int kGearCorners = 4 * kTeeth;

using GearCorners = std::array<Vec3d, kGearCorners>;

struct Gear {
  Vec3d center;  // of the upper face
  double outer_radius, inner_radius, thickness;
  const GearCorners& directions;
};

/// The vectors from the centre to the vertices, unit length. `turn`: the direction of the first
/// tooth, radians.
GearCorners gear_directions(double turn) {
  // Vertices of a tooth and the gap after it, in tooth widths from the middle of the tooth.
  constexpr std::array<double, 4> kPlaces = {-0.19, 0.19, 0.3, 0.7};
  GearCorners out;
  for (int i = 0; i < kGearCorners; ++i) {
    const double angle = turn + 2 * pi / kTeeth * (i / 4 + kPlaces[i % 4]);
    out[i] = {exact_cos(angle), exact_sin(angle), 0};
  }
  return out;
}

/// Two concave faces of 144 vertices each, and the rim between them.
void add_gear(SceneMaker& maker, const Gear& gear) {
  GearCorners top, bottom;
  for (int i = 0; i < kGearCorners; ++i) {
    const double radius = i % 4 < 2 ? gear.outer_radius : gear.inner_radius;
    top[i] = gear.center + gear.directions[i] * radius;
  }
  // Seen from below, the order is reversed; starting at a tooth's far vertex keeps the first angle
  // convex, which readers use to find a polygon's front.
  const Vec3d down{0, 0, -gear.thickness};
  for (int i = 0; i < kGearCorners; ++i) {
    bottom[i] = top[(kGearCorners + 1 - i) % kGearCorners] + down;
  }
  maker.face(top);
  for (int i = 0; i < kGearCorners; ++i) {
    const Vec3d a = top[i], b = top[(i + 1) % kGearCorners];
    maker.face({a, a + down, b + down, b});
  }
  maker.face(bottom);
}

/// A random-looking colour in sevenths, as bright as possible; one gear in five is glass.
Material gear_material(int x, int y, int z) {
  const auto channel = [](int n, int factor) { return 0.01 + n * factor % 7 / 7.0; };
  const Vec3d color(channel(3 * x + 2 * y + z + 1, 5), channel(3 * y + 2 * z + x + 1, 3),
                    channel(3 * z + 2 * x + y + 1, 2));
  const Rgb brightest(color / max_component(color));
  if ((4 * x + 2 * y + z) % 5 == 0) {
    return {
        .color = brightest, .kd = 0.2f, .shine = kNoHighlight, .transmission = 0.8f, .ior = 1.1f};
  }
  return {.color = brightest, .kd = 1, .shine = kNoHighlight, .ior = 0};
}

/// A tetrahedron around `center`, with its vertices at four corners of a cube of side 2 `half`.
void split_tetra(SceneMaker& maker, Vec3d center, double half, int levels) {
  constexpr std::array<Vec3d, 4> kCorners = {Vec3d{-1, -1, 1}, Vec3d{-1, 1, -1}, Vec3d{1, -1, -1},
                                             Vec3d{1, 1, 1}};
  if (levels > 0) {
    for (const Vec3d corner : kCorners) {
      split_tetra(maker, center + corner * (half / 2), half / 2, levels - 1);
    }
    return;
  }
  std::array<uint32_t, 4> v;
  for (int i = 0; i < 4; ++i) v[i] = maker.position(center + kCorners[i] * half);
  maker.triangle({v[0], v[1], v[2]});
  maker.triangle({v[3], v[2], v[1]});
  maker.triangle({v[2], v[3], v[0]});
  maker.triangle({v[1], v[0], v[3]});
}

/// A normal deviate as a function of `seed`, by the polar method with a small linear congruential
/// generator (Press et al., Numerical Recipes, the table of constants for "quick and dirty"
/// generators).
double normal_deviate(int64_t seed) {
  constexpr int64_t kModulus = 134456, kFactor = 8121, kStep = 28411;
  const auto next = [&] {
    seed = (seed * kFactor + kStep) % kModulus;
    return 2 * double(seed) / double(kModulus) - 1;
  };
  double v, r2;
  do {
    v = next();
    const double w = next();
    r2 = v * v + w * w;
  } while (r2 >= 1 || r2 == 0);
  return v * std::sqrt(-2 * exact_log(r2) / r2);
}

/// The seed of grid point (x, y) among 2^size + 1 per side. A poor hash, kept because the published
/// mountains have it: it is little more than 128 x + 32768 y of the position in the unit square, so
/// the terrain repeats. Points shared by two sizes have the same seed.
uint16_t mountain_seed(uint64_t x, uint64_t y, int size) {
  return uint16_t((x << 23 >> size) + (y << 15 >> size) + (x << 7 >> size));
}

/// Heights on a grid of 2^size + 1 points per side over the square from -1 to 1, with a border of
/// 0, row by row. Midpoint displacement on ever finer grids, after Fournier, Fussell and Carpenter
/// 1982, "Computer Rendering of Stochastic Models", CACM 25(6), for squares.
std::vector<double> mountain_heights(int size) {
  constexpr double kFractalDimension = 2.2;
  const double ratio = 2 / exact_pow(2, 1 / (kFractalDimension - 1));
  const double roughness = std::sqrt(ratio * ratio - 1);
  const int cells = 1 << size;
  std::vector<double> heights(size_t(cells + 1) * (cells + 1), 0.0);
  std::vector<double> deviates(0x10000);  // of all seeds, 0 if not computed yet
  const auto deviate = [&](uint64_t x, uint64_t y) {
    constexpr int64_t kMountain = 21;
    const uint16_t seed = mountain_seed(x, y, size);
    if (deviates[seed] == 0) deviates[seed] = normal_deviate(kMountain + seed);
    return deviates[seed];
  };
  const auto at = [&](int x, int y) -> double& { return heights[size_t(y) * (cells + 1) + x]; };

  for (int half = cells / 2; half >= 1; half /= 2) {
    const double rise = half * 2.0 / cells * roughness;
    for (int y = 0; y <= cells; y += half) {
      for (int x = 0; x <= cells; x += half) {
        const bool new_x = x / half % 2 == 1, new_y = y / half % 2 == 1;
        if (!new_x && !new_y) continue;
        // The neighbours on the coarser grid: left and right, below and above, or four corners.
        const int dx = new_x ? half : 0, dy = new_y ? half : 0;
        double middle = (at(x - dx, y - dy) + at(x + dx, y + dy)) / 2;
        double reach = rise;
        if (new_x && new_y) {
          middle = (middle + (at(x - dx, y + dy) + at(x + dx, y - dy)) / 2) / 2;
          reach *= std::numbers::sqrt2;
        }
        at(x, y) = middle + reach * deviate(uint64_t(x), uint64_t(y));
      }
    }
  }
  return heights;
}

void add_mountain(SceneMaker& maker, int size) {
  const int cells = 1 << size;
  const std::vector<double> heights = mountain_heights(size);
  maker.use({.color = {0.5f, 0.45f, 0.35f}, .kd = 1, .shine = kNoHighlight, .ior = 0});
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      maker.position(
          {-1 + 2.0 * x / cells, -1 + 2.0 * y / cells, heights[size_t(y) * (cells + 1) + x]});
    }
  }
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const auto here = uint32_t(y * (cells + 1) + x), above = here + uint32_t(cells + 1);
      maker.triangle({here, here + 1, above + 1});
      maker.triangle({above + 1, above, here});
    }
  }
}

/// Four glass balls, one on three, of the given radii, at positions where balls of 0.17 touch.
void add_glass_pyramid(SceneMaker& maker, float ior, const std::array<double, 4>& radii) {
  maker.use({.color = {1, 1, 1},
             .kd = 0.1f,
             .ks = 0.1f,
             .shine = 101.148f,
             .transmission = 0.9f,
             .ior = ior});
  const Vec3d center{-0.8, 0.8, 1};
  const Vec3d top{0, 0, 0.17 * std::sqrt(1.5)};
  maker.sphere(center + top, radii[0]);
  const Vec3d axis = normalize(Vec3d(1, 1, 0));
  const Vec3d low = rotation(axis, exact_acos(-1.0 / 3))(top);
  for (int i = 0; i < 3; ++i) {
    maker.sphere(center + rotation(kAxisZ, i * 2 * pi / 3)(low), radii[i + 1]);
  }
}

SceneMaker mount_scene() { return {{-1.6, 1.6, 1.7}, {0, 0, 0}, kAxisZ, 45, 0.01f}; }
constexpr Vec3d kMountLight{-100, -100, 100};

/// The variant of the technical report of 2018: a white light, and glass balls with other radii and
/// another index of refraction.
Scene report_mount(int size) {
  SceneMaker maker = mount_scene();
  maker.white_light(kMountLight);
  add_glass_pyramid(maker, 1.2f, {0.17, 0.169, 0.168, 0.167});
  add_mountain(maker, size);
  return maker.finish();
}

}  // namespace

Scene make_gears(int size) {
  SceneMaker maker({-1.1, -2.1, 2.6}, {0, 0, 0}, kAxisZ, 45, 1);
  for (const Vec3d light : {Vec3d{2, 4, 4}, Vec3d{-2, 4, 3}, Vec3d{2, -2.5, 2.5}, Vec3d{-1, -4, 2},
                            Vec3d{-1.111, -2.121, 2.626}}) {
    maker.light(light);
  }
  maker.use({.color = {1, 0.85f, 0.7f}, .kd = 0.3f, .ks = 0.6f, .shine = 3.0827f, .ior = 0});
  maker.face({{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}});

  // Teeth are a tenth of the radius deep, and neighbours mesh: the row of gears is 2 wide. Radii
  // are slightly less than half the distance, so that no two surfaces coincide.
  constexpr double kTooth = 0.1, kClearance = 0.995;
  const double radius = 1 / (size - (size - 1) * kTooth / 2);
  const double step = radius * (2 - kTooth), start = -1 + radius;
  const std::array<GearCorners, 2> directions = {gear_directions(0), gear_directions(pi / kTeeth)};
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        maker.use(gear_material(x, y, z));
        add_gear(maker, {.center = {start + x * step, start + y * step, 1 - double(z) / size},
                         .outer_radius = kClearance * radius,
                         .inner_radius = (1 - kTooth) * radius,
                         .thickness = std::min(0.1, 0.5 / size),
                         .directions = directions[(x + y + z) % 2]});
      }
    }
  }
  return maker.finish();
}

/// The view is from Kay and Kajiya 1986, "Ray Tracing Complex Scenes".
Scene make_tetra(int size) {
  SceneMaker maker({1.022846, -3.177154, -2.174512}, {-0.004103, -0.004103, 0.216539},
                   {-0.816497, -0.816497, 0.816497}, 45, 1);
  maker.light({2, -18, -5});
  maker.use({.color = {1, 0.2f, 0.2f}, .kd = 1, .shine = kNoHighlight, .ior = 0});
  split_tetra(maker, {0, 0, 0}, 1, size - 1);
  return maker.finish();
}

Scene make_mount(int size) {
  SceneMaker maker = mount_scene();
  maker.light(kMountLight);
  add_glass_pyramid(maker, 1.5f, {0.17, 0.17, 0.17, 0.17});
  add_mountain(maker, size);
  return maker.finish();
}

Scene make_mount_low(int) { return report_mount(1); }
Scene make_mount_high(int) { return report_mount(5); }
Scene make_mount_very_high(int) { return report_mount(7); }

}  // namespace raio::core
