// A wavefront of one pixel with a Recorder that logs its rays. All instruction sets give the same
// numbers, so the baseline suffices.
#include "integrate/explain.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "integrate/classic-inl.h"
#include "integrate/classic.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// Lane k of columns' elements i, i + 1, ...
float lane(V v, size_t k) {
  HWY_ALIGN float lanes[kWidth];
  hn::Store(v, d, lanes);
  return lanes[k];
}
Vec3f lane(const V3& v, size_t k) { return {lane(v.x, k), lane(v.y, k), lane(v.z, k)}; }
Vec3f element(const Floats3& f, size_t i) { return {f.x.at[i], f.y.at[i], f.z.at[i]}; }

// `Shading`: of the recorded rays.
template <class Shading>
class RayRecorder {
 public:
  using Paths = PathRays<Shading::kTints>;
  using Weight = typename Paths::Weight;

  RayRecorder(uint32_t sample, double scale, WorkControl& control, Explanation& out)
      : sample_(sample), scale_(scale), control_(control), out_(out) {}

  void begin_sample(uint32_t sample) { recording_ = sample == sample_; }

  // Records all current rays with their hits. `escaped_there` evaluates rays that hit nothing.
  template <class SeenThere>
  void traced(int level, const Paths& current, const HitBatch& hits, SeenThere&& escaped_there) {
    for (size_t i = 0; recording_ && i < current.rays.size(); ++i) {
      const uint32_t branch = current.branch[i];
      places_[branch] = int(out_.rays.size());
      ExplainedRay& r =
          add(level == 1 ? Kind::eye : child_kind(branch % 2), level == 1 ? -1 : find(branch / 2),
              current.rays[i], weight_of(current, i));
      r.hit = hits[i];
      if (!r.hit.found()) set_background(r, escaped_there(r.ray.dir, r.weight));
    }
  }

  // Records children of current rays beyond the last level.
  template <class SeenThere>
  void untraced(const Paths& current, size_t first, const V3& origin, const V3& dir,
                const Weight& weight, uint32_t side, M mask, SeenThere&& escaped_there) {
    const V chosen = hn::IfThenElseZero(mask, hn::Set(d, 1));
    for (size_t k = 0; recording_ && k < kWidth && first + k < current.rays.size(); ++k) {
      if (lane(chosen, k) == 0) continue;
      ExplainedRay& r = add(child_kind(side), find(current.branch[first + k]),
                            {lane(origin, k), lane(dir, k)}, Rgb(lane(weight, k)));
      r.traced = false;
      set_background(r, escaped_there(r.ray.dir, r.weight));
    }
  }

  void ambient(const Paths& current, const SurfacePoints& v, size_t n) {
    for (size_t i = 0; recording_ && i < n; ++i)
      out_.rays[size_t(find(current.branch[i]))].ambient = element(v.radiance, i);
  }

  // Records shadow rays of the n current rays that face light l.
  void shadow_rays(const Paths& current, const RayBatch& rays, const uint8_t* hidden, size_t l,
                   size_t n) {
    shadow_of_.assign(n, -1);
    for (size_t i = 0; recording_ && i < n; ++i) {
      if (!(rays.tmax[i] > 0)) continue;
      const int parent = find(current.branch[i]);
      const ExplainedRay& from = out_.rays[size_t(parent)];
      ExplainedRay r{.kind = ExplainedRay::Kind::shadow,
                     .parent = parent,
                     .level = from.level,
                     .light = int(l),
                     .ray = rays[i],
                     .occluded = hidden[i] != 0,
                     .weight = from.weight};
      shadow_of_[i] = int(out_.rays.size());
      out_.rays.push_back(r);
    }
  }
  // Records the light's contribution to current rays first, first + 1, ...
  void lit(size_t first, size_t n, const V3& diffuse, const V3& both) {
    for (size_t i = first; recording_ && i < std::min(first + kWidth, n); ++i) {
      if (shadow_of_[i] < 0) continue;
      ExplainedRay& r = out_.rays[size_t(shadow_of_[i])];
      if (r.occluded) continue;
      r.diffuse = Vec3d(lane(diffuse, i - first));
      // Exact, so that the two add up to the surface's float.
      r.highlight = Vec3d(lane(both, i - first)) - r.diffuse;
    }
  }

