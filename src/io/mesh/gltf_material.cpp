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
    if (look_.textured)
      pbr["baseColorTexture"] = {{"index", scene_.material_texture[look_.material]}};
    if (look_.opacity < 1) out["alphaMode"] = "BLEND";
    return out;
  }

 private:
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
