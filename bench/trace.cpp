// The suites that compare with bare Embree: trace and build.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <ranges>

#include "bench/embree_direct.h"
#include "bench/rays.h"
#include "bench/suites.h"

namespace raio::core::bench {
namespace {

// Traces a batch and returns the number of rays that hit.
struct Tracer {
  std::string name;
  std::function<size_t(const RayBatch&)> trace;
};

std::vector<Contender> contenders_of(const std::vector<Tracer>& tracers,
                                     const std::vector<RayBatch>& batches, int threads) {
  std::vector<Contender> contenders;
  contenders.reserve(tracers.size());
  for (const Tracer& tracer : tracers)
    contenders.push_back([&, threads] {
      return seconds_on(threads, [&] {
        tbb::parallel_for(size_t(0), batches.size(), [&](size_t i) { tracer.trace(batches[i]); });
      });
    });
  return contenders;
}

// Whether Embree gives the same hits, except for a few rays that graze an edge.
void check_hits(const std::vector<Tracer>& tracers, const std::vector<RayBatch>& batches,
                const std::string& what) {
  std::vector<double> hits;
  double rays = 0;
  for (const Tracer& tracer : tracers) {
    size_t sum = 0;
    for (const RayBatch& batch : batches) sum += tracer.trace(batch);
    hits.push_back(double(sum));
  }
  for (const RayBatch& batch : batches) rays += double(batch.size());
  for (size_t i = 1; i < hits.size(); ++i)
    if (std::abs(hits[i] - hits[0]) > 0.002 * rays)
      give_up(1, fmt::format("{}: {} of {} rays hit by {}, {} by {}", what, hits[0], rays,
                             tracers[0].name, hits[i], tracers[i].name));
}

struct TraceSubject {
  const Scene& scene;
  std::vector<std::unique_ptr<Accel>> structures;
  Recording rays;
  std::unique_ptr<EmbreeScene> embree;  // null if Embree does not have all shapes
};

// Raio's structures, and Embree with its fastest interface for these rays.
Json measure_kind(const TraceSubject& subject, RayKind kind, int threads, const Settings& s) {
  const std::vector<RayBatch>& batches = subject.rays.of(kind);
  std::vector<Tracer> tracers, ways;
  for (const auto& accel : subject.structures)
    tracers.push_back({accel->info().name, [&accel, kind](const RayBatch& batch) {
                         thread_local HitBatch hits;
                         return trace_batch(*accel, batch, kind, hits);
                       }});
  Json row;
  row["scene"] = subject.scene.name, row["kind"] = kRayKindNames[size_t(kind)];
  row["group"] = is_coherent(kind) ? "eye, shadow, reflection" : "random";
  row["threads"] = threads, row["rays"] = subject.rays.count(kind);
  if (subject.embree) {
    for (const EmbreeWay& way : kEmbreeWays)
      ways.push_back({std::string(way.name), [&](const RayBatch& batch) {
                        return subject.embree->trace(batch, way, kind == RayKind::shadow);
                      }});
    const auto seconds = alternate(contenders_of(ways, batches, threads), 3);
    const auto fastest = std::ranges::min_element(seconds, {}, median) - seconds.begin();
    row["Embree_way"] = ways[size_t(fastest)].name;
    tracers.push_back({"Embree", ways[size_t(fastest)].trace});
  }
  if (s.check) check_hits(tracers, batches, subject.scene.name);
  const auto seconds = alternate(contenders_of(tracers, batches, threads), s.repeat);
  for (size_t i = 0; i < tracers.size(); ++i) {
    const std::string& name = tracers[i].name;
    row[name + "_mrays_s"] = double(subject.rays.count(kind)) / median(seconds[i]) * 1e-6;
    if (subject.embree && i + 1 < tracers.size())
      row[name + "_to_Embree"] = median(seconds[i]) / median(seconds.back());
    row["runs_s"][name] = seconds[i];
  }
  return row;
}

// With their bytes after each run; destroying a structure is not timed.
std::vector<std::pair<std::string, Contender>> builders(const Scene& scene,
                                                        const Geometry& geometry, const Settings& s,
                                                        std::vector<size_t>& bytes) {
  std::vector<std::pair<std::string, Contender>> all;
  bytes.resize(s.structures.size() + 1);
  all.reserve(bytes.size());
  for (const AccelKind kind : s.structures)
    all.emplace_back(accel_name(kind), [&, kind, &size = bytes[all.size()]] {
      std::unique_ptr<Accel> accel;
      const double seconds =
          seconds_on(s.options.threads, [&] { accel = build_structure(scene, kind, s); });
      size = accel->info().bytes;
      return seconds;
    });
  if (EmbreeScene::can_hold(geometry))
    all.emplace_back("Embree", [&, &size = bytes[all.size()]] {
      std::optional<EmbreeScene> embree;
      const double seconds = seconds_on(s.options.threads, [&] { embree.emplace(geometry); });
      size = embree->bytes();
      return seconds;
    });
  return all;
}

}  // namespace

std::vector<Json> trace_suite(const Settings& request) {
  const Settings s = request.with_defaults(kP3dScenes, {AccelKind::bvh, AccelKind::grid}, 11);
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    tell(name);
    const Scene scene = get_scene(name);
    TraceSubject subject{scene, {}, {}, {}};
    for (const AccelKind kind : s.structures)
      subject.structures.push_back(build_structure(scene, kind, s));
    subject.rays = record_rays(scene, *subject.structures.front(), s.options);
    const Geometry& geometry = subject.structures.front()->geometry();
    if (EmbreeScene::can_hold(geometry)) subject.embree = std::make_unique<EmbreeScene>(geometry);
    for (const auto& accel : subject.structures)
      if (s.check) check_structure(scene, *accel, subject.rays, s.options.threads);
    for (const RayKind kind : kRayKinds)
      for (int threads = 1; threads <= s.options.threads;
           threads += std::max(1, s.options.threads - 1))
        if (subject.rays.count(kind) > 0) rows.push_back(measure_kind(subject, kind, threads, s));
  }
  print_table(rows, {{"scene", "scene"},
                     {"kind", "rays"},
                     {"threads", "threads"},
                     {"rays", "M", 1e-6},
                     {"bvh_mrays_s", "bvh Mrays/s"},
                     {"grid_mrays_s", "grid"},
                     {"Embree_mrays_s", "Embree"},
                     {"Embree_way", "its way"},
                     {"bvh_to_Embree", "bvh/Embree"},
                     {"grid_to_Embree", "grid/Embree"}});
  fmt::print(
      "\nx/Embree: ratio of times on the same rays, medians of {} runs; -: the scene has cones "
      "or planes, which Embree does not have\n",
      s.repeat);
  for (const char* group : {"kind", "group"})
    for (const char* ratio : {"bvh_to_Embree", "grid_to_Embree"}) print_means(rows, group, ratio);
  return rows;
}

