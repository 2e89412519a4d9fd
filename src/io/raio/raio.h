// Raio's own binary scenes (docs/raio-scene.md): all that a Scene holds, as its columns lie in
// memory, so that a file is mapped and not read. For large scenes, and for those that NFF has no
// words for.
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "io/diagnostics.h"
#include "io/file.h"
#include "scene/scene.h"

namespace raio {

/// Do these bytes, the first of a file, belong to a .raio scene?
bool is_raio_scene(std::string_view start);

/// The scene as the bytes of a file. It must pass validate(); its name is not kept.
std::string encode_raio_scene(const Scene& scene);

/// The file is replaced whole or not at all.
std::expected<void, Error> write_raio_scene(const Scene& scene, const std::filesystem::path& path);

/// A scene that passes validate(), or one line that says what is wrong with the bytes. All is
/// checked before it is used, and each column against its hash. The columns are read in place for
/// as long as the scene lives, so `keep` must hold the bytes; without it they are copied.
std::expected<Scene, std::string> decode_raio_scene(std::string_view bytes,
                                                    const std::shared_ptr<const void>& keep);

/// The same of a file, which stays mapped into memory as long as any column of the scene does. It
/// may be replaced or removed meanwhile, but not overwritten or cut: that would end the program.
std::expected<Scene, Diagnostics> read_raio_scene(const std::filesystem::path& path);

}  // namespace raio
