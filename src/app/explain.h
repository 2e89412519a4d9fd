// What raio explain tells of a sample: as text, as JSON, and drawn into the scene.
#pragma once

#include <array>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "app/canvas.h"
#include "app/commands.h"
#include "integrate/explain.h"
#include "render/options.h"

namespace raio::app {

struct Explained {
  const Scene& scene;
  const Accel& accel;
  const RenderSettings& settings;
  std::array<int, 2> pixel;  // column, row
  int number;                // of the sample
  const Explanation& sample;
  const std::vector<std::optional<TraceLog>>& logs;  // of each ray
  std::optional<Vec3d> plot_from{};                  // where the drawing is seen from
  std::optional<Camera> plot_camera{};               // or all of that; else from aside
};

/// The options as they have to be for rays that are told: with counters, and a structure that does
/// tell what it does. The caller has refused or replaced Embree.
RenderSettings explained_settings(RenderOptions options, const Scene& scene);
/// What each ray did in the structure; nothing for rays that were not traced.
std::vector<std::optional<TraceLog>> logs_of(const Explanation& sample, const Accel& accel);

std::string explained_text(const Explained& what);
std::string explained_json(const Explained& what);

/// The file's bytes: the rays in the scene, seen from aside or from where `what` says, beside
/// what they hit. The error is one line.
std::expected<std::string, std::string> draw_explained(const Explained& what, PlotFormat format);

/// Where the rays are seen from aside, and about how large what they hit is.
struct SideView {
  Camera camera;
  double extent = 1;
};
SideView side_view(const Explanation& sample, const RenderSettings& settings,
                   double width_per_height);
/// Where a ray ends in a drawing: one that hits nothing is cut off.
Vec3d drawn_end(const ExplainedRay& ray, const std::optional<TraceLog>& log, double extent);

/// "sphere 12".
std::string name_of(const Geometry& geometry, PrimitiveId id);
/// Of a shadow ray: the test that stopped it; null if there is none or nothing was logged.
const TraceLog::Test* stopper(const std::optional<TraceLog>& log);

}  // namespace raio::app
