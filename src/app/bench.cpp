#include "app/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <expected>
#include <map>
#include <memory>
#include <ranges>
#include <tuple>

#include "app/commands.h"
#include "app/output.h"
#include "app/plot.h"
#include "app/terminal.h"
#include "base/platform/processor.h"
#include "io/image/image.h"
#include "render/render.h"

namespace raio::app {

namespace {

// The share of pixels in which the structures' pictures may differ by more than 8 of 255: rays that
// graze an edge may fall on either side of it.
constexpr double kAllowedDisagreement = 0.001;

using Failure = BenchFailure;

struct ReportTime {
  std::string_view scene;
  Combination combination;
  double seconds;
};

// What is known of the report's table (kReportSource); the rest is not, and stays out.
constexpr ReportTime kReportTimes[] = {
    {"balls_medium", {AccelKind::none, false, false, false}, 24.3},
    {"balls_medium", {AccelKind::grid, false, false, false}, 4.5},
    {"balls_medium", {AccelKind::grid, true, true, true}, 98.4},
};

class Measurement {
 public:
  Measurement(const Scene& scene, const BenchCommand& command, RenderControl& control)
      : scene_(scene), command_(command), control_(control) {
    // Resolved as if all effects were on, so that lens and light are settled for those that use
    // them.
    RenderOptions wish = command.options;
    wish.soft_shadows = true, wish.dof = true;
    options_ = resolve_options(wish, scene);
  }

  std::expected<BenchTable, Failure> run() {
    BenchTable table;
    table.version = RAIO_VERSION;
    table.scene = scene_.name;
    table.machine = processor_name();
    table.width = options_.width, table.height = options_.height;
    table.threads = options_.threads, table.depth = options_.depth;
    table.repeat = std::max(1, command_.repeat), table.seed = options_.seed;

    for (const AccelKind kind : kBenchStructures) {
      const auto built = build(kind);
      if (!built) return std::unexpected(built.error());
      table.structures.push_back(*built);
    }
    const auto disagreement = compare_plain();
    if (!disagreement) return std::unexpected(disagreement.error());
    table.disagreement = *disagreement;

    // What costs little comes first, so that an interrupted or watched run has shown most by then:
    // the structures before brute force, few samples before many.
    const auto combinations = all_combinations();
    std::vector<size_t> order(combinations.size());
    std::ranges::copy(std::views::iota(size_t(0), order.size()), order.begin());
    std::ranges::sort(order, {}, [&](size_t i) {
      return std::tuple(combinations[i].accel == AccelKind::none,
                        samples_per_pixel(combinations[i]), i);
    });
    table.rows.resize(combinations.size());
    for (size_t done = 0; const size_t i : order) {
      const std::string label =
          fmt::format("{}/{} {}", ++done, order.size(), short_label(combinations[i]));
      auto row = measure(combinations[i], label);
      if (!row) return std::unexpected(row.error());
      table.rows[i] = std::move(*row);
    }
    return table;
  }

 private:
  std::expected<BenchStructure, Failure> build(AccelKind kind) {
    AccelOptions wish = command_.options.accel;
    if (kind != AccelKind::grid) wish = {};
    wish.kind = kind;
    const auto start = std::chrono::steady_clock::now();
    std::expected<std::unique_ptr<Accel>, std::string> accel;
    on_threads(options_.threads, [&] { accel = build_accel(scene_, wish, options_.one_sided); });
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    if (!accel) return std::unexpected(Failure{kNoResource, accel.error()});
    if (control_.stop) return std::unexpected(Failure{kInterrupted, {}});
    accels_[kind] = std::move(*accel);
    return BenchStructure{accels_[kind]->info(), elapsed.count()};
  }

  struct Rendered {
    double seconds;
    std::unique_ptr<Film> film;
  };
  std::expected<Rendered, Failure> render_once(const Combination& c, const std::string& label) {
    RenderOptions options = options_;
    options.aa = aa_cells(c), options.lens_samples = lens_samples(c);
    options.soft_shadows = c.soft_shadows, options.dof = c.dof;
    control_.rays_done = control_.work_done = control_.work_total = 0;
    const ProgressLine progress(control_, command_.progress, label);
    auto film = make_film(scene_, options);
    if (!film) return std::unexpected(Failure{kNoResource, film.error()});
    const RenderResult result = render(scene_, *accels_.at(c.accel), options, **film, control_);
    if (!result.finished) return std::unexpected(Failure{kInterrupted, {}});
    return Rendered{result.seconds, std::move(*film)};
  }

