#include "view/stage.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

namespace raio::core::view {

Texture::~Texture() {
  if (name_) glDeleteTextures(1, &name_);
}

void Texture::set(const Image& image) {
  if (!name_) {
    glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  // Four bytes per pixel: the native format of graphics cards, so nothing is converted.
  bytes_.resize(image.pixels.size() * 4);
  uint8_t* out = bytes_.data();
  for (const Rgb& c : image.pixels) {
    *out++ = to_byte(c.x), *out++ = to_byte(c.y), *out++ = to_byte(c.z);
    *out++ = 255;
  }
  glBindTexture(GL_TEXTURE_2D, name_);
  if (width_ == image.width && height_ == image.height) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE,
                    bytes_.data());
    return;
  }
  width_ = image.width, height_ = image.height;
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_, height_, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               bytes_.data());
}

uint64_t Texture::checksum() const {
  uint64_t sum = 14695981039346656037u;  // FNV-1a
  for (const uint8_t byte : bytes_) sum = (sum ^ byte) * 1099511628211u;
  return sum;
}

void Texture::bind(bool sharp) const {
  glBindTexture(GL_TEXTURE_2D, name_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, sharp ? GL_NEAREST : GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, sharp ? GL_NEAREST : GL_LINEAR);
}

void Texture::draw_round(ImVec2 lo, ImVec2 hi, float radius) const {
  if (empty()) return;
  bind(false);
  ImGui::GetWindowDrawList()->AddImageRounded(id(), lo, hi, {0, 0}, {1, 1}, 0xffffffff, radius,
                                              ImDrawFlags_RoundCornersTop);
}

void Texture::draw(ImVec2 lo, ImVec2 hi, float left, float right, float alpha, bool sharp) const {
  if (empty()) return;
  bind(sharp);
  const float width = hi.x - lo.x;
  ImGui::GetBackgroundDrawList()->AddImage(id(), {lo.x + width * left, lo.y},
                                           {lo.x + width * right, hi.y}, {left, 0}, {right, 1},
                                           ImGui::ColorConvertFloat4ToU32({1, 1, 1, alpha}));
}

Stage::Stage(const Rect& a, float pixels_per_unit, int width, int height, bool grows) : area(a) {
  const auto pixels = [&](float units) {
    return std::max(1, int(std::lround(units * pixels_per_unit)));
  };
  if (width <= 0) {
    lo = {area.left, area.top}, hi = {area.right, area.bottom};
    picture_width = pixels(area.width()), picture_height = pixels(area.height());
    return;
  }
  picture_width = width, picture_height = height;
  const float fit = std::min(area.width() / float(width), area.height() / float(height));
  const float unit = 1 / pixels_per_unit;
  sharp = fit >= unit * (1 - 1e-3f);
  const float most = std::floor(fit / unit * (1 + 1e-3f));
  const float scale = sharp ? unit * (grows ? most : 1) : fit;
  const ImVec2 size = {float(width) * scale, float(height) * scale};
  lo = {area.left + std::floor((area.width() - size.x) / 2),
        area.top + std::floor((area.height() - size.y) / 2)};
  hi = {lo.x + size.x, lo.y + size.y};
}

}  // namespace raio::core::view
