// The JSON of a glTF file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/exact_math.h"
#include "io/mesh/builder.h"
#include "io/mesh/gltf.h"
#include "io/mesh/gltf_json.h"
#include "io/mesh/gltf_lights.h"
#include "io/mesh/gltf_paint.h"
#include "io/mesh/gltf_place.h"

namespace raio::core::gltf {
namespace {

class Parser {
 public:
  explicit Parser(const Json& json) : root_(json, "") {}

  Document parse() {
    check_version();
    check_extensions();
    read_buffers();
    read_accessors();
    read_pictures();
    read_materials();
    read_meshes();
    read_skins();
    read_cameras();
    read_lights();
    read_nodes();
    read_scene();
    if (const auto animations = root_.find("animations"); animations && animations->size() > 0)
      for (size_t i = 0; i < animations->size(); ++i)
        out_.notices.add(Severity::left_out, "animations", label((*animations)[i]));
    return std::move(out_);
  }

 private:
  size_t count_of(const char* array) const {
    const auto found = root_.find(array);
    return found ? found->size() : 0;
  }
  template <class F>  // f(value)
  void each(const char* array, const F& f) const {
    const auto found = root_.find(array);
    for (size_t i = 0; found && i < found->size(); ++i) f((*found)[i]);
  }
  uint32_t index(const Value& value, const char* array) const {
    return index_of(value, array, count_of(array));
  }
  Index find_index(const Value& object, const char* key, const char* array) const {
    const auto value = object.find(key);
    return value ? Index(index(*value, array)) : std::nullopt;
  }

  void check_version() {
    // Version 1 has objects instead of arrays and need not state its version.
    if (const auto meshes = root_.find("meshes"); meshes && meshes->is_object()) fail_old("1");
    const std::string& version = root_.at("asset").at("version").string();
    if (version.starts_with("1.") || version == "1") fail_old(version);
    if (!version.starts_with("2.")) root_.at("asset").at("version").fail_expected("glTF 2.0");
    if (const auto least = root_.at("asset").find("minVersion"); least && least->string() != "2.0")
      least->fail_expected("glTF 2.0");
  }

  [[noreturn]] static void fail_old(std::string_view version) {
    throw ReadFailure{fmt::format(
        "a scene in glTF {}; Raio reads glTF 2.0, convert it with gltf-pipeline", version)};
  }

  // Extensions without which a scene is much the same.
  static bool is_optional(std::string_view name) {
    static const std::set<std::string_view> kOptional = {"KHR_animation_pointer", "KHR_xmp_json_ld",
                                                         "MSFT_lod"};
    return name.starts_with("KHR_materials_") || kOptional.contains(name);
  }

  void check_extensions() {
    static const std::set<std::string_view> kKnown = {
        "EXT_mesh_gpu_instancing",    "KHR_lights_punctual",
        "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
        "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_sheen",        "KHR_materials_specular",
        "KHR_materials_transmission", "KHR_materials_unlit",
        "KHR_materials_volume",       "KHR_mesh_quantization",
        "KHR_texture_transform"};
    each("extensionsRequired", [&](const Value& value) {
      const std::string& name = value.string();
      if (kKnown.contains(name) || is_optional(name)) return;
      const bool packed =
          name == "KHR_draco_mesh_compression" || name.find("meshopt") != std::string::npos;
      value.fail(fmt::format("the file requires the extension {}, which is not supported; {}",
                             core::quoted(name),
                             packed ? "export without mesh compression" : "export without it"));
    });
    each("extensionsUsed", [&](const Value& value) {
      const std::string& name = value.string();
      if (!kKnown.contains(name))
        out_.notices.add(Severity::left_out, "extensions", core::quoted(name));
    });
  }

  void read_buffers() {
    each("buffers", [&](const Value& value) {
      Buffer buffer{value.at("byteLength").whole(1, kMaxBytes), {}};
      if (const auto uri = value.find("uri")) buffer.uri = uri->string();
      out_.buffers.push_back(std::move(buffer));
    });
    each("bufferViews", [&](const Value& value) {
      View view{index(value.at("buffer"), "buffers"), bytes_or(value, "byteOffset", 0),
                value.at("byteLength").whole(0, kMaxBytes)};
      if (const auto stride = value.find("byteStride")) view.stride = stride->whole(4, 252);
      view.compressed = value.extension("EXT_meshopt_compression").has_value();
      const size_t size = out_.buffers[view.buffer].length;
      if (view.offset > size || view.length > size - view.offset)
        value.fail(fmt::format("bytes {} to {} of buffer {}, which has {}", view.offset,
                               view.offset + view.length, view.buffer, size));
      out_.views.push_back(view);
    });
  }

  static Component component(const Value& value, bool only_whole) {
    const size_t number = value.whole(0, 65535);
    const bool whole = number == 5121 || number == 5123 || number == 5125;
    if (whole || (!only_whole && (number == 5120 || number == 5122 || number == 5126)))
      return Component(number);
    value.fail_expected(only_whole ? "5121, 5123 or 5125" : "5120, 5121, 5122, 5123, 5125 or 5126");
  }

