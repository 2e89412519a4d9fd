// OpenEXR through its C++ library, in memory.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <map>
#include <stdexcept>

#include "io/image/codecs.h"

namespace raio::core {

namespace {

static_assert(sizeof(Rgb) == 3 * sizeof(float), "channels are read and written in place");

class MemoryWriter : public Imf::OStream {
 public:
  MemoryWriter() : OStream("memory") {}

  void write(const char bytes[], int count) override {
    if (position_ + size_t(count) > bytes_.size()) bytes_.resize(position_ + size_t(count));
    std::memcpy(bytes_.data() + position_, bytes, size_t(count));
    position_ += size_t(count);
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t position_ = 0;
};

class MemoryReader : public Imf::IStream {
 public:
  explicit MemoryReader(std::string_view bytes) : IStream("memory"), bytes_(bytes) {}

  bool read(char bytes[], int count) override {
    if (count < 0 || position_ > bytes_.size() || size_t(count) > bytes_.size() - position_)
      throw std::runtime_error("the file ends early");
    std::memcpy(bytes, bytes_.data() + position_, size_t(count));
    position_ += size_t(count);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  uint64_t position_ = 0;
};

/// Checks the headers before the library sees them, since it allocates memory as they say. EXR is a
/// sequence of attributes (name, type, size, value); names and types end with a zero byte, a header
/// with an empty name.
class HeaderCheck {
 public:
  explicit HeaderCheck(std::string_view bytes) : bytes_(bytes), left_(bytes) {}

  /// Returns the error, or nothing.
  std::string problem() {
    constexpr uint32_t kDeepFile = 1 << 11, kManyParts = 1 << 12;
    if (left_.size() < 8) return "the file ends early";
    const uint32_t version = number(left_, 4);
    if (version & kDeepFile) return "it has deep data, which is not supported";
    left_.remove_prefix(8);
    std::string found = header();
    if (!(version & kManyParts)) return found;
    while (found.empty() && !left_.starts_with('\0')) found = header();
    return found;
  }

 private:
  static uint32_t number(std::string_view bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 4; i-- > 0;) value = value << 8 | uint8_t(bytes[at + i]);
    return value;
  }

  /// The bytes per pixel of a channel list: a name with a zero byte, the type, four irrelevant
  /// bytes, the sampling steps in x and y. Steps of zero or less are left to the library.
  static double pixel_bytes(std::string_view list) {
    double bytes = 0;
    for (;;) {
      const size_t end = list.find('\0');
      if (end == 0 || end == std::string_view::npos || list.size() - end < 17) return bytes;
      list.remove_prefix(end + 1);
      const double samples = double(number(list, 8)) * double(number(list, 12));
      bytes += (number(list, 0) == Imf::HALF ? 2 : 4) / std::max(samples, 1.0);
      list.remove_prefix(16);
    }
  }

  std::string header() {
    long long width = 0, height = 0;
    uint64_t tile = 0;
    int compression = 0;
    double bytes_a_pixel = 0;
    for (;;) {
      if (left_.starts_with('\0')) break;
      const size_t name_end = left_.find('\0');
      const size_t type_end = left_.find('\0', name_end + 1);
      if (name_end == std::string_view::npos || type_end == std::string_view::npos ||
          left_.size() - type_end < 5)
        return "the header ends early";
      const std::string_view name = left_.substr(0, name_end);
      const size_t size = number(left_, type_end + 1);
      left_.remove_prefix(type_end + 5);
      if (size > left_.size()) return fmt::format("attribute {} is longer than the file", name);
      if (name == "dataWindow" && size == 16) {
        width = (long long)(int32_t(number(left_, 8)))-int32_t(number(left_, 0)) + 1;
        height = (long long)(int32_t(number(left_, 12)))-int32_t(number(left_, 4)) + 1;
      }
      if (name == "tiles" && size == 9) tile = uint64_t(number(left_, 0)) * number(left_, 4);
      if (name == "compression" && size == 1) compression = uint8_t(left_[0]);
      if (name == "channels") bytes_a_pixel = pixel_bytes(left_.substr(0, size));
      left_.remove_prefix(size);
    }
    left_.remove_prefix(1);
    if (std::string wrong = size_problem(width, height); !wrong.empty()) return wrong;
    if (tile > uint64_t(kMaxPixels)) return "tiles of an impossible size";
    // Compression does not exceed deflate's 1032 to one, except that PXR24 first drops a quarter of
    // the bits and DWA nearly all of an even block of 8 x 8 pixels.
    const bool dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
    const double most = (dwa ? 1400.0 * 64 : 1400.0) * double(bytes_.size());
    if (double(width) * double(height) * std::max(bytes_a_pixel, 2.0) > most)
      return fmt::format("too short for {} x {} pixels", width, height);
    return {};
  }

