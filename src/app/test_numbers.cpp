#include "app/test_numbers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/json.h"

namespace raio::core::app {
namespace {

class TestWriter {
 public:
  TestWriter(const Ray& ray, Sides sides, const Vec3d& origin)
      : ray_(ray), sides_(sides), origin_(origin) {}

  TestNumbers take() && { return std::move(out_); }

  // The formulas are those of first_hit() (shape/). C is a centre, P a point, O + t D the ray.
  void write(const Plane& p) {
    out_.formula = "t = N.(P - O) / N.D";
    const Vec3d n(p.normal);
    const double along = dot(n, Vec3d(ray_.dir)),
                 height = dot(n, Vec3d(p.point) - Vec3d(ray_.origin));
    add("N", p.normal), add_place("P", p.point);
    add("N.(P - O)", height), add("N.D", along);
    if (along == 0) return miss("N.D = 0");
    hit_at(float(height / along));
  }

  void write(const Sphere& s) {
    out_.formula = "m = (C - O).D\nh^2 = r^2 - |C - O - m D|^2\nt = m - h > 0, or m + h";
    const Vec3f to_center = s.center - ray_.origin;
    const float m = dot(to_center, ray_.dir);
    const Vec3f offset = to_center - ray_.dir * m;
    const float h2 = s.radius * s.radius - dot(offset, offset);
    add_place("C", s.center), add("r", s.radius), add("m", m), add("h^2", h2);
    chord(m, std::sqrt(h2));
  }

  void write(const Triangle& t) {
    out_.formula =
        "A, B, C = S (P - O) of the corners P, where S D = (0, 0, 1)\n"
        "U = Cx By - Cy Bx\nV = Ax Cy - Ay Cx\nW = Bx Ay - By Ax\n"
        "U, V, W >= 0 or U, V, W <= 0\nb0, b1, b2 = U, V, W / (U + V + W)\n"
        "t = (U Az + V Bz + W Cz) / (U + V + W)";
    const ShearedRay s(ray_.dir);
    const Vec3f a = sheared(t.a, s), b = sheared(t.b, s), c = sheared(t.c, s);
    const float u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
    const float det = u + v + w;
    add_place("P0", t.a), add_place("P1", t.b), add_place("P2", t.c);
    add("A", a), add("B", b), add("C", c);
    add("U", u), add("V", v), add("W", w), add("U + V + W", det);
    if (det != 0) {
      add("b0", u / det), add("b1", v / det), add("b2", w / det);
      const float at = (u * a.z + v * b.z + w * c.z) / det;
      hit_at(at);
    } else {
      miss("U + V + W = 0");
    }
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
      miss("U, V and W differ in their signs");
    else if (det != 0 && !intersect(t.a, t.b, t.c, ray_, s))
      miss("the triangle is seen edge-on, beside the ray");
  }

  void write(const BakedCone& c) {
    out_.formula =
        "X(t) = O + t D - base, z = X.axis\n|X|^2 - z^2 = (r + k z)^2\n"
        "a s^2 + 2 b s + q = 0, t = s + shift\n0 <= z <= height";
    const Vec3d d(ray_.dir), axis(c.axis), from_base = Vec3d(ray_.origin) - Vec3d(c.base);
    const double k = c.slope;
    const double shift = -dot(from_base - axis * (0.5 * double(c.height)), d) / dot(d, d);
    const Vec3d o = from_base + d * shift;
    const double oz = dot(o, axis), dz = dot(d, axis);
    const Vec3d o_across = o - axis * oz, d_across = d - axis * dz;
    const double o_r = double(c.base_radius) + k * oz, d_r = k * dz;
    const double a = dot(d_across, d_across) - d_r * d_r;
    const double b = dot(o_across, d_across) - o_r * d_r;
    const double q = dot(o_across, o_across) - o_r * o_r;
    add_place("base", c.base), add("axis", c.axis), add("height", c.height);
    add("r", c.base_radius), add("k", c.slope), add("shift", shift);
    add("a", a), add("b", b), add("q", q);
    const ConeRoots roots = cone_roots(c, ray_);
    if (a != 0 && b * b - a * q < 0) return miss("b^2 - a q < 0");
    if (roots.count == 0) return miss("z is outside of 0..height");
    int root = 0;
    while (root + 1 < roots.count && !(roots.t[root] > 0 && visible(sides_, roots.cosine[root])))
      ++root;
    hit_at(roots.t[root]);
  }

  void write(const BakedEllipsoid& e) {
    out_.formula =
        "O' = M (O - C), D' = M D\nm = -O'.D' / D'.D'\n"
        "h^2 = (1 - |O' + m D'|^2) / D'.D'\nt = m - h > 0, or m + h";
    const Vec3d from_center = Vec3d(ray_.origin) - Vec3d(e.center), dir(ray_.dir);
    Vec3d o, d;
    for (int i = 0; i < 3; ++i)
      o[i] = dot(from_center, Vec3d(e.to_unit[i])), d[i] = dot(dir, Vec3d(e.to_unit[i]));
    const double per_unit = dot(d, d), m = -dot(o, d) / per_unit;
    const Vec3d nearest = o + d * m;
    const double h2 = (1 - dot(nearest, nearest)) / per_unit;
    add_place("C", e.center);
    add("M, row 1", e.to_unit[0]), add("M, row 2", e.to_unit[1]), add("M, row 3", e.to_unit[2]);
    add("O'", o), add("D'", d), add("m", m), add("h^2", h2);
    chord(m, std::sqrt(h2));
  }

