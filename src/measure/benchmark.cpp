#include "measure/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "base/clock.h"
#include "base/executor.h"
#include "base/platform/processor.h"
#include "render/render.h"

namespace raio::core {

namespace {

// The fraction of pixels in which the structures' pictures may differ by more than 8 of 255: rays
// that graze an edge may fall on either side of it.
constexpr double kAllowedDisagreement = 0.001;

using Failure = BenchmarkFailure;

// Switches off effects in `combined` but not in `effects`.
RenderOptions with_effects(RenderOptions options, EffectSet effects, EffectSet combined,
                           const Scene& scene) {
  // The effects determine the number of samples, jittered as in the report.
  options.samples = 0, options.sampler = SamplerKind::jitter;
  options.view = View::picture, options.integrator = IntegratorKind::classic;
  options.channels = {};
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    if (kBenchmarkEffects[i].by_default || (combined >> i & 1))
      options = with_effect(options, kBenchmarkEffects[i].effect, effects >> i & 1, scene);
  return options;
}

class Measurement {
 public:
  Measurement(const Scene& scene, const BenchmarkRequest& request, WorkControl& control,
              const std::function<void(const BenchmarkStep&)>& on_step)
      : scene_(scene), request_(request), control_(control), on_step_(on_step) {}

  std::expected<BenchmarkTable, Failure> run() {
    const RenderSettings settings = settings_with(0);
    table_.version = RAIO_VERSION;
    table_.scene = scene_.name;
    table_.machine = processor_name();
    table_.width = settings.width, table_.height = settings.height;
    table_.threads = settings.threads, table_.depth = settings.depth;
    table_.repeat = std::max(1, request_.repeat), table_.seed = settings.seed;
    table_.effects = request_.effects;
    for (const Combination& c : combinations(request_)) table_.rows.push_back({c, {}, 0});

    for (const AccelKind kind : request_.structures)
      if (const auto built = build(kind); !built) return std::unexpected(built.error());
    if (const auto same = compare_plain(); !same) return std::unexpected(same.error());
    if (const auto timed = time_all(); !timed) return std::unexpected(timed.error());
    return std::move(table_);
  }

 private:
  RenderSettings settings_with(EffectSet effects) const {
    return resolve_options(with_effects(request_.options, effects, request_.effects, scene_),
                           scene_);
  }

  std::expected<void, Failure> build(AccelKind kind) {
    AccelOptions request{.kind = kind};
    if (kind == AccelKind::grid) {
      request.grid_factor = request_.options.accel.grid_factor;
      request.grid_resolution = request_.options.accel.grid_resolution;
    }
    const auto start = Clock::now();
    auto accel = Executor(table_.threads, &control_).run([&] {
      return build_accel(scene_, request, request_.options.one_sided);
    });
    const double elapsed = seconds_since(start);
    if (control_.stop) return std::unexpected(Failure{Failure::stopped, {}});
    if (!accel) return std::unexpected(Failure{Failure::no_resource, accel.error().message});
    table_.structures.push_back({(*accel)->info(), elapsed});
    accels_[kind] = std::move(*accel);
    return {};
  }

  struct Rendered {
    double seconds;
    std::unique_ptr<Film> film;
  };
  std::expected<Rendered, Failure> render_once(BenchmarkStep step) {
    step.so_far = &table_;
    const RenderSettings settings = settings_with(step.combination.effects);
    control_.rays_done = control_.work_done = control_.work_total = 0;
    if (on_step_) on_step_(step);
    auto film = make_film(scene_, settings);
    if (!film) return std::unexpected(Failure{Failure::no_resource, film.error().message});
    const Accel& accel = *accels_.at(step.combination.accel);
    const RenderResult result = render(scene_, accel, settings, **film, control_);
    if (!result.finished) return std::unexpected(Failure{Failure::stopped, {}});
    return Rendered{std::max(result.seconds, 1e-9), std::move(*film)};
  }

  // Whether the structures give the same picture, judged by brute force if it takes part. Also
  // warms up the machine.
  std::expected<void, Failure> compare_plain() {
    const auto& kinds = request_.structures;
    const bool brute_force = std::ranges::count(kinds, AccelKind::none) > 0;
    const AccelKind judge = brute_force ? AccelKind::none : kinds.front();
    std::map<AccelKind, Image> pictures;
    for (const AccelKind kind : kinds) {
      const auto rendered = render_once({.combination = {kind}});
      if (!rendered) return std::unexpected(rendered.error());
      pictures[kind] = rendered->film->resolve();
    }
    for (const auto& [kind, picture] : pictures) {
      if (kind == judge) continue;
      const auto differing = check_agreement(kind, picture, judge, pictures[judge]);
      if (!differing) return std::unexpected(Failure{Failure::disagreement, differing.error()});
      table_.disagreement = std::max(table_.disagreement.value_or(0), *differing);
    }
    return {};
  }

