#include "view/measure.h"

#include <array>
#include <chrono>
#include <new>
#include <utility>

namespace raio::view {
namespace {

constexpr std::array kEffects = {Command::antialiasing,   Command::soft_shadows,
                                 Command::depth_of_field, Command::reflection,
                                 Command::refraction,     Command::structure};

// A picture is measured by every 32nd of its tiles, and by more while they take no longer than
// this.
constexpr uint32_t kShards = 32;
constexpr double kEnoughSeconds = 0.08;

// Nothing when told to stop.
std::optional<double> picture_seconds(const Scene& scene, const Accel& accel, RenderSettings o,
                                      RenderControl& control) {
  o.sampler = SamplerKind::jitter, o.samples = 0;
  o.aa = o.aa == 1 ? 1 : 3;
  o.lens_samples = o.dof ? 3 : 1;
  const auto film = make_film(scene, o);
  if (!film) return std::nullopt;
  double seconds = 0;
  uint32_t shard = 0;
  while (shard < kShards && seconds < kEnoughSeconds) {
    const RenderResult done =
        render(scene, accel, o, **film, control, {.shard = shard++, .shards = kShards});
    if (!done.finished) return std::nullopt;
    seconds += done.seconds;
  }
  return seconds * kShards / shard;
}

}  // namespace

void Measuring::start(Work work, std::function<Measured(RenderControl&)> measure) {
  work_ = work;
  done_ = false;
  control_.stop = false;
  thread_ = std::thread([this, measure = std::move(measure)] {
    try {
      found_ = measure(control_);
    } catch (const std::bad_alloc&) {
      found_.error = "out of memory";
    }
    done_ = true;
    on_done_();
  });
}

Measuring::~Measuring() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

std::optional<std::string> Measuring::poll() {
  if (!busy() || !done_) return std::nullopt;
  thread_.join();
  const Work work = std::exchange(work_, Work::none);
  Measured found = std::exchange(found_, {});
  if (control_.stop) return work == Work::table ? "not measured" : "";
  if (!found.error.empty()) return found.error;
  if (work == Work::costs) {
    result_.costs = std::move(found.costs);
    return "";
  }
  result_.table = std::move(found.table);
  return "measured the sixteen";
}

void Measuring::start_costs(const ViewState& state, std::shared_ptr<const BakedScene> baked,
                            int width, int height) {
  start(Work::costs, [state, baked = std::move(baked), width, height](RenderControl& control) {
    Measured out;
    const Scene& scene = *state.scene;
    const auto resolved = [&](const ViewState& s) {
      RenderOptions o = s.request(width, height);
      o.view = View::picture, o.integrator = std::nullopt, o.channels = {};
      return resolve_options(o, scene);
    };
    const RenderSettings now = resolved(state);
    const auto now_s = picture_seconds(scene, *baked->accel, now, control);
    for (const Command effect : kEffects) {
      if (!now_s || control.stop) return out;
      ViewState other = state;
      const bool on = state.is_on(effect);
      std::optional<double> other_s;
      if (effect == Command::structure) {
        RenderSettings o = now;
        o.accel = {};
        o.accel.kind = on ? AccelKind::none : AccelKind::bvh;
        const auto accel = build_accel(scene, o.accel, o.one_sided);
        if (accel) other_s = picture_seconds(scene, **accel, o, control);
      } else {
        (void)other.toggle(effect);
        other_s = picture_seconds(scene, *baked->accel, resolved(other), control);
      }
      if (!other_s) return out;
      out.costs.push_back({effect, on, on ? *now_s : *other_s, on ? *other_s : *now_s});
    }
    return out;
  });
}

void Measuring::start_table(const ViewState& state, int width, int height) {
  start(Work::table,
        [scene = state.scene, options = state.request(width, height)](RenderControl& control) {
          Measured out;
          auto table = measure_benchmark(*scene, BenchmarkRequest{.options = options}, control);
          if (table)
            out.table = std::move(*table);
          else
            out.error = with_settings(table.error().message, "");
          return out;
        });
}

}  // namespace raio::view
