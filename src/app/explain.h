// What raio explain tells of a sample: as text, as JSON, and drawn into the scene.
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "app/canvas.h"
#include "app/commands.h"
#include "integrate/explain.h"

namespace raio::app {

struct Explained {
  const Scene& scene;
  const Accel& accel;
  const ExplainCommand& command;
  const RenderSettings& settings;
  const Explanation& sample;
  std::vector<std::optional<TraceLog>> logs;  // of each ray
};

std::string explained_text(const Explained& what);
std::string explained_json(const Explained& what);

/// The file's bytes: the rays in the scene, seen from aside or from where the command says, beside
/// what they hit. The error is one line.
std::expected<std::string, std::string> draw_explained(const Explained& what, PlotFormat format);

/// "sphere 12".
std::string name_of(PrimitiveId id);
/// Of a shadow ray: the test that stopped it; null if there is none or nothing was logged.
const TraceLog::Test* stopper(const std::optional<TraceLog>& log);

}  // namespace raio::app
