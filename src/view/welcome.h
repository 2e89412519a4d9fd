// The screen without a scene: recent ones, and those that come with Raio.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "view/layout.h"

namespace raio::core::view {

struct WelcomeResult {
  std::optional<std::string> open;  // a scene was selected
  bool asks = false;                // for the dialog
};

WelcomeResult draw_welcome(const Rect& where, const std::vector<std::string>& recent,
                           const std::vector<std::string>& samples);

}  // namespace raio::core::view
