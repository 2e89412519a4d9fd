// Martin Newell's teapot with Frank Crow's bottom: 32 bicubic Bezier patches. Crow 1987, "The
// Origins of the Teapot", IEEE CG&A 7(1), lists 306 control points; all follow from the curves
// below, because rim, body, lid and bottom are surfaces of revolution, and handle and spout are
// symmetric.
#include <array>
#include <vector>

#include "io/generate/parts.h"

namespace raio::core {
namespace {

using Patch = std::array<std::array<Vec3d, 4>, 4>;

/// A control point of a profile that is revolved about the z axis.
struct Outline {
  double radius, height;
  // The distance of a quarter circle's inner control points. The best circle takes 0.5523 of the
  // radius; Newell took 0.56.
  // radius; Newell took 0.56.
  double reach = 0.56 * radius;
};
using OutlineCurve = std::array<Outline, 4>;

constexpr OutlineCurve kRim = {{{1.4, 2.4}, {1.3375, 2.53125}, {1.4375, 2.53125}, {1.5, 2.4}}};
constexpr OutlineCurve kUpperBody = {{{1.5, 2.4}, {1.75, 1.875}, {2, 1.35}, {2, 0.9}}};
constexpr OutlineCurve kLowerBody = {{{2, 0.9}, {2, 0.45}, {1.5, 0.225}, {1.5, 0.15}}};
constexpr OutlineCurve kKnob = {{{0, 3.15}, {0.8, 3.15, 0.45}, {0, 2.85}, {0.2, 2.7}}};
constexpr OutlineCurve kLid = {{{0.2, 2.7}, {0.4, 2.55}, {1.3, 2.55}, {1.3, 2.4}}};
constexpr OutlineCurve kBottom = {{{0, 0}, {1.425, 0}, {1.5, 0.075}, {1.5, 0.15}}};

/// Control points of a bent tube in the plane y = 0: its two sides and half its width.
struct Tube {
  double near_x, near_z, far_x, far_z, half_width;
};
using TubeCurve = std::array<Tube, 4>;

constexpr TubeCurve kUpperHandle = {{{-1.6, 2.025, -1.5, 2.25, 0.3},
                                     {-2.3, 2.025, -2.5, 2.25, 0.3},
                                     {-2.7, 2.025, -3, 2.25, 0.3},
                                     {-2.7, 1.8, -3, 1.8, 0.3}}};
constexpr TubeCurve kLowerHandle = {{{-2.7, 1.8, -3, 1.8, 0.3},
                                     {-2.7, 1.575, -3, 1.35, 0.3},
                                     {-2.5, 1.125, -2.65, 0.9375, 0.3},
                                     {-2, 0.9, -1.9, 0.6, 0.3}}};
constexpr TubeCurve kLowerSpout = {{{1.7, 1.425, 1.7, 0.6, 0.66},
                                    {2.6, 1.425, 3.1, 0.825, 0.66},
                                    {2.3, 2.1, 2.4, 2.025, 0.25},
                                    {2.7, 2.4, 3.3, 2.4, 0.25}}};
constexpr TubeCurve kUpperSpout = {{{2.7, 2.4, 3.3, 2.4, 0.25},
                                    {2.8, 2.475, 3.525, 2.49375, 0.25},
                                    {2.9, 2.475, 3.45, 2.5125, 0.15},
                                    {2.8, 2.4, 3.2, 2.4, 0.15}}};

/// Four quarters, each rotated by a quarter turn; `sense` is 1 for counter-clockwise from above, or
/// -1.
void add_revolved(std::vector<Patch>& patches, const OutlineCurve& curve, double sense) {
  Patch patch;
  for (int row = 0; row < 4; ++row) {
    const auto [radius, height, reach] = curve[row];
    patch[row] = {{{radius, 0, height},
                   {radius, sense * reach, height},
                   {reach, sense * radius, height},
                   {0, sense * radius, height}}};
  }
  for (int quarter = 0; quarter < 4; ++quarter) {
    patches.push_back(patch);
    for (auto& row : patch) {
      for (Vec3d& p : row) p = {-sense * p.y, sense * p.x, p.z};
    }
  }
}

/// Two halves: one from the near side to the far side, the other back.
void add_tube(std::vector<Patch>& patches, const TubeCurve& curve) {
  Patch there, back;
  for (int row = 0; row < 4; ++row) {
    const Tube& t = curve[row];
    there[row] = {{{t.near_x, 0, t.near_z},
                   {t.near_x, -t.half_width, t.near_z},
                   {t.far_x, -t.half_width, t.far_z},
                   {t.far_x, 0, t.far_z}}};
    back[row] = {{{t.far_x, 0, t.far_z},
                  {t.far_x, t.half_width, t.far_z},
                  {t.near_x, t.half_width, t.near_z},
                  {t.near_x, 0, t.near_z}}};
  }
  patches.push_back(there);
  patches.push_back(back);
}

std::vector<Patch> teapot_patches() {
  std::vector<Patch> patches;
  add_revolved(patches, kRim, -1);
  add_revolved(patches, kUpperBody, -1);
  add_revolved(patches, kLowerBody, -1);
  add_tube(patches, kUpperHandle);
  add_tube(patches, kLowerHandle);
  add_tube(patches, kLowerSpout);
  add_tube(patches, kUpperSpout);
  add_revolved(patches, kKnob, -1);
  add_revolved(patches, kLid, -1);
  add_revolved(patches, kBottom, 1);
  return patches;
}

/// The cubic Bernstein polynomials at u, and their derivatives.
struct Bernstein {
  std::array<double, 4> value, slope;

