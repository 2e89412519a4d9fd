// glTF 2.0 of Khronos (ISO/IEC 12113), as text with separate files or as one binary file. Its
// nodes, meshes, materials, cameras and lights become a scene.
#include "io/mesh/gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/placement.h"
#include "io/far_origin.h"
#include "io/fit_camera.h"
#include "io/mesh/builder.h"
#include "io/mesh/gltf_lights.h"
#include "io/mesh/gltf_paints.h"
#include "io/mesh/gltf_primitive.h"
#include "io/mesh/read.h"
#include "io/points.h"

namespace raio::core {
namespace {

using namespace gltf;

class GltfReader {
 public:
  GltfReader(std::string_view json, std::optional<std::string_view> chunk,
             const ReadOptions& options)
      : options_(options),
        document_(parse_document(json)),
        buffers_(document_, chunk, options),
        notices_(std::move(document_.notices)),
        nodes_(document_, buffers_, memory_, notices_),
        paints_(document_, buffers_, options, nodes_, scene_, notices_),
        primitives_(document_, buffers_, nodes_, notices_) {}

  ReadScene read() {
    scene_.dialect = Dialect::data;
    find_origin();
    place_posed();
    place_meshes();
    if (scene_.primitive_count() == 0)
      throw ReadFailure{lines_ > 0 ? fmt::format("all {} primitives are lines; expected "
                                                 "triangles or points",
                                                 lines_)
                                   : "the scene has no primitives; expected triangles or points"};
    const auto is_seen = [](const Object& scene) {
      return !scene.spheres.empty() || std::ranges::any_of(scene.meshes, has_area);
    };
    if (!is_seen(scene_) && std::ranges::none_of(scene_.prototypes, is_seen))
      notices_.add_whole(Severity::warning, kNoArea);
    set_camera();
    set_lights();
    ReadScene out{std::move(scene_), {}};
    append(out.notices, notices_, "");
    return out;
  }

 private:
  // Chooses the origin from the bounding boxes of placed meshes, before anything else is read.
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
    for (const Use& use : nodes_.meshes())
      if (!is_far(use.number, use.place)) return;
    for (const PosedUse& use : nodes_.posed())
      for (const Transform& place : use.skin ? nodes_.bones_of(*use.skin) : std::vector{use.place})
        if (!is_far(use.number, place)) return;
    scene_.origin = found.value();
  } catch (const FileOrigin::NotFar&) {
    scene_.origin = {};
  }

  // Bounds all vertices of a mesh, or the first ones of each primitive.
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

  // --- meshes
  void place_posed() {
    const Vec3d& o = scene_.origin;
    const Transform from_origin{{1, 0, 0, o.x, 0, 1, 0, o.y, 0, 0, 1, o.z}};
    for (const PosedUse& use : nodes_.posed()) {
      for (const MeshPrimitive& p : document_.meshes[use.number].primitives)
        if (p.mode == 0) {
          add_points(use.number, p, use.place);
          notices_.add(Severity::left_out, "the pose of points", document_.meshes[use.number].name);
        }
      for (Mesh& mesh : triangles_of(use.number, 1, &use)) {
        move(mesh, use.skin ? from_origin : use.place);  // skins include the node's transformation
        scene_.meshes.push_back(std::move(mesh));
      }
    }
  }

