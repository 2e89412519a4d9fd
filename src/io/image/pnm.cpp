// PPM, its grey variants, and PFM: a few words of text, then the values.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "io/image/codecs.h"

namespace raio::core {

namespace {

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// The words of a header or of a plain picture, without comments (# to the end of the line).
class PnmWords {
 public:
  explicit PnmWords(std::string_view bytes) : left_(bytes) {}

  std::string_view next() {
    skip_blanks();
    size_t end = 0;
    while (end < left_.size() && !is_blank(left_[end]) && left_[end] != '#') ++end;
    const std::string_view word = left_.substr(0, end);
    left_.remove_prefix(end);
    return word;
  }

  /// The next word as a number. On failure the error names what was expected.
  template <class T>
  Decoded<T> number(std::string_view what) {
    const std::string_view word = next();
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc() && end == word.data() + word.size() && !word.empty()) return value;
    return std::unexpected(
        word.empty() ? fmt::format("the file ends before {}", what)
                     : fmt::format("expected {}, found \"{}\"", what, word.substr(0, 20)));
  }

  /// The data after the one blank that follows the last word: the values of a binary picture.
  std::string_view rest() const { return left_.substr(left_.empty() ? 0 : 1); }

 private:
  void skip_blanks() {
    while (!left_.empty() && (is_blank(left_[0]) || left_[0] == '#')) {
      const bool comment = left_[0] == '#';
      const size_t end = comment ? left_.find_first_of("\r\n") : 1;
      left_.remove_prefix(std::min(end, left_.size()));
    }
  }

  std::string_view left_;
};

struct Size {
  int width = 0, height = 0;
  size_t values(size_t channels) const { return size_t(width) * size_t(height) * channels; }
};

Decoded<Size> read_size(PnmWords& words) {
  const auto width = words.number<int>("the width");
  if (!width) return std::unexpected(width.error());
  const auto height = words.number<int>("the height");
  if (!height) return std::unexpected(height.error());
  if (std::string problem = size_problem(*width, *height); !problem.empty())
    return std::unexpected(std::move(problem));
  return Size{*width, *height};
}

std::unexpected<std::string> too_short(size_t needed, size_t there) {
  return std::unexpected(
      fmt::format("the file ends early: expected {} bytes of pixels, found {}", needed, there));
}

/// Fills an image from `value`, called once per value in the file's order; an error ends it.
template <class Value>
Decoded<Image> fill(const Size& size, bool grey, const Value& value) {
  Image image(size.width, size.height);
  for (Rgb& pixel : image.pixels) {
    for (int channel = 0; channel < (grey ? 1 : 3); ++channel) {
      const Decoded<float> read = value();
      if (!read) return std::unexpected(read.error());
      pixel[channel] = *read;
    }
    if (grey) pixel = Rgb(pixel.x);
  }
  return image;
}

Decoded<Image> decode_plain_ppm(PnmWords& words, const Size& size, bool grey, unsigned max_value) {
  // Every value has a digit and, except for the last, a blank.
  const size_t needed = 2 * size.values(grey ? 1 : 3) - 1;
  if (words.rest().size() < needed) return too_short(needed, words.rest().size());
  return fill(size, grey, [&]() -> Decoded<float> {
    const auto value = words.number<unsigned>("a value");
    if (!value) return std::unexpected(value.error());
    if (*value > max_value)
      return std::unexpected(
          fmt::format("a value of {} exceeds the maximum of {}", *value, max_value));
    return float(*value) / float(max_value);
  });
}

Decoded<Image> decode_binary_ppm(PnmWords& words, const Size& size, bool grey, unsigned max_value) {
  const size_t value_bytes = max_value > 255 ? 2 : 1;
  const size_t needed = size.values(grey ? 1 : 3) * value_bytes;
  const std::string_view raster = words.rest();
  if (raster.size() < needed) return too_short(needed, raster.size());
  const char* p = raster.data();
  return fill(size, grey, [&]() -> Decoded<float> {
    unsigned value = uint8_t(*p++);
    if (value_bytes == 2) value = value << 8 | uint8_t(*p++);
    if (value > max_value)
      return std::unexpected(
          fmt::format("a value of {} exceeds the maximum of {}", value, max_value));
    return float(value) / float(max_value);
  });
}

Decoded<Image> decode_ppm_body(char kind, PnmWords& words) {
  const auto size = read_size(words);
  if (!size) return std::unexpected(size.error());
  const auto max_value = words.number<unsigned>("the largest value");
  if (!max_value) return std::unexpected(max_value.error());
  if (*max_value < 1 || *max_value > 65535)
    return std::unexpected(
        fmt::format("expected a largest value from 1 to 65535, found {}", *max_value));
  const bool grey = kind == '2' || kind == '5', plain = kind == '2' || kind == '3';
  return plain ? decode_plain_ppm(words, *size, grey, *max_value)
               : decode_binary_ppm(words, *size, grey, *max_value);
}

Decoded<Image> decode_pfm_body(bool grey, PnmWords& words) {
  const auto size = read_size(words);
  if (!size) return std::unexpected(size.error());
  const auto scale = words.number<double>("the scale");
  if (!scale) return std::unexpected(scale.error());
  if (!std::isfinite(*scale) || *scale == 0)
    return std::unexpected("expected a non-zero scale; its sign is the byte order");
  const size_t needed = size->values(grey ? 1 : 3) * 4;
  const std::string_view raster = words.rest();
  if (raster.size() < needed) return too_short(needed, raster.size());

  const size_t row_bytes = needed / size_t(size->height);
  const bool little = *scale < 0;
  Image image(size->width, size->height);
  for (int y = 0; y < size->height; ++y) {
    const char* p = raster.data() + size_t(size->height - 1 - y) * row_bytes;
    for (int x = 0; x < size->width; ++x) {
      Rgb& pixel = image.at(x, y);
      for (int channel = 0; channel < (grey ? 1 : 3); ++channel, p += 4) {
        uint32_t bits = 0;
        for (int i = 0; i < 4; ++i) bits |= uint32_t(uint8_t(p[i])) << 8 * (little ? i : 3 - i);
        pixel[channel] = std::bit_cast<float>(bits);
      }
      if (grey) pixel = Rgb(pixel.x);
    }
  }
  return image;
}

}  // namespace

