// glTF 2.0 of Khronos (ISO/IEC 12113), as text with files beside it or in one binary file: nodes,
// meshes and the base colours of materials become a scene.
#include "io/mesh/gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/memory.h"
#include "base/placement.h"
#include "io/far_origin.h"
#include "io/fit_camera.h"
#include "io/mesh/builder.h"
#include "io/mesh/gltf_place.h"
#include "io/mesh/read.h"
#include "io/points.h"
#include "io/textures.h"

namespace raio {
namespace {

using namespace gltf;

/// A mesh or camera where a node places it.
struct Use {
  uint32_t number = 0;
  Transform place;
};

/// A mesh in a pose of its own: with the weights of its morph targets, and with its skin, which
/// places it (glTF 2.0, 3.7.2.2 and 3.7.3.1).
struct PosedUse : Use {
  const std::vector<double>* weights = nullptr;
  Index skin;
};

bool draws_triangles(const MeshPrimitive& p) { return p.mode >= 4; }

class GltfReader {
 public:
  GltfReader(std::string_view json, std::optional<std::string_view> chunk,
             const ReadOptions& options)
      : options_(options), document_(parse_document(json)), buffers_(document_, chunk, options) {}

  ReadScene read() {
    for (std::string& warning : document_.warnings) warn(std::move(warning));
    scene_.dialect = Dialect::data;
    find_uses();
    find_origin();
    add_materials();
    place_posed();
    place_meshes();
    tell_left_out();
    if (scene_.primitive_count() == 0)
      throw ReadFailure{
          lines_ > 0 ? fmt::format("there is nothing to draw but lines, in {} primitives; expected "
                                   "triangles or points",
                                   lines_)
                     : "there is nothing to draw: its scene has neither triangles nor points"};
    if (scene_.spheres.empty() && std::ranges::none_of(scene_.meshes, has_area))
      warn(std::string(kNoArea));
    set_camera();
    return {std::move(scene_), std::move(warnings_)};
  }

 private:
  void warn(std::string message) {
    warnings_.push_back({Severity::warning, "", 0, 0, std::move(message), ""});
  }

  void take_memory(double bytes) {
    bytes_ += bytes;
    if (bytes_ > double(available_memory_bytes()) / 2) throw ReadFailure{std::string(kNoMemory)};
  }

  // --- nodes
  void find_uses() {
    std::vector<std::pair<uint32_t, Transform>> open;
    std::vector<uint32_t> with_mesh;
    places_.resize(document_.nodes.size());
    for (size_t i = document_.roots.size(); i-- > 0;) open.emplace_back(document_.roots[i], kHere);
    std::vector<bool> seen(document_.nodes.size());
    while (!open.empty()) {
      const auto [number, around] = open.back();
      open.pop_back();
      if (seen[number])
        throw ReadFailure{
            fmt::format("/nodes/{}: the node is reached twice; expected a tree of nodes", number)};
      seen[number] = true;
      const Node& node = document_.nodes[number];
      const Transform place = around * Transform{node.matrix};
      places_[number] = place;
      if (node.mesh) with_mesh.push_back(number);
      if (node.camera) cameras_.push_back({*node.camera, place});
      for (size_t i = node.children.size(); i-- > 0;) open.emplace_back(node.children[i], place);
    }
    for (const uint32_t number : with_mesh) add_mesh_uses(number);
  }

  void add_mesh_uses(uint32_t number) {
    const Node& node = document_.nodes[number];
    const std::vector<double>& weights =
        node.weights.empty() ? document_.meshes[*node.mesh].weights : node.weights;
    const bool is_morphed = std::ranges::any_of(weights, [](double w) { return w != 0; });
    const auto is_there = [](const Index& column) { return column.has_value(); };
    uncopied_ += node.skin && std::ranges::any_of(node.copies, is_there);
    for (const Transform& place : copies_of(number)) {
      if (node.skin) {
        posed_.push_back({{*node.mesh, kHere}, &weights, node.skin});
      } else if (!place.is_sound()) {
        ++unsound_;
      } else if (is_morphed) {
        posed_.push_back({{*node.mesh, place}, &weights, {}});
      } else {
        meshes_.push_back({*node.mesh, place});
      }
    }
  }

