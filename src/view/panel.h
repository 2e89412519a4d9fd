// The panel beside the picture: effects, figures, the scene, all options.
#pragma once

#include <string>
#include <vector>

#include "io/diagnostics.h"
#include "view/costs_panel.h"
#include "view/layout.h"
#include "view/state.h"
#include "view/structure_overlay.h"
#include "view/theme.h"

namespace raio::view {

/// What the panel tells besides the state.
struct PanelFacts {
  CostFacts costs;
  Diagnostics errors;                 // of the file on the disk, when it is not that of the scene
  std::vector<std::string> warnings;  // of the scene, one line each
  Theme look;
  BoxFacts boxes;
};

/// What was done to it.
struct PanelResult {
  std::vector<const KeySpec*> pressed;  // as if by their keys
  bool changed = false;                 // the state's options or camera
  bool dragging = false;                // they still change
  bool wants_costs = false;             // they are in view
  bool saves_curve = false;
  std::string problem;  // with what was typed
};

/// Draws it there, and changes the state as it is told. Its rows keep their places, whatever they
/// say.
PanelResult draw_panel(ViewState& state, const PanelFacts& facts, const Rect& where);

}  // namespace raio::view
