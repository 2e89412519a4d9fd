#include "measure/effect_costs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "base/parallel.h"
#include "measure/timed_share.h"

namespace raio::core {
namespace {

constexpr size_t kFewestRounds = 5, kFewestSlowRounds = 3, kMaxRounds = 25;
constexpr double kCostPatienceSeconds = 15;  // after that, the minimum number of rounds suffices
constexpr double kNewsSeconds = 0.5;
constexpr uint32_t kProbeShards = 64;
// Of brute force in one tile: some seconds.
constexpr double kMaxTests = 6e9;

// One of the compared pictures.
struct Variant {
  RenderSettings settings;
  const Accel* accel = nullptr;
  const Accel* counting = nullptr;  // the same with counters
  uint32_t share = 1;               // a run renders every `share`th tile,
  double part = 1;                  // which is this part of the picture's work
  std::vector<double> seconds{};    // per round, of a run
  EffectCost::Side counted{};
  double counted_pixels = 0;
};

class EffectMeasurement {
 public:
  EffectMeasurement(const Scene& scene, const Accel& accel, const RenderOptions& options,
                    CostOf what, WorkControl& control,
                    const std::function<void(const EffectCosts&)>& on_news,
                    const MeasuringEffort& effort)
      : scene_(scene),
        options_(what == CostOf::report ? timed_options(options, scene) : sampled_options(options)),
        control_(control),
        on_news_(on_news),
        effort_(effort) {
    costs_.of = what;
    base_ = {.settings = resolve_options(options_, scene_), .accel = &accel};
  }

  std::expected<EffectCosts, Error> run() {
    costs_.width = base_.settings.frame().width(), costs_.height = base_.settings.frame().height();
    for (const Effect effect : kEffects)
      costs_.effects.push_back({.effect = effect,
                                .on = is_on(effect, options_, scene_),
                                .presence = is_in_scene(effect, scene_, base_.settings.fresnel)
                                                ? EffectCost::in_picture
                                                : EffectCost::not_in_scene});
    if (!base_.settings.camera.can_have_lens())
      cost(Effect::depth_of_field).presence = EffectCost::not_in_picture;
    const bool empty = scene_.primitive_count() == 0;
    if (empty || (measure_effects() && measure_structure())) {
      costs_.finished = true, costs_.done = 1, costs_.left_s = 0;
      tell();
    }
    if (error_) return std::unexpected(std::move(*error_));
    return std::move(costs_);
  }

 private:
  EffectCost& cost(Effect effect) { return costs_.effects[size_t(effect)]; }

  // The options with the effect switched.
  RenderOptions other_options(const EffectCost& c) const {
    RenderOptions o = with_effect(options_, c.effect, !c.on, scene_);
    if (costs_.of == CostOf::report) return o;
    // The picture has as many samples as before, wherever they are in the pixel and on the lens.
    o.lens_samples = options_.lens_samples;
    if (c.effect == Effect::antialiasing && !c.on && options_.samples > 0) o.aa = 0;
    return o;
  }
  // Of a run.
  double samples_of(const RenderSettings& s) const {
    return costs_.of == CostOf::report ? s.samples_per_pixel() : 1;
  }

  bool fail(Error why) {
    error_ = std::move(why);
    return false;
  }

  void tell() {
    if (on_news_) on_news_(costs_);
    told_ = Clock::now();
  }
  void tell_now_and_then() {
    if (seconds_since(told_) >= kNewsSeconds) tell();
  }
  void expect(double left_s) {
    const double passed = seconds_since(start_);
    costs_.left_s = left_s;
    costs_.done = passed / std::max(passed + left_s, 1e-9);
  }

  // Builds the counting structures of the timed ones.
  bool build_counting(Variant& v) {
    const AccelKind kind = v.settings.accel.kind;
    const bool has_steps = kind != AccelKind::embree;
    v.counted.has_steps = has_steps;
    const bool counts_anyway = kind == AccelKind::bvh || kind == AccelKind::automatic;
    v.counting = v.accel;
    if (!has_steps || counts_anyway || v.settings.accel.counters) return true;
    AccelOptions o = v.settings.accel;
    o.counters = true;
    v.counting = build(o);
    return v.counting != nullptr;
  }

  const Accel* build(const AccelOptions& o) {
    auto accel = Executor(base_.settings.threads, &control_).run([&] {
      return build_accel(scene_, o, base_.settings.one_sided);
    });
    if (control_.stop) return nullptr;
    if (!accel) return fail(std::move(accel.error())), nullptr;
    built_.push_back(std::move(*accel));
    return built_.back().get();
  }

