// Pictures with alpha and layers: EXR stores all, PNG alpha, and losses are reported.
#include <Imath/half.h>
#include <OpenEXR/ImfInputFile.h>

#include <array>
#include <cstring>
#include <limits>

#include "image_files.h"
#include "noise.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::ImageTest;
using tests::layered;
using tests::noise;

template <class T>
void expect_equal_bits(const Column<T>& a, const Column<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
}

void expect_equal_bits(const Picture& a, const Picture& b) {
  ASSERT_EQ(a.color.width, b.color.width);
  ASSERT_EQ(a.color.height, b.color.height);
  expect_equal_bits(a.color.pixels, b.color.pixels);
  expect_equal_bits(a.alpha, b.alpha);
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (size_t i = 0; i < a.layers.size(); ++i) {
    SCOPED_TRACE(a.layers[i].name);
    EXPECT_EQ(a.layers[i].name, b.layers[i].name);
    EXPECT_EQ(a.layers[i].components, b.layers[i].components);
    ASSERT_EQ(a.layers[i].values.index(), b.layers[i].values.index());
    std::visit(
        [&]<class T>(const Column<T>& values) {
          expect_equal_bits(values, std::get<Column<T>>(b.layers[i].values));
        },
        a.layers[i].values);
  }
}

TEST_F(ImageTest, ExrKeepsEveryBitOfAlphaAndLayers) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(7, 5), std::pair(33, 35)}) {
    SCOPED_TRACE(width);
    const Picture picture = layered(width, height);
    const std::string bytes = written(picture, "a.exr");
    expect_equal_bits(read_whole_good(bytes), picture);
    expect_equal_bits(read_good(bytes).pixels, picture.color.pixels);
  }
}

TEST_F(ImageTest, ExrLayersAreChannelsOfOnePart) {
  ASSERT_TRUE(write_image(layered(3, 2), file("a.exr"), {{"seed", "42"}}));
  const Imf::InputFile in(file("a.exr").c_str());
  std::vector<std::string> names, whole_numbers;
  for (auto i = in.header().channels().begin(); i != in.header().channels().end(); ++i) {
    names.emplace_back(i.name());
    if (i.channel().type == Imf::UINT) whole_numbers.emplace_back(i.name());
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre(
                         "R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "depth.Z", "id.I",
                         "light.key.R", "light.key.G", "light.key.B", "light.key.A", "normal.X",
                         "normal.Y", "normal.Z", "pair.first", "pair.second", "samples"));
  EXPECT_THAT(whole_numbers, ElementsAre("id.I", "pair.first", "pair.second", "samples"));
  EXPECT_EQ(in.header().compression(), Imf::ZIP_COMPRESSION);
  EXPECT_EQ(read_metadata(file("a.exr")), (Metadata{{"seed", "42"}}));
}

