// Raio's binary scenes (docs/raio-scene.md): a complete Scene with columns in the layout of memory,
// so that files are read, not parsed. For large scenes, and for scenes that NFF cannot express.
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "io/diagnostics.h"
#include "io/file.h"
#include "scene/scene.h"

namespace raio::core {

/// Whether the first bytes of a file are those of a .raio scene.
bool is_raio_scene(std::string_view start);

/// The scene as the bytes of a file. It must pass validate(); its name is not stored.
std::string encode_raio_scene(const Scene& scene);

/// The file is replaced whole or not at all.
std::expected<void, Error> write_raio_scene(const Scene& scene, const std::filesystem::path& path);

/// A scene that passes validate(), or a line that describes the fault of the bytes. Everything is
/// checked before use, and each column against its hash. Columns are read in place while the scene
/// lives, so `keep` must own the bytes; without it they are copied.
std::expected<Scene, std::string> decode_raio_scene(std::string_view bytes,
                                                    const std::shared_ptr<const void>& keep);

/// The same for a file. Its bytes are kept while any column of the scene lives.
std::expected<Scene, Diagnostics> read_raio_scene(const std::filesystem::path& path);

}  // namespace raio::core
