// Colours as text: names, #rrggbb, r,g,b, transparent.
#pragma once

#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "base/vec.h"
#include "scene/cube_map.h"

namespace raio::core {

/// A colour parsed from text.
struct WrittenColor {
  Rgb color;
  bool transparent = false;  // the colour is then black
  /// Whether these are display values, as for names and #rrggbb; linear_from_srgb() converts
  /// them to light. Three numbers are taken as they are, 1 being white.
  bool encoded = false;
  /// For a background: a sky instead of the colour, named by its folder. parse_color() sets none.
  std::shared_ptr<const CubeMap> sky = {};  // NOLINT(readability-redundant-member-init)
  /// For a background that also lights the scene: "sky", or the path of an environment.
  std::string environment = {};  // NOLINT(readability-redundant-member-init)

  friend bool operator==(const WrittenColor&, const WrittenColor&) = default;
};

/// The colours that a text may have.
struct ColorLimits {
  bool transparent = true;
  double brightest = 1e6;  // of three numbers
};

/// Parses "white", "#ff8800", "#f80", "0.1,0.2,0.4" or "transparent". The names are the sixteen of
/// HTML 4 and a few more, in any case. The error is one line: what was expected and what was found.
std::expected<WrittenColor, std::string> parse_color(std::string_view text,
                                                     const ColorLimits& limits = {});

}  // namespace raio::core
