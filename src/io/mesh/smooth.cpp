#include "io/mesh/smooth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "base/exact_math.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

constexpr TriangleIndices kFlatTriangle{kNoNormal, kNoNormal, kNoNormal};

// Numbers distinct positions, in the order of x, y and z, and returns the number of each vertex.
std::vector<uint32_t> places_of(const Array<Vec3f>& positions, uint32_t& count) {
  std::vector<uint32_t> order(positions.size()), place(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
    const Vec3f &p = positions[a], &q = positions[b];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
  });
  count = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    count += i == 0 || positions[order[i]] != positions[order[i - 1]];
    place[order[i]] = count - 1;
  }
  return place;
}

class Smoother {
 public:
  Smoother(Mesh& mesh, float least_cosine) : mesh_(mesh), least_cosine_(least_cosine) {}

  bool smooth() {
    const size_t count = mesh_.triangles.size();
    if (count == 0 || count >= kNoNormal / 3) return false;
    areas_.resize(count), units_.resize(count), corners_.resize(3 * count);
    for_each_index(count, [&](size_t i) {
      const auto [a, b, c] = mesh_.triangles[i];
      const Vec3d at(mesh_.positions[a]);
      areas_[i] = cross(Vec3d(mesh_.positions[b]) - at, Vec3d(mesh_.positions[c]) - at);
      const double area = length(areas_[i]);
      units_[i] = area > 0 ? areas_[i] / area : Vec3d();
    });
    find_neighbours();
    for_each_index(first_.size() - 1, [&](size_t place) { smooth_around(place); });
    return store();
  }

 private:
  // Lists the corners (3 triangle + corner) around each position, in the order of the file.
  void find_neighbours() {
    uint32_t places = 0;
    const std::vector<uint32_t> place = places_of(mesh_.positions, places);
    first_.assign(size_t(places) + 1, 0);
    for (const TriangleIndices& t : mesh_.triangles)
      for (const uint32_t vertex : t) ++first_[place[vertex] + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    around_.resize(corners_.size());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t i = 0; i < corners_.size(); ++i)
      around_[next[place[mesh_.triangles[i / 3][i % 3]]]++] = i;
  }

  void smooth_around(size_t place) {
    const std::span<const uint32_t> here =
        std::span(around_).subspan(first_[place], first_[place + 1] - first_[place]);
    if (here.size() > kMaxAround) return;
    for (const uint32_t corner : here) {
      Vec3d sum;
      for (const uint32_t other : here)
        if (dot(units_[corner / 3], units_[other / 3]) >= double(least_cosine_))
          sum = sum + areas_[other / 3];
      const double size = length(sum);
      corners_[corner] = size > 0 ? Vec3f(sum / size) : Vec3f();
    }
  }

  // A triangle stays flat if a corner has no normal, or all corners have the triangle's own.
  bool stays_flat(size_t triangle) const {
    const std::span<const Vec3f> normals(&corners_[3 * triangle], 3);
    return std::ranges::find(normals, Vec3f()) != normals.end() ||
           std::ranges::count(normals, Vec3f(units_[triangle])) == 3;
  }

  // Stores each normal of a position once; false if all triangles stay flat.
  bool store() {
    std::vector<Vec3f> normals;
    std::vector<TriangleIndices> indices(mesh_.triangles.size(), kFlatTriangle);
    for (size_t place = 0; place + 1 < first_.size(); ++place) {
      const size_t first = normals.size();
      for (size_t k = first_[place]; k < first_[place + 1]; ++k) {
        const uint32_t corner = around_[k];
        if (stays_flat(corner / 3)) continue;
        const auto same =
            std::find(normals.begin() + ptrdiff_t(first), normals.end(), corners_[corner]);
        indices[corner / 3][corner % 3] = uint32_t(same - normals.begin());
        if (same == normals.end()) normals.push_back(corners_[corner]);
      }
    }
    if (normals.empty()) return false;
    mesh_.normals = std::move(normals), mesh_.normal_indices = std::move(indices);
    return true;
  }

  // Triangles stay flat if more than this many share a vertex, as in the hub of a fan, since each
  // is compared with all others.
  static constexpr size_t kMaxAround = 1000;

  Mesh& mesh_;
  const float least_cosine_;
  std::vector<Vec3d> areas_, units_;      // per triangle
  std::vector<Vec3f> corners_;            // per-corner normals
  std::vector<uint32_t> first_, around_;  // by position: where its entries of around_ begin
};

size_t smooth_all(Object& scene, float least_cosine) {
  size_t count = 0;
  for (Mesh& mesh : scene.meshes)
    count += mesh.normals.empty() && Smoother(mesh, least_cosine).smooth();
  for (Object& prototype : scene.prototypes) count += smooth_all(prototype, least_cosine);
  return count;
}

}  // namespace

size_t smooth_meshes(Scene& scene, float degrees) {
  if (degrees <= 0) return 0;
  // Rounded to float, so that the last bit of the system's cosine does not matter.
  return smooth_all(scene, float(exact_cos(double(degrees) * std::numbers::pi / 180)));
}

}  // namespace raio::core
