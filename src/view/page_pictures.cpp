#include "view/page_pictures.h"

#include <librsvg/rsvg.h>

#include <cmath>
#include <memory>

#include "base/lazy_library.h"
#include "view/panel_parts.h"

namespace raio::core::view {
namespace {

// Only a diagram loads it, with its thirty dependencies, among them the others.
constexpr char kRsvg[] = "librsvg-2.so.2";
constexpr char kCairo[] = "libcairo.so.2", kObjects[] = "libgobject-2.0.so.0";

constexpr double kScale = 2;         // pixels for each of an SVG's own
constexpr double kMaxSide = 8192;    // pixels
constexpr float kUsualShape = 1.5f;  // of a picture that is not loaded yet

std::expected<Image, std::string> read_svg(const std::filesystem::path& file) {
  if (const auto loaded = load_library(kRsvg); !loaded) return std::unexpected(loaded.error());
  const std::unique_ptr<RsvgHandle, void (*)(RsvgHandle*)> svg(
      call<kRsvg, rsvg_handle_new_from_file>(file.c_str(), nullptr),
      [](RsvgHandle* handle) { call<kObjects, g_object_unref>(gpointer(handle)); });
  double width = 0, height = 0;
  if (!svg || !call<kRsvg, rsvg_handle_get_intrinsic_size_in_pixels>(svg.get(), &width, &height) ||
      !(width >= 1 && height >= 1 && width <= kMaxSide && height <= kMaxSide))
    return std::unexpected(file.string() + " is not an SVG with a size in pixels");
  const RsvgRectangle whole{0, 0, std::ceil(kScale * width), std::ceil(kScale * height)};
  Image image(int(whole.width), int(whole.height));
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      call<kCairo, cairo_image_surface_create>(CAIRO_FORMAT_RGB24, image.width, image.height),
      [](cairo_surface_t* s) { call<kCairo, cairo_surface_destroy>(s); });
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(
      call<kCairo, cairo_create>(surface.get()),
      [](cairo_t* c) { call<kCairo, cairo_destroy>(c); });
  call<kCairo, cairo_set_source_rgb>(cairo.get(), 1.0, 1.0, 1.0);
  call<kCairo, cairo_paint>(cairo.get());
  GError** const no_error = nullptr;
  if (!call<kRsvg, rsvg_handle_render_document>(svg.get(), cairo.get(), &whole, no_error))
    return std::unexpected(file.string() + " cannot be drawn");
  call<kCairo, cairo_surface_flush>(surface.get());
  const unsigned char* const bytes = call<kCairo, cairo_image_surface_get_data>(surface.get());
  const int stride = call<kCairo, cairo_image_surface_get_stride>(surface.get());
  for (int y = 0; y < image.height; ++y) {
    const auto* const row =
        reinterpret_cast<const uint32_t*>(bytes + ptrdiff_t(y) * stride);  // cairo aligns it
    for (int x = 0; x < image.width; ++x) {
      const auto part = [&](int shift) { return float(row[x] >> shift & 255) / 255; };
      image.at(x, y) = {part(16), part(8), part(0)};
    }
  }
  return image;
}

}  // namespace

std::expected<Image, std::string> read_page_picture(const std::filesystem::path& file) {
  if (file.extension() == ".svg") return read_svg(file);
  auto image = read_image(file);
  if (!image) return std::unexpected(image.error().text());
  return std::move(*image);
}

const PagePictures::Entry& PagePictures::of(const std::filesystem::path& file) {
  const auto [entry, is_new] = entries_.try_emplace(file);
  Entry& picture = entry->second;
  if (!is_new) return picture;
  if (const auto image = read_page_picture(file)) {
    picture.texture.set(*image);
    picture.width = float(image->width), picture.height = float(image->height);
  }
  return picture;
}

void PagePictures::draw(const std::filesystem::path& file, const std::string& description,
                        float width) {
  const auto known = entries_.find(file);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (known == entries_.end()) {
    const ImVec2 room(width, std::round(width / kUsualShape));
    if (!ImGui::IsRectVisible(room)) return ImGui::Dummy(room);
  }
  const Entry& picture = of(file);
  if (picture.texture.empty()) {
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
    faint_text(description);
    ImGui::PopTextWrapPos();
    return;
  }
  const ImVec2 size(width, std::round(width * picture.height / picture.width));
  ImGui::Dummy(size);
  picture.texture.draw_round(at, {at.x + size.x, at.y + size.y}, 0);
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(30 * em());
  text(description);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace raio::core::view
