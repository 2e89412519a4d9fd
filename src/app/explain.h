// The output of `raio explain`: text, JSON, or a drawing of the scene.
#pragma once

#include <array>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands.h"
#include "draw/canvas.h"
#include "integrate/explain.h"
#include "render/options.h"

namespace raio::core::app {

struct Explained {
  const Scene& scene;
  const Accel& accel;
  const RenderSettings& settings;
  std::array<int, 2> pixel;  // column, row
  int number;                // of the sample
  const Explanation& sample;
  const std::vector<std::optional<TraceLog>>& logs;  // by ray
  std::optional<Vec3d> plot_from{};                  // viewpoint of the drawing
  std::optional<Camera> plot_camera{};               // or the whole camera; absent: from the side
};

/// Why rays cannot be explained with these options, or nothing.
std::optional<Error> explain_conflict(RenderOptions options, const Scene& scene);
/// The options needed for explained rays: with counters, and a structure that can log. The caller
/// has refused or replaced Embree.
RenderSettings explained_settings(RenderOptions options, const Scene& scene);
/// The log of each ray in the structure; nothing for rays that were not traced.
std::vector<std::optional<TraceLog>> logs_of(const Explanation& sample, const Accel& accel);

std::string explained_text(const Explained& what);
std::string explained_json(const Explained& what);

/// The bytes of a drawing of the rays in the scene, from the side or the viewpoint in `what`, with
/// a list of their hits. The error is one line.
std::expected<std::string, std::string> draw_explained(const Explained& what, PlotFormat format);

/// A viewpoint at the side of the rays that shows them all: eye, hits, camera and lights.
struct SideView {
  struct Light {
    int number = 0;
    Vec3d at;                        // if it is distant, in its direction
    std::optional<Vec3d> towards{};  // a distant light: its direction
    std::vector<Vec3d> corners{};    // with soft shadows
  };

  Camera camera;
  double extent = 1;  // approximate size of eye and hits
  // The inspected camera: its eye, and the corners of its image and of the pixel there, from the
  // upper left, clockwise. A small pixel is enlarged.
  Vec3d eye;
  bool is_parallel = false;
  std::array<Vec3d, 4> image, pixel;
  std::vector<Light> lights;  // those in front of the surfaces hit
};
SideView side_view(const Explanation& sample, const RenderSettings& settings,
                   std::array<int, 2> pixel, double width_per_height);
/// The end of a ray in a drawing: one that hits nothing is cut off.
Vec3d drawn_end(const ExplainedRay& ray, const std::optional<TraceLog>& log, const SideView& view);

/// "reflection".
std::string_view word_of(ExplainedRay::Kind kind);
/// "sphere 12".
std::string name_of(const Geometry& geometry, PrimitiveId id);
/// For a shadow ray: "0", or on a path Bounce::light.
std::string light_name(const Explanation& sample, const ExplainedRay& shadow);
/// For a shadow ray: the test that stopped it; null if none or not logged.
const TraceLog::Test* stopper(const std::optional<TraceLog>& log);

}  // namespace raio::core::app
