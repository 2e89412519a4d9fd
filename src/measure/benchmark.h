// The costs of effects and the gains of structures: times a scene with combinations of both, after
// checking that all structures give the same picture. To time another effect, add a line to
// kBenchmarkEffects; requests, tables and plots follow.
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "base/executor.h"
#include "io/image/image.h"
#include "measure/effects.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core {

/// An effect that can be switched on and off.
struct BenchmarkEffect {
  Effect effect;
  std::string_view name;                    // for programs
  std::string_view short_name;              // for people, in a narrow column
  std::array<std::string_view, 2> heading;  // for people, in two lines
  bool by_default;
  int samples;                  // the factor by which it increases the number of samples
  std::string_view wants = {};  // the scene must have it, else the effect is refused
};

/// The first three are the effects of the report of 2018, which takes 1 sample per pixel without
/// effects, 3 with depth of field, 9 with antialiasing and 27 with both. They are off unless
/// combined; options and scene decide about the others.
inline constexpr auto kBenchmarkEffects = std::to_array<BenchmarkEffect>({
    {Effect::antialiasing, "aa", "AA", {"anti-", "aliasing"}, true, 9},
    {Effect::soft_shadows, "soft_shadows", "soft", {"soft", "shadows"}, true, 1},
    {Effect::depth_of_field, "dof", "DOF", {"depth", "of field"}, true, 3},
    {Effect::gloss, "gloss", "gloss", {"", "gloss"}, false, 1, "mirrors"},
    {Effect::translucency, "translucency", "transl", {"trans-", "lucency"}, false, 1, "glass"},
    {Effect::motion, "motion", "motion", {"", "motion"}, false, 1, "movement"},
});

/// A set of effects: bit i stands for kBenchmarkEffects[i].
using EffectSet = uint32_t;

/// The effect with that name alone; empty if unknown.
constexpr EffectSet effect_named(std::string_view name) {
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    if (kBenchmarkEffects[i].name == name) return EffectSet(1) << i;
  return 0;
}

constexpr EffectSet default_effects() {
  EffectSet set = 0;
  for (size_t i = 0; i < kBenchmarkEffects.size(); ++i)
    set |= EffectSet(kBenchmarkEffects[i].by_default) << i;
  return set;
}

/// One row of the benchmark.
struct Combination {
  AccelKind accel = AccelKind::none;
  EffectSet effects = 0;

  friend bool operator==(const Combination&, const Combination&) = default;
};

/// 1 without effects.
int samples_per_pixel(EffectSet effects);

/// "grid AA DOF".
std::string short_label(const Combination& combination);

struct BenchmarkRequest {
  /// Each at most once, and not AccelKind::automatic.
  std::vector<AccelKind> structures = {AccelKind::none, AccelKind::grid, AccelKind::bvh};
  /// All subsets of these are timed, including the empty one.
  EffectSet effects = default_effects();
  int repeat = 1;
  /// The scene's view and everything except effects and numbers of samples: size, camera, depth,
  /// lens, light size, grid cells, threads, seed.
  RenderOptions options;
};

/// The rows of a request, by structure; effects count in binary, the last fastest.
std::vector<Combination> combinations(const BenchmarkRequest& request);

/// Minimum, median and maximum of at least one value.
struct Spread {
  double least = 0, median = 0, most = 0;

  /// Half the range, relative to the median.
  double half_width() const { return (most - least) / 2 / median; }
};
Spread spread_of(std::vector<double> values);

struct BenchmarkRow {
  Combination combination;
  std::vector<double> runs_s;  // rendering only, one per round; never empty
  uint64_t rays = 0;           // per run

  Spread seconds() const { return spread_of(runs_s); }
  double rays_per_s() const { return double(rays) / seconds().median; }
};

/// The time of a row relative to a base measured with it, round by round, so a machine that slows
/// down between rounds does not matter.
Spread ratio_of(const BenchmarkRow& row, const BenchmarkRow& base);

struct BenchmarkStructure {
  AccelInfo info;
  double build_s = 0;
};

struct BenchmarkTable {
  std::string version, scene;
  std::string machine;  // the processor's model
  int width = 0, height = 0, threads = 0, depth = 0, repeat = 1;
  uint32_t seed = 0;
  std::vector<BenchmarkStructure> structures;
  EffectSet effects = 0;               // that were combined
  std::optional<double> disagreement;  // largest fraction of pixels in which the plain pictures of
                                       // two structures differ; nothing for one structure
  std::vector<BenchmarkRow> rows;      // in the order of combinations()

  /// Whether machine-readable output lists kBenchmarkEffects[i]: always for the report's, for
  /// others if they were combined.
  bool lists(size_t i) const { return kBenchmarkEffects[i].by_default || (effects >> i & 1); }

  /// Null if it was not measured.
  const BenchmarkRow* find(const Combination& combination) const;

  /// The row's cost: its time relative to the same structure without effects.
  Spread relative_cost(const BenchmarkRow& row) const;
};

struct BenchmarkFailure {
  enum Kind { stopped, no_resource, disagreement } kind;
  std::string message;  // one line; empty if stopped
};

/// The render that starts now.
struct BenchmarkStep {
  Combination combination;
  int number = 0,
      count = 0;  // index of the timed render, from 1, and their number; 0: a comparison
  const BenchmarkTable* so_far = nullptr;  // its rows may be incomplete; valid during the call only
};

/// Builds the structures, compares their pictures without effects, and times the combinations of
/// the request; `control` shows the progress of the current one. The runs of a structure go in
/// rounds over all its rows, so a drift of the machine affects all rows alike. `on_step` is called
/// before each render, outside of the timed part.
std::expected<BenchmarkTable, BenchmarkFailure> measure_benchmark(
    const Scene& scene, const BenchmarkRequest& request, WorkControl& control,
    const std::function<void(const BenchmarkStep&)>& on_step = {});

/// The fraction of pixels in which the picture of `kind` differs by more than 8 of 255 from that of
/// another structure. An error, one line, if it exceeds 0.001: a fast but wrong picture is no
/// result.
std::expected<double, std::string> check_agreement(AccelKind kind, const Image& picture,
                                                   AccelKind other, const Image& of_other);

}  // namespace raio::core
