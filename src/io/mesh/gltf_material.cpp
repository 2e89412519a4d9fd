#include "io/mesh/gltf_material.h"

#include <algorithm>
#include <cmath>

#include "base/srgb.h"

namespace raio::core::gltf {
namespace {

using Json = nlohmann::json;

class GltfMaterial {
 public:
  GltfMaterial(const Scene& scene, const GltfAppearance& look)
      : scene_(scene), look_(look), m_(scene.materials[look.material]) {}

  Json json() const {
    const StandardSurface* const surface = scene_.standard_surface_of(look_.material);
    return surface ? json_of(*surface) : json_of_classic();
  }

 private:
  Json json_of_classic() const {
    // Raio shows both sides of surfaces.
    Json out = {{"doubleSided", true}};
    const double transmitted = std::clamp(double(m_.transmission), 0.0, 1.0);
    Json& pbr = out["pbrMetallicRoughness"];
    const Vec3d diffuse = light(look_.color * m_.kd);
    Vec3d base = diffuse;
    double metallic = 0;
    if (transmitted > 0) {
      // Raio does not tint transmitted light.
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
    put_texture(pbr, "baseColorTexture", scene_.texture_of(look_.material));
    if (look_.opacity < 1) out["alphaMode"] = "BLEND";
    return out;
  }

  Json json_of(const StandardSurface& s) const {
    Json out = {{"doubleSided", s.is_two_sided != 0}};
    Json& pbr = out["pbrMetallicRoughness"];
    const Vec3d base = light(look_.color);
    pbr = {{"baseColorFactor", {base.x, base.y, base.z, double(look_.opacity)}},
           {"metallicFactor", s.metallic},
           {"roughnessFactor", s.roughness}};
    put_texture(pbr, "baseColorTexture", scene_.texture_of(look_.material));
    if (s.alpha_mode == AlphaMode::mask)
      out["alphaMode"] = "MASK", out["alphaCutoff"] = s.alpha_cutoff;
    else if (s.alpha_mode == AlphaMode::blend || look_.opacity < 1)
      out["alphaMode"] = "BLEND";
    if (s.is_unlit) {
      out["extensions"]["KHR_materials_unlit"] = Json::object();
      return out;
    }
    put_texture(pbr, "metallicRoughnessTexture", s.metallic_roughness_texture);
    if (put_texture(out, "normalTexture", s.normal_texture))
      out["normalTexture"]["scale"] = s.normal_scale;
    put_emission(s, out);
    if (Json extensions = extensions_of(s); !extensions.empty())
      for (auto& [name, value] : extensions.items()) out["extensions"][name] = std::move(value);
    return out;
  }

  bool put_texture(Json& to, const char* key, uint32_t texture) const {
    if (!look_.textured || texture == kNoTexture) return false;
    to[key] = {{"index", texture}};
    return true;
  }

  static Json numbers(Rgb color) { return {double(color.x), double(color.y), double(color.z)}; }

  void put_emission(const StandardSurface& s, Json& out) const {
    if (s.emission == Rgb()) return;
    const float strength = std::max(1.0f, max_component(s.emission));
    out["emissiveFactor"] = numbers(s.emission / strength);
    put_texture(out, "emissiveTexture", s.emission_texture);
    if (strength > 1)
      out["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
  }

  // Those whose numbers are not the defaults.
  Json extensions_of(const StandardSurface& s) const {
    const StandardSurface usual;
    Json out = Json::object();
    if (m_.ior != kUsualIor) out["KHR_materials_ior"] = {{"ior", std::max(1.0f, m_.ior)}};
    if (s.specular != usual.specular || s.specular_color != usual.specular_color)
      out["KHR_materials_specular"] = {{"specularFactor", s.specular},
                                       {"specularColorFactor", numbers(s.specular_color)}};
    if (s.transmission > 0) {
      Json& transmission = out["KHR_materials_transmission"];
      transmission["transmissionFactor"] = s.transmission;
      put_texture(transmission, "transmissionTexture", s.transmission_texture);
    }
    if (!s.is_thin) {
      Json& volume = out["KHR_materials_volume"];
      volume = {{"thicknessFactor", 1}, {"attenuationColor", numbers(s.attenuation_color)}};
      if (s.attenuation_distance > 0) volume["attenuationDistance"] = s.attenuation_distance;
    }
    if (s.coat > 0)
      out["KHR_materials_clearcoat"] = {{"clearcoatFactor", s.coat},
                                        {"clearcoatRoughnessFactor", s.coat_roughness}};
    if (s.sheen_color != usual.sheen_color)
      out["KHR_materials_sheen"] = {{"sheenColorFactor", numbers(s.sheen_color)},
                                    {"sheenRoughnessFactor", s.sheen_roughness}};
    return out;
  }

  // Index of refraction in glTF without its extension.
  static constexpr float kUsualIor = 1.5f;
  // Reflectance of a non-metal in glTF.
  static constexpr double kDielectric = 0.04;

  // Classic shading computes display values, glTF linear light.
  Vec3d light(Rgb color) const {
    if (scene_.dialect != Dialect::data)
      for (int i = 0; i < 3; ++i) color[i] = linear_from_srgb(color[i]);
    return Vec3d(color);
  }
  static double brightness(Vec3d c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

  // The metallic factor for which base (1 - metallic) is the diffuse colour and the specular part
  // is that of the metal; the conversion of KHR_materials_pbrSpecularGlossiness.
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

  // Converts the width of Phong's highlight to a microfacet roughness (Walter et al. 2007,
  // "Microfacet Models for Refraction through Rough Surfaces", EGSR); glTF squares it.
  double roughness() const {
    return m_.ks > 0 ? std::sqrt(std::sqrt(2 / (double(m_.shine) + 2))) : 1;
  }

  const Scene& scene_;
  const GltfAppearance& look_;
  const Material& m_;
};

}  // namespace

Json material_of(const Scene& scene, const GltfAppearance& look) {
  return GltfMaterial(scene, look).json();
}

}  // namespace raio::core::gltf
