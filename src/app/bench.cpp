#include "app/bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <ranges>

#include "app/commands.h"
#include "app/output.h"
#include "app/plot.h"
#include "app/terminal.h"

namespace raio::core::app {

namespace {

constexpr std::array kStructures = {AccelKind::none, AccelKind::grid, AccelKind::bvh,
                                    AccelKind::embree};

// The indices in `words` of a comma-separated list of items; nothing if one is unknown or repeated,
// or the list is empty.
std::optional<std::vector<size_t>> places_of(std::string_view list,
                                             const std::vector<std::string>& words) {
  std::vector<size_t> places;
  for (const auto item : std::views::split(list, ',')) {
    const auto found = std::ranges::find(words, std::string_view(item.begin(), item.end()));
    const size_t place = size_t(found - words.begin());
    if (found == words.end() || std::ranges::count(places, place) > 0) return std::nullopt;
    places.push_back(place);
  }
  if (places.empty()) return std::nullopt;
  return places;
}

// Checks usage and targets before minutes of work; returns the exit status.
int check_targets(const BenchCommand& command) {
  if (command.json == "-" && command.csv == "-")
    return bad_input("--json and --csv cannot both go to standard output; give one of them a file");
  if (!command.plot.empty())
    if (const auto format = plot_format(command.plot); !format) return bad_input(format.error());
  for (const std::string& path : {command.json, command.csv, command.plot}) {
    if (path.empty() || path == "-") continue;
    if (const auto writable = check_writable(path); !writable) return fail(writable.error());
  }
  return kDone;
}

int write_results(const BenchmarkTable& table, const BenchCommand& command) {
  int status = kDone;
  const auto write = [&](const std::string& path, std::string_view bytes) {
    if (const int failed = deliver(path, bytes)) status = failed;
  };
  if (command.json != "-" && command.csv != "-") write("-", table_text(table));
  if (!command.json.empty()) write(command.json, table_json(table));
  if (!command.csv.empty()) write(command.csv, table_csv(table));
  if (!command.plot.empty()) {
    const auto picture = draw_plot(table, *plot_format(command.plot));
    if (picture)
      write(command.plot, *picture);
    else
      status = no_resource(picture.error());
  }
  return status;
}

int report(const BenchmarkFailure& failure) {
  if (failure.kind == BenchmarkFailure::stopped) return interrupted();
  print_error(with_settings(failure.message, "--"));
  return failure.kind == BenchmarkFailure::disagreement ? kCheckFailed : kNoResource;
}

}  // namespace

std::expected<std::vector<AccelKind>, std::string> parse_structures(std::string_view list) {
  std::vector<std::string> words;
  words.reserve(kStructures.size());
  for (const AccelKind kind : kStructures) words.emplace_back(accel_name(kind));
  const auto places = places_of(list, words);
  if (!places)
    return std::unexpected(fmt::format("expected some of {}, each once, as in grid,bvh, found '{}'",
                                       fmt::join(words, ", "), list));
  std::vector<AccelKind> kinds;
  kinds.reserve(places->size());
  for (const size_t place : *places) kinds.push_back(kStructures[place]);
  return kinds;
}

std::expected<EffectSet, std::string> parse_effects(std::string_view list) {
  if (list == "none") return 0;
  std::vector<std::string> words;
  words.reserve(kBenchmarkEffects.size());
  for (const BenchmarkEffect& effect : kBenchmarkEffects) words.push_back(effect_word(effect));
  const auto places = places_of(list, words);
  if (!places)
    return std::unexpected(
        fmt::format("expected none, or some of {}, each once, as in {},{}, found '{}'",
                    fmt::join(words, ", "), words[0], words[1], list));
  EffectSet effects = 0;
  for (const size_t place : *places) effects |= EffectSet(1) << place;
  return effects;
}

std::string effect_word(const BenchmarkEffect& effect) {
  std::string word(effect.name);
  std::ranges::replace(word, '_', '-');
  return word;
}

std::string bench_conflict(const BenchmarkRequest& request) {
  const RenderOptions& o = request.options;
  const bool grid = std::ranges::count(request.structures, AccelKind::grid) > 0;
  const bool soft = (request.effects & effect_named("soft_shadows")) != 0;
  const bool dof = (request.effects & effect_named("dof")) != 0;
  const auto without = [](std::string_view option, std::string_view word, std::string_view list) {
    return fmt::format("{0} has no effect without {1} among {2}; add {1} there or leave {0} out",
                       option, word, list);
  };
  if (o.accel.grid_factor > 0 && !grid) return without("--grid-factor", "grid", "--accel");
  if (o.light_size > 0 && !soft) return without("--light-size", "soft-shadows", "--effects");
  if (o.aperture > 0 && !dof) return without("--aperture", "dof", "--effects");
  if (o.focus > 0 && !dof) return without("--focus", "dof", "--effects");
  for (const auto& [word, roughness] :
       {std::pair("gloss", o.gloss), std::pair("translucency", o.translucency)})
    if (roughness == 0 && (request.effects & effect_named(word)))
      return fmt::format(
          "--{0} 0 cannot be combined with {0} in --effects; give a roughness above 0, or leave "
          "one of them out",
          word);
  if (o.shutter && (*o.shutter)[0] == (*o.shutter)[1] && (request.effects & effect_named("motion")))
    return "--shutter closes when it opens, so nothing moves; give two times, or leave motion out "
           "of --effects";
  return {};
}

std::string absence_of_effects(const BenchmarkRequest& request, const Scene& scene) {
  const Fresnel fresnel = resolve_options(request.options, scene).fresnel;
  for (const BenchmarkEffect& effect : kBenchmarkEffects)
    if (!effect.wants.empty() && (request.effects & effect_named(effect.name)) &&
        !is_in_scene(effect.effect, scene, fresnel))
      return fmt::format("{0} has no effect on a scene without {1}; leave {0} out of --effects",
                         effect_word(effect), effect.wants);
  if (request.options.shutter && !scene.moves())
    return "--shutter has no effect on a scene without motion; leave it out";
  return {};
}

int run(const BenchCommand& command) {
  if (const int status = check_targets(command)) return status;
  WorkControl control;
  const StopOnSignal stop(&control);
  const auto scene = Executor(0, &control).run([&] {
    return load_scene(command.scene, false, nullptr, {.instances = true});
  });
  if (!scene) return scene.error();
  if (const auto why = absence_of_effects(command.request, *scene); !why.empty())
    return bad_input(why);

  std::optional<ProgressLine> line;
  const auto table =
      measure_benchmark(*scene, command.request, control, [&](const BenchmarkStep& step) {
        const std::string label = short_label(step.combination);
        line.reset();  // wipes the previous one
        line.emplace(control, command.progress,
                     step.number > 0 ? fmt::format("{}/{} {}", step.number, step.count, label)
                                     : "comparing " + label);
      });
  line.reset();
  return table ? write_results(*table, command) : report(table.error());
}

}  // namespace raio::core::app
