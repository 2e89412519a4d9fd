// The section of the panel with all options.
#pragma once

#include <string>

#include "view/costs_panel.h"
#include "view/panel.h"
#include "view/state.h"

namespace raio::core::view {

/// What a field shows: the value that was given, else the one in use, also for disabled effects;
/// words where it is no single number. Never empty.
std::string shown_value(const OptionSpec& spec, const ViewState& state, const CostFacts& facts);

void draw_options(ViewState& state, const CostFacts& facts, PanelResult& result);

}  // namespace raio::core::view
