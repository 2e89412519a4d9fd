// A scene as glTF 2.0 (Khronos, ISO/IEC 12113).
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "base/exact_math.h"
#include "base/srgb.h"
#include "io/fit_camera.h"
#include "io/image/codecs.h"
#include "io/mesh/gltf_lights.h"
#include "io/mesh/gltf_material.h"
#include "io/mesh/gltf_parts.h"
#include "io/mesh/write.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

using namespace gltf;
using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "numbers are written as they are");

Json numbers(Vec3d v) { return {v.x, v.y, v.z}; }
Json numbers(Vec3f v) { return numbers(Vec3d(v)); }

class GltfWriter {
 public:
  GltfWriter(const Scene& scene, SurfaceParts parts) : scene_(scene), parts_(std::move(parts)) {}

  /// The JSON without its buffer; binary() has the bytes.
  Json json(std::string_view comment) {
    json_["asset"] = {{"version", "2.0"}, {"generator", comment}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({Json{{"nodes", Json::array({0})}}});
    Json root = {{"name", scene_.name}};
    if (scene_.origin != Vec3d()) root["translation"] = numbers(scene_.origin);
    add("nodes", std::move(root));
    add_textures();
    for (const GltfAppearance& look : parts_.looks) add_material(look);
    for (const Surface& surface : parts_.surfaces) add_surface(surface);
    meshes_of_objects_.resize(parts_.objects.size());
    add_object(0, 0);
    add_camera();
    for (const Light& light : scene_.lights) add_light(light);
    for (const PhysicalLight& light : scene_.physical_lights)
      if (is_punctual(light)) add_light_node(json_of(light), node_at(place_of(light)));
    return std::move(json_);
  }
  std::string_view binary() const { return binary_; }

 private:
  Json& list(const char* name) {
    Json& out = json_[name];
    if (out.is_null()) out = Json::array();
    return out;
  }
  static size_t append(Json& to, Json what) {
    to.push_back(std::move(what));
    return to.size() - 1;
  }
  size_t add(const char* name, Json what) { return append(list(name), std::move(what)); }
  size_t add_node(Json node, size_t parent = 0) {
    const size_t number = add("nodes", std::move(node));
    json_["nodes"][parent]["children"].push_back(number);
    return number;
  }
  void use(std::string_view extension) {
    Json& used = list("extensionsUsed");
    if (std::find(used.begin(), used.end(), Json(extension)) == used.end())
      used.push_back(extension);
  }

  // --- buffer
  size_t add_view(std::string_view bytes) {
    const size_t offset = binary_.size();
    binary_ += bytes;
    binary_.resize((binary_.size() + 3) / 4 * 4);
    return add("bufferViews",
               {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
  }
  enum class Target { vertices = 34962, indices = 34963 };
  template <class T>
  size_t add_accessor(const std::vector<T>& column, std::string_view type, Target target) {
    const size_t view =
        add_view({reinterpret_cast<const char*>(column.data()), column.size() * sizeof(T)});
    json_["bufferViews"][view]["target"] = int(target);
    const bool is_index = target == Target::indices;
    return add("accessors", {{"bufferView", view},
                             {"componentType", is_index ? 5125 : 5126},
                             {"count", column.size() * (is_index ? 3 : 1)},
                             {"type", type}});
  }

  // --- visible parts
  void add_textures() {
    for (const Texture& texture : scene_.textures) {
      Image image(int(texture.width), int(texture.height));
      Column<float> alpha(image.pixels.size());
      for (size_t i = 0; i < image.pixels.size(); ++i) {
        const uint32_t texel = scene_.texels[texture.first + i];
        const auto part = [&](int shift) { return float(texel >> shift & 255) / 255; };
        image.pixels[i] = Rgb(part(0), part(8), part(16));
        alpha[i] = 1 - part(24);
      }
      PictureView picture(image);
      picture.is_straight = true;
      if (std::ranges::any_of(alpha, [](float a) { return a < 1; })) picture.alpha = alpha;
      const size_t view = add_view(encode_png(picture, {}).value());
      constexpr std::array kWraps = {10497, 33071, 33648};  // in the order of TextureWrap
      add("samplers",
          {{"wrapS", kWraps[size_t(texture.wrap_u)]}, {"wrapT", kWraps[size_t(texture.wrap_v)]}});
      const size_t number = add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
      add("textures", {{"source", number}, {"sampler", number}});
    }
  }

  void add_material(const GltfAppearance& look) {
    Json material = material_of(scene_, look);
    if (material.contains("extensions"))
      for (const auto& [name, value] : material["extensions"].items()) use(name);
    add("materials", std::move(material));
  }

  void add_surface(const Surface& s) {
    Json attributes;
    const size_t positions = add_accessor(s.positions, "VEC3", Target::vertices);
    Box3f box;
    for (const Vec3f& p : s.positions) box.extend(p);
    Json& accessor = json_["accessors"][positions];
    accessor["min"] = numbers(box.lo), accessor["max"] = numbers(box.hi);
    attributes["POSITION"] = positions;
    if (!s.normals.empty())
      attributes["NORMAL"] = add_accessor(s.normals, "VEC3", Target::vertices);
    if (!s.colors.empty())
      attributes["COLOR_0"] = add_accessor(light_of(s.colors), "VEC3", Target::vertices);
    if (!s.uv.empty()) {
      std::vector<Uv> from_top = s.uv;
      for (Uv& uv : from_top) uv[1] = 1 - uv[1];
      attributes["TEXCOORD_0"] = add_accessor(from_top, "VEC2", Target::vertices);
    }
    surfaces_.push_back({{"attributes", std::move(attributes)},
                         {"indices", add_accessor(s.triangles, "SCALAR", Target::indices)}});
  }
  std::vector<Rgb> light_of(std::vector<Rgb> colors) const {
    if (scene_.dialect != Dialect::data)
      for (Rgb& color : colors)
        for (int i = 0; i < 3; ++i) color[i] = linear_from_srgb(color[i]);
    return colors;
  }

  size_t add_mesh(std::span<const SurfacePart> parts) {
    Json primitives = Json::array();
    for (const SurfacePart& part : parts) {
      Json primitive = surfaces_[part.surface];
      primitive["material"] = part.look;
      primitives.push_back(std::move(primitive));
    }
    return add("meshes", {{"primitives", std::move(primitives)}});
  }

  static Json node_at(const NodePlace& place) {
    Json node = {{"translation", numbers(place.shift)}, {"scale", numbers(place.scale)}};
    if (place.rotation != NodePlace().rotation) node["rotation"] = place.rotation;
    return node;
  }

  // In a node and those below it.
  void add_object(uint32_t number, size_t at) {
    const ObjectParts& object = parts_.objects[number];
    std::optional<size_t>& mesh = meshes_of_objects_[number];
    if (!object.fixed.empty()) {
      if (!mesh) mesh = add_mesh(object.fixed);
      json_["nodes"][at]["mesh"] = *mesh;
    }
    for (const auto& [part, place] : object.shapes) {
      auto shape = meshes_of_shapes_.find(part);
      if (shape == meshes_of_shapes_.end())
        shape = meshes_of_shapes_.emplace(part, add_mesh({&part, 1})).first;
      Json node = node_at(place);
      node["mesh"] = shape->second;
      add_node(std::move(node), at);
    }
    for (const auto& [copied, place] : object.copies)
      add_object(copied, add_node(node_at(place), at));
  }

  // --- camera and lights
  void add_camera() {
    const Camera& c = scene_.camera;
    const Vec3d from(c.from), view = Vec3d(c.at) - from;
    const Vec3d forward = normalize(view), right = normalize(cross(forward, Vec3d(c.up)));
    const double angle = double(fitted_fov_deg(c)) * std::numbers::pi / 180;
    const double aspect =
        c.width > 0 && c.height > 0 ? double(c.width) / c.height : 1;  // as pictures of 512 x 512
    // Programs of triangles need a plane where the picture begins.
    const auto hither = double(scene_.requests.near_clip);
    const double near = hither > 0 ? hither : length(view) / 1000;
    Json camera;
    if (c.is_parallel()) {
      const double height = exact_tan(angle / 2) * length(view);
      const Box3f box = bounds(scene_);
      const double far =
          box.empty() ? 0 : length(Vec3d(max(abs(box.lo - c.from), abs(box.hi - c.from))));
      camera = {{"type", "orthographic"},
                {"orthographic",
                 {{"xmag", height * aspect},
                  {"ymag", height},
                  {"znear", near},
                  {"zfar", 2 * std::max(far, near)}}}};
    } else {
      camera = {{"type", "perspective"},
                {"perspective", {{"yfov", angle}, {"aspectRatio", aspect}, {"znear", near}}}};
    }
    add_node({{"camera", add("cameras", std::move(camera))},
              {"translation", numbers(from)},
              {"rotation", rotation_to(right, cross(right, forward), -forward)}});
  }

  // In candela: at the middle of the scene as bright as Raio's light, which does not decrease.
  void add_light(const Light& light) {
    const Rgb color = light.color.value_or(Rgb(float(1 / std::sqrt(double(scene_.lights.size())))));
    const double most = double(max_component(color));
    const Box3f box = bounds(scene_);
    const Vec3d middle =
        box.empty() ? Vec3d(scene_.camera.at) : (Vec3d(box.lo) + Vec3d(box.hi)) * 0.5;
    const Vec3d way = Vec3d(light.position) - middle;
    add_light_node({{"type", "point"},
                    {"color", numbers(most > 0 ? Vec3d(color) / most : Vec3d(1))},
                    {"intensity", most * std::numbers::pi * dot(way, way)}},
                   {{"translation", numbers(light.position)}});
  }
  void add_light_node(Json light, Json node) {
    use(kLights);
    Json& all = json_["extensions"][kLights]["lights"];
    if (all.is_null()) all = Json::array();
    node["extensions"][kLights]["light"] = append(all, std::move(light));
    add_node(std::move(node));
  }

  const Scene& scene_;
  const SurfaceParts parts_;
  Json json_;
  std::string binary_;
  std::vector<Json> surfaces_;  // as primitives without a material
  // The numbers of meshes, of objects once they are in use.
  std::vector<std::optional<size_t>> meshes_of_objects_;
  std::map<SurfacePart, size_t> meshes_of_shapes_;
};

std::string base64_of(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

// Names of files may be in any encoding.
std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::expected<std::string, std::string> one_file(const Json& json, std::string_view binary) {
  std::string text = json_text(json, -1);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  constexpr size_t kHeader = 12, kChunk = 8;
  const size_t size = kHeader + kChunk + text.size() + kChunk + binary.size();
  if (size > 0xffffffffu)
    return std::unexpected(
        fmt::format("a .glb file has at most 4 GiB, and this one would have {:.1f}; leave some of "
                    "the scene out, or choose another format",
                    double(size) / double(size_t(1) << 30)));
  std::string out;
  out.reserve(size);
  const auto add = [&](std::string_view name, size_t number) {
    const auto bits = uint32_t(number);
    out += name, out.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  };
  const auto chunk = [&](std::string_view type, std::string_view bytes) {
    add("", bytes.size());
    out += type, out += bytes;
  };
  add("glTF", 2), add("", size);
  chunk("JSON", text), chunk(std::string_view("BIN\0", 4), binary);
  return out;
}

}  // namespace

bool gltf_keeps_copies(const Object& scene) {
  const auto is_node = [](const Instance& copy) { return place_of(copy.matrix).has_value(); };
  return std::ranges::all_of(scene.instances, is_node) &&
         std::ranges::all_of(scene.prototypes, gltf_keeps_copies);
}

std::expected<std::string, std::string> write_gltf(const Scene& scene, GltfForm form,
                                                   std::string_view comment) {
  if (!gltf_keeps_copies(scene))
    return std::unexpected("glTF nodes cannot shear, as some of its instances do");
  auto parts = surface_parts(scene);
  if (!parts) return std::unexpected(std::move(parts.error()));
  const auto is_empty = [](const ObjectParts& o) { return o.fixed.empty() && o.shapes.empty(); };
  if (std::ranges::all_of(parts->objects, is_empty))
    return std::unexpected(
        "glTF stores triangles, and nothing in the scene can be converted to them; choose another "
        "format");
  GltfWriter writer(scene, std::move(*parts));
  Json json = writer.json(comment);
  json["buffers"] = Json::array({Json{{"byteLength", writer.binary().size()}}});
  if (form == GltfForm::binary) return one_file(json, writer.binary());
  json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64_of(writer.binary());
  return json_text(json, 1) + '\n';
}

std::string not_in_gltf(const Scene& scene) {
  std::string lost;
  const auto add = [&](std::string_view what) {
    if (!what.empty()) lost += (lost.empty() ? "" : ", ") + std::string(what);
  };
  const auto count = [&](size_t number, std::string_view one) {
    return number == 0 ? std::string()
                       : fmt::format("{} {}{}", number, one, number == 1 ? "" : "s");
  };
  add(count(scene.planes.size(), "plane"));
  if (const size_t curved = count_curved(scene); curved > 0)
    add(fmt::format("the exact form of {}, replaced by triangles", count(curved, "round shape")));
  add(text_of(scene, {Feature::object_names, Feature::roughness, Feature::light_extents,
                      Feature::movement, Feature::environment, Feature::all_directions}));
  const auto is_lost = [](const PhysicalLight& light) { return !is_punctual(light); };
  add(count(size_t(std::ranges::count_if(scene.physical_lights, is_lost)), "physical light"));
  if (scene.dialect != Dialect::data) add("the background");
  if (scene.camera.lens_radius.value_or(0) > 0) add("the camera's lens");
  return lost;
}

}  // namespace raio::core
