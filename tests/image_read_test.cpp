// Pictures by other programs are read, whatever of their formats they use.
#include <OpenEXR/ImfRgbaFile.h>

#include <array>

#include "image_files.h"

namespace raio::core {
namespace {

using tests::exr_of;
using tests::ExrLayout;
using tests::ImageTest;
using tests::png_of;

TEST_F(ImageTest, ReadsEveryKindOfPng) {
  const Rgb red(1, 0, 0), blue(0, 0, 1), third(51 / 255.f, 102 / 255.f, 153 / 255.f);
  for (const bool interlaced : {false, true}) {
    Image image =
        read_good(png_of({PNG_COLOR_TYPE_RGB, 8, interlaced}, 2, 1, "\xff\x33\x66\x01\x02\x03"));
    EXPECT_EQ(image.pixels,
              (Column<Rgb>{Rgb(1, 51 / 255.f, 102 / 255.f), Rgb(1 / 255.f, 2 / 255.f, 3 / 255.f)}));
    image = read_good(png_of({PNG_COLOR_TYPE_RGB, 16, interlaced}, 1, 1,
                             std::string("\x12\x34\xff\xff\x00\x01", 6)));
    EXPECT_EQ(image.pixels, Column<Rgb>{Rgb(0x1234 / 65535.f, 1, 1 / 65535.f)});
    image = read_good(png_of({PNG_COLOR_TYPE_RGB_ALPHA, 8, interlaced}, 1, 1,
                             std::string("\x33\x66\x99\x00", 4)));
    EXPECT_EQ(image.pixels, Column<Rgb>{third});
    image = read_good(png_of({PNG_COLOR_TYPE_GRAY, 8, interlaced}, 1, 2, "\x33\xff"));
    EXPECT_EQ(image.pixels, (Column<Rgb>{Rgb(51 / 255.f), Rgb(1)}));
    image = read_good(png_of({PNG_COLOR_TYPE_GRAY, 1, interlaced}, 3, 1, "\xa0"));
    EXPECT_EQ(image.pixels, (Column<Rgb>{Rgb(1), Rgb(0), Rgb(1)}));
    image = read_good(png_of({PNG_COLOR_TYPE_GRAY, 16, interlaced}, 1, 1, "\x80\x01"));
    EXPECT_EQ(image.pixels, Column<Rgb>{Rgb(0x8001 / 65535.f)});
    image =
        read_good(png_of({PNG_COLOR_TYPE_GRAY_ALPHA, 16, interlaced}, 1, 1, "\x80\x01\x11\x11"));
    EXPECT_EQ(image.pixels, Column<Rgb>{Rgb(0x8001 / 65535.f)});
    // Four pixels of two bits: palette entries 0, 2, 3, 3; entry 0 is fully transparent.
    image = read_good(png_of({PNG_COLOR_TYPE_PALETTE, 2, interlaced}, 4, 1, "\x2f"));
    EXPECT_EQ(image.pixels, (Column<Rgb>{red, blue, third, third}));
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

TEST_F(ImageTest, ExrErrorsNameTheExistingChannels) {
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
  EXPECT_EQ(read_good("P3 1 2 4 4 0 2 1 1 1").pixels, (Column<Rgb>{a, b}));
  EXPECT_EQ(read_good("P3#c\n# 9 9\n1 # w\n2\t4#m\r\n4 0 2#x\n1 1\n1\n").pixels,
            (Column<Rgb>{a, b}));
  EXPECT_EQ(read_good("P2\n2 1\n4\n1 1").pixels, (Column<Rgb>{b, b}));
  EXPECT_EQ(read_good(std::string("P6\n1 2\n# \n4\n\x04\x00\x02\x01\x01\x01", 19)).pixels,
            (Column<Rgb>{a, b}));
  EXPECT_EQ(read_good(std::string("P6 1 1 1000 \x03\xe8\x00\x00\x01\xf4", 18)).pixels,
            Column<Rgb>{a});
  EXPECT_EQ(read_good("P5 1 1 4\n\x01").pixels, Column<Rgb>{b});
  EXPECT_EQ(read_good("P5 1 1 65535\n\xff\xff").pixels, Column<Rgb>{Rgb(1)});
  EXPECT_EQ(read_good(std::string("PF\n1 1\n1.0\n\x3f\x80\0\0\0\0\0\0\x3f\0\0\0", 23)).pixels,
            Column<Rgb>{a});
  EXPECT_EQ(read_good(std::string("Pf\n1 2\n-2.5\n\0\0\x80\x3e\0\0\x80\x3f", 20)).pixels,
            (Column<Rgb>{Rgb(1), b}));
}

}  // namespace
}  // namespace raio::core