  // Nothing if stopped.
  std::optional<TimedRun> run_share(const Variant& v, const Accel& accel, uint32_t share) {
    auto done = render_share(scene_, accel, v.settings, share, control_,
                             costs_.of == CostOf::report ? 0 : 1);
    if (!done) return fail(std::move(done.error())), std::nullopt;
    return *done;
  }
  double part_of_picture(uint64_t pixels) const {
    return double(pixels) / (double(costs_.width) * costs_.height);
  }

  bool count(Variant& v, uint32_t share, uint64_t& pixels) {
    if (!v.counting && !build_counting(v)) return false;
    const auto counted = run_share(v, *v.counting, share);
    if (!counted) return false;
    v.counted.rays = counted->rays;
    pixels = counted->pixels;
    v.counted_pixels = double(pixels);
    v.share = share, v.part = part_of_picture(pixels);
    tell_now_and_then();
    return true;
  }

  bool time(Variant& v) {
    double seconds = 0;
    int runs = 0;
    do {
      const auto timed = run_share(v, *v.accel, v.share);
      if (!timed) return false;
      seconds += std::max(timed->seconds, 1e-9), ++runs;
    } while (seconds < effort_.least_run_s);
    v.seconds.push_back(seconds / runs);
    tell_now_and_then();
    return true;
  }

  // Estimates the time of all tiles from some; nothing if stopped.
  std::optional<double> probe(const Variant& v, uint32_t shards) {
    const auto some = run_share(v, *v.accel, shards);
    if (!some) return std::nullopt;
    return some->seconds / part_of_picture(std::max<uint64_t>(1, some->pixels));
  }

  // All except the structure.
  bool measure_effects() {
    std::vector<std::pair<Effect, Variant>> others;
    double most_samples = 1;
    for (const EffectCost& c : costs_.effects) {
      if (c.effect == Effect::structure || c.presence != EffectCost::in_picture) continue;
      others.push_back(
          {c.effect,
           {.settings = resolve_options(other_options(c), scene_), .accel = base_.accel}});
      most_samples = std::max(most_samples, samples_of(others.back().second.settings));
    }
    tell();
    const auto whole_s = probe(base_, kProbeShards);
    if (!whole_s) return false;
    const double per_sample = *whole_s / samples_of(base_.settings);
    const uint32_t share =
        share_for(scene_, base_.settings, per_sample * most_samples, kTilesPerThread);
    double round_s = *whole_s;
    for (const auto& [effect, v] : others) round_s += per_sample * samples_of(v.settings);
    expect(double(kFewestRounds + 1) * round_s / share);

    uint64_t pixels = 0;
    if (!count(base_, share, pixels)) return false;
    for (auto& [effect, v] : others) {
      v.counting = base_.counting, v.counted.has_steps = base_.counted.has_steps;
      if (!count(v, share, pixels)) return false;
      EffectCost& c = cost(effect);
      c.pixels = pixels;
      (c.on ? c.with : c.without) = base_.counted, (c.on ? c.without : c.with) = v.counted;
      if (!affects(effect, c.with.rays)) c.presence = EffectCost::not_in_picture;
    }
    std::erase_if(others,
                  [&](auto& o) { return cost(o.first).presence != EffectCost::in_picture; });
    return compare(base_, others);
  }

  // Whether the effect affects any ray of the picture.
  static bool affects(Effect effect, const RayCounts& with) {
    switch (effect) {
      case Effect::reflection:
      case Effect::gloss:
        return with.reflection > 0;
      case Effect::refraction:
      case Effect::translucency:
        return with.refraction > 0;
      case Effect::soft_shadows:
        return with.shadow > 0;
      default:
        return with.eye_hits > 0;
    }
  }

  // Repeats rounds over all pictures until the ratios are known.
  bool compare(Variant& base, std::vector<std::pair<Effect, Variant>>& others) {
    const auto start = Clock::now();
    for (size_t round = 1; !others.empty(); ++round) {
      const auto round_start = Clock::now();
      std::vector<Variant*> order = {&base};
      for (auto& [effect, v] : others) order.push_back(&v);
      if (round % 2 == 0) std::ranges::reverse(order);
      for (Variant* v : order)
        if (!time(*v)) return false;
      const double round_s = seconds_since(round_start);
      const bool patient = seconds_since(start) + round_s < kCostPatienceSeconds;
      for (const auto& [effect, v] : others) take_round(cost(effect), base, v, patient);
      std::erase_if(others, [&](auto& o) { return cost(o.first).finished; });
      const size_t fewest = patient ? kFewestRounds : kFewestSlowRounds;
      expect(round_s * double(others.empty() ? 0 : round < fewest ? fewest - round : 1));
      tell();
    }
    return true;
  }

