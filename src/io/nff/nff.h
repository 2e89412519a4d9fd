// The Neutral File Format (docs/nff.md): text to Scene and back.
#pragma once

#include <expected>
#include <filesystem>
#include <string_view>

#include "io/read_scene.h"

namespace raio::core {

class TextBuffer;  // io/nff/text_cursor.h

/// Reads a whole file: NFF 3.9, `pl`, coloured lights, Raio's keywords (docs/nff.md) and P3F
/// (docs/p3f.md). The dialect is P3F if the file has a sky or a material of 11 or 12 numbers.
/// Returns a scene that passes validate(), with its warnings, or all errors of the file: at most
/// kMaxDiagnostics, then a line with the number of further ones.
std::expected<ReadScene, Diagnostics> read_nff(const std::filesystem::path& path);

/// The same for text in memory; `file` is the name in messages.
std::expected<ReadScene, Diagnostics> parse_nff(std::string_view text, std::string_view file);
std::expected<ReadScene, Diagnostics> parse_nff(const TextBuffer& text, std::string_view file);

inline constexpr size_t kMaxDiagnostics = 20;

/// The scene as NFF, or as P3F if that is its dialect. Every number has the fewest digits that read
/// back to the same float. Primitives are written kind by kind, smooth triangles as `pp`, P3F's
/// lens after `resolution`; features that NFF cannot express are converted by plain_scene()
/// (io/plain_scene.h).
std::string write_nff(const Scene& scene, std::string_view comment = {});

}  // namespace raio::core
