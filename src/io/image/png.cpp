// PNG through libpng. Its errors are jumps (setjmp, longjmp), which must not cross anything with a
// destructor: all calls that can fail are in lambdas under guarded(), with owners of memory
// outside.
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <exception>

#include "base/parallel.h"
#include "io/image/codecs.h"
#include "io/image/deflate.h"

namespace raio::core {

namespace {

struct ErrorText {
  char text[200] = "not enough memory";
};

void fail(png_structp png, png_const_charp text) {
  auto* error = static_cast<ErrorText*>(png_get_error_ptr(png));
  std::snprintf(error->text, sizeof error->text, "%s", text);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

/// Runs `step`; false if libpng gave up, as described by ErrorText. What `step` calls must own
/// nothing.
template <class Step>
bool guarded(png_structp png, const Step& step) {
  if (setjmp(png_jmpbuf(png))) return false;
  step();
  return true;
}

void take_bytes(png_structp png, png_bytep out, size_t count) {
  auto* left = static_cast<std::string_view*>(png_get_io_ptr(png));
  if (left->size() < count) png_error(png, "the file ends early");
  std::memcpy(out, left->data(), count);
  left->remove_prefix(count);
}

void append_bytes(png_structp png, png_bytep bytes, size_t count) {
  bool appended = true;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))
        ->append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::exception&) {
    appended = false;
  }
  if (!appended) png_error(png, "not enough memory");
}