  void take_round(EffectCost& c, const Variant& base, const Variant& other, bool patient) const {
    const Variant &with = c.on ? base : other, &without = c.on ? other : base;
    const bool is_structure = c.effect == Effect::structure;
    const Variant &over = is_structure ? without : with, &under = is_structure ? with : without;
    std::vector<double> ratios;
    ratios.reserve(with.seconds.size());
    for (size_t i = 0; i < with.seconds.size(); ++i)
      ratios.push_back(over.seconds[i] / over.part / (under.seconds[i] / under.part));
    c.factor = median_interval(std::move(ratios));
    c.rounds = int(with.seconds.size());
    // The other picture's seconds follow from the factor, so the three numbers agree.
    const double shown_s = median_interval(base.seconds).median / base.part;
    const bool is_over = c.on != is_structure;
    const double other_s = is_over ? shown_s / c.factor.median : shown_s * c.factor.median;
    (c.on ? c.with : c.without).seconds = shown_s, (c.on ? c.without : c.with).seconds = other_s;
    const bool close = c.factor.half_width() <= effort_.close_enough;
    const auto rounds = size_t(c.rounds);
    c.finished = (rounds >= kFewestRounds && close) || rounds >= kMaxRounds ||
                 (rounds >= kFewestSlowRounds && !patient);
  }

  // Compares the structure with brute force, which has time for only a few tiles. With the
  // structure, tiles differ in cost, and the same few would not represent the picture (a third off
  // on sphereflake), so it renders more. Brute force takes the same time for every ray, within 5 %,
  // so its seconds are scaled by the numbers of rays.
  bool measure_structure() {
    EffectCost& c = cost(Effect::structure);
    const double rays = double(base_.counted.rays.total()) / std::max(base_.counted_pixels, 1.0);
    if (c.on && rays * kTileSide * kTileSide * double(scene_.primitive_count()) > kMaxTests) {
      c.presence = EffectCost::too_slow;
      return true;
    }
    const RenderOptions o = other_options(c);
    Variant base{.settings = base_.settings, .accel = base_.accel, .counting = base_.counting};
    base.counted.has_steps = base_.counted.has_steps;
    Variant other{.settings = resolve_options(o, scene_)};
    // Brute force counts at no cost.
    if (c.on) other.settings.accel.counters = true;
    other.accel = build(other.settings.accel);
    if (!other.accel) return false;
    Variant &slow = c.on ? other : base, &fast = c.on ? base : other;
    const auto whole_s = probe(slow, kProbeShards * kProbeShards);
    const auto fast_s = probe(fast, kProbeShards);
    if (!whole_s || !fast_s) return false;
    // The probe's tile was rendered by one thread.
    const uint32_t share = share_for(scene_, base.settings, *whole_s / base.settings.threads, 1);
    expect(*whole_s / base.settings.threads / share * double(kFewestSlowRounds + 1));
    if (!count(base, share, c.pixels) || !count(other, share, c.pixels)) return false;
    (c.on ? c.with : c.without) = base.counted, (c.on ? c.without : c.with) = other.counted;
    fast.share = share_for(scene_, fast.settings, *fast_s, kTilesPerThread);
    const auto run = run_share(fast, *fast.accel, fast.share);
    if (!run) return false;
    fast.part = part_of_picture(run->pixels);
    slow.part = fast.part * double(slow.counted.rays.total()) / double(run->rays.total());
    std::vector<std::pair<Effect, Variant>> others;
    others.emplace_back(Effect::structure, std::move(other));
    return compare(base, others);
  }

  const Scene& scene_;
  RenderOptions options_;
  WorkControl& control_;
  const std::function<void(const EffectCosts&)>& on_news_;
  const MeasuringEffort effort_;
  Variant base_;
  std::vector<std::unique_ptr<Accel>> built_;
  EffectCosts costs_;
  std::optional<Error> error_;
  Clock::time_point start_ = Clock::now(), told_ = start_;
};

}  // namespace

std::expected<EffectCosts, Error> measure_effects(
    const Scene& scene, const Accel& accel, const RenderOptions& options, CostOf what,
    WorkControl& control, const std::function<void(const EffectCosts&)>& on_news,
    const MeasuringEffort& effort) {
  return EffectMeasurement(scene, accel, options, what, control, on_news, effort).run();
}

}  // namespace raio::core
