// The parts of the panel with figures: statistics of the picture, what each effect costs, the table
// of combinations.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/session.h"
#include "view/measure.h"

namespace raio::view {

/// What these parts show.
struct CostFacts {
  std::shared_ptr<const SessionPicture> picture;  // may be null
  int picture_width = 0, picture_height = 0;      // pixels
  std::vector<EffectCost> costs;
  std::optional<BenchmarkTable> table;
  Measuring::Work measuring = Measuring::Work::none;
};

void draw_statistics(const CostFacts& facts);
void draw_costs(const CostFacts& facts);
/// Whether its button, which does what the key does, was pressed.
bool draw_table(const CostFacts& facts);

}  // namespace raio::view