std::string encode_ppm(const Image& image) {
  std::string bytes = fmt::format("P6\n{} {}\n255\n", image.width, image.height);
  size_t at = bytes.size();
  bytes.resize(at + image.pixels.size() * 3);
  for (const Rgb& pixel : image.pixels)
    for (const float value : {pixel.x, pixel.y, pixel.z}) bytes[at++] = char(to_byte(value));
  return bytes;
}

Decoded<Image> decode_ppm(std::string_view bytes) {
  PnmWords words(bytes.substr(2));
  auto image = decode_ppm_body(bytes[1], words);
  if (!image) return std::unexpected(fmt::format("broken PPM: {}", image.error()));
  return image;
}

std::string encode_pfm(const Image& image) {
  std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", image.width, image.height);
  size_t at = bytes.size();
  bytes.resize(at + image.pixels.size() * 12);
  for (int y = image.height; y-- > 0;)
    for (int x = 0; x < image.width; ++x) {
      const Rgb& pixel = image.at(x, y);
      for (const float value : {pixel.x, pixel.y, pixel.z}) {
        const auto bits = std::bit_cast<uint32_t>(value);
        for (int i = 0; i < 4; ++i) bytes[at++] = char(bits >> 8 * i & 0xff);
      }
    }
  return bytes;
}

Decoded<Image> decode_pfm(std::string_view bytes) {
  PnmWords words(bytes.substr(2));
  auto image = decode_pfm_body(bytes[1] == 'f', words);
  if (!image) return std::unexpected(fmt::format("broken PFM: {}", image.error()));
  return image;
}

}  // namespace raio::core