  explicit Bernstein(double u) {
    const double v = 1 - u;
    value = {v * v * v, 3 * u * v * v, 3 * u * u * v, u * u * u};
    slope = {-3 * v * v, 3 * v * (v - 2 * u), 3 * u * (2 * v - u), 3 * u * u};
  }
};

Vec3d blend(const Patch& patch, const std::array<double, 4>& rows,
            const std::array<double, 4>& columns) {
  Vec3d sum;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) sum += patch[r][c] * (rows[r] * columns[c]);
  }
  return sum;
}

/// A mesh of `size` x `size` squares, each two smooth triangles. Edges of the knob and the bottom
/// that degenerate to a point on the axis give single triangles there, with the normal up or down.
void add_patch(SceneMaker& maker, const Patch& patch, int size) {
  struct Corner {
    uint32_t position, normal;
    bool on_axis;
  };
  std::vector<Corner> grid;
  for (int row = 0; row <= size; ++row) {
    for (int column = 0; column <= size; ++column) {
      const Bernstein s(double(row) / size), t(double(column) / size);
      const Vec3d p = blend(patch, s.value, t.value);
      const bool on_axis = p.x == 0 && p.y == 0;
      const Vec3d normal =
          on_axis
              ? (p.z > 1.5 ? kAxisZ : -kAxisZ)
              : normalize(cross(blend(patch, s.value, t.slope), blend(patch, s.slope, t.value)));
      grid.push_back({maker.position(p), maker.normal(normal), on_axis});
    }
  }
  const auto add = [&](const Corner& a, const Corner& b, const Corner& c) {
    if (a.on_axis + b.on_axis + c.on_axis > 1) return;
    maker.smooth_triangle({a.position, b.position, c.position}, {a.normal, b.normal, c.normal});
  };
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const Corner* low = &grid[size_t(row) * (size + 1) + column];
      const Corner* high = low + size + 1;
      add(low[0], low[1], high[1]);
      add(high[1], high[0], low[0]);
    }
  }
}

/// The squares of one colour; `parity` of row plus column.
void add_board_squares(SceneMaker& maker, int size, int parity) {
  const auto place = [&](int i) { return 8.0 * i / size - 4; };
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      if ((i + j) % 2 != parity) continue;
      maker.face({{place(i), place(j), 0},
                  {place(i + 1), place(j), 0},
                  {place(i + 1), place(j + 1), 0},
                  {place(i), place(j + 1), 0}});
    }
  }
}

}  // namespace

Scene make_teapot(int size) {
  SceneMaker maker({4.86, 7.2, 5.4}, {0, 0, 0}, kAxisZ, 45, 1);
  maker.light({-3.1, 9.8, 12.1});
  maker.light({11.3, 5.1, 8.8});
  maker.use({.color = {1, 1, 1}, .kd = 0.5f, .ks = 0.5f, .shine = 4.81884f, .ior = 0});
  add_board_squares(maker, size, 1);
  maker.use({.color = Rgb(0.5f), .kd = 0.5f, .ks = 0.5f, .shine = 4.81884f, .ior = 0});
  add_board_squares(maker, size, 0);
  maker.use({.color = {1, 0.5f, 0.1f}, .kd = 0.75f, .ks = 0.25f, .shine = 3.0827f, .ior = 0});
  for (const Patch& patch : teapot_patches()) add_patch(maker, patch, size);
  return maker.finish();
}

}  // namespace raio::core
