// What effects cost and what structures gain: times a scene with combinations of both, after making
// sure that all structures see the same picture. An effect is timed once it has a line in
// kBenchmarkEffects; requests, tables and plots take it from there.
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
#include "integrate/control.h"
#include "io/image/image.h"
#include "measure/effects.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio {

/// An effect that can be switched on and off.
struct BenchmarkEffect {
  Effect effect;
  std::string_view name;                    // for programs
  std::string_view short_name;              // for people, in a narrow column
  std::array<std::string_view, 2> heading;  // for people, in two lines
  bool by_default;
  int samples;  // a pixel gets so many times the samples that it gets without the effect
  std::string_view wants = {};  // of a scene, without which it is refused
};

/// The first three are those of the report of 2018, which takes 1 sample a pixel without effects, 3
/// with depth of field, 9 with antialiasing and 27 with both. They are off where they are not
/// combined; the others are then as options and scene say.
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

/// The effect of that name alone; empty when there is none.
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
  /// All subsets of these are timed, the empty one included.
  EffectSet effects = default_effects();
  int repeat = 1;
  /// The scene's view and all that is no effect and no number of samples: size, camera, depth,
  /// lens, size of the lights, cells of the grid, threads, seed.
  RenderOptions options;
};

/// The rows of a request, by structure; effects count up in binary, the last of them fastest.
std::vector<Combination> combinations(const BenchmarkRequest& request);

/// The least, the median and the most of some values, of which there is at least one.
struct Spread {
  double least = 0, median = 0, most = 0;

  /// Half of what lies between the least and the most, as a part of the median.
  double half_width() const { return (most - least) / 2 / median; }
};
Spread spread_of(std::vector<double> values);

struct BenchmarkRow {
  Combination combination;
  std::vector<double> runs_s;  // rendering alone, one a round; never empty
  uint64_t rays = 0;           // of one run

  Spread seconds() const { return spread_of(runs_s); }
  double rays_per_s() const { return double(rays) / seconds().median; }
};

/// How many times as long a row takes as a base that was measured with it, round by round: a
/// machine that is slower in one round than in another does not change it.
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
  std::optional<double> disagreement;  // largest share of pixels in which two structures' plain
                                       // pictures differ; nothing where there is one structure
  std::vector<BenchmarkRow> rows;      // in the order of combinations()

  /// Do programs read of kBenchmarkEffects[i] whether it was on? Of the report's always, of the
  /// others where they were combined.
  bool lists(size_t i) const { return kBenchmarkEffects[i].by_default || (effects >> i & 1); }

  /// Null when it was not measured.
  const BenchmarkRow* find(const Combination& combination) const;

  /// The row's cost: how many times as long as the same structure takes without effects.
  Spread relative_cost(const BenchmarkRow& row) const;
};

struct BenchmarkFailure {
  enum Kind { stopped, no_resource, disagreement } kind;
  std::string message;  // one line; empty when stopped
};

/// The render that begins now.
struct BenchmarkStep {
  Combination combination;
  int number = 0, count = 0;  // which of how many that are timed, from 1; 0: one to be compared
  const BenchmarkTable* so_far = nullptr;  // its rows may have no runs yet; for the call only
};

/// Builds the structures, holds their pictures without effects against each other, and times the
/// combinations of the request, of which `control` shows how far the present one has come. The runs
/// of a structure go in rounds, each over all its rows, so that a drift of the machine meets all
/// rows alike. `on_step` is called before each render, outside of what is timed.
std::expected<BenchmarkTable, BenchmarkFailure> measure_benchmark(
    const Scene& scene, const BenchmarkRequest& request, RenderControl& control,
    const std::function<void(const BenchmarkStep&)>& on_step = {});

/// The share of pixels in which the picture of `kind` differs by more than 8 of 255 from that of
/// another structure. An error, one line, when it is more than 0.001: fast and wrong is no result.
std::expected<double, std::string> check_agreement(AccelKind kind, const Image& picture,
                                                   AccelKind other, const Image& of_other);

}  // namespace raio
