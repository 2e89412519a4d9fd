// NPZ and NPY, parsed as specified and by NumPy itself.
#include <minizip/unzip.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <regex>

#include "image_files.h"
#include "noise.h"
#include "render/render.h"

namespace raio::core {
namespace {

using testing::MatchesRegex;
using tests::ImageTest;
using tests::layered;
using tests::noise;

constexpr std::pair<int, int> kSizes[] = {{1, 1}, {7, 5}, {301, 203}};

/// The files in a zip archive. Their check sums are held against their contents.
std::map<std::string, std::string> unzipped(const std::filesystem::path& path) {
  std::map<std::string, std::string> files;
  unzFile zip = unzOpen64(path.c_str());
  EXPECT_NE(zip, nullptr);
  for (int found = unzGoToFirstFile(zip); found == UNZ_OK; found = unzGoToNextFile(zip)) {
    unz_file_info64 info{};
    char name[300] = "";
    EXPECT_EQ(unzGetCurrentFileInfo64(zip, &info, name, sizeof name, nullptr, 0, nullptr, 0),
              UNZ_OK);
    EXPECT_EQ(info.compression_method, Z_DEFLATED);
    std::string& bytes = files[name];
    bytes.resize(info.uncompressed_size);
    EXPECT_EQ(unzOpenCurrentFile(zip), UNZ_OK);
    EXPECT_EQ(unzReadCurrentFile(zip, bytes.data(), unsigned(bytes.size())), int(bytes.size()));
    char more = 0;
    EXPECT_EQ(unzReadCurrentFile(zip, &more, 1), 0);
    EXPECT_EQ(unzCloseCurrentFile(zip), UNZ_OK);
  }
  unzClose(zip);
  return files;
}

/// The data of an NPY of that shape; its header must follow NEP 1.
std::string values_of(const std::string& npy, const std::string& type, const std::string& shape) {
  if (npy.size() < 10) return ADD_FAILURE() << npy.size() << " bytes", "";
  EXPECT_EQ(npy.substr(0, 8), std::string("\x93NUMPY\x01\0", 8));
  const size_t size = uint8_t(npy[8]) + 256 * uint8_t(npy[9]);
  EXPECT_EQ((10 + size) % 64, 0);
  const std::string header = npy.substr(10, size);
  const std::string expected =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  EXPECT_EQ(header.substr(0, expected.size()), expected);
  EXPECT_EQ(header.find_first_not_of(' ', expected.size()), header.size() - 1);
  EXPECT_EQ(header.back(), '\n');
  return npy.substr(10 + size);
}

std::string bytes_of(const auto& column) {
  return {reinterpret_cast<const char*>(column.data()), column.size() * sizeof column[0]};
}

std::string rgba_of(const Picture& picture) {
  std::vector<float> values;
  for (size_t i = 0; i < picture.color.pixels.size(); ++i) {
    const Rgb& c = picture.color.pixels[i];
    values.insert(values.end(), {c.x, c.y, c.z, picture.alpha.empty() ? 1 : picture.alpha[i]});
  }
  return bytes_of(values);
}

TEST_F(ImageTest, NpyIsRgba) {
  for (const auto& [width, height] : kSizes)
    for (const bool alpha : {false, true}) {
      Picture picture = layered(width, height);
      picture.layers.clear();
      if (!alpha) picture.alpha.clear();
      const std::string shape = std::to_string(height) + ", " + std::to_string(width) + ", 4";
      EXPECT_EQ(values_of(written(picture, "a.npy"), "<f4", shape), rgba_of(picture));
    }
}

TEST_F(ImageTest, NpzHasAnArrayForEachLayer) {
  for (const auto& [width, height] : kSizes) {
    const Picture picture = layered(width, height);
    const std::string bytes = written(picture, "a.npz");
    const auto files = unzipped(file("a.npz"));
    EXPECT_EQ(files.size(), 1 + picture.layers.size());
    const std::string shape = std::to_string(height) + ", " + std::to_string(width);
    EXPECT_EQ(values_of(files.at("rgba.npy"), "<f4", shape + ", 4"), rgba_of(picture));
    for (const Layer& layer : picture.layers) {
      SCOPED_TRACE(layer.name);
      const size_t components = layer.components.size();
      const std::string all = components == 1 ? shape : shape + ", " + std::to_string(components);
      const std::string type = layer.values.index() == 0 ? "<f4" : "<u4";
      EXPECT_EQ(values_of(files.at(layer.name + ".npy"), type, all),
                std::visit([](const auto& values) { return bytes_of(values); }, layer.values));
    }
    Executor(1).run([&] { EXPECT_EQ(written(picture, "b.npz"), bytes); });
  }
}

TEST_F(ImageTest, NpzIsCompressed) {
  Picture picture;
  picture.color = Image(1000, 1000);
  picture.layers.push_back({"depth", {"Z"}, Column<float>(1'000'000, 2.5f)});
  EXPECT_LT(written(picture, "a.npz").size(), 20'000'000 / 100);
}

TEST_F(ImageTest, NumpyLoadsNpzAndNpy) {
  // Debian's has the package; another one may come first.
  std::string python = "/usr/bin/python3";
  const auto has_numpy = [&] {
    return std::system((python + " -c 'import numpy' 2>/dev/null").c_str()) == 0;
  };
  if (!has_numpy()) python = "python3";
  if (!has_numpy()) GTEST_SKIP() << "there is no Python with NumPy";
  const Picture picture = layered(301, 203);
  written(picture, "a.npz");
  written(picture.color, "a.npy");
  put(file("rgba"), rgba_of(picture));
  Picture opaque;
  opaque.color = picture.color;
  put(file("opaque"), rgba_of(opaque));
  std::string script = R"(
import numpy
def same(array, name, dtype, shape):
    with open(name, 'rb') as file:
        assert array.tobytes() == file.read(), name
    assert array.dtype == dtype and array.shape == shape, (name, array.dtype, array.shape)
same(numpy.load('a.npy'), 'opaque', 'float32', (203, 301, 4))
arrays = numpy.load('a.npz')
same(arrays['rgba'], 'rgba', 'float32', (203, 301, 4))
)";
  for (const Layer& layer : picture.layers) {
    put(file(layer.name),
        std::visit([](const auto& values) { return bytes_of(values); }, layer.values));
    const size_t components = layer.components.size();
    const std::string name = "'" + layer.name + "'";
    script += "same(arrays[" + name + "], " + name + ", " +
              (layer.values.index() == 0 ? "'float32'" : "'uint32'") + ", (203, 301" +
              (components > 1 ? ", " + std::to_string(components) : "") + "))\n";
  }
  script += "assert len(arrays.files) == " + std::to_string(1 + picture.layers.size()) + "\n";
  put(file("check.py"), script);
  const std::string command =
      "cd '" + folder().string() + "' && " + python + " check.py >errors 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << get(file("errors"));
}

}  // namespace
}  // namespace raio::core
