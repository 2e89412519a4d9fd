// The grid's resolution: a slider, and the curve of its costs.
#pragma once

#include "view/costs_panel.h"
#include "view/state.h"

namespace raio::core::view {

struct GridPanelResult {
  bool changed = false;   // the state's options
  bool measures = false;  // as by the key
  bool saves = false;     // the curve, as CSV
};
GridPanelResult draw_grid(ViewState& state, const CostFacts& facts);

}  // namespace raio::core::view
