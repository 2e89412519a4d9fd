#include "shape/triangle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "sanitized.h"

namespace raio::core {
namespace {

using tests::if_sanitized;
using Real = long double;
using Vec3r = Vec3<Real>;

std::optional<TriangleHit> hit(const Triangle& t, const Ray& ray) {
  return intersect(t.a, t.b, t.c, ray, ShearedRay(ray.dir));
}

Vec3d random_unit(std::mt19937& rng) {
  std::normal_distribution<double> gauss;
  const double x = gauss(rng), y = gauss(rng), z = gauss(rng);
  return normalize(Vec3d(x, y, z));
}

double uniform(std::mt19937& rng, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(rng);
}

struct Mesh {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 3>> faces;
};

/// An icosahedron, its faces split in four a few times and its points pushed out to the unit
/// sphere.
Mesh icosphere(int splits) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Mesh m;
  for (const double s : {-1.0, 1.0}) {
    for (const double q : {-g, g}) {
      m.points.push_back({0, s, q}), m.points.push_back({s, q, 0}), m.points.push_back({q, 0, s});
    }
  }
  for (Vec3d& p : m.points) p = normalize(p);
  // The faces are the triples of points an edge apart, turned outwards.
  const double edge = 2 / std::sqrt(1 + g * g) * 1.001;
  const auto near = [&](int i, int j) { return length(m.points[i] - m.points[j]) < edge; };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
        const Vec3d a = m.points[i], b = m.points[j], c = m.points[k];
        const bool outwards = dot(cross(b - a, c - a), a) > 0;
        m.faces.push_back({i, outwards ? j : k, outwards ? k : j});
      }
    }
  }
  for (; splits > 0; --splits) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int i, int j) {
      const auto [at, added] = middles.try_emplace(std::minmax(i, j), int(m.points.size()));
      if (added) m.points.push_back(normalize(m.points[i] + m.points[j]));
      return at->second;
    };
    std::vector<std::array<int, 3>> faces;
    for (const auto& [i, j, k] : m.faces) {
      const int a = middle(i, j), b = middle(j, k), c = middle(k, i);
      faces.insert(faces.end(), {{i, a, c}, {j, b, a}, {k, c, b}, {a, b, c}});
    }
    m.faces = faces;
  }
  return m;
}

/// The same with every point at a random height: thin and steep triangles. Star-shaped about 0.
Mesh spikes(int splits, uint32_t seed) {
  Mesh m = icosphere(splits);
  std::mt19937 rng(seed);
  for (Vec3d& p : m.points) p = p * uniform(rng, 0.05, 1);
  return m;
}

TEST(Triangle, ClosedForms) {
  const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto front = hit(t, {{0.25f, 0.5f, 2}, {0, 0, -1}});
  ASSERT_TRUE(front);
  EXPECT_EQ(front->t, 2);
  EXPECT_EQ(front->u, 0.25f);
  EXPECT_EQ(front->v, 0.5f);
  EXPECT_LT(front->cosine, 0);
  const auto back = hit(t, {{0.25f, 0.5f, -2}, {0, 0, 1}});
  ASSERT_TRUE(back);
  EXPECT_GT(back->cosine, 0);
  const auto behind = hit(t, {{0.25f, 0.5f, 2}, {0, 0, 1}});
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->t, -2);
  EXPECT_FALSE(hit(t, {{0.6f, 0.5f, 2}, {0, 0, -1}}));
  EXPECT_FALSE(hit(t, {{-0.1f, 0.5f, 2}, {0, 0, -1}}));
  EXPECT_FALSE(hit(t, {{0.25f, 0, 0}, {1, 0, 0}})) << "in its plane";
  EXPECT_EQ(triangle_normal(t), Vec3f(0, 0, 1));
  EXPECT_EQ(triangle_normal({t.a, t.b, t.b}), Vec3f());
}

