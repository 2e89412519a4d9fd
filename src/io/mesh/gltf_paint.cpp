#include "io/mesh/gltf_paint.h"

#include <algorithm>

#include "base/exact_math.h"

namespace raio::core::gltf {
namespace {

// F0, the reflectance of a dielectric with the usual index of refraction, 1.5.
constexpr float kUsualReflectance = 0.04f;

class PaintReader {
 public:
  PaintReader(const Value& material, size_t textures, Notices& notices)
      : value_(material), texture_count_(textures), notices_(notices) {}

  Paint read() {
    out_.name = label(value_);
    if (const auto both = value_.find("doubleSided")) s_.is_two_sided = both->truth();
    if (const auto old = extension("pbrSpecularGlossiness", {"specularGlossinessTexture"}))
      take_specular_glossiness(*old);
    else if (const auto pbr = value_.find("pbrMetallicRoughness"))
      take_metallic_roughness(*pbr);
    take_alpha();
    take_emission();
    if (const auto normal = take_texture(value_, "normalTexture", Slot::normal))
      if (const auto scale = normal->find("scale")) s_.normal_scale = float(scale->number());
    take_dielectric();
    take_transmission();
    take_layers();
    if (extension("unlit", {})) make_unlit();
    return std::move(out_);
  }

 private:
  // Returns the texture's object.
  std::optional<Value> take_texture(const Value& from, const char* key, Slot slot) {
    const auto given = from.find(key);
    if (!given) return given;
    TextureUse& use = out_.textures[size_t(slot)].emplace();
    use.texture = index_of(given->at("index"), "textures", texture_count_);
    const auto take_set = [&](const Value& of) {
      if (const auto set = of.find("texCoord")) use.set = uint32_t(set->whole(0, 65535));
    };
    take_set(*given);
    if (const auto moved = given->extension("KHR_texture_transform")) {
      if (const auto offset = moved->find("offset")) use.offset = offset->numbers<2>();
      if (const auto scale = moved->find("scale")) use.scale = scale->numbers<2>();
      if (const auto rotation = moved->find("rotation"))
        use.cosine = exact_cos(rotation->number()), use.sine = exact_sin(rotation->number());
      take_set(*moved);
    }
    return given;
  }

  // An extension of materials, such as "specular", without its textures `lost`.
  std::optional<Value> extension(std::string_view name, std::initializer_list<const char*> lost) {
    const std::string whole = "KHR_materials_" + std::string(name);
    auto found = value_.extension(whole.c_str());
    for (const char* texture : lost)
      if (found && found->has(texture))
        notices_.add(Severity::left_out, fmt::format("textures of {}", name), out_.name);
    return found;
  }

  void take_base_color(const Value& from, const char* factor, const char* texture) {
    if (const auto color = from.find(factor)) {
      const auto numbers = color->numbers<4>();
      for (size_t i = 0; i < 4; ++i) {
        if (numbers[i] < 0 || numbers[i] > 1) color->fail_expected("numbers from 0 to 1");
        out_.color[i] = float(numbers[i]);
      }
    }
    take_texture(from, texture, Slot::color);
  }

  void take_metallic_roughness(const Value& pbr) {
    take_base_color(pbr, "baseColorFactor", "baseColorTexture");
    s_.metallic = number_or(1, pbr, "metallicFactor");
    s_.roughness = number_or(1, pbr, "roughnessFactor");
    take_texture(pbr, "metallicRoughnessTexture", Slot::metallic_roughness);
  }

  // A dielectric whose F0 is the specular colour.
  void take_specular_glossiness(const Value& old) {
    take_base_color(old, "diffuseFactor", "diffuseTexture");
    s_.metallic = 0;
    s_.roughness = 1 - number_or(1, old, "glossinessFactor");
    s_.specular_color = color_or(Rgb(1), old, "specularFactor") / kUsualReflectance;
  }