  std::string_view bytes_, left_;
};

/// Numbers read or written in place, one per `stride` values.
template <class T>
void add_slice(Imf::FrameBuffer& frame, const std::string& name, const T* first, size_t stride,
               const Imath::Box2i& window) {
  const Imf::PixelType type = std::is_same_v<T, float> ? Imf::FLOAT : Imf::UINT;
  const size_t pixel = stride * sizeof(T), row = size_t(window.max.x - window.min.x + 1) * pixel;
  frame.insert(name, Imf::Slice::Make(type, first, window, pixel, row));
}

/// Adds everything in the picture.
void add_picture(Imf::FrameBuffer& frame, const PictureView& picture, const Imath::Box2i& window,
                 bool grey) {
  const Rgb* const pixels = picture.color.pixels.data();
  add_slice(frame, grey ? "Y" : "R", &pixels->x, 3, window);
  if (!grey) {
    add_slice(frame, "G", &pixels->y, 3, window);
    add_slice(frame, "B", &pixels->z, 3, window);
  }
  if (!picture.alpha.empty()) add_slice(frame, "A", picture.alpha.data(), 1, window);
  for (const Layer& layer : picture.layers)
    for (size_t c = 0; c < layer.components.size(); ++c) {
      const std::string& component = layer.components[c];
      const std::string channel = component.empty() ? layer.name : layer.name + "." + component;
      std::visit(
          [&](const auto& values) {
            add_slice(frame, channel, values.data() + c, layer.components.size(), window);
          },
          layer.values);
    }
}

bool is_whole(const Imf::Channel* channel) {
  return channel && channel->xSampling == 1 && channel->ySampling == 1;
}

/// Whether the picture is grey, or an error that names the channels if they are neither R, G, B nor
/// Y.
Decoded<bool> is_grey(const Imf::ChannelList& channels) {
  const auto whole = [&](const char* name) { return is_whole(channels.findChannel(name)); };
  if (whole("R") && whole("G") && whole("B")) return false;
  if (whole("Y") && !channels.findChannel("RY") && !channels.findChannel("BY")) return true;
  std::vector<std::string> names;
  for (auto i = channels.begin(); i != channels.end(); ++i) names.emplace_back(i.name());
  return std::unexpected(
      fmt::format("expected the EXR channels R, G and B, or Y, at full resolution; found {}",
                  fmt::join(names, ", ")));
}

/// Finds the layers besides colours and alpha, with values of `pixels` pixels yet to be read.
Decoded<std::vector<Layer>> find_layers(const Imf::ChannelList& channels, bool grey,
                                        size_t pixels) {
  const std::string_view colors = grey ? "YA" : "RGBA";
  const auto color = [](std::string_view among, const std::string& name) {
    return name.size() == 1 ? among.find(name) : std::string_view::npos;
  };
  using Key = std::pair<std::string, bool>;  // the name, and whether its numbers are integers
  std::map<Key, std::vector<std::string>> found;
  size_t count = 0;
  for (auto i = channels.begin(); i != channels.end(); ++i, ++count) {
    const std::string name = i.name();
    if (!is_whole(&i.channel()))
      return std::unexpected(fmt::format("the EXR channel {} is not at full resolution", name));
    if (color(colors, name) != std::string_view::npos) continue;
    const size_t dot = name.ends_with('.') ? std::string_view::npos : name.rfind('.');
    const std::string component = dot == std::string_view::npos ? "" : name.substr(dot + 1);
    found[{name.substr(0, dot), i.channel().type == Imf::UINT}].push_back(component);
  }
  if (count * pixels > kMaxNumbers)
    return std::unexpected(fmt::format("{} channels of {} pixels are more than {} numbers", count,
                                       pixels, kMaxNumbers));
  std::vector<Layer> layers;
  for (auto& [key, components] : found) {
    std::ranges::sort(components, {},
                      [&](const std::string& c) { return std::pair(color("RGBA", c), c); });
    const size_t numbers = pixels * components.size();
    Layer& layer = layers.emplace_back(key.first, std::move(components));
    if (key.second)
      layer.values = Column<uint32_t>(numbers);
    else
      layer.values = Column<float>(numbers);
  }
  return layers;
}

/// Reads the colours and, if wanted, the rest.
Decoded<Picture> read_exr(std::string_view bytes, bool all) try {
  if (const std::string problem = HeaderCheck(bytes).problem(); !problem.empty())
    return std::unexpected("broken EXR: " + problem);
  MemoryReader memory(bytes);
  Imf::InputFile file(memory);
  const Imath::Box2i window = file.header().dataWindow();
  const Imf::ChannelList& channels = file.header().channels();
  const auto grey = is_grey(channels);
  if (!grey) return std::unexpected(grey.error());
  const long long width = (long long)(window.max.x) - window.min.x + 1;
  const long long height = (long long)(window.max.y) - window.min.y + 1;
  if (const std::string problem = size_problem(width, height); !problem.empty())
    return std::unexpected("broken EXR: " + problem);

  Picture picture;
  const auto pixels = size_t(width * height);
  if (all) {
    auto layers = find_layers(channels, *grey, pixels);
    if (!layers) return std::unexpected(layers.error());
    picture.layers = std::move(*layers);
    if (channels.findChannel("A")) picture.alpha.resize(pixels);
  }
  picture.color = Image(int(width), int(height));
  Imf::FrameBuffer frame;
  add_picture(frame, picture, window, *grey);
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  if (*grey)
    for (Rgb& pixel : picture.color.pixels) pixel = Rgb(pixel.x);
  return picture;
} catch (const std::exception& error) {
  return std::unexpected(fmt::format("broken EXR: {}", error.what()));
}

}  // namespace

Decoded<void> check_exr() { return {}; }

Decoded<std::string> encode_exr(const PictureView& picture, const Metadata& metadata) try {
  const Image& image = picture.color;
  Imf::Header header(image.width, image.height, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                     Imf::ZIP_COMPRESSION);
  // Much faster than the library's default, and hardly larger.
  header.zipCompressionLevel() = 1;
  Imf::FrameBuffer frame;
  add_picture(frame, picture, header.dataWindow(), false);
  for (auto i = frame.begin(); i != frame.end(); ++i)
    header.channels().insert(i.name(), Imf::Channel(i.slice().type));
  if (picture.dpi > 0) Imf::addXDensity(header, picture.dpi);
  for (const auto& [key, value] : metadata)
    header.insert(metadata_name(key), Imf::StringAttribute(value));
  MemoryWriter memory;
  {
    Imf::OutputFile file(memory, header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }
  return memory.take();
} catch (const std::exception& error) {
  return std::unexpected(error.what());
}

Decoded<Image> decode_exr(std::string_view bytes) {
  auto picture = read_exr(bytes, false);
  if (!picture) return std::unexpected(picture.error());
  return std::move(picture->color);
}

Decoded<Picture> decode_exr_picture(std::string_view bytes) { return read_exr(bytes, true); }

Decoded<Metadata> exr_metadata(std::string_view bytes) try {
  if (const std::string problem = HeaderCheck(bytes).problem(); !problem.empty())
    return std::unexpected("broken EXR: " + problem);
  MemoryReader memory(bytes);
  const Imf::InputFile file(memory);
  Metadata metadata;
  for (auto i = file.header().begin(); i != file.header().end(); ++i)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
      add_metadata(metadata, i.name(), text->value());
  return metadata;
} catch (const std::exception& error) {
  return std::unexpected(fmt::format("broken EXR: {}", error.what()));
}

}  // namespace raio::core
