#include "integrate/path_scene.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

namespace raio::core {
namespace {

float luminance(Rgb c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

// docs/materials.md. Mirrors stay sharp, or have the roughness of P3F; what would reflect more than
// it receives is scaled down.
PathMaterial mapped(const Material& m, Rgb specular, float roughness) {
  PathMaterial out;
  const float all = m.kd * max_component(m.color) + m.ks * max_component(specular) + m.transmission;
  const float scale = all > 1 ? 1 / all : 1;
  out.diffuse = m.kd * scale;
  out.roughness = std::min(roughness, 1.0f);
  out.ior = m.ior > 0 ? m.ior : 1;
  if (m.transmission > 0) {
    // Glass divides the light between reflection and refraction itself.
    out.transmission = std::min((m.ks + m.transmission) * scale, 1.0f);
    out.is_white = 1;
    if (out.transmission < 1) out.diffuse /= 1 - out.transmission;
  } else {
    out.mirror = specular * (m.ks * scale);
  }
  return out;
}

PathMaterial mapped(const Material& m, const StandardSurface& s) {
  PathMaterial out;
  out.metallic = s.metallic, out.roughness = s.roughness;
  out.specular = s.specular_color * s.specular;
  const float brightest = max_component(out.specular);
  if (brightest > 1) out.specular = out.specular / brightest;
  out.transmission = s.transmission, out.is_thin = float(s.is_thin), out.ior = m.ior;
  if (s.attenuation_distance > 0 && !s.is_thin) {
    for (int c = 0; c < 3; ++c) out.attenuation[c] = std::min(s.attenuation_color[c], 1.0f);
    out.per_attenuation_distance = 1 / s.attenuation_distance;
  }
  if (s.is_unlit) out.diffuse = out.metallic = out.transmission = 0, out.specular = Rgb(0);
  out.emission = s.emission, out.is_two_sided = float(s.is_two_sided);
  out.normal_scale = s.normal_scale;
  if (!s.is_unlit) {
    out.clearcoat = s.coat, out.clearcoat_roughness = s.coat_roughness;
    for (int c = 0; c < 3; ++c) out.sheen[c] = std::min(s.sheen_color[c], 1.0f);
    out.sheen_roughness = s.sheen_roughness;
  }
  out.metallic_roughness_texture = s.metallic_roughness_texture;
  out.normal_texture = s.normal_texture, out.emission_texture = s.emission_texture;
  out.transmission_texture = s.transmission_texture;
  return out;
}

EnergyTables::Layers layers_of(const PathMaterial& m) {
  return {m.clearcoat, m.clearcoat_roughness, max_component(m.sheen), m.sheen_roughness};
}

void set_tables(PathMaterial& m, EnergyTables& energy) {
  const EnergyTables::Layers layers = layers_of(m);
  if (layers.any()) m.layers = energy.layers(layers);
  const bool is_metal = m.metallic == 1 && m.metallic_roughness_texture == kNoTexture;
  const bool has_interface = m.transmission > 0 || max_component(m.specular) > 0;
  const bool is_dielectric = m.ior != 1 && has_interface && !is_metal;
  // Computing tables takes longer than tracing a small picture.
  const bool is_mirror = m.metallic > 0 || max_component(m.mirror) > 0;
  const bool needs_conductor = is_mirror || !is_dielectric || (m.is_thin > 0 && m.transmission > 0);
  const auto set = [&](const EnergyTables::Layers& above) {
    m.conductor = energy.conductor(needs_conductor ? above : EnergyTables::Layers());
    m.reflection = m.entering = m.leaving = m.conductor;
    if (!is_dielectric) return;
    const auto tables = energy.dielectric(m.ior, above, m.transmission > 0);
    m.reflection = tables.reflection;
    if (m.is_thin == 0) m.entering = tables.entering, m.leaving = tables.leaving;
  };
  set({});
  m.inner_conductor = m.conductor, m.inner_reflection = m.reflection;
  m.inner_entering = m.entering;
  if (layers.any()) set(layers);
}

uint64_t key_of(InstanceId instance, PrimitiveId primitive) {
  return uint64_t(instance) << 32 | primitive;
}

LightBounds bounds_of(const TriangleLight& t) {
  LightBounds b;
  for (const Vec3f p : {t.corner, t.corner + t.edge1, t.corner + t.edge2}) b.box.extend(p);
  b.axis = t.normal, b.cos_normals = 1, b.cos_emission = 0, b.two_sided = t.is_two_sided > 0;
  b.power = luminance(t.emission) * t.area * float(std::numbers::pi) * (b.two_sided ? 2 : 1);
  return b;
}

LightBounds bounds_of(const SampledLight& l) {
  LightBounds b;
  const Vec3f round = l.is_round ? l.edge_u + l.edge_v : Vec3f();
  b.box.extend(l.position - round);
  b.box.extend(l.position + l.edge_u + l.edge_v);
  if (l.is_round)
    b.box.extend(l.position - l.edge_u + l.edge_v), b.box.extend(l.position + l.edge_u - l.edge_v);
  else
    b.box.extend(l.position + l.edge_u), b.box.extend(l.position + l.edge_v);
  const bool is_directed = l.has_area || l.least_cosine > -1;
  b.axis = is_directed ? l.axis : Vec3f(0, 0, 1);
  b.cos_normals = is_directed ? 1.0f : -1.0f;
  b.cos_emission = l.has_area ? std::max(l.least_cosine, 0.0f) : std::max(l.least_cosine, -1.0f);
  b.two_sided = l.is_two_sided;
  b.power = luminance(l.emission) * float(std::numbers::pi) * (l.has_area ? 1 : 4);
  return b;
}

// The tables of earlier pictures. Computing them takes longer than tracing a small picture, and a
// window or an inspector prepares the same scene again and again.
class RememberedTables {
 public:
  EnergyTables recall() {
    const std::scoped_lock lock(mutex_);
    return tables_;
  }
  void remember(const EnergyTables& tables) {
    const std::scoped_lock lock(mutex_);
    if (tables.size() > tables_.size() && tables.size() <= kMost) tables_ = tables;
  }

 private:
  static constexpr size_t kMost = size_t(1) << 20;  // numbers
  std::mutex mutex_;
  EnergyTables tables_;
};
RememberedTables& remembered_tables() {
  static RememberedTables tables;
  return tables;
}

}  // namespace

PathLights::PathLights(const Scene& scene, const Geometry& geometry,
                       const std::vector<SampledLight>& lights) {
  for (const SampledLight& light : lights) {
    if (light.emission == Rgb()) continue;
    (light.decreases && !light.is_distant ? near_ : distant_).push_back(light);
  }
  if (scene.has_emission()) add_triangles(geometry, {}, 0);
  std::ranges::sort(numbers_);
  if (!scene.environment.empty()) {
    environment_.emplace(scene.environment[0], scene.environment_texels);
    if (environment_->is_black()) environment_.reset();
  }
  std::vector<LightBounds> bounds;
  bounds.reserve(near_.size() + triangles_.size());
  for (const SampledLight& light : near_) bounds.push_back(bounds_of(light));
  for (const TriangleLight& light : triangles_) bounds.push_back(bounds_of(light));
  if (!bounds.empty()) tree_.emplace(bounds);
  kinds_ = (tree_ ? 1 : 0) + distant_.size() + (environment_ ? 1 : 0);
  if (kinds_ > 0) far_probability_ = 1 / float(kinds_);
}

void PathLights::add_triangles(const Geometry& geometry, const std::vector<Placement>& places,
                               InstanceId instance) {
  const Scene& scene = geometry.scene();
  const auto to_scene = [&](Vec3d p) {
    for (const Placement& place : places) p = place.point(p);
    return p;
  };
  for (uint32_t i = 0; i < geometry.count(PrimitiveKind::triangle); ++i) {
    const MaterialId material = geometry.facet(i).material;
    const StandardSurface* const surface = scene.standard_surface_of(material);
    if (!surface || surface->emission == Rgb()) continue;
    const Triangle t = geometry.triangle(i);
    const Vec3d a = to_scene(Vec3d(t.a)), b = to_scene(Vec3d(t.b)), c = to_scene(Vec3d(t.c));
    Vec3d normal(geometry.facet(i).normal);
    for (const Placement& place : places) normal = place.normal(normal);
    TriangleLight light;
    light.corner = Vec3f(a), light.edge1 = Vec3f(b - a), light.edge2 = Vec3f(c - a);
    light.normal = Vec3f(normal);
    light.area = float(length(cross(b - a, c - a)) / 2);
    // Transparent triangles emit where they stop rays.
    const uint32_t depth = geometry.depth_of(PrimitiveKind::triangle, i);
    light.emission = surface->emission * (depth == kOpaque ? 1 : 1 - passed(depth));
    light.is_two_sided = float(surface->is_two_sided);
    light.triangle = i, light.geometry = &geometry, light.material = material;
    light.emission_texture = surface->emission_texture;
    if (!(light.area > 0)) continue;
    numbers_.emplace_back(key_of(instance, geometry.id_of(PrimitiveKind::triangle, i)),
                          uint32_t(triangles_.size()));
    triangles_.push_back(light);
  }
  if (!geometry.has_instances()) return;
  for (uint32_t i = 0; i < geometry.object().instances.size(); ++i) {
    const InstanceId first = geometry.instance_id(i);
    std::vector<Placement> inner = {geometry.placement(i)};
    inner.insert(inner.end(), places.begin(), places.end());
    add_triangles(geometry.placed(first).object, inner, instance + first);
  }
}

PathLights::Choice PathLights::choose(Vec3f point, Vec3f normal, float u) const {
  using Kind = Choice::Kind;
  if (kinds_ == 0) return {};
  const float along = u * float(kinds_);
  const auto which = std::min(size_t(along), kinds_ - 1);
  const float rest = std::min(along - float(which), 1 - 0x1p-24f);
  if (which < distant_.size()) return {Kind::distant, uint32_t(which), far_probability_};
  if (environment_ && which == distant_.size()) return {Kind::environment, 0, far_probability_};
  const LightChoice choice = tree_->choose(point, normal, rest);
  if (choice.probability == 0) return {};
  const bool is_near = choice.light < near_.size();
  return {is_near ? Kind::near : Kind::triangle,
          is_near ? choice.light : choice.light - uint32_t(near_.size()),
          choice.probability * far_probability_};
}

std::optional<uint32_t> PathLights::triangle_at(const Hit& hit) const {
  const uint64_t key = key_of(hit.instance, hit.primitive);
  const auto at =
      std::ranges::lower_bound(numbers_, key, {}, &std::pair<uint64_t, uint32_t>::first);
  if (at == numbers_.end() || at->first != key) return std::nullopt;
  return at->second;
}

float PathLights::triangle_probability(Vec3f point, Vec3f normal, uint32_t triangle) const {
  return tree_->probability(point, normal, uint32_t(near_.size()) + triangle) * far_probability_;
}

PathScene::PathScene(const Scene& scene, const Geometry& geometry,
                     const std::vector<SampledLight>& lights)
    : energy(remembered_tables().recall()), lights(scene, geometry, lights) {
  for (MaterialId id = 0; id < scene.materials.size(); ++id) {
    const StandardSurface* const surface = scene.standard_surface_of(id);
    const Material& m = scene.materials[id];
    PathMaterial out =
        surface ? mapped(m, *surface) : mapped(m, scene.specular_of(id), scene.roughness_of(id));
    any_textures |=
        surface && (out.metallic_roughness_texture != kNoTexture ||
                    out.emission_texture != kNoTexture || out.transmission_texture != kNoTexture);
    any_normal_maps |= out.normal_texture != kNoTexture;
    set_tables(out, energy);
    any_layers |= layers_of(out).any();
    materials.push_back(out);
  }
  remembered_tables().remember(energy);
}

}  // namespace raio::core
