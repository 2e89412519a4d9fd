// raio_bench: the speed of Raio and its structures compared with others. See docs/performance.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "app/arguments.h"
#include "bench/suites.h"
#include "draw/canvas.h"

namespace raio::core::bench {
namespace {

struct Suite {
  const char* name;
  const char* help;
  std::vector<Json> (*run)(const Settings&);
};
constexpr Suite kSuites[] = {
    {"frame", "Rendering alone, structures and effects side by side", frame_suite},
    {"trace", "Bare tracing by kind of ray, compared with Embree", trace_suite},
    {"build", "Building, seconds and bytes, compared with Embree", build_suite},
    {"cancel", "How quickly cancelled builds stop", cancel_suite},
    {"growth", "Reading, building and rendering of growing scenes", growth_suite},
    {"threads", "Rendering on all threads and on one", threads_suite},
    {"converge", "Errors of the samplers against the number of samples", converge_suite},
    {"process", "The whole program, compared with Tachyon and POV-Ray", process_suite},
};

// Finds the item with that name in a comma-separated list.
template <class Items, class Name>
auto find_item(const std::string& wanted, const Items& items, const Name& name_of) {
  for (const auto& item : items)
    if (name_of(item) == wanted) return item;
  std::string names;
  for (const auto& item : items) names += fmt::format(" {}", name_of(item));
  throw CLI::ValidationError(fmt::format("found '{}', expected one of{}", wanted, names));
}

void add_suite(CLI::App& app, const Suite& suite, Settings& s, std::string& json) {
  auto* sub = app.add_subcommand(suite.name, suite.help);
  sub->add_option("scene", s.scenes,
                  "Scene files, or procedural scenes as NAME[:SIZE], "
                  "spheres:N, mixed:N, terrain:N (default: the suite's own)");
  sub->add_option_function<std::vector<std::string>>(
         "--accel",
         [&s](const std::vector<std::string>& names) {
           constexpr AccelKind kKinds[] = {AccelKind::automatic, AccelKind::none, AccelKind::grid,
                                           AccelKind::bvh, AccelKind::embree};
           for (const auto& name : names)
             s.structures.push_back(find_item(name, kKinds, accel_name));
         },
         "Structures; the others are compared with the first")
      ->delimiter(',');
  sub->add_option_function<std::vector<std::string>>(
         "--effects",
         [&s](const std::vector<std::string>& names) {
           for (const auto& name : names)
             s.effects.push_back(
                 find_item(name, kEffects, [](const Effects& e) { return e.name; }));
         },
         "plain (1 sample per pixel), aa (9) or all (the same 9 for soft shadows and lens, too)")
      ->delimiter(',');
  sub->add_option("--repeat", s.repeat, "Runs of each; the table shows the median")
      ->check(CLI::Range(1, 100000));
  sub->add_flag_callback("--no-check", [&s] { s.check = false; }, "Do not compare with none first");
  sub->add_option("--json", json, "Write a line of JSON for each row of the table");
  sub->add_option("--plot", s.plot, "growth, converge: draw it, .png .svg .pdf by suffix");
  sub->add_option("--crops", s.crops,
                  "converge: write a part of a soft shadow by jitter and sobol, enlarged");
  sub->add_option("--raio", s.raio, "process: the program (default: the one built beside this)");
  sub->add_option("--pov-converter", s.pov_converter,
                  "process: a Python script IN.nff OUT.pov, without which POV-Ray is left out");
  app::add_render_options(*sub, s.options,
                          {"size", "threads", "grid-factor", "grid-resolution", "light-size",
                           "aperture", "focus", "depth", "seed"});
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Compares the speed of Raio and others, after checking that their pictures agree");
  app.require_subcommand(1);
  Settings s;
  s.raio = RAIO_PROGRAM;
  std::string json;
  for (const Suite& suite : kSuites) add_suite(app, suite, s, json);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) ? 2 : 0;
  }
  if (!s.plot.empty())
    if (const auto format = plot_format(s.plot); !format) give_up(2, format.error());
  s.options.threads = resolve_options(s.options, Scene{}).threads;
  for (const Suite& suite : kSuites) {
    if (!app.got_subcommand(suite.name)) continue;
    std::vector<Json> rows = suite.run(s);
    for (Json& row : rows) row["suite"] = suite.name;
    if (!json.empty()) write_json(rows, json);
  }
  return 0;
}

}  // namespace
}  // namespace raio::core::bench

int main(int argc, char** argv) {
  int status = 3;
  std::string message;
  try {
    return raio::core::bench::parse_and_run(argc, argv);
  } catch (const raio::core::bench::Failure& failure) {
    status = failure.status, message = failure.message;
  } catch (const std::exception& error) {
    message = error.what();
  }
  raio::core::bench::tell("error: " + message);
  return status;
}
