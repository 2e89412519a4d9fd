#include "shape/polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/box.h"

namespace raio::core {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

struct Point {
  double x = 0, y = 0;
  friend bool operator==(const Point&, const Point&) = default;
};

/// Twice the signed area; positive if a, b, c are counter-clockwise. Exact for floats of similar
/// magnitude: the products of their differences fit in a double.
double orient(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Twice the vector area. Vertices are relative to the first, which preserves the precision of a
/// small polygon far from the origin.
Vec3d newell(std::span<const Vec3f> corners) {
  Vec3d sum;
  if (corners.size() < 3) return sum;
  const Vec3d first(corners[0]);
  Vec3d a = Vec3d(corners[1]) - first;
  for (size_t i = 2; i < corners.size(); ++i) {
    const Vec3d b = Vec3d(corners[i]) - first;
    sum += cross(a, b);
    a = b;
  }
  return sum;
}

/// The projection along the coordinate axis nearest to the normal, seen from the side where the
/// vertices are counter-clockwise: areas shrink least, and no coordinate is rounded.
struct Projection {
  int u = 0, v = 1;

  explicit Projection(std::span<const Vec3f> corners) {
    const Vec3d normal = newell(corners);
    int axis = max_axis(abs(normal));
    if (normal == Vec3d()) {  // collinear, or loops that cancel: project along the shortest side
      Box3d box;
      for (const Vec3f& p : corners) box.extend(Vec3d(p));
      axis = max_axis(-box.size());
    }
    u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
  }

  Point operator()(const Vec3f& p) const { return {p[u], p[v]}; }
};

/// Chooses the diagonal with the larger smaller triangle: the inner one in a concave quadrilateral,
/// and no degenerate triangle without need.
Triangles split_quad(std::span<const Vec3f> corners) {
  const Projection project(corners);
  const Point a = project(corners[0]), b = project(corners[1]), c = project(corners[2]),
              d = project(corners[3]);
  const double by_ac = std::min(orient(a, b, c), orient(c, d, a));
  const double by_bd = std::min(orient(b, c, d), orient(d, a, b));
  if (by_ac >= by_bd) return {{0, 1, 2}, {2, 3, 0}};
  return {{1, 2, 3}, {3, 0, 1}};
}

/// Whether it is strictly convex: every vertex turns left, and only one is rightmost, so the
/// outline turns once.
bool is_convex(std::span<const Point> p) {
  const size_t n = p.size();
  const auto left_of = [](Point a, Point b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
  int rightmost = 0;
  Point before = p[n - 2], at = p[n - 1];
  for (const Point& after : p) {
    if (!(orient(before, at, after) > 0)) return false;
    rightmost += left_of(before, at) && left_of(after, at);
    before = at, at = after;
  }
  return rightmost == 1;
}

/// Cuts the vertices first..last of a convex polygon off along their chord, halving the run each
/// time: no fan of slivers, and logarithmic depth.
void split_run(uint32_t first, uint32_t last, Triangles& out) {
  if (last - first < 2) return;
  const uint32_t middle = first + (last - first) / 2;
  out.push_back({first, middle, last});
  split_run(first, middle, out);
  split_run(middle, last, out);
}

/// Clips ears off a ring of vertices until a triangle is left.
///
/// An ear is a vertex that turns left and has no other vertex in its triangle. Only vertices that
/// do not turn left can be inside; these are kept in a uniform grid. Clipping elsewhere never makes
/// an ear of a vertex, so each is tested once, and again only when a neighbour is cut: at most 3 n
/// tests. Once a neighbour is cut, a vertex waits for the next round: each round halves a convex
/// stretch, where clipping in order would produce a fan.
///
/// Polygons that touch or cross themselves can run out of ears. Then the requirements are lowered
/// for one cut (see `Demand`), in a search that resumes where the last one ended and has limited
/// patience.
class EarCutter {
 public:
  EarCutter(std::span<const Point> points, Triangles& out)
      : p_(points), out_(out), left_(points.size()), links_(points.size()) {
    const uint32_t n = uint32_t(points.size());
    for (uint32_t i = 0; i < n; ++i) {
      links_[i].before = i == 0 ? n - 1 : i - 1;
      links_[i].after = i + 1 == n ? 0 : i + 1;
    }
    make_grid();
    for (uint32_t i = 0; i < n; ++i) update(i);
  }

  void run() {
    const size_t n = p_.size();
    std::vector<uint32_t> round(n), next;
    for (uint32_t i = 0; i < n; ++i) round[i] = i;
    next.reserve(n);
    size_t patience = 8 * n;
    uint32_t cursor = 0;
    for (uint32_t number = 1; left_ > 3; ++number) {
      for (const uint32_t b : round) {
        if (links_[b].cut || links_[b].touched == number) continue;
        if (!is_ear(b, Demand::proper)) continue;
        cut(b, number, next);
        if (left_ == 3) break;
      }
      if (next.empty() && left_ > 3) {
        cursor = least_bad(cursor, patience);
        cut(cursor, number, next);
      }
      round.swap(next);
      next.clear();
    }
    uint32_t last = 0;
    while (links_[last].cut) ++last;
    out_.push_back({links_[last].before, last, links_[last].after});
  }

 private:
  static constexpr uint32_t kNone = 0xffffffffu;

  struct Link {
    uint32_t before = 0, after = 0;
    uint32_t next_in_cell = kNone;
    uint32_t touched = 0;  // the last round that cut a neighbour
    bool cut = false;
    bool blunt = false;  // does not turn left
    bool in_grid = false;
  };

  /// Requirements on a vertex to be cut, from the strictest. `proper`: it turns left and its closed
  /// triangle is empty, or it repeats another or is the tip of a spike, without area. `touching`:
  /// its open triangle is empty, or it is straight. `convex`: it turns left. `none`: nothing.
  enum class Demand { proper, touching, convex, none };

  double turn(uint32_t b) const { return orient(p_[links_[b].before], p_[b], p_[links_[b].after]); }

  bool is_ear(uint32_t b, Demand demand) {
    if (demand == Demand::none) return true;
    const double area = turn(b);
    if (area == 0) {
      if (demand == Demand::touching) return true;
      const Point a = p_[links_[b].before], m = p_[b], c = p_[links_[b].after];
      return demand == Demand::proper && (m.x - a.x) * (c.x - m.x) + (m.y - a.y) * (c.y - m.y) <= 0;
    }
    if (!(area > 0)) return false;
    return demand == Demand::convex || is_free(b, demand == Demand::proper);
  }

  /// The next vertex around the ring that satisfies the strictest requirement any vertex satisfies;
  /// when the patience is used up, the next vertex.
  uint32_t least_bad(uint32_t cursor, size_t& patience) {
    while (links_[cursor].cut) cursor = links_[cursor].after;
    for (const Demand demand : {Demand::touching, Demand::convex}) {
      for (size_t i = 0; i < left_ && patience > 0; ++i, --patience) {
        if (is_ear(cursor, demand)) return cursor;
        cursor = links_[cursor].after;
      }
    }
    return cursor;
  }

  void cut(uint32_t b, uint32_t round, std::vector<uint32_t>& next) {
    const uint32_t a = links_[b].before, c = links_[b].after;
    out_.push_back({a, b, c});
    links_[b].cut = true;
    links_[a].after = c;
    links_[c].before = a;
    --left_;
    for (const uint32_t neighbour : {a, c}) {
      update(neighbour);
      Link& link = links_[neighbour];
      if (link.touched != round) next.push_back(neighbour);
      link.touched = round;
    }
  }

  // A grid over the bounding rectangle with about one cell per blunt vertex. A cell is a list
  // linked through the vertices; searches drop vertices that are cut or turn left by now.

  void make_grid() {
    Point lo = p_[0], hi = p_[0];
    size_t blunt = 0;
    for (uint32_t i = 0; i < p_.size(); ++i) {
      lo = {std::min(lo.x, p_[i].x), std::min(lo.y, p_[i].y)};
      hi = {std::max(hi.x, p_[i].x), std::max(hi.y, p_[i].y)};
      blunt += !(turn(i) > 0);
    }
    side_ = std::max(1, int(std::sqrt(double(blunt))));
    lo_ = lo;
    per_x_ = hi.x > lo.x ? side_ / (hi.x - lo.x) : 0;
    per_y_ = hi.y > lo.y ? side_ / (hi.y - lo.y) : 0;
    cells_.assign(size_t(side_) * side_, kNone);
  }

  Point in_cells(Point p) const { return {(p.x - lo_.x) * per_x_, (p.y - lo_.y) * per_y_}; }
  int clamped(double cell) const { return std::clamp(int(cell), 0, side_ - 1); }

  void update(uint32_t i) {
    Link& link = links_[i];
    link.blunt = !(turn(i) > 0);
    if (!link.blunt || link.in_grid) return;
    const Point g = in_cells(p_[i]);
    uint32_t& head = cells_[size_t(clamped(g.y)) * side_ + clamped(g.x)];
    link.next_in_cell = std::exchange(head, i);
    link.in_grid = true;
  }

  /// Whether the triangle of vertex b contains no blunt vertex. Visits the cells that the triangle
  /// touches, row by row.
  bool is_free(uint32_t b, bool closed) {
    const std::array<Point, 3> g{in_cells(p_[links_[b].before]), in_cells(p_[b]),
                                 in_cells(p_[links_[b].after])};
    // In cells; far above the rounding of coordinates here (2^-52 of at most some thousands).
    constexpr double kSlack = 1e-6;
    constexpr double kFlat =
        1e-3;  // intersections of edges and rows are not computed below this slope
    const int first = clamped(std::min({g[0].y, g[1].y, g[2].y}) - kSlack);
    const int last = clamped(std::max({g[0].y, g[1].y, g[2].y}) + kSlack);
    for (int row = first; row <= last; ++row) {
      // The interval of each edge within the row.
      double from = side_, to = 0;
      for (int i = 0; i < 3; ++i) {
        Point s = g[i], e = g[(i + 1) % 3];
        if (s.y > e.y) std::swap(s, e);
        if (e.y < row - kSlack || s.y > row + 1 + kSlack) continue;
        if (e.y - s.y < kFlat) {
          from = std::min({from, s.x, e.x}), to = std::max({to, s.x, e.x});
          continue;
        }
        const double slope = (e.x - s.x) / (e.y - s.y);
        const double x0 = s.y < row ? s.x + (row - s.y) * slope : s.x;
        const double x1 = e.y > row + 1 ? e.x - (e.y - (row + 1)) * slope : e.x;
        from = std::min({from, x0, x1});
        to = std::max({to, x0, x1});
      }
      const int end = clamped(to + kSlack);
      for (int column = clamped(from - kSlack); column <= end; ++column) {
        if (is_cell_blocked(cells_[size_t(row) * side_ + column], b, closed)) return false;
      }
    }
    return true;
  }

  bool is_cell_blocked(uint32_t& head, uint32_t b, bool closed) {
    for (uint32_t* link = &head; *link != kNone;) {
      const uint32_t i = *link;
      if (links_[i].cut || !links_[i].blunt) {
        *link = links_[i].next_in_cell;
        links_[i].in_grid = false;
        continue;
      }
      if (blocks(i, b, closed)) return true;
      link = &links_[i].next_in_cell;
    }
    return false;
  }

  /// Whether vertex i prevents cutting off vertex b.
  bool blocks(uint32_t i, uint32_t b, bool closed) const {
    const uint32_t ia = links_[b].before, ic = links_[b].after;
    if (i == ia || i == b || i == ic) return false;
    const Point q = p_[i], a = p_[ia], m = p_[b], c = p_[ic];
    const double u = orient(a, m, q), v = orient(m, c, q), w = orient(c, a, q);
    if (!closed) return u > 0 && v > 0 && w > 0;
    if (u < 0 || v < 0 || w < 0) return false;
    // At the same place as a vertex of the triangle: blocks if an edge leads into the triangle.
    if (q == a) return leads_between(i, m, c);
    if (q == m) return leads_between(i, c, a);
    if (q == c) return leads_between(i, a, m);
    return true;
  }

  /// Whether an edge of vertex i lies between the directions to `from` and, counter-clockwise, to
  /// `to`, or everything between them is outside the polygon at vertex i.
  bool leads_between(uint32_t i, Point from, Point to) const {
    const Point q = p_[i], before = p_[links_[i].before], after = p_[links_[i].after];
    const auto between = [&](Point x) { return orient(q, from, x) > 0 && orient(q, x, to) > 0; };
    const auto same_way = [&](Point x, Point y) {
      return orient(q, x, y) == 0 && (x.x - q.x) * (y.x - q.x) + (x.y - q.y) * (y.y - q.y) > 0;
    };
    return between(before) || between(after) || (same_way(before, from) && same_way(after, to));
  }

  std::span<const Point> p_;
  Triangles& out_;
  size_t left_;
  std::vector<Link> links_;
  std::vector<uint32_t> cells_;
  int side_ = 1;
  Point lo_;
  double per_x_ = 0, per_y_ = 0;
};

}  // namespace

Vec3f polygon_normal(std::span<const Vec3f> corners) {
  const Vec3d sum = newell(corners);
  const double len = length(sum);
  return len > 0 ? Vec3f(sum / len) : Vec3f();
}

std::vector<std::array<uint32_t, 3>> triangulate(std::span<const Vec3f> corners) {
  const size_t n = corners.size();
  if (n < 3) return {};
  if (n == 3) return {{0, 1, 2}};
  if (n == 4) return split_quad(corners);

  const Projection project(corners);
  std::vector<Point> points(n);
  std::ranges::transform(corners, points.begin(), project);
  Triangles out;
  out.reserve(n - 2);
  if (is_convex(points)) {
    const uint32_t third = uint32_t(n / 3), two_thirds = uint32_t(2 * n / 3), end = uint32_t(n);
    out.push_back({0, third, two_thirds});
    split_run(0, third, out);
    split_run(third, two_thirds, out);
    split_run(two_thirds, end, out);
    for (auto& triangle : out) {
      if (triangle[2] == end) triangle[2] = 0;
    }
  } else {
    EarCutter(points, out).run();
  }
  return out;
}

}  // namespace raio::core
