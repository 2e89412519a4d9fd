#include "io/mesh/gltf_primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/executor.h"
#include "io/mesh/builder.h"
#include "io/points.h"

namespace raio::core::gltf {
namespace {

Vec3f normal(const Elements& from, size_t i) {
  const auto x = from.numbers(i);
  return unit({x[0], x[1], x[2]});
}

// glTF's texture coordinates run down from the upper left corner; Mesh's run up.
Uv coordinates_of(const Elements& from, size_t i, const TextureUse* use) {
  const auto x = from.numbers(i);
  double u = x[0], v = x[1];
  if (use) {
    const double c = use->cosine, s = use->sine;
    const double su = u * use->scale[0], sv = v * use->scale[1];
    u = c * su + s * sv + use->offset[0], v = -s * su + c * sv + use->offset[1];
  }
  const auto number = [](double y) {
    const auto f = float(y);
    return std::isfinite(f) ? f : 0;
  };
  return {number(u), number(1 - v)};
}

// The mean of the joints' transformations, weighted for the vertex.
Transform blend(const std::vector<Transform>& bones,
                const std::vector<std::pair<Elements, Elements>>& columns, size_t vertex) {
  Transform sum{};
  double total = 0;
  for (const auto& [joints, weights] : columns) {
    const auto joint = joints.numbers(vertex), weight = weights.numbers(vertex);
    for (size_t k = 0; k < 4; ++k) {
      if (!(weight[k] > 0)) continue;
      if (!(joint[k] >= 0 && joint[k] < double(bones.size())))
        throw ReadFailure{fmt::format("{}: joint {} of a skin of {}", joints.place(vertex),
                                      joint[k], bones.size())};
      for (size_t j = 0; j < 12; ++j) sum.m[j] += weight[k] * bones[size_t(joint[k])].m[j];
      total += weight[k];
    }
  }
  if (!(total > 0)) return kHere;
  for (double& x : sum.m) x /= total;
  return sum;
}

}  // namespace

Vec3f position(const Elements& from, size_t i) {
  const auto x = from.numbers(i);
  const Vec3f p{float(x[0]), float(x[1]), float(x[2])};
  if (!is_place(p))
    throw ReadFailure{from.place(i) + ": expected coordinates between -1e25 and 1e25"};
  return p;
}
Vec3f unit(Vec3d v) {
  const double size = length(v);
  return size > 1e-30 && std::isfinite(size) ? Vec3f(v * (1 / size)) : Vec3f(0, 0, 1);
}

Rgb color(const Elements& from, size_t i) {
  const auto part = [](double x) { return x > 0 ? float(std::min(x, 1.0)) : 0; };
  const auto x = from.numbers(i);
  return {part(x[0]), part(x[1]), part(x[2])};
}

Vec3f checked(Vec3f p, std::string_view what) {
  if (!is_place(p))
    throw ReadFailure{std::string(what) +
                      ": its transformation gives coordinates beyond 1e25 or not finite"};
  return p;
}

Mesh PrimitiveReader::read(const MeshPrimitive& p, const std::string& what, const PosedUse* pose,
                           Vec3d origin) {
  Mesh mesh = mesh_of(p, what);
  if (pose) take_pose(mesh, p, *pose, origin, what);
  for (const uint32_t at : named_) numbers_[at] = kNoNormal;
  return mesh;
}

// Stores each used vertex once: primitives may share long accessors.
Mesh PrimitiveReader::mesh_of(const MeshPrimitive& p, const std::string& what) {
  const Elements positions(document_, buffers_, *p.position, 3, 3);
  const auto column = [&](Index accessor, uint32_t least, uint32_t most,
                          std::string_view name) -> std::optional<Elements> {
    if (!accessor) return std::nullopt;
    std::optional<Elements> found(std::in_place, document_, buffers_, *accessor, least, most);
    if (found->count() != positions.count())
      throw ReadFailure{fmt::format("{}/attributes/{}: it has {} elements, POSITION has {}", what,
                                    name, found->count(), positions.count())};
    return found;
  };
  const auto normals = column(p.normal, 3, 3, "NORMAL");
  const auto colors = column(p.color, 3, 4, "COLOR_0");
  const auto indices =
      p.indices ? std::optional<Elements>(std::in_place, document_, buffers_, *p.indices, 1, 1)
                : std::nullopt;
  const Paint* const paint = p.material ? &document_.materials[*p.material] : nullptr;
  const TextureUse* const use = paint ? paint->coordinates() : nullptr;
  Index coordinates;
  for (const auto& [set, accessor] : p.uv)
    if (set == (use ? use->set : 0)) coordinates = accessor;
  const auto uv = column(coordinates, 2, 2, "TEXCOORD_n");

  Mesh mesh;
  if (numbers_.size() < positions.count()) numbers_.resize(positions.count(), kNoNormal);
  named_.clear();
  const auto vertex = [&](size_t i) {
    const size_t at = indices ? indices->whole(i) : i;
    if (at >= positions.count())
      throw ReadFailure{
          fmt::format("{}: index {} of {} vertices", indices->place(i), at, positions.count())};
    uint32_t& number = numbers_[at];
    if (number != kNoNormal) return number;
    number = uint32_t(named_.size());
    named_.push_back(uint32_t(at));
    mesh.positions.push_back(position(positions, at));
    if (normals) mesh.normals.push_back(normal(*normals, at));
    if (colors) mesh.colors.push_back(color(*colors, at));
    if (uv) mesh.uv.push_back(coordinates_of(*uv, at, use));
    return number;
  };
  const size_t count = indices ? indices->count() : positions.count();
  const size_t triangles = p.mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
  mesh.triangles.reserve(triangles);
  StopCheck look;
  for (size_t i = 0; i < triangles; ++i) {
    look();
    const auto at = [&](size_t k) -> size_t {
      if (p.mode == 4) return 3 * i + k;
      if (p.mode == 6) return k == 0 ? 0 : i + k;
      return k == 0 || i % 2 == 0 ? i + k : i + 3 - k;  // strips alternate orientation
    };
    const uint32_t a = vertex(at(0)), b = vertex(at(1));
    mesh.triangles.push_back({a, b, vertex(at(2))});
  }
  return mesh;
}

// Moves the vertices `named_` of the primitive by its morph targets, then by its skin.
void PrimitiveReader::take_pose(Mesh& mesh, const MeshPrimitive& p, const PosedUse& pose,
                                Vec3d origin, const std::string& what) {
  const auto placed = [&](Vec3d at) { return checked(Vec3f(at - origin), what); };
  const auto column = [&](uint32_t accessor, uint32_t components) {
    Elements found(document_, buffers_, accessor, components, components);
    if (!named_.empty() && std::ranges::max(named_) >= found.count())
      throw ReadFailure{fmt::format("{}: accessor {} has {} elements, fewer than POSITION", what,
                                    accessor, found.count())};
    return found;
  };
  const auto add = [&](auto& to, Index accessor, double weight) {
    if (!accessor || to.empty()) return;
    const Elements from = column(*accessor, 3);
    for (size_t i = 0; i < to.size(); ++i) {
      const auto x = from.numbers(named_[i]);
      to[i] = Vec3f(Vec3d(to[i]) + Vec3d(x[0], x[1], x[2]) * weight);
    }
  };
  for (size_t i = 0; i < std::min(p.targets.size(), pose.weights->size()); ++i) {
    const double weight = (*pose.weights)[i];
    if (weight == 0) continue;
    add(mesh.positions, p.targets[i].position, weight);
    add(mesh.normals, p.targets[i].normal, weight);
  }
  for (Vec3f& n : mesh.normals) n = unit(Vec3d(n));
  if (pose.skin && p.bones.empty()) {
    notices_.add(Severity::left_out, "the pose of primitives without JOINTS_0 and WEIGHTS_0", what);
    for (Vec3f& position : mesh.positions) position = placed(Vec3d(position));
  }
  if (pose.skin && !p.bones.empty()) {
    const std::vector<Transform>& bones = nodes_.bones_of(*pose.skin);
    std::vector<std::pair<Elements, Elements>> columns;
    columns.reserve(p.bones.size());
    for (const auto& [joints, weights] : p.bones)
      columns.emplace_back(column(joints, 4), column(weights, 4));
    StopCheck look;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      look();
      const Transform by = blend(bones, columns, named_[i]);
      mesh.positions[i] = placed(by.point(Vec3d(mesh.positions[i])));
      if (!mesh.normals.empty()) mesh.normals[i] = unit(by.normal(Vec3d(mesh.normals[i])));
    }
  }
  for (const Vec3f& position : mesh.positions) (void)checked(position, what);
}

}  // namespace raio::core::gltf
