// OpenEXR by its C++ library, on memory.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstring>
#include <exception>
#include <stdexcept>

#include "io/image/codecs.h"

namespace raio {

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

/// A look at the headers before the library sees them: it asks for memory as they say. EXR is a
/// sequence of attributes (name, type, size, value), names and types ended by a zero byte, a header
/// by an empty name.
class HeaderCheck {
 public:
  explicit HeaderCheck(std::string_view bytes) : bytes_(bytes), left_(bytes) {}

  /// What is wrong, or nothing.
  std::string problem() {
    constexpr uint32_t kDeepFile = 1 << 11, kManyParts = 1 << 12;
    if (left_.size() < 8) return "the file ends early";
    const uint32_t version = number(4);
    if (version & kDeepFile) return "it holds deep data, which is not read";
    left_.remove_prefix(8);
    std::string found = header();
    if (!(version & kManyParts)) return found;
    while (found.empty() && !left_.starts_with('\0')) found = header();
    return found;
  }

 private:
  uint32_t number(size_t at) const {
    uint32_t value = 0;
    for (size_t i = 4; i-- > 0;) value = value << 8 | uint8_t(left_[at + i]);
    return value;
  }

  std::string header() {
    long long width = 0, height = 0;
    uint64_t tile = 0;
    int compression = 0;
    for (;;) {
      if (left_.starts_with('\0')) break;
      const size_t name_end = left_.find('\0');
      const size_t type_end = left_.find('\0', name_end + 1);
      if (name_end == std::string_view::npos || type_end == std::string_view::npos ||
          left_.size() - type_end < 5)
        return "the header ends early";
      const std::string_view name = left_.substr(0, name_end);
      const size_t size = number(type_end + 1);
      left_.remove_prefix(type_end + 5);
      if (size > left_.size()) return fmt::format("attribute {} is longer than the file", name);
      if (name == "dataWindow" && size == 16) {
        width = (long long)(int32_t(number(8)))-int32_t(number(0)) + 1;
        height = (long long)(int32_t(number(12)))-int32_t(number(4)) + 1;
      }
      if (name == "tiles" && size == 9) tile = uint64_t(number(0)) * number(4);
      if (name == "compression" && size == 1) compression = uint8_t(left_[0]);
      left_.remove_prefix(size);
    }
    left_.remove_prefix(1);
    if (std::string wrong = size_problem(width, height); !wrong.empty()) return wrong;
    if (tile > uint64_t(kMaxPixels)) return "tiles of an impossible size";
    // A pixel has two bytes or more. No compression gets far beyond deflate's 1032 to one, but that
    // PXR24 drops a quarter of the bits first and DWA nearly all of an even block of 8 x 8 pixels.
    const bool dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
    const long long pixels_per_byte = dwa ? 700 * 64 : 700;
    if (width * height / pixels_per_byte > (long long)(bytes_.size()))
      return fmt::format("too short for {} x {} pixels", width, height);
    return {};
  }

  std::string_view bytes_, left_;
};

void add_slices(Imf::FrameBuffer& frame, const Rgb* pixels, const Imath::Box2i& window, bool grey) {
  const size_t row = size_t(window.max.x - window.min.x + 1) * sizeof(Rgb);
  const auto add = [&](const char* name, const float* first) {
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, first, window, sizeof(Rgb), row));
  };
  if (grey) return add("Y", &pixels->x);
  add("R", &pixels->x);
  add("G", &pixels->y);
  add("B", &pixels->z);
}

/// Whether the picture is grey, or an error that names the channels when they are no R, G, B and no
/// Y.
Decoded<bool> is_grey(const Imf::ChannelList& channels) {
  const auto whole = [&](const char* name) {
    const Imf::Channel* channel = channels.findChannel(name);
    return channel && channel->xSampling == 1 && channel->ySampling == 1;
  };
  if (whole("R") && whole("G") && whole("B")) return false;
  if (whole("Y") && !channels.findChannel("RY") && !channels.findChannel("BY")) return true;
  std::vector<std::string> names;
  for (auto i = channels.begin(); i != channels.end(); ++i) names.emplace_back(i.name());
  return std::unexpected(
      fmt::format("expected the EXR channels R, G and B, or Y, at full resolution; found {}",
                  fmt::join(names, ", ")));
}

}  // namespace

Decoded<std::string> encode_exr(const Image& image, const Metadata& metadata) try {
  Imf::Header header(image.width, image.height, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                     Imf::ZIP_COMPRESSION);
  // A good deal faster than the library's own choice, and hardly larger.
  header.zipCompressionLevel() = 1;
  for (const char* channel : {"R", "G", "B"})
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  for (const auto& [key, value] : metadata)
    header.insert(metadata_name(key), Imf::StringAttribute(value));
  Imf::FrameBuffer frame;
  add_slices(frame, image.pixels.data(), header.dataWindow(), false);
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

Decoded<Image> decode_exr(std::string_view bytes) try {
  if (const std::string problem = HeaderCheck(bytes).problem(); !problem.empty())
    return std::unexpected("broken EXR: " + problem);
  MemoryReader memory(bytes);
  Imf::InputFile file(memory);
  const Imath::Box2i window = file.header().dataWindow();
  const auto grey = is_grey(file.header().channels());
  if (!grey) return std::unexpected(grey.error());
  const long long width = (long long)(window.max.x) - window.min.x + 1;
  const long long height = (long long)(window.max.y) - window.min.y + 1;
  if (const std::string problem = size_problem(width, height); !problem.empty())
    return std::unexpected("broken EXR: " + problem);

  Image image{int(width), int(height)};
  Imf::FrameBuffer frame;
  add_slices(frame, image.pixels.data(), window, *grey);
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  if (*grey)
    for (Rgb& pixel : image.pixels) pixel = Rgb(pixel.x);
  return image;
} catch (const std::exception& error) {
  return std::unexpected(fmt::format("broken EXR: {}", error.what()));
}

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

}  // namespace raio
