#include "io/image.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <png.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include "noise.h"
#include "render/render.h"
#include "temporary_folder.h"

namespace raio {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::next_random;
using testing::noise;
using ::testing::Not;

void expect_equal_bits(const Image& a, const Image& b) {
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  for (size_t i = 0; i < a.pixels.size(); ++i)
    for (int channel = 0; channel < 3; ++channel)
      ASSERT_EQ(std::bit_cast<uint32_t>(a.pixels[i][channel]),
                std::bit_cast<uint32_t>(b.pixels[i][channel]))
          << "pixel " << i << " channel " << channel;
}

struct PngLayout {
  int color_type, bit_depth;
  bool interlaced = false;
};

/// A PNG of `rows` as they are stored: packed, 16 bit values big-endian.
std::string png_of(const PngLayout& layout, int width, int height, const std::string& rows) {
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

constexpr int kExrSize = 4;

/// An EXR of 4 x 4 pixels; channel number c in order of names has value c + x / 4 + y / 16.
std::string exr_of(const fs::path& path, const ExrLayout& layout) {
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

  /// By way of a file in memory: tests read thousands.
  std::expected<Image, FileError> read(std::string_view bytes) {
    EXPECT_EQ(::ftruncate(memory_, 0), 0);
    EXPECT_EQ(::pwrite(memory_, bytes.data(), bytes.size(), 0), ssize_t(bytes.size()));
    return read_image(in_memory_);
  }
  Image read_good(std::string_view bytes) {
    auto image = read(bytes);
    EXPECT_TRUE(image) << image.error().message;
    return image ? *image : Image();
  }
  void expect_bad(std::string_view bytes, std::string_view why) {
    const auto image = read(bytes);
    ASSERT_FALSE(image) << why;
    EXPECT_EQ(image.error().kind, FileError::bad_input);
    EXPECT_THAT(image.error().message, HasSubstr(in_memory_.string()));
    EXPECT_THAT(image.error().message, HasSubstr(std::string(why)));
    EXPECT_THAT(image.error().message, Not(HasSubstr("\n")));
  }
  std::string written(const Image& image, std::string_view name) {
    const auto done = write_image(image, file(name));
    EXPECT_TRUE(done) << done.error().message;
    return get(file(name));
  }

 private:
  int memory_ = ::memfd_create("raio-test", 0);
  fs::path in_memory_ = "/proc/self/fd/" + std::to_string(memory_);
};

TEST(ToByte, ClampsAndRoundsToNearest) {
  for (int i = 0; i < 256; ++i) {
    EXPECT_EQ(to_byte(float(i) / 255), i);
    EXPECT_EQ(to_byte((float(i) + 0.499f) / 255), i);
    EXPECT_EQ(to_byte((float(i) - 0.499f) / 255), i);
  }
  EXPECT_EQ(to_byte(-1), 0);
  EXPECT_EQ(to_byte(1e30f), 255);
  EXPECT_EQ(to_byte(std::numeric_limits<float>::infinity()), 255);
  EXPECT_EQ(to_byte(-std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(to_byte(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST_F(ImageTest, FormatBySuffix) {
  EXPECT_EQ(image_format("a.png"), ImageFormat::png);
  EXPECT_EQ(image_format("a.b.ExR"), ImageFormat::exr);
  EXPECT_EQ(image_format("A.PFM"), ImageFormat::pfm);
  EXPECT_EQ(image_format("missing/a.ppm"), ImageFormat::ppm);
  EXPECT_EQ(image_format("-"), ImageFormat::png);
  EXPECT_EQ(image_format("/dev/null"), ImageFormat::png);
  EXPECT_EQ(image_format("/dev/stdout"), ImageFormat::png);
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(file("pipe.exr").c_str(), 0600), 0);
  EXPECT_EQ(image_format(file("pipe")), ImageFormat::png);
  EXPECT_EQ(image_format(file("pipe.exr")), ImageFormat::exr);
  put(file("plain"), "");
  for (const fs::path& path : {fs::path("a.jpg"), fs::path("a"), fs::path(".png"), file("plain")}) {
    const auto format = image_format(path);
    ASSERT_FALSE(format) << path;
    EXPECT_EQ(format.error().kind, FileError::bad_input);
    for (const char* suffix : {".png", ".exr", ".pfm", ".ppm"})
      EXPECT_THAT(format.error().message, HasSubstr(suffix));
    EXPECT_EQ(write_image(noise(1, 1), path).error().message, format.error().message);
  }
}

TEST_F(ImageTest, EightBitFormatsRoundWithinHalfAStep) {
  const Image image = noise(37, 11);
  for (const char* name : {"a.png", "a.ppm", "A.PNG"}) {
    const Image back = read_good(written(image, name));
    ASSERT_EQ(back.pixels.size(), image.pixels.size());
    ASSERT_EQ(back.width, image.width);
    for (size_t i = 0; i < image.pixels.size(); ++i)
      for (int channel = 0; channel < 3; ++channel)
        ASSERT_NEAR(back.pixels[i][channel], std::clamp(image.pixels[i][channel], 0.f, 1.f),
                    0.5f / 255 + 1e-6f);
    EXPECT_EQ(compare(image, back).largest, 0) << name;
  }
}

TEST_F(ImageTest, FloatingPointFormatsKeepEveryBit) {
  Image image = noise(33, 35);  // more than one block of 16 rows
  using Limits = std::numeric_limits<float>;
  const float special[] = {-0.f,
                           1e-42f,
                           Limits::denorm_min(),
                           -3.5f,
                           Limits::max(),
                           Limits::lowest(),
                           Limits::infinity(),
                           -Limits::infinity(),
                           Limits::quiet_NaN()};
  for (size_t i = 0; i < std::size(special); ++i) image.pixels[i * 7] = Rgb(special[i], 2, 1e9f);
  for (const char* name : {"a.exr", "a.pfm"}) {
    SCOPED_TRACE(name);
    expect_equal_bits(image, read_good(written(image, name)));
  }
}

TEST_F(ImageTest, PfmAndPpmBytesAreAsTheFormatsSay) {
  Image image(1, 2);
  image.at(0, 0) = {1, 2, 3};
  image.at(0, 1) = {0, 0.5f, -1};
  EXPECT_EQ(written(image, "a.ppm"), std::string("P6\n1 2\n255\n\xff\xff\xff\x00\x80\x00", 17));
  // Bottom row first; 0.5 is 3f000000, -1 bf800000.
  EXPECT_EQ(written(image, "a.pfm"),
            std::string("PF\n1 2\n-1.0\n"
                        "\0\0\0\0\0\0\0\x3f\0\0\x80\xbf\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40",
                        36));
}

TEST_F(ImageTest, VeryWideAndVeryHighPicturesAreWritten) {
  for (const auto& [width, height] : {std::pair(1'000'001, 1), std::pair(1, 1'000'001)}) {
    Image image(width, height);
    image.pixels.back() = Rgb(1);
    for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm"}) {
      SCOPED_TRACE(name);
      expect_equal_bits(image, read_good(written(image, name)));
    }
  }
}

TEST_F(ImageTest, PicturesThatAreNoneAreErrors) {
  Image wrong(4, 4);
  wrong.pixels.pop_back();
  Image negative;
  negative.width = negative.height = -1;
  for (const Image& image : {Image(), Image(0, 5), Image(5, 0), wrong, negative})
    for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm"}) {
      const auto done = write_image(image, file(name));
      ASSERT_FALSE(done) << name;
      EXPECT_EQ(done.error().kind, FileError::bad_input);
    }
  EXPECT_EQ(entries(), 0);
}

TEST_F(ImageTest, TargetsThatCannotBeWritten) {
  const Image image = noise(8, 8);
  EXPECT_TRUE(write_image(image, "/dev/null"));
  fs::create_directory(file("folder.png"));
  for (const fs::path& path : {fs::path("/dev/full"), file("folder.png"), file("missing/a.exr")}) {
    const auto done = write_image(image, path);
    ASSERT_FALSE(done) << path;
    EXPECT_EQ(done.error().kind, FileError::cannot_write);
    EXPECT_THAT(done.error().message, HasSubstr(path.string()));
  }
}

/// The contents of all IDAT chunks of a PNG in a row.
std::string idat_of(std::string_view png) {
  std::string out;
  for (size_t at = 8; at + 12 <= png.size();) {
    size_t size = 0;
    for (size_t i = 0; i < 4; ++i) size = size << 8 | uint8_t(png[at + i]);
    if (png.substr(at + 4, 4) == "IDAT") out += png.substr(at + 8, size);
    at += size + 12;
  }
  return out;
}

TEST_F(ImageTest, PngOfManyBandsIsOneStream) {
  // Bands of many rows and of one, the last shorter and not.
  const std::pair<int, int> sizes[] = {{700, 310}, {700, 311}, {30000, 3}, {1, 40000}, {21845, 2}};
  for (const auto& [width, height] : sizes) {
    SCOPED_TRACE(width);
    const Image image = noise(width, height);
    const std::string bytes = written(image, "a.png");
    EXPECT_EQ(compare(image, read_good(bytes)).largest, 0);
    const std::string deflated = idat_of(bytes);
    std::vector<Bytef> rows(size_t(3 * width + 1) * size_t(height) + 1);
    uLongf size = uLongf(rows.size());
    uLong taken = uLong(deflated.size());
    // Z_OK means that the check sum is right, too.
    EXPECT_EQ(
        uncompress2(rows.data(), &size, reinterpret_cast<const Bytef*>(deflated.data()), &taken),
        Z_OK);
    EXPECT_EQ(size, rows.size() - 1);
    EXPECT_EQ(taken, deflated.size());
    on_threads(1, [&] { EXPECT_EQ(written(image, "b.png"), bytes); });
  }
}

const Metadata kMetadata = {{"seed", "42"}, {"scene", "b\xc3\xa4lle 4"}, {"note", ""}};

TEST_F(ImageTest, PngKeepsMetadata) {
  ASSERT_TRUE(write_image(noise(3, 2), file("a.png"), kMetadata));
  std::FILE* stream = std::fopen(file("a.png").c_str(), "rb");
  ASSERT_NE(stream, nullptr);
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, stream);
  png_read_info(png, info);
  EXPECT_EQ(png_get_bit_depth(png, info), 8);
  EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_RGB);
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(png, info, &texts, &count);
  std::map<std::string, std::string> found;
  for (int i = 0; i < count; ++i) found[texts[i].key] = texts[i].text;
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(stream);
  EXPECT_THAT(found, ::testing::UnorderedElementsAre(std::pair("raio.seed", "42"),
                                                     std::pair("raio.scene", "b\xc3\xa4lle 4"),
                                                     std::pair("raio.note", "")));
}

TEST_F(ImageTest, ExrKeepsMetadata) {
  ASSERT_TRUE(write_image(noise(3, 2), file("a.exr"), kMetadata));
  const Imf::InputFile in(file("a.exr").c_str());
  EXPECT_EQ(in.header().compression(), Imf::ZIP_COMPRESSION);
  EXPECT_EQ(in.header().channels()["R"].type, Imf::FLOAT);
  for (const auto& [key, value] : kMetadata)
    EXPECT_EQ(in.header().typedAttribute<Imf::StringAttribute>("raio." + key).value(), value);
}

TEST_F(ImageTest, MetadataKeysArePlainWords) {
  for (const std::string& key : {std::string(), std::string(75, 'k'), std::string("two words"),
                                 std::string("a\nb"), std::string("\xc3\xa4")})
    for (const char* name : {"a.png", "a.exr"}) {
      const auto done = write_image(noise(1, 1), file(name), {{key, "v"}});
      ASSERT_FALSE(done) << key;
      EXPECT_EQ(done.error().kind, FileError::bad_input);
    }
  EXPECT_EQ(entries(), 0);
  for (const char* name : {"a.png", "a.exr"})
    EXPECT_TRUE(write_image(noise(1, 1), file(name), {{std::string(74, 'k'), "v"}}));
}

TEST_F(ImageTest, ReadsEveryKindOfPng) {
  const Rgb red(1, 0, 0), blue(0, 0, 1), third(51 / 255.f, 102 / 255.f, 153 / 255.f);
  for (const bool interlaced : {false, true}) {
    Image image =
        read_good(png_of({PNG_COLOR_TYPE_RGB, 8, interlaced}, 2, 1, "\xff\x33\x66\x01\x02\x03"));
    EXPECT_EQ(image.pixels,
              (std::vector{Rgb(1, 51 / 255.f, 102 / 255.f), Rgb(1 / 255.f, 2 / 255.f, 3 / 255.f)}));
    image = read_good(png_of({PNG_COLOR_TYPE_RGB, 16, interlaced}, 1, 1,
                             std::string("\x12\x34\xff\xff\x00\x01", 6)));
    EXPECT_EQ(image.pixels, std::vector{Rgb(0x1234 / 65535.f, 1, 1 / 65535.f)});
    image = read_good(png_of({PNG_COLOR_TYPE_RGB_ALPHA, 8, interlaced}, 1, 1,
                             std::string("\x33\x66\x99\x00", 4)));
    EXPECT_EQ(image.pixels, std::vector{third});
    image = read_good(png_of({PNG_COLOR_TYPE_GRAY, 8, interlaced}, 1, 2, "\x33\xff"));
    EXPECT_EQ(image.pixels, (std::vector{Rgb(51 / 255.f), Rgb(1)}));
    image = read_good(png_of({PNG_COLOR_TYPE_GRAY, 1, interlaced}, 3, 1, "\xa0"));
    EXPECT_EQ(image.pixels, (std::vector{Rgb(1), Rgb(0), Rgb(1)}));
    image = read_good(png_of({PNG_COLOR_TYPE_GRAY, 16, interlaced}, 1, 1, "\x80\x01"));
    EXPECT_EQ(image.pixels, std::vector{Rgb(0x8001 / 65535.f)});
    image =
        read_good(png_of({PNG_COLOR_TYPE_GRAY_ALPHA, 16, interlaced}, 1, 1, "\x80\x01\x11\x11"));
    EXPECT_EQ(image.pixels, std::vector{Rgb(0x8001 / 65535.f)});
    // Four pixels of two bits: palette entries 0, 2, 3, 3; entry 0 is fully transparent.
    image = read_good(png_of({PNG_COLOR_TYPE_PALETTE, 2, interlaced}, 4, 1, "\x2f"));
    EXPECT_EQ(image.pixels, (std::vector{red, blue, third, third}));
  }
}

TEST_F(ImageTest, ReadsManyKindsOfExr) {
  ExrLayout layout;
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION})
    for (const bool tiled : {false, true})
      for (const Imath::V2i& corner : {Imath::V2i(0, 0), Imath::V2i(-7, 90)}) {
        layout.compression = compression;
        layout.tiled = tiled;
        layout.corner = corner;
        const Image image = read_good(exr_of(file("a.exr"), layout));
        ASSERT_EQ(image.width, 4);
        ASSERT_EQ(image.height, 4);
        // In order of names: B, G, R.
        for (int y = 0; y < 4; ++y)
          for (int x = 0; x < 4; ++x) {
            const float value = float(x) / 4 + float(y) / 16;
            ASSERT_EQ(image.at(x, y), Rgb(value + 2, value + 1, value));
          }
      }
  layout.channels = {{"Y", Imf::Channel()}, {"A", Imf::Channel()}};
  EXPECT_EQ(read_good(exr_of(file("a.exr"), layout)).at(1, 0), Rgb(1.25f));
}

