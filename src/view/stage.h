// The display of pictures: textures on the graphics card, and the rectangle of the window for them.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <vector>

#include "io/image/image.h"
#include "view/layout.h"

namespace raio::core::view {

/// A picture on the graphics card, with the bytes that `raio render` would write.
class Texture {
 public:
  Texture() = default;
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  void set(const Image& image);
  bool empty() const { return width_ == 0; }
  ImTextureID id() const {
    return reinterpret_cast<ImTextureID>(uintptr_t(name_));  // NOLINT(performance-no-int-to-ptr)
  }
  /// Of the bytes, for comparing pictures in tests.
  uint64_t checksum() const;

  /// Draws the part of the picture between `left` and `right` (0 to 1); `sharp`: pixel by pixel,
  /// without smoothing.
  void draw(ImVec2 lo, ImVec2 hi, float left, float right, float alpha, bool sharp) const;
  /// Draws all of it in the current control, smoothed, with round corners at the top.
  void draw_round(ImVec2 lo, ImVec2 hi, float radius) const;

 private:
  void bind(bool sharp) const;

  unsigned name_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<uint8_t> bytes_;
};

/// The picture's area of the window, and the picture in it, in window coordinates.
struct Stage {
  Rect area{0, 0, 1, 1};
  ImVec2 lo{0, 0}, hi{1, 1};                  // of the picture
  int picture_width = 1, picture_height = 1;  // pixels
  bool sharp = true;  // each pixel of the picture is one of the screen, or a square of them

  /// A picture that fills the area; one of a given size (not 0x0) is shown whole, in the middle, at
  /// most one of its pixels for each of the screen's, or if it `grows`, squares of them.
  Stage(const Rect& area, float pixels_per_unit, int width, int height, bool grows = false);
  Stage() = default;

  bool contains(double x, double y) const { return area.contains(x, y); }
  /// Position in the picture, 0 to 1.
  double across(double x) const { return (x - lo.x) / (hi.x - lo.x); }
  double down(double y) const { return (y - lo.y) / (hi.y - lo.y); }
  double aspect() const { return double(picture_width) / picture_height; }
};

}  // namespace raio::core::view
