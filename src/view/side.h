// A session with its display, and how pictures and labels are drawn into the window.
#pragma once

#include <imgui.h>

#include <memory>
#include <optional>
#include <string>

#include "render/session.h"
#include "view/stage.h"
#include "view/state.h"

namespace raio::core::view {

/// A session, its newest picture, and its texture.
struct Side {
  std::unique_ptr<Session> session;
  Texture texture;
  std::shared_ptr<const SessionPicture> picture;
  uint64_t first_request = 0;  // of the current kind
  bool is_logged = true;

  /// Whether there is a picture of the current kind.
  bool has_picture() const;
  /// Takes the newest picture; returns whether it changed. `view` has the annotations for it.
  bool take(const ViewState& view);
  /// Draws the part between `left` and `right` (0 to 1) on the stage.
  void draw(const Stage& stage, float left, float right, float alpha) const;
  /// Makes an image the texture, with the exposure and tone curve of the settings, and annotations.
  void show(const Image& image, const RenderSettings& settings, const Overlay& overlay = {});
  /// The newly visible picture, once: "720x480 samples 3 request 1 sum 4c0e7ee63a101cca".
  std::optional<std::string> news();
};

enum class Beside { left, right };

/// White on a dark ground, to the left or right of a position.
void draw_label(ImVec2 at, const std::string& label, Beside beside);

/// The bar between two pictures, `at` 0 to 1, with their labels.
void draw_split_bar(const Stage& stage, float at, const std::string& left,
                    const std::string& right);

}  // namespace raio::core::view
