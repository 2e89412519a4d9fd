#include "io/mesh/gltf_nodes.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/mesh/builder.h"

namespace raio::core::gltf {

NodeTree::NodeTree(const Document& document, const Buffers& buffers, MemoryCount& memory,
                   Notices& notices)
    : document_(document), buffers_(buffers), memory_(memory), notices_(notices) {
  std::vector<std::pair<uint32_t, Transform>> open;
  std::vector<uint32_t> with_mesh;
  places_.resize(document_.nodes.size());
  for (size_t i = document_.roots.size(); i-- > 0;) open.emplace_back(document_.roots[i], kHere);
  std::vector<bool> seen(document_.nodes.size());
  while (!open.empty()) {
    const auto [number, around] = open.back();
    open.pop_back();
    if (seen[number])
      throw ReadFailure{fmt::format(
          "/nodes/{}: the node is reached more than once; expected a tree of nodes", number)};
    seen[number] = true;
    const Node& node = document_.nodes[number];
    const Transform place = around * Transform{node.matrix};
    places_[number] = place;
    if (node.mesh) with_mesh.push_back(number);
    if (node.camera) cameras_.push_back({*node.camera, place});
    if (node.light) lights_.push_back({*node.light, place});
    for (size_t i = node.children.size(); i-- > 0;) open.emplace_back(node.children[i], place);
  }
  for (const uint32_t number : with_mesh) add_mesh_uses(number);
}

void NodeTree::add_mesh_uses(uint32_t number) {
  const Node& node = document_.nodes[number];
  const std::vector<double>& weights =
      node.weights.empty() ? document_.meshes[*node.mesh].weights : node.weights;
  const bool is_morphed = std::ranges::any_of(weights, [](double w) { return w != 0; });
  const auto is_there = [](const Index& column) { return column.has_value(); };
  const std::string& name = document_.meshes[*node.mesh].name;
  if (node.skin && std::ranges::any_of(node.copies, is_there))
    notices_.add(Severity::left_out, "instances of skinned meshes", name);
  for (const Transform& place : copies_of(number)) {
    if (node.skin) {
      posed_.push_back({{*node.mesh, kHere}, &weights, node.skin});
    } else if (!place.is_sound()) {
      notices_.add(Severity::left_out, "meshes with a scale of 0", name);
    } else if (is_morphed) {
      posed_.push_back({{*node.mesh, place}, &weights, {}});
    } else {
      meshes_.push_back({*node.mesh, place});
    }
  }
}

// The node's transformations, one per instance of EXT_mesh_gpu_instancing; a skin places its mesh
// once.
std::vector<Transform> NodeTree::copies_of(uint32_t number) const {
  const Node& node = document_.nodes[number];
  std::array<std::optional<Elements>, 3> columns;
  size_t count = 0;
  for (size_t i = 0; i < 3; ++i) {
    if (!node.copies[i] || node.skin) continue;
    const uint32_t components = i == 1 ? 4 : 3;
    columns[i].emplace(document_, buffers_, *node.copies[i], components, components);
    if (count > 0 && columns[i]->count() != count)
      throw ReadFailure{fmt::format(
          "/nodes/{}/extensions/EXT_mesh_gpu_instancing: its accessors have {} and {} elements",
          number, count, columns[i]->count())};
    count = columns[i]->count();
  }
  if (count == 0) return {*places_[number]};
  memory_.take(double(count) * 3 * sizeof(Transform));
  std::vector<Transform> out;
  for (size_t i = 0; i < count; ++i) {
    const auto row = [&](size_t k, std::array<double, 4> usual) {
      return columns[k] ? columns[k]->numbers(i) : usual;
    };
    const auto vector = [](const std::array<double, 4>& v) { return Vec3d(v[0], v[1], v[2]); };
    out.push_back(*places_[number] *
                  Transform{placement_matrix(
                      {vector(row(0, {})), row(1, {0, 0, 0, 1}), vector(row(2, {1, 1, 1, 0}))})});
  }
  return out;
}

const std::vector<Transform>& NodeTree::bones_of(uint32_t number) {
  const Skin& skin = document_.skins[number];
  bones_.resize(document_.skins.size());
  std::vector<Transform>& out = bones_[number];
  if (!out.empty()) return out;
  std::optional<Elements> inverse;
  if (skin.inverse_bind) inverse.emplace(document_, buffers_, *skin.inverse_bind, 16, 16);
  if (skin.joints.empty() || (inverse && inverse->count() < skin.joints.size()))
    throw ReadFailure{fmt::format("/skins/{}: it has {} joints and {} inverseBindMatrices", number,
                                  skin.joints.size(), inverse ? inverse->count() : 0)};
  for (size_t i = 0; i < skin.joints.size(); ++i) {
    if (!places_[skin.joints[i]])
      throw ReadFailure{fmt::format("/skins/{}/joints/{}: node {} is not in the scene", number, i,
                                    skin.joints[i])};
    const Transform& joint = *places_[skin.joints[i]];
    out.push_back(inverse ? joint * Transform{inverse->matrix(i)} : joint);
  }
  return out;
}

}  // namespace raio::core::gltf