  void take_alpha() {
    const auto mode = value_.find("alphaMode");
    if (!mode || mode->string() == "OPAQUE") return;
    if (mode->string() == "BLEND") {
      s_.alpha_mode = AlphaMode::blend;
    } else if (mode->string() == "MASK") {
      s_.alpha_mode = AlphaMode::mask;
      s_.alpha_cutoff = number_or(0.5f, value_, "alphaCutoff", kBrightest);
    } else {
      mode->fail_expected("OPAQUE, MASK or BLEND");
    }
  }

  void take_emission() {
    const auto strong = extension("emissive_strength", {});
    s_.emission = color_or(Rgb(), value_, "emissiveFactor", kBrightest) *
                  (strong ? number_or(1, *strong, "emissiveStrength", kBrightest) : 1);
    take_texture(value_, "emissiveTexture", Slot::emission);
    drop_unless(s_.emission != Rgb(), Slot::emission);
  }

  void take_dielectric() {
    if (const auto specular = extension("specular", {"specularTexture", "specularColorTexture"})) {
      s_.specular = number_or(1, *specular, "specularFactor");
      s_.specular_color = color_or(Rgb(1), *specular, "specularColorFactor", kBrightest);
    }
    const auto refraction = extension("ior", {});
    const auto ior = refraction ? refraction->find("ior") : std::nullopt;
    if (!ior) return;
    const double index = ior->number();
    if (index == 0) {
      // Reflects everything, for materials that were of specular-glossiness.
      s_.specular_color = s_.specular_color / kUsualReflectance;
    } else if (index >= 1 && index <= kBrightest) {
      out_.ior = float(index);
    } else {
      ior->fail_expected("0, or a number of at least 1");
    }
  }

  void take_transmission() {
    if (const auto transmission = extension("transmission", {})) {
      s_.transmission = number_or(0, *transmission, "transmissionFactor");
      take_texture(*transmission, "transmissionTexture", Slot::transmission);
      drop_unless(s_.transmission > 0, Slot::transmission);
    }
    // The texture of the thickness is for programs that trace no rays.
    const auto volume = extension("volume", {});
    if (!volume) return;
    s_.is_thin = number_or(0, *volume, "thicknessFactor", kBrightest) == 0;
    s_.attenuation_color = color_or(Rgb(1), *volume, "attenuationColor");
    s_.attenuation_distance = number_or(0, *volume, "attenuationDistance", 1e30);
  }

  // Without the texture that masks them, layers would cover everything, so they are left out.
  void take_layers() {
    if (const auto coat = extension("clearcoat", {"clearcoatTexture", "clearcoatRoughnessTexture",
                                                  "clearcoatNormalTexture"})) {
      s_.coat = number_or(0, *coat, "clearcoatFactor");
      if (coat->has("clearcoatTexture")) s_.coat = 0;
      s_.coat_roughness = number_or(0, *coat, "clearcoatRoughnessFactor");
    }
    if (const auto sheen = extension("sheen", {"sheenColorTexture", "sheenRoughnessTexture"})) {
      s_.sheen_color = color_or(Rgb(), *sheen, "sheenColorFactor");
      if (sheen->has("sheenColorTexture")) s_.sheen_color = {};
      s_.sheen_roughness = number_or(0, *sheen, "sheenRoughnessFactor");
    }
  }

  // Whatever else the material has is for programs without the extension.
  void make_unlit() {
    for (const Slot slot :
         {Slot::metallic_roughness, Slot::normal, Slot::emission, Slot::transmission})
      drop_unless(false, slot);
    s_.is_unlit = 1;
  }

  // A texture without effect need not be read.
  void drop_unless(bool needed, Slot slot) {
    if (!needed) out_.textures[size_t(slot)].reset();
  }

  const Value& value_;
  size_t texture_count_;
  Notices& notices_;
  Paint out_;
  StandardSurface& s_ = out_.surface;
};

}  // namespace

Paint paint_of(const Value& material, size_t textures, Notices& notices) {
  return PaintReader(material, textures, notices).read();
}

}  // namespace raio::core::gltf