  // The node itself, or its copies by EXT_mesh_gpu_instancing; a skin places its mesh once.
  std::vector<Transform> copies_of(uint32_t number) {
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
    take_memory(double(count) * 3 * sizeof(Transform));
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

  // From the mesh to the scene, for each joint.
  const std::vector<Transform>& bones_of(uint32_t number) {
    const Skin& skin = document_.skins[number];
    bones_.resize(document_.skins.size());
    std::vector<Transform>& out = bones_[number];
    if (!out.empty()) return out;
    std::optional<Elements> inverse;
    if (skin.inverse_bind) inverse.emplace(document_, buffers_, *skin.inverse_bind, 16, 16);
    if (skin.joints.empty() || (inverse && inverse->count() < skin.joints.size()))
      throw ReadFailure{fmt::format("/skins/{}: it has {} joints and {} inverseBindMatrices",
                                    number, skin.joints.size(), inverse ? inverse->count() : 0)};
    for (size_t i = 0; i < skin.joints.size(); ++i) {
      if (!places_[skin.joints[i]])
        throw ReadFailure{fmt::format("/skins/{}/joints/{}: node {} is not in the scene", number, i,
                                      skin.joints[i])};
      const Transform& joint = *places_[skin.joints[i]];
      out.push_back(inverse ? joint * Transform{inverse->matrix(i)} : joint);
    }
    return out;
  }

  // Looks at the boxes of meshes where nodes place them, before anything else is read of them.
  void find_origin() try {
    FileOrigin found;
    std::map<uint32_t, Box3d> boxes;
    const auto is_far = [&](uint32_t number, const Transform& place) {
      const Box3d some = box_of(number, 1);
      if (some.empty()) return true;
      found.choose(place.point(some.lo));
      if (!found.is_far()) return false;
      const auto [box, is_new] = boxes.try_emplace(number);
      if (is_new) box->second = box_of(number);
      for (int k = 0; k < 8; ++k) (void)found.local(place.point(corner(box->second, k)));
      return true;
    };
    for (const Use& use : meshes_)
      if (!is_far(use.number, use.place)) return;
    for (const PosedUse& use : posed_)
      for (const Transform& place : use.skin ? bones_of(*use.skin) : std::vector{use.place})
        if (!is_far(use.number, place)) return;
    scene_.origin = found.value();
  } catch (const FileOrigin::NotFar&) {
  }

  // Of all vertices of a mesh, or of the first ones of each primitive.
  Box3d box_of(uint32_t number, size_t most = SIZE_MAX) const {
    Box3d box;
    for (const MeshPrimitive& p : document_.meshes[number].primitives) {
      if (!p.position || (p.mode > 0 && !draws_triangles(p))) continue;
      const Elements positions(document_, buffers_, *p.position, 3, 3);
      for (size_t i = 0; i < std::min(most, positions.count()); ++i)
        box.extend(Vec3d(position(positions, i)));
    }
    return box;
  }
  static Vec3d corner(const Box3d& box, int k) {
    return {k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y, k & 4 ? box.hi.z : box.lo.z};
  }

  // --- materials
  // Only those that are used have their textures read.
  void add_materials() {
    std::vector<bool> used(document_.materials.size());
    bool any_plain = false;
    const auto take = [&](const Use& use) {
      for (const MeshPrimitive& p : document_.meshes[use.number].primitives) {
        if (p.material)
          used[*p.material] = true;
        else
          any_plain = true;
      }
    };
    for (const Use& use : meshes_) take(use);
    for (const Use& use : posed_) take(use);
    materials_.resize(used.size());
    size_t no_alpha = 0;
    for (size_t i = 0; i < used.size(); ++i) {
      if (!used[i]) continue;
      const Paint& paint = document_.materials[i];
      const uint32_t texture = paint.texture ? texture_of(paint.texture->texture) : kNoTexture;
      no_alpha += texture != kNoTexture && (paint.blends || paint.masks);
      const Rgb color(paint.color[0], paint.color[1], paint.color[2]);
      materials_[i] = scene_.add_material({.color = color, .kd = 1}, Rgb(1), 0,
                                          paint.blends ? paint.color[3] : 1, texture);
    }
    if (any_plain || scene_.materials.empty())
      plain_ = scene_.add_material({.color = Rgb(1), .kd = 1});
    if (no_alpha > 0)
      warn(fmt::format("the alpha of the textures of {} materials is left out", no_alpha));
  }

  uint32_t texture_of(uint32_t number) {
    const PictureTexture& texture = document_.textures[number];
    std::string what = fmt::format("/textures/{}", number);
    if (!texture.image) {
      warn(what + ": it has no source, so the colours of its materials are plain");
      return kNoTexture;
    }
    what = fmt::format("/images/{}", *texture.image);
    const auto added = picture(document_.images[*texture.image], what, [&](std::string_view bytes) {
      return textures_.add(scene_, bytes, texture.wrap_u, texture.wrap_v);
    });
    if (added) return *added;
    warn(fmt::format("{}: {}, so the colours of its materials are plain", what, added.error()));
    return kNoTexture;
  }
  template <class Add>
  std::expected<uint32_t, std::string> picture(const PictureSource& image, const std::string& what,
                                               const Add& add) const try {
    if (image.view) return add(buffers_.view(*image.view, what));
    if (image.uri.starts_with("data:")) return add(decode_data_uri(image.uri, what + "/uri"));
    const std::string name = file_of_uri(image.uri, what + "/uri");
    const auto bytes = options_.folder ? read_beside(*options_.folder, name)
                                       : std::unexpected("there is no folder to look for it in");
    if (!bytes) return std::unexpected(fmt::format("{}: {}", raio::quoted(name), bytes.error()));
    return add(*bytes);
  } catch (const ReadFailure& failure) {
    return std::unexpected(failure.message);
  }

  // --- meshes
  void place_posed() {
    const Vec3d& o = scene_.origin;
    const Transform from_origin{{1, 0, 0, o.x, 0, 1, 0, o.y, 0, 0, 1, o.z}};
    for (const PosedUse& use : posed_) {
      for (const MeshPrimitive& p : document_.meshes[use.number].primitives)
        if (p.mode == 0) {
          add_points(use.number, p, use.place);
          ++unposed_;
        }
      for (Mesh& mesh : triangles_of(use.number, 1, &use)) {
        move(mesh, use.skin ? from_origin : use.place);  // skins place what they move
        scene_.meshes.push_back(std::move(mesh));
      }
    }
  }

  void place_meshes() {
    std::vector<std::vector<Transform>> places(document_.meshes.size());
    for (const Use& use : meshes_) places[use.number].push_back(use.place);
    for (uint32_t number = 0; number < places.size(); ++number) {
      const auto& all = places[number];
      if (all.empty()) continue;
      for (const MeshPrimitive& p : document_.meshes[number].primitives)
        if (p.mode == 0)
          for (const Transform& place : all) add_points(number, p, place);
      std::vector<Mesh> meshes = triangles_of(number, all.size());
      if (meshes.empty()) continue;
      if (all.size() == 1) {
        for (Mesh& mesh : meshes) {
          move(mesh, all[0]);
          scene_.meshes.push_back(std::move(mesh));
        }
        continue;
      }
      Scene object;
      object.meshes = std::move(meshes);
      object.materials = scene_.materials;
      object.material_opacity = scene_.material_opacity;
      object.material_texture = scene_.material_texture;
      const Box3f whole = bounds(object);
      const Box3d box{Vec3d(whole.lo), Vec3d(whole.hi)};
      for (const Transform& place : all) {
        for (int k = 0; k < 8; ++k)
          (void)placed(place.point(corner(box, k)), fmt::format("/meshes/{}", number));
        scene_.instances.push_back(
            {uint32_t(scene_.prototypes.size()), place.matrix(scene_.origin)});
      }
      scene_.prototypes.push_back(std::move(object));
    }
  }

  static Vec3f checked(Vec3f p, std::string_view what) {
    if (!is_place(p))
      throw ReadFailure{std::string(what) + ": it is placed beyond 1e25, or at no place at all"};
    return p;
  }
  // A place of the file as the scene has it.
  Vec3f placed(Vec3d p, std::string_view what) const {
    return checked(Vec3f(p - scene_.origin), what);
  }

  // Of all primitives that have some, in the space of the mesh, or in a pose.
  std::vector<Mesh> triangles_of(uint32_t number, size_t copies, const PosedUse* pose = nullptr) {
    std::vector<Mesh> out;
    for (size_t i = 0; i < document_.meshes[number].primitives.size(); ++i) {
      const MeshPrimitive& p = document_.meshes[number].primitives[i];
      if (p.mode >= 1 && p.mode <= 3) ++lines_;
      if (!draws_triangles(p)) continue;
      if (!p.position) {
        ++nowhere_;
        continue;
      }
      const std::string what = fmt::format("/meshes/{}/primitives/{}", number, i);
      Mesh mesh = mesh_of(p, what);
      if (pose) take_pose(mesh, p, *pose, what);
      for (const uint32_t at : named_) numbers_[at] = kNoNormal;
      // Where copies are asked to be primitives of their own, they will be.
      const double each = sizeof(TriangleIndices) + 3 * (2 * sizeof(Vec3f) + sizeof(Uv));
      take_memory(double(mesh.triangles.size()) * each * double(options_.instances ? 1 : copies));
      if (!mesh.triangles.empty()) out.push_back(std::move(mesh));
    }
    return out;
  }

  MaterialId material_of(const MeshPrimitive& p) const {
    return p.material ? materials_[*p.material] : plain_;
  }

  // Vertices that a primitive names, each once: several primitives may share long columns.
  Mesh mesh_of(const MeshPrimitive& p, const std::string& what) {
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
    const TextureUse* const use = paint && paint->texture ? &*paint->texture : nullptr;
    Index coordinates;
    for (const auto& [set, accessor] : p.uv)
      if (set == (use ? use->set : 0)) coordinates = accessor;
    const auto uv = column(coordinates, 2, 2, "TEXCOORD_n");

    Mesh mesh;
    mesh.materials = {material_of(p)};
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
    for (size_t i = 0; i < triangles; ++i) {
      const auto at = [&](size_t k) -> size_t {
        if (p.mode == 4) return 3 * i + k;
        if (p.mode == 6) return k == 0 ? 0 : i + k;
        return k == 0 || i % 2 == 0 ? i + k : i + 3 - k;  // a strip turns every other triangle
      };
      const uint32_t a = vertex(at(0)), b = vertex(at(1));
      mesh.triangles.push_back({a, b, vertex(at(2))});
    }
    return mesh;
  }

  // Moves the vertices, `named_` of the primitive, by its morph targets and then by its skin.
  void take_pose(Mesh& mesh, const MeshPrimitive& p, const PosedUse& pose,
                 const std::string& what) {
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
    unposed_ += pose.skin && p.bones.empty();
    if (pose.skin && p.bones.empty())
      for (Vec3f& position : mesh.positions) position = placed(Vec3d(position), what);
    if (pose.skin && !p.bones.empty()) {
      const std::vector<Transform>& bones = bones_of(*pose.skin);
      std::vector<std::pair<Elements, Elements>> columns;
      for (const auto& [joints, weights] : p.bones)
        columns.emplace_back(column(joints, 4), column(weights, 4));
      for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const Transform by = blend(bones, columns, named_[i]);
        mesh.positions[i] = placed(by.point(Vec3d(mesh.positions[i])), what);
        if (!mesh.normals.empty()) mesh.normals[i] = unit(by.normal(Vec3d(mesh.normals[i])));
      }
    }
    for (const Vec3f& position : mesh.positions) (void)checked(position, what);
  }

