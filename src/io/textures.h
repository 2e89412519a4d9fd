// Pictures in files of data to textures of a scene.
#pragma once

#include <expected>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "base/hash.h"
#include "scene/scene.h"

namespace raio {

class TextureReader {
 public:
  /// The number of a texture with the picture, a whole PNG or JPEG file, which is decoded and
  /// stored once, however often it comes; or why there is none. 16 bits become 8, and alpha is
  /// dropped.
  std::expected<uint32_t, std::string> add(Scene& scene, std::string_view bytes,
                                           TextureWrap wrap_u = TextureWrap::repeat,
                                           TextureWrap wrap_v = TextureWrap::repeat);

 private:
  // By the hash of their bytes, also those that are none.
  std::map<std::pair<uint64_t, uint64_t>, std::expected<Texture, std::string>> known_;
};

/// The bytes of the file that a file of data names, from `folder` on, or why there are none. What
/// would wait for somebody to write to it is not read.
std::expected<std::string, std::string> read_beside(const std::filesystem::path& folder,
                                                    std::string_view name);

}  // namespace raio
