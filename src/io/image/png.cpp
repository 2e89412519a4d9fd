// PNG by libpng. Its errors are jumps (setjmp, longjmp), which must not cross anything with a
// destructor: all calls that can fail are made from lambdas under guarded(), with every object that
// owns memory outside.
#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "base/parallel.h"
#include "io/image/codecs.h"

namespace raio {

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

/// Runs `step`; false when libpng gave up, of which ErrorText tells. What `step` calls must own
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

/// tEXt, or iTXt for values that Latin-1 might not hold. The strings must stay where they are.
png_text text_chunk(std::string& name, std::string& value) {
  const bool ascii = std::ranges::all_of(value, [](unsigned char c) { return c < 128; });
  png_text text{};
  text.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
  text.key = name.data();
  text.text = value.data();
  return text;
}

Image from_rows(const std::vector<png_byte>& rows, int width, int height, int bit_depth) {
  Image image(width, height);
  const png_byte* p = rows.data();
  for (Rgb& pixel : image.pixels)
    for (int channel = 0; channel < 3; ++channel) {
      if (bit_depth == 16) {
        pixel[channel] = float(p[0] << 8 | p[1]) / 65535;
        p += 2;
      } else {
        pixel[channel] = float(*p++) / 255;
      }
    }
  return image;
}

// Writing: libpng cannot compress on several threads, so it is given the compressed pixels.

/// So that zlib's lengths and PNG's can hold a row.
constexpr size_t kWidest = size_t(1) << 28;

/// A raw deflate stream. Level 1 on rows with no filter is several times faster than libpng's
/// defaults on rendered pictures, and the files are hardly larger.
struct Deflater {
  z_stream stream{};

  Deflater() {
    constexpr int kRaw = -MAX_WBITS, kUsualMemory = 8;
    if (deflateInit2(&stream, 1, Z_DEFLATED, kRaw, kUsualMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream); }

  /// Appends all of `bytes` to `out`, for itself; more can follow there, unless this is the last.
  void append(std::vector<png_byte>& bytes, bool last, std::string& out) {
    deflateReset(&stream);
    constexpr size_t kFlushBytes = 16;
    const size_t before = out.size();
    out.resize(before + deflateBound(&stream, uLong(bytes.size())) + kFlushBytes);
    stream.next_in = bytes.data();
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = uInt(out.size() - before);
    deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
};

/// Rows as PNG wants them, a byte for the filter before each.
std::vector<png_byte> filtered_rows(const Image& image, int first, int end) {
  std::vector<png_byte> rows((1 + 3 * size_t(image.width)) * size_t(end - first));
  png_byte* out = rows.data();
  for (int y = first; y < end; ++y) {
    *out++ = PNG_FILTER_VALUE_NONE;
    const Rgb* pixel = &image.at(0, y);
    for (int x = 0; x < image.width; ++x, ++pixel) {
      *out++ = to_byte(pixel->x);
      *out++ = to_byte(pixel->y);
      *out++ = to_byte(pixel->z);
    }
  }
  return rows;
}

/// The picture as one zlib stream (RFC 1950) in parts, bands of rows that are compressed each for
/// itself, on all threads. Their height is a matter of the width alone, so that the number of
/// threads does not show.
std::vector<std::string> zlib_stream(const Image& image) {
  constexpr size_t kBandBytes = 1 << 16;  // the file is 2 % larger than without bands
  const int height = std::max(1, int(kBandBytes / (1 + 3 * size_t(image.width))));
  std::vector<std::string> bands(size_t(image.height - 1) / size_t(height) + 1);
  std::vector<uLong> check_sums(bands.size());
  std::vector<size_t> sizes(bands.size());
  PerThread<Deflater> deflaters;  // a quarter of a megabyte each
  bands[0] = "\x78\x01";          // deflate with a window of 32 kB, fastest
  parallel_for(bands.size(), [&](size_t i) {
    const int first = int(i) * height;
    std::vector<png_byte> rows =
        filtered_rows(image, first, std::min(image.height - first, height) + first);
    sizes[i] = rows.size();
    check_sums[i] = adler32_z(adler32_z(0, nullptr, 0), rows.data(), rows.size());
    deflaters.local().append(rows, i + 1 == bands.size(), bands[i]);
  });
  uLong check_sum = check_sums[0];
  for (size_t i = 1; i < bands.size(); ++i)
    check_sum = adler32_combine(check_sum, check_sums[i], z_off_t(sizes[i]));
  for (const int shift : {24, 16, 8, 0}) bands.back() += char(check_sum >> shift & 255);
  return bands;
}

void write_chunk(png_structp png, const char* type, std::string_view bytes) {
  png_write_chunk(png, reinterpret_cast<png_const_bytep>(type),
                  reinterpret_cast<png_const_bytep>(bytes.data()), bytes.size());
}

}  // namespace

Decoded<std::string> encode_png(const Image& image, const Metadata& metadata) {
  if (size_t(image.width) > kWidest) return std::unexpected("it is too wide for a PNG");
  const std::vector<std::string> bands = zlib_stream(image);
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
    png_set_IHDR(png, writer.info, png_uint_32(image.width), png_uint_32(image.height), 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_text(png, writer.info, texts.data(), int(texts.size()));
    png_write_info(png, writer.info);
    for (const std::string& band : bands) write_chunk(png, "IDAT", band);
    write_chunk(png, "IEND", {});
  });
  if (!done) return std::unexpected(writer.error.text);
  return bytes;
}

Decoded<Image> decode_png(std::string_view bytes) {
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
    // Colour spaces, texts and the like are not even looked at.
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png, reader.info);
    stored_row = png_get_rowbytes(png, reader.info);
  });
  if (!begun) return broken(reader.error.text);

  const auto width = png_get_image_width(png, reader.info);
  const auto height = png_get_image_height(png, reader.info);
  if (const std::string problem = size_problem(width, height); !problem.empty())
    return broken(problem);
  // Deflate makes 258 bytes of no less than two bits.
  if (stored_row * height / 1032 > bytes.size())
    return broken(fmt::format("too short for {} x {} pixels", width, height));

  std::vector<png_byte> rows;
  size_t row_bytes = 0;
  int passes = 0;
  const bool prepared = guarded(png, [&] {
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_strip_alpha(png);
    passes = png_set_interlace_handling(png);
    png_read_update_info(png, reader.info);
    row_bytes = png_get_rowbytes(png, reader.info);
  });
  if (!prepared) return broken(reader.error.text);
  const int bit_depth = png_get_bit_depth(png, reader.info);
  if (row_bytes != size_t(width) * 3 * size_t(bit_depth / 8))
    return broken("a layout of pixels that is not known");
  rows.resize(row_bytes * height);
  const bool done = guarded(png, [&] {
    for (int pass = 0; pass < passes; ++pass)
      for (size_t y = 0; y < height; ++y) png_read_row(png, &rows[y * row_bytes], nullptr);
    png_read_end(png, nullptr);
  });
  if (!done) return broken(reader.error.text);
  return from_rows(rows, int(width), int(height), bit_depth);
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
    png_read_info(png, reader.info);  // up to the pixels, where write_image has the texts
    count = png_get_text(png, reader.info, &texts, nullptr);
  });
  if (!done) return std::unexpected(fmt::format("broken PNG: {}", reader.error.text));
  Metadata metadata;
  for (int i = 0; i < count; ++i)
    if (texts[i].key && texts[i].text) add_metadata(metadata, texts[i].key, texts[i].text);
  return metadata;
}

}  // namespace raio
