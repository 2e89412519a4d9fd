#include "io/textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/file.h"
#include "io/image/codecs.h"

namespace raio::core {

namespace fs = std::filesystem;

namespace {

std::expected<Texture, std::string> decode(Scene& scene, std::string_view bytes) {
  const auto rows = decode_rows(bytes, true);
  if (!rows) return std::unexpected(rows.error());
  const size_t width = size_t(rows->width), height = size_t(rows->height);
  if (width > kLargestTexture || height > kLargestTexture)
    return std::unexpected(fmt::format("it has {} x {} pixels; expected at most {} x {}", width,
                                       height, kLargestTexture, kLargestTexture));
  const size_t first = scene.texels.size();
  if (first + width * height > kMaxTexels)
    return std::unexpected(
        fmt::format("the pictures have more than {} pixels in total", kMaxTexels));
  scene.texels.resize(first + width * height);
  uint32_t* const texels = scene.texels.data() + first;
  for (size_t y = 0; y < height; ++y) put_texels(*rows, int(y), texels + y * width);
  return Texture{uint32_t(first), uint32_t(width), uint32_t(height)};
}

}  // namespace

std::expected<uint32_t, std::string> TextureReader::add(Scene& scene, std::string_view bytes,
                                                        TextureWrap wrap_u, TextureWrap wrap_v) {
  const Hash128 hash = hash128(bytes);
  const std::pair key(hash.first, hash.second);
  auto at = known_.find(key);
  if (at == known_.end()) at = known_.emplace(key, decode(scene, bytes)).first;
  if (!at->second) return std::unexpected(at->second.error());
  Texture texture = *at->second;
  texture.wrap_u = wrap_u, texture.wrap_v = wrap_v;
  const auto& all = std::as_const(scene).textures;
  const auto same = std::ranges::find(all, texture);
  const auto number = uint32_t(same - all.begin());
  if (number == all.size()) scene.textures.push_back(texture);
  return number;
}

std::expected<std::string, std::string> read_beside(const fs::path& folder, std::string_view name) {
  std::string path(name);
  std::ranges::replace(path, '\\', '/');
  const fs::path file = folder / path;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::unexpected("the file does not exist");
  auto bytes = read_file(file, size_t(1) << 31);
  if (!bytes) return std::unexpected(bytes.error().message);
  return std::move(*bytes);
}

}  // namespace raio::core
