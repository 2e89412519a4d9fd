// The boxes of the structure over the picture: the cells of a grid, or nodes and leaves of a tree.
#pragma once

#include <memory>
#include <vector>

#include "render/session.h"
#include "view/legend.h"
#include "view/stage.h"
#include "view/state.h"

namespace raio::view {

/// What there is to be drawn.
struct BoxFacts {
  size_t drawn = 0, all = 0;
  int levels = 0;   // of a tree, that of its deepest leaf; 0: a grid
  size_t most = 1;  // primitives in a box at the level that is shown
};

/// Where there are more, the largest ones are drawn.
inline constexpr size_t kMaxBoxes = 3000;

class StructureOverlay {
 public:
  /// Those that will be drawn, until the look or the structure is another one.
  void choose(const BoxLook& look, std::shared_ptr<const BakedScene> baked);
  /// Nothing where the state says that they are hidden.
  void draw(const Rect& area, const ViewState& state, std::shared_ptr<const BakedScene> baked,
            const Stage& stage);
  const BoxFacts& facts() const { return facts_; }
  Legend legend() const;

 private:
  Rgb color_of(const AccelBox& box) const;

  BoxLook look_;
  std::shared_ptr<const BakedScene> baked_;  // whose boxes these are
  std::vector<AccelBox> boxes_;
  BoxFacts facts_;
};

}  // namespace raio::view
