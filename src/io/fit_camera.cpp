#include "io/fit_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/exact_math.h"
#include "scene/enclosing.h"

namespace raio::core {
namespace {

constexpr double kFovDeg = 25;  // a long lens, as for portraits
constexpr double kMargin = 1.06;
constexpr double kRadians = std::numbers::pi / 180;

struct Moments {
  double count = 0;
  Vec3d sum;
  std::array<double, 6> squares{};  // xx xy xz yy yz zz

  void join(const Moments& b) {
    count += b.count, sum = sum + b.sum;
    for (size_t i = 0; i < squares.size(); ++i) squares[i] += b.squares[i];
  }
};

/// The eigenvectors of the covariance, largest eigenvalue first. Jacobi 1846; three rows take a few
/// sweeps. Nothing if the extent is the same in all directions, as for a crystal: then they would
/// be mere rounding errors.
std::optional<std::array<Vec3d, 3>> principal_axes(const Moments& m) {
  const Vec3d mean = m.sum / m.count;
  const auto entry = [&](size_t place, double a, double b) {
    return m.squares[place] / m.count - a * b;
  };
  double a[3][3] = {{entry(0, mean.x, mean.x), entry(1, mean.x, mean.y), entry(2, mean.x, mean.z)},
                    {0, entry(3, mean.y, mean.y), entry(4, mean.y, mean.z)},
                    {0, 0, entry(5, mean.z, mean.z)}};
  a[1][0] = a[0][1], a[2][0] = a[0][2], a[2][1] = a[1][2];
  std::array<Vec3d, 3> axes = {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  for (int sweep = 0; sweep < 32; ++sweep)
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      if (std::abs(a[p][q]) <= 1e-14 * (std::abs(a[p][p]) + std::abs(a[q][q]))) continue;
      const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const double t = std::copysign(1, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      for (auto& row : a) {
        const double x = row[p], y = row[q];
        row[p] = c * x - s * y, row[q] = s * x + c * y;
      }
      for (int k = 0; k < 3; ++k) {
        const double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
      }
      const Vec3d x = axes[size_t(p)], y = axes[size_t(q)];
      axes[size_t(p)] = x * c - y * s, axes[size_t(q)] = x * s + y * c;
    }
  std::array<int, 3> order = {0, 1, 2};
  std::ranges::sort(
      order, [&](int x, int y) { return a[x][x] > a[y][y] || (a[x][x] == a[y][y] && x < y); });
  if (m.count > 3 && a[order[2]][order[2]] > 0.95 * a[order[0]][order[0]]) return std::nullopt;
  std::array<Vec3d, 3> out;
  for (size_t i = 0; i < 3; ++i) {
    const Vec3d v = axes[size_t(order[i])];
    // Of both signs, the one that does not depend on how the axes were found.
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    const double sign = std::abs(v.x) > 0.99 * largest   ? v.x
                        : std::abs(v.y) > 0.99 * largest ? v.y
                                                         : v.z;
    out[i] = sign < 0 ? v * -1.0 : v;
  }
  return out;
}

/// What the picture must contain, above the middle, below it and on each side: the required
/// distances of the edges, at the camera.
struct Needs {
  double above = -std::numeric_limits<double>::infinity(), below = above, right = above,
         left = above;

  void join(const Needs& b) {
    above = std::max(above, b.above), below = std::max(below, b.below);
    right = std::max(right, b.right), left = std::max(left, b.left);
  }
};

/// Tangents of half the required angles.
struct Tangents {
  double up = 0, across = 0;

  void join(const Tangents& b) { up = std::max(up, b.up), across = std::max(across, b.across); }
};

/// The picture's axes in space.
struct PictureAxes {
  Vec3d right, up, forward;
  Vec3d upright;  // up in the data, so that the camera is upright elsewhere, too
};

PictureAxes axes_towards(Vec3d forward, Vec3d up) {
  const Vec3d right = normalize(cross(forward, up));
  return {right, cross(right, forward), forward, up};
}

PictureAxes three_quarter(Vec3d up) {
  const Frame<double> frame(up);  // two axes of the data perpendicular to the vertical one
  return axes_towards(normalize(up * 0.55 + frame.u * 0.45 - frame.v * 0.9) * -1.0, up);
}

PictureAxes axes_from(Side side, Vec3d up) {
  const Vec3d axis = std::abs(up.x) > 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0);
  const Vec3d right = normalize(axis - up * dot(axis, up)), front = cross(right, up);
  switch (side) {
    case Side::front:
      break;
    case Side::back:
      return axes_towards(front, up);
    case Side::left:
      return axes_towards(right, up);
    case Side::right:
      return axes_towards(right * -1.0, up);
    case Side::top:
      return axes_towards(up * -1.0, front * -1.0);
    case Side::bottom:
      return axes_towards(up, front);
    case Side::iso:
      return axes_towards(normalize(front + right + up) * -1.0, up);
  }
  return axes_towards(front * -1.0, up);
}

// The angle of a picture with at least this half angle.
float degrees(double tangent) {
  return std::clamp(float(2 * exact_atan(tangent * kMargin) / kRadians), 0.01f, 170.0f);
}

Vec3d middle_of(const Box3f& box) { return (Vec3d(box.lo) + Vec3d(box.hi)) * 0.5; }

/// Spheres that enclose a scene.
struct Places {
  struct Place {
    Vec3f center;
    float radius;
  };
  std::vector<Place> all;