TEST_F(ImageTest, ExrWithoutTheChannelsTellsWhatIsThere) {
  ExrLayout layout;
  layout.channels = {{"depth.Z", Imf::Channel()}, {"R", Imf::Channel()}, {"G", Imf::Channel()}};
  expect_bad(exr_of(file("a.exr"), layout), "found G, R, depth.Z");
  layout.channels = {{"Y", Imf::Channel(Imf::FLOAT, 2, 2)}};
  expect_bad(exr_of(file("a.exr"), layout), "full resolution; found Y");
  {
    Imf::RgbaOutputFile luminance(file("yc.exr").c_str(), 4, 4, Imf::WRITE_YC);
    std::array<Imf::Rgba, 16> pixels;
    luminance.setFrameBuffer(pixels.data(), 1, 4);
    luminance.writePixels(4);
  }
  expect_bad(get(file("yc.exr")), "found BY, RY, Y");
}

TEST_F(ImageTest, ReadsEveryKindOfPpmAndPfm) {
  const Rgb a(1, 0, 0.5f), b(0.25f);
  EXPECT_EQ(read_good("P3 1 2 4 4 0 2 1 1 1").pixels, (std::vector{a, b}));
  EXPECT_EQ(read_good("P3#c\n# 9 9\n1 # w\n2\t4#m\r\n4 0 2#x\n1 1\n1\n").pixels,
            (std::vector{a, b}));
  EXPECT_EQ(read_good("P2\n2 1\n4\n1 1").pixels, (std::vector{b, b}));
  EXPECT_EQ(read_good(std::string("P6\n1 2\n# \n4\n\x04\x00\x02\x01\x01\x01", 19)).pixels,
            (std::vector{a, b}));
  EXPECT_EQ(read_good(std::string("P6 1 1 1000 \x03\xe8\x00\x00\x01\xf4", 18)).pixels,
            std::vector{a});
  EXPECT_EQ(read_good("P5 1 1 4\n\x01").pixels, std::vector{b});
  EXPECT_EQ(read_good("P5 1 1 65535\n\xff\xff").pixels, std::vector{Rgb(1)});
  EXPECT_EQ(read_good(std::string("PF\n1 1\n1.0\n\x3f\x80\0\0\0\0\0\0\x3f\0\0\0", 23)).pixels,
            std::vector{a});
  EXPECT_EQ(read_good(std::string("Pf\n1 2\n-2.5\n\0\0\x80\x3e\0\0\x80\x3f", 20)).pixels,
            (std::vector{Rgb(1), b}));
}

