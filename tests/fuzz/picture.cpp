// Pictures, of the format that the seeds are of, and their settings: whatever the bytes, a reason
// in one line, or a picture that survives the way through a file to the last bit.
#include <zlib.h>

#include <cstring>
#include <string>

#include "io/image/codecs.h"
#include "render/provenance.h"
#include "require.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

namespace raio::core::fuzz {
namespace {

uint32_t big_endian(const uint8_t* p) {
  return uint32_t(p[0]) << 24 | uint32_t(p[1]) << 16 | uint32_t(p[2]) << 8 | p[3];
}

/// Makes the check sums of PNG's chunks right, so that a change gets past them.
void mend_check_sums(uint8_t* data, size_t size) {
  constexpr size_t kSignature = 8, kAround = 12;
  for (size_t at = kSignature; at + kAround <= size;) {
    const size_t length = big_endian(data + at);
    if (length > size - at - kAround) return;
    const uint8_t* const type = data + at + 4;
    const auto sum = uint32_t(crc32_z(0, type, length + 4));
    for (size_t i = 0; i < 4; ++i) data[at + 8 + length + i] = uint8_t(sum >> (24 - 8 * i));
    at += kAround + length;
  }
}

}  // namespace
}  // namespace raio::core::fuzz

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  const size_t mutated = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 != 0 && mutated > 1 && std::memcmp(data, "\x89P", 2) == 0)
    raio::core::fuzz::mend_check_sums(data, mutated);
  return mutated;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raio::core;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (const auto settings = decode_metadata(bytes))
    (void)options_from(*settings);
  else
    fuzz::require(!settings.error().empty(), "an error has a reason");
  const auto image = decode_image(bytes);
  const auto picture = decode_picture(bytes);
  if (picture) {
    fuzz::require(image && image->pixels.size() == picture->color.pixels.size(),
                  "what has a picture has an image");
    for (const Layer& layer : picture->layers)
      fuzz::require(std::visit([](const auto& values) { return values.size(); }, layer.values) ==
                        layer.components.size() * image->pixels.size(),
                    "a layer has its numbers");
  } else {
    fuzz::require(!picture.error().empty(), "an error has a reason");
  }
  if (!image) return fuzz::require(!image.error().empty(), "an error has a reason"), 0;
  fuzz::require(image->width > 0 && image->height > 0 &&
                    image->pixels.size() == size_t(image->width) * size_t(image->height),
                "a picture has its pixels");
  if (image->pixels.size() > 10'000) return 0;
  const auto again = decode_pfm(encode_pfm(*image));
  fuzz::require(again && again->width == image->width &&
                    std::memcmp(again->pixels.data(), image->pixels.data(),
                                image->pixels.size() * sizeof(Rgb)) == 0,
                "a picture survives a file");
  fuzz::require(decode_png(*encode_png(*image, {})).has_value(), "a picture can be displayed");
  return 0;
}