  // Do the structures see the same picture? Also warms the machine up.
  std::expected<double, Failure> compare_plain() {
    Image of_none;
    double most = 0;
    for (const AccelKind kind : kBenchStructures) {
      const Combination plain{kind};
      const auto result = render_once(plain, fmt::format("comparing {}", short_label(plain)));
      if (!result) return std::unexpected(result.error());
      Image picture = result->film->resolve();
      if (kind == AccelKind::none) {
        of_none = std::move(picture);
        continue;
      }
      const auto differing = check_agreement(kind, picture, of_none);
      if (!differing) return std::unexpected(Failure{kCheckFailed, differing.error()});
      most = std::max(most, *differing);
    }
    return most;
  }

  std::expected<BenchRow, Failure> measure(const Combination& c, const std::string& label) {
    BenchRow row;
    row.combination = c;
    row.report_s = report_seconds(scene_.name, options_.width, options_.height, c);
    for (int i = 0; i < std::max(1, command_.repeat); ++i) {
      const auto result = render_once(c, label);
      if (!result) return std::unexpected(result.error());
      row.runs_s.push_back(std::max(result->seconds, 1e-9));
      row.rays = result->film->rays().total();
    }
    return row;
  }

  const Scene& scene_;
  const BenchCommand& command_;
  RenderControl& control_;
  RenderOptions options_;
  std::map<AccelKind, std::unique_ptr<Accel>> accels_;
};

// Usage and targets, before minutes of work are spent; the exit status.
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

int write_results(const BenchTable& table, const BenchCommand& command) {
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

}  // namespace

std::array<Combination, 8 * kBenchStructures.size()> all_combinations() {
  std::array<Combination, 8 * kBenchStructures.size()> all;
  for (unsigned i = 0; i < all.size(); ++i)
    all[i] = {kBenchStructures[i / 8], bool(i & 4), bool(i & 2), bool(i & 1)};
  return all;
}

std::string short_label(const Combination& c) {
  std::string label(accel_name(c.accel));
  if (c.aa) label += " AA";
  if (c.soft_shadows) label += " soft";
  if (c.dof) label += " DOF";
  return label;
}

std::optional<double> report_seconds(std::string_view scene, int width, int height,
                                     const Combination& combination) {
  if (width != 512 || height != 512) return {};
  for (const ReportTime& known : kReportTimes)
    if (known.scene == scene && known.combination == combination) return known.seconds;
  return {};
}

std::expected<double, std::string> check_agreement(AccelKind kind, const Image& picture,
                                                   const Image& of_none) {
  const double differing = compare(picture, of_none).above_8;
  if (differing <= kAllowedDisagreement) return differing;
  return std::unexpected(fmt::format(
      "the pictures of {} and none differ in {:.3g} % of the pixels (allowed {:.3g} %), "
      "so their times mean nothing",
      accel_name(kind), 100 * differing, 100 * kAllowedDisagreement));
}

double BenchRow::seconds() const {
  std::vector<double> sorted = runs_s;
  std::ranges::sort(sorted);
  const size_t half = sorted.size() / 2;
  return sorted.size() % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

std::optional<double> BenchRow::speedup() const {
  return report_s ? std::optional(*report_s / seconds()) : std::nullopt;
}

double BenchTable::relative_cost(const BenchRow& row) const {
  const auto plain =
      std::ranges::find(rows, Combination{row.combination.accel}, &BenchRow::combination);
  return plain == rows.end() ? 1 : row.seconds() / plain->seconds();
}

std::expected<BenchTable, BenchFailure> measure_bench(const Scene& scene,
                                                      const BenchCommand& command,
                                                      RenderControl& control) {
  return Measurement(scene, command, control).run();
}

int run(const BenchCommand& command) {
  if (const int status = check_targets(command)) return status;
  RenderControl control;
  const StopOnSignal stop(&control);
  const auto scene = load_scene(command.scene);
  if (!scene) return scene.error();

  const auto table = measure_bench(*scene, command, control);
  if (!table) {
    if (table.error().status == kInterrupted) return interrupted();
    print_error(table.error().message);
    return table.error().status;
  }
  return write_results(*table, command);
}

}  // namespace raio::app
