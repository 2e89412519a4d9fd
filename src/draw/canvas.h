// A page for plots and annotations: Cairo with a few strokes, colours, and output formats.
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "io/image/image.h"

struct _cairo;  // cairo_t; NOLINT(bugprone-reserved-identifier)

namespace raio::core {

inline constexpr double kPageWidth = 1600, kPageHeight = 1000;
inline constexpr double kText = 19;  // size of most text
inline constexpr double kMarkerRadius = 10;

struct Ink {
  int r, g, b;  // 0..255
};

// Okabe and Ito's palette, with colours that remain distinct to colour-blind eyes; the two blues
// also differ in lightness, so that a grey print works.
inline constexpr Ink kBlack{26, 26, 31}, kGrey{107, 107, 115}, kFaint{224, 224, 230};
inline constexpr Ink kSkyBlue{86, 180, 233}, kBlue{0, 114, 178}, kVermilion{213, 94, 0};
inline constexpr Ink kGreen{0, 158, 115}, kPurple{204, 121, 167};
inline constexpr Ink kWhite{255, 255, 255};

enum class Align { left, center, right };

class Canvas {
 public:
  explicit Canvas(_cairo* cairo);

  double text_width(const std::string& text, double size, bool bold = false) const;

  /// `y` is the middle of the small letters. Text wider than `max_width` is set smaller.
  void text(double x, double y, const std::string& text, Ink ink, Align align = Align::left,
            double size = kText, bool bold = false, double max_width = kPageWidth) const;
  /// The same, with a rim in another ink for contrast with the background.
  void rimmed_text(double x, double y, const std::string& text, Ink ink, Ink rim, Align align,
                   double size, double max_width) const;
  void upright_text(double x, double y, const std::string& words, Ink ink) const;

  void box(double x, double y, double w, double h, Ink ink) const;
  void line(double x0, double y0, double x1, double y1, Ink ink, double width,
            bool dotted = false) const;
  /// Draws the displayed pixels in a box of that size.
  void image(double x, double y, double w, double h, const Image& image) const;
  /// Clips the drawing of `draw` to this box.
  void clipped(double x, double y, double w, double h, const std::function<void()>& draw) const;
  void disc(double x, double y, double radius, Ink ink) const;
  /// With a white rim for contrast with a bar below.
  void diamond(double x, double y, Ink ink, double radius = kMarkerRadius) const;

 private:
  void set(Ink ink) const;
  void set_font(double size, bool bold) const;
  // Sets the font and moves to the start of the text.
  void begin_text(double x, double y, const std::string& text, Align align, double size, bool bold,
                  double max_width) const;

  _cairo* cairo_;
};

/// Cairo refuses text that is not UTF-8, but a file name may be any bytes.
std::string valid_utf8(const std::string& text);

enum class PlotFormat { png, svg, pdf };

/// By suffix, in any case; the error lists the suffixes.
std::expected<PlotFormat, std::string> plot_format(const std::filesystem::path& path);

/// Whether drawing is possible. The error is one line.
std::expected<void, std::string> check_drawing();

/// A rectangle of pixels in a page.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The result of `draw` on that part of a transparent page, row by row from the top, premultiplied,
/// as 0xaarrggbb. The error is one line.
std::expected<std::vector<uint32_t>, std::string> draw_pixels(
    const std::function<void(const Canvas&)>& draw, const PixelBox& box);

/// The bytes of a file with the result of `draw` on a white page of this many pixels, or the same
/// in vectors. The error is one line.
std::expected<std::string, std::string> draw_page(PlotFormat format,
                                                  const std::function<void(const Canvas&)>& draw,
                                                  double width = kPageWidth,
                                                  double height = kPageHeight);

}  // namespace raio::core