  void join(const Places& b) { all.insert(all.end(), b.all.begin(), b.all.end()); }
};

struct Extent {
  Box3f box;

  void add(Vec3f center, float radius) {
    box.extend(center - Vec3f(radius)), box.extend(center + Vec3f(radius));
  }
  void join(const Extent& b) { box.extend(b.box); }
};

/// The part of a scene that a camera is fitted to.
class Shown {
 public:
  Shown(const Scene& scene, Fit fit) : scene_(scene) {
    if (fit == Fit::most) most_ = most_of(scene);
  }

  /// sum_up() of this part.
  template <class Sum, class Add>
  Sum sum(const Add& add) const {
    if (!most_) return sum_up<Sum>(scene_, add);
    return sum_up<Sum>(scene_, [&](Sum& sum, Vec3f center, float radius) {
      if (most_->has(center, radius)) add(sum, center, radius);
    });
  }

  Box3f box() const {
    if (!most_) return bounds(scene_);
    return sum<Extent>([](Extent& e, Vec3f center, float radius) { e.add(center, radius); }).box;
  }

 private:
  const Scene& scene_;
  std::optional<MostOfScene> most_;
};

Camera fitted_in_parallel(const Shown& shown, const Camera& camera) {
  const Vec3d at(camera.at), view = at - Vec3d(camera.from), forward = normalize(view);
  const Vec3d right = normalize(cross(forward, Vec3d(camera.up))), up = cross(right, forward);
  const auto needs = shown.sum<Needs>([&](Needs& n, Vec3f center, float radius) {
    const Vec3d c = Vec3d(center) - at;
    const double x = dot(c, right), y = dot(c, up), r = double(radius);
    n.join({r + y, r - y, r + x, r - x});
  });
  if (!std::isfinite(needs.above)) return camera;
  const Vec3d to_middle =
      right * ((needs.right - needs.left) / 2) + up * ((needs.above - needs.below) / 2);
  Camera out = camera;
  out.from = Vec3f(Vec3d(camera.from) + to_middle), out.at = Vec3f(at + to_middle);
  out.fov_deg = degrees((needs.above + needs.below) / (2 * length(view)));
  out.horizontal_fov_deg = degrees((needs.right + needs.left) / (2 * length(view)));
  return out;
}

// Moves the camera so that a picture with these axes contains `shown`, with the bounds `box`. The
// vertical angle, 0 for that of a long lens, determines the distance.
Camera fitted(const Shown& shown, const Box3f& box, Camera camera, const PictureAxes& axes,
              float fov_deg = 0) {
  camera.movement.reset();
  const auto& [to_right, to_up, forward, upright] = axes;
  const Vec3d middle = middle_of(box);
  const double angle = fov_deg > 0 ? double(fov_deg) : kFovDeg;
  const double tangent = exact_tan(angle / 2 * kRadians) / kMargin;
  const double across = camera.width > 0 ? tangent * camera.width / camera.height : tangent;
  const double secant = std::sqrt(1 + tangent * tangent),
               secant_across = std::sqrt(1 + across * across);
  // A sphere at (x, y, z), seen from a distance D of the middle, stays below the upper edge if y +
  // radius / cos <= (D + z) tan, and so on.
  const auto needs = shown.sum<Needs>([&](Needs& n, Vec3f center, float radius) {
    const Vec3d c = Vec3d(center) - middle;
    const double x = dot(c, to_right), y = dot(c, to_up), z = dot(c, forward);
    const double high = double(radius) * secant - z * tangent,
                 wide = double(radius) * secant_across - z * across;
    n.join({high + y, high - y, wide + x, wide - x});
  });
  double distance = std::max((needs.above + needs.below) / (2 * tangent),
                             (needs.right + needs.left) / (2 * across));
  const double size = length(Vec3d(box.hi) - Vec3d(box.lo));
  // More than the spacing of floats, 1e-45 at the origin.
  const double apart = std::max(1e-4 * max_component(abs(middle)), 1e-30);
  distance = std::max({distance, size > 0 ? size * 1e-3 : 1.0, apart});
  const Vec3d at = middle + to_right * ((needs.right - needs.left) / 2) +
                   to_up * ((needs.above - needs.below) / 2);
  const Vec3d from = at - forward * distance;
  const auto tangents = shown.sum<Tangents>([&](Tangents& t, Vec3f center, float radius) {
    const Vec3d c = Vec3d(center) - from;
    const double x = std::abs(dot(c, to_right)), y = std::abs(dot(c, to_up)), r = double(radius),
                 z = std::max(dot(c, forward), 1e-6 * distance);
    t.join({(y + r * secant) / z, (x + r * secant_across) / z});
  });
  camera.from = Vec3f(from), camera.at = Vec3f(at), camera.up = Vec3f(upright);
  camera.fov_deg = degrees(tangents.up), camera.horizontal_fov_deg = degrees(tangents.across);
  return camera.is_parallel() ? fitted_in_parallel(shown, camera) : camera;
}

}  // namespace

void fit_camera(Scene& scene, FitView view, Vec3f up) {
  if (scene.camera.width == 0) scene.camera.width = 1200, scene.camera.height = 900;
  const Box3f box = bounds(scene);
  if (box.empty()) return;
  std::optional<std::array<Vec3d, 3>> axes;
  if (view == FitView::principal) {
    const Vec3d middle = middle_of(box);
    auto moments = sum_up<Moments>(scene, [&](Moments& m, Vec3f center, float) {
      const Vec3d c = Vec3d(center) - middle;
      m.count += 1, m.sum = m.sum + c;
      const std::array<double, 6> by = {c.x * c.x, c.x * c.y, c.x * c.z,
                                        c.y * c.y, c.y * c.z, c.z * c.z};
      for (size_t i = 0; i < by.size(); ++i) m.squares[i] += by[i];
    });
    axes = principal_axes(moments);
  }
  scene.camera = fitted(Shown(scene, Fit::all), box, scene.camera,
                        axes ? axes_towards(cross((*axes)[1], (*axes)[0]), (*axes)[1])
                             : three_quarter(normalize(Vec3d(up))));
}

void fit_camera_to_cell(Scene& scene, const std::array<Vec3d, 3>& sides, bool is_flat) {
  if (scene.camera.width == 0) scene.camera.width = 1200, scene.camera.height = 900;
  const Box3f box = bounds(scene);
  if (box.empty()) return;
  const Vec3d up = normalize(sides[2]);
  const Vec3d across = length(sides[1]) > length(sides[0]) ? sides[1] : sides[0];
  const Vec3d right = normalize(across - up * dot(across, up)), front = cross(right, up);
  scene.camera =
      fitted(Shown(scene, Fit::all), box, scene.camera,
             is_flat ? axes_towards(up * -1.0, front * -1.0)
                     : axes_towards(normalize(front + right * 0.3 + up * 0.22) * -1.0, up));
}

MostOfScene most_of(const Scene& scene) {
  constexpr size_t kEnough = size_t(1) << 16;
  // Odd, unlike the row lengths of many lattices.
  const size_t every = (scene.primitive_count() / kEnough) | 1;
  const auto keep = [](Places& p, Vec3f c, float radius) { p.all.push_back({c, radius}); };
  auto places = sum_up<Places>(scene, keep, every).all;
  MostOfScene out;
  if (places.empty()) return out;
  const auto quantile = [&](double part, const auto& of) {
    const auto at = places.begin() + std::ptrdiff_t(std::ceil(part * double(places.size() - 1)));
    std::ranges::nth_element(places, at, {}, of);
    return of(*at);
  };
  for (int axis = 0; axis < 3; ++axis)
    out.center[axis] = quantile(0.5, [&](const auto& p) { return p.center[axis]; });
  const auto reach = [&](const Places::Place& p) {
    return length(Vec3d(p.center) - Vec3d(out.center)) + double(p.radius);
  };
  out.radius = kFarAway * quantile(0.75, reach);
  // Three quarters coincide: no distance tells which of the others are strays.
  if (out.radius == 0) out.radius = std::numeric_limits<double>::infinity();
  Extent inside;
  for (const Places::Place& p : places)
    if (reach(p) <= out.radius) inside.add(p.center, p.radius);
  const double size = length(Vec3d(inside.box.size()));
  if (size > 0) out.shrinks = length(Vec3d(bounds(scene).size())) / size;
  return out;
}

double part_outside(const Scene& scene, const MostOfScene& most) {
  struct Counts {
    size_t all = 0, outside = 0;

    void join(const Counts& b) { all += b.all, outside += b.outside; }
  };
  const auto counts = sum_up<Counts>(scene, [&](Counts& n, Vec3f center, float radius) {
    ++n.all, n.outside += !most.has(center, radius);
  });
  return counts.all > 0 ? double(counts.outside) / double(counts.all) : 0;
}

Camera fitted_from(const Scene& scene, const Camera& camera, std::optional<Side> side, Vec3f up,
                   Fit fit, float fov_deg) {
  const Shown shown(scene, fit);
  const Box3f box = shown.box();
  if (box.empty()) return camera;
  const Vec3d to_up = normalize(Vec3d(up));
  return fitted(shown, box, camera, side ? axes_from(*side, to_up) : three_quarter(to_up), fov_deg);
}

Camera fitted_along(const Scene& scene, const Camera& camera, Fit fit, float fov_deg) {
  const Shown shown(scene, fit);
  const Box3f box = shown.box();
  if (box.empty()) return camera;
  const Vec3d view = Vec3d(camera.at) - Vec3d(camera.from);
  return fitted(shown, box, camera, axes_towards(normalize(view), Vec3d(camera.up)), fov_deg);
}

Vec3f nearest_axis(Vec3f direction) {
  int longest = 0;
  for (const int axis : {1, 2})
    if (std::abs(direction[axis]) > std::abs(direction[longest])) longest = axis;
  Vec3f out;
  out[longest] = std::copysign(1.0f, direction[longest]);
  return out;
}

Camera fitted_in_parallel(const Scene& scene, const Camera& camera) {
  return fitted_in_parallel(Shown(scene, Fit::all), camera);
}

float fitted_fov_deg(const Camera& camera, int width, int height) {
  if (camera.horizontal_fov_deg <= 0) return camera.fov_deg;
  const double half = exact_tan(double(camera.horizontal_fov_deg) / 2 * kRadians) * height / width;
  return std::max(camera.fov_deg, float(2 * exact_atan(half) / kRadians));
}

float fitted_fov_deg(const Camera& camera) {
  const bool has_size = camera.width > 0 && camera.height > 0;
  return has_size ? fitted_fov_deg(camera, camera.width, camera.height) : camera.fov_deg;
}

}  // namespace raio::core
