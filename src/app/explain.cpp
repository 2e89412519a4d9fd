// raio explain: one sample of a pixel as a tree of rays, for people or as JSON.
#include "app/explain.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "app/json.h"
#include "app/output.h"
#include "app/terminal.h"
#include "shape/kinds.h"

namespace raio::core::app {
namespace {

using Kind = ExplainedRay::Kind;

constexpr std::string_view kKindNames[] = {"eye", "reflection", "refraction", "shadow"};
std::string_view word_of(Kind kind) { return kKindNames[size_t(kind)]; }

// The shortest digits that read back as the same number.
std::string text_of(Vec3f v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }
std::string text_of(Vec3d v) { return text_of(Vec3f(v)); }
// Positions in the coordinates of the scene's file.
Vec3d place(const Scene& scene, Vec3f p) { return scene.origin + plain(p); }

// A single number if the colours have equal weights.
std::string text_of_weight(Rgb w) { return w == Rgb(w.x) ? fmt::format("{}", w.x) : text_of(w); }

std::string counted(uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

class TextTree {
 public:
  explicit TextTree(const Explained& what) : what_(what), children_(what.sample.rays.size()) {
    for (size_t k = 1; k < children_.size(); ++k)
      children_[size_t(what.sample.rays[k].parent)].push_back(k);
  }

  std::string text() {
    const RenderSettings& o = what_.settings;
    out_ = fmt::format("{}, pixel {},{} of {}x{}, sample {} of {}\ncolour  {}\n", what_.scene.name,
                       what_.pixel[0], what_.pixel[1], o.width, o.height, what_.number,
                       o.samples_per_pixel(), text_of(what_.sample.rgb));
    add_ray(0, "");
    return out_;
  }

 private:
  void line(const std::string& indent, std::string_view name, const std::string& value) {
    out_ += fmt::format("{}{:<12}{}\n", indent, name, value);
  }
  std::string cost(size_t i) const {
    if (!what_.logs[i]) return "";
    const bool cells = what_.settings.accel.kind == AccelKind::grid;
    std::string steps;
    if (const uint64_t n = what_.logs[i]->count_steps(); n > 0)
      steps = cells ? counted(n, "cell, ", "cells, ") : counted(n, "node, ", "nodes, ");
    return fmt::format(" ({}{})", steps, counted(what_.logs[i]->count_tests(), "test", "tests"));
  }

  void add_ray(size_t i, const std::string& indent) {
    const ExplainedRay& r = what_.sample.rays[i];
    out_ += fmt::format("\n{}{} ray, level {}, weight {}, adds {}\n", indent, word_of(r.kind),
                        r.level, text_of_weight(r.weight), text_of(r.brings));
    const std::string in = indent + "  ";
    line(in, "from", text_of(place(what_.scene, r.ray.origin)));
    line(in, "direction", text_of(r.ray.dir));
    if (!r.surface) {
      line(in, r.traced ? "hits" : "ends",
           r.traced ? "nothing" + cost(i)
                    : fmt::format("beyond level {}, the last one traced", what_.settings.depth));
      line(in, "background", text_of(r.background));
      return;
    }
    const ExplainedRay::Surface& s = *r.surface;
    line(in, "hits",
         fmt::format("{} at a distance of {}{}", name_of(geometry(), r.hit.primitive), r.hit.t,
                     cost(i)));
    line(in, "point", text_of(place(what_.scene, s.point)));
    line(in, "normal", text_of(s.normal));
    line(in, "material",
         fmt::format("{}: colour {}, kd {}, ks {}{}, shine {}, transmission {}", s.material,
                     text_of(s.color), s.kd, s.ks,
                     s.specular == Rgb(1) ? "" : " of colour " + text_of(s.specular), s.shine,
                     s.transmission));
    line(in, "ambient", text_of(r.ambient));
    for (size_t l = 0; l < what_.scene.lights.size(); ++l) add_light(l, children_[i], in);
    for (const size_t k : children_[i])
      if (what_.sample.rays[k].kind != Kind::shadow) add_ray(k, in);
  }

  void add_light(size_t l, const std::vector<size_t>& children, const std::string& in) {
    const std::string name = fmt::format("light {}", l);
    for (const size_t k : children) {
      const ExplainedRay& r = what_.sample.rays[k];
      if (r.light != int(l)) continue;
      if (!r.occluded)
        return line(in, name,
                    fmt::format("diffuse {}, highlight {}{}", text_of(r.diffuse),
                                text_of(r.highlight), cost(k)));
      const TraceLog::Test* const by = stopper(what_.logs[k]);
      return line(
          in, name,
          (by ? "in the shadow of " + name_of(geometry(), by->primitive) : "in shadow") + cost(k));
    }
    line(in, name, "behind the surface");
  }

  const Geometry& geometry() const { return what_.accel.geometry(); }

  const Explained& what_;
  std::vector<std::vector<size_t>> children_;  // by ray
  std::string out_;
};

template <class T>
Json json_of(Vec3<T> v) {
  return {plain(v.x), plain(v.y), plain(v.z)};
}
Json json_of(const Geometry& geometry, PrimitiveId id) {
  return {{"kind", kPrimitiveKindNames[size_t(geometry.kind_of(id))]},
          {"index", geometry.index_of(id)}};
}
Json distance(float t) { return std::isfinite(t) ? Json(plain(t)) : Json(nullptr); }

void add_log(Json& json, const TraceLog& log, const Geometry& geometry, bool grid) {
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
    const TraceLog::Test& test = log.tests[k];
    Json one{{"primitive", json_of(geometry, test.primitive)}};
    if (!log.steps.empty()) one["step"] = next == 0 ? Json(nullptr) : Json(next - 1);
    one["t"] = distance(test.t), one["nearest"] = test.nearest;
    if (test.repeated) one["repeated"] = true;
    tests.push_back(std::move(one));
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

Json json_of(const Explained& what, size_t id) {
  const ExplainedRay& r = what.sample.rays[id];
  const bool shadow = r.kind == Kind::shadow;
  const TraceLog::Test* const by = shadow && r.occluded ? stopper(what.logs[id]) : nullptr;
  const bool hit = r.hit.found() || by;
  Json json{{"id", id},
            {"parent", r.parent < 0 ? Json(nullptr) : Json(r.parent)},
            {"kind", word_of(r.kind)},
            {"level", r.level},
            {"light", r.light < 0 ? Json(nullptr) : Json(r.light)},
            {"origin", json_of(place(what.scene, r.ray.origin))},
            {"direction", json_of(r.ray.dir)},
            {"tmax", distance(r.ray.tmax)},
            {"traced", r.traced},
            {"t", hit ? distance(by ? by->t : r.hit.t) : Json(nullptr)},
            {"primitive", hit ? json_of(what.accel.geometry(), by ? by->primitive : r.hit.primitive)
                              : Json(nullptr)},
            {"weight", json_of(r.weight)},
            {"terms",
             {{"ambient", json_of(r.ambient)},
              {"diffuse", json_of(r.diffuse)},
              {"highlight", json_of(r.highlight)},
              {"background", json_of(r.background)}}}};
  if (shadow)
    json["occluded"] = r.occluded;
  else
    json["brings"] = json_of(r.brings);
  if (r.surface) {
    const ExplainedRay::Surface& s = *r.surface;
    json["surface"] = {{"point", json_of(place(what.scene, s.point))},
                       {"normal", json_of(s.normal)},
                       {"geometric_normal", json_of(s.geometric)},
                       {"material", s.material},
                       {"color", json_of(s.color)},
                       {"kd", plain(s.kd)},
                       {"ks", plain(s.ks)},
                       {"specular", json_of(s.specular)},
                       {"shine", plain(s.shine)},
                       {"transmission", plain(s.transmission)},
                       {"eta", plain(s.eta)}};
  }
  if (what.logs[id])
    add_log(json, *what.logs[id], what.accel.geometry(),
            what.settings.accel.kind == AccelKind::grid);
  return json;
}

}  // namespace

std::string name_of(const Geometry& geometry, PrimitiveId id) {
  return fmt::format("{} {}", kPrimitiveKindNames[size_t(geometry.kind_of(id))],
                     geometry.index_of(id));
}

const TraceLog::Test* stopper(const std::optional<TraceLog>& log) {
  if (!log) return nullptr;
  for (const TraceLog::Test& test : log->tests)
    if (test.nearest) return &test;
  return nullptr;
}

RenderSettings explained_settings(RenderOptions options, const Scene& scene) {
  options.accel.counters = true;
  RenderSettings settings = resolve_options(options, scene);
  if (settings.accel.kind == AccelKind::automatic) settings.accel.kind = AccelKind::bvh;
  return settings;
}

std::vector<std::optional<TraceLog>> logs_of(const Explanation& sample, const Accel& accel) {
  std::vector<std::optional<TraceLog>> logs;
  logs.reserve(sample.rays.size());
  for (const ExplainedRay& r : sample.rays)
    logs.push_back(r.traced ? accel.log(r.ray, r.kind == Kind::shadow) : std::nullopt);
  return logs;
}

std::string explained_text(const Explained& what) { return TextTree(what).text(); }

std::string explained_json(const Explained& what) {
  const Explanation& sample = what.sample;
  Json json{{"version", RAIO_VERSION},
            {"scene", what.scene.name},
            {"pixel", what.pixel},
            {"sample", what.number},
            {"rgb", json_of(Vec3f(sample.rgb))}};
  json["rays"] = Json::array();
  for (size_t i = 0; i < sample.rays.size(); ++i) json["rays"].push_back(json_of(what, i));
  return json_text(json);
}

int run(const ExplainCommand& command) {
  if (!command.plot.empty()) {
    if (const auto format = plot_format(command.plot); !format) return bad_input(format.error());
    if (const auto writable = check_writable(command.plot); !writable)
      return fail(writable.error());
  }
  const auto scene = load_scene(command.scene, false, nullptr, command.read);
  if (!scene) return scene.error();
  RenderOptions options = command.options;
  if (options.accel.kind == AccelKind::embree)
    return bad_input("--accel: Embree does not log its steps; choose none, grid or bvh");
  options.accel.counters = true;
  if (const auto why = option_conflict(options, &*scene)) return fail(*why);
  const RenderSettings settings = explained_settings(options, *scene);
  const auto [x, y] = command.pixel;
  if (x >= settings.width || y >= settings.height)
    return bad_input(fmt::format(
        "--pixel: the picture of {}x{} has no pixel {},{}; the last is "
        "{},{}",
        settings.width, settings.height, x, y, settings.width - 1, settings.height - 1));
  if (command.sample >= settings.samples_per_pixel())
    return bad_input(fmt::format(
        "--sample: a pixel has {}, numbered from 0; found {}",
        counted(uint64_t(settings.samples_per_pixel()), "sample", "samples"), command.sample));
  const auto accel = build_accel(*scene, settings.accel, settings.one_sided);
  if (!accel) return fail(accel.error());

  const auto sample = explain_sample(*scene, **accel, settings, x, y, uint32_t(command.sample));
  if (!sample) return fail(sample.error());
  const auto logs = logs_of(*sample, **accel);
  const Explained what{*scene,         **accel, settings, command.pixel,
                       command.sample, *sample, logs,     command.plot_from};
  const int status = deliver("-", command.json ? explained_json(what) : explained_text(what));
  if (command.plot.empty() || status != kDone) return status;
  const auto picture = draw_explained(what, *plot_format(command.plot));
  return picture ? deliver(command.plot, *picture) : no_resource(picture.error());
}

}  // namespace raio::core::app
