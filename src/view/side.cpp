#include "view/side.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "render/picture.h"

namespace raio::core::view {

bool Side::has_picture() const {
  return picture && picture->request >= first_request && !texture.empty();
}

void Side::show(const Image& image, const RenderSettings& settings, const Overlay& overlay) {
  const bool is_plain = settings.tone == Tone::none && settings.exposure == Exposure();
  if (is_plain && !overlay) return texture.set(image);
  Picture shown{image, {}, {}};
  tone_map(shown.color, {}, settings.tone, settings.exposure);
  if (overlay) (void)overlay(shown, false);  // without Cairo's font there are none
  texture.set(shown.color);
}

bool Side::take(const ViewState& view) {
  auto newest = session->picture();
  if (!newest || newest == picture) return false;
  picture = std::move(newest);
  // Previews are too coarse for annotations.
  const bool is_whole = picture->image && picture->image->width == picture->settings.width &&
                        picture->baked && picture->baked->scene == view.scene;
  if (picture->image)
    show(*picture->image, picture->settings,
         is_whole ? view.overlay(picture->settings) : Overlay());
  is_logged = false;
  return true;
}

void Side::draw(const Stage& stage, float left, float right, float alpha) const {
  const bool sharp =
      stage.sharp && picture && picture->image && picture->image->width == stage.picture_width;
  texture.draw(stage.lo, stage.hi, left, right, alpha, sharp);
}

std::optional<std::string> Side::news() {
  if (std::exchange(is_logged, true) || !picture->image) return std::nullopt;
  return fmt::format("{}x{} samples {} request {} sum {:016x}", picture->image->width,
                     picture->image->height, picture->samples, picture->request,
                     texture.checksum());
}

void draw_label(ImVec2 at, const std::string& label, Beside beside) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(label.c_str());
  const float pad = ImGui::GetFontSize() / 4;
  if (beside == Beside::left) at.x -= size.x;
  draw.AddRectFilled({at.x - pad, at.y - pad}, {at.x + size.x + pad, at.y + size.y + pad},
                     IM_COL32(0, 0, 0, 150));
  draw.AddText(at, IM_COL32_WHITE, label.c_str());
}

void draw_split_bar(const Stage& stage, float at, const std::string& left,
                    const std::string& right) {
  const float x = std::round(stage.lo.x + at * (stage.hi.x - stage.lo.x));
  ImGui::GetBackgroundDrawList()->AddLine({x, stage.lo.y}, {x, stage.hi.y},
                                          IM_COL32(255, 255, 255, 220), 2);
  const float margin = ImGui::GetFontSize() / 2;
  draw_label({x - margin, stage.lo.y + margin}, left, Beside::left);
  draw_label({x + margin, stage.lo.y + margin}, right, Beside::right);
}

}  // namespace raio::core::view