TEST_F(ImageTest, BadFilesAreErrorsInOneLine) {
  expect_bad("", "empty");
  expect_bad("GIF89a", "no picture in PNG, EXR, PFM or PPM");
  expect_bad("P4 1 1 \xff", "no picture");
  expect_bad("P6", "the file ends before the width");
  expect_bad("P6 x 1 255 ", "expected the width, found \"x\"");
  expect_bad("P6 2 99999999999 255 ", "expected the height");
  expect_bad("P6 0 1 255 ", "0 x 1 pixels");
  expect_bad("P6 -1 -1 255 ", "-1 x -1 pixels");
  expect_bad("P6 20000 20000 255 ", "more than 268435456 pixels");
  expect_bad("P6 2147483647 2147483647 255 ", "more than 268435456 pixels");
  expect_bad("P6 10000 10000 255 ab", "300000000 bytes of pixels expected, 2 there");
  expect_bad("P3 10000 10000 255 1 2 3", "599999999 bytes of pixels expected, 5 there");
  expect_bad("P6 1 1 65536 abc", "from 1 to 65535");
  expect_bad("P6 1 1 0 abc", "from 1 to 65535");
  expect_bad("P6 1 1 10 \x01\x02\x0b", "a value of 11, the largest is 10");
  expect_bad("P3 1 1 10 1 2 11", "a value of 11, the largest is 10");
  expect_bad("P3 1 1 10 1 -2 11", "expected a value, found \"-2\"");
  expect_bad("P2 2 1 10 1      ", "the file ends before a value");
  expect_bad("PF 1 1 0 abcdefghijkl", "a scale that is not zero");
  expect_bad("PF 1 1 nan abcdefghijkl", "a scale that is not zero");
  expect_bad("PF 10000 10000 -1 ab", "1200000000 bytes of pixels expected");
  expect_bad("\x89PNG\r\n\x1a\n", "broken PNG: the file ends early");
  expect_bad("\x76\x2f\x31\x01", "broken EXR");
  EXPECT_THAT(read_image(file("missing.png")).error().message, HasSubstr("No such file"));
  EXPECT_THAT(read_image(folder()).error().message, HasSubstr("Is a directory"));
  EXPECT_THAT(read_image("/dev/zero").error().message, HasSubstr("device"));
}

