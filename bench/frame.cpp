// The suites that render pictures: frame, threads, growth.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "bench/rays.h"
#include "bench/suites.h"
#include "io/file.h"
#include "io/nff/nff.h"
#include "render/options.h"
#include "render/render.h"

namespace raio::core::bench {
namespace {

struct Built {
  AccelKind kind;
  std::unique_ptr<Accel> accel;
  double seconds;
};

std::vector<Built> build_and_check(const Scene& scene, const Settings& s) {
  std::vector<Built> all;
  for (const AccelKind kind : s.structures) {
    std::unique_ptr<Accel> accel;
    const double seconds =
        seconds_on(s.options.threads, [&] { accel = build_structure(scene, kind, s); });
    all.push_back({kind, std::move(accel), seconds});
  }
  if (!s.check || all.empty()) return all;
  const Recording rays = record_rays(scene, *all.front().accel, s.options);
  for (const Built& b : all) check_structure(scene, *b.accel, rays, s.options.threads);
  return all;
}

struct Rendered {
  double seconds;
  RayCounts rays;
};
Rendered render_once(const Scene& scene, const Accel& accel, const RenderSettings& settings) {
  const auto film = make_film(scene, settings);
  if (!film) give_up(3, film.error().text());
  // Its memory is allocated before the clock starts, as for consecutive pictures.
  for (size_t t = 0; t < (*film)->tiles(); ++t) (*film)->replace(t, {});
  WorkControl control;
  const double seconds = render(scene, accel, settings, **film, control).seconds;
  return {seconds, (*film)->rays()};
}

RenderSettings with_effects(const Settings& s, const Scene& scene, const Effects& effects,
                            int threads) {
  RenderOptions request = s.options;
  request.soft_shadows = true, request.dof = true;  // so that lens and light are settled
  RenderSettings options = resolve_options(request, scene);
  options.aa = effects.aa, options.lens_samples = 1, options.threads = threads;
  options.soft_shadows = effects.soft_and_dof, options.dof = effects.soft_and_dof;
  return options;
}

// Every structure with all effects on all numbers of threads; `ratio` is the first row's time
// divided by this row's.
std::vector<Json> measure_frames(const Scene& scene, const Settings& s,
                                 const std::vector<int>& threads) {
  const std::vector<Built> built = build_and_check(scene, s);
  std::vector<Json> rows;
  std::vector<Contender> contenders;
  for (const Built& b : built)
    for (const Effects& effects : s.effects)
      for (const int n : threads) {
        const RenderSettings options = with_effects(s, scene, effects, n);
        const Accel* accel = b.accel.get();
        contenders.push_back(
            [&scene, accel, options] { return render_once(scene, *accel, options).seconds; });
        Json row;
        row["scene"] = scene.name, row["primitives"] = scene.primitive_count();
        row["structure"] = accel_name(b.kind), row["effects"] = effects.name, row["threads"] = n;
        row["what"] = fmt::format("{} {}, {} threads", accel_name(b.kind), effects.name, n);
        row["rays"] = render_once(scene, *accel, options).rays.total();
        row["build_s"] = b.seconds;
        rows.push_back(std::move(row));
      }
  const auto seconds = alternate(contenders, s.repeat);
  for (size_t i = 0; i < rows.size(); ++i) {
    add_times(rows[i], seconds[i], seconds[0]);
    rows[i]["mrays_s"] = double(rows[i]["rays"]) / median(seconds[i]) * 1e-6;
  }
  return rows;
}

std::vector<Json> frames(const Settings& request, const std::vector<AccelKind>& structures,
                         const std::vector<int>& threads) {
  const Settings s = request.with_defaults(kP3dScenes, structures, 11);
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    tell(name);
    std::ranges::move(measure_frames(get_scene(name), s, threads), std::back_inserter(rows));
  }
  print_table(rows, {{"scene", "scene"},
                     {"what", "what"},
                     {"median_s", "ms", 1e3},
                     {"least_s", "least ms", 1e3},
                     {"mrays_s", "Mrays/s"},
                     {"ratio", "ratio"}});
  fmt::print("\nmedians of {} runs; {}\n", s.repeat, kRatioNote);
  print_means(rows, "what", "ratio");
  return rows;
}

// Writes the scene's text to a file and reads it back: MB/s. The file is in the system's cache.
double reading_speed(const Scene& scene) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("raio_bench_{}.nff", getpid());
  const std::string text = write_nff(scene);
  if (const auto written = write_file(path, text); !written) give_up(3, written.error().text());
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    best = std::min(best, seconds_of([&] {
                      if (!read_nff(path)) give_up(1, scene.name + ": cannot be read again");
                    }));
  std::filesystem::remove(path);
  return double(text.size()) / best * 1e-6;
}

}  // namespace

std::vector<Json> frame_suite(const Settings& request) {
  return frames(request, {AccelKind::automatic, AccelKind::embree}, {request.options.threads});
}

std::vector<Json> threads_suite(const Settings& request) {
  return frames(request, {AccelKind::automatic}, {request.options.threads, 1});
}

std::vector<Json> growth_suite(const Settings& request) {
  std::vector<std::string> flakes;
  for (int level = 2; level <= 7; ++level) flakes.push_back(fmt::format("sphereflake:{}", level));
  const Settings s =
      request.with_defaults(flakes, {AccelKind::automatic, AccelKind::grid, AccelKind::embree}, 5);
  // The first build of a kind loads its dependencies, such as Embree's library.
  const Scene few = get_scene("spheres:8");
  for (const AccelKind kind : s.structures) build_structure(few, kind, s);
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    tell(name);
    const Scene scene = get_scene(name);
    const double mb_s = reading_speed(scene);
    for (Json& row : measure_frames(scene, s, {s.options.threads})) {
      row["read_mb_s"] = mb_s;
      rows.push_back(std::move(row));
    }
  }
  print_table(rows, {{"scene", "scene"},
                     {"primitives", "primitives"},
                     {"structure", "structure"},
                     {"read_mb_s", "read MB/s"},
                     {"build_s", "build ms", 1e3},
                     {"median_s", "render ms", 1e3},
                     {"ratio", "ratio"}});
  if (!s.plot.empty()) plot_growth(rows, s.plot);
  return rows;
}

}  // namespace raio::core::bench
