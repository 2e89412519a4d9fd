#include "draw/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "base/lazy_library.h"
#include "io/file.h"

namespace raio::core {

namespace {

// Only drawing a plot loads it, with its fifteen dependencies.
constexpr char kCairo[] = "libcairo.so.2";

cairo_status_t write_to(void* bytes, const unsigned char* data, unsigned int size) {
  try {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  } catch (const std::bad_alloc&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

cairo_surface_t* make_surface(PlotFormat format, double width, double height, std::string& bytes) {
  switch (format) {
    case PlotFormat::png:
      return call<kCairo, cairo_image_surface_create>(CAIRO_FORMAT_RGB24, int(width), int(height));
    case PlotFormat::svg: {
      auto* surface =
          call<kCairo, cairo_svg_surface_create_for_stream>(write_to, &bytes, width, height);
      call<kCairo, cairo_svg_surface_set_document_unit>(surface, CAIRO_SVG_UNIT_PX);
      return surface;
    }
    case PlotFormat::pdf:
      return call<kCairo, cairo_pdf_surface_create_for_stream>(write_to, &bytes, width, height);
  }
  return nullptr;
}

}  // namespace

Canvas::Canvas(cairo_t* cairo) : cairo_(cairo) {
  // Unhinted widths scale continuously with the size, in pictures as in vector formats.
  const std::unique_ptr<cairo_font_options_t, void (*)(cairo_font_options_t*)> options(
      call<kCairo, cairo_font_options_create>(),
      [](auto* o) { call<kCairo, cairo_font_options_destroy>(o); });
  call<kCairo, cairo_font_options_set_hint_metrics>(options.get(), CAIRO_HINT_METRICS_OFF);
  call<kCairo, cairo_font_options_set_hint_style>(options.get(), CAIRO_HINT_STYLE_NONE);
  call<kCairo, cairo_set_font_options>(cairo_, options.get());
}

double Canvas::text_width(const std::string& text, double size, bool bold) const {
  set_font(size, bold);
  cairo_text_extents_t extents;
  call<kCairo, cairo_text_extents>(cairo_, text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(double x, double y, const std::string& text, Ink ink, Align align, double size,
                  bool bold, double max_width) const {
  begin_text(x, y, text, align, size, bold, max_width);
  set(ink);
  call<kCairo, cairo_show_text>(cairo_, text.c_str());
}

void Canvas::rimmed_text(double x, double y, const std::string& text, Ink ink, Ink rim, Align align,
                         double size, double max_width) const {
  begin_text(x, y, text, align, size, false, max_width);
  call<kCairo, cairo_text_path>(cairo_, text.c_str());
  set(rim);
  call<kCairo, cairo_set_line_width>(cairo_, 0.24 * size);
  call<kCairo, cairo_set_line_join>(cairo_, CAIRO_LINE_JOIN_ROUND);
  call<kCairo, cairo_stroke_preserve>(cairo_);
  set(ink);
  call<kCairo, cairo_fill>(cairo_);
}

void Canvas::begin_text(double x, double y, const std::string& text, Align align, double size,
                        bool bold, double max_width) const {
  const double width = text_width(text, size, bold);
  if (width > max_width) size *= max_width / width;
  const double shown = std::min(width, max_width);
  const double shift = align == Align::left ? 0 : align == Align::center ? shown / 2 : shown;
  set_font(size, bold);
  call<kCairo, cairo_move_to>(cairo_, x - shift, y + 0.36 * size);
}

void Canvas::upright_text(double x, double y, const std::string& words, Ink ink) const {
  call<kCairo, cairo_save>(cairo_);
  call<kCairo, cairo_translate>(cairo_, x, y);
  call<kCairo, cairo_rotate>(cairo_, -std::numbers::pi / 2);
  text(0, 0, words, ink, Align::center, 24, true);
  call<kCairo, cairo_restore>(cairo_);
}

void Canvas::box(double x, double y, double w, double h, Ink ink) const {
  set(ink);
  call<kCairo, cairo_rectangle>(cairo_, x, y, w, h);
  call<kCairo, cairo_fill>(cairo_);
}

void Canvas::line(double x0, double y0, double x1, double y1, Ink ink, double width,
                  bool dotted) const {
  set(ink);
  call<kCairo, cairo_set_line_width>(cairo_, width);
  const double dash[] = {1, 6};
  call<kCairo, cairo_set_line_cap>(cairo_, dotted ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  call<kCairo, cairo_set_dash>(cairo_, dash, dotted ? 2 : 0, 0);
  call<kCairo, cairo_move_to>(cairo_, x0, y0);
  call<kCairo, cairo_line_to>(cairo_, x1, y1);
  call<kCairo, cairo_stroke>(cairo_);
}

void Canvas::image(double x, double y, double w, double h, const Image& image) const {
  std::vector<uint32_t> pixels;
  pixels.reserve(image.pixels.size());
  for (const Rgb& p : image.pixels)
    pixels.push_back(uint32_t(to_byte(p.x)) << 16 | uint32_t(to_byte(p.y)) << 8 | to_byte(p.z));
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      call<kCairo, cairo_image_surface_create_for_data>(
          reinterpret_cast<unsigned char*>(pixels.data()), CAIRO_FORMAT_RGB24, image.width,
          image.height, 4 * image.width),
      [](auto* s) { call<kCairo, cairo_surface_destroy>(s); });
  call<kCairo, cairo_save>(cairo_);
  call<kCairo, cairo_translate>(cairo_, x, y);
  call<kCairo, cairo_scale>(cairo_, w / image.width, h / image.height);
  call<kCairo, cairo_set_source_surface>(cairo_, surface.get(), 0.0, 0.0);
  call<kCairo, cairo_paint>(cairo_);
  call<kCairo, cairo_restore>(cairo_);
  call<kCairo, cairo_surface_finish>(surface.get());
}

void Canvas::clipped(double x, double y, double w, double h,
                     const std::function<void()>& draw) const {
  call<kCairo, cairo_save>(cairo_);
  call<kCairo, cairo_rectangle>(cairo_, x, y, w, h);
  call<kCairo, cairo_clip>(cairo_);
  draw();
  call<kCairo, cairo_restore>(cairo_);
}

void Canvas::disc(double x, double y, double radius, Ink ink) const {
  set(ink);
  call<kCairo, cairo_new_sub_path>(cairo_);
  call<kCairo, cairo_arc>(cairo_, x, y, radius, 0, 2 * std::numbers::pi);
  call<kCairo, cairo_fill>(cairo_);
}

void Canvas::diamond(double x, double y, Ink ink, double radius) const {
  for (const auto& [r, fill] : {std::pair(1.3 * radius, kWhite), std::pair(radius, ink)}) {
    set(fill);
    call<kCairo, cairo_move_to>(cairo_, x - r, y);
    call<kCairo, cairo_line_to>(cairo_, x, y - r);
    call<kCairo, cairo_line_to>(cairo_, x + r, y);
    call<kCairo, cairo_line_to>(cairo_, x, y + r);
    call<kCairo, cairo_close_path>(cairo_);
    call<kCairo, cairo_fill>(cairo_);
  }
}

void Canvas::set(Ink ink) const {
  call<kCairo, cairo_set_source_rgb>(cairo_, ink.r / 255.0, ink.g / 255.0, ink.b / 255.0);
}

void Canvas::set_font(double size, bool bold) const {
  call<kCairo, cairo_select_font_face>(cairo_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                                       bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  call<kCairo, cairo_set_font_size>(cairo_, size);
}

std::string valid_utf8(const std::string& text) {
  using nlohmann::json;
  const auto replace = json::error_handler_t::replace;
  return json::parse(json(text).dump(-1, ' ', false, replace)).get<std::string>();
}

std::expected<PlotFormat, std::string> plot_format(const std::filesystem::path& path) {
  const std::string suffix = lower_suffix(path);
  if (suffix == ".png") return PlotFormat::png;
  if (suffix == ".svg") return PlotFormat::svg;
  if (suffix == ".pdf") return PlotFormat::pdf;
  return std::unexpected(
      fmt::format("{}: expected a plot file that ends in .png, .svg or .pdf", path.string()));
}

std::expected<void, std::string> check_drawing() { return load_library(kCairo); }

std::expected<std::vector<uint32_t>, std::string> draw_pixels(
    const std::function<void(const Canvas&)>& draw, const PixelBox& box) {
  if (auto loaded = load_library(kCairo); !loaded) return std::unexpected(loaded.error());
  std::vector<uint32_t> pixels(size_t(box.width) * size_t(box.height));
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      call<kCairo, cairo_image_surface_create_for_data>(
          reinterpret_cast<unsigned char*>(pixels.data()), CAIRO_FORMAT_ARGB32, box.width,
          box.height, 4 * box.width),
      [](auto* s) { call<kCairo, cairo_surface_destroy>(s); });
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(
      call<kCairo, cairo_create>(surface.get()), [](auto* c) { call<kCairo, cairo_destroy>(c); });
  call<kCairo, cairo_translate>(cairo.get(), double(-box.x), double(-box.y));
  draw(Canvas(cairo.get()));
  const cairo_status_t status = call<kCairo, cairo_status>(cairo.get());
  call<kCairo, cairo_surface_finish>(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) return pixels;
  return std::unexpected(
      fmt::format("cannot draw: {}", call<kCairo, cairo_status_to_string>(status)));
}

std::expected<std::string, std::string> draw_page(PlotFormat format,
                                                  const std::function<void(const Canvas&)>& draw,
                                                  double width, double height) {
  if (auto loaded = load_library(kCairo); !loaded) return std::unexpected(loaded.error());
  std::string bytes;  // outlives the surface, which may write to it until it is finished
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      make_surface(format, width, height, bytes),
      [](auto* s) { call<kCairo, cairo_surface_destroy>(s); });
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(
      call<kCairo, cairo_create>(surface.get()), [](auto* c) { call<kCairo, cairo_destroy>(c); });
  const Canvas canvas(cairo.get());
  canvas.box(0, 0, width, height, kWhite);
  draw(canvas);
  cairo_status_t status = call<kCairo, cairo_status>(cairo.get());
  if (status == CAIRO_STATUS_SUCCESS && format == PlotFormat::png)
    status = call<kCairo, cairo_surface_write_to_png_stream>(surface.get(), write_to, &bytes);
  call<kCairo, cairo_surface_finish>(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) status = call<kCairo, cairo_surface_status>(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) return bytes;
  return std::unexpected(
      fmt::format("cannot draw the plot: {}", call<kCairo, cairo_status_to_string>(status)));
}

}  // namespace raio::core