std::vector<Json> build_suite(const Settings& request) {
  const Settings s = request.with_defaults({"spheres:1000000", "mixed:1000000", "terrain:1000000"},
                                           {AccelKind::bvh, AccelKind::grid}, 3);
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    tell(name);
    const Scene scene = get_scene(name);
    std::optional<Recording> rays;
    for (const AccelKind kind : s.structures) {
      if (!s.check) break;
      const auto accel = build_structure(scene, kind, s);
      if (!rays) rays = record_rays(scene, *accel, s.options);
      check_structure(scene, *accel, *rays, s.options.threads);
    }
    const Geometry geometry(scene, scene);  // for Embree; Raio bakes its own on its own time
    std::vector<size_t> bytes;
    const auto all = builders(scene, geometry, s, bytes);
    std::vector<Contender> contenders;
    std::ranges::copy(std::views::values(all), std::back_inserter(contenders));
    const auto seconds = alternate(contenders, s.repeat);
    for (size_t i = 0; i < all.size(); ++i) {
      Json row;
      row["scene"] = name, row["primitives"] = scene.primitive_count();
      row["structure"] = all[i].first, row["threads"] = s.options.threads;
      row["bytes"] = bytes[i];
      row["bytes_per_primitive"] = double(bytes[i]) / double(scene.primitive_count());
      add_times(row, seconds[i], seconds[0]);
      rows.push_back(std::move(row));
    }
  }
  print_table(rows, {{"scene", "scene"},
                     {"primitives", "primitives"},
                     {"structure", "structure"},
                     {"median_s", "ms", 1e3},
                     {"bytes", "MB", 1e-6},
                     {"bytes_per_primitive", "bytes each"},
                     {"ratio", "ratio"}});
  fmt::print("\nmedians of {} runs; {}; Embree with its buffers\n", s.repeat, kRatioNote);
  print_means(rows, "structure", "ratio");
  return rows;
}

}  // namespace raio::core::bench
