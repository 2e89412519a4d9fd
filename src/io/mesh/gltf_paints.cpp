#include "io/mesh/gltf_paints.h"

#include <fmt/format.h>

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

 private:
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
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const Paint& paint = document.materials[i];
    const uint32_t texture =
        paint.texture ? pictures.texture_of(paint.texture->texture) : kNoTexture;
    if (texture != kNoTexture && (paint.blends || paint.masks))
      notices.add(Severity::left_out, "alpha of textures", paint.name);
    const Rgb color(paint.color[0], paint.color[1], paint.color[2]);
    of_[i] = scene.add_material({.color = color, .kd = 1}, Rgb(1), 0,
                                paint.blends ? paint.color[3] : 1, texture);
  }
  if (any_plain || scene.materials.empty()) plain_ = scene.add_material({.color = Rgb(1), .kd = 1});
}

}  // namespace raio::core::gltf