struct Reader {
  ErrorText error;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &error, fail, ignore_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;

  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writer {
  ErrorText error;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, fail, ignore_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;

  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

/// tEXt, or iTXt for values beyond Latin-1. The strings must not move.
png_text text_chunk(std::string& name, std::string& value) {
  const bool ascii = std::ranges::all_of(value, [](unsigned char c) { return c < 128; });
  png_text text{};
  text.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
  text.key = name.data();
  text.text = value.data();
  return text;
}

// Writing: libpng cannot compress with several threads, so it receives compressed pixels.

/// Limits a row to the lengths of zlib and PNG.
constexpr size_t kWidest = size_t(1) << 28;

/// A pixel with straight alpha. An opaque one has the same bytes as without alpha.
png_byte* put_straight(const Rgb& color, float alpha, bool is_straight, png_byte* out) {
  const uint8_t opacity = to_byte(alpha);
  const float covered = is_straight ? 1 : std::min(alpha, 1.0f);
  for (const float value : {color.x, color.y, color.z})
    *out++ = opacity == 0 && !is_straight ? 0 : to_byte(value / covered);
  *out++ = opacity;
  return out;
}

size_t bytes_a_row(const PictureView& picture) {
  return 1 + (picture.alpha.empty() ? 3 : 4) * size_t(picture.color.width);
}

/// Rows in PNG's layout, each after a filter byte.
std::vector<png_byte> filtered_rows(const PictureView& picture, int first, int end) {
  std::vector<png_byte> rows(bytes_a_row(picture) * size_t(end - first));
  png_byte* out = rows.data();
  const auto width = size_t(picture.color.width);
  for (size_t y = size_t(first); y < size_t(end); ++y) {
    *out++ = PNG_FILTER_VALUE_NONE;
    const Rgb* pixel = &picture.color.pixels[y * width];
    if (picture.alpha.empty()) {
      for (size_t x = 0; x < width; ++x, ++pixel) {
        *out++ = to_byte(pixel->x);
        *out++ = to_byte(pixel->y);
        *out++ = to_byte(pixel->z);
      }
    } else {
      const float* alpha = &picture.alpha[y * width];
      for (size_t x = 0; x < width; ++x)
        out = put_straight(pixel[x], alpha[x], picture.is_straight, out);
    }
  }
  return rows;
}

/// The picture as one zlib stream (RFC 1950) in parts. The height of a band depends only on width
/// and channels.
std::vector<std::string> zlib_stream(const PictureView& picture) {
  constexpr size_t kBandBytes = 1 << 16;  // the file is 2 % larger than without bands
  const int rows = picture.color.height;
  const int height = std::max(1, int(kBandBytes / bytes_a_row(picture)));
  Deflated deflated =
      deflate_bands(size_t(rows - 1) / size_t(height) + 1, kAdler32, [&](size_t band) {
        const int first = int(band) * height;
        return filtered_rows(picture, first, std::min(rows - first, height) + first);
      });
  // Deflate with a window of 32 kB, fastest.
  deflated.bands.front().insert(0, "\x78\x01");
  for (const int shift : {24, 16, 8, 0})
    deflated.bands.back() += char(deflated.check_sum >> shift & 255);
  return std::move(deflated.bands);
}

void write_chunk(png_structp png, const char* type, std::string_view bytes) {
  png_write_chunk(png, reinterpret_cast<png_const_bytep>(type),
                  reinterpret_cast<png_const_bytep>(bytes.data()), bytes.size());
}

}  // namespace

Decoded<std::string> encode_png(const PictureView& picture, const Metadata& metadata) {
  const Image& image = picture.color;
  if (size_t(image.width) > kWidest) return std::unexpected("it is too wide for a PNG");
  const int colors = picture.alpha.empty() ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA;
  const std::vector<std::string> bands = zlib_stream(picture);
  std::string bytes;
  Metadata named = metadata;
  std::vector<png_text> texts;
  for (auto& [key, value] : named) {
    key = metadata_name(key);
    texts.push_back(text_chunk(key, value));
  }
  Writer writer;
  if (!writer.png || !writer.info) return std::unexpected(writer.error.text);
  const bool done = guarded(writer.png, [&] {
    png_structp png = writer.png;
    png_set_write_fn(png, &bytes, append_bytes, nullptr);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(png, writer.info, png_uint_32(image.width), png_uint_32(image.height), 8, colors,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (picture.dpi > 0) {
      const auto per_meter = png_uint_32(std::lround(double(picture.dpi) / 0.0254));
      png_set_pHYs(png, writer.info, per_meter, per_meter, PNG_RESOLUTION_METER);
    }
    png_set_text(png, writer.info, texts.data(), int(texts.size()));
    png_write_info(png, writer.info);
    for (const std::string& band : bands) write_chunk(png, "IDAT", band);
    write_chunk(png, "IEND", {});
  });
  if (!done) return std::unexpected(writer.error.text);
  return bytes;
}

Decoded<PixelRows> png_rows(std::string_view bytes, bool with_alpha) {
  Reader reader;
  png_structp png = reader.png;
  if (!png || !reader.info) return std::unexpected(reader.error.text);
  const auto broken = [&](std::string_view why) {
    return std::unexpected(fmt::format("broken PNG: {}", why));
  };
  std::string_view left = bytes;
  size_t stored_row = 0;
  const bool begun = guarded(png, [&] {
    png_set_read_fn(png, &left, take_bytes);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    // Ignores colour spaces, texts and so on.
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png, reader.info);
    stored_row = png_get_rowbytes(png, reader.info);
  });
  if (!begun) return broken(reader.error.text);

  const auto width = png_get_image_width(png, reader.info);
  const auto height = png_get_image_height(png, reader.info);
  if (const std::string problem = size_problem(width, height); !problem.empty())
    return broken(problem);
  // Deflate needs at least two bits for 258 bytes.
  if (stored_row * height / 1032 > bytes.size())
    return broken(fmt::format("too short for {} x {} pixels", width, height));

  size_t row_bytes = 0;
  int passes = 0, channels = 0;
  const bool prepared = guarded(png, [&] {
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    if (!with_alpha) png_set_strip_alpha(png);
    passes = png_set_interlace_handling(png);
    png_read_update_info(png, reader.info);
    row_bytes = png_get_rowbytes(png, reader.info);
    channels = png_get_channels(png, reader.info);
  });
  if (!prepared) return broken(reader.error.text);
  const int bit_depth = png_get_bit_depth(png, reader.info);
  const bool known = channels == 3 || (with_alpha && channels == 4);
  if (!known || row_bytes != size_t(width) * size_t(channels) * size_t(bit_depth / 8))
    return broken("an unknown pixel layout");
  PixelRows rows{int(width), int(height), channels, bit_depth, {}};
  rows.bytes.resize(row_bytes * height);
  const bool done = guarded(png, [&] {
    for (int pass = 0; pass < passes; ++pass)
      for (size_t y = 0; y < height; ++y, check_stop())
        png_read_row(png, &rows.bytes[y * row_bytes], nullptr);
    png_read_end(png, nullptr);
  });
  if (!done) return broken(reader.error.text);
  return rows;
}

Decoded<Image> decode_png(std::string_view bytes) {
  const auto rows = png_rows(bytes, false);
  if (!rows) return std::unexpected(rows.error());
  return picture_of(*rows).color;
}

Decoded<Picture> decode_png_picture(std::string_view bytes) {
  const auto rows = png_rows(bytes, true);
  if (!rows) return std::unexpected(rows.error());
  Picture picture = picture_of(*rows);
  for (size_t i = 0; i < picture.alpha.size(); ++i) picture.color.pixels[i] *= picture.alpha[i];
  return picture;
}

Decoded<Metadata> png_metadata(std::string_view bytes) {
  Reader reader;
  png_structp png = reader.png;
  if (!png || !reader.info) return std::unexpected(reader.error.text);
  std::string_view left = bytes;
  png_textp texts = nullptr;
  int count = 0;
  const bool done = guarded(png, [&] {
    png_set_read_fn(png, &left, take_bytes);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_chunk_malloc_max(png, 1 << 20);
    png_read_info(png, reader.info);  // up to the pixels, where write_image puts the texts
    count = png_get_text(png, reader.info, &texts, nullptr);
  });
  if (!done) return std::unexpected(fmt::format("broken PNG: {}", reader.error.text));
  Metadata metadata;
  for (int i = 0; i < count; ++i)
    if (texts[i].key && texts[i].text) add_metadata(metadata, texts[i].key, texts[i].text);
  return metadata;
}

}  // namespace raio::core
