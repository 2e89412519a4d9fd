// Scene files of any format, detected by content, then by suffix. For all code that opens the
// user's files.
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "io/diagnostics.h"
#include "io/file.h"
#include "io/nff/nff.h"
#include "scene/scene.h"

namespace raio::core {

/// Reads an NFF or P3F text (read_nff), a .raio scene (read_raio_scene) or a file of atoms, points
/// or meshes (file_kind), optionally gzip-compressed; "-" is standard input. For an unsupported
/// format, the error says what the file seems to be. The scene's sky is read, too; if that fails, a
/// warning says why and Scene::sky is null.
std::expected<ReadScene, Diagnostics> read_scene(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

/// A file that is read frame by frame. It is opened, decompressed and searched for frames once, so
/// the time per frame of a trajectory does not depend on the number of frames; for PDB and CIF,
/// each frame reads all models.
class SceneFrames {
 public:
  explicit SceneFrames(std::filesystem::path path) : path_(std::move(path)) {}
  /// As read_scene(), without a notice about other frames. The options may differ between calls.
  std::expected<ReadScene, Diagnostics> read(ReadOptions options) {
    options.cache = &cache_;
    return read_one(options);
  }

 private:
  friend std::expected<ReadScene, Diagnostics> read_scene(const std::filesystem::path& path,
                                                          const ReadOptions& options);
  std::expected<ReadScene, Diagnostics> read_one(const ReadOptions& options);

  std::filesystem::path path_;
  std::shared_ptr<const TextBuffer> text_;
  std::filesystem::path name_;  // without the suffix of compression
  FrameCache cache_;
};

/// The same for bytes in memory, without the sky; `file` is the name in messages; its suffix is
/// used for detection, its stem becomes the scene's name.
std::expected<ReadScene, Diagnostics> parse_scene(std::string_view bytes, std::string_view file,
                                                  const ReadOptions& options = {});

/// A format other than NFF, P3F and .raio: "a Wavefront OBJ mesh", and its reader; null if Raio
/// cannot read it.
struct FileKind {
  /// Which reader options apply to it.
  enum class Takes : uint8_t { nothing, points, all };

  std::string_view name;
  SceneReader read = nullptr;
  Takes takes = Takes::nothing;
  bool is_mesh = false;
  float smooth = 0;  // default of ReadOptions; degrees
};

/// Detects a file's format by its first bytes, its lower-case suffix (".obj") and its size. No name
/// if it may be NFF, P3F or .raio.
FileKind file_kind(std::string_view start, std::string_view suffix, size_t size);

/// Suffixes of scene and data files, without the dot.
std::vector<std::string_view> scene_suffixes();

/// Whether the name ends with one of them, compressed or not ("a.PDB", "a.pdb.gz"), for lists of
/// files: read_scene() reads more, by their content.
bool has_scene_suffix(const std::filesystem::path& path);

/// Formats for writing scenes.
enum class SceneFormat { nff, raio, pov, ply, gltf };

/// By suffix, in any case; otherwise an error (bad_input) that lists the suffixes. "-" and .p3f are
/// NFF, in the scene's dialect.
std::expected<SceneFormat, Error> scene_format(const std::filesystem::path& path);

/// What the format loses of the scene, in one line (text_of), or nothing.
std::string lost_features(const Scene& scene, SceneFormat format);

/// Writes the scene in the format of the suffix, with instances as primitives if the format has
/// none; a .pov uses the scene's resolution, else 512 x 512. `comment` is a line at the head of
/// formats with comments.
std::expected<void, Error> write_scene(const Scene& scene, const std::filesystem::path& path,
                                       std::string_view comment = {});

}  // namespace raio::core
