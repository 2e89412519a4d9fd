// raio explain --json: all numbers of a sample, from which its colour can be recomputed.
#include <cmath>
#include <string>

#include "app/explain.h"
#include "app/json.h"
#include "app/test_numbers.h"
#include "shape/kinds.h"

namespace raio::core::app {
namespace {

using Kind = ExplainedRay::Kind;

template <class T>
Json json_of(Vec3<T> v) {
  return {plain(v.x), plain(v.y), plain(v.z)};
}
Json json_of(const Geometry& geometry, PrimitiveId id) {
  return {{"kind", kPrimitiveKindNames[size_t(geometry.kind_of(id))]},
          {"index", geometry.index_of(id)}};
}
Json distance(float t) { return std::isfinite(t) ? Json(plain(t)) : Json(nullptr); }
Json json_or_null(const std::optional<float>& x) { return x ? Json(plain(*x)) : Json(nullptr); }

class JsonTree {
 public:
  explicit JsonTree(const Explained& what)
      : what_(what), sample_(what.sample), geometry_(what.accel.geometry()) {}

  Json json() const {
    const RenderSettings& o = what_.settings;
    Json json{{"version", RAIO_VERSION},
              {"scene", what_.scene.name},
              {"pixel", what_.pixel},
              {"sample", what_.number},
              {"samples", o.samples_per_pixel()},
              {"rgb", json_of(sample_.rgb)},
              {"unit", sample_.unit},
              {"integrator", kIntegratorNames[size_t(o.integrator)]},
              {"depth", o.depth},
              {"structure", accel_name(o.accel.kind)},
              {"shading", shading_name(o.shading)},
              {"fresnel", fresnel_name(o.fresnel)},
              {"ambient", plain(sample_.ambient)},
              {"camera", camera()}};
    json["lights"] = Json::array();
    for (const PreparedScene::Emitter& light : sample_.lights) {
      Json one{{"position", json_of(place(light.position))},
               {"intensity", json_of(light.intensity)}};
      if (o.soft_shadows) one["sides"] = {json_of(light.edge_u), json_of(light.edge_v)};
      json["lights"].push_back(std::move(one));
    }
    json["rays"] = Json::array();
    for (size_t i = 0; i < sample_.rays.size(); ++i) json["rays"].push_back(ray(i));
    return json;
  }

 private:
  Vec3d place(Vec3f p) const { return what_.scene.origin + plain(p); }

  Json camera() const {
    const Camera& c = what_.settings.camera;
    return {{"from", json_of(place(c.from))},
            {"at", json_of(place(c.at))},
            {"up", json_of(c.up)},
            {"angle", plain(c.fov_deg)},
            {"parallel", c.is_parallel()},
            {"width", what_.settings.width},
            {"height", what_.settings.height}};
  }

  Json ray(size_t id) const {
    const ExplainedRay& r = sample_.rays[id];
    const bool shadow = r.kind == Kind::shadow;
    const TraceLog::Test* const by = shadow && r.occluded ? stopper(what_.logs[id]) : nullptr;
    const bool hit = r.hit.found() || by;
    Json json{{"id", id},
              {"parent", r.parent < 0 ? Json(nullptr) : Json(r.parent)},
              {"kind", word_of(r.kind)},
              {"level", r.level},
              {"light", r.light < 0 ? Json(nullptr) : Json(r.light)},
              {"origin", json_of(place(r.ray.origin))},
              {"direction", json_of(r.ray.dir)},
              {"tmax", distance(r.ray.tmax)},
              {"time", plain(r.ray.time)},
              {"traced", r.traced},
              {"t", hit ? distance(by ? by->t : r.hit.t) : Json(nullptr)},
              {"primitive",
               hit ? json_of(geometry_, by ? by->primitive : r.hit.primitive) : Json(nullptr)},
              {"weight", json_of(r.weight)},
              {"terms",
               {{"ambient", json_of(r.ambient)},
                {"diffuse", json_of(r.diffuse)},
                {"highlight", json_of(r.highlight)},
                {"background", json_of(r.background)}}}};
    if (shadow) json["occluded"] = r.occluded;
    if (r.lit) {
      const bool blinn = what_.settings.shading == ShadingModel::blinn_phong;
      json["n_dot_l"] = plain(r.lit->n_dot_l);
      json[blinn ? "h" : "r"] = json_of(r.lit->direction);
      json[blinn ? "n_dot_h" : "r_dot_v"] = plain(r.lit->cosine);
      json["power"] = plain(r.lit->power);
    }
    if (!shadow) json["adds"] = json_of(r.adds);
    if (r.surface) json["surface"] = r.bounce ? surface_of_path(r) : surface(*r.surface);
    if (r.bounce) json["bounce"] = bounce(*r.bounce);
    if (r.escape)
      json["escape"] = {{"light_density", plain(r.escape->light_density)},
                        {"weight", plain(r.escape->weight)}};
    if (what_.logs[id]) add_log(json, r.ray, *what_.logs[id]);
    return json;
  }