/// Moeller and Trumbore's determinants in long double, with the weights' distance from the border.
TEST(Triangle, AgreesWithDeterminants) {
  std::mt19937 rng(1);
  int hits = 0, misses = 0;
  for (int k = 0; k < 200000; ++k) {
    const double size = std::array{1e-6, 1.0, 1e6}[k % 3];
    const Vec3d place = random_unit(rng) * size * std::array{0.0, 1.0, 1e3, 1e5}[k % 4];
    const auto corner = [&] { return Vec3f(place + random_unit(rng) * size); };
    const Vec3f a = corner(), b = corner(), c = corner();
    const double distance = size * std::array{0.1, 3.0, 1e2, 1e4, 1e6}[k % 5];
    const Vec3d to = Vec3d(a) + (Vec3d(b) - Vec3d(a)) * uniform(rng, -0.5, 1) +
                     (Vec3d(c) - Vec3d(a)) * uniform(rng, -0.5, 1);
    const Vec3f origin(to - random_unit(rng) * distance);
    const Ray ray{origin, Vec3f(normalize(to - Vec3d(origin)))};

    const Vec3r d(ray.dir), e1 = Vec3r(b) - Vec3r(a), e2 = Vec3r(c) - Vec3r(a);
    const Vec3r s = Vec3r(origin) - Vec3r(a), n = cross(e1, e2);
    const Real det = -dot(n, d), scale = length(e1) * length(e2);
    const Real far = length(s) + length(e1) + length(e2),
               bound = 8 * std::numeric_limits<float>::epsilon() * far;
    // The bound, as a shift of the ray, in units of the weights.
    const Real slack = bound * std::max(length(e1), length(e2)) / std::abs(det);
    if (!(slack < 0.1L) || std::abs(det) < 1e-3L * scale) continue;
    const Real u = dot(cross(d, e2), s) / det, v = -dot(cross(d, e1), s) / det;
    const Real t = dot(n, s) / det;
    const Real inside = std::min({u, v, 1 - u - v});
    const auto found = hit({a, b, c}, ray);
    if (inside > slack) {
      ASSERT_TRUE(found);
      ++hits;
    } else if (inside < -slack) {
      ASSERT_FALSE(found);
      ++misses;
    }
    if (!found) continue;
    ASSERT_LE(std::abs(found->u - u), slack);
    ASSERT_LE(std::abs(found->v - v), slack);
    ASSERT_LE(std::abs(found->t - t), bound * scale / std::abs(det));
    ASSERT_EQ(found->cosine < 0, det > 0);
  }
  EXPECT_GT(hits, 20000);
  EXPECT_GT(misses, 20000);
}

/// Shoots rays from outside at points of edges and vertices, and towards the middle beyond them;
/// only the triangles around are tested. A ray must hit one of these.
void check_watertight(const Mesh& mesh, double scale, Vec3d place, int rays, uint32_t seed) {
  std::vector<Vec3f> p;
  for (const Vec3d& q : mesh.points) p.push_back(Vec3f(q * scale + place));
  std::vector<std::vector<int>> around(p.size());
  for (int f = 0; f < int(mesh.faces.size()); ++f) {
    for (const int i : mesh.faces[f]) around[i].push_back(f);
  }
  std::mt19937 rng(seed);
  int lost = 0, not_finite = 0, asked_all = 0;
  for (int k = 0; k < rays; ++k) {
    const auto& face = mesh.faces[rng() % mesh.faces.size()];
    const int i = face[0], j = face[1];
    const double along = k % 4 == 0 ? 0 : uniform(rng, 0, 1);
    const Vec3d target = Vec3d(p[i]) + (Vec3d(p[j]) - Vec3d(p[i])) * along;
    // Star-shaped meshes: everything further out on the line from the middle is outside.
    const double distance = std::array{1.5, 10.0, 1000.0}[k % 3];
    const Vec3f origin(place + normalize(target - place) * (scale * distance));
    const Ray ray{origin, Vec3f(normalize(target - Vec3d(origin)))};
    const ShearedRay sheared(ray.dir);
    // A ray that leaks hits the far side from within: the nearest hit must be on a front.
    TriangleHit nearest{INFINITY, 0, 0, 1};
    const auto ask = [&](int f) {
      const auto& [a, b, c] = mesh.faces[f];
      const auto h = intersect(p[a], p[b], p[c], ray, sheared);
      if (!h) return;
      not_finite += !std::isfinite(h->t) || std::isnan(h->u) || std::isnan(h->v);
      if (h->t < nearest.t) nearest = *h;
    };
    for (const int corner : {i, j}) {
      for (const int f : around[corner]) ask(f);
    }
    // Rounding of a far ray can carry it past all the small triangles around: then it must hit
    // others.
    const bool beside = nearest.cosine > 0;
    for (int f = 0; f < int(mesh.faces.size()) && beside; ++f) ask(f);
    asked_all += beside;
    lost += nearest.cosine > 0;
  }
  EXPECT_LT(asked_all, rays / 100);
  EXPECT_EQ(lost, 0) << "scale " << scale << " place " << length(place) / scale;
  EXPECT_EQ(not_finite, 0);
}

