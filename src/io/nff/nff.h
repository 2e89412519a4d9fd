// The Neutral File Format (docs/nff.md): text to Scene and back.
#pragma once

#include <expected>
#include <filesystem>
#include <string_view>

#include "io/read_scene.h"

namespace raio {

class TextBuffer;  // io/nff/text_cursor.h

/// Reads a whole file: all of NFF 3.9, `pl`, coloured lights (docs/nff.md) and P3F but for its
/// motion (docs/p3f.md); the scene's dialect is P3F where the file has a material of 11 or 12
/// numbers or a sky. Returns every error of the file, not only the first (at most kMaxDiagnostics,
/// then a line that says how many more), or a scene that passes validate() with the warnings it
/// raised.
std::expected<ReadScene, Diagnostics> read_nff(const std::filesystem::path& path);

/// The same for text in memory; `file` is the name in messages.
std::expected<ReadScene, Diagnostics> parse_nff(std::string_view text, std::string_view file);
std::expected<ReadScene, Diagnostics> parse_nff(const TextBuffer& text, std::string_view file);

inline constexpr size_t kMaxDiagnostics = 20;

/// The scene as NFF, or as P3F where that is its dialect, every number with the fewest digits that
/// read back to the same float. Pools are written kind by kind; smooth triangles as `pp`, P3F's
/// lens after `resolution`; what NFF has no words for as plain_scene() (io/plain_scene.h) has it.
std::string write_nff(const Scene& scene, std::string_view comment = {});

}  // namespace raio
