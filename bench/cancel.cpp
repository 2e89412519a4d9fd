// How quickly cancelled builds stop.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <random>
#include <thread>

#include "base/clock.h"
#include "base/executor.h"
#include "bench/suites.h"

namespace raio::core::bench {
namespace {

// The seconds from the request to stop, `after_s` from the beginning of a build, until it has ended
// and its memory is free; nothing if it was complete before.
std::optional<double> seconds_to_stop(const Scene& scene, const AccelOptions& options, int threads,
                                      double after_s) {
  WorkControl control;
  Clock::time_point asked;
  std::jthread watch([&] {
    std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
    asked = Clock::now();
    control.stop = true;
  });
  const bool complete =
      Executor(threads, &control).run([&] { return build_accel(scene, options).has_value(); });
  const auto end = Clock::now();
  watch.join();
  if (complete) return std::nullopt;
  return std::chrono::duration<double>(end - asked).count();
}

}  // namespace

std::vector<Json> cancel_suite(const Settings& request) {
  const Settings s =
      request.with_defaults({"spheres:10000000"}, {AccelKind::bvh, AccelKind::grid}, 100);
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    tell(name);
    const Scene scene = get_scene(name);
    for (const AccelKind kind : s.structures) {
      AccelOptions options = s.options.accel;
      options.kind = kind;
      const double build_s =
          seconds_on(s.options.threads, [&] { (void)build_structure(scene, kind, s); });
      std::mt19937 random(1);
      std::uniform_real_distribution<double> moment(0, build_s);
      std::vector<double> runs_s;
      double latest_s = -1, latest_after_s = 0;
      for (int i = 0; i < s.repeat; ++i) {
        const double after_s = moment(random);
        const auto late = seconds_to_stop(scene, options, s.options.threads, after_s);
        if (!late) continue;
        runs_s.push_back(*late);
        if (*late > latest_s) latest_s = *late, latest_after_s = after_s;
      }
      if (runs_s.empty()) give_up(1, name + ": no build took long enough to be stopped");
      rows.push_back({{"scene", name},
                      {"structure", accel_name(kind)},
                      {"threads", s.options.threads},
                      {"build_s", build_s},
                      {"stopped", runs_s.size()},
                      {"median_s", median(runs_s)},
                      {"nine_of_ten_s", quantile(runs_s, 0.9)},
                      {"latest_s", latest_s},
                      {"latest_after_s", latest_after_s},
                      {"runs_s", runs_s}});
    }
  }
  print_table(rows, {{"scene", "scene"},
                     {"structure", "structure"},
                     {"threads", "threads"},
                     {"build_s", "build ms", 1e3},
                     {"stopped", "stopped"},
                     {"median_s", "median ms", 1e3},
                     {"nine_of_ten_s", "9 of 10", 1e3},
                     {"latest_s", "latest ms", 1e3},
                     {"latest_after_s", "told after ms", 1e3}});
  fmt::print("\nfrom the request to stop until the build has ended and its memory is free\n");
  return rows;
}

}  // namespace raio::core::bench