  void shaded(const Paths& current, const SurfacePoints& v, size_t n, const TileSums& sums) {
    for (size_t i = 0; recording_ && i < n; ++i) {
      ExplainedRay& r = out_.rays[size_t(find(current.branch[i]))];
      r.surface =
          ExplainedRay::Surface{.point = element(v.point, i),
                                .normal = element(v.normal, i),
                                .geometric = element(v.geometric, i),
                                .material = v.material[i],
                                .color = element(v.color, i),
                                .kd = v.kd.at[i],
                                .ks = v.ks.at[i],
                                .shine = v.shine.at[i],
                                .transmission = v.transmission.at[i],
                                .eta = v.eta.at[i],
                                .specular = Shading::kTints ? element(v.specular, i) : Rgb(1),
                                .roughness = Shading::kTints ? v.roughness.at[i] : 0};
      r.brings = unscaled(sums.fixed(element(v.radiance, i) * r.weight));
    }
  }

 private:
  using Kind = ExplainedRay::Kind;

  // The branch in the ray tree (integrate/sampler.h) identifies the rays of a sample.
  int find(uint32_t branch) const { return places_.at(branch); }
  static Rgb weight_of(const Paths& current, size_t i) {
    const auto& w = current.weight;
    return {w.front()[i], w[w.size() / 2][i], w.back()[i]};
  }
  ExplainedRay& add(Kind kind, int parent, const Ray& ray, Rgb weight) {
    const int level = parent < 0 ? 1 : out_.rays[size_t(parent)].level + 1;
    if (out_.rays.size() >= kMaxExplainedRays) control_.stop = true;
    out_.rays.push_back(
        {.kind = kind, .parent = parent, .level = level, .ray = ray, .weight = weight});
    return out_.rays.back();
  }
  static Kind child_kind(uint32_t side) { return side ? Kind::refraction : Kind::reflection; }
  void set_background(ExplainedRay& r, const std::pair<Rgb, PixelSums>& seen) const {
    r.background = seen.first, r.brings = unscaled(seen.second);
  }
  Vec3d unscaled(const PixelSums& s) const {
    return {double(s[0]) / scale_, double(s[1]) / scale_, double(s[2]) / scale_};
  }

  uint32_t sample_;
  double scale_;
  WorkControl& control_;
  Explanation& out_;
  bool recording_ = false;
  std::unordered_map<uint32_t, int> places_;  // index of rays by branch
  std::vector<int> shadow_of_;                // by current ray; -1: none
};

}  // namespace

std::optional<Explanation> explain(const Scene& scene, const Accel& accel, RenderSettings settings,
                                   int x, int y, uint32_t sample) {
  settings.crop = Crop{x, y, x + 1, y + 1};
  settings.channels = {};
  const PreparedScene prepared(scene, accel, settings);
  Film film(1, 1, classic_bound(scene, settings));
  Explanation out;
  WorkControl control;
  const auto render = [&]<class Shading> {
    using Recorder = RayRecorder<Shading>;
    const Recorder recorder(sample, film.scale(), control, out);
    Wavefront<Shading, Recorder>(prepared, control, recorder).render(0, {sample, sample + 1}, film);
  };
  if (needs_models(scene, settings))
    render.template operator()<ModelShading>();
  else
    render.template operator()<ClassicShading>();
  if (control.stop) return std::nullopt;
  out.counts = film.rays();
  for (const ExplainedRay& r : out.rays) out.rgb = out.rgb + r.brings;
  return out;
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

namespace raio::core {

std::expected<Explanation, Error> explain_sample(const Scene& scene, const Accel& accel,
                                                 const RenderSettings& settings, int x, int y,
                                                 uint32_t sample) {
  const auto refuse = [](std::string_view option, std::string message) {
    return std::unexpected(bad_option(option, std::move(message)));
  };
  if (settings.integrator == IntegratorKind::ambient)
    return refuse(
        "integrator",
        "the rays of `integrator` ambient cannot be explained; give `integrator` classic");
  if (accel.geometry().any_transparent())
    return refuse("", "rays through surfaces of an opacity below 1 cannot be explained yet");
  auto out = HWY_NAMESPACE::explain(scene, accel, settings, x, y, sample);
  if (out) return std::move(*out);
  return std::unexpected(Error{ErrorKind::no_resource, "",
                               fmt::format("the sample has more than {} rays; choose a smaller "
                                           "`depth`",
                                           kMaxExplainedRays)});
}

}  // namespace raio::core
