// The contents of a glTF 2.0 file (Khronos, ISO/IEC 12113) as plain data; JSON and buffers are read
// separately. Internal to the reader. Failures are ReadFailure; those in the JSON name values by
// their JSON pointers (RFC 6901).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/read_scene.h"

namespace raio::core::gltf {

using Index = std::optional<uint32_t>;  // checked index into an array of Document

/// Values of componentType.
enum class Component : uint32_t {
  i8 = 5120,
  u8 = 5121,
  i16 = 5122,
  u16 = 5123,
  u32 = 5125,
  f32 = 5126
};
size_t bytes_of(Component component);

struct Buffer {
  size_t length = 0;
  std::optional<std::string> uri;
};
struct View {
  uint32_t buffer = 0;
  size_t offset = 0, length = 0, stride = 0;  // 0: tightly packed
  bool compressed = false;                    // by EXT_meshopt_compression
};
/// Replacements for some elements of an accessor.
struct Sparse {
  size_t count = 0;
  uint32_t indices_view = 0, values_view = 0;
  size_t indices_offset = 0, values_offset = 0;
  Component indices = Component::u32;
};
struct Accessor {
  Index view;  // none: zeros
  size_t offset = 0, count = 0;
  Component component = Component::f32;
  uint32_t components = 1;  // 16: a matrix of 4 x 4; 0: another matrix
  bool normalized = false;
  std::optional<Sparse> sparse;
};
struct PictureSource {
  Index view;
  std::string uri;
};
struct PictureTexture {
  Index image;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
};
/// A texture with the coordinates TEXCOORD_`set`, transformed by KHR_texture_transform.
struct TextureUse {
  uint32_t texture = 0, set = 0;
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double cosine = 1, sine = 0;  // of the rotation

  bool has_coordinates_of(const TextureUse& other) const {
    return set == other.set && offset == other.offset && scale == other.scale &&
           cosine == other.cosine && sine == other.sine;
  }
};
/// The textures of a material that a scene has room for.
enum class Slot : uint8_t { color, metallic_roughness, normal, emission, transmission };
inline constexpr std::array<std::string_view, 5> kSlotNames = {
    "base colour", "metallic-roughness", "normal", "emission", "transmission"};
struct Paint {
  std::array<float, 4> color{1, 1, 1, 1};  // linear
  float ior = 1.5f;
  StandardSurface surface{.metallic = 1, .is_two_sided = 0};          // without its textures
  std::array<std::optional<TextureUse>, kSlotNames.size()> textures;  // by Slot
  std::string name;  // here and below: for messages, else the JSON pointer

  /// The texture whose coordinates a mesh gets: that of the base colour, else the first one.
  const TextureUse* coordinates() const {
    for (const auto& use : textures)
      if (use) return &*use;
    return nullptr;
  }
};
/// A light of KHR_lights_punctual.
struct Lamp {
  PhysicalLight light;  // shines along -z
  std::string name;
};
/// The displacements of a morph target at weight 1.
struct MorphTarget {
  Index position, normal;
};
struct MeshPrimitive {
  uint32_t mode = 4;
  Index position, normal, color, indices, material;
  std::vector<MorphTarget> targets;
  std::vector<std::pair<uint32_t, uint32_t>> bones;  // accessors JOINTS_n and WEIGHTS_n
  std::vector<std::pair<uint32_t, uint32_t>> uv;     // set and accessor index
};
struct MeshDescription {
  std::vector<MeshPrimitive> primitives;
  std::vector<double> weights;  // of its morph targets; missing ones are 0
  std::string name;
};
struct Skin {
  Index inverse_bind;            // accessor of matrices; none: each is the identity
  std::vector<uint32_t> joints;  // nodes
};
struct Lens {
  double fov = 0;          // vertical, radians; for perspective
  double half_height = 0;  // orthographic, scene units; 0: perspective
  double aspect = 0;       // width over height; 0: any
  double near = 0;         // near clipping plane; 0: unknown
  std::string name;
};
struct Node {
  std::array<double, 12> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};  // as Matrix
  Index mesh, camera, skin, light;
  std::vector<uint32_t> children;
  std::vector<double> weights;  // override the mesh's
  /// EXT_mesh_gpu_instancing: accessors of translations, rotations and scales, one element per
  /// instance.
  std::array<Index, 3> copies;
};

struct Document {
  std::vector<Buffer> buffers;
  std::vector<View> views;
  std::vector<Accessor> accessors;
  std::vector<PictureSource> images;
  std::vector<PictureTexture> textures;
  std::vector<Paint> materials;
  std::vector<MeshDescription> meshes;
  std::vector<Skin> skins;
  std::vector<Lens> cameras;
  std::vector<Lamp> lights;
  std::vector<Node> nodes;
  std::vector<uint32_t> roots;  // of the default scene
  Notices notices;              // about skipped data
};

/// Parses a .gltf file or the JSON of a .glb.
Document parse_document(std::string_view json);

/// The parts of a .glb.
struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};
Chunks chunks_of(std::string_view file);

/// The bytes of all buffers, and their total size.
class Buffers {
 public:
  /// `chunk`: the binary chunk of a .glb; empty if there is none.
  Buffers(const Document& document, std::optional<std::string_view> chunk,
          const ReadOptions& options);

  std::string_view view(uint32_t number, const std::string& user) const;
  size_t total_bytes() const { return total_; }

 private:
  const Document& document_;
  std::vector<std::string> own_;
  std::vector<std::string_view> bytes_;
  size_t total_ = 0;
};

/// Reads the elements of one accessor.
class Elements {
 public:
  /// The number of components must be from `least` to `most`.
  Elements(const Document& document, const Buffers& buffers, uint32_t accessor, uint32_t least,
           uint32_t most);

  size_t count() const { return accessor_.count; }
  uint32_t components() const { return accessor_.components; }
  /// The components of an element; normalized integers become -1 to 1.
  std::array<double, 4> numbers(size_t i) const;
  /// The first three rows of a 4 x 4 matrix.
  std::array<double, 12> matrix(size_t i) const;
  /// An element as a whole number.
  uint32_t whole(size_t i) const;
  /// "/accessors/3, element 7"
  std::string place(size_t i) const;

 private:
  const char* element(size_t i) const;
  void take_sparse(const Buffers& buffers);

  const Accessor& accessor_;
  uint32_t number_;
  size_t stride_ = 0, size_ = 0;
  std::string_view bytes_;          // from the first element; empty: all zeros
  std::vector<uint32_t> replaced_;  // indices of sparse elements, ascending
  std::string_view replacements_;
};

/// Decodes a data: URI; fails with its JSON pointer `what`.
std::string decode_data_uri(std::string_view uri, const std::string& what);
/// The file name in a URI, with %20 and the like decoded; fails for http: and similar schemes.
std::string file_of_uri(std::string_view uri, const std::string& what);

/// Memory requested so far, in bytes; at most half of what is available.
class MemoryCount {
 public:
  void take(double bytes);

 private:
  double bytes_ = 0;
};

}  // namespace raio::core::gltf
