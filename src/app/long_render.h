// Renders that outlive the program: what `raio render` starts from (the settings of a picture, a
// part file) and how it keeps its film meanwhile. docs/long-renders.md
#pragma once

#include <expected>
#include <memory>
#include <string>

#include "app/commands.h"
#include "base/parallel.h"
#include "render/part.h"

namespace raio::app {

/// Why options of `raio render` do not go together that are about where it starts and what it
/// keeps; one line, empty when they do.
std::string long_render_conflict(const RenderCommand& command);

/// Where a render starts. Errors are exit statuses; they were printed.
struct RenderStart {
  RenderCommand command;       // with the options and the scene that a picture or a part brought
  Metadata settings;           // of that picture or part; empty: none
  uint32_t samples = 0;        // of a pixel, when not all that the options say
  std::unique_ptr<Film> film;  // of --add-samples and --resume
};
std::expected<RenderStart, int> find_start(const RenderCommand& command);

/// The film to work on: the one that `start` brought, if it is of this picture, or an empty one.
std::expected<std::unique_ptr<Film>, int> film_of(RenderStart& start, const Scene& scene,
                                                  const RenderSettings& used,
                                                  const Metadata& settings);

/// Keeps a film in a part file, at intervals while it lives. A failure is told once and does not
/// disturb the work.
class Checkpoint {
 public:
  Checkpoint(const RenderCommand& command, PartHeader header, const Film& film);
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Now, and no more afterwards. Nothing to do without --checkpoint.
  std::expected<void, FileError> finish();

 private:
  std::string path_;
  PartHeader header_;
  const Film& film_;
  bool told_ = false;  // of a failure, to the user
  Ticker ticker_;
};

}  // namespace raio::app
