// Textures of data files.
#pragma once

#include <expected>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "base/hash.h"
#include "scene/scene.h"

namespace raio::core {

class TextureReader {
 public:
  /// The index of a texture with the picture, a whole PNG or JPEG file, which is decoded and stored
  /// once; or an error. 16 bits become 8.
  std::expected<uint32_t, std::string> add(Scene& scene, std::string_view bytes,
                                           TextureWrap wrap_u = TextureWrap::repeat,
                                           TextureWrap wrap_v = TextureWrap::repeat);

 private:
  // By the hash of their bytes, including invalid ones.
  std::map<std::pair<uint64_t, uint64_t>, std::expected<Texture, std::string>> known_;
};

/// The bytes of a file referenced by a data file, relative to `folder`, or an error. Does not read
/// files that would block, such as pipes.
std::expected<std::string, std::string> read_beside(const std::filesystem::path& folder,
                                                    std::string_view name);

}  // namespace raio::core
