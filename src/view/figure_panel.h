// The panel's section of figures: how the file is read, light and lines, annotations, and a picture
// for print.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/read_options.h"
#include "view/state.h"

namespace raio::core::view {

struct FigureFacts {
  ReadOptions read;    // how the file is to be read, now or soon
  bool waits = false;  // for a long time
  int picture_width = 1, picture_height = 1;
  std::optional<double> printed;  // share of the picture for print, while there is one
};

/// A new text for an option; empty: the default.
struct ReadChange {
  const ReadOptionSpec* option;
  std::string text;
};

struct FigureResult {
  std::vector<ReadChange> reads;
  bool prints = false, stops_printing = false, copies_print = false;
};

/// Draws the section, and updates the state; appends to `problem` why it could not. Returns whether
/// the picture's options changed.
bool draw_figure(ViewState& state, const FigureFacts& facts, FigureResult& result,
                 std::string& problem);

}  // namespace raio::core::view
