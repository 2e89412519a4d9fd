#include "io/mesh/gltf_paints.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/file.h"
#include "io/mesh/builder.h"
#include "io/textures.h"

namespace raio::core::gltf {
namespace {

/// Decodes textures on first use.
class Pictures {
 public:
  Pictures(const Document& document, const Buffers& buffers, const ReadOptions& options,
           Scene& scene, Notices& notices)
      : document_(document),
        buffers_(buffers),
        options_(options),
        scene_(scene),
        notices_(notices) {}

  uint32_t texture_of(const Paint& paint, Slot slot) {
    const auto& use = paint.textures[size_t(slot)];
    if (!use) return kNoTexture;
    if (use->has_coordinates_of(*paint.coordinates())) return texture_of(use->texture);
    notices_.add(Severity::left_out,
                 fmt::format("{} textures with other coordinates than the material's first texture",
                             kSlotNames[size_t(slot)]),
                 paint.name);
    return kNoTexture;
  }

 private:
  uint32_t texture_of(uint32_t number) {
    const PictureTexture& texture = document_.textures[number];
    if (!texture.image) {
      tell(fmt::format("/textures/{}: it has no source", number));
      return kNoTexture;
    }
    const std::string what = fmt::format("/images/{}", *texture.image);
    const auto added = picture(document_.images[*texture.image], what, [&](std::string_view bytes) {
      return textures_.add(scene_, bytes, texture.wrap_u, texture.wrap_v);
    });
    if (added) return *added;
    tell(fmt::format("{}: {}", what, added.error()));
    return kNoTexture;
  }

  void tell(std::string_view why) {
    notices_.add(Severity::left_out, "unreadable textures, replaced by plain colours", why);
  }

  template <class Add>
  std::expected<uint32_t, std::string> picture(const PictureSource& image, const std::string& what,
                                               const Add& add) const try {
    if (image.view) return add(buffers_.view(*image.view, what));
    if (image.uri.starts_with("data:")) return add(decode_data_uri(image.uri, what + "/uri"));
    const std::string name = file_of_uri(image.uri, what + "/uri");
    const auto bytes = options_.folder ? read_beside(*options_.folder, name)
                                       : std::unexpected("the scene has no folder to search");
    if (!bytes) return std::unexpected(fmt::format("{}: {}", core::quoted(name), bytes.error()));
    return add(*bytes);
  } catch (const ReadFailure& failure) {
    return std::unexpected(failure.message);
  }

  const Document& document_;
  const Buffers& buffers_;
  const ReadOptions& options_;
  Scene& scene_;
  Notices& notices_;
  TextureReader textures_;
};

StandardSurface surface_of(const Paint& paint, Pictures& pictures) {
  StandardSurface out = paint.surface;
  // Without its texture, a factor would apply everywhere, and most are 1.
  const auto take = [&](Slot slot, uint32_t& texture, auto&... factors) {
    if (!paint.textures[size_t(slot)]) return;
    texture = pictures.texture_of(paint, slot);
    if (texture == kNoTexture) ((factors = {}), ...);
  };
  take(Slot::metallic_roughness, out.metallic_roughness_texture, out.metallic);
  take(Slot::normal, out.normal_texture);
  take(Slot::emission, out.emission_texture, out.emission);
  take(Slot::transmission, out.transmission_texture, out.transmission);
  return out;
}

}  // namespace

Paints::Paints(const Document& document, const Buffers& buffers, const ReadOptions& options,
               const NodeTree& nodes, Scene& scene, Notices& notices) {
  Pictures pictures(document, buffers, options, scene, notices);
  std::vector<bool> used(document.materials.size());
  bool any_plain = false;
  const auto take = [&](const Use& use) {
    for (const MeshPrimitive& p : document.meshes[use.number].primitives) {
      if (p.material)
        used[*p.material] = true;
      else
        any_plain = true;
    }
  };
  for (const Use& use : nodes.meshes()) take(use);
  for (const Use& use : nodes.posed()) take(use);
  of_.resize(used.size());
  // All base colours first, in case the textures are too many.
  std::vector<uint32_t> textures(used.size(), kNoTexture);
  for (size_t i = 0; i < used.size(); ++i)
    if (used[i]) textures[i] = pictures.texture_of(document.materials[i], Slot::color);
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const Paint& paint = document.materials[i];
    const Rgb color(paint.color[0], paint.color[1], paint.color[2]);
    const bool is_opaque = paint.surface.alpha_mode == AlphaMode::opaque;
    const StandardSurface surface = surface_of(paint, pictures);
    of_[i] = scene.add_standard_material(surface, {.color = color, .kd = 1, .ior = paint.ior},
                                         is_opaque ? 1 : paint.color[3], textures[i]);
  }
  if (!any_plain && !scene.materials.empty()) return;
  const Paint plain;
  plain_ = scene.add_standard_material(plain.surface, {.color = Rgb(1), .kd = 1, .ior = plain.ior});
}

}  // namespace raio::core::gltf
