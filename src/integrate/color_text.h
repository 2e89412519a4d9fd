// Colours as people write them: names, #rrggbb, r,g,b, transparent.
#pragma once

#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "base/vec.h"
#include "scene/cube_map.h"

namespace raio {

/// A colour that was written down.
struct WrittenColor {
  Rgb color;
  bool transparent = false;  // nothing there; the colour is black
  /// Display values, as names and #rrggbb give; where light is meant, linear_from_srgb() of
  /// integrate/tone.h makes it. Three numbers are what they are, 1 being white.
  bool encoded = false;
  /// Of a background: a sky in place of the colour, by the name of its folder. parse_color() gives
  /// none.
  std::shared_ptr<const CubeMap> sky = {};  // NOLINT(readability-redundant-member-init)

  friend bool operator==(const WrittenColor&, const WrittenColor&) = default;
};

/// Reads "white", "#ff8800", "#f80", "0.1,0.2,0.4" (numbers from 0 to 1e6) or "transparent". The
/// names are the sixteen of HTML 4 and a few more; case does not matter. The error is one line:
/// what was expected and what was found.
std::expected<WrittenColor, std::string> parse_color(std::string_view text);

}  // namespace raio
