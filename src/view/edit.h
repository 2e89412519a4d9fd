// Edits a scene in the window. Displayed scenes are immutable; an edit makes a new one, which
// shares all large arrays with the old.
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

namespace raio::core::view {

using SharedScene = std::shared_ptr<const Scene>;

/// The scene after `change`. Cheap, except for arrays that it writes, and for the first edit of a
/// scene that owns its arrays.
SharedScene edited(const SharedScene& scene, const std::function<void(Scene&)>& change);

/// The scene to save: with this camera and background, or sky. The scene's own sky keeps the name
/// of its folder, others get the whole path.
Scene as_seen(const Scene& scene, const Camera& camera, const Rgb& background,
              const std::shared_ptr<const CubeMap>& sky = nullptr);

/// Writes scenes in the background.
class SceneWriter {
 public:
  struct Written {
    std::string path;
    SharedScene source, scene;                 // what was to be saved, and the file's contents
    std::expected<std::string, Error> result;  // what the format loses, in one line
  };

  /// Starts to write the state's scene as currently displayed. Must not be called while is_busy().
  void write(const ViewState& state, const std::string& path);
  bool is_busy() const { return writing_.valid(); }
  /// The finished result, once.
  std::optional<Written> poll();

 private:
  std::future<Written> writing_;  // awaited at destruction
};

/// Makes the written file the state's; edits made meanwhile are kept.
void take_saved(ViewState& state, const SceneWriter::Written& written);

}  // namespace raio::core::view
