#include "shape/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include "base/box.h"

namespace raio::core {
namespace {

using Corners = std::vector<Vec3f>;
using Triangles = std::vector<std::array<uint32_t, 3>>;

/// Twice the vector area.
Vec3d area2(const Corners& p) {
  Vec3d sum;
  for (size_t i = 0; i < p.size(); ++i) sum += cross(Vec3d(p[i]), Vec3d(p[(i + 1) % p.size()]));
  return sum;
}

Vec3d area2(const Corners& p, const std::array<uint32_t, 3>& t) {
  return cross(Vec3d(p[t[1]]) - Vec3d(p[t[0]]), Vec3d(p[t[2]]) - Vec3d(p[t[0]]));
}

/// Corners in the plane z = 0, counter-clockwise about +z.
Corners flat(const std::vector<std::array<double, 2>>& xy) {
  Corners out;
  for (const auto& [x, y] : xy) out.emplace_back(float(x), float(y), 0.f);
  return out;
}

Corners star(int n, uint32_t seed, double innermost) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> radius(innermost, 1);
  std::vector<std::array<double, 2>> xy;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, r = radius(rng);
    xy.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return flat(xy);
}

Corners comb(int teeth) {
  std::vector<std::array<double, 2>> xy{{0, -1}, {double(teeth), -1}};
  for (int i = teeth; i-- > 0;) {
    xy.push_back({i + 0.75, 0});
    xy.push_back({i + 0.5, 10});
    xy.push_back({i + 0.25, 0});
  }
  return flat(xy);
}

/// A band that winds inwards: out along one side, back along the other.
Corners spiral(int n, double turns) {
  std::vector<std::array<double, 2>> xy;
  const auto at = [&](int i, double width) {
    const double angle = 2 * std::numbers::pi * turns * i / n, r = 1 + angle + width;
    xy.push_back({r * std::cos(angle), r * std::sin(angle)});
  };
  for (int i = 0; i < n; ++i) at(i, 3);
  for (int i = n; i-- > 0;) at(i, 0);
  return flat(xy);
}

/// Checks the triangles of a simple polygon: number, use of vertices, winding and area. If no
/// triangle is flipped, equal area means no overlaps and no gaps.
void check(const Corners& p, const Triangles& triangles) {
  ASSERT_EQ(triangles.size(), p.size() - 2);
  const Vec3d total = area2(p);
  const Vec3d normal = normalize(total);
  Box3d box;
  for (const Vec3f& q : p) box.extend(Vec3d(q));
  // Float vertices of a rotated polygon are off its plane by half an ulp, which can flip triangles
  // thinner than that; in a coordinate plane only the test's own sums are rounded.
  const bool exact = normal == Vec3d(0, 0, 1) || normal == Vec3d(0, 0, -1);
  const double largest = max_component(max(abs(box.lo), abs(box.hi)));
  const double slack = exact ? 1e-12 * length(total) : 0x1p-23 * largest * length(box.size());
  double sum = 0;
  std::vector<int> uses(p.size());
  for (const auto& t : triangles) {
    for (const uint32_t i : t) {
      ASSERT_LT(i, p.size());
      ++uses[i];
    }
    const double area = dot(area2(p, t), normal);
    ASSERT_GE(area, -slack);
    sum += area;
  }
  EXPECT_NEAR(sum, length(total), 1e-9 * length(total));
  EXPECT_EQ(std::ranges::count(uses, 0), 0) << "each corner is in a triangle";
}

void check(const Corners& p) { check(p, triangulate(p)); }

/// The same polygon translated and rotated: a rotation with integer entries over 3, 7, ... would
/// round; this one is arbitrary.
Corners turned(const Corners& p, double scale, Vec3d to) {
  const Frame<double> f(normalize(Vec3d(1, 2, -0.5)));
  const Vec3d n = cross(f.u, f.v);
  Corners out;
  for (const Vec3f& q : p) {
    const Vec3d v(q);
    out.emplace_back((f.u * v.x + f.v * v.y + n * v.z) * scale + to);
  }
  return out;
}

bool inside_even_odd(const Corners& p, double x, double y) {
  bool inside = false;
  for (size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    const double xi = p[i].x, yi = p[i].y, xj = p[j].x, yj = p[j].y;
    if ((yi > y) != (yj > y) && x < (xj - xi) * (y - yi) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

bool inside_triangle(const Corners& p, const std::array<uint32_t, 3>& t, double x, double y) {
  const auto side = [&](int i) {
    const Vec3d a(p[t[i]]), b(p[t[(i + 1) % 3]]);
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
  };
  return side(0) > 0 && side(1) > 0 && side(2) > 0;
}

/// Random points are in exactly one triangle if in the polygon, and otherwise in none.
void check_points(const Corners& p, int points, uint32_t seed) {
  const Triangles triangles = triangulate(p);
  double size = 0;
  for (const Vec3f& q : p) size = std::max({size, double(std::abs(q.x)), double(std::abs(q.y))});
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> coordinate(-1.1 * size, 1.1 * size);
  for (int k = 0; k < points; ++k) {
    const double x = coordinate(rng), y = coordinate(rng);
    const auto in = [&](const auto& t) { return inside_triangle(p, t, x, y); };
    ASSERT_EQ(std::ranges::count_if(triangles, in), int(inside_even_odd(p, x, y)));
  }
}

TEST(Polygon, NormalOfConcaveAndEmptyPolygons) {
  const Corners arrow = flat({{0, 0}, {4, 0}, {1, 1}, {0, 4}});
  EXPECT_EQ(polygon_normal(arrow), Vec3f(0, 0, 1));
  EXPECT_EQ(polygon_normal(flat({{0, 4}, {1, 1}, {4, 0}, {0, 0}})), Vec3f(0, 0, -1));
  EXPECT_EQ(polygon_normal(flat({{0, 0}, {1, 1}, {2, 2}, {3, 3}})), Vec3f());
  EXPECT_EQ(polygon_normal({}), Vec3f());
  const Corners far = {{1e6f, 1e6f, 5}, {1e6f + 1, 1e6f, 5}, {1e6f + 1, 1e6f + 1, 5}};
  EXPECT_EQ(polygon_normal(far), Vec3f(0, 0, 1));
}

TEST(Polygon, SmallPolygons) {
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate(flat({{0, 0}, {1, 0}})).empty());
  EXPECT_EQ(triangulate(flat({{0, 0}, {1, 0}, {0, 1}})), (Triangles{{0, 1, 2}}));
  check(flat({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  check(flat({{0, 0}, {2, 0}, {3, 1}, {1, 3}, {0, 2}}));
}

TEST(Polygon, QuadsAreCutAlongTheInnerDiagonal) {
  const std::vector<std::array<double, 2>> arrow{{0, 0}, {4, 0}, {1, 1}, {0, 4}};
  for (int start = 0; start < 4; ++start) {
    auto xy = arrow;
    std::ranges::rotate(xy, xy.begin() + start);
    check(flat(xy));
    std::ranges::reverse(xy);
    check(flat(xy));
  }
  // A collinear vertex makes no degenerate triangle.
  const Corners in_line = flat({{0, 0}, {1, 0}, {2, 0}, {0, 2}});
  for (const auto& t : triangulate(in_line)) EXPECT_GT(length(area2(in_line, t)), 0.5);
}

TEST(Polygon, RandomStarsInSpace) {
  std::mt19937 rng(1);
  for (uint32_t k = 0; k < 400; ++k) {
    const int n = 4 + int(rng() % 60);
    const Corners p = star(n, k, 0.05);
    check(p);
    for (const double scale : {1e-6, 1.0, 1e6}) check(turned(p, scale, Vec3d(3, -7, 2) * scale));
  }
}

TEST(Polygon, PointsAreInOneTriangleOrNone) {
  for (uint32_t k = 0; k < 30; ++k) check_points(star(8 + 3 * int(k), k, 0.02), 400, k);
  check_points(comb(7), 1000, 1);
  check_points(spiral(60, 3), 1000, 2);
}

TEST(Polygon, CombsAndSpirals) {
  for (const int teeth : {1, 2, 5, 100}) check(comb(teeth));
  for (const double turns : {0.3, 1.0, 4.5}) check(spiral(300, turns));
  check(turned(comb(40), 1e-3, {5, 5, 5}));
}

TEST(Polygon, CornersInLineMakeNoFlatTriangles) {
  // A square with many vertices along each side.
  std::vector<std::array<double, 2>> xy;
  const int n = 16;
  for (int i = 0; i < n; ++i) xy.push_back({double(i), 0});
  for (int i = 0; i < n; ++i) xy.push_back({double(n), double(i)});
  for (int i = 0; i < n; ++i) xy.push_back({double(n - i), double(n)});
  for (int i = 0; i < n; ++i) xy.push_back({0, double(n - i)});
  const Corners square = flat(xy);
  check(square);
  for (const auto& t : triangulate(square)) EXPECT_GT(area2(square, t).z, 0);

  const Corners notched = flat({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}});
  check(notched);
  for (const auto& t : triangulate(notched)) EXPECT_GT(area2(notched, t).z, 0);
}

TEST(Polygon, RepeatedCorners) {
  const Corners base = star(20, 5, 0.1);
  for (const int copies : {2, 3}) {
    Corners p;
    for (const Vec3f& q : base) p.insert(p.end(), copies, q);
    check(p);
  }
  const Corners square = flat({{0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 1}, {0, 0}});
  check(square);
}

TEST(Polygon, AHoleJoinedByASlit) {
  const Corners p =
      flat({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}});
  check(p);
  EXPECT_NEAR(area2(p).z, 2 * (81 - 9), 1e-6);
  check_points(p, 2000, 3);
}

TEST(Polygon, AChainThatTouchesACornerFromInside) {
  // The corner (0, 0) is visited again by a wedge from the far side.
  check(flat({{0, 0}, {4, 0}, {4, 4}, {3, 4}, {0, 0}, {1, 4}, {-4, 4}, {-4, 0}}));
  check(flat({{-2, -1}, {0, -1}, {2, -1}, {2, 2}, {1, 2}, {0, -1}, {-1, 2}, {-2, 2}}));
}

TEST(Polygon, DegenerateInputAlwaysGivesItsNumberOfTriangles) {
  std::mt19937 rng(3);
  std::vector<Corners> all;
  for (const int n : {4, 5, 6, 9, 50, 2000}) {
    all.push_back(Corners(n, Vec3f(1, 2, 3)));
    Corners line, there_and_back, noise, lattice, bow;
    for (int i = 0; i < n; ++i) {
      line.emplace_back(float(i), 2 * float(i), 0.f);
      there_and_back.emplace_back(float(std::min(i, n - i)), 0.f, 0.f);
      noise.emplace_back(float(rng() % 1000), float(rng() % 1000), 0.f);
      lattice.emplace_back(float(rng() % 3), float(rng() % 3), float(rng() % 2));
      bow.emplace_back(float(i % 4 == 1 || i % 4 == 2), float(i % 4 / 2), 0.f);
    }
    for (auto& p : {line, there_and_back, noise, lattice, bow}) all.push_back(p);
  }
  for (const Corners& p : all) {
    const Triangles triangles = triangulate(p);
    ASSERT_EQ(triangles.size(), p.size() - 2);
    for (const auto& t : triangles) {
      for (const uint32_t i : t) ASSERT_LT(i, p.size());
      EXPECT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    }
  }
}

TEST(Polygon, ConvexPolygonsAreNotCutIntoSlivers) {
  const int n = 1000;
  const Corners circle = star(n, 0, 1);
  const Triangles triangles = triangulate(circle);
  check(circle, triangles);
  // Halving uses a vertex in about 2 log2(n) triangles; a fan uses one in n.
  std::vector<int> uses(n);
  for (const auto& t : triangles) {
    for (const uint32_t i : t) ++uses[i];
  }
  EXPECT_LE(std::ranges::max(uses), 24);
}

TEST(Polygon, ManyCornersAreFast) {
  const int n = 100000;
  const auto timed = [](const char* name, const Corners& p) {
    const std::clock_t start = std::clock();
    const Triangles triangles = triangulate(p);
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    check(p, triangles);
    // Quadratic time would be minutes; the bound leaves room for sanitizers, and the processor's
    // own time does not grow on a busy machine.
    EXPECT_LT(seconds, 10) << name;
    testing::Test::RecordProperty(name, std::to_string(seconds));
  };
  timed("star", star(n, 1, 0.5));
  timed("thin_star", star(n, 2, 0.001));
  timed("comb", comb(n / 3));
  timed("spiral", spiral(n / 2, 50));
  timed("circle", star(n, 3, 1));
}

/// The polygons of 144 vertices of an NFF file.
std::vector<Corners> gears(const std::filesystem::path& path) {
  std::vector<Corners> out;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line) && out.size() < 300;) {
    if (line != "p 144") continue;
    Corners p(144);
    for (Vec3f& q : p) in >> q.x >> q.y >> q.z;
    out.push_back(p);
  }
  return out;
}

TEST(Polygon, TheGearsOfTheStandardScenes) {
  const auto path =
      std::filesystem::path(RAIO_SOURCE_DIR) / ".." / "shared" / "scenes" / "spd" / "gears.nff";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const std::vector<Corners> all = gears(path);
  ASSERT_FALSE(all.empty());
  for (const Corners& p : all) {
    const Triangles triangles = triangulate(p);
    ASSERT_EQ(triangles.size(), 142u);
    const Vec3d total = area2(p), normal = normalize(total);
    double sum = 0;
    for (const auto& t : triangles) {
      const double area = dot(area2(p, t), normal);
      EXPECT_GE(area, -1e-6 * length(total));  // the file has six digits
      sum += area;
    }
    EXPECT_NEAR(sum, length(total), 1e-6 * length(total));
  }
}

}  // namespace
}  // namespace raio::core
