// The screen without a scene: pictures of recent scenes, of the course's lessons, and of the scenes
// that come with Raio.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "view/layout.h"
#include "view/lesson.h"
#include "view/memory.h"
#include "view/page_pictures.h"
#include "view/stage.h"

namespace raio::core::view {

/// The picture of a file, and two texts below and beside it.
struct SceneCard {
  Texture texture;    // empty: it has none
  std::string size;   // "91 primitives"
  std::string about;  // a sentence, or why there is no picture
};

struct WelcomeFacts {
  std::vector<std::string> recent;
  SampleScenes samples;
  const std::map<std::string, SceneCard>* cards = nullptr;  // by path, those made so far
  std::vector<LessonEntry> lessons = {};  // NOLINT(readability-redundant-member-init)
  PagePictures* pictures = nullptr;       // of the lessons; null: none
};

struct WelcomeResult {
  std::optional<std::string> open;    // a scene was selected
  std::optional<std::string> lesson;  // a page was selected
  bool asks = false;                  // for the dialog
};

WelcomeResult draw_welcome(const Rect& where, const WelcomeFacts& facts);

}  // namespace raio::core::view