  void read_accessors() {
    each("accessors", [&](const Value& value) {
      Accessor a;
      a.view = find_index(value, "bufferView", "bufferViews");
      a.offset = bytes_or(value, "byteOffset", 0);
      a.count = value.at("count").whole(1, 0xfffffffe);
      a.component = component(value.at("componentType"), false);
      if (const auto normalized = value.find("normalized")) a.normalized = normalized->truth();
      const std::string& type = value.at("type").string();
      if (type == "SCALAR")
        a.components = 1;
      else if (type.starts_with("VEC") && type.size() == 4 && type[3] >= '2' && type[3] <= '4')
        a.components = uint32_t(type[3] - '0');
      else if (type == "MAT2" || type == "MAT3" || type == "MAT4")
        a.components = type == "MAT4" ? 16 : 0;
      else
        value.at("type").fail_expected("SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
      if (const auto sparse = value.find("sparse")) {
        const Value indices = sparse->at("indices"), values = sparse->at("values");
        a.sparse = {sparse->at("count").whole(1, a.count),
                    index(indices.at("bufferView"), "bufferViews"),
                    index(values.at("bufferView"), "bufferViews"),
                    bytes_or(indices, "byteOffset", 0),
                    bytes_or(values, "byteOffset", 0),
                    component(indices.at("componentType"), true)};
      }
      out_.accessors.push_back(a);
    });
  }

  void read_pictures() {
    each("images", [&](const Value& value) {
      PictureSource image{find_index(value, "bufferView", "bufferViews"), ""};
      if (const auto uri = value.find("uri")) image.uri = uri->string();
      out_.images.push_back(std::move(image));
    });
    const auto wrap = [](const Value& sampler, const char* key) {
      const auto value = sampler.find(key);
      const size_t number = value ? value->whole(0, 65535) : 10497;
      if (number == 33071) return TextureWrap::clamp;
      if (number == 33648) return TextureWrap::mirror;
      if (number != 10497) value->fail_expected("10497, 33071 or 33648");
      return TextureWrap::repeat;
    };
    const auto samplers = root_.find("samplers");
    each("textures", [&](const Value& value) {
      PictureTexture texture{find_index(value, "source", "images")};
      if (const Index sampler = find_index(value, "sampler", "samplers")) {
        texture.wrap_u = wrap((*samplers)[*sampler], "wrapS");
        texture.wrap_v = wrap((*samplers)[*sampler], "wrapT");
      }
      out_.textures.push_back(texture);
    });
  }

  void read_materials() {
    each("materials", [&](const Value& value) {
      out_.materials.push_back(paint_of(value, count_of("textures"), out_.notices));
    });
  }

  MeshPrimitive primitive(const Value& value) const {
    MeshPrimitive out;
    if (const auto mode = value.find("mode")) out.mode = uint32_t(mode->whole(0, 6));
    out.indices = find_index(value, "indices", "accessors");
    out.material = find_index(value, "material", "materials");
    const Value attributes = value.at("attributes");
    out.position = find_index(attributes, "POSITION", "accessors");
    out.normal = find_index(attributes, "NORMAL", "accessors");
    out.color = find_index(attributes, "COLOR_0", "accessors");
    for (int set = 0; set < 64; ++set) {
      const Index joints =
          find_index(attributes, fmt::format("JOINTS_{}", set).c_str(), "accessors");
      const Index weights =
          find_index(attributes, fmt::format("WEIGHTS_{}", set).c_str(), "accessors");
      if (!joints || !weights) break;
      out.bones.emplace_back(*joints, *weights);
    }
    if (const auto targets = value.find("targets"))
      for (size_t i = 0; i < targets->size(); ++i)
        out.targets.push_back({find_index((*targets)[i], "POSITION", "accessors"),
                               find_index((*targets)[i], "NORMAL", "accessors")});
    attributes.each([&](const std::string& name, const Value& accessor) {
      constexpr std::string_view kSet = "TEXCOORD_";
      if (!name.starts_with(kSet) || name.size() > kSet.size() + 4) return;
      uint32_t set = 0;
      for (const char c : name.substr(kSet.size())) {
        if (c < '0' || c > '9') return;
        set = set * 10 + uint32_t(c - '0');
      }
      out.uv.emplace_back(set, index(accessor, "accessors"));
    });
    return out;
  }

  void read_meshes() {
    each("meshes", [&](const Value& value) {
      MeshDescription mesh;
      mesh.name = label(value);
      const Value primitives = value.at("primitives");
      for (size_t i = 0; i < primitives.size(); ++i)
        mesh.primitives.push_back(primitive(primitives[i]));
      mesh.weights = weights_of(value);
      out_.meshes.push_back(std::move(mesh));
    });
  }

  // Weights of morph targets.
  static std::vector<double> weights_of(const Value& value) {
    std::vector<double> out;
    if (const auto weights = value.find("weights"))
      for (size_t i = 0; i < weights->size(); ++i) out.push_back((*weights)[i].number());
    return out;
  }

  void read_skins() {
    each("skins", [&](const Value& value) {
      Skin skin{find_index(value, "inverseBindMatrices", "accessors"), {}};
      const Value joints = value.at("joints");
      for (size_t i = 0; i < joints.size(); ++i) skin.joints.push_back(index(joints[i], "nodes"));
      out_.skins.push_back(std::move(skin));
    });
  }

  void read_cameras() {
    each("cameras", [&](const Value& value) {
      Lens& camera = out_.cameras.emplace_back();
      camera.name = label(value);
      const auto take_near = [&](const Value& lens) {
        if (const auto near = lens.find("znear")) camera.near = std::max(0.0, near->number());
      };
      if (value.at("type").string() == "orthographic") {
        const Value lens = value.at("orthographic");
        take_near(lens);
        // Negative values mirror, which exporters do not intend.
        camera.half_height = std::abs(lens.at("ymag").number());
        if (camera.half_height == 0) lens.at("ymag").fail_expected("a non-zero height");
        camera.aspect = std::abs(lens.at("xmag").number()) / camera.half_height;
        return;
      }
      if (value.at("type").string() != "perspective")
        value.at("type").fail_expected("perspective or orthographic");
      const Value lens = value.at("perspective");
      take_near(lens);
      camera.fov = lens.at("yfov").number();
      if (!(camera.fov > 0 && camera.fov < 0.999999 * std::numbers::pi))
        lens.at("yfov").fail_expected("an angle between 0 and pi");
      if (const auto aspect = lens.find("aspectRatio")) camera.aspect = aspect->number();
    });
  }

  void read_lights() {
    const auto lights = root_.extension(kLights);
    if (!lights) return;
    const Value all = lights->at("lights");
    for (size_t i = 0; i < all.size(); ++i) out_.lights.push_back(lamp_of(all[i]));
  }

  void read_nodes() {
    each("nodes", [&](const Value& value) {
      Node node;
      if (const auto matrix = value.find("matrix")) {
        const auto by_columns = matrix->numbers<16>();
        for (size_t row = 0; row < 3; ++row)
          for (size_t column = 0; column < 4; ++column)
            node.matrix[4 * row + column] = by_columns[4 * column + row];
      } else {
        place(value, node);
      }
      node.mesh = find_index(value, "mesh", "meshes");
      node.camera = find_index(value, "camera", "cameras");
      node.skin = find_index(value, "skin", "skins");
      node.weights = weights_of(value);
      if (const auto lights = value.extension(kLights))
        node.light = index_of(lights->at("light"), "lights", out_.lights.size());
      if (const auto copies = value.extension("EXT_mesh_gpu_instancing")) {
        const Value attributes = copies->at("attributes");
        node.copies = {find_index(attributes, "TRANSLATION", "accessors"),
                       find_index(attributes, "ROTATION", "accessors"),
                       find_index(attributes, "SCALE", "accessors")};
      }
      if (const auto children = value.find("children"))
        for (size_t i = 0; i < children->size(); ++i)
          node.children.push_back(index((*children)[i], "nodes"));
      out_.nodes.push_back(std::move(node));
    });
  }

  static void place(const Value& value, Node& node) {
    NodePlace place;
    const auto vector = [&](const char* key, Vec3d& to) {
      if (const auto given = value.find(key)) {
        const auto [x, y, z] = given->numbers<3>();
        to = {x, y, z};
      }
    };
    vector("translation", place.shift), vector("scale", place.scale);
    if (const auto given = value.find("rotation")) {
      place.rotation = given->numbers<4>();
      if (place.rotation == std::array<double, 4>{})
        given->fail_expected("a quaternion of length 1");
    }
    node.matrix = placement_matrix(place);
  }

  void read_scene() {
    const Index shown = find_index(root_, "scene", "scenes");
    const auto scenes = root_.find("scenes");
    if (scenes && scenes->size() > 0) {
      for (size_t i = 0; i < scenes->size(); ++i)
        if (i != shown.value_or(0))
          out_.notices.add(Severity::left_out, "scenes other than the default",
                           label((*scenes)[i]));
      if (const auto nodes = (*scenes)[shown.value_or(0)].find("nodes"))
        for (size_t i = 0; i < nodes->size(); ++i)
          out_.roots.push_back(index((*nodes)[i], "nodes"));
      return;
    }
    std::vector<bool> is_child(out_.nodes.size());
    for (const Node& node : out_.nodes)
      for (const uint32_t child : node.children) is_child[child] = true;
    for (uint32_t i = 0; i < out_.nodes.size(); ++i)
      if (!is_child[i]) out_.roots.push_back(i);
  }

  Value root_;
  Document out_;
};

}  // namespace

Document parse_document(std::string_view json) {
  const Json root = parse_json(json);
  return Parser(root).parse();
}

}  // namespace raio::core::gltf
