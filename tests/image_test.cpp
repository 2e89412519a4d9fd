// Pictures are written as their formats specify, without loss.
#include "io/image/image.h"

#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <sys/stat.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <limits>

#include "image_files.h"
#include "noise.h"
#include "render/render.h"
#include "sanitized.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::ImageTest;
using tests::noise;

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
  EXPECT_EQ(image_format("a.npz"), ImageFormat::npz);
  EXPECT_EQ(image_format("a.NPY"), ImageFormat::npy);
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
    EXPECT_EQ(format.error().kind, ErrorKind::bad_input);
    for (const char* suffix : {".png", ".exr", ".pfm", ".ppm", ".npz", ".npy"})
      EXPECT_THAT(format.error().text(), HasSubstr(suffix));
    EXPECT_EQ(write_image(noise(1, 1), path).error().text(), format.error().text());
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
  constexpr int kVery = tests::if_sanitized(100'001, 1'000'001);
  for (const auto& [width, height] : {std::pair(kVery, 1), std::pair(1, kVery)}) {
    Image image(width, height);
    image.pixels.back() = Rgb(1);
    for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm"}) {
      SCOPED_TRACE(name);
      expect_equal_bits(image, read_good(written(image, name)));
    }
  }
}

TEST_F(ImageTest, InvalidPicturesAreErrors) {
  Image wrong(4, 4);
  wrong.pixels.pop_back();
  Image negative;
  negative.width = negative.height = -1;
  for (const Image& image : {Image(), Image(0, 5), Image(5, 0), wrong, negative})
    for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm", "a.npz", "a.npy"}) {
      const auto done = write_image(image, file(name));
      ASSERT_FALSE(done) << name;
      EXPECT_EQ(done.error().kind, ErrorKind::bad_input);
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
    EXPECT_EQ(done.error().kind, ErrorKind::cannot_write);
    EXPECT_THAT(done.error().text(), HasSubstr(path.string()));
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
    Executor(1).run([&] { EXPECT_EQ(written(image, "b.png"), bytes); });
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
  EXPECT_THAT(found, testing::UnorderedElementsAre(std::pair("raio.seed", "42"),
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
      EXPECT_EQ(done.error().kind, ErrorKind::bad_input);
    }
  EXPECT_EQ(entries(), 0);
  for (const char* name : {"a.png", "a.exr"})
    EXPECT_TRUE(write_image(noise(1, 1), file(name), {{std::string(74, 'k'), "v"}}));
}

}  // namespace
}  // namespace raio::core