TEST_F(ImageTest, ReadsLayersByOtherPrograms) {
  const std::vector<std::pair<const char*, Imf::PixelType>> channels = {
      {"R", Imf::HALF},       {"G", Imf::HALF},      {"B", Imf::HALF},     {"A", Imf::HALF},
      {"Z", Imf::HALF},       {"a.b.Y", Imf::FLOAT}, {"a.b.X", Imf::HALF}, {"mixed.V", Imf::FLOAT},
      {"mixed.I", Imf::UINT}, {".", Imf::UINT},      {".x", Imf::UINT},    {"Y", Imf::HALF}};
  Imf::Header header(2, 1);
  Imf::FrameBuffer frame;
  std::vector<std::array<std::array<char, 4>, 2>> values(channels.size());
  for (uint32_t c = 0; c < channels.size(); ++c) {
    const auto& [name, type] = channels[c];
    for (uint32_t x = 0; x < 2; ++x) {
      const float number = float(c) + 0.5f * float(x);
      const uint32_t whole = c + 0xffff'ff00u * x;
      const Imath::half half = number;
      char* const value = values[c][x].data();
      if (type == Imf::HALF) std::memcpy(value, &half, sizeof half);
      if (type == Imf::FLOAT) std::memcpy(value, &number, sizeof number);
      if (type == Imf::UINT) std::memcpy(value, &whole, sizeof whole);
    }
    header.channels().insert(name, Imf::Channel(type));
    frame.insert(name, Imf::Slice::Make(type, values[c].data(), header.dataWindow(), 4, 8));
  }
  {
    Imf::OutputFile out(file("a.exr").c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(1);
  }
  const Picture picture = read_whole_good(get(file("a.exr")));
  EXPECT_EQ(picture.color.pixels, (Column<Rgb>{Rgb(0, 1, 2), Rgb(0.5f, 1.5f, 2.5f)}));
  EXPECT_EQ(picture.alpha, (Column<float>{3, 3.5f}));
  using Numbers = Column<float>;
  using Whole = Column<uint32_t>;
  EXPECT_THAT(picture.layers,
              ElementsAre(Layer{"", {"x"}, Whole{10, 10 + 0xffff'ff00u}},
                          Layer{".", {""}, Whole{9, 9 + 0xffff'ff00u}},
                          Layer{"Y", {""}, Numbers{11, 11.5f}}, Layer{"Z", {""}, Numbers{4, 4.5f}},
                          Layer{"a.b", {"X", "Y"}, Numbers{6, 5, 6.5f, 5.5f}},
                          Layer{"mixed", {"V"}, Numbers{7, 7.5f}},
                          Layer{"mixed", {"I"}, Whole{8, 8 + 0xffff'ff00u}}));

  tests::ExrLayout layout;
  layout.channels["coarse.X"] = Imf::Channel(Imf::FLOAT, 2, 2);
  const std::string coarse = exr_of(file("b.exr"), layout);
  EXPECT_EQ(read_good(coarse).width, 4);
  EXPECT_THAT(read_whole(coarse).error().text(), HasSubstr("coarse.X is not at full resolution"));
}

TEST_F(ImageTest, GreyExrHasAlpha) {
  tests::ExrLayout layout;
  layout.channels = {{"Y", Imf::Channel()}, {"A", Imf::Channel()}};
  const Picture picture = read_whole_good(exr_of(file("a.exr"), layout));
  EXPECT_EQ(picture.color.at(1, 0), Rgb(1.25f));
  EXPECT_EQ(picture.alpha[1], 0.25f);
  EXPECT_EQ(picture.layers.size(), 0);
}

/// The bytes of a PNG with four channels, as libpng gives them.
std::vector<uint8_t> rgba_bytes(std::string_view png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, png.data(), png.size()));
  EXPECT_EQ(image.format, png_uint_32(PNG_FORMAT_RGBA));
  std::vector<uint8_t> bytes(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr));
  return bytes;
}

TEST_F(ImageTest, PngHasStraightAlpha) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Picture picture;
  picture.color = Image(9, 1);
  picture.color.pixels = {Rgb(0.2f, 0.4f, 1),
                          Rgb(0.2f, 0.1f, 0.4f),
                          Rgb(0.5f, 0, 0.25f),
                          Rgb(0.5f, 0.25f, 1000),
                          Rgb(1),
                          Rgb(0.5f, 0.25f, 0),
                          Rgb(0.001f, 0.002f, 0),
                          Rgb(-1, nan, 0.5f),
                          Rgb(1)};
  picture.alpha = {1, 0.4f, 0.5f, 0.25f, 0, 2, 0.0019f, 0.5f, nan};
  EXPECT_THAT(rgba_bytes(written(picture, "a.png")),
              ElementsAre(51, 102, 255, 255,  //
                          128, 64, 255, 102,  //
                          255, 0, 128, 128,   //
                          255, 255, 255, 64,  // no value over 255
                          0, 0, 0, 0,         // nothing covered
                          128, 64, 0, 255,    // alpha beyond 1
                          0, 0, 0, 0,         // less than half a step
                          0, 0, 255, 128, 0, 0, 0, 0));
}

TEST_F(ImageTest, OpaquePixelsOfPngAreAsWithoutAlpha) {
  Picture picture;
  picture.color = noise(700, 313);  // many bands
  picture.alpha.assign(picture.color.pixels.size(), 1);
  const std::string opaque = written(picture, "a.png");
  const Image image = read_good(opaque);
  EXPECT_EQ(image.pixels, read_good(written(picture.color, "b.png")).pixels);
  const Picture back = read_whole_good(opaque);
  EXPECT_EQ(back.color.pixels, image.pixels);
  EXPECT_EQ(back.alpha, picture.alpha);
}

TEST_F(ImageTest, PngAlphaComesBackWithinHalfAStep) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(7, 5), std::pair(300, 301)}) {
    Picture picture = layered(width, height);
    picture.layers.clear();
    const Picture back = read_whole_good(written(picture, "a.png"));
    ASSERT_EQ(back.alpha.size(), picture.alpha.size());
    for (size_t i = 0; i < picture.alpha.size(); ++i) {
      const float alpha = picture.alpha[i];
      ASSERT_NEAR(back.alpha[i], alpha, 0.5f / 255 + 1e-6f);
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(back.color.pixels[i][c], std::clamp(picture.color.pixels[i][c], 0.f, alpha),
                    1.f / 255 + 1e-6f);
    }
  }
}

TEST_F(ImageTest, ReadsAlphaOfEveryKindOfPng) {
  const auto read_alpha = [&](int type, int depth, const std::string& row, int width) {
    const Picture picture = read_whole_good(tests::png_of({type, depth}, width, 1, row));
    EXPECT_EQ(picture.layers.size(), 0);
    return std::pair(picture.color.pixels, picture.alpha);
  };
  EXPECT_EQ(read_alpha(PNG_COLOR_TYPE_RGB_ALPHA, 8, "\xff\x33\x66\x33", 1),
            std::pair(Column<Rgb>{0.2f * Rgb(1, 0.2f, 0.4f)}, Column<float>{0.2f}));
  EXPECT_EQ(read_alpha(PNG_COLOR_TYPE_GRAY_ALPHA, 16, "\xff\xff\x80\x01", 1),
            std::pair(Column<Rgb>{Rgb(0x8001 / 65535.f)}, Column<float>{0x8001 / 65535.f}));
  EXPECT_EQ(read_alpha(PNG_COLOR_TYPE_RGB, 8, "\xff\x33\x66", 1),
            std::pair(Column<Rgb>{Rgb(1, 0.2f, 0.4f)}, Column<float>{}));
  // Palette entries 0, red and fully transparent, 1, green and half so, and 2, opaque.
  EXPECT_EQ(read_alpha(PNG_COLOR_TYPE_PALETTE, 2, "\x18", 3),
            std::pair(Column<Rgb>{Rgb(0), Rgb(0, 128 / 255.f, 0), Rgb(0, 0, 1)},
                      Column<float>{0, 128 / 255.f, 1}));
}

TEST_F(ImageTest, PicturesOfColoursAloneAreImages) {
  Picture picture;
  picture.color = noise(37, 23);
  for (const char* name : {"a.png", "a.exr", "a.pfm", "a.ppm", "a.npz", "a.npy"}) {
    SCOPED_TRACE(name);
    const std::string bytes = written(picture, name);
    EXPECT_EQ(bytes, written(picture.color, name));
    if (std::string_view(name).starts_with("a.np")) continue;
    const Picture back = read_whole_good(bytes);
    expect_equal_bits(back.color.pixels, read_good(bytes).pixels);
    EXPECT_EQ(back.alpha.size() + back.layers.size(), 0);
  }
}

TEST_F(ImageTest, UnsupportedFeaturesAreRefusedWithAdvice) {
  using enum ImageFormat;
  const std::vector<std::string> none, depth = {"depth"}, two = {"depth", "normal"};
  const char* const kToPlain = "; choose a name that ends in .exr or .npz";
  const char* const kToAlpha = "; choose a name that ends in .png, .exr, .npz or .npy";
  const std::string only = " stores only colours, not ",
                    and_alpha = " stores only colours and alpha, not ";
  for (const ImageFormat format : {png, exr, pfm, ppm, npz, npy})
    EXPECT_EQ(unkept(format, false, none), "");
  for (const ImageFormat format : {png, exr, npz, npy}) EXPECT_EQ(unkept(format, true, none), "");
  for (const ImageFormat format : {exr, npz}) EXPECT_EQ(unkept(format, true, two), "");
  EXPECT_EQ(unkept(png, false, depth), "PNG" + and_alpha + "depth" + kToPlain);
  EXPECT_EQ(unkept(npy, true, two), "NPY" + and_alpha + "depth, normal" + kToPlain);
  EXPECT_EQ(unkept(pfm, true, none), "PFM" + only + "alpha" + kToAlpha);
  EXPECT_EQ(unkept(ppm, true, two), "PPM" + only + "alpha, depth, normal" + kToPlain);
  EXPECT_EQ(unkept(pfm, false, two), "PFM" + only + "depth, normal" + kToPlain);
  EXPECT_THAT(unkept(npz, false, std::vector<std::string>{"rgba"}), HasSubstr("rename the layer"));

  for (const char* name : {"a.png", "a.pfm", "a.ppm", "a.npy"}) {
    const auto done = write_image(layered(2, 2), file(name));
    ASSERT_FALSE(done) << name;
    EXPECT_EQ(done.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(done.error().text(), HasSubstr("stores only colours"));
    EXPECT_THAT(done.error().text(), HasSubstr(file(name).string()));
  }
  EXPECT_EQ(entries(), 0);
}

TEST_F(ImageTest, MismatchedPartsOfPicturesAreErrors) {
  const auto expect_refused = [&](const auto& change, const char* why) {
    Picture picture = layered(3, 2);
    change(picture);
    for (const char* name : {"a.exr", "a.npz"}) {
      const auto done = write_image(picture, file(name));
      ASSERT_FALSE(done) << why;
      EXPECT_EQ(done.error().kind, ErrorKind::bad_input);
      EXPECT_THAT(done.error().text(), HasSubstr(why));
    }
  };
  expect_refused([](Picture& p) { p.alpha.pop_back(); }, "alpha of 5 pixels does not fit 6");
  expect_refused([](Picture& p) { std::get<0>(p.layers[0].values).pop_back(); },
                 "albedo has 17 numbers, not 3 components of 6 pixels");
  expect_refused([](Picture& p) { p.layers[0].components.clear(); },
                 "18 numbers, not 0 components");
  expect_refused([](Picture& p) { p.layers[1].name = "albedo"; }, "two layers are called albedo");
  expect_refused([](Picture& p) { p.layers[0].components[1] = "R"; }, "two components \"R\"");
  for (const std::string& name :
       {std::string(), std::string("a b"), std::string("../depth"), std::string("a\\b"),
        std::string("\xc3\xa4"), std::string(201, 'n')})
    expect_refused([&](Picture& p) { p.layers[1].name = name; }, "cannot be the name of a layer");
  for (const std::string& component : {std::string("a.b"), std::string("\n"), std::string(51, 'c')})
    expect_refused([&](Picture& p) { p.layers[1].components[0] = component; },
                   "cannot be a component of the layer depth");
  // EXR would take these channels for a colour and for a component.
  for (const char* name : {"R", "A", "light.R"})
    expect_refused([&](Picture& p) { p.layers.back().name = name; }, "cannot be a component");
  EXPECT_EQ(entries(), 0);
}

TEST_F(ImageTest, LongNamesOfLayersAreStored) {
  Picture picture = layered(2, 1);
  picture.layers[1].name = std::string(200, 'd'),
  picture.layers[1].components[0] = std::string(50, 'c');
  const Picture back = read_whole_good(written(picture, "a.exr"));
  EXPECT_TRUE(std::ranges::any_of(back.layers, [&](const Layer& layer) {
    return layer.name == picture.layers[1].name && layer.components == picture.layers[1].components;
  }));
}

}  // namespace
}  // namespace raio::core