  Json surface(const ExplainedRay::Surface& s) const {
    Json json{{"point", json_of(place(s.point))},
              {"normal", json_of(s.normal)},
              {"geometric_normal", json_of(s.geometric)},
              {"material", s.material},
              {"color", json_of(s.color)},
              {"kd", plain(s.kd)},
              {"ks", plain(s.ks)},
              {"specular", json_of(s.specular)},
              {"shine", plain(s.shine)},
              {"transmission", plain(s.transmission)},
              {"ior", plain(s.ior)},
              {"gloss", plain(s.gloss)},
              {"translucency", plain(s.translucency)},
              {"radiance", json_of(s.radiance)}};
    if (s.ks > 0 || s.reflectance) json["mirror_normal"] = json_of(s.mirror_normal);
    if (s.transmission > 0) {
      json["refraction"] = {{"normal", json_of(s.refraction_normal)},
                            {"index_before", plain(s.index_before())},
                            {"index_behind", plain(s.index_behind())},
                            {"eta", plain(s.eta)},
                            {"cosine", plain(s.cosine)},
                            {"cosine2_behind", plain(s.cosine2_behind)},
                            {"reflectance", json_or_null(s.reflectance)}};
    }
    return json;
  }

  Json surface_of_path(const ExplainedRay& r) const {
    const ExplainedRay::Surface& s = *r.surface;
    return {{"point", json_of(place(s.point))},         {"normal", json_of(s.normal)},
            {"geometric_normal", json_of(s.geometric)}, {"material", s.material},
            {"diffuse", json_of(r.bounce->diffuse)},    {"metal", json_of(r.bounce->mirror)},
            {"dielectric", json_of(r.bounce->coat)},    {"glass", plain(r.bounce->glass)},
            {"roughness", plain(r.bounce->roughness)},  {"clearcoat", plain(r.bounce->clearcoat)},
            {"sheen", json_of(r.bounce->sheen)},        {"radiance", json_of(s.radiance)}};
  }
  static Json bounce(const ExplainedRay::Bounce& b) {
    Json json{{"transmittance", json_of(b.transmittance)},
              {"emission", json_of(b.emission)},
              {"emission_density", plain(b.emission_density)},
              {"emission_weight", plain(b.emission_weight)},
              {"density", plain(b.density)},
              {"weight", json_of(b.weight)},
              {"chance", plain(b.chance)},
              {"light", nullptr}};
    if (!b.light.empty())
      json["light"] = {{"name", b.light},
                       {"probability", plain(b.light_probability)},
                       {"density", plain(b.light_density)},
                       {"radiance", json_of(b.light_radiance)},
                       {"bsdf_cosine", json_of(b.light_bsdf)},
                       {"bsdf_density", plain(b.light_bsdf_density)},
                       {"weight", plain(b.light_weight)},
                       {"adds", json_of(b.direct)}};
    return json;
  }

  void add_log(Json& json, const Ray& ray, const TraceLog& log) const {
    const bool grid = what_.settings.accel.kind == AccelKind::grid;
    const bool tree = !grid && !log.steps.empty();
    Json places = Json::array(), leaving = Json::array(), tests = Json::array();
    for (const TraceLog::Step& step : log.steps) {
      if (grid) {
        places.push_back(step.cell);
        leaving.push_back(json_of(step.t_max));
      } else {
        places.push_back({{step.leaf ? "leaf" : "node", step.node},
                          {"depth", step.depth},
                          {"lo", json_of(step.box.lo)},
                          {"hi", json_of(step.box.hi)}});
      }
    }
    size_t next = 0;
    for (size_t k = 0; k < log.tests.size(); ++k) {
      while (next < log.steps.size() && log.steps[next].first_test <= k) ++next;
      tests.push_back(test(ray, log.tests[k]));
      if (!log.steps.empty()) tests.back()["step"] = next == 0 ? Json(nullptr) : Json(next - 1);
    }
    if (grid) {
      json["cells"] = std::move(places), json["t_max"] = std::move(leaving);
      json["t_delta"] = json_of(log.t_delta);
    } else if (tree) {
      json["nodes"] = std::move(places);
    }
    json["tests"] = std::move(tests);
    json["counts"] = {{"steps", log.count_steps()}, {"tests", log.count_tests()}};
  }

  Json test(const Ray& ray, const TraceLog::Test& test) const {
    Json json{{"primitive", json_of(geometry_, test.primitive)},
              {"t", distance(test.t)},
              {"nearest", test.nearest}};
    if (test.repeated) {
      json["repeated"] = true;
      return json;
    }
    for (const auto& [name, value] : test_numbers(geometry_, test.primitive, ray).values)
      json["values"][name] = value.size() == 1 ? Json(value[0]) : Json(value);
    return json;
  }

  const Explained& what_;
  const Explanation& sample_;
  const Geometry& geometry_;
};

}  // namespace

std::string explained_json(const Explained& what) { return json_text(JsonTree(what).json()); }

}  // namespace raio::core::app
