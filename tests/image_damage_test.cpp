// Files that are no pictures, or no longer: an error in one line, and no memory that they only
// claim.
#include "image_files.h"
#include "noise.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using testing::Not;
using tests::exr_of;
using tests::ExrLayout;
using tests::ImageTest;
using tests::layered;
using tests::next_random;
using tests::noise;
using tests::png_of;

TEST_F(ImageTest, BadFilesAreErrorsInOneLine) {
  expect_bad("", "empty");
  expect_bad("GIF89a", "expected a PNG, JPEG, EXR, HDR, PFM or PPM picture");
  expect_bad("P4 1 1 \xff", "expected a PNG, JPEG, EXR");
  expect_bad("P6", "the file ends before the width");
  expect_bad("P6 x 1 255 ", "expected the width, found \"x\"");
  expect_bad("P6 2 99999999999 255 ", "expected the height");
  expect_bad("P6 0 1 255 ", "0 x 1 pixels");
  expect_bad("P6 -1 -1 255 ", "-1 x -1 pixels");
  expect_bad("P6 20000 20000 255 ", "more than 268435456 pixels");
  expect_bad("P6 2147483647 2147483647 255 ", "more than 268435456 pixels");
  expect_bad("P6 10000 10000 255 ab", "expected 300000000 bytes of pixels, found 2");
  expect_bad("P3 10000 10000 255 1 2 3", "expected 599999999 bytes of pixels, found 5");
  expect_bad("P6 1 1 65536 abc", "from 1 to 65535");
  expect_bad("P6 1 1 0 abc", "from 1 to 65535");
  expect_bad("P6 1 1 10 \x01\x02\x0b", "a value of 11 exceeds the maximum of 10");
  expect_bad("P3 1 1 10 1 2 11", "a value of 11 exceeds the maximum of 10");
  expect_bad("P3 1 1 10 1 -2 11", "expected a value, found \"-2\"");
  expect_bad("P2 2 1 10 1      ", "the file ends before a value");
  expect_bad("PF 1 1 0 abcdefghijkl", "a non-zero scale");
  expect_bad("PF 1 1 nan abcdefghijkl", "a non-zero scale");
  expect_bad("PF 10000 10000 -1 ab", "expected 1200000000 bytes of pixels");
  expect_bad("\x89PNG\r\n\x1a\n", "broken PNG: the file ends early");
  expect_bad("\x76\x2f\x31\x01", "broken EXR");
  EXPECT_THAT(read_image(file("missing.png")).error().text(), HasSubstr("No such file"));
  EXPECT_THAT(read_image(folder()).error().text(), HasSubstr("Is a directory"));
  EXPECT_THAT(read_image("/dev/zero").error().text(), HasSubstr("device"));
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

TEST_F(ImageTest, HugeSizesInSmallFilesAreRefusedBeforeAllocation) {
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

TEST_F(ImageTest, ChannelsAreCheckedBeforeAllocation) {
  std::string exr = written(layered(4, 4), "a.exr");
  const std::string name("dataWindow\0box2i\0\x10\0\0\0", 21);
  const size_t at = exr.find(name);
  ASSERT_NE(at, exr.npos);
  // The file could have 512 x 512 pixels, if they had only colours.
  exr.replace(at + name.size() + 8, 8, std::string("\xff\x01\0\0\xff\x01\0\0", 8));
  expect_bad(exr, "too short for 512 x 512");
  exr.resize(1'000'000);  // long enough for these, but not in a good order
  expect_bad(exr, "broken EXR");
  // 19 channels of 2^28 pixels; a long enough file has 15 MB.
  exr.resize(15'000'000);
  exr.replace(at + name.size() + 8, 8, std::string("\xff\x3f\0\0\xff\x3f\0\0", 8));
  EXPECT_THAT(read_whole(exr).error().text(),
              HasSubstr("19 channels of 268435456 pixels are more than 1073741824 numbers"));
}

TEST_F(ImageTest, EveryTruncationIsAnError) {
  const Image image = noise(5, 4);
  std::vector<std::string> originals;
  for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm"})
    originals.push_back(written(image, name));
  Picture picture = layered(5, 4);
  originals.push_back(written(picture, "a.exr"));
  picture.layers.clear();
  originals.push_back(written(picture, "a.png"));
  for (const std::string& whole : originals)
    for (size_t size = 0; size < whole.size(); ++size) {
      const auto read_back = read(std::string_view(whole).substr(0, size));
      ASSERT_FALSE(read_back) << whole.substr(0, 4) << " cut to " << size;
      ASSERT_EQ(read_back.error().kind, ErrorKind::cannot_read);
      const auto with_layers = read_whole(std::string_view(whole).substr(0, size));
      ASSERT_FALSE(with_layers) << whole.substr(0, 4) << " cut to " << size;
      ASSERT_EQ(with_layers.error().kind, ErrorKind::cannot_read);
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
  originals.push_back(written(layered(4, 4), "a.exr"));
  for (size_t kind = 0; kind < originals.size(); ++kind) {
    const bool png = originals[kind].starts_with("\x89PNG");
    int good = 0, bad = 0;
    for (uint64_t round = 0; round < 2000; ++round) {
      uint64_t random = kind << 32 | round;
      std::string bytes = originals[kind];
      for (uint64_t n = 1 + next_random(random) % 3; n > 0; --n) change(bytes, random);
      if (png && round % 4 != 0) mend_check_sums(bytes);
      const auto image_alone = read(bytes);
      const auto result = read_whole(bytes);
      if (image_alone) {
        ++good;
        ASSERT_GT(image_alone->width, 0);
        ASSERT_EQ(image_alone->pixels.size(),
                  size_t(image_alone->width) * size_t(image_alone->height));
      } else {
        ++bad;
        ASSERT_EQ(image_alone.error().kind, ErrorKind::cannot_read);
        ASSERT_THAT(image_alone.error().text(), Not(HasSubstr("\n")));
        ASSERT_FALSE(result);
      }
      if (result) {
        ASSERT_EQ(result->color.width, image_alone->width);
        for (const Layer& layer : result->layers)
          ASSERT_EQ(std::visit([](const auto& values) { return values.size(); }, layer.values),
                    layer.components.size() * result->color.pixels.size());
      } else {
        ASSERT_THAT(result.error().text(), Not(HasSubstr("\n")));
      }
    }
    EXPECT_GT(good, 0) << "kind " << kind;
    EXPECT_GT(bad, 100) << "kind " << kind;
  }
}

}  // namespace
}  // namespace raio::core