  void write(const Disc& disc) {
    out_.formula = "t = N.(C - O) / N.D\nr_in <= |O + t D - C| <= r";
    const Vec3d n(disc.normal), dir(ray_.dir), to_center = Vec3d(disc.center) - Vec3d(ray_.origin);
    const double along = dot(n, dir), height = dot(n, to_center), t = height / along;
    add_place("C", disc.center), add("N", disc.normal), add("r_in", disc.inner);
    add("r", disc.radius), add("N.(C - O)", height), add("N.D", along);
    if (along == 0) return miss("N.D = 0");
    const double distance = length(dir * t - to_center);
    add("|O + t D - C|", distance);
    hit_at(float(t));
    if (distance > double(disc.radius)) miss("|O + t D - C| > r");
    if (distance < double(disc.inner)) miss("|O + t D - C| < r_in");
  }

  void write(const MovingSphere& s) {
    out_.formula =
        "C = C0 + (C1 - C0) (time - t0) / (t1 - t0)\nm = (C - O).D\n"
        "h^2 = r^2 - |C - O - m D|^2\nt = m - h > 0, or m + h";
    const Vec3d center = center_at(s, ray_.time), dir(ray_.dir);
    const Vec3d to_center = center - Vec3d(ray_.origin);
    const double dir2 = dot(dir, dir), m = dot(to_center, dir) / dir2, r = s.radius;
    const Vec3d offset = to_center - dir * m;
    const double h2 = r * r - dot(offset, offset);
    add_place("C0", s.center), add_place("C1", s.to), moves(s.begin, s.end);
    add("C", center + origin_), add("r", s.radius), add("m", m), add("h^2", h2);
    chord(m, std::sqrt(h2 / dir2));
  }

  void write(const MovingTriangle& t) {
    out_.formula =
        "A = A0 + (A1 - A0) (time - t0) / (t1 - t0) - O, and the same for B and C\n"
        "U = (C x B).D, V = (A x C).D, W = (B x A).D\nU, V, W >= 0 or U, V, W <= 0\n"
        "b0, b1, b2 = U, V, W / (U + V + W)\nt = (b0 A + b1 B + b2 C).D";
    const double part = part_moved(t.begin, t.end, ray_.time);
    const Vec3d dir(ray_.dir), from(ray_.origin);
    const Vec3d a = between(t.from.a, t.to.a, part) - from,
                b = between(t.from.b, t.to.b, part) - from,
                c = between(t.from.c, t.to.c, part) - from;
    const double u = dot(cross(c, b), dir), v = dot(cross(a, c), dir), w = dot(cross(b, a), dir);
    const double det = u + v + w;
    moves(t.begin, t.end);
    add("A", a), add("B", b), add("C", c);
    add("U", u), add("V", v), add("W", w), add("U + V + W", det);
    if (det == 0) return miss("U + V + W = 0");
    add("b0", u / det), add("b1", v / det), add("b2", w / det);
    hit_at(float(dot((a * u + b * v + c * w) / det, dir) / dot(dir, dir)));
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0))
      miss("U, V and W differ in their signs");
  }

 private:
  void add(const char* name, float x) { out_.values.push_back({name, {plain(x)}}); }
  void add(const char* name, double x) { out_.values.push_back({name, {x}}); }
  template <class T>
  void add(const char* name, const Vec3<T>& v) {
    out_.values.push_back({name, {plain(v.x), plain(v.y), plain(v.z)}});
  }
  void add_place(const char* name, Vec3f p) { add(name, origin_ + plain(p)); }
  void moves(float begin, float end) { add("t0", begin), add("t1", end), add("time", ray_.time); }
  void miss(const char* condition) { out_.miss = condition; }

  Vec3f sheared(Vec3f p, const ShearedRay& s) const {
    p = p - ray_.origin;
    return {p[s.kx] - s.sx * p[s.kz], p[s.ky] - s.sy * p[s.kz], s.sz * p[s.kz]};
  }

  void hit_at(float t) {
    add("t", t);
    if (!(t > 0)) miss("t <= 0");
    if (t >= ray_.tmax) miss("t >= tMax");
  }
  // A ray through a closed surface between m - half and m + half.
  template <class T>
  void chord(T m, T half) {
    if (!(half >= 0)) return miss("h^2 < 0");
    add("h", half);
    const auto entry = float(m - half);
    hit_at(entry > 0 && visible(sides_, -1) ? entry : float(m + half));
  }

  const Ray& ray_;
  Sides sides_;
  Vec3d origin_;
  TestNumbers out_;
};

}  // namespace

TestNumbers test_numbers(const Geometry& geometry, PrimitiveId primitive, const Ray& ray) {
  return with_kind(geometry.kind_of(primitive), [&]<PrimitiveKind kind> {
    const uint32_t index = geometry.index_of(kind, primitive);
    TestWriter writer(ray, geometry.sides_of(kind, index), geometry.scene().origin);
    writer.write(geometry.get<kind>(index));
    return std::move(writer).take();
  });
}

}  // namespace raio::core::app
