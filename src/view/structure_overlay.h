// The boxes of the structure over the picture: the cells of a grid, or nodes and leaves of a tree.
#pragma once

#include <memory>
#include <vector>

#include "render/session.h"
#include "view/legend.h"
#include "view/stage.h"
#include "view/state.h"

namespace raio::core::view {

/// The boxes that can be drawn.
struct BoxFacts {
  size_t drawn = 0, all = 0;
  int levels = 0;   // in a tree, that of its deepest leaf; 0: a grid
  size_t most = 1;  // maximum number of primitives in a box at the displayed level
};

/// If there are more, only the largest are drawn.
inline constexpr size_t kMaxBoxes = 3000;

class StructureOverlay {
 public:
  /// Selects the boxes to draw, until the style or the structure changes.
  void choose(const BoxLook& look, std::shared_ptr<const BakedScene> baked);
  /// Draws nothing if the state hides them.
  void draw(const Rect& area, const ViewState& state, std::shared_ptr<const BakedScene> baked,
            const Stage& stage);
  const BoxFacts& facts() const { return facts_; }
  Legend legend() const;

 private:
  Rgb color_of(const AccelBox& box) const;

  BoxLook look_;
  std::shared_ptr<const BakedScene> baked_;  // owner of these boxes
  std::vector<AccelBox> boxes_;
  BoxFacts facts_;
};

}  // namespace raio::core::view
