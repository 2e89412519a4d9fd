#include "io/cube_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "io/file.h"
#include "io/image/codecs.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kSuffixes = {".jpg", ".jpeg", ".png"};
constexpr size_t kMaxFileBytes = size_t(1) << 31;

using Files = std::array<fs::path, kCubeFaces>;

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

Error refused(const fs::path& folder, std::string why) {
  return {ErrorKind::bad_input, folder.string(), std::move(why)};
}

/// Finds the file of each face; the error names missing ones.
std::expected<Files, Error> find_faces(const fs::path& folder) {
  std::error_code error;
  std::vector<std::pair<std::string, fs::path>> entries;  // by lower-case name
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    entries.emplace_back(lower(entry->path().filename().string()), entry->path());
  if (error) return std::unexpected(refused(folder, "cannot read the folder: " + error.message()));
  std::ranges::sort(entries);
  Files files;
  std::vector<std::string_view> missing;
  for (size_t face = 0; face < kCubeFaces; ++face) {
    for (const std::string_view suffix : kSuffixes) {
      const std::string name = std::string(kCubeFaceNames[face]) + std::string(suffix);
      const auto found = std::ranges::find(entries, name, [](const auto& e) { return e.first; });
      if (found == entries.end()) continue;
      files[face] = found->second;
      break;
    }
    if (files[face].empty()) missing.push_back(kCubeFaceNames[face]);
  }
  if (missing.empty()) return files;
  return std::unexpected(refused(
      folder, fmt::format("missing faces of the sky: {}; expected {}, each as .jpg, .jpeg or .png",
                          fmt::join(missing, ", "), fmt::join(kCubeFaceNames, ", "))));
}

/// "the face left (sky/left.jpg)"
std::string named(size_t face, const fs::path& file) {
  return fmt::format("the face {} ({})", kCubeFaceNames[face], file.string());
}

std::string size_of(const PixelRows& rows) {
  return fmt::format("{} x {} pixels", rows.width, rows.height);
}

/// Reads one face.
std::expected<PixelRows, Error> read_face(const fs::path& folder, size_t face,
                                          const fs::path& file) {
  const auto bytes = read_file(file, kMaxFileBytes);
  if (!bytes) {
    Error error = bytes.error();
    error.message = fmt::format("the face {}: {}", kCubeFaceNames[face], error.message);
    return std::unexpected(std::move(error));
  }
  auto rows = decode_rows(*bytes);
  if (!rows)
    return std::unexpected(refused(folder, fmt::format("{}: {}", named(face, file), rows.error())));
  if (rows->width != rows->height)
    return std::unexpected(
        refused(folder, fmt::format("{} has {}; expected as many columns as rows",
                                    named(face, file), size_of(*rows))));
  if (rows->width > kLargestFace)
    return std::unexpected(
        refused(folder, fmt::format("{} has {}; expected at most {} x {}", named(face, file),
                                    size_of(*rows), kLargestFace, kLargestFace)));
  return std::move(*rows);
}

void take_face(CubeMap& map, CubeFace face, const PixelRows& rows) {
  for (int y = 0; y < rows.height; ++y) put_texels(rows, y, &map.texels[map.index(face, 0, y)]);
}

std::expected<std::shared_ptr<const CubeMap>, Error> read_faces(const fs::path& folder,
                                                                const Files& files,
                                                                std::string_view name) {
  auto map = std::make_shared<CubeMap>();
  std::array<std::optional<std::expected<PixelRows, Error>>, kCubeFaces> faces;
  parallel_for(kCubeFaces, [&](size_t i) { faces[i] = read_face(folder, i, files[i]); });
  for (size_t i = 0; i < kCubeFaces; ++i) {
    if (!*faces[i]) return std::unexpected(std::move(faces[i]->error()));
    const PixelRows &first = **faces[0], &rows = **faces[i];
    if (rows.width != first.width)
      return std::unexpected(refused(
          folder,
          fmt::format("{} has {}, but {} has {}; expected faces of one size", named(i, files[i]),
                      size_of(rows), named(0, files[0]), size_of(first))));
  }
  map->folder = name.empty() ? folder.string() : std::string(name);
  map->side = (*faces[0])->width;
  map->texels.resize(kCubeFaces * map->stride() * map->stride());
  parallel_for(kCubeFaces, [&](size_t i) { take_face(*map, CubeFace(i), **faces[i]); });
  map->finish();
  return map;
}

}  // namespace

std::expected<std::shared_ptr<const CubeMap>, Error> read_cube_map(const fs::path& folder,
                                                                   std::string_view name) try {
  const auto files = find_faces(folder);
  if (!files) return std::unexpected(files.error());
  return read_faces(folder, *files, name);
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(folder));
}

fs::path find_sky(std::string_view folder, const fs::path& scene) {
  std::error_code error;
  const fs::path wanted(folder);
  fs::path place = fs::absolute(scene, error).lexically_normal().parent_path();
  while (!error) {
    if (fs::path sky = place / wanted; fs::is_directory(sky, error)) return sky;
    error.clear();
    if (!place.has_relative_path()) break;
    place = place.parent_path();
  }
  return {};
}

}  // namespace raio::core