TEST(Triangle, MeshesAreWatertight) {
  constexpr int kRays = if_sanitized(5000, 60000);
  const Mesh round = icosphere(3), rough = spikes(3, 1);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double away : {0.0, 10.0, 1e4}) {
      const Vec3d place = normalize(Vec3d(3, -2, 1)) * (scale * away);
      check_watertight(round, scale, place, kRays, 2);
      check_watertight(rough, scale, place, kRays, 3);
    }
  }
}

TEST(Triangle, TheCosineDistinguishesInFromOut) {
  const Mesh mesh = spikes(2, 4);
  std::mt19937 rng(5);
  for (int k = 0; k < 2000; ++k) {
    // Along the ray, front and back hits alternate, starting with a front.
    const Vec3f origin(random_unit(rng) * 3.0);
    const Ray ray{origin, Vec3f(normalize(random_unit(rng) * 0.02 - Vec3d(origin)))};
    int balance = 0;
    for (const auto& [a, b, c] : mesh.faces) {
      const Triangle t{Vec3f(mesh.points[a]), Vec3f(mesh.points[b]), Vec3f(mesh.points[c])};
      const auto h = hit(t, ray);
      if (!h) continue;
      balance += h->cosine < 0 ? 1 : -1;
      const double cosine = dot(Vec3d(triangle_normal(t)), Vec3d(ray.dir));
      ASSERT_TRUE(std::abs(cosine) < 1e-3 || (h->cosine < 0) == (cosine < 0));
    }
    ASSERT_EQ(balance, 0);
  }
}

TEST(Triangle, DegenerateOnesGiveNoNan) {
  std::mt19937 rng(6);
  int hits = 0;
  for (int k = 0; k < 300000; ++k) {
    const float size = std::array{1e-20f, 1e-12f, 1e-6f, 1.f, 1e6f}[k % 5];
    const Vec3f a = Vec3f(random_unit(rng)) * size, b = Vec3f(random_unit(rng)) * size;
    const Vec3f middle = a + (b - a) * float(uniform(rng, 0, 1));
    const Vec3f c = k % 4 == 0 ? a : k % 4 == 1 ? b : middle;
    const Vec3f target = k % 3 == 0 ? a : middle;
    const Vec3f origin = target - Vec3f(random_unit(rng)) * (size * (k % 7 == 0 ? 1e3f : 2.f));
    const Ray ray{origin, normalize((target - origin) / size)};
    const auto h = hit({a, b, c}, ray);
    if (!h) continue;
    ++hits;
    ASSERT_TRUE(std::isfinite(h->t) && h->u >= 0 && h->v >= 0 && h->u <= 1 && h->v <= 1);
    ASSERT_LE(h->t, length(origin - a) * 1.01f + 4 * size);
  }
  EXPECT_GT(hits, 0);
}

// Small and exactly edge-on, so edge functions are mere rounding: a ray that passes at many times
// their size does not hit them.
TEST(Triangle, EdgeOnAndOffToTheSideIsMissed) {
  std::mt19937 rng(8);
  int hits = 0;
  for (int k = 0; k < if_sanitized(100000, 1000000); ++k) {
    const Vec3d dir = random_unit(rng), aside = normalize(cross(dir, random_unit(rng)));
    const auto corner = [&] {  // in the plane of the ray and `aside`
      return Vec3f(dir * (5 + uniform(rng, 0, 1e-3)) + aside * (1 + uniform(rng, 0, 1e-3)));
    };
    hits += hit({corner(), corner(), corner()}, {{0, 0, 0}, Vec3f(dir)}).has_value();
  }
  EXPECT_EQ(hits, 0);
}

}  // namespace
}  // namespace raio::core
