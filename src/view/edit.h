// Changes of a scene in the window. Scenes are immutable once they are shown; a change makes
// another one, which shares all large arrays with the first.
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <string>

#include "base/error.h"
#include "scene/scene.h"
#include "view/state.h"

namespace raio::view {

using SharedScene = std::shared_ptr<const Scene>;

/// The scene with what `change` makes of it. Costs little but for the arrays that it writes to, and
/// at the first change of a scene that owns its arrays.
SharedScene edited(const SharedScene& scene, const std::function<void(Scene&)>& change);

/// What is saved: the scene seen from there, with that background.
Scene as_seen(const Scene& scene, const Camera& camera, const Rgb& background);

/// Writes the state's scene as it is seen, which becomes the state's; what of it the format does
/// not keep, in one line, or nothing.
std::expected<std::string, Error> save_as_seen(ViewState& state, const std::string& path);

}  // namespace raio::view
