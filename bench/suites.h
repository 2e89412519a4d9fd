// The suites of the benchmark, and their common parts. Each suite checks the compared alternatives,
// measures, prints a table, and returns its rows for --json.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "bench/figures.h"
#include "render/options.h"

namespace raio::core::bench {

/// The samples of a picture: one per pixel, or nine, alone or shared by all effects.
struct Effects {
  std::string_view name;
  int aa;
  bool soft_and_dof;
};
inline constexpr Effects kEffects[] = {{"plain", 1, false}, {"aa", 3, false}, {"all", 3, true}};

struct Settings {
  std::vector<std::string> scenes;
  std::vector<AccelKind> structures;  // the others are compared with the first
  std::vector<Effects> effects;
  int repeat = 0;
  bool check = true;
  std::string plot, crops, raio, pov_converter;
  RenderOptions options;  // size and threads are resolved

  /// The defaults.
  Settings with_defaults(const std::vector<std::string>& scenes,
                         const std::vector<AccelKind>& structures, int repeat) const;
};

inline const std::vector<std::string> kP3dScenes = {"balls_low", "balls_medium", "balls_high",
                                                    "mount_low", "mount_high",   "mount_very_high"};
inline constexpr std::string_view kRatioNote =
    "ratio: time of the scene's first line over this one";

/// `request` is a file, or a name with a size after a colon: a procedural scene (sphereflake:6), or
/// with the number of primitives spheres:N (equal radii), mixed:N (radii of 1 to 100) or terrain:N
/// (triangles). Ends the program on failure, like everything here.
Scene get_scene(const std::string& request);

/// With the grid options of the settings.
std::unique_ptr<Accel> build_structure(const Scene& scene, AccelKind kind,
                                       const Settings& settings);

/// Time against the number of primitives from the rows of growth_suite: .png, .svg or .pdf.
void plot_growth(const std::vector<Json>& rows, const std::string& path);

/// Pictures, rendering only: each structure with each of the effects.
std::vector<Json> frame_suite(const Settings& request);
/// The same on all threads and on one.
std::vector<Json> threads_suite(const Settings& request);
/// Reading, building and rendering of growing scenes.
std::vector<Json> growth_suite(const Settings& request);
/// Bare tracing of recorded rays by kind, compared with expert use of Embree.
std::vector<Json> trace_suite(const Settings& request);
/// Seconds and bytes of building, compared with Embree and its buffers.
std::vector<Json> build_suite(const Settings& request);
/// How quickly cancelled builds stop at `repeat` random times.
std::vector<Json> cancel_suite(const Settings& request);
/// The error of each sampler for growing numbers of samples.
std::vector<Json> converge_suite(const Settings& request);
/// The whole program from start to end, compared with Tachyon and POV-Ray.
std::vector<Json> process_suite(const Settings& request);

}  // namespace raio::core::bench
