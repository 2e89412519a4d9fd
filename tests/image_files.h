// Writes and reads picture files for tests.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <png.h>
#include <sys/mman.h>
#include <unistd.h>

#include <map>

#include "io/image/image.h"
#include "temporary_folder.h"

namespace raio::core::tests {

namespace fs = std::filesystem;

struct PngLayout {
  int color_type, bit_depth;
  bool interlaced = false;
};

/// A PNG of `rows` as they are stored: packed, 16 bit values big-endian.
inline std::string png_of(const PngLayout& layout, int width, int height, const std::string& rows) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), n);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, layout.bit_depth, layout.color_type,
               layout.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
  png_color palette[4] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {51, 102, 153}};
  const png_byte opacity[2] = {0, 128};
  if (layout.color_type == PNG_COLOR_TYPE_PALETTE) {
    png_set_PLTE(png, info, palette, 4);
    png_set_tRNS(png, info, opacity, 2, nullptr);
  }
  png_write_info(png, info);
  const size_t row_bytes = png_get_rowbytes(png, info);
  EXPECT_EQ(rows.size(), row_bytes * height);
  for (int pass = png_set_interlace_handling(png); pass > 0; --pass)
    for (int y = 0; y < height; ++y)
      png_write_row(png, reinterpret_cast<png_const_bytep>(&rows[y * row_bytes]));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

struct ExrLayout {
  std::map<std::string, Imf::Channel> channels = {{"R", Imf::Channel(Imf::HALF)},
                                                  {"G", Imf::Channel(Imf::HALF)},
                                                  {"B", Imf::Channel(Imf::HALF)}};
  Imf::Compression compression = Imf::PIZ_COMPRESSION;
  bool tiled = false;
  Imath::V2i corner{0, 0};  // of the data window
};

inline constexpr int kExrSize = 4;

/// An EXR of 4 x 4 pixels; channel number c in order of names has value c + x / 4 + y / 16.
inline std::string exr_of(const fs::path& path, const ExrLayout& layout) {
  const Imath::Box2i window(layout.corner, layout.corner + Imath::V2i(kExrSize - 1));
  Imf::Header header(Imath::Box2i(Imath::V2i(0), Imath::V2i(99)), window);
  header.compression() = layout.compression;
  std::vector<std::vector<float>> values;
  values.reserve(layout.channels.size());
  Imf::FrameBuffer frame;
  for (const auto& [name, channel] : layout.channels) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT, channel.xSampling, channel.ySampling));
    auto& own = values.emplace_back();
    for (int i = 0; i < kExrSize * kExrSize; ++i)
      own.push_back(float(values.size()) - 1 + float(i % 4) / 4 + float(i / 4) / 16);
    frame.insert(
        name, Imf::Slice::Make(Imf::FLOAT, own.data(), window, 4, 4 * kExrSize / channel.xSampling,
                               channel.xSampling, channel.ySampling));
  }
  if (layout.tiled) {
    header.setTileDescription(Imf::TileDescription(2, 2));
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(kExrSize);
  }
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class ImageTest : public TemporaryFolder {
 protected:
  ~ImageTest() override { ::close(memory_); }

  /// Through a file in memory: tests read thousands.
  std::expected<Image, Error> read(std::string_view bytes) { return read_image(in_memory(bytes)); }
  std::expected<Picture, Error> read_whole(std::string_view bytes) {
    return read_picture(in_memory(bytes));
  }
  Image read_good(std::string_view bytes) {
    auto image = read(bytes);
    EXPECT_TRUE(image) << image.error().text();
    return image ? *image : Image();
  }
  Picture read_whole_good(std::string_view bytes) {
    auto picture = read_whole(bytes);
    EXPECT_TRUE(picture) << picture.error().text();
    return picture ? *picture : Picture();
  }
  void expect_bad(std::string_view bytes, std::string_view why) {
    const auto image = read(bytes);
    ASSERT_FALSE(image) << why;
    EXPECT_EQ(image.error().kind, ErrorKind::cannot_read);
    EXPECT_THAT(image.error().text(), testing::HasSubstr(in_memory_.string()));
    EXPECT_THAT(image.error().text(), testing::HasSubstr(std::string(why)));
    EXPECT_THAT(image.error().text(), testing::Not(testing::HasSubstr("\n")));
  }
  std::string written(const auto& picture, std::string_view name) {
    const auto done = write_image(picture, file(name));
    EXPECT_TRUE(done) << done.error().text();
    return get(file(name));
  }

 private:
  const fs::path& in_memory(std::string_view bytes) {
    EXPECT_EQ(::ftruncate(memory_, 0), 0);
    EXPECT_EQ(::pwrite(memory_, bytes.data(), bytes.size(), 0), ssize_t(bytes.size()));
    return in_memory_;
  }

  int memory_ = ::memfd_create("raio-test", 0);
  fs::path in_memory_ = "/proc/self/fd/" + std::to_string(memory_);
};

}  // namespace raio::core::tests
