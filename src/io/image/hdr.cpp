// Radiance HDR: lines of text, then pixels of three mantissas and a common exponent (RGBE), flat or
// run-length coded.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/spelling.h"
#include "io/image/codecs.h"

namespace raio::core {
namespace {

constexpr size_t kLongestShown = 40;  // of what an error repeats
constexpr std::string_view kRgbeFormat = "32-bit_rle_rgbe", kHdrEndsEarly = "the file ends early";

/// The next line, without its end; nothing if it does not end.
std::optional<std::string_view> take_hdr_line(std::string_view& bytes) {
  const size_t end = bytes.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = bytes.substr(0, end);
  bytes.remove_prefix(end + 1);
  return line;
}

template <class T>
std::optional<T> hdr_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::unexpected<std::string> expected_text(std::string_view what, std::string_view found) {
  std::string shown = cut_text(found, kLongestShown);
  std::ranges::replace_if(shown, [](char c) { return c < ' ' || c > '~'; }, '?');
  return std::unexpected(fmt::format("expected {}, found \"{}\"", what, shown));
}

/// Reads the lines up to the empty one: by what the pixels must be divided.
Decoded<double> read_hdr_header(std::string_view& bytes) {
  double exposure = 1;
  bool has_format = false;
  take_hdr_line(bytes);  // the name of the program
  for (;;) {
    const auto line = take_hdr_line(bytes);
    if (!line) return std::unexpected("the file ends before the size");
    const std::string_view text = trimmed(*line);
    if (text.empty()) break;
    const size_t equals = std::min(text.find('='), text.size());
    const std::string_view name = trimmed(text.substr(0, equals));
    const std::string_view value = trimmed(text.substr(std::min(equals + 1, text.size())));
    if (name == "FORMAT") {
      if (value != kRgbeFormat) return expected_text(fmt::format("FORMAT={}", kRgbeFormat), text);
      has_format = true;
    } else if (name == "EXPOSURE") {  // those of several lines multiply
      exposure *= hdr_number<double>(value).value_or(0);
      if (!(exposure > 0) || !std::isfinite(exposure))
        return expected_text("a positive EXPOSURE", text);
    } else if (name == "COLORCORR") {
      return std::unexpected("COLORCORR is not supported; remove the correction of its colours");
    }
  }
  if (!has_format) return std::unexpected(fmt::format("expected a line FORMAT={}", kRgbeFormat));
  return exposure;
}

/// Reads "-Y HEIGHT +X WIDTH": rows from top to bottom, pixels from left to right.
Decoded<Image> image_of_size(std::string_view& bytes) {
  const auto line = take_hdr_line(bytes);
  if (!line) return std::unexpected("the file ends before the size");
  constexpr std::string_view kExpected = "the size as -Y HEIGHT +X WIDTH";
  const std::string_view text = trimmed(*line);
  const size_t across = text.find(" +X ");
  if (!text.starts_with("-Y ") || across == std::string_view::npos || across < 3)
    return expected_text(kExpected, text);
  const auto height = hdr_number<int>(text.substr(3, across - 3)),
             width = hdr_number<int>(text.substr(across + 4));
  if (!width || !height) return expected_text(kExpected, text);
  if (std::string problem = size_problem(*width, *height); !problem.empty())
    return std::unexpected(std::move(problem));
  // Runs of one value have at most 127 bytes.
  const size_t flat = size_t(*width) * 4, least = 4 + 8 * ((size_t(*width) + 126) / 127);
  if (bytes.size() / size_t(*height) < std::min(flat, least))
    return std::unexpected(
        fmt::format("{} bytes are too short for {} x {} pixels", bytes.size(), *width, *height));
  return Image(*width, *height);
}

using RgbeRow = std::vector<std::array<uint8_t, 4>>;

/// Reads a row whose four components are stored one after the other, in runs. Returns the error, or
/// nothing.
std::string take_runs(std::string_view& bytes, RgbeRow& row) {
  for (size_t component = 0; component < 4; ++component)
    for (size_t x = 0; x < row.size();) {
      if (bytes.empty()) return std::string(kHdrEndsEarly);
      const auto code = uint8_t(bytes[0]);
      const bool is_run = code > 128;
      const size_t count = is_run ? code - 128 : code, stored = is_run ? 1 : count;
      if (count == 0 || count > row.size() - x)
        return fmt::format("{} pixels at column {} of a row of {}", count, x, row.size());
      if (bytes.size() <= stored) return std::string(kHdrEndsEarly);
      for (size_t i = 0; i < count; ++i) row[x++][component] = uint8_t(bytes[1 + (is_run ? 0 : i)]);
      bytes.remove_prefix(1 + stored);
    }
  return {};
}

/// Returns the error, or nothing.
std::string take_row(std::string_view& bytes, RgbeRow& row) {
  if (bytes.size() < 4) return std::string(kHdrEndsEarly);
  const auto byte = [&](size_t i) { return size_t(uint8_t(bytes[i])); };
  // Other programs write no runs for other widths, and no run begins as a bright pixel.
  if (row.size() >= 8 && row.size() < 32768 && byte(0) == 2 && byte(1) == 2 && byte(2) < 128) {
    if (const size_t width = byte(2) << 8 | byte(3); width != row.size())
      return fmt::format("a row of {} pixels in a picture of {}", width, row.size());
    bytes.remove_prefix(4);
    return take_runs(bytes, row);
  }
  if (bytes.size() < 4 * row.size()) return std::string(kHdrEndsEarly);
  for (auto& pixel : row) {
    for (size_t i = 0; i < 4; ++i) pixel[i] = uint8_t(bytes[i]);
    if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1)
      return "run-length coding of whole pixels, which old programs wrote, is not supported";
    bytes.remove_prefix(4);
  }
  return {};
}

Decoded<Image> decode_rgbe(std::string_view bytes) {
  const auto exposure = read_hdr_header(bytes);
  if (!exposure) return std::unexpected(exposure.error());
  auto image = image_of_size(bytes);
  if (!image) return image;
  RgbeRow row(size_t(image->width));
  for (int y = 0; y < image->height; ++y) {
    if (std::string wrong = take_row(bytes, row); !wrong.empty())
      return std::unexpected(fmt::format("row {}: {}", y, wrong));
    for (int x = 0; x < image->width; ++x) {
      const auto& [r, g, b, exponent] = row[size_t(x)];
      // The lower end of the interval that a mantissa stands for, as most programs have it: black
      // remains black, and white 1.
      const double unit = exponent == 0 ? 0 : std::ldexp(1 / *exposure, int(exponent) - 136);
      image->at(x, y) = Rgb(float(r * unit), float(g * unit), float(b * unit));
    }
  }
  return image;
}

}  // namespace

Decoded<Image> decode_hdr(std::string_view bytes) {
  auto image = decode_rgbe(bytes);
  if (!image) return std::unexpected(fmt::format("broken HDR: {}", image.error()));
  return image;
}

}  // namespace raio::core