uint32_t crc32_of(std::string_view bytes) {
  uint32_t crc = ~0u;
  for (const unsigned char c : bytes) {
    crc ^= c;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

/// Makes the check sums of all whole chunks right, so that a changed PNG gets past them.
void mend_check_sums(std::string& png) {
  const auto number = [&](size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | uint8_t(png[at + i]);
    return value;
  };
  for (size_t at = 8; at + 12 <= png.size();) {
    const size_t size = number(at);
    if (size > png.size() - at - 12) return;
    const uint32_t crc = crc32_of(std::string_view(png).substr(at + 4, size + 4));
    for (size_t i = 0; i < 4; ++i) png[at + 8 + size + i] = char(crc >> (24 - 8 * i) & 0xff);
    at += 12 + size;
  }
}

TEST_F(ImageTest, HugeSizesInSmallFilesAreRefusedBeforeMemoryIsAsked) {
  std::string png = written(noise(4, 4), "a.png");
  png.replace(16, 8, std::string("\0\0\x40\0\0\0\x40\0", 8));  // 16384 x 16384 is within the limit
  mend_check_sums(png);
  expect_bad(png, "too short for 16384 x 16384");
  png.replace(16, 8, "\x7f\xff\xff\xff\x7f\xff\xff\xff");
  mend_check_sums(png);
  expect_bad(png, "more than 268435456 pixels");

  std::string exr = written(noise(4, 4), "a.exr");
  const std::string name("dataWindow\0box2i\0\x10\0\0\0", 21);
  const size_t at = exr.find(name);
  ASSERT_NE(at, exr.npos);
  exr.replace(at + name.size() + 8, 8, std::string("\xff\x3f\0\0\xff\x3f\0\0", 8));
  expect_bad(exr, "too short for 16384 x 16384");
  exr.replace(at + name.size() + 8, 8, "\xff\xff\xff\x7f\xff\xff\xff\x7f");
  expect_bad(exr, "more than 268435456 pixels");
  exr.replace(at + 17, 4, "\xff\xff\xff\x7f");
  expect_bad(exr, "longer than the file");
}

TEST_F(ImageTest, EveryTruncationIsAnError) {
  const Image image = noise(5, 4);
  for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm"}) {
    const std::string whole = written(image, name);
    for (size_t size = 0; size < whole.size(); ++size) {
      const auto read_back = read(std::string_view(whole).substr(0, size));
      ASSERT_FALSE(read_back) << name << " cut to " << size;
      ASSERT_EQ(read_back.error().kind, FileError::bad_input);
    }
  }
}

void change(std::string& bytes, uint64_t& random) {
  const auto below = [&](size_t n) { return size_t(next_random(random) % std::max<size_t>(n, 1)); };
  const size_t at = below(bytes.size());
  switch (below(6)) {
    case 0:
      bytes[at] = char(bytes[at] ^ 1 << below(8));
      break;
    case 1:
      bytes[at] = "\x00\xff\x7f\x80\x01\x20 9-"[below(9)];
      break;
    case 2:
      bytes[at] = char(below(256));
      break;
    case 3:
      bytes.erase(at, 1 + below(8));
      break;
    case 4:
      bytes.insert(below(bytes.size()), bytes.substr(at, 1 + below(8)));
      break;
    case 5:
      for (size_t i = at; i < std::min(at + 4, bytes.size()); ++i)
        bytes[i] = below(2) ? '\xff' : '\0';
      break;
  }
  if (bytes.empty()) bytes = "P";
}

TEST_F(ImageTest, ChangedFilesNeverDoMoreThanFail) {
  const Image image = noise(4, 4);
  std::vector<std::string> originals = {
      written(image, "a.png"),
      written(image, "a.exr"),
      written(image, "a.pfm"),
      written(image, "a.ppm"),
      "P3 2 2 9 1 2 3 4 5 6 7 8 9 0 1 2",
      png_of({PNG_COLOR_TYPE_PALETTE, 2, true}, 4, 4, "\x2f\x11\x22\x33"),
      png_of({PNG_COLOR_TYPE_RGB_ALPHA, 16}, 2, 1, std::string("0123456789abcdef"))};
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION,
        Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION}) {
    ExrLayout layout;
    layout.compression = compression;
    layout.tiled = compression == Imf::RLE_COMPRESSION;
    originals.push_back(exr_of(file("a.exr"), layout));
  }
  for (size_t kind = 0; kind < originals.size(); ++kind) {
    const bool png = originals[kind].starts_with("\x89PNG");
    int good = 0, bad = 0;
    for (uint64_t round = 0; round < 2000; ++round) {
      uint64_t random = kind << 32 | round;
      std::string bytes = originals[kind];
      for (uint64_t n = 1 + next_random(random) % 3; n > 0; --n) change(bytes, random);
      if (png && round % 4 != 0) mend_check_sums(bytes);
      const auto result = read(bytes);
      if (result) {
        ++good;
        ASSERT_GT(result->width, 0);
        ASSERT_EQ(result->pixels.size(), size_t(result->width) * size_t(result->height));
      } else {
        ++bad;
        ASSERT_EQ(result.error().kind, FileError::bad_input);
        ASSERT_THAT(result.error().message, Not(HasSubstr("\n")));
      }
    }
    EXPECT_GT(good, 0) << "kind " << kind;
    EXPECT_GT(bad, 100) << "kind " << kind;
  }
}

}  // namespace
}  // namespace raio
