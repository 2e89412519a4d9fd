// Changes of a scene in the window. Scenes are immutable once they are shown; a change makes
// another one, which shares all large arrays with the first.
#pragma once

#include <expected>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "base/error.h"
#include "scene/scene.h"
#include "view/state.h"

namespace raio::view {

using SharedScene = std::shared_ptr<const Scene>;

/// The scene with what `change` makes of it. Costs little but for the arrays that it writes to, and
/// at the first change of a scene that owns its arrays.
SharedScene edited(const SharedScene& scene, const std::function<void(Scene&)>& change);

/// What is saved: the scene seen from there, with that background, or that sky. A sky of the
/// scene's own keeps the name of its folder, others get the whole path.
Scene as_seen(const Scene& scene, const Camera& camera, const Rgb& background,
              const std::shared_ptr<const CubeMap>& sky = nullptr);

/// Writes scenes in the background.
class SceneWriter {
 public:
  struct Written {
    std::string path;
    SharedScene source, scene;                 // what was to be saved, and what the file says
    std::expected<std::string, Error> result;  // what the format does not keep, in one line
  };

  /// Begins to write the state's scene as it is seen now. Not while is_busy().
  void write(const ViewState& state, const std::string& path);
  bool is_busy() const { return writing_.valid(); }
  /// What was written meanwhile, once.
  std::optional<Written> poll();

 private:
  std::future<Written> writing_;  // is waited for in the end
};

/// Makes the file that was written the state's; what was edited meanwhile stays.
void take_saved(ViewState& state, const SceneWriter::Written& written);

}  // namespace raio::view
