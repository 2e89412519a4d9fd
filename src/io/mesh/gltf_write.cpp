// A scene as glTF 2.0 (Khronos, ISO/IEC 12113).
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "base/srgb.h"
#include "io/fit_camera.h"
#include "io/image/codecs.h"
#include "io/mesh/gltf_parts.h"
#include "io/mesh/write.h"
#include "scene/columns.h"

namespace raio {
namespace {

using namespace gltf;
using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "numbers are written as they are");

Json numbers(Vec3d v) { return {v.x, v.y, v.z}; }
Json numbers(Vec3f v) { return numbers(Vec3d(v)); }

/// The material of metallic-roughness that reflects as much light.
class GltfMaterial {
 public:
  GltfMaterial(const Scene& scene, const Look& look)
      : scene_(scene), look_(look), m_(scene.materials[look.material]) {}

  Json json() const {
    // Both sides of a surface are seen, as in Raio.
    Json out = {{"doubleSided", true}};
    const double transmitted = std::clamp(double(m_.transmission), 0.0, 1.0);
    Json& pbr = out["pbrMetallicRoughness"];
    const Vec3d diffuse = light(look_.color * m_.kd);
    Vec3d base = diffuse;
    double metallic = 0;
    if (transmitted > 0) {
      // Raio does not tint what goes through.
      base = diffuse + Vec3d(transmitted);
      const double part = transmitted / (transmitted + brightness(diffuse));
      out["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", part}}},
                           {"KHR_materials_ior", {{"ior", std::max(1.0, double(m_.ior))}}}};
    } else if (const Vec3d mirrored = light(scene_.specular_of(look_.material) * m_.ks);
               brightness(mirrored) > kDielectric) {
      metallic = metallic_part(brightness(diffuse), brightness(mirrored));
      base = mixed_base(diffuse, mirrored, metallic);
    }
    base = min(base, Vec3d(1));
    pbr["baseColorFactor"] = {base.x, base.y, base.z, double(look_.opacity)};
    pbr["metallicFactor"] = metallic;
    pbr["roughnessFactor"] = roughness();
    if (look_.textured)
      pbr["baseColorTexture"] = {{"index", scene_.material_texture[look_.material]}};
    if (look_.opacity < 1) out["alphaMode"] = "BLEND";
    return out;
  }

 private:
  // What a surface of glTF mirrors that is no metal.
  static constexpr double kDielectric = 0.04;

  // The classic shading computes display values, glTF light.
  Vec3d light(Rgb color) const {
    if (scene_.dialect != Dialect::data)
      for (int i = 0; i < 3; ++i) color[i] = linear_from_srgb(color[i]);
    return Vec3d(color);
  }
  static double brightness(Vec3d c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

  // Where base (1 - metallic) is the diffuse colour and what is mirrored is that of a metal as far
  // as it is one, as KHR_materials_pbrSpecularGlossiness converts its materials.
  static double metallic_part(double diffuse, double mirrored) {
    const double b = diffuse + mirrored - 2 * kDielectric, c = mirrored - kDielectric;
    return std::min(1.0, 2 * c / (b + std::sqrt(b * b + 4 * kDielectric * c)));
  }
  static Vec3d mixed_base(Vec3d diffuse, Vec3d mirrored, double metallic) {
    const Vec3d of_metal = (mirrored - Vec3d(kDielectric * (1 - metallic))) / metallic;
    const Vec3d of_diffuse = diffuse / std::max(1 - metallic, 1e-6);
    const double part = metallic * metallic;
    return max(min(of_diffuse, Vec3d(1)) * (1 - part) + of_metal * part, Vec3d());
  }

  // The width of Phong's highlight, as one of microfacets (Walter et al. 2007, "Microfacet Models
  // for Refraction through Rough Surfaces", EGSR); glTF squares it.
  double roughness() const {
    return m_.ks > 0 ? std::sqrt(std::sqrt(2 / (double(m_.shine) + 2))) : 1;
  }

  const Scene& scene_;
  const Look& look_;
  const Material& m_;
};

class GltfWriter {
 public:
  GltfWriter(const Scene& scene, SurfaceParts parts) : scene_(scene), parts_(std::move(parts)) {}

