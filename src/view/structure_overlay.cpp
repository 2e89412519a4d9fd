#include "view/structure_overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/exact_math.h"
#include "integrate/views.h"
#include "view/projection.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr float kNearest = 0.9f, kFarthest = 0.25f;  // opacity of their lines

float area_of(const AccelBox& b) {
  const Vec3f s = b.box.size();
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

}  // namespace

// Visits all boxes, but only if the structure or the selection changed.
void StructureOverlay::choose(const BoxLook& look, std::shared_ptr<const BakedScene> baked) {
  if (look == look_ && baked == baked_) return;
  const bool is_other = baked != baked_;
  look_ = look, baked_ = std::move(baked);
  boxes_.clear();
  facts_ = {.levels = is_other ? 0 : facts_.levels};
  if (!look.shown || !baked_) return;
  const Accel& accel = *baked_->accel;
  if (is_other || facts_.levels == 0)
    accel.boxes(kLeafBoxes,
                [&](const AccelBox& b) { facts_.levels = std::max(facts_.levels, b.level); });
  const auto keep_largest = [&] {
    if (boxes_.size() <= kMaxBoxes) return;
    std::ranges::nth_element(boxes_, boxes_.begin() + kMaxBoxes, std::ranges::greater(), area_of);
    boxes_.resize(kMaxBoxes);
  };
  accel.boxes(look.level, [&](const AccelBox& b) {
    facts_.most = std::max(facts_.most, b.primitives);
    if (b.primitives < size_t(look.fewest)) return;
    ++facts_.all;
    boxes_.push_back(b);
    if (boxes_.size() == 2 * kMaxBoxes) keep_largest();
  });
  keep_largest();
  facts_.drawn = boxes_.size();
}

// Levels are spread evenly over the scale of counts.
Rgb StructureOverlay::color_of(const AccelBox& box) const {
  if (!look_.by_level) return heat_color(double(box.primitives));
  return heat_color(exact_pow(4.0, 5.0 * box.level / std::max(facts_.levels, 1)));
}

Legend StructureOverlay::legend() const {
  Legend legend{
      look_.by_level ? tr("level of the box") : tr("primitives in the box"), {}, look_.by_level};
  if (look_.by_level) {
    for (int level = 0; level <= facts_.levels; ++level)
      legend.stops.push_back({color_of({.level = level}), fmt::format("{}", level)});
    return legend;
  }
  for (size_t count = 1; count <= 1024; count *= 4)
    legend.stops.push_back({color_of({.primitives = count}), fmt::format("{}", count)});
  legend.stops.back().label += "+";
  return legend;
}

void StructureOverlay::draw(const Rect& area, const ViewState& state,
                            std::shared_ptr<const BakedScene> baked, const Stage& stage) {
  choose(state.boxes, std::move(baked));
  if (boxes_.empty()) return;
  const Projection projection(state.edge_to_edge(stage.picture_width, stage.picture_height), stage);
  const Vec3d from(state.camera.from);
  const auto distance = [&](const AccelBox& b) { return length(Vec3d(b.box.center()) - from); };
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const AccelBox& b : boxes_)
    nearest = std::min(nearest, distance(b)), farthest = std::max(farthest, distance(b));
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect({area.left, area.top}, {area.right, area.bottom}, true);
  draw.AddRectFilled({area.left, area.top}, {area.right, area.bottom},
                     color(palette().ground, 0.6f));
  for (const AccelBox& b : boxes_) {
    const double far = (distance(b) - nearest) / std::max(farthest - nearest, 1e-30);
    const Rgb ink = color_of(b);
    const ImU32 line =
        color({ink.x, ink.y, ink.z, 1}, kNearest + float(far) * (kFarthest - kNearest));
    for_each_edge(b.box, [&](const Vec3f& a, const Vec3f& c) {
      if (const auto s = projection.segment(Vec3d(a), Vec3d(c)))
        draw.AddLine((*s)[0], (*s)[1], line, 1);
    });
  }
  draw.PopClipRect();
}

}  // namespace raio::core::view
