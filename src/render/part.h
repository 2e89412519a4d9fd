// Part files (.raio): a film, complete or not, with everything that determines its picture, so that
// it can be resumed elsewhere. Checkpoints, shards and pictures to refine are part files. Their
// layout is in docs/long-renders.md.
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "integrate/film.h"
#include "io/file.h"
#include "render/provenance.h"

namespace raio::core {

struct PartHeader {
  Metadata settings;               // settings_of() the picture
  uint32_t shard = 0, shards = 1;  // the tiles of this part, as in RenderTask
  SampleSpan samples = {};         // the samples of this part; empty: all of the settings
};

struct Part {
  PartHeader header;
  std::unique_ptr<Film> film;
};

/// Whether the suffix is that of a part file.
bool is_part_path(const std::filesystem::path& path);

/// A snapshot of the film while others may add to it: each tile is consistent.
std::string encode_part(const PartHeader& header, const Film& film);
std::expected<void, Error> write_part(const std::filesystem::path& path, const PartHeader& header,
                                      const Film& film);

/// The file is not trusted: the result is a valid film of the size in its settings. The error has
/// no subject.
std::expected<Part, Error> decode_part(std::string_view file);
std::expected<Part, Error> read_part(const std::filesystem::path& path);

/// The number of samples in the tiles of a part, within its shard.
struct SampleCounts {
  uint32_t fewest = 0, most = 0;
  double mean = 0;    // of all pixels
  bool alike = true;  // all tiles have the same samples
  SampleSet samples;  // of the first tile
};
SampleCounts samples_of(const Part& part);

/// The share of the pixels in a part's shard that have so many samples.
double share_with(uint32_t samples, const Part& part);

/// "0:20,50:100": each span as first sample and end, exclusive.
std::string text_of(const SampleSet& samples);

/// A part with its name, for messages.
struct NamedPart {
  std::string name;
  Part part;
};

/// Adds the samples of a part to a film, exactly. The error (bad_input) names the contradiction:
/// different settings, samples in both; the film is then unchanged.
std::expected<void, Error> add_part(NamedPart& whole, const NamedPart& part);

/// Merges parts into the film of the first, giving the bytes of a single render; errors as above.
/// The source provides one part after another, each until the next is asked for, and on an error
/// earlier ones again.
using PartSource = std::function<std::expected<NamedPart*, Error>(size_t index)>;
std::expected<Part, Error> merge_parts(size_t count, const PartSource& part);
std::expected<Part, Error> merge_parts(std::span<NamedPart> parts);

/// The samples missing in the tiles of a shard; nothing if its tiles miss different ones.
std::optional<SampleSet> missing_samples(const Part& part, uint32_t shard, uint32_t shards);

/// The missing tiles and samples of a part, tiles by shard; nothing if it is complete. `shards`:
/// the number of shards of the picture.
std::string missing_samples(const Part& part, uint32_t shards);

}  // namespace raio::core
