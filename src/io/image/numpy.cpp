// NumPy's arrays: NPY, "A Simple File Format for NumPy Arrays" (NEP 1), version 1.0, and NPZ, a zip
// archive of such files, through minizip, which receives compressed data.
#include <fmt/format.h>
#include <minizip/zip.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <exception>
#include <functional>
#include <new>
#include <utility>

#include "io/image/codecs.h"
#include "io/image/deflate.h"

namespace raio::core {

namespace {

/// A file under construction: its first bytes, then the numbers from `first` to `end` provided by
/// `copy`, in file order.
struct NpyArray {
  std::string name, header;
  size_t numbers, number_bytes;
  std::function<void(size_t first, size_t end, uint8_t* out)> copy;

  size_t bytes() const { return header.size() + numbers * number_bytes; }
};

/// `components`: 0 for an array with two dimensions. `type` is NumPy's letter for a number type,
/// with its size in bytes.
std::string npy_header(const Image& image, size_t components, std::string_view type) {
  constexpr char kByteOrder = std::endian::native == std::endian::little ? '<' : '>';
  const std::string third = components > 0 ? fmt::format(", {}", components) : "";
  std::string text =
      fmt::format("{{'descr': '{}{}', 'fortran_order': False, 'shape': ({}, {}{}), }}", kByteOrder,
                  type, image.height, image.width, third);
  // The numbers start at a multiple of 64 bytes. A 16-bit size, little-endian, precedes the text.
  constexpr size_t kBefore = 10, kAligned = 64;
  const size_t whole = (kBefore + text.size() + 1 + kAligned - 1) / kAligned * kAligned;
  text.resize(whole - kBefore - 1, ' ');
  text += '\n';
  return std::string("\x93NUMPY\x01\0", 8) + char(text.size() & 255) + char(text.size() >> 8) +
         text;
}

NpyArray rgba_array(const PictureView& picture) {
  constexpr size_t kComponents = 4;
  const Image& image = picture.color;
  const auto copy = [&image, alpha = picture.alpha](size_t first, size_t end, uint8_t* out) {
    for (size_t i = first / kComponents; i < end / kComponents; ++i) {
      const Rgb& c = image.pixels[i];
      const float rgba[] = {c.x, c.y, c.z, alpha.empty() ? 1 : alpha[i]};
      out = std::copy_n(reinterpret_cast<const uint8_t*>(rgba), sizeof rgba, out);
    }
  };
  return {"rgba", npy_header(image, kComponents, "f4"), kComponents * image.pixels.size(),
          sizeof(float), copy};
}

size_t dimensions_of(const Layer& layer) {
  return layer.components.size() == 1 ? 0 : layer.components.size();
}

NpyArray layer_array(const Image& image, const Layer& layer) {
  return std::visit(
      [&]<class T>(const Column<T>& values) {
        const auto copy = [from = values.data()](size_t first, size_t end, uint8_t* out) {
          std::memcpy(out, from + first, (end - first) * sizeof(T));
        };
        const char* const type = std::is_same_v<T, float> ? "f4" : "u4";
        return NpyArray{layer.name, npy_header(image, dimensions_of(layer), type), values.size(),
                        sizeof(T), copy};
      },
      layer.values);
}

/// The layer with the rounding errors of this one's floats; null if there is none.
const Layer* low_of(const Layer& layer, std::span<const Layer> layers) {
  const auto low = std::ranges::find(layers, layer.name + std::string(kLowLayer), &Layer::name);
  if (low == layers.end()) return nullptr;
  const auto* const values = std::get_if<Column<float>>(&layer.values);
  const auto* const rest = std::get_if<Column<float>>(&low->values);
  return values && rest && values->size() == rest->size() ? &*low : nullptr;
}

/// The sums of a layer and its rounding errors, as doubles.
NpyArray wide_array(const Image& image, const Layer& layer, const Layer& low) {
  const auto floats = [](const Layer& l) { return std::span(std::get<Column<float>>(l.values)); };
  const auto copy = [a = floats(layer), b = floats(low)](size_t first, size_t end, uint8_t* out) {
    for (size_t i = first; i < end; ++i) {
      const double sum = double(a[i]) + double(b[i]);
      out = std::copy_n(reinterpret_cast<const uint8_t*>(&sum), sizeof sum, out);
    }
  };
  return {layer.name, npy_header(image, dimensions_of(layer), "f8"), floats(layer).size(),
          sizeof(double), copy};
}

/// In bands; the first one starts with the header.
Deflated deflate(const NpyArray& array) {
  constexpr size_t kBand = 1 << 16;  // numbers, whole pixels of "rgba"
  const size_t bands = (array.numbers - 1) / kBand + 1;
  return deflate_bands(bands, kCrc32, [&](size_t band) {
    const size_t first = band * kBand, end = std::min(first + kBand, array.numbers);
    std::vector<uint8_t> bytes;
    if (band == 0) bytes.assign(array.header.begin(), array.header.end());
    const size_t before = bytes.size();
    bytes.resize(before + (end - first) * array.number_bytes);
    array.copy(first, end, bytes.data() + before);
    return bytes;
  });
}

/// A zip archive in memory.
class Zip {
 public:
  Zip() {
    zlib_filefunc64_def calls{};
    calls.zopen64_file = [](void* zip, const void*, int) { return zip; };
    calls.zread_file = [](void*, void*, void*, uLong) -> uLong {
      return 0;
    };  // for existing archives
    calls.zwrite_file = [](void* zip, void*, const void* bytes, uLong count) {
      return static_cast<Zip*>(zip)->write(static_cast<const char*>(bytes), count);
    };
    calls.ztell64_file = [](void* zip, void*) {
      return ZPOS64_T(static_cast<const Zip*>(zip)->position_);
    };
    calls.zseek64_file = [](void* zip, void*, ZPOS64_T offset, int origin) {
      return static_cast<Zip*>(zip)->seek(offset, origin);
    };
    calls.zclose_file = [](void*, void*) { return 0; };
    calls.zerror_file = [](void*, void*) { return 0; };
    calls.opaque = this;
    file_ = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &calls);
    if (!file_) throw std::bad_alloc();
  }
  Zip(const Zip&) = delete;
  Zip& operator=(const Zip&) = delete;
  ~Zip() { (void)close(); }