  // Cheap combinations come first, so an interrupted run has most results: structures before brute
  // force, few samples before many.
  std::expected<void, Failure> time_all() {
    struct Place {
      bool brute_force;
      size_t structure;
      int round, samples;
      size_t row;
      auto operator<=>(const Place&) const = default;
    };
    std::vector<Place> order;
    const size_t rows_each = table_.rows.size() / request_.structures.size();
    for (size_t i = 0; i < table_.rows.size(); ++i)
      for (int round = 0; round < table_.repeat; ++round) {
        const auto [accel, effects] = table_.rows[i].combination;
        order.push_back(
            {accel == AccelKind::none, i / rows_each, round, samples_per_pixel(effects), i});
      }
    std::ranges::sort(order);

    BenchmarkStep step;
    step.count = int(order.size());
    for (const Place& place : order) {
      BenchmarkRow& row = table_.rows[place.row];
      step.combination = row.combination, ++step.number;
      const auto rendered = render_once(step);
      if (!rendered) return std::unexpected(rendered.error());
      row.runs_s.push_back(rendered->seconds);
      row.rays = rendered->film->rays().total();
    }
    return {};
  }

  const Scene& scene_;
  const BenchmarkRequest& request_;
  WorkControl& control_;
  const std::function<void(const BenchmarkStep&)>& on_step_;
  std::map<AccelKind, std::unique_ptr<Accel>> accels_;
  BenchmarkTable table_;
};

}  // namespace

int samples_per_pixel(EffectSet effects) {
  int samples = 1;
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    if (effects >> i & 1) samples *= kBenchmarkEffects[i].samples;
  return samples;
}

std::string short_label(const Combination& combination) {
  std::string label(accel_name(combination.accel));
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    if (combination.effects >> i & 1) label += fmt::format(" {}", kBenchmarkEffects[i].short_name);
  return label;
}

std::vector<Combination> combinations(const BenchmarkRequest& request) {
  std::vector<EffectSet> sets = {0};
  for (size_t i = kBenchmarkEffects.size(); i-- > 0;) {
    const EffectSet effect = request.effects & EffectSet(1) << i;
    if (!effect) continue;
    const size_t without = sets.size();
    for (size_t k = 0; k < without; ++k) sets.push_back(sets[k] | effect);
  }
  std::vector<Combination> all;
  for (const AccelKind accel : request.structures)
    for (const EffectSet effects : sets) all.push_back({accel, effects});
  return all;
}

Spread spread_of(std::vector<double> values) {
  std::ranges::sort(values);
  const size_t half = values.size() / 2;
  const double median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
  return {values.front(), median, values.back()};
}

Spread ratio_of(const BenchmarkRow& row, const BenchmarkRow& base) {
  std::vector<double> ratios;
  ratios.reserve(row.runs_s.size());
  for (size_t round = 0; round < row.runs_s.size(); ++round)
    ratios.push_back(row.runs_s[round] / base.runs_s[round]);
  return spread_of(std::move(ratios));
}

const BenchmarkRow* BenchmarkTable::find(const Combination& combination) const {
  const auto found = std::ranges::find(rows, combination, &BenchmarkRow::combination);
  return found == rows.end() ? nullptr : &*found;
}

Spread BenchmarkTable::relative_cost(const BenchmarkRow& row) const {
  return ratio_of(row, *find({row.combination.accel}));
}

std::expected<BenchmarkTable, BenchmarkFailure> measure_benchmark(
    const Scene& scene, const BenchmarkRequest& request, WorkControl& control,
    const std::function<void(const BenchmarkStep&)>& on_step) {
  return Measurement(scene, request, control, on_step).run();
}

std::expected<double, std::string> check_agreement(AccelKind kind, const Image& picture,
                                                   AccelKind other, const Image& of_other) {
  const double differing = compare(picture, of_other).above_8;
  if (differing <= kAllowedDisagreement) return differing;
  return std::unexpected(fmt::format(
      "the pictures of {} and {} differ in {:.3g} % of the pixels (allowed {:.3g} %), so their "
      "times are not comparable",
      accel_name(kind), accel_name(other), 100 * differing, 100 * kAllowedDisagreement));
}

}  // namespace raio::core
