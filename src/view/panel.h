// The panel at the right of the picture: effects, figures, the scene, all options.
#pragma once

#include <string>
#include <vector>

#include "io/diagnostics.h"
#include "view/compared.h"
#include "view/costs_panel.h"
#include "view/figure_panel.h"
#include "view/layout.h"
#include "view/selection.h"
#include "view/state.h"
#include "view/structure_overlay.h"
#include "view/theme.h"

namespace raio::core::view {

/// The contents of the panel besides the state.
struct PanelFacts {
  CostFacts costs;
  Diagnostics errors;                 // of the file on the disk, if it is newer than the scene
  std::vector<std::string> warnings;  // of the scene, one line each
  Theme look;
  BoxFacts boxes;
  FigureFacts figure;
  const Difference* difference = nullptr;  // from the picture compared with; null: not known yet
  SelectionFacts selection;
};

/// Actions on the selected primitive. Hiding applies to all picked atoms.
enum class SelectionUse {
  nothing,
  focus,
  inspect,
  turn,
  clear,
  hide,
  hide_residue,
  hide_chain,
  color,
  color_residue,
  color_chain
};

/// User input in the panel.
struct PanelResult {
  std::vector<const KeySpec*> pressed;  // as if by their keys
  bool changed = false;                 // the state's options or camera
  bool dragging = false;                // still changing
  bool wants_costs = false;             // they are visible
  bool saves_curve = false;
  FigureResult figure;
  SelectionUse selection = SelectionUse::nothing;
  std::string problem;  // with the user's input
};

/// Draws it there, and updates the state from user input. Its rows keep their positions, whatever
/// their contents.
PanelResult draw_panel(ViewState& state, const PanelFacts& facts, const Rect& where);

}  // namespace raio::core::view