  /// Whether there was enough memory, here and below.
  bool add(const std::string& name, const Deflated& deflated) {
    zip_fileinfo info{};
    info.dosDate = (1 << 5 | 1) << 16;  // 1980-01-01, so that the same picture has the same bytes
    constexpr int kRaw = 1, kLevel = 1, kMadeOnDos = 0, kNoFlags = 0;
    // Longer ones need other headers, even if only compression makes them longer.
    constexpr uint64_t kLong = 0xf000'0000;
    bool added = zipOpenNewFileInZip4_64(file_, name.c_str(), &info, nullptr, 0, nullptr, 0,
                                         nullptr, Z_DEFLATED, kLevel, kRaw, -MAX_WBITS,
                                         DEF_MEM_LEVEL, Z_DEFAULT_STRATEGY, nullptr, 0, kMadeOnDos,
                                         kNoFlags, deflated.bytes >= kLong) == ZIP_OK;
    if (!added) return false;
    for (const std::string& band : deflated.bands)
      added &= zipWriteInFileInZip(file_, band.data(), unsigned(band.size())) == ZIP_OK;
    return zipCloseFileInZipRaw64(file_, deflated.bytes, deflated.check_sum) == ZIP_OK && added;
  }

  bool close() {
    zipFile file = std::exchange(file_, nullptr);
    return file && zipClose(file, nullptr) == ZIP_OK;
  }

  std::string take() { return std::move(bytes_); }

 private:
  /// Called from C, which exceptions must not cross.
  uLong write(const char* bytes, uLong count) noexcept try {
    if (position_ + count > bytes_.size()) bytes_.resize(position_ + count);
    std::copy_n(bytes, count, bytes_.data() + position_);
    position_ += count;
    return count;
  } catch (const std::exception&) {
    return 0;
  }

  long seek(size_t offset, int origin) {
    if (origin == ZLIB_FILEFUNC_SEEK_CUR) offset += position_;
    if (origin == ZLIB_FILEFUNC_SEEK_END) offset += bytes_.size();
    position_ = offset;
    return 0;
  }

  std::string bytes_;
  size_t position_ = 0;
  zipFile file_ = nullptr;
};

}  // namespace

Decoded<std::string> encode_npz(const PictureView& picture) {
  Zip zip;
  const auto add = [&](const NpyArray& array) {
    return zip.add(array.name + ".npy", deflate(array));
  };
  bool added = add(rgba_array(picture));
  const std::span layers = picture.layers;
  for (const Layer& layer : layers) {
    const auto is_rest = [&](const Layer& other) { return low_of(other, layers) == &layer; };
    if (const Layer* const low = low_of(layer, layers))
      added &= add(wide_array(picture.color, layer, *low));
    else if (std::ranges::none_of(layers, is_rest))
      added &= add(layer_array(picture.color, layer));
  }
  if (!zip.close() || !added) return std::unexpected("not enough memory");
  return zip.take();
}

std::string encode_npy(const PictureView& picture) {
  const NpyArray array = rgba_array(picture);
  std::string bytes = array.header;
  bytes.resize(array.bytes());
  array.copy(0, array.numbers, reinterpret_cast<uint8_t*>(bytes.data() + array.header.size()));
  return bytes;
}

}  // namespace raio::core
