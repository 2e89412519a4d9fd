// Scene files of any kind: what they are is told by their content, then by their suffix. For all
// who open what a user names.
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

namespace raio {

/// Reads an NFF or P3F text (read_nff), a .raio scene (read_raio_scene) or a file of atoms, points
/// or meshes (file_kind), also compressed by gzip; "-" is standard input. The errors of a file of
/// another kind are one that says what it seems to be. The scene's sky is read, too; where it
/// cannot be, a warning says why and Scene::sky is null.
std::expected<ReadScene, Diagnostics> read_scene(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

/// A file of which frame after frame is read. It is opened, unpacked and searched for its frames
/// once, so that the next frame of a trajectory takes as long whatever the number of frames; of a
/// PDB or CIF file each reads all models.
class SceneFrames {
 public:
  explicit SceneFrames(std::filesystem::path path) : path_(std::move(path)) {}
  /// As read_scene(). The options may differ from one call to the next.
  std::expected<ReadScene, Diagnostics> read(const ReadOptions& options);

 private:
  std::filesystem::path path_;
  std::shared_ptr<const TextBuffer> text_;
  std::filesystem::path name_;  // without the suffix of what was unpacked
  FrameCache cache_;
};

/// The same for bytes in memory, without the sky; `file` is the name in messages, whose suffix
/// counts and which the scene is called by.
std::expected<ReadScene, Diagnostics> parse_scene(std::string_view bytes, std::string_view file,
                                                  const ReadOptions& options = {});

/// A kind of file other than NFF, P3F and .raio: "a Wavefront OBJ mesh", and what reads it; null
/// for one that Raio cannot read.
struct FileKind {
  /// Which of the options that readers have it leaves open.
  enum class Takes : uint8_t { nothing, points, all };

  std::string_view name;
  SceneReader read = nullptr;
  Takes takes = Takes::nothing;
  bool is_mesh = false;
  float smooth = 0;  // see ReadOptions, where they do not say; degrees
};

/// What a file seems to be by its first bytes, its lower-case suffix (".obj") and its size. No name
/// for what may be NFF, P3F or .raio.
FileKind file_kind(std::string_view start, std::string_view suffix, size_t size);

/// Suffixes that files of scenes and data have, without the dot: for those who offer files.
std::vector<std::string_view> scene_suffixes();

/// How scenes can be written.
enum class SceneFormat { nff, raio, pov, ply, gltf };

/// By suffix, in any case; an error (bad_input) that lists the suffixes otherwise. "-" and .p3f are
/// NFF, whose dialect is the scene's.
std::expected<SceneFormat, Error> scene_format(const std::filesystem::path& path);

/// What of the scene is lost in the format, in one line (text_of), or nothing.
std::string lost_features(const Scene& scene, SceneFormat format);

/// Writes the scene in the format of the suffix, copies as primitives where it cannot keep them; a
/// .pov has the scene's resolution, else 512 x 512. `comment` is a line at the head of formats that
/// have comments.
std::expected<void, Error> write_scene(const Scene& scene, const std::filesystem::path& path,
                                       std::string_view comment = {});

}  // namespace raio
