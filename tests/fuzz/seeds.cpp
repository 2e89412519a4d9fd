// Writes the seed inputs of the fuzzers for pictures, part files and .raio scenes: small files of
// many kinds, a folder per format. Usage: raio_fuzz_seeds FOLDER
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <png.h>

#include <cstdio>
#include <filesystem>
#include <vector>

#include "../jpeg_bytes.h"
#include "../rich_scene.h"
#include "io/image/codecs.h"
#include "io/raio/raio.h"
#include "render/part.h"

namespace raio::core::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 5;

Image sample() {
  Image image(kSide, kSide);
  for (int i = 0; i < kSide * kSide; ++i)
    image.pixels[i] = Rgb(float(i % 7) / 6, float(i % 3) / 2, float(i) / 24);
  return image;
}

Picture layered() {
  constexpr size_t kPixels = size_t(kSide) * kSide;
  return {sample(),
          Column<float>(kPixels, 0.5f),
          {{"depth", {"Z"}, Column<float>(kPixels, 7.25f)},
           {"id", {"I"}, Column<uint32_t>(kPixels, 3u)},
           {"normal", {"X", "Y", "Z"}, Column<float>(3 * kPixels, 0.6f)},
           {"samples", {""}, Column<uint32_t>(kPixels, 16u)}}};
}

void put(const fs::path& path, std::string_view bytes) {
  if (!write_file(path, bytes)) throw std::runtime_error("cannot write " + path.string());
}

void write_png(const fs::path& folder) {
  put(folder / "own.png", encode_png(sample(), {{"accel", "bvh"}, {"size", "5x5"}}).value());
  Picture picture = layered();
  picture.layers.clear();
  put(folder / "alpha.png", encode_png(picture, {}).value());
  const std::vector<uint16_t> pixels(4 * kSide * kSide, 0x4567);  // enough for all kinds
  for (const png_uint_32 format :
       {png_uint_32(PNG_FORMAT_GRAY), png_uint_32(PNG_FORMAT_GA), png_uint_32(PNG_FORMAT_RGBA),
        png_uint_32(PNG_FORMAT_LINEAR_RGB), png_uint_32(PNG_FORMAT_LINEAR_Y_ALPHA),
        png_uint_32(PNG_FORMAT_RGBA_COLORMAP)}) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = image.height = kSide;
    image.format = format;
    image.colormap_entries = 128;
    const std::vector<uint16_t> colors(size_t(4) * 128, 0x1234);
    png_image_write_to_file(&image, (folder / fmt::format("{}.png", format)).c_str(), 0,
                            pixels.data(), 0, colors.data());
  }
}

void write_jpeg(const fs::path& folder) {
  const std::string rows(size_t(3) * 20 * 20, 'a');
  for (const bool progressive : {false, true})
    put(folder / fmt::format("{}.jpg", progressive ? "progressive" : "baseline"),
        tests::jpeg_of(20, 20, rows, progressive));
  put(folder / "grey.jpg", tests::jpeg_of(20, 20, rows.substr(0, 400), false, true));
}

void write_exr(const fs::path& folder) {
  put(folder / "own.exr", encode_exr(sample(), {{"accel", "bvh"}, {"size", "5x5"}}).value());
  put(folder / "layers.exr", encode_exr(layered(), {}).value());
  const Image image = sample();
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression)
    for (const bool tiled : {false, true}) {
      Imf::Header header(kSide, kSide);
      header.compression() = Imf::Compression(compression);
      Imf::FrameBuffer frame;
      const float* first = &image.pixels[0].x;
      for (const char* name : {"R", "G", "B"}) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        frame.insert(name, Imf::Slice::Make(Imf::FLOAT, first++, header.dataWindow(), sizeof(Rgb)));
      }
      const auto path = folder / fmt::format("{}{}.exr", compression, tiled ? "-tiled" : "");
      if (tiled) {
        header.setTileDescription(Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
      } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(kSide);
      }
    }
}

// With 20 x 20 pixels: whole, and a shard.
void write_parts(const fs::path& folder) {
  const Scene scene;
  RenderOptions request;
  request.width = request.height = 20, request.samples = 3, request.soft_shadows = true;
  const RenderSettings options = resolve_options(request, scene);
  for (const uint32_t shards : {1u, 2u}) {
    Film film(options.width, options.height, 1, 8);
    for (size_t t = 0; t < film.tiles(); t += shards) {
      const Tile tile = film.tile(t);
      const auto pixels = size_t(tile.x1 - tile.x0) * size_t(tile.y1 - tile.y0);
      TileSamples samples;
      samples.samples = SampleSpan{0, 3};
      samples.rays.eye = 3 * pixels;
      samples.sums.assign(4 * pixels, int64_t(t) * 1000);
      film.replace(t, samples);
    }
    put(folder / fmt::format("{}.raio", shards),
        encode_part({settings_of(scene, options), 0, shards}, film));
  }
}

void write_scenes(const fs::path& folder) {
  Scene least;
  least.materials.emplace_back();
  put(folder / "least.raio", encode_raio_scene(least));
  put(folder / "random.raio", encode_raio_scene(tests::random_scene(4, 1)));
  put(folder / "rich.raio", encode_raio_scene(tests::rich_scene()));
  put(folder / "copies.raio", encode_raio_scene(tests::nested_scene()));
}

void write_all(const fs::path& folder) {
  for (const char* format : {"png", "jpeg", "exr", "pfm", "ppm", "hdr", "part", "scene_file"})
    fs::create_directories(folder / format);
  write_png(folder / "png");
  write_jpeg(folder / "jpeg");
  write_exr(folder / "exr");
  write_parts(folder / "part");
  write_scenes(folder / "scene_file");
  put(folder / "pfm/own.pfm", encode_pfm(sample()));
  put(folder / "pfm/grey.pfm", std::string("Pf\n1 2\n2.5\n\0\0\x80\x3e\0\0\x80\x3f", 19));
  const std::string head = "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n";
  put(folder / "hdr/flat.hdr", head + "-Y 2 +X 1\n\x80\x40\xff\x81\x05\x06\x07\x7f");
  put(folder / "hdr/runs.hdr", head + std::string("-Y 1 +X 8\n\x02\x02\0\x08\x88\x80\x88\x10\x83"
                                                  "\x10\x05\x09\x08\x07\x06\x05\x88\x81",
                                                  28));
  put(folder / "ppm/own.ppm", encode_ppm(sample()));
  put(folder / "ppm/2.ppm", "P2\n2 1 # grey\n4\n1 4");
  put(folder / "ppm/3.ppm", "P3 1 2 255 4 0 255\n1 1 1");
  put(folder / "ppm/5.ppm", "P5 1 1 65535\n\xff\xff");
}

}  // namespace
}  // namespace raio::core::fuzz

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("usage: raio_fuzz_seeds FOLDER");
  raio::core::fuzz::write_all(argv[1]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
