// The panel beside the picture: effects, keys, statistics, costs, all options.
#pragma once

#include <string>
#include <vector>

#include "io/diagnostics.h"
#include "view/costs_panel.h"
#include "view/state.h"

namespace raio::view {

/// What the panel tells besides the state.
struct PanelFacts {
  CostFacts costs;
  Diagnostics errors;  // of the file on the disk, when it is not that of the scene
};

/// What was done to it.
struct PanelResult {
  std::vector<const KeySpec*> pressed;  // as if by their keys
  bool changed = false;                 // the state's options or camera
  bool dragging = false;                // they still change
  bool wants_costs = false;             // they are in view
  std::string problem;                  // with what was typed
};

/// Draws it at the window's right side, `width` wide, and changes the state as it is told.
PanelResult draw_panel(ViewState& state, const PanelFacts& facts, float width);

}  // namespace raio::view