  void place_meshes() {
    std::vector<std::vector<Transform>> places(document_.meshes.size());
    for (const Use& use : nodes_.meshes()) places[use.number].push_back(use.place);
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
      Object object;
      object.meshes = std::move(meshes);
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

  // A position of the file, relative to the scene's origin.
  Vec3f placed(Vec3d p, std::string_view what) const {
    return checked(Vec3f(p - scene_.origin), what);
  }

  // The triangles of all primitives that have some, in the mesh's space or in a pose.
  std::vector<Mesh> triangles_of(uint32_t number, size_t copies, const PosedUse* pose = nullptr) {
    std::vector<Mesh> out;
    for (size_t i = 0; i < document_.meshes[number].primitives.size(); ++i) {
      const MeshPrimitive& p = document_.meshes[number].primitives[i];
      const std::string what = fmt::format("/meshes/{}/primitives/{}", number, i);
      if (p.mode >= 1 && p.mode <= 3) {
        notices_.add(Severity::left_out, "primitives of lines", what);
        ++lines_;
      }
      if (!draws_triangles(p)) continue;
      if (!p.position) {
        notices_.add(Severity::left_out, "primitives without POSITION", what);
        continue;
      }
      Mesh mesh = primitives_.read(p, what, pose, scene_.origin);
      mesh.materials = {paints_.of(p)};
      // Instances that are requested as primitives are stored as such.
      const double each = sizeof(TriangleIndices) + 3 * (2 * sizeof(Vec3f) + sizeof(Uv));
      memory_.take(double(mesh.triangles.size()) * each * double(options_.instances ? 1 : copies));
      if (!mesh.triangles.empty()) out.push_back(std::move(mesh));
    }
    return out;
  }

  void move(Mesh& mesh, const Transform& by) const {
    const Placement place(by.matrix());
    for (Vec3f& p : mesh.positions) p = placed(by.point(Vec3d(p)), "/nodes");
    for (Vec3f& n : mesh.normals) n = unit(place.normal(Vec3d(n)));
    if (place.determinant() < 0)
      for (TriangleIndices& t : mesh.triangles) std::swap(t[1], t[2]);
  }

  // Adds points as spheres of one size.
  void add_points(uint32_t number, const MeshPrimitive& p, const Transform& by) {
    if (!p.position) return;
    const Elements positions(document_, buffers_, *p.position, 3, 3);
    std::optional<Elements> colors, indices;
    if (p.color) colors.emplace(document_, buffers_, *p.color, 3, 4);
    if (p.indices) indices.emplace(document_, buffers_, *p.indices, 1, 1);
    const Rgb of_material = scene_.materials[paints_.of(p)].color;
    const std::string what = fmt::format("/meshes/{}", number);
    Box3f box;
    const size_t count = indices ? indices->count() : positions.count();
    const size_t before = scene_.spheres.size();
    memory_.take(double(count) * (sizeof(Sphere) + sizeof(Rgb) + sizeof(MaterialId)));
    for (size_t i = 0; i < count; ++i) {
      const size_t at = indices ? indices->whole(i) : i;
      if (at >= positions.count() || (colors && at >= colors->count()))
        throw ReadFailure{
            fmt::format("/meshes/{}: index {} of {} points", number, at, positions.count())};
      const Vec3f to = placed(by.point(Vec3d(position(positions, at))), what);
      scene_.spheres.push_back({to, 0});
      box.extend(to);
      scene_.sphere_materials.push_back(paints_.of(p));
      scene_.sphere_colors.push_back(colors ? color(*colors, at) * of_material : of_material);
    }
    const float radius = std::clamp(mean_spacing(box, count) / 2, 1e-25f, kFarthestPlace);
    for (size_t i = 0; i < count; ++i) scene_.spheres[before + i].radius = radius;
  }

  void set_camera() {
    bool found = false;
    for (const Use& use : nodes_.cameras()) {
      const Lens& lens = document_.cameras[use.number];
      if (found) {
        notices_.add(Severity::left_out, "further cameras", lens.name);
      } else if (const auto camera = use.place.is_sound() ? camera_through(lens, use.place, scene_)
                                                          : std::nullopt) {
        scene_.camera = *camera, scene_.requests.near_clip = float(lens.near);
        found = true;
      } else {
        notices_.add(Severity::left_out, "cameras that see nothing", lens.name);
      }
    }
    if (!found) fit_camera(scene_, FitView::three_quarter, {0, 1, 0});
  }

  void set_lights() {
    for (const Use& use : nodes_.lights()) {
      const Lamp& lamp = document_.lights[use.number];
      if (const auto light = placed_light(lamp.light, use.place, scene_.origin))
        scene_.physical_lights.push_back(*light);
      else
        notices_.add(Severity::left_out, "lights with a scale of 0", lamp.name);
    }
    // Exporters write candela or watts, and some expect a camera's exposure.
    constexpr int kManyStops = 4;
    if (const int stops = stops_above_white(scene_.physical_lights, bounds(scene_));
        stops >= kManyStops)
      notices_.add_whole(Severity::warning,
                         fmt::format("its lights are about 2^{0} times too bright for a display; "
                                     "`exposure` -{0} shows what they light",
                                     stops));
  }

  const ReadOptions& options_;
  Document document_;
  Buffers buffers_;
  Scene scene_;
  Notices notices_;
  MemoryCount memory_;
  NodeTree nodes_;
  Paints paints_;
  PrimitiveReader primitives_;
  size_t lines_ = 0;
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

}  // namespace raio::core
