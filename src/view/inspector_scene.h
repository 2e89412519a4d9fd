// The inspected rays, drawn at their positions in space over the window's picture.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/inspection.h"
#include "view/projection.h"

namespace raio::core::view {

ImU32 color_of(RayKind kind, float alpha = 1);
/// In English: "eye ray".
const char* name_of(RayKind kind);

/// A line from `from` to `to`.
struct DrawnRay {
  Vec3d from, to;
  RayKind kind = RayKind::eye;
  float alpha = 1;
  bool chosen = false;
  std::string label{};     // at its end; empty: none
  bool is_sample = false;  // for a light: its end is marked
};

struct DrawnBox {
  Box3f box;
  float alpha = 1;
};

class RayScene {
 public:
  /// `accel` determines which parts are hidden; null: none. Kept alive by `owner`.
  void set(std::vector<DrawnRay> rays, std::shared_ptr<const BakedScene> hides);
  std::vector<DrawnBox> boxes;
  std::vector<Vec3d> points;             // along a ray
  std::optional<app::SideView> objects;  // the inspected camera and the lights

  void draw(const Rect& area, const Camera& camera, const Stage& stage);

 private:
  void find_hidden(const Camera& camera);
  void draw_ray(ImDrawList& draw, const Projection& projection, size_t i) const;

  std::vector<DrawnRay> rays_;
  std::shared_ptr<const BakedScene> hides_;
  size_t pieces_ = 1;  // of each ray; each piece is visible or hidden
  std::vector<uint8_t> hidden_;
  Camera seen_from_;
  bool is_known_ = false;
};

/// The kinds of rays with their colours, at the upper left of the picture.
void draw_ray_legend(const Rect& area, bool has_boxes);

}  // namespace raio::core::view
