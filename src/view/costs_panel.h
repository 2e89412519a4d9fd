// Sections of the panel with figures: statistics of the picture, the cost of each effect, the table
// of combinations.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "render/session.h"
#include "view/measure.h"

namespace raio::core::view {

/// The contents of these sections.
struct CostFacts {
  std::shared_ptr<const SessionPicture> picture;  // may be null
  int picture_width = 0, picture_height = 0;      // pixels
  EffectCosts costs;
  std::optional<BenchmarkTable> table;
  GridCurve curve;
  bool is_curve_old = false;  // of another picture
  Measuring::Work measuring = Measuring::Work::none;
  MeasuringProgress progress;
  bool are_old = false;              // the costs belong to the picture before the last change
  std::optional<std::string> waits;  // waiting for a slow picture's first sample
};

/// "34 %, 12 s left".
std::string text_of_progress(const MeasuringProgress& progress);

/// "first sample: 34 %, 12 s left".
std::string progress_line(const SessionProgress& progress);

/// "soft shadows: 1.83 x ±2%; 51.1 ms, without 28.0 ms; rays 1.75 x, tests 1.9 x, steps 1.6 x".
std::string cost_line(const EffectCost& cost);

void draw_statistics(const CostFacts& facts);
/// `of`: which costs, as chosen there.
void draw_costs(const CostFacts& facts, CostOf& of);
/// Returns whether its button, equivalent to the key, was pressed.
bool draw_table(const CostFacts& facts);

}  // namespace raio::core::view
