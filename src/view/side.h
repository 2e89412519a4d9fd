// A session with what is seen of it, and how pictures and labels are drawn into the window.
#pragma once

#include <imgui.h>

#include <memory>
#include <optional>
#include <string>

#include "render/session.h"
#include "view/stage.h"

namespace raio::view {

/// One session, its newest picture, and that as a texture.
struct Side {
  std::unique_ptr<Session> session;
  Texture texture;
  std::shared_ptr<const SessionPicture> picture;
  uint64_t request = 0, first_request = 0;  // the newest; the first that is of the present kind
  bool is_logged = true;

  /// Is there one of the present kind?
  bool has_picture() const;
  /// Takes the newest picture. Whether it is another.
  bool take();
  /// Draws the part between `left` and `right` (0 to 1) where the stage says.
  void draw(const Stage& stage, float left, float right, float alpha) const;
  /// Makes an image the texture, with the exposure and tone curve of the settings.
  void show(const Image& image, const RenderSettings& settings);
  /// What has just become visible, once: "720x480 samples 3 request 1 sum 4c0e7ee63a101cca".
  std::optional<std::string> news();
};

enum class Beside { left, right };

/// White on a dark ground, to the left or to the right of a place.
void draw_label(ImVec2 at, const std::string& label, Beside beside);

/// The bar between two pictures, `at` 0 to 1, with what they are.
void draw_split_bar(const Stage& stage, float at, const std::string& left,
                    const std::string& right);

}  // namespace raio::view