  /// The JSON, but for its buffer, whose bytes are binary().
  Json json(std::string_view comment) {
    json_["asset"] = {{"version", "2.0"}, {"generator", comment}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({Json{{"nodes", Json::array({0})}}});
    Json root = {{"name", scene_.name}, {"children", Json::array()}};
    if (scene_.origin != Vec3d()) root["translation"] = numbers(scene_.origin);
    json_["nodes"] = Json::array({std::move(root)});
    add_textures();
    for (const Look& look : parts_.looks) add_material(look);
    for (const Surface& surface : parts_.surfaces) add_surface(surface);
    if (!parts_.fixed.empty()) add_node({{"mesh", add_mesh(parts_.fixed)}});
    add_copies();
    add_camera();
    for (const Light& light : scene_.lights) add_light(light);
    return std::move(json_);
  }
  std::string_view binary() const { return binary_; }

 private:
  Json& list(const char* name) {
    Json& out = json_[name];
    if (out.is_null()) out = Json::array();
    return out;
  }
  size_t append(Json& to, Json what) {
    to.push_back(std::move(what));
    return to.size() - 1;
  }
  size_t add(const char* name, Json what) { return append(list(name), std::move(what)); }
  void add_node(Json node) {
    const size_t number = add("nodes", std::move(node));
    json_["nodes"][0]["children"].push_back(number);
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

  // --- what is seen
  void add_textures() {
    for (const Texture& texture : scene_.textures) {
      Image image(int(texture.width), int(texture.height));
      for (size_t i = 0; i < image.pixels.size(); ++i) {
        const uint32_t texel = scene_.texels[texture.first + i];
        const auto part = [&](int shift) { return float(texel >> shift & 255) / 255; };
        image.pixels[i] = Rgb(part(0), part(8), part(16));
      }
      const size_t view = add_view(encode_png(image, {}).value());
      constexpr std::array kWraps = {10497, 33071, 33648};  // in the order of TextureWrap
      add("samplers",
          {{"wrapS", kWraps[size_t(texture.wrap_u)]}, {"wrapT", kWraps[size_t(texture.wrap_v)]}});
      const size_t number = add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
      add("textures", {{"source", number}, {"sampler", number}});
    }
  }

  void add_material(const Look& look) {
    Json material = GltfMaterial(scene_, look).json();
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

  void add_copies() {
    std::map<SurfacePart, size_t> meshes;
    for (const auto& [part, place] : parts_.copies) {
      auto at = meshes.find(part);
      if (at == meshes.end()) at = meshes.emplace(part, add_mesh({&part, 1})).first;
      Json node = {{"mesh", at->second},
                   {"translation", numbers(place.shift)},
                   {"scale", numbers(place.scale)}};
      if (place.rotation != NodePlace().rotation) node["rotation"] = place.rotation;
      add_node(std::move(node));
    }
  }

  // --- from where, and in what light
  void add_camera() {
    const Camera& c = scene_.camera;
    const Vec3d from(c.from), view = Vec3d(c.at) - from;
    const Vec3d forward = normalize(view), right = normalize(cross(forward, Vec3d(c.up)));
    const double angle = double(fitted_fov_deg(c)) * std::numbers::pi / 180;
    const double aspect =
        c.width > 0 && c.height > 0 ? double(c.width) / c.height : 1;  // as pictures of 512 x 512
    // Programs of triangles need a plane where the picture begins.
    const double near = c.hither > 0 ? double(c.hither) : length(view) / 1000;
    Json camera;
    if (c.is_parallel()) {
      const double height = std::tan(angle / 2) * length(view);
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
    use("KHR_lights_punctual");
    Json& all = json_["extensions"]["KHR_lights_punctual"]["lights"];
    if (all.is_null()) all = Json::array();
    const size_t number =
        append(all, {{"type", "point"},
                     {"color", numbers(most > 0 ? Vec3d(color) / most : Vec3d(1))},
                     {"intensity", most * std::numbers::pi * dot(way, way)}});
    add_node({{"translation", numbers(light.position)},
              {"extensions", {{"KHR_lights_punctual", {{"light", number}}}}}});
  }

  const Scene& scene_;
  const SurfaceParts parts_;
  Json json_;
  std::string binary_;
  std::vector<Json> surfaces_;  // as primitives without a material
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

std::expected<std::string, std::string> write_gltf(const Scene& scene, GltfForm form,
                                                   std::string_view comment) {
  auto parts = surface_parts(scene);
  if (!parts) return std::unexpected(std::move(parts.error()));
  if (parts->fixed.empty() && parts->copies.empty())
    return std::unexpected(
        "glTF holds triangles, and the scene has nothing that they can stand for; choose another "
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
    add(fmt::format("the exact form of {}, for which triangles stand",
                    count(curved, "round shape")));
  add(text_of(scene, {Feature::object_names, Feature::roughness, Feature::light_extents,
                      Feature::movement}));
  if (scene.dialect != Dialect::data) add("the background");
  if (scene.camera.lens_radius.value_or(0) > 0) add("the camera's lens");
  return lost;
}

}  // namespace raio