  // The mean of the bones by their weights for the vertex.
  static Transform blend(const std::vector<Transform>& bones,
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

  static Vec3f position(const Elements& from, size_t i) {
    const auto x = from.numbers(i);
    const Vec3f p{float(x[0]), float(x[1]), float(x[2])};
    if (!is_place(p)) throw ReadFailure{from.place(i) + ": expected coordinates of at most 1e25"};
    return p;
  }
  static Vec3f unit(Vec3d v) {
    const double size = length(v);
    return size > 1e-30 && std::isfinite(size) ? Vec3f(v * (1 / size)) : Vec3f(0, 0, 1);
  }
  static Vec3f normal(const Elements& from, size_t i) {
    const auto x = from.numbers(i);
    return unit({x[0], x[1], x[2]});
  }
  static Rgb color(const Elements& from, size_t i) {
    const auto part = [](double x) { return x > 0 ? float(std::min(x, 1.0)) : 0; };
    const auto x = from.numbers(i);
    return {part(x[0]), part(x[1]), part(x[2])};
  }
  // From the upper left corner downwards, as glTF has them, to those of Mesh.
  static Uv coordinates_of(const Elements& from, size_t i, const TextureUse* use) {
    const auto x = from.numbers(i);
    double u = x[0], v = x[1];
    if (use) {
      const double c = std::cos(use->rotation), s = std::sin(use->rotation);
      const double su = u * use->scale[0], sv = v * use->scale[1];
      u = c * su + s * sv + use->offset[0], v = -s * su + c * sv + use->offset[1];
    }
    const auto number = [](double y) {
      const auto f = float(y);
      return std::isfinite(f) ? f : 0;
    };
    return {number(u), number(1 - v)};
  }

  void move(Mesh& mesh, const Transform& by) const {
    const Placement place(by.matrix());
    for (Vec3f& p : mesh.positions) p = placed(by.point(Vec3d(p)), "/nodes");
    for (Vec3f& n : mesh.normals) n = unit(place.normal(Vec3d(n)));
    if (place.determinant() < 0)
      for (TriangleIndices& t : mesh.triangles) std::swap(t[1], t[2]);
  }

  // As spheres of one size.
  void add_points(uint32_t number, const MeshPrimitive& p, const Transform& by) {
    if (!p.position) return;
    const Elements positions(document_, buffers_, *p.position, 3, 3);
    std::optional<Elements> colors, indices;
    if (p.color) colors.emplace(document_, buffers_, *p.color, 3, 4);
    if (p.indices) indices.emplace(document_, buffers_, *p.indices, 1, 1);
    const Rgb of_material = scene_.materials[material_of(p)].color;
    const std::string what = fmt::format("/meshes/{}", number);
    Box3f box;
    const size_t count = indices ? indices->count() : positions.count();
    const size_t before = scene_.spheres.size();
    take_memory(double(count) * (sizeof(Sphere) + sizeof(Rgb) + sizeof(MaterialId)));
    for (size_t i = 0; i < count; ++i) {
      const size_t at = indices ? indices->whole(i) : i;
      if (at >= positions.count() || (colors && at >= colors->count()))
        throw ReadFailure{
            fmt::format("/meshes/{}: index {} of {} points", number, at, positions.count())};
      const Vec3f to = placed(by.point(Vec3d(position(positions, at))), what);
      scene_.spheres.push_back({to, 0});
      box.extend(to);
      scene_.sphere_materials.push_back(material_of(p));
      scene_.sphere_colors.push_back(colors ? color(*colors, at) * of_material : of_material);
    }
    const float radius = std::clamp(mean_spacing(box, count) / 2, 1e-25f, kFarthestPlace);
    for (size_t i = 0; i < count; ++i) scene_.spheres[before + i].radius = radius;
  }

  void tell_left_out() {
    if (lines_ > 0) warn(fmt::format("{} primitives of lines are left out", lines_));
    if (nowhere_ > 0) warn(fmt::format("{} primitives without POSITION are left out", nowhere_));
    if (unsound_ > 0)
      warn(fmt::format("{} meshes are left out that are scaled to nothing", unsound_));
    if (unposed_ > 0)
      warn(
          fmt::format("{} primitives are drawn without their pose: points, or without JOINTS_0 "
                      "and WEIGHTS_0 in a skin",
                      unposed_));
    if (uncopied_ > 0)
      warn(fmt::format("the copies of {} meshes with skins are left out", uncopied_));
  }

  // --- camera
  void set_camera() {
    size_t usable = 0;
    const Use* first = nullptr;
    for (const Use& use : cameras_) {
      if (!use.place.is_sound()) continue;
      if (usable++ == 0) first = &use;
    }
    if (first && look_through(*first)) {
      if (usable > 1) warn(fmt::format("of {} cameras the first is taken", usable));
      return;
    }
    if (!cameras_.empty())
      warn("its camera, which sees nothing, is left out, and another one is fitted");
    fit_camera(scene_, FitView::three_quarter, {0, 1, 0});
  }
  bool look_through(const Use& use) {
    const Lens& lens = document_.cameras[use.number];
    Camera camera;
    const Vec3d from = use.place.point({0, 0, 0});
    const Vec3d forward = use.place.vector({0, 0, -1}), up = use.place.vector({0, 1, 0});
    const Box3f box = bounds(scene_);
    const Vec3d eye = from - scene_.origin;
    const Vec3d ahead = forward * (1 / length(forward));
    // As far as the middle of what is seen, which depth of field keeps in focus.
    const double middle = dot((Vec3d(box.lo) + Vec3d(box.hi)) * 0.5 - eye, ahead);
    const double least = std::max(1e-3 * std::max(1.0, length(from)), lens.half_height);
    camera.from = Vec3f(eye), camera.at = Vec3f(eye + ahead * std::max(middle, least));
    camera.up = unit(up);
    constexpr double kDegrees = 180 / 3.14159265358979323846;
    double tangent = std::tan(lens.fov / 2);
    camera.fov_deg = float(lens.fov * kDegrees);
    if (lens.half_height > 0) {
      camera.projection = Projection::orthographic;
      tangent = lens.half_height / length(Vec3d(camera.at) - Vec3d(camera.from));
      camera.fov_deg = float(2 * kDegrees * std::atan(tangent));
    }
    camera.width = 1200, camera.height = 900;
    if (lens.aspect >= 0.1 && lens.aspect <= 10) {
      // Narrower pictures show as much across.
      camera.across_deg = float(2 * kDegrees * std::atan(tangent * lens.aspect));
      if (lens.aspect > 4.0 / 3)
        camera.height = int(std::lround(1200 / lens.aspect));
      else
        camera.width = int(std::lround(900 * lens.aspect));
    }
    if (!is_place(camera.from) || !is_place(camera.at) || !camera_problem(camera).empty() ||
        !(camera.fov_deg > 0 && camera.fov_deg < 180))
      return false;
    scene_.camera = camera;
    return true;
  }

  const ReadOptions& options_;
  Document document_;
  Buffers buffers_;
  Scene scene_;
  Diagnostics warnings_;
  TextureReader textures_;
  std::vector<Use> meshes_, cameras_;
  std::vector<PosedUse> posed_;
  std::vector<std::vector<Transform>> bones_;     // of each skin, once they are asked for
  std::vector<std::optional<Transform>> places_;  // of the nodes that the scene has
  std::vector<MaterialId> materials_;             // of the file's, those that are used
  MaterialId plain_ = 0;
  std::vector<uint32_t> numbers_, named_;  // of vertices in a mesh; kNoNormal: none
  size_t lines_ = 0, nowhere_ = 0, unsound_ = 0, unposed_ = 0, uncopied_ = 0;
  double bytes_ = 0;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_gltf(const TextBuffer& bytes, std::string_view file,
                                                const ReadOptions& options) {
  return read_guarded(file, [&] {
    const std::string_view all = bytes.view();
    const Chunks chunks = all.starts_with("glTF") ? chunks_of(all) : Chunks{all, {}};
    return GltfReader(chunks.json, chunks.binary, options).read();
  });
}

}  // namespace raio
